//! A sheet that is bent without stretching. The surfaces are exact, not the polynomials of the estimator, on purpose.

use std::f64::consts::PI;

use nalgebra::{Matrix2, Matrix3, Point2, Point3, Rotation3, Vector2, Vector3};

use super::bend::{BendConfig, BendKind};
use crate::error::Result;
use crate::geometry::{Pose, Ray, RectangleSize};

/// Terms of the series of a wave's section. At the largest sag the first one that is left out is below 1e-15.
const TERMS: usize = 7;
/// Iterations for the curvature that gives a sag; they converge after less than half of them.
const CURVATURE_STEPS: usize = 60;
/// Intervals per side of the rule that averages over the sheet (Simpson's).
const INTERVALS: usize = 32;
/// Rotations after which the mean plane lies still.
const LEVELLINGS: usize = 4;
/// Steps of Newton's method with bisection; without bisection five suffice.
const ROOT_STEPS: usize = 80;
/// Relative width of a root's interval that counts as rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Steps of Newton's method on a twisted sheet.
const TWIST_STEPS: usize = 20;

/// A bent sheet in the frame of the flat one: the origin its top left corner, x along the width, y along the height, z
/// away from the viewer. The mean plane of the bent sheet is z = 0, and its middle stays in its place in x and y.
#[derive(Debug, Clone, PartialEq)]
pub struct BentSheet {
    size: RectangleSize,
    profile: Profile,
    /// Cosine and sine of the angle from the sheet's width to the direction across the axis.
    turn: [f64; 2],
    /// From coordinates across the axis, along it, and away from the viewer.
    sheet_from_profile: Pose,
}

/// A point of a bent sheet on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BentSheetHit {
    /// In lengths of the ray's direction.
    pub distance: f64,
    /// The place on the flat sheet, mm.
    pub place: Point2<f64>,
    /// Unit normal away from the viewer, in the sheet's frame.
    pub normal: Vector3<f64>,
}

/// The shape about the sheet's middle.
#[derive(Debug, Clone, PartialEq)]
enum Profile {
    /// A section that is the same all along the axis.
    Cylinder {
        section: Section,
        /// Half the extent of the sheet across the axis, mm.
        reach: f64,
    },
    /// z = rate · x · y, 1/mm.
    Twist { rate: f64 },
}

/// A plane curve by its arc length from the middle.
#[derive(Debug, Clone, PartialEq)]
enum Section {
    /// A circle of signed curvature, 1/mm.
    Arc { curvature: f64 },
    /// A curve whose slope angle is `steepest` · cos(π t / reach), by its Fourier series (Jacobi and Anger).
    Wave(Box<Wave>),
}

/// The series of a wave.
#[derive(Debug, Clone, PartialEq)]
struct Wave {
    reach: f64,
    steepest: f64,
    /// Mean of the slope angle's cosine.
    mean: f64,
    /// Of sin(2 π t / reach), sin(4 π t / reach), ... across the axis.
    across: [f64; TERMS],
    /// Of sin(π t / reach), sin(3 π t / reach), ... away from the viewer.
    away: [f64; TERMS],
}

impl Section {
    /// The arc whose ends, `reach` from the middle, lie `sag` before it.
    fn arc(sag: f64, reach: f64) -> Self {
        let wanted = sag.abs() / reach;
        // (1 − cos θ) / θ = sag / reach, by Newton's method from small angles.
        let mut angle = 2.0 * wanted;
        for _ in 0..CURVATURE_STEPS {
            let excess = 2.0 * libm::sin(angle / 2.0).powi(2) - wanted * angle;
            let slope = libm::sin(angle) - wanted;
            if slope > 0.0 {
                angle -= excess / slope;
            }
        }
        Self::Arc { curvature: (angle / reach).copysign(sag) }
    }

    /// The wave whose crests lie `sag` beside its chord.
    fn wave(sag: f64, reach: f64) -> Self {
        let crest = |steepest: f64| {
            let terms = (0..TERMS).map(|k| libm::jn(odd(k), steepest) / f64::from(odd(k)));
            2.0 * reach / PI * terms.sum::<f64>()
        };
        let mut steepest = PI * sag.abs() / reach;
        for _ in 0..CURVATURE_STEPS {
            let height = crest(steepest);
            if height > 0.0 {
                steepest *= sag.abs() / height;
            }
        }
        let sign = |k: usize| if k.is_multiple_of(2) { 2.0 } else { -2.0 };
        let across = |k: usize| {
            let n = odd(k) + 1;
            // The series of the cosine begins with J₀, which is the mean.
            -sign(k) * libm::jn(n, steepest) * reach / (f64::from(n) * PI)
        };
        let away = |k: usize| {
            let n = odd(k);
            (sign(k) * libm::jn(n, steepest) * reach / (f64::from(n) * PI)) * 1_f64.copysign(sag)
        };
        Self::Wave(Box::new(Wave {
            reach,
            steepest: steepest.copysign(sag),
            mean: libm::j0(steepest),
            across: std::array::from_fn(across),
            away: std::array::from_fn(away),
        }))
    }

