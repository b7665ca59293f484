//! Where along its slit the light of a match leaves the panel. The stripes do not code it: it follows from the match by
//! way of the rig, so that the panel's borders and other matches can contradict it.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::super::camera_ray::{CameraRay, CameraRays};
use super::super::light_plane::{Coordinate, Hit, ProjectorLight};
use super::super::point_covariance::RigSigma;
use crate::error::Result;
use crate::estimate::residual::LENS;
use crate::estimate::unknowns::SHARED;
use crate::geometry::Distortion;
use crate::matches::Match;
use crate::parameter::LensParameter;
use crate::rig::Rig;

/// Light is followed this far outside the panel, in its sides. Farther out there are wrong labels alone.
const FOLLOWED: f64 = 0.5;

/// Positions along the slits, as one rig has them.
#[derive(Debug, Clone)]
pub(super) struct PanelPositions {
    rays: CameraRays,
    light: ProjectorLight,
    sigma: Option<RigSigma>,
}

/// The coded coordinate of a match of stripes: 0 and the column, or 1 and the row. `None` where both or neither is known.
pub(super) fn coded(m: &Match) -> Option<(usize, f64)> {
    match (m.projector_column, m.projector_row) {
        (Some(column), None) => Some((0, column)),
        (None, Some(row)) => Some((1, row)),
        _ => None,
    }
}

impl PanelPositions {
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a rig without a projector.
    pub(super) fn new(rig: &Rig, min_angle_rad: f64) -> Result<Self> {
        let projector = rig.require_projector()?;
        let (model, pose) = (projector.device.model, projector.from_camera.pose);
        Ok(Self {
            rays: CameraRays::new(rig.camera.model),
            light: ProjectorLight::new(model, pose, min_angle_rad, FOLLOWED),
            sigma: RigSigma::of(rig),
        })
    }

    /// The panel's size along the slits whose coordinate is of this axis, px.
    pub(super) fn length_px(&self, axis: usize) -> f64 {
        f64::from(self.light.projector.size()[1 - axis])
    }

    /// The panel's size across them, px.
    pub(super) fn width_px(&self, axis: usize) -> f64 {
        f64::from(self.light.projector.size()[axis])
    }

    /// The image's size, px.
    pub(super) fn image_px(&self) -> [f64; 2] {
        self.rays.camera.size().map(f64::from)
    }

    /// The position along its slit of the light of a match, px on the panel, if the slit's coordinate is this one.
    pub(super) fn at(&self, m: &Match, axis: usize, coordinate: f64) -> Option<f64> {
        let (_, hit) = self.meet(m, axis, coordinate)?;
        Some(self.light.pixel(hit.ideal)[1 - axis])
    }

    /// 1σ of a position by the noise of its match, px on the panel. `across` is the image coordinate that was measured.
    pub(super) fn noise_px(&self, m: &Match, across: usize) -> Option<f64> {
        let (axis, coordinate) = coded(m)?;
        let (ray, hit) = self.meet(m, axis, coordinate)?;
        let [of_code, along] = self.both(&ray, &hit, axis)?;
        let turned = self.light.pose.rotation.matrix() * ray.by_pixel.column(across).push(0.0);
        let by = |c: &Coordinate| c.h.dot(&turned) / hit.depth_ratio;
        Some(((by(&along) - along.slope / of_code.slope * by(&of_code)) * m.sigma_px).abs())
    }

    /// 1σ of the difference of the positions of two matches of a slit (of one of them without a second) by the rig's
    /// covariance, px on the panel; `None` where the rig has no covariance.
    pub(super) fn rig_sigma_px(&self, m: &Match, second: Option<&Match>) -> Option<f64> {
        let sigma = self.sigma.as_ref()?;
        let mut gradient = self.gradient(m)?;
        if let Some(second) = second {
            for (g, other) in gradient.iter_mut().zip(self.gradient(second)?) {
                *g -= other;
            }
        }
        Some(sigma.propagated(&gradient))
    }

    fn meet(&self, m: &Match, axis: usize, coordinate: f64) -> Option<(CameraRay, Hit)> {
        let ray = self.rays.of(m.camera, &self.light.pose.rotation)?;
        let wanted = if axis == 0 { [Some(coordinate), None] } else { [None, Some(coordinate)] };
        let hit = self.light.meet(&ray.in_projector, wanted).ok()?;
        Some((ray, hit))
    }

    /// The coordinate that is coded, and the position along the slit.
    fn both(&self, ray: &CameraRay, hit: &Hit, axis: usize) -> Option<[Coordinate; 2]> {
        let [column, row] = self.light.at(&ray.in_projector, hit.inverse_depth, [Some(0.0); 2]).ok()?.of;
        let (column, row) = (column?, row?);
        Some(if axis == 0 { [column, row] } else { [row, column] })
    }

