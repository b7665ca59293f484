//! Residuals of the joint problem and their derivatives, all in camera pixels.
//!
//! A lens has eight parameters in the order [ln f, cx, cy, k1, k2, p1, p2, k3] (fx, fy and skew scale with f); a pose
//! `a_from_b` has six, [ω, t], where ω turns it about a's axes: R ← exp(ω)·R.

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Point2, Point3, SMatrix, SVector, Vector2, Vector3};

use crate::geometry::{Camera, Distortion, Pose, RectangleSize, Side};
use crate::parameter::{LensParameter, PoseParameter};

/// Number of parameters of a lens.
pub(crate) const LENS: usize = LensParameter::ALL.len();
/// Number of parameters of a pose.
pub(crate) const POSE: usize = PoseParameter::ALL.len();

type Lens2 = SMatrix<f64, 2, LENS>;
type Pose2 = SMatrix<f64, 2, POSE>;

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
}

impl Residual {
    /// A residual of the camera and the sheet alone.
    fn of_sheet(value: Vector2<f64>, miss: Vector2<f64>, camera: Lens2, view: Pose2) -> Self {
        let lenses = [camera, Lens2::zeros()];
        Self { value, miss, lenses, projector_from_camera: Pose2::zeros(), view }
    }
}

/// Derivatives of m·D(x)·u by x and by (k1, k2, p1, p2, k3), where D is the distortion's Jacobian at x.
fn slope_jacobian(
    d: &Distortion,
    x: Vector2<f64>,
    m: Vector2<f64>,
    u: Vector2<f64>,
) -> (Vector2<f64>, SVector<f64, 5>) {
    let r2 = x.norm_squared();
    let (mu, mx, xu) = (m.dot(&u), m.dot(&x), x.dot(&u));
    // The radial factor's first and second derivative by r².
    let slope = d.k1 + r2 * (2.0 * d.k2 + 3.0 * r2 * d.k3);
    let bend = 2.0 * d.k2 + 6.0 * r2 * d.k3;
    // What p1 and p2 are multiplied by, linear in x.
    let cross = |x: Vector2<f64>| 2.0 * (x.x * u.y + x.y * u.x);
    let p1 = |x: Vector2<f64>| m.x * cross(x) + m.y * (2.0 * x.dot(&u) + 4.0 * x.y * u.y);
    let p2 = |x: Vector2<f64>| m.x * (2.0 * x.dot(&u) + 4.0 * x.x * u.x) + m.y * cross(x);
    let linear = |f: &dyn Fn(Vector2<f64>) -> f64| Vector2::new(f(Vector2::x()), f(Vector2::y()));
    let radial = x * (2.0 * slope * mu + 4.0 * bend * mx * xu) + (m * xu + u * mx) * (2.0 * slope);
    let by_x = radial + linear(&p1) * d.p1 + linear(&p2) * d.p2;
    let of_power = |n: i32| r2.powi(n) * mu + 2.0 * f64::from(n) * r2.powi(n - 1) * mx * xu;
    (by_x, SVector::from([of_power(1), of_power(2), p1(x), p2(x), of_power(3)]))
}

/// The 2×2 part of K.
fn k2(camera: &Camera) -> Matrix2<f64> {
    let k = &camera.intrinsics;
    Matrix2::new(k.fx, k.skew, 0.0, k.fy)
}

/// Pixel of a point in the device frame, with derivatives by the point and the lens; `None` behind the device.
fn project(camera: &Camera, p: &Point3<f64>) -> Option<(Point2<f64>, Matrix2x3<f64>, Lens2)> {
    if p.z.is_nan() || p.z <= 0.0 {
        return None;
    }
    let x = Vector2::new(p.x / p.z, p.y / p.z);
    let xd = camera.distortion.distort(x);
    let k = k2(camera);
    let by_ideal = k * camera.distortion.jacobian(x);
    let ideal_by_point = Matrix2x3::new(1.0, 0.0, -x.x, 0.0, 1.0, -x.y) / p.z;
    let mut lens = Lens2::zeros();
    lens.set_column(0, &(k * xd));
    lens.fixed_view_mut::<2, 2>(0, 1).fill_with_identity();
    lens.fixed_view_mut::<2, 5>(0, 3).copy_from(&(k * Distortion::coefficient_jacobian(x)));
    Some((camera.intrinsics.pixel(xd), by_ideal * ideal_by_point, lens))
}

