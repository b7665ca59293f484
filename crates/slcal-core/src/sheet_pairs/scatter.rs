//! How far cells scatter about a smooth map of the sheet, beyond what the pixels of each say.
//!
//! The borders of a code lie on a grid, and so do the camera's pixels: where the two grids beat, all pixels of a cell err alike.

use nalgebra::{DMatrix, DVector, Point2, Vector2};

use crate::solve::{Loss, median, robust_scale};

/// Degree of the polynomial that takes up lenses and bends. A fifth-order term of a lens is the last that can be seen on a sheet.
const DEGREE: i32 = 5;
/// It has at most one term for so many cells.
const CELLS_PER_TERM: usize = 3;
/// Cutoff of Huber's loss, in standard deviations.
const HUBER: f64 = 2.0;
/// Cells within so many standard deviations count. The scatter has long tails, because some cells lie where the grids beat most; what lies beyond
/// is something on the sheet.
const COUNTED: f64 = 6.0;
const ROUNDS: usize = 5;

/// The variance that cells have beyond `variances` about a polynomial in their places, px²: `values` are what each measured. Zero where they
/// scatter less, or are too few to tell.
pub(super) fn excess(places: &[Point2<f64>], values: &[f64], variances: &[f64]) -> f64 {
    let n = places.len();
    let terms = |degree: i32| ((degree + 1) * (degree + 2) / 2) as usize;
    let Some(degree) = (1..=DEGREE).rev().find(|d| terms(*d) * CELLS_PER_TERM <= n) else { return 0.0 };
    let design = design(places, degree);
    let mut weights = vec![1.0; n];
    let mut errors = DVector::from_column_slice(values);
    for _ in 0..ROUNDS {
        let rows = |i: usize, j: usize| design[(i, j)] * weights[i];
        let weighted = DMatrix::from_fn(n, design.ncols(), rows);
        let side = DVector::from_fn(n, |i, _| values[i] * weights[i]);
        let Some(coefficients) = weighted.svd(true, true).solve(&side, f64::EPSILON).ok() else { return 0.0 };
        errors = DVector::from_column_slice(values) - &design * coefficients;
        let scale = robust_scale(errors.iter().map(|e| e.abs()));
        if scale <= 0.0 {
            return 0.0;
        }
        for (w, e) in weights.iter_mut().zip(errors.iter()) {
            *w = Loss::Huber(HUBER).weight((e / scale).powi(2)).min(1.0).sqrt();
        }
    }
    let limit = COUNTED * robust_scale(errors.iter().map(|e| e.abs()));
    let counted: Vec<f64> = errors.iter().filter(|e| e.abs() <= limit).map(|e| e * e).collect();
    if counted.len() <= design.ncols() {
        return 0.0;
    }
    let scatter = counted.iter().sum::<f64>() / (counted.len() - design.ncols()) as f64;
    let expected = median(&mut variances.to_vec()).unwrap_or(0.0);
    (scatter - expected).max(0.0)
}

/// Monomials of the places, moved and scaled to within one of zero.
fn design(places: &[Point2<f64>], degree: i32) -> DMatrix<f64> {
    let mean = places.iter().fold(Vector2::zeros(), |s, p| s + p.coords) / places.len() as f64;
    let reach = places.iter().map(|p| (p.coords - mean).amax()).fold(f64::MIN_POSITIVE, f64::max);
    let powers: Vec<(i32, i32)> = (0..=degree).flat_map(|d| (0..=d).map(move |i| (d - i, i))).collect();
    DMatrix::from_fn(places.len(), powers.len(), |i, j| {
        let at = (places[i].coords - mean) / reach;
        at.x.powi(powers[j].0) * at.y.powi(powers[j].1)
    })
}