    /// Across the axis and away from the viewer.
    fn at(&self, t: f64) -> Vector2<f64> {
        match self {
            Self::Arc { curvature } if *curvature == 0.0 => Vector2::new(t, 0.0),
            Self::Arc { curvature } => {
                let turn = curvature * t;
                Vector2::new(libm::sin(turn), -2.0 * libm::sin(turn / 2.0).powi(2)) / *curvature
            }
            Self::Wave(wave) => {
                let phase = PI * t / wave.reach;
                let twice = 2.0 * libm::cos(phase);
                let mut sum = Vector2::new(wave.mean * t, 0.0);
                // sin((n + 1) φ) = 2 cos φ sin(n φ) − sin((n − 1) φ)
                let (mut before, mut sine) = (0.0, libm::sin(phase));
                for (a, b) in wave.across.iter().zip(&wave.away) {
                    sum.y += b * sine;
                    (before, sine) = (sine, twice * sine - before);
                    sum.x += a * sine;
                    (before, sine) = (sine, twice * sine - before);
                }
                sum
            }
        }
    }

    /// The angle of the tangent.
    fn slope(&self, t: f64) -> f64 {
        match self {
            Self::Arc { curvature } => -curvature * t,
            Self::Wave(wave) => wave.steepest * libm::cos(PI * t / wave.reach),
        }
    }

    /// Where the tangent has an angle, as far as `reach`; NaN and positions beyond it stand for none.
    fn tangent_at(&self, angle: f64) -> [f64; 2] {
        match self {
            Self::Arc { curvature } => [-angle / curvature, f64::NAN],
            Self::Wave(wave) => {
                let t = wave.reach / PI * libm::acos(angle / wave.steepest);
                [-t, t]
            }
        }
    }

    /// Where a straight line meets the curve within `reach` of the middle, unordered: at most one root between
    /// neighbouring places where the curve runs parallel to the line.
    fn meet(&self, origin: Vector2<f64>, direction: Vector2<f64>, reach: f64) -> impl Iterator<Item = f64> {
        let across = Vector2::new(-direction.y, direction.x).normalize();
        let off = |t: f64| across.dot(&(self.at(t) - origin));
        let mut ends = [f64::NAN; 4];
        let mut count = 1;
        ends[0] = -reach;
        for t in self.tangent_at(libm::atan(direction.y / direction.x)) {
            if t > ends[count - 1] && t < reach {
                ends[count] = t;
                count += 1;
            }
        }
        ends[count] = reach;
        let mut roots = [None; 3];
        let mut low = (ends[0], off(ends[0]));
        for (root, t) in roots.iter_mut().zip(&ends[1..=count]) {
            let high = (*t, off(*t));
            if (low.1 <= 0.0 && high.1 >= 0.0) || (low.1 >= 0.0 && high.1 <= 0.0) {
                let along = |t: f64| {
                    let angle = self.slope(t);
                    across.dot(&Vector2::new(libm::cos(angle), libm::sin(angle)))
                };
                *root = Some(zero(low, high, off, along));
            }
            low = high;
        }
        roots.into_iter().flatten()
    }
}

/// The zero of a function between two ends of different sign, by Newton's method, halving where that leaves the interval.
fn zero(
    low: (f64, f64),
    high: (f64, f64),
    value: impl Fn(f64) -> f64,
    derivative: impl Fn(f64) -> f64,
) -> f64 {
    let rises = high.1 > low.1;
    let (mut a, mut b) = (low.0, high.0);
    let mut t = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1)).clamp(0.0, 1.0);
    if t.is_nan() {
        return low.0;
    }
    for _ in 0..ROOT_STEPS {
        let f = value(t);
        if f == 0.0 {
            break;
        }
        if (f > 0.0) == rises {
            b = t;
        } else {
            a = t;
        }
        let newton = t - f / derivative(t);
        let next = if newton > a && newton < b { newton } else { f64::midpoint(a, b) };
        let step = (next - t).abs();
        t = next;
        if step <= ROUNDING * (a.abs() + b.abs()) {
            break;
        }
    }
    t
}

