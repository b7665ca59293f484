//! One device from two vanishing points, as published: R. Orghidan, J. Salvi, M. Gordan, C. Florea, J. Batlle,
//! "Structured light self-calibration with vanishing points", Machine Vision and Applications 25:489-500 (2014),
//! sections 2.1 and 2.2.
//!
//! ```text
//! V_x = top × bottom, V_y = left × right                      (homogeneous)
//! f²  = |O_c V_i|² − |O V_i|² = −(v1x v2x + v1y v2y)/(v1w v2w)      eq. (5) to (7), relative to the principal point
//! D   = |O_c P1'| · |P1P2| / |P1'Q|,  t = D · O_cP1'/|O_cP1'|         eq. (11)
//! P2' = (P1'V_x) ∩ (P2 V_y), P4' = (P4 V_x) ∩ (P1 V_y), P3' = (P4'V_x) ∩ (P2'V_y)     eq. (14)
//! ```
//!
//! (Slips in print: the sentence before eq. (5) calls O_cV_i O_iV_i; under the root in (7) stands f², not f.)
//!
//! Precondition: square pixels, no distortion, an exactly known principal point, and a sheet tilted about both axes: only
//! the orthogonality of the sheet's sides is used, which determines nothing when one of them is parallel to the image.

mod closed_form;
pub(crate) mod rig;
pub(crate) mod sigma;

use nalgebra::{Matrix2x3, Matrix3, Point2, Point3, Vector3};

use crate::calibrate::initial_guess::metric::imaginary;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{
    Camera, Homography, Line, Pose, ProjectivePoint, RectangleSize, VanishingPoints, nearest_rotation,
};
use crate::solve::{Block, Linearised, Loss, Problem, Structure, minimise};

type Quad = [Point2<f64>; 4];

/// The vanishing points of a quadrilateral TL, TR, BR, BL that is the image of a rectangle.
pub(crate) fn vanishing_points(q: &[ProjectivePoint; 4]) -> VanishingPoints {
    let side = |a: usize, b: usize| Line::through(q[a], q[b]);
    VanishingPoints { x: side(0, 1).meet(side(3, 2)), y: side(0, 3).meet(side(1, 2)) }
}

/// The same for finite corners, without the cancellation that far-off pixels bring.
pub(crate) fn vanishing_points_of_quad(q: &Quad) -> VanishingPoints {
    let side = |a: usize, b: usize| Line::through_pixels(q[a], q[b]);
    VanishingPoints { x: side(0, 1).meet(side(3, 2)), y: side(0, 3).meet(side(1, 2)) }
}

/// f from the vanishing points of two orthogonal directions, the product signed.
///
/// # Errors
/// [`Error::ImaginaryFocal`] when f² is negative; [`Error::Degenerate`] when a vanishing point is at infinity.
pub(crate) fn focal(v: &VanishingPoints, principal_point: Point2<f64>, device: ErrorSubject) -> Result<f64> {
    let (a, b) = (v.x.relative_to(principal_point).0, v.y.relative_to(principal_point).0);
    let f_squared = -(a.x * b.x + a.y * b.y) / (a.z * b.z);
    if f_squared.is_finite() && f_squared > 0.0 {
        return Ok(f_squared.sqrt());
    }
    if f_squared.is_finite() {
        return Err(imaginary(device, f_squared));
    }
    Err(Error::Degenerate {
        what: ErrorSubject::Named("the focal length from vanishing points"),
        measure: (a.z * b.z).abs(),
        limit: 0.0,
        advice: "a side of the sheet is parallel to the image: tilt it about both axes, or use the maximum-likelihood \
                 method"
            .into(),
    })
}

/// Rotation device ← sheet; the sign of each axis is the one in which the sheet's corners are seen.
pub(crate) fn rotation(
    v: &VanishingPoints,
    f: f64,
    principal_point: Point2<f64>,
    corners: &Quad,
) -> Option<Matrix3<f64>> {
    let tl = corners[0] - principal_point;
    let axis = |v: ProjectivePoint, towards: Point2<f64>| {
        let v = v.relative_to(principal_point).0;
        let r = Vector3::new(v.x / f, v.y / f, v.z).try_normalize(f64::MIN_POSITIVE)?;
        let moves = r.xy() * f - tl * r.z;
        Some(if moves.dot(&(towards - corners[0])) > 0.0 { r } else { -r })
    };
    let (r1, r2) = (axis(v.x, corners[1])?, axis(v.y, corners[3])?);
    nearest_rotation(&Matrix3::from_columns(&[r1, r2, r1.cross(&r2)])).map(|r| *r.matrix())
}

