//! Normalised direct linear transform (R. Hartley, "In defense of the eight-point algorithm", PAMI 19:580-593, 1997).

use nalgebra::{DMatrix, Matrix3, Point2};

use super::null_vector;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Homography;

/// The similarity that brings points to zero mean and mean distance √2; `None` when they coincide.
fn conditioning(points: impl Iterator<Item = Point2<f64>> + Clone) -> Option<Matrix3<f64>> {
    let n = points.clone().count() as f64;
    let mean = points.clone().fold(nalgebra::Vector2::zeros(), |s, p| s + p.coords) / n;
    let spread = points.map(|p| (p.coords - mean).norm()).sum::<f64>() / n;
    let s = std::f64::consts::SQRT_2 / spread;
    (s.is_finite() && s > 0.0).then(|| Matrix3::new(s, 0.0, -s * mean.x, 0.0, s, -s * mean.y, 0.0, 0.0, 1.0))
}

/// The homography `b_from_a` of pairs (a, b), least squares in the algebraic error of conditioned coordinates; exact
/// for four pairs.
///
/// # Errors
/// [`Error::Invalid`] for fewer than four pairs; [`Error::Degenerate`] when three of four points, or all, are collinear.
pub(crate) fn homography_from_points(pairs: &[(Point2<f64>, Point2<f64>)]) -> Result<Homography> {
    if pairs.len() < 4 {
        return Err(Error::invalid(ErrorSubject::Homography, "at least 4 pairs of points", pairs.len()));
    }
    let coincide = "the points coincide or lie on one line";
    let degenerate = || Error::undetermined(ErrorSubject::Homography, coincide);
    let t_a = conditioning(pairs.iter().map(|p| p.0)).ok_or_else(degenerate)?;
    let t_b = conditioning(pairs.iter().map(|p| p.1)).ok_or_else(degenerate)?;
    let mut a = DMatrix::zeros(2 * pairs.len(), 9);
    for (i, (p, q)) in pairs.iter().enumerate() {
        let p = t_a * p.to_homogeneous();
        let q = t_b * q.to_homogeneous();
        for j in 0..3 {
            a[(2 * i, j)] = p[j];
            a[(2 * i, 6 + j)] = -q.x * p[j];
            a[(2 * i + 1, 3 + j)] = p[j];
            a[(2 * i + 1, 6 + j)] = -q.y * p[j];
        }
    }
    let h = null_vector(a, ErrorSubject::Homography)?;
    let h = Matrix3::from_row_slice(h.as_slice());
    // Three collinear points among four give a null vector, but one that flattens the plane.
    if h.determinant().abs() < 1e-10 {
        return Err(degenerate());
    }
    let h = t_b.try_inverse().ok_or_else(degenerate)? * h * t_a;
    Ok(Homography(h / h.norm()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovers_a_homography_from_far_off_points() {
        let truth = Homography(Matrix3::new(1.1, 0.2, 300.0, -0.1, 0.9, 50.0, 2e-4, -1e-4, 1.0));
        let pairs: Vec<_> = (0..30)
            .map(|i| {
                let p = Point2::new(f64::from(i % 6) * 100.0 + 5000.0, f64::from(i / 6) * 80.0 - 3000.0);
                (p, truth.map(p).unwrap())
            })
            .collect();
        for n in [4 + 6, 30] {
            let h = homography_from_points(&pairs[..n]).unwrap();
            for (p, q) in &pairs {
                assert!((h.map(*p).unwrap() - q).norm() < 1e-7);
            }
        }
    }

    #[test]
    fn collinear_points_are_refused() {
        let line: Vec<_> =
            (0..9).map(|i| Point2::new(f64::from(i), 2.0 * f64::from(i))).map(|p| (p, p)).collect();
        assert!(homography_from_points(&line).is_err());
        let mut three: Vec<_> = line[..3].to_vec();
        three.push((Point2::new(0.0, 5.0), Point2::new(0.0, 5.0)));
        assert!(homography_from_points(&three).is_err());
        assert!(homography_from_points(&[(Point2::new(f64::NAN, 0.0), Point2::origin()); 4]).is_err());
    }
}