    /// Derivatives of a position by all parameters, px per unit.
    ///
    /// A parameter moves both coordinates of the point at a fixed depth. The depth then follows so that the coded
    /// coordinate u stays, which moves the position w along: δw = ∂w − (dw/dz)/(du/dz)·∂u.
    fn gradient(&self, m: &Match) -> Option<[f64; SHARED]> {
        let (axis, coordinate) = coded(m)?;
        let (ray, hit) = self.meet(m, axis, coordinate)?;
        let [of_code, along] = self.both(&ray, &hit, axis)?;
        let by_depth = along.slope / of_code.slope;
        let mut out = self.at_fixed_depth(&ray, &hit, &along);
        for (o, u) in out.iter_mut().zip(self.at_fixed_depth(&ray, &hit, &of_code)) {
            *o -= by_depth * u;
        }
        Some(out)
    }

    /// Derivatives of a coordinate on the panel of the point at a fixed depth on its ray.
    fn at_fixed_depth(&self, ray: &CameraRay, hit: &Hit, c: &Coordinate) -> [f64; SHARED] {
        let mut out = [0.0; SHARED];
        let rotation = self.light.pose.rotation.matrix();
        let by_ray = rotation.tr_mul(&c.h).xy() / hit.depth_ratio;
        out[..LENS].copy_from_slice(&self.by_camera(ray, by_ray));
        out[LENS..2 * LENS].copy_from_slice(&self.by_projector(hit.ideal, c.axis));
        let turn: Vector3<f64> = ray.in_projector.cross(&c.h) / hit.depth_ratio;
        let shift = c.h * (hit.inverse_depth / hit.depth_ratio);
        out[2 * LENS..2 * LENS + 3].copy_from_slice(turn.as_slice());
        out[2 * LENS + 3..].copy_from_slice(shift.as_slice());
        out
    }

    /// By the camera's lens, whose parameters turn the ray of a fixed pixel.
    fn by_camera(&self, ray: &CameraRay, by_ray: Vector2<f64>) -> [f64; LENS] {
        let (camera, ideal) = (&self.rays.camera, ray.bearing.xy());
        let k = &camera.intrinsics;
        let unbent = ray.by_pixel * Matrix2::new(k.fx, k.skew, 0.0, k.fy);
        let by_distorted = -unbent.tr_mul(&by_ray);
        let distorted = camera.distortion.distort(ideal);
        let by_centre = -ray.by_pixel.tr_mul(&by_ray);
        let mut out = [0.0; LENS];
        out[LensParameter::Focal as usize] = by_distorted.dot(&distorted) / k.fx;
        out[LensParameter::Cx as usize] = by_centre.x;
        out[LensParameter::Cy as usize] = by_centre.y;
        out[LensParameter::Aspect as usize] = by_distorted.y * distorted.y;
        add_coefficients(&mut out, ideal, by_distorted);
        out
    }

    /// By the projector's lens.
    fn by_projector(&self, ideal: Vector2<f64>, axis: usize) -> [f64; LENS] {
        let projector = &self.light.projector;
        let row = self.light.k_row(axis);
        let distorted = projector.distortion.distort(ideal);
        let mut out = [0.0; LENS];
        out[LensParameter::Focal as usize] = row.dot(&distorted) / projector.intrinsics.fx;
        out[LensParameter::Cx as usize + axis] = 1.0;
        if axis == 1 {
            out[LensParameter::Aspect as usize] = projector.intrinsics.fy * distorted.y;
        }
        add_coefficients(&mut out, ideal, row);
        out
    }
}