/// Translation by similar triangles on the top side (eq. 11).
pub(crate) fn translation(
    r: &Matrix3<f64>,
    f: f64,
    principal_point: Point2<f64>,
    corners: &Quad,
    size: RectangleSize,
) -> Option<Vector3<f64>> {
    let ray = |p: Point2<f64>| Vector3::new(p.x - principal_point.x, p.y - principal_point.y, f);
    let (start, other) = (ray(corners[0]), ray(corners[1]));
    let along = r.column(0).into_owned();
    // Q on the shifted segment's line, nearest to the ray of P2 (with noise the two are skew).
    let n = other.normalize();
    let across = |x: Vector3<f64>| x - n * n.dot(&x);
    let (a, b) = (across(along), across(start));
    let to_q = -a.dot(&b) / a.norm_squared();
    let distance = start.norm() * size.width_mm / to_q.abs();
    let t = start.normalize() * distance;
    t.iter().all(|x| x.is_finite()).then_some(t)
}

/// Reprojection of the sheet's corners as a function of the translation alone.
struct Translation<'a> {
    camera: &'a Camera,
    rotation: Matrix3<f64>,
    corners: &'a Quad,
    size: RectangleSize,
    blocks: Vec<Block>,
}

impl Problem for Translation<'_> {
    type State = Vector3<f64>;

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn structure(&self) -> Structure<'_> {
        Structure::dense(3)
    }

    fn linearise(&self, t: &Vector3<f64>, at: &mut Linearised) -> Option<()> {
        let f = self.camera.intrinsics.fx;
        for (i, (c, seen)) in self.size.corners().iter().zip(self.corners).enumerate() {
            let p = self.rotation * Vector3::new(c.x, c.y, 0.0) + t;
            let off = self.camera.project(&Point3::from(p))? - seen;
            at.residuals.fixed_rows_mut::<2>(2 * i).copy_from(&off);
            let s = f / p.z;
            let by_t = Matrix2x3::new(s, 0.0, -s * p.x / p.z, 0.0, s, -s * p.y / p.z);
            at.jacobian.fixed_view_mut::<2, 3>(2 * i, 0).copy_from(&by_t);
        }
        Some(())
    }

    fn step(&self, t: &Vector3<f64>, delta: &nalgebra::DVector<f64>) -> Option<Vector3<f64>> {
        Some(t + delta.fixed_rows::<3>(0))
    }
}

/// The pose of the sheet: rotation from the vanishing points, translation by similar triangles, then refined by
/// Levenberg–Marquardt on the reprojection of the corners (square pixels, no distortion).
///
/// # Errors
/// [`Error::Degenerate`] when the corners do not determine it.
pub(crate) fn pose(
    camera: &Camera,
    v: &VanishingPoints,
    corners: &Quad,
    size: RectangleSize,
) -> Result<Pose> {
    let failed = || Error::Degenerate {
        what: ErrorSubject::Named("the pose from vanishing points"),
        measure: 0.0,
        limit: 0.0,
        advice: "check the corners of the sheet and their order".into(),
    };
    let (f, pp) = (camera.intrinsics.fx, camera.intrinsics.principal_point());
    let r = rotation(v, f, pp, corners).ok_or_else(failed)?;
    let start = translation(&r, f, pp, corners, size).ok_or_else(failed)?;
    let blocks = vec![Block { len: 2, loss: Loss::Square }; 4];
    let problem = Translation { camera, rotation: r, corners, size, blocks };
    let t = minimise(&problem, start).map_or(start, |m| m.state);
    Ok(Pose { rotation: nalgebra::Rotation3::from_matrix_unchecked(r), translation: t })
}

/// Keystone removal (eq. 14): the quadrilateral P1'..P4' in the camera image that is a rectangle aligned with the sheet,
/// from the projected pattern's outer corners P1..P4 (TL, TR, BR, BL) in the camera image. All joins and meets, so it
/// also holds with a vanishing point at infinity.
pub(crate) fn keystone_removed(outline: &Quad, v: &VanishingPoints) -> [ProjectivePoint; 4] {
    let p = outline.map(ProjectivePoint::from_pixel);
    let p2 = Line::through(p[0], v.x).meet(Line::through(p[1], v.y));
    let p4 = Line::through(p[3], v.x).meet(Line::through(p[0], v.y));
    let p3 = Line::through(p4, v.x).meet(Line::through(p2, v.y));
    [p[0], p2, p3, p4].map(unit)
}

/// Scale means nothing: bring it to one before the next product.
fn unit(p: ProjectivePoint) -> ProjectivePoint {
    ProjectivePoint(p.0 / p.0.norm())
}

/// The pattern to project so that it appears as a rectangle aligned with the sheet: eq. 14 mapped back to the projector.
pub(crate) fn rectified_pattern(
    outline: &Quad,
    v: &VanishingPoints,
    projector_from_camera: &Homography,
) -> [ProjectivePoint; 4] {
    keystone_removed(outline, v).map(|p| unit(projector_from_camera.apply(p)))
}

#[cfg(test)]
mod tests;