/// Ideal normalized point of a pixel, with derivatives by the pixel and the lens.
fn unproject(camera: &Camera, p: Point2<f64>) -> Option<(Vector2<f64>, Matrix2<f64>, Lens2)> {
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
    Some((x, by_pixel, lens))
}

/// Distance of an edge point from the image of a side, px: g(p)/|∇g(p)|, where g is the side's line at the undistorted
/// point. Exact without distortion; with it, of first order in the distance (P. D. Sampson, 1982).
///
/// With n the line's normal at the undistorted x, D the distortion's Jacobian there and ∇g = K⁻ᵀD⁻ᵀn, ∇g changes with the
/// line, with f (in proportion to 1/f) and with D: ∇g·d(∇g) = −(D⁻ᵀn)·dD·(D⁻¹K⁻¹∇g).
pub(crate) fn edge(
    camera: &Camera,
    camera_from_sheet: &Pose,
    size: RectangleSize,
    side: Side,
    p: Point2<f64>,
) -> Option<Residual> {
    let corners = size.corners();
    let (from, to) = (corners[side as usize], corners[(side as usize + 1) % 4]);
    let along = (to - from).normalize();
    let arm = camera_from_sheet.rotation * Vector3::new(from.x, from.y, 0.0);
    let start = arm + camera_from_sheet.translation;
    let e = camera_from_sheet.rotation * Vector3::new(along.x, along.y, 0.0);
    let line = start.cross(&e);
    let (x, by_pixel, lens) = unproject(camera, p)?;
    let point = Vector3::new(x.x, x.y, 1.0);
    let gradient = by_pixel.transpose() * line.xy();
    let norm = gradient.norm();
    let value = line.dot(&point) / norm;
    if !value.is_finite() {
        return None;
    }
    let mut by_line = point;
    let shrink = by_pixel * gradient * (value / norm);
    by_line.x -= shrink.x;
    by_line.y -= shrink.y;
    let by_line = by_line.transpose() / norm;
    let turn = e.cross_matrix() * arm.cross_matrix() - start.cross_matrix() * e.cross_matrix();
    let mut view = Pose2::zeros();
    view.fixed_view_mut::<1, 3>(0, 0).copy_from(&(by_line * turn));
    view.fixed_view_mut::<1, 3>(0, 3).copy_from(&(-by_line * e.cross_matrix()));
    let mut by_lens = (line.xy().transpose() * lens / norm).transpose();
    by_lens[0] += value;
    let (by_x, by_coefficients) =
        slope_jacobian(&camera.distortion, x, k2(camera).transpose() * gradient, by_pixel * gradient);
    let change = value / (norm * norm);
    by_lens += lens.transpose() * by_x * change;
    by_lens.fixed_rows_mut::<5>(3).axpy(change, &by_coefficients, 1.0);
    let mut camera = Lens2::zeros();
    camera.set_row(0, &by_lens.transpose());
    Some(Residual::of_sheet(Vector2::new(value, 0.0), gradient * (-value / norm), camera, view))
}