fn odd(k: usize) -> i32 {
    2 * k as i32 + 1
}

impl Profile {
    /// The point of a place across and along the axis, from the middle.
    fn point(&self, p: Vector2<f64>) -> Vector3<f64> {
        match self {
            Self::Cylinder { section, .. } => {
                let at = section.at(p.x);
                Vector3::new(at.x, p.y, at.y)
            }
            // The sides, and to second order all lines parallel to them, keep their lengths.
            Self::Twist { rate } => {
                let [x, y] = [rate * p.x, rate * p.y];
                Vector3::new(p.x * (1.0 - y * y / 2.0), p.y * (1.0 - x * x / 2.0), rate * p.x * p.y)
            }
        }
    }

    /// Its derivatives.
    fn tangents(&self, p: Vector2<f64>) -> [Vector3<f64>; 2] {
        match self {
            Self::Cylinder { section, .. } => {
                let angle = section.slope(p.x);
                [Vector3::new(libm::cos(angle), 0.0, libm::sin(angle)), Vector3::y()]
            }
            Self::Twist { rate } => {
                let [x, y] = [rate * p.x, rate * p.y];
                [Vector3::new(1.0 - y * y / 2.0, -x * y, y), Vector3::new(-x * y, 1.0 - x * x / 2.0, x)]
            }
        }
    }

    /// The places, and the distances in lengths of the direction, where a ray meets the surface.
    fn meet(&self, ray: &Ray) -> [Option<(Vector2<f64>, f64)>; 3] {
        let mut found = [None; 3];
        match self {
            Self::Cylinder { section, reach } => {
                let origin = Vector2::new(ray.origin.x, ray.origin.z);
                let direction = Vector2::new(ray.direction.x, ray.direction.z);
                let squared = direction.norm_squared();
                if squared == 0.0 {
                    return found;
                }
                for (place, t) in found.iter_mut().zip(section.meet(origin, direction, *reach)) {
                    let distance = (section.at(t) - origin).dot(&direction) / squared;
                    let along = ray.origin.y + ray.direction.y * distance;
                    *place = Some((Vector2::new(t, along), distance));
                }
            }
            Self::Twist { rate } => {
                for (place, start) in found.iter_mut().zip(saddle(*rate, ray)) {
                    *place = self.refined(ray, start);
                }
            }
        }
        found
    }

    /// Newton's method from a distance along the ray that is nearly right.
    fn refined(&self, ray: &Ray, start: f64) -> Option<(Vector2<f64>, f64)> {
        let at = ray.origin + ray.direction * start;
        let (mut p, mut distance) = (Vector2::new(at.x, at.y), start);
        for _ in 0..TWIST_STEPS {
            let off = self.point(p) - ray.origin.coords - ray.direction * distance;
            let [x, y] = self.tangents(p);
            let step = Matrix3::from_columns(&[x, y, -ray.direction]).try_inverse()? * off;
            p -= step.xy();
            distance -= step.z;
            if step.xy().norm() <= ROUNDING * (1.0 + p.norm()) {
                return Some((p, distance));
            }
        }
        // Rounding may go on for ever; what does not converge at all is far off.
        let off = self.point(p) - ray.origin.coords - ray.direction * distance;
        (off.norm() <= 1e-10 * (1.0 + p.norm())).then_some((p, distance))
    }
}

/// The distances at which a ray meets z = rate · x · y; where it passes by, the nearest.
fn saddle(rate: f64, ray: &Ray) -> [f64; 2] {
    let (o, d) = (ray.origin, ray.direction);
    let square = rate * d.x * d.y;
    let linear = rate * (o.x * d.y + o.y * d.x) - d.z;
    let constant = rate * o.x * o.y - o.z;
    let root = (linear * linear - 4.0 * square * constant).max(0.0).sqrt();
    // The sum of equal signs keeps its digits.
    let sum = -(linear + root.copysign(linear)) / 2.0;
    [constant / sum, sum / square]
}

impl BentSheet {
    /// A sheet with a bend.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) as [`BendConfig::validate`].
    pub fn new(bend: &BendConfig, size: RectangleSize) -> Result<Self> {
        bend.validate(size)?;
        let sag = bend.sag_mm(size);
        let angle = bend.axis_deg.to_radians();
        let turn = [libm::cos(angle), libm::sin(angle)];
        let reach = f64::midpoint(size.width_mm * turn[0].abs(), size.height_mm * turn[1].abs());
        let profile = match bend.kind {
            BendKind::Curl => Profile::Cylinder { section: Section::arc(sag, reach), reach },
            BendKind::Wave => Profile::Cylinder { section: Section::wave(sag, reach), reach },
            BendKind::Twist => Profile::Twist { rate: 4.0 * sag / (size.width_mm * size.height_mm) },
        };
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        let translation = Vector3::new(size.width_mm / 2.0, size.height_mm / 2.0, 0.0);
        let mut sheet = Self { size, profile, turn, sheet_from_profile: Pose { rotation, translation } };
        sheet.level();
        Ok(sheet)
    }

