//! The rig's share of a point's σ.

use nalgebra::{Matrix2, Vector2};

use super::camera_ray::CameraRay;
use super::light_plane::{Hit, ProjectorLight};
use crate::estimate::Unknowns;
use crate::estimate::residual::LENS;
use crate::estimate::unknowns::SHARED;
use crate::geometry::{Camera, Distortion};
use crate::parameter::Parameter;
use crate::rig::Rig;

/// The covariance of the devices and of the transform between them.
#[derive(Debug, Clone)]
pub(super) struct RigSigma {
    /// Of the parameters of camera, projector and transform, the one that row i is of.
    parameters: Vec<usize>,
    /// Row by row.
    matrix: Vec<f64>,
}

impl RigSigma {
    /// From the rig's covariance; `None` where it has none, or one of parameters that are not known here, or one that is
    /// no matrix of finite numbers.
    pub(super) fn of(rig: &Rig) -> Option<Self> {
        let covariance = rig.covariance.as_ref()?;
        // Poses and bends of the sheet play no part.
        let all = Unknowns::all(0, false);
        let shared = covariance
            .parameters
            .iter()
            .enumerate()
            .filter(|(_, p)| !matches!(p, Parameter::View(..) | Parameter::Bend(..)));
        let places: Vec<(usize, usize)> =
            shared.map(|(row, p)| Some((row, all.position(p)?))).collect::<Option<_>>()?;
        let mut matrix = Vec::with_capacity(places.len() * places.len());
        for (i, _) in &places {
            for (j, _) in &places {
                matrix.push(*covariance.matrix.get((*i, *j)).filter(|x| x.is_finite())?);
            }
        }
        let parameters: Vec<usize> = places.iter().map(|(_, p)| *p).collect();
        (!parameters.is_empty()).then_some(Self { parameters, matrix })
    }

    /// 1σ along the camera's ray, mm, to first order.
    pub(super) fn along_ray(
        &self,
        camera: &Camera,
        light: &ProjectorLight,
        ray: &CameraRay,
        hit: &Hit,
    ) -> f64 {
        self.propagated(&gradient(camera, light, ray, hit))
    }

    /// 1σ of a quantity with these derivatives by all parameters, to first order.
    pub(super) fn propagated(&self, all: &[f64; SHARED]) -> f64 {
        let n = self.parameters.len();
        let mut g = [0.0; SHARED];
        for (to, from) in g.iter_mut().zip(&self.parameters) {
            *to = all[*from];
        }
        let g = &g[..n.min(SHARED)];
        let rows = self.matrix.chunks_exact(n);
        let row = |row: &[f64]| row.iter().zip(g).map(|(m, x)| m * x).sum::<f64>();
        let variance: f64 = rows.zip(g).map(|(r, x)| row(r) * x).sum();
        variance.max(0.0).sqrt()
    }
}

/// Derivatives of a point's position along its ray by all parameters, mm per unit.
///
/// The camera's parameters move the ray (by δb), and the point stays on it and in the light: with the light's coordinate
/// u(X) and the point z·b, ∇u·δ(z·b) + δu = 0. The displacement along the ray is that of the depth and that of the ray
/// itself, |b|·δz + z·(b·δb)/|b|.
fn gradient(camera: &Camera, light: &ProjectorLight, ray: &CameraRay, hit: &Hit) -> [f64; SHARED] {
    let z = 1.0 / hit.inverse_depth;
    let (b, q) = (&ray.bearing, &ray.in_projector);
    // What a displacement of the ray's direction, per unit of (x, y), does to the result.
    let length = ray.squared_length.sqrt();
    let mut by_ray = b.xy() * (z / length);
    let mut out = [0.0; SHARED];
    for c in hit.coordinates() {
        // As h is perpendicular to q + t/z: −1/(h·q), by what the coordinate counts.
        let factor = length * c.gain / (hit.inverse_depth * hit.depth_ratio);
        by_ray += light.pose.rotation.matrix().tr_mul(&c.h).xy() * (z * factor);
        // Times the depth in the projector, as are the gradients of the lens.
        let depth = hit.depth_ratio * z;
        let of_lens = lens_gradient(light, hit.ideal, c.axis);
        for (o, g) in out[LENS..2 * LENS].iter_mut().zip(of_lens) {
            *o += factor * depth * g;
        }
        let turn = q.cross(&c.h) * z;
        for k in 0..3 {
            out[2 * LENS + k] += factor * turn[k];
            out[2 * LENS + 3 + k] += factor * c.h[k];
        }
    }
    let ideal = b.xy();
    let (distorted, unbent) = if camera.distortion.is_none() {
        (ideal, Matrix2::identity())
    } else {
        let k = &camera.intrinsics;
        (camera.distortion.distort(ideal), ray.by_pixel * Matrix2::new(k.fx, k.skew, 0.0, k.fy))
    };
    let by_distorted = -unbent.tr_mul(&by_ray);
    out[0] = by_distorted.dot(&distorted) / camera.intrinsics.fx;
    let by_centre = -ray.by_pixel.tr_mul(&by_ray);
    (out[1], out[2]) = (by_centre.x, by_centre.y);
    let coefficients = Distortion::coefficient_jacobian(ideal);
    for (i, column) in coefficients.column_iter().enumerate() {
        out[3 + i] = by_distorted.dot(&column);
    }
    out
}

/// Derivatives of one coordinate of the pixel of an ideal point by the projector's lens.
fn lens_gradient(light: &ProjectorLight, ideal: Vector2<f64>, axis: usize) -> [f64; LENS] {
    let row = light.k_row(axis);
    let mut out = [0.0; LENS];
    out[0] = row.dot(&light.projector.distortion.distort(ideal)) / light.projector.intrinsics.fx;
    out[1 + axis] = 1.0;
    for (o, column) in out[3..].iter_mut().zip(Distortion::coefficient_jacobian(ideal).column_iter()) {
        *o = row.dot(&column);
    }
    out
}
