//! Focal length and vertical principal point of a projector with lens shift, cx known, in closed form.
//!
//! With H = [h1 h2 h3] from the sheet (mm) to the projector (uncentred px) and S = cx² + cy² + f², orthogonality and
//! equal scale of the sheet's axes are linear in cy and S:
//!
//! ```text
//! a1b1 + a2b2 − cx(a1b3 + a3b1) − cy(a2b3 + a3b2) + S·a3b3 = 0
//! (a1²+a2²−b1²−b2²) − 2cx(a1a3 − b1b3) − 2cy(a2a3 − b2b3) + S(a3² − b3²) = 0
//! ```
//!
//! Precondition: the sheet is not tilted about the projector's horizontal axis alone, which leaves the system singular.

use nalgebra::{DMatrix, DVector, Point2};

use super::metric::{centred, imaginary};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{Homography, Intrinsics};

/// The smaller singular value of the scaled 2×2 system against the larger: below this, noise decides. A tilt of half a
/// degree off the horizontal axis gives about 1e-2.
const SINGULAR: f64 = 1e-6;

/// f and cy from one or more homographies sheet → projector, given cx; `size` is the panel's, px.
///
/// # Errors
/// [`Error::Degenerate`] when shift and focal length cannot be separated; [`Error::ImaginaryFocal`] when f² is negative.
pub(crate) fn focal_and_shift(homographies: &[Homography], cx: f64, size: [f64; 2]) -> Result<Intrinsics> {
    // Origin at the centre column and row, lengths in panel widths: then cx = 0, cy and S are of order one.
    let width = size[0];
    let row = (size[1] - 1.0) / 2.0;
    let mut a = DMatrix::zeros(2 * homographies.len(), 2);
    let mut b = DVector::zeros(2 * homographies.len());
    for (i, h) in homographies.iter().enumerate() {
        let mut h = centred(h, Point2::new(cx, row));
        h.0.row_mut(2).scale_mut(width);
        let [h1, h2, _] = h.columns();
        let scale = 2.0 / (h1.xy().norm_squared() + h2.xy().norm_squared());
        // The second equation is disturbed twice as much by the same noise, see `metric`.
        let half = scale / 2.0;
        a[(2 * i, 0)] = -(h1.y * h2.z + h1.z * h2.y) * scale;
        a[(2 * i, 1)] = h1.z * h2.z * scale;
        b[2 * i] = -h1.xy().dot(&h2.xy()) * scale;
        a[(2 * i + 1, 0)] = -2.0 * (h1.y * h1.z - h2.y * h2.z) * half;
        a[(2 * i + 1, 1)] = (h1.z * h1.z - h2.z * h2.z) * half;
        b[2 * i + 1] = -(h1.xy().norm_squared() - h2.xy().norm_squared()) * half;
    }
    let singular = |measure: f64| {
        Error::Degenerate {
        what: ErrorSubject::LensShift,
        measure,
        limit: SINGULAR,
        advice: "a sheet tilted about the projector's horizontal axis alone cannot separate lens shift from focal \
                 length: turn it about its vertical axis as well, or give the principal point"
            .into(),
    }
    };
    let norms: Vec<f64> = a.column_iter().map(|c| c.norm()).collect();
    if norms.iter().any(|n| n.is_nan() || *n <= 0.0) {
        return Err(singular(0.0));
    }
    for (mut column, n) in a.column_iter_mut().zip(&norms) {
        column /= *n;
    }
    let qr = a.qr();
    let r = qr.r();
    let conditioning = (r[(1, 1)] / r[(0, 0)]).abs();
    if conditioning.is_nan() || conditioning < SINGULAR {
        return Err(singular(conditioning));
    }
    qr.q_tr_mul(&mut b);
    let y = r.solve_upper_triangular(&b.rows(0, 2).into_owned()).ok_or_else(|| singular(0.0))?;
    let (cy, s) = (y[0] / norms[0], y[1] / norms[1]);
    let f_squared = s - cy * cy;
    if f_squared.is_nan() || f_squared <= 0.0 {
        return Err(imaginary(ErrorSubject::Projector, f_squared * width * width));
    }
    Ok(Intrinsics::square(f_squared.sqrt() * width, Point2::new(cx, row + cy * width)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Rotation3, Vector3};

    const PANEL: [f64; 2] = [1024.0, 768.0];

    fn seen(tilt_x: f64, tilt_y: f64, roll: f64, k: &Intrinsics) -> Homography {
        let [x, y, z] = [tilt_x, tilt_y, roll].map(f64::to_radians);
        let r = Rotation3::from_euler_angles(x, y, z);
        let t = Vector3::new(-300.0, -420.0, 1100.0);
        let columns = [r.matrix().column(0).into_owned(), r.matrix().column(1).into_owned(), t];
        Homography(k.matrix() * Matrix3::from_columns(&columns) * 7e-4)
    }

    #[test]
    fn recovers_shift_and_focal_length_wherever_the_principal_point_lies() {
        for cy in [383.5, 768.0, 1358.0, -200.0] {
            let truth = Intrinsics::square(1700.0, Point2::new(511.5, cy));
            for (x, y) in [(25.0, 28.0), (0.0, 30.0), (5.0, 5.0)] {
                let found = focal_and_shift(&[seen(x, y, 3.0, &truth)], 511.5, PANEL).unwrap();
                assert!((found.fx - 1700.0).abs() < 1e-5, "{x} {y}: {found:?}");
                assert!((found.cy - cy).abs() < 1e-5, "{x} {y}: {found:?}");
            }
        }
    }

    #[test]
    fn a_tilt_about_the_horizontal_axis_alone_is_singular() {
        let truth = Intrinsics::square(1700.0, Point2::new(511.5, 768.0));
        let error = focal_and_shift(&[seen(30.0, 0.0, 0.0, &truth)], 511.5, PANEL).unwrap_err();
        assert!(error.to_string().contains("horizontal axis"), "{error}");
        let other = seen(0.0, 30.0, 0.0, &truth);
        assert!(focal_and_shift(&[seen(30.0, 0.0, 0.0, &truth), other], 511.5, PANEL).is_ok());
    }
}
