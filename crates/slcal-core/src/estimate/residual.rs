//! Residuals of the joint problem and their derivatives, all in camera pixels.
//!
//! A lens has nine parameters in the order [ln f, cx, cy, k1, k2, p1, p2, k3, ln(fy/fx)] (fx, fy and skew scale with f); a pose
//! `a_from_b` has six, [ω, t], where ω turns it about a's axes: R ← exp(ω)·R; the bend of a sheet has twelve coefficients.

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Point2, Point3, SMatrix, Vector2, Vector3};

use super::sheet::Sheet;
use crate::geometry::{Camera, Distortion, Pose, SheetBend, Terms};
use crate::parameter::{LensParameter, PoseParameter};

/// Number of parameters of a lens.
pub(crate) const LENS: usize = LensParameter::ALL.len();
/// Number of parameters of a pose.
pub(crate) const POSE: usize = PoseParameter::ALL.len();
/// Number of parameters of a sheet's bend.
pub(crate) const BEND: usize = SheetBend::DEGREES.len();

pub(super) type Lens2 = SMatrix<f64, 2, LENS>;
pub(super) type Pose2 = SMatrix<f64, 2, POSE>;
type Bend2 = SMatrix<f64, 2, BEND>;

/// A residual and its derivatives; those that do not apply are zero, as is the second row of an edge point.
pub(crate) struct Residual {
    /// px.
    pub(crate) value: Vector2<f64>,
    /// From where it was seen to where it is expected, px.
    pub(crate) miss: Vector2<f64>,
    /// By the parameters of camera and projector.
    pub(crate) lenses: [Lens2; 2],
    pub(crate) projector_from_camera: Pose2,
    pub(crate) view: Pose2,
    pub(crate) bend: Bend2,
}

/// The 2×2 part of K.
fn k2(camera: &Camera) -> Matrix2<f64> {
    let k = &camera.intrinsics;
    Matrix2::new(k.fx, k.skew, 0.0, k.fy)
}

/// Pixel of a point in the device frame, with derivatives by the point; `None` behind the device and where its distortion
/// folds over.
pub(super) fn image(camera: &Camera, p: &Point3<f64>) -> Option<(Point2<f64>, Matrix2x3<f64>)> {
    if p.z.is_nan() || p.z <= 0.0 {
        return None;
    }
    let x = Vector2::new(p.x / p.z, p.y / p.z);
    let distorted = camera.distortion.jacobian(x);
    if distorted.determinant() <= 0.0 {
        return None;
    }
    let ideal_by_point = Matrix2x3::new(1.0, 0.0, -x.x, 0.0, 1.0, -x.y) / p.z;
    let pixel = camera.intrinsics.pixel(camera.distortion.distort(x));
    Some((pixel, k2(camera) * distorted * ideal_by_point))
}

/// The same with the derivatives by the lens.
pub(super) fn project(camera: &Camera, p: &Point3<f64>) -> Option<(Point2<f64>, Matrix2x3<f64>, Lens2)> {
    let (pixel, by_point) = image(camera, p)?;
    let x = Vector2::new(p.x / p.z, p.y / p.z);
    let xd = camera.distortion.distort(x);
    let k = k2(camera);
    let mut lens = Lens2::zeros();
    lens.set_column(0, &(k * xd));
    lens.fixed_view_mut::<2, 2>(0, 1).fill_with_identity();
    lens.fixed_view_mut::<2, 5>(0, 3).copy_from(&(k * Distortion::coefficient_jacobian(x)));
    lens[(1, LensParameter::Aspect as usize)] = camera.intrinsics.fy * xd.y;
    Some((pixel, by_point, lens))
}

/// Ideal normalized point of a pixel, with derivatives by the lens.
fn unproject(camera: &Camera, p: Point2<f64>) -> Option<(Vector2<f64>, Lens2)> {
    let xd = camera.intrinsics.normalized(p);
    let x = camera.distortion.undistort(xd)?;
    let inverse = if camera.distortion == Distortion::NONE {
        Matrix2::identity()
    } else {
        camera.distortion.jacobian(x).try_inverse()?
    };
    let by_pixel = inverse * k2(camera).try_inverse()?;
    let mut lens = Lens2::zeros();
    lens.set_column(0, &(-(inverse * xd)));
    lens.fixed_view_mut::<2, 2>(0, 1).copy_from(&-by_pixel);
    lens.fixed_view_mut::<2, 5>(0, 3).copy_from(&-(inverse * Distortion::coefficient_jacobian(x)));
    lens.set_column(LensParameter::Aspect as usize, &(-by_pixel.column(1) * camera.intrinsics.fy * xd.y));
    Some((x, lens))
}

/// How a point that is fixed to the sheet moves with the sheet's pose and bend.
pub(super) struct OnSheet {
    pub(super) point: Point3<f64>,
    pub(super) view: SMatrix<f64, 3, POSE>,
    pub(super) bend: SMatrix<f64, 3, BEND>,
}

