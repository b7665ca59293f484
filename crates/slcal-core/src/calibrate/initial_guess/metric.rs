//! Focal length and pose of one device from homographies of a rectangle of known size.
//!
//! With H = [h1 h2 h3] from millimetres to pixels centred on the principal point, h1 = (a1, a2, a3), h2 = (b1, b2, b3):
//!
//! ```text
//! orthogonality:  (a1 b1 + a2 b2)/f² + a3 b3 = 0
//! equal scale:    (a1² + a2² − b1² − b2²)/f² + (a3² − b3²) = 0
//! ```
//!
//! The first is eq. (7) of R. Orghidan et al., "Structured light self-calibration with vanishing points", Machine Vision
//! and Applications 25:489-500 (2014); both are Z. Zhang's, "A flexible new technique for camera calibration", PAMI 22
//! (2000). Precondition: square pixels, no skew, no distortion, the principal point known.

use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Homography;
use nalgebra::{Matrix3, Point2, Vector2};

/// The two constraints as (coefficient of 1/f², constant), each row of unit noise to first order.
///
/// Noise of the same size in every coordinate of h1 and h2 disturbs the second constraint twice as much as the first, so
/// that one counts half. H is scaled so that |h1|² + |h2|² = 2 in the image plane, which makes homographies comparable.
pub(crate) fn constraints(centred: &Homography) -> [Vector2<f64>; 2] {
    let [h1, h2, _] = centred.columns();
    let scale = 2.0 / (h1.xy().norm_squared() + h2.xy().norm_squared());
    let orthogonality = Vector2::new(h1.xy().dot(&h2.xy()), h1.z * h2.z);
    let equal_scale =
        Vector2::new(h1.xy().norm_squared() - h2.xy().norm_squared(), h1.z * h1.z - h2.z * h2.z);
    [orthogonality * scale, equal_scale * (scale / 2.0)]
}

/// Moves the origin of the image to the principal point.
pub(crate) fn centred(h: &Homography, principal_point: Point2<f64>) -> Homography {
    let mut shift = Matrix3::identity();
    shift[(0, 2)] = -principal_point.x;
    shift[(1, 2)] = -principal_point.y;
    Homography(shift * h.0)
}

/// f² from the constraints of one or more homographies (of one device, image origin at the principal point): weighted
/// least squares in 1/f², which leaves a degenerate constraint (both coefficients zero) without influence. When noise
/// makes that negative, each constraint is solved alone, the better determined first.
///
/// # Errors
/// [`Error::ImaginaryFocal`] when no constraint has a real solution; [`Error::Degenerate`] when all are empty (every
/// sheet exactly face-on).
pub(crate) fn focal_from_homographies(homographies: &[Homography], device: ErrorSubject) -> Result<f64> {
    let rows: Vec<Vector2<f64>> = homographies.iter().flat_map(constraints).collect();
    let quadratic: f64 = rows.iter().map(|c| c.x * c.x).sum();
    let mixed: f64 = rows.iter().map(|c| c.x * c.y).sum();
    let inverse = -mixed / quadratic;
    if inverse > 0.0 && inverse.is_finite() {
        return Ok(inverse.sqrt().recip());
    }
    let alone = rows
        .iter()
        .filter(|c| -c.y / c.x > 0.0 && (c.y / c.x).is_finite())
        .max_by(|a, b| a.x.abs().total_cmp(&b.x.abs()));
    if let Some(c) = alone {
        return Ok((-c.x / c.y).sqrt());
    }
    if inverse == 0.0 || !inverse.is_finite() {
        return Err(Error::Degenerate {
            what: ErrorSubject::FocalLength,
            measure: mixed.abs(),
            limit: 0.0,
            advice: "the sheet is seen exactly face-on: tilt it".into(),
        });
    }
    Err(imaginary(device, 1.0 / inverse))
}

/// The error for a negative f², with what usually causes it.
pub(crate) fn imaginary(device: ErrorSubject, f_squared: f64) -> Error {
    let advice = if device == ErrorSubject::Camera {
        "no lens with this principal point sees the sheet like that; check the sheet's size (are width and height \
         swapped?) and its corners, and tilt the sheet about both axes"
    } else {
        "no lens with this principal point throws the pattern like that: it is not where it was assumed (lens shift is \
         usual); use the maximum-likelihood method with the rule 'shift', and tilt the sheet about both axes"
    };
    Error::ImaginaryFocal { device, f_squared, advice: advice.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::planar_pose::pose_from_homography;
    use crate::geometry::{Intrinsics, Pose};
    use nalgebra::{Rotation3, Vector3};

    fn view(tilt_x: f64, tilt_y: f64) -> (Homography, Pose) {
        let rotation = Rotation3::from_euler_angles(tilt_x.to_radians(), tilt_y.to_radians(), 0.1);
        let pose = Pose { rotation, translation: Vector3::new(-200.0, -150.0, 1000.0) };
        let k = Intrinsics::square(1500.0, Point2::origin()).matrix();
        let r = pose.rotation.matrix();
        let columns = [r.column(0).into_owned(), r.column(1).into_owned(), pose.translation];
        (Homography(k * Matrix3::from_columns(&columns) * -3e-4), pose)
    }

    #[test]
    fn exact_homographies_give_focal_length_and_pose() {
        for (x, y) in [(25.0, 28.0), (30.0, 0.0), (0.0, 30.0), (-5.0, 5.0), (3.0, -1.0)] {
            let (h, truth) = view(x, y);
            let f = focal_from_homographies(&[h], ErrorSubject::Camera).unwrap();
            assert!((f - 1500.0).abs() < 1e-6, "{x} {y}: {f}");
            let pose =
                pose_from_homography(&h, &Intrinsics::square(f, Point2::origin()), Point2::origin()).unwrap();
            assert!((pose.rotation.matrix() - truth.rotation.matrix()).norm() < 1e-9);
            assert!((pose.translation - truth.translation).norm() < 1e-6);
        }
    }

    #[test]
    fn face_on_is_refused_and_a_negative_square_is_imaginary() {
        let (h, _) = view(0.0, 0.0);
        assert!(focal_from_homographies(&[h], ErrorSubject::Camera).is_err());
        let mut wrong = view(20.0, 20.0).0;
        wrong.0.row_mut(2).columns_mut(0, 1).neg_mut();
        let only_orthogonality = constraints(&wrong)[0];
        assert!(only_orthogonality.x * only_orthogonality.y > 0.0);
    }
}