fn add_coefficients(out: &mut [f64; LENS], ideal: Vector2<f64>, by_distorted: Vector2<f64>) {
    let coefficients = Distortion::coefficient_jacobian(ideal);
    for (o, column) in out[LensParameter::K1 as usize..].iter_mut().zip(coefficients.column_iter()) {
        *o = by_distorted.dot(&column);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, Point2, Point3, Rotation3};

    use super::*;
    use crate::for_tests::test_rig;
    use crate::geometry::Intrinsics;
    use crate::parameter::{Parameter, PoseParameter};
    use crate::rig::Covariance;

    fn distorted() -> Rig {
        let mut rig = test_rig();
        rig.camera.model.distortion = Distortion { k1: -0.12, k2: 0.03, p1: 1e-3, p2: -5e-4, k3: 0.01 };
        rig.camera.model.intrinsics = Intrinsics { fx: 1500.0, fy: 1480.0, skew: 0.0, cx: 700.0, cy: 420.0 };
        let projector = &mut rig.projector.as_mut().unwrap().device.model;
        projector.distortion = Distortion { k1: 0.05, k2: -0.02, p1: 1e-3, p2: 1e-3, k3: 0.0 };
        projector.intrinsics = Intrinsics { fx: 1700.0, fy: 1690.0, skew: 0.0, cx: 511.5, cy: 768.0 };
        rig
    }

    fn changed(rig: &Rig, parameter: &Parameter, x: f64) -> Rig {
        let mut rig = rig.clone();
        let projector = rig.projector.as_mut().unwrap();
        let lens = |camera: &mut crate::geometry::Camera, p: LensParameter| {
            let (k, d) = (&mut camera.intrinsics, &mut camera.distortion);
            match p {
                LensParameter::Focal => (k.fx, k.fy) = (k.fx + x, k.fy * (1.0 + x / k.fx)),
                LensParameter::Cx => k.cx += x,
                LensParameter::Cy => k.cy += x,
                LensParameter::K1 => d.k1 += x,
                LensParameter::K2 => d.k2 += x,
                LensParameter::P1 => d.p1 += x,
                LensParameter::P2 => d.p2 += x,
                LensParameter::K3 => d.k3 += x,
                LensParameter::Aspect => k.fy *= 1.0 + x,
            }
        };
        match parameter {
            Parameter::Camera(p) => lens(&mut rig.camera.model, *p),
            Parameter::Projector(p) => lens(&mut projector.device.model, *p),
            Parameter::ProjectorFromCamera(p) => {
                let pose = &mut projector.from_camera.pose;
                let k = *p as usize % 3;
                if (*p as usize) < 3 {
                    let mut turn = Vector3::zeros();
                    turn[k] = x;
                    pose.rotation = Rotation3::from_scaled_axis(turn) * pose.rotation;
                } else {
                    pose.translation[k] += x;
                }
            }
            _ => unreachable!(),
        }
        rig
    }

    /// One parameter after the other with σ = 1: the propagated σ is the size of the derivative.
    #[test]
    fn sigma_follows_from_derivatives_of_the_position() {
        let lenses =
            LensParameter::ALL.into_iter().flat_map(|p| [Parameter::Camera(p), Parameter::Projector(p)]);
        let poses = PoseParameter::ALL.into_iter().map(Parameter::ProjectorFromCamera);
        let (a, b) = (Point2::new(520.0, 610.0), Point2::new(760.0, 300.0));
        for parameter in lenses.chain(poses) {
            for axis in [0, 1] {
                let mut rig = distorted();
                let projector = rig.projector.unwrap();
                let at = |pixel: Point2<f64>, depth: f64| {
                    let lit = Point3::from(rig.camera.model.bearing(pixel).unwrap() * depth);
                    let seen = projector.device.model.project(&projector.from_camera.pose.transform(&lit));
                    let c = seen.unwrap()[axis];
                    if axis == 0 { Match::at(pixel, Some(c), None) } else { Match::at(pixel, None, Some(c)) }
                };
                let (m, n) = (at(a, 900.0), at(b, 1100.0));
                rig.covariance =
                    Some(Covariance { parameters: vec![parameter.clone()], matrix: DMatrix::identity(1, 1) });
                let stated = PanelPositions::new(&rig, 0.0).unwrap();
                let place = |x: f64, m: &Match| {
                    let (axis, c) = coded(m).unwrap();
                    PanelPositions::new(&changed(&rig, &parameter, x), 0.0).unwrap().at(m, axis, c).unwrap()
                };
                let step = 1e-6;
                let slope = |m: &Match| (place(step, m) - place(-step, m)) / (2.0 * step);
                let (one, both) = (slope(&m), slope(&m) - slope(&n));
                let close =
                    |found: f64, wanted: f64| (found - wanted.abs()).abs() <= 1e-4 * wanted.abs() + 1e-5;
                let found = stated.rig_sigma_px(&m, None).unwrap();
                assert!(close(found, one), "{parameter} of axis {axis}: {found}, {one}");
                let found = stated.rig_sigma_px(&m, Some(&n)).unwrap();
                assert!(close(found, both), "{parameter} of axis {axis}, difference: {found}, {both}");
            }
        }
        assert_eq!(
            PanelPositions::new(&distorted(), 0.0)
                .unwrap()
                .rig_sigma_px(&Match::at(a, Some(380.0), None), None),
            None
        );
    }

    #[test]
    fn noise_moves_the_position() {
        let rig = distorted();
        let positions = PanelPositions::new(&rig, 0.0).unwrap();
        let m = Match { sigma_px: 0.2, ..Match::at(Point2::new(520.0, 610.0), Some(380.0), None) };
        for across in [0, 1] {
            let place = |by: f64| {
                let mut m = m;
                m.camera[across] += by;
                positions.at(&m, 0, 380.0).unwrap()
            };
            let wanted = 0.2 * (place(1e-4) - place(-1e-4)).abs() / 2e-4;
            assert!((positions.noise_px(&m, across).unwrap() - wanted).abs() < 1e-4 * wanted);
        }
    }
}