/// A point of the sheet (mm) in the camera frame, given where it lies in the sheet's frame and the derivatives of its shift in the
/// sheet's plane.
pub(super) fn on_sheet(sheet: &Sheet, at: Point2<f64>, place: Point3<f64>, shift: [Terms; 2]) -> OnSheet {
    let rotation = sheet.pose.rotation.matrix();
    let arm = rotation * place.coords;
    let mut view = SMatrix::<f64, 3, POSE>::zeros();
    view.fixed_view_mut::<3, 3>(0, 0).copy_from(&-arm.cross_matrix());
    view.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
    let [x, y] = shift;
    let z = SheetBend::by_terms(sheet.size, at);
    let local = SMatrix::<f64, 3, BEND>::from_rows(&[x, y, z].map(|terms| terms.transpose()));
    OnSheet { point: Point3::from(arm + sheet.pose.translation), view, bend: rotation * local }
}

/// A corner of the sheet: expected minus seen, px.
pub(crate) fn sheet_corner(
    camera: &Camera,
    sheet: &Sheet,
    corner: Point2<f64>,
    seen: Point2<f64>,
) -> Option<Residual> {
    let shift = sheet.bend.shortening(sheet.size, corner).by_terms;
    let OnSheet { point, view, bend } = on_sheet(sheet, corner, sheet.bend.point(sheet.size, corner), shift);
    let (pixel, by_point, lens) = project(camera, &point)?;
    Some(Residual {
        value: pixel - seen,
        miss: pixel - seen,
        lenses: [lens, Lens2::zeros()],
        projector_from_camera: Pose2::zeros(),
        view: by_point * view,
        bend: by_point * bend,
    })
}

/// Where the light of a projector pixel falls on the sheet, in the camera frame; `None` when it misses it.
pub(crate) fn lit_point(
    projector: &Camera,
    projector_from_camera: &Pose,
    sheet: &Sheet,
    q: Point2<f64>,
) -> Option<Point3<f64>> {
    let camera_from_projector = projector_from_camera.inverse();
    let centre = camera_from_projector.translation;
    let ray = camera_from_projector.rotation * projector.bearing(q)?;
    sheet.meet(Point3::from(centre), ray).map(|hit| hit.point)
}

/// A projected corner: the exact projector pixel `q` is cast onto the sheet and seen by the camera; expected minus seen,
/// camera px.
///
/// With c the projector's centre and m the ray in the camera frame, the sheet's surface z − h(x, y) = 0 with the normal
/// n = R·(−h_x, −h_y, 1) at the point X = c + s·m: dX = u + m·(n·(dω×(t − X)) + n·(dt − u) + dh)/(n·m) with u = dc + s·dm.
pub(crate) fn projected_corner(
    camera: &Camera,
    projector: &Camera,
    projector_from_camera: &Pose,
    sheet: &Sheet,
    q: Point2<f64>,
    seen: Point2<f64>,
) -> Option<Residual> {
    let back = projector_from_camera.rotation.inverse();
    let (x, by_lens) = unproject(projector, q)?;
    let bearing = Vector3::new(x.x, x.y, 1.0);
    let ray = back * bearing;
    let centre = -(back * projector_from_camera.translation);
    let hit = sheet.meet(Point3::from(centre), ray)?;
    let along = hit.normal.dot(&ray);
    let (pixel, by_point, lens) = project(camera, &hit.point)?;
    // How the point follows the ray (u) and the surface.
    let by_ray = by_point * (Matrix3::identity() - ray * hit.normal.transpose() / along);
    let by_surface = by_point * ray / along;
    let back = back.matrix();
    let arm = sheet.pose.translation - hit.point.coords;
    let mut view = Pose2::zeros();
    view.fixed_view_mut::<2, 3>(0, 0).copy_from(&(by_surface * hit.normal.cross(&arm).transpose()));
    view.fixed_view_mut::<2, 3>(0, 3).copy_from(&(by_surface * hit.normal.transpose()));
    // u = −s Rᵀ(ω×b) + Rᵀ(ω×t) − Rᵀ dt = Rᵀ[s b − t]× ω − Rᵀ dt
    let lever = bearing * hit.along - projector_from_camera.translation;
    let mut stereo = Pose2::zeros();
    stereo.fixed_view_mut::<2, 3>(0, 0).copy_from(&(by_ray * back * lever.cross_matrix()));
    stereo.fixed_view_mut::<2, 3>(0, 3).copy_from(&(-(by_ray * back)));
    let back_xy = back.fixed_view::<3, 2>(0, 0).into_owned();
    let lenses = [lens, by_ray * back_xy * by_lens * hit.along];
    let value = pixel - seen;
    let bend = by_surface * hit.terms.transpose();
    Some(Residual { value, miss: value, lenses, projector_from_camera: stereo, view, bend })
}
