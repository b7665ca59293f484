//! The intersection of a camera's ray with the light plane of a projector column or row.

// Inlined from match to point; otherwise the compiler passes every intersection through memory.
#![allow(clippy::inline_always)]

use std::cmp::Ordering;

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::geometry::{Camera, Pose};

/// Why a match gives no point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rejection {
    Invalid,
    Grazing,
    Behind,
    OutsidePanel,
    Contradicting,
    OutsideDepth,
}

/// Newton's iteration has converged when a step is below this share of the inverse depth. As every step squares the
/// error, the remaining one is rounding.
const CONVERGED: f64 = 1e-8;
/// Three or four steps suffice for any lens; more are needed where column and row contradict each other.
const MAX_STEPS: usize = 30;

/// The projector as a source of light, in the camera's frame.
#[derive(Debug, Clone)]
pub(super) struct ProjectorLight {
    pub(super) projector: Camera,
    pub(super) pose: Pose,
    bent: bool,
    least_sin2: f64,
    panel: [std::ops::RangeInclusive<f64>; 2],
    /// Largest distance of column and row from the projection of their point, px.
    margin: [f64; 2],
}

/// A coordinate on the panel as a function of the point, to first order. Its gradient by the point in the projector's
/// frame is `h`/(depth), and `h` is perpendicular to the ray from the projector.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coordinate {
    /// 0 for a column, 1 for a row.
    pub(super) axis: usize,
    /// Gradient times depth, px.
    pub(super) h: Vector3<f64>,
    /// Derivative by the inverse depth along a fixed ray, px·mm.
    pub(super) slope: f64,
    /// Derivative of the result, the inverse depth, by this coordinate, 1/(px·mm). It is the inverse of the slope, or
    /// its least-squares weight where column and row are both known (zero for a coordinate that does not depend on
    /// depth).
    pub(super) gain: f64,
}

/// The illuminated point of a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    /// 1/z in the camera's frame, 1/mm.
    pub(super) inverse_depth: f64,
    /// Its ideal normalized point in the projector.
    pub(super) ideal: Vector2<f64>,
    /// Depth in the projector over depth in the camera.
    pub(super) depth_ratio: f64,
    /// By column and by row.
    pub(super) of: [Option<Coordinate>; 2],
}

impl Hit {
    pub(super) fn coordinates(&self) -> impl Iterator<Item = &Coordinate> {
        self.of.iter().flatten()
    }
}

impl ProjectorLight {
    pub(super) fn new(projector: Camera, pose: Pose, min_angle_rad: f64, panel_margin: f64) -> Self {
        let side = |size: u32| {
            let margin = panel_margin * f64::from(size);
            -0.5 - margin..=f64::from(size) - 0.5 + margin
        };
        Self {
            projector,
            pose,
            bent: !projector.distortion.is_none(),
            least_sin2: min_angle_rad.sin().powi(2),
            panel: [side(projector.width), side(projector.height)],
            margin: projector.size().map(|n| panel_margin * f64::from(n)),
        }
    }

    /// The point of the ray `q` (the camera's (x, y, 1) rotated into the projector's frame) that is lit by the given
    /// column, row, or both.
    ///
    /// The light plane of an ideal column c is h·X = 0 through the projector's centre with h = (fx, s, cx − c), so that
    /// h·(z·q + t) = 0 gives the depth z in closed form (paper, eq. 17–19, solved on the ray). Where the lens bends it,
    /// or column and row overdetermine the depth, Newton's method (Gauss–Newton on the residuals in px) starts from
    /// there. The unknown is 1/z, in which a coordinate on the panel is nearly linear, and which passes through zero at
    /// infinity.
    #[inline(always)]
    pub(super) fn meet(&self, q: &Vector3<f64>, wanted: [Option<f64>; 2]) -> Result<Hit, Rejection> {
        let mut inverse_depth = self.start(q, wanted);
        if !inverse_depth.is_finite() {
            return Err(Rejection::Grazing);
        }
        let mut hit = self.at(q, inverse_depth, wanted)?;
        if self.bent || (wanted[0].is_some() && wanted[1].is_some()) {
            let mut steps = 0;
            loop {
                let step = self.step(&hit, wanted);
                inverse_depth -= step;
                if !inverse_depth.is_finite() {
                    return Err(Rejection::Grazing);
                }
                hit = self.at(q, inverse_depth, wanted)?;
                if step.abs() <= CONVERGED * inverse_depth.abs() {
                    break;
                }
                steps += 1;
                if steps == MAX_STEPS {
                    return Err(Rejection::Invalid);
                }
            }
        }
        self.check(q, &hit, wanted)?;
        Ok(hit)
    }