    /// Moves the mean plane to z = 0: over the flat sheet, z has no mean, no slope along the width, and none along the height.
    fn level(&mut self) {
        let middle = Point2::new(self.size.width_mm / 2.0, self.size.height_mm / 2.0);
        for _ in 0..LEVELLINGS {
            let (mut weights, mut height) = (0.0, 0.0);
            let (mut moments, mut products) = (Matrix2::zeros(), Vector2::zeros());
            for (weight, place) in self.nodes() {
                let (flat, z) = (place - middle, self.point(place).z);
                weights += weight;
                height += weight * z;
                moments += flat * flat.transpose() * weight;
                products += flat * (z * weight);
            }
            let pose = &mut self.sheet_from_profile;
            // The bend is symmetric to the middle, so that height and slopes do not depend on each other.
            let slopes = moments.try_inverse().map_or(Vector2::zeros(), |inverse| inverse * products);
            let normal = Vector3::new(-slopes.x, -slopes.y, 1.0);
            if let Some(back) = Rotation3::rotation_between(&normal, &Vector3::z()) {
                pose.rotation = back * pose.rotation;
            }
            pose.translation.z -= height / weights;
        }
    }

    /// Places all over the sheet with the weights of Simpson's rule.
    fn nodes(&self) -> impl Iterator<Item = (f64, Point2<f64>)> + use<> {
        let weight = |i: usize| match i {
            0 | INTERVALS => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let [w, h] = [self.size.width_mm, self.size.height_mm].map(|side| side / INTERVALS as f64);
        (0..=INTERVALS).flat_map(move |j| {
            (0..=INTERVALS).map(move |i| (weight(i) * weight(j), Point2::new(i as f64 * w, j as f64 * h)))
        })
    }

    /// The flat sheet.
    #[must_use]
    pub fn size(&self) -> RectangleSize {
        self.size
    }

    /// Across and along the axis, from the middle.
    fn place(&self, p: Point2<f64>) -> Vector2<f64> {
        let [c, s] = self.turn;
        let (x, y) = (p.x - self.size.width_mm / 2.0, p.y - self.size.height_mm / 2.0);
        Vector2::new(c * x + s * y, c * y - s * x)
    }

    /// The point of the bent sheet at a place of the flat one, mm.
    #[must_use]
    pub fn point(&self, p: Point2<f64>) -> Point3<f64> {
        self.sheet_from_profile.transform(&self.profile.point(self.place(p)).into())
    }

    /// The unit normal away from the viewer there.
    #[must_use]
    pub fn normal(&self, p: Point2<f64>) -> Vector3<f64> {
        self.normal_at(self.place(p))
    }

    fn normal_at(&self, p: Vector2<f64>) -> Vector3<f64> {
        let [x, y] = self.profile.tangents(p);
        self.sheet_from_profile.rotation * x.cross(&y).normalize()
    }

    /// The nearest point of the sheet on a ray, further than `after` and nearer than `before` in lengths of the ray's
    /// direction.
    #[must_use]
    pub fn meet(&self, ray: &Ray, [after, before]: [f64; 2]) -> Option<BentSheetHit> {
        let back = self.sheet_from_profile.inverse();
        let local = Ray { origin: back.transform(&ray.origin), direction: back.rotation * ray.direction };
        let [c, s] = self.turn;
        let (w, h) = (self.size.width_mm, self.size.height_mm);
        let mut best: Option<BentSheetHit> = None;
        for (p, distance) in self.profile.meet(&local).into_iter().flatten() {
            let place = Point2::new(c * p.x - s * p.y + w / 2.0, s * p.x + c * p.y + h / 2.0);
            let nearest = distance > after && distance < best.map_or(before, |b| b.distance);
            if nearest && (0.0..=w).contains(&place.x) && (0.0..=h).contains(&place.y) {
                best = Some(BentSheetHit { distance, place, normal: self.normal_at(p) });
            }
        }
        best
    }
}

#[cfg(test)]
#[path = "bent_sheet_tests.rs"]
mod tests;