/// A corner of the sheet: expected minus seen, px.
pub(crate) fn sheet_corner(
    camera: &Camera,
    camera_from_sheet: &Pose,
    corner: Point2<f64>,
    seen: Point2<f64>,
) -> Option<Residual> {
    let arm = camera_from_sheet.rotation * Vector3::new(corner.x, corner.y, 0.0);
    let (pixel, by_point, lens) = project(camera, &Point3::from(arm + camera_from_sheet.translation))?;
    let mut view = Pose2::zeros();
    view.fixed_view_mut::<2, 3>(0, 0).copy_from(&(-by_point * arm.cross_matrix()));
    view.fixed_view_mut::<2, 3>(0, 3).copy_from(&by_point);
    Some(Residual::of_sheet(pixel - seen, pixel - seen, lens, view))
}

/// Where the light of a projector pixel falls on the sheet, in the camera frame; `None` when it misses the plane.
pub(crate) fn lit_point(
    projector: &Camera,
    projector_from_camera: &Pose,
    camera_from_sheet: &Pose,
    q: Point2<f64>,
) -> Option<Point3<f64>> {
    let camera_from_projector = projector_from_camera.inverse();
    let centre = camera_from_projector.translation;
    let ray = camera_from_projector.rotation * projector.bearing(q)?;
    let normal = camera_from_sheet.rotation * Vector3::z();
    let s = normal.dot(&(camera_from_sheet.translation - centre)) / normal.dot(&ray);
    (s > 0.0 && s.is_finite()).then(|| Point3::from(centre + ray * s))
}

/// A projected corner: the exact projector pixel `q` is cast onto the sheet and seen by the camera; expected minus seen,
/// camera px.
///
/// With c the projector's centre and m the ray in the camera frame, n the sheet's normal and t its origin,
/// X = c + s·m, s = n·(t − c)/(n·m), so dX = u + m·(dn·(t − X) + n·(dt − u))/(n·m) with u = dc + s·dm.
pub(crate) fn projected_corner(
    camera: &Camera,
    projector: &Camera,
    projector_from_camera: &Pose,
    camera_from_sheet: &Pose,
    q: Point2<f64>,
    seen: Point2<f64>,
) -> Option<Residual> {
    let back = projector_from_camera.rotation.inverse();
    let (x, _, by_lens) = unproject(projector, q)?;
    let bearing = Vector3::new(x.x, x.y, 1.0);
    let ray = back * bearing;
    let centre = -(back * projector_from_camera.translation);
    let normal = camera_from_sheet.rotation * Vector3::z();
    let along = normal.dot(&ray);
    let s = normal.dot(&(camera_from_sheet.translation - centre)) / along;
    if !(s > 0.0 && s.is_finite()) {
        return None;
    }
    let point = Point3::from(centre + ray * s);
    let (pixel, by_point, lens) = project(camera, &point)?;
    // How the point follows the ray (u) and the plane.
    let by_ray = by_point * (Matrix3::identity() - ray * normal.transpose() / along);
    let by_plane = by_point * ray / along;
    let back = back.matrix();
    let arm = camera_from_sheet.translation - point.coords;
    let mut view = Pose2::zeros();
    view.fixed_view_mut::<2, 3>(0, 0).copy_from(&(by_plane * normal.cross(&arm).transpose()));
    view.fixed_view_mut::<2, 3>(0, 3).copy_from(&(by_plane * normal.transpose()));
    // u = −s Rᵀ(ω×b) + Rᵀ(ω×t) − Rᵀ dt = Rᵀ[s b − t]× ω − Rᵀ dt
    let lever = bearing * s - projector_from_camera.translation;
    let mut stereo = Pose2::zeros();
    stereo.fixed_view_mut::<2, 3>(0, 0).copy_from(&(by_ray * back * lever.cross_matrix()));
    stereo.fixed_view_mut::<2, 3>(0, 3).copy_from(&(-(by_ray * back)));
    let back_xy = back.fixed_view::<3, 2>(0, 0).into_owned();
    let lenses = [lens, by_ray * back_xy * by_lens * s];
    let value = pixel - seen;
    Some(Residual { value, miss: value, lenses, projector_from_camera: stereo, view })
}