    /// Rejects points behind a device, at grazing angles or outside the panel, and column and row that contradict each
    /// other.
    #[inline(always)]
    fn check(&self, q: &Vector3<f64>, hit: &Hit, wanted: [Option<f64>; 2]) -> Result<(), Rejection> {
        let least = self.least_sin2 * q.norm_squared();
        if !hit.coordinates().any(|c| c.h.dot(q).powi(2) >= least * c.h.norm_squared()) {
            return Err(Rejection::Grazing);
        }
        if !(hit.inverse_depth > 0.0 && hit.depth_ratio > 0.0) {
            return Err(Rejection::Behind);
        }
        let lit = self.pixel(hit.ideal);
        if !(self.panel[0].contains(&lit.x) && self.panel[1].contains(&lit.y)) {
            return Err(Rejection::OutsidePanel);
        }
        if let [Some(column), Some(row)] = wanted
            && !((lit.x - column).abs() <= self.margin[0] && (lit.y - row).abs() <= self.margin[1])
        {
            return Err(Rejection::Contradicting);
        }
        Ok(())
    }

    #[inline(always)]
    pub(super) fn pixel(&self, ideal: Vector2<f64>) -> Vector2<f64> {
        let at = if self.bent { self.projector.distortion.distort(ideal) } else { ideal };
        self.projector.intrinsics.pixel(at).coords
    }

    /// The rows of K's 2×2 part.
    #[inline(always)]
    pub(super) fn k_row(&self, axis: usize) -> Vector2<f64> {
        let k = &self.projector.intrinsics;
        if axis == 0 { Vector2::new(k.fx, k.skew) } else { Vector2::new(0.0, k.fy) }
    }

    /// 1/z without distortion, from the coordinate that is more sensitive to it.
    #[inline(always)]
    fn start(&self, q: &Vector3<f64>, wanted: [Option<f64>; 2]) -> f64 {
        let centre = self.projector.intrinsics.principal_point();
        let (mut best, mut inverse_depth) = (0.0, f64::NAN);
        for (axis, c) in wanted.into_iter().enumerate() {
            let Some(c) = c else { continue };
            let k = self.k_row(axis);
            let h = Vector3::new(k.x, k.y, centre[axis] - c);
            let by_translation = h.dot(&self.pose.translation);
            if by_translation.abs() > best {
                best = by_translation.abs();
                inverse_depth = -h.dot(q) / by_translation;
            }
        }
        inverse_depth
    }

    /// The projection into the projector of the ray's point at an inverse depth.
    #[inline(always)]
    pub(super) fn at(
        &self,
        q: &Vector3<f64>,
        inverse_depth: f64,
        wanted: [Option<f64>; 2],
    ) -> Result<Hit, Rejection> {
        let t = &self.pose.translation;
        let p = q + t * inverse_depth;
        if p.z.is_nan() || p.z <= 0.0 {
            return Err(Rejection::Behind);
        }
        let per_depth = 1.0 / p.z;
        let ideal = p.xy() * per_depth;
        let bend = if self.bent { self.projector.distortion.jacobian(ideal) } else { Matrix2::identity() };
        let turned_over = self.bent && bend.determinant().partial_cmp(&0.0) != Some(Ordering::Greater);
        if turned_over {
            // Beyond the fold of the distortion model: no light leaves there.
            return Err(Rejection::OutsidePanel);
        }
        let coordinate = |axis: usize| {
            let k = self.k_row(axis);
            let by_ideal = if self.bent { bend.tr_mul(&k) } else { k };
            let h = Vector3::new(by_ideal.x, by_ideal.y, -by_ideal.dot(&ideal));
            let along = h.dot(t);
            Coordinate { axis, h, slope: along * per_depth, gain: p.z / along }
        };
        let mut of = [wanted[0].map(|_| coordinate(0)), wanted[1].map(|_| coordinate(1))];
        if let [Some(a), Some(b)] = &mut of {
            let sum = a.slope * a.slope + b.slope * b.slope;
            a.gain = a.slope / sum;
            b.gain = b.slope / sum;
        }
        Ok(Hit { inverse_depth, ideal, depth_ratio: p.z, of })
    }

    /// The step of 1/z that minimises the distance from the observed coordinates.
    fn step(&self, hit: &Hit, wanted: [Option<f64>; 2]) -> f64 {
        let lit = self.pixel(hit.ideal);
        let off = |axis: usize| {
            hit.of[axis].zip(wanted[axis]).map_or(0.0, |(of, wanted)| of.gain * (lit[axis] - wanted))
        };
        off(0) + off(1)
    }
}
