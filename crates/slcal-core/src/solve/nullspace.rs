//! The solution of A·x = 0, |x| = 1 in the least-squares sense.

use nalgebra::{DMatrix, DVector};

use crate::error::{Error, ErrorSubject, Result};

/// Maximum number of iterations of the small SVD. A few dozen suffice, and an unbounded SVD may not terminate on
/// degenerate input.
const MAX_SVD_ITERATIONS: usize = 500;

/// The unit vector x that minimises |A·x|, for A with as many rows as columns, one fewer, or more.
///
/// Tall systems are reduced by QR first, so that the SVD runs on the small square factor with a bounded number of
/// iterations.
///
/// # Errors
/// [`Error::Degenerate`] when the null space has more than one dimension (the second smallest singular value is below
/// 1e-10 of the largest), or when the numbers are not finite.
pub(crate) fn null_vector(a: DMatrix<f64>, what: ErrorSubject) -> Result<DVector<f64>> {
    let n = a.ncols();
    let degenerate = |measure: f64, limit: f64| Error::Degenerate {
        what,
        measure,
        limit,
        advice: "the measurements coincide, lie on one line, or are not finite numbers".into(),
    };
    if !a.iter().all(|x| x.is_finite()) {
        return Err(degenerate(f64::NAN, 0.0));
    }
    if a.nrows() + 1 < n {
        return Err(degenerate(a.nrows() as f64, n as f64 - 1.0));
    }
    let mut square = if a.nrows() > n { a.qr().r() } else { a };
    if square.nrows() < n {
        // A thin SVD of a wide matrix leaves out the null vector: pad with zero rows.
        square = square.resize_vertically(n, 0.0);
    }
    let svd = square
        .try_svd(false, true, f64::EPSILON, MAX_SVD_ITERATIONS)
        .ok_or_else(|| degenerate(f64::NAN, 0.0))?;
    let v_t = svd.v_t.as_ref().ok_or_else(|| degenerate(f64::NAN, 0.0))?;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| svd.singular_values[i].total_cmp(&svd.singular_values[j]));
    let (second, largest) = (svd.singular_values[order[1]], svd.singular_values[order[n - 1]]);
    let limit = 1e-10 * largest;
    if second.is_nan() || second <= limit {
        return Err(degenerate(second, limit));
    }
    Ok(v_t.row(order[0]).transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_normal_of_a_plane_of_rows() {
        let x = DVector::from_vec(vec![0.5, -0.5, 0.5, 0.5]);
        for rows in [3, 4, 50] {
            let a = DMatrix::from_fn(rows, 4, |i, j| ((i * 7 + j * 3) as f64).sin() + (i * j) as f64 * 0.1);
            let a = &a - (&a * &x) * x.transpose();
            let found = null_vector(a, ErrorSubject::Homography).unwrap();
            assert!((found.dot(&x).abs() - 1.0).abs() < 1e-12, "{rows} rows");
        }
    }

    #[test]
    fn refuses_two_dimensions_and_nan() {
        assert!(null_vector(DMatrix::from_element(6, 3, 1.0), ErrorSubject::Homography).is_err());
        assert!(null_vector(DMatrix::from_element(6, 3, f64::NAN), ErrorSubject::Homography).is_err());
        assert!(null_vector(DMatrix::zeros(1, 3), ErrorSubject::Homography).is_err());
    }
}
