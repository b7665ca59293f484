//! Covariances: of an estimate, and those that rigs carry.

use nalgebra::{DMatrix, DVector};

use super::measurement::Kind;
use super::model::Model;
use super::problem::BundleAdjustment;
use super::robust::EFFICIENCY;
use super::unknowns::Unknowns;
use crate::parameter::{LensParameter, Parameter};
use crate::rig::{Covariance, Rig};
use crate::solve::{Loss, Problem, covariance};

/// 1σ that stands in for "no information", in natural units: 1000 % of a focal length, 10 widths, ten times the distance.
pub(crate) const UNINFORMATIVE: f64 = 10.0;

/// (JᵀWJ + priors)⁻¹ with outliers left out and the σ of edges and pairs widened; directions that nothing determines get a σ
/// of [`UNINFORMATIVE`], never infinity. Focal lengths as ln f.
pub(crate) fn posterior(
    problem: &BundleAdjustment,
    model: &Model,
    inliers: &[bool],
    widened: [f64; 2],
) -> Option<DMatrix<f64>> {
    let mut j = problem.at(model)?.jacobian;
    let measured = problem.measurements.iter().zip(&problem.blocks).zip(inliers);
    let weights = problem.row_weights(measured.map(|((m, block), keep)| match (m.kind(), block.loss) {
        _ if !keep => 0.0,
        (Kind::SheetCorner, _) => 1.0,
        (kind, Loss::Tukey(_)) => EFFICIENCY.sqrt() / widened[kind as usize],
        (kind, _) => 1.0 / widened[kind as usize],
    }));
    let weights = DVector::from_vec(weights);
    j.column_iter_mut().for_each(|mut column| column.component_mul_assign(&weights));
    let units = model.units(&problem.unknowns);
    let beforehand: Vec<f64> = units.into_iter().map(|unit| 1.0 / (UNINFORMATIVE * unit)).collect();
    covariance(&problem.structure(), &j, &beforehand)
}

/// What d ln f is to be multiplied by to be a change in px, for each unknown; 1 for what is no focal length.
fn pixels(unknowns: &Unknowns, model: &Model) -> DVector<f64> {
    let pixels = |p| match p {
        Parameter::Camera(LensParameter::Focal) => model.camera.intrinsics.fx,
        Parameter::Projector(LensParameter::Focal) => model.projector.map_or(1.0, |p| p.intrinsics.fx),
        _ => 1.0,
    };
    DVector::from_vec(unknowns.parameters().into_iter().map(pixels).collect())
}

/// A covariance of the unknowns in the units of rigs, focal lengths in px.
pub(crate) fn to_rig(covariance: &DMatrix<f64>, unknowns: &Unknowns, model: &Model) -> Covariance {
    let scale = pixels(unknowns, model);
    let matrix = covariance.map_with_location(|i, j, c| c * scale[i] * scale[j]);
    Covariance { parameters: unknowns.parameters(), matrix }
}

/// A rig's covariance of these unknowns, focal lengths as ln f; zero for what the rig holds fixed or does not list.
/// `None` for a rig without covariance, or with one that is no covariance of any of these unknowns.
pub(crate) fn of_rig(rig: &Rig, unknowns: &Unknowns) -> Option<DMatrix<f64>> {
    let known = rig.covariance.as_ref()?;
    let at: Vec<Option<usize>> =
        unknowns.parameters().iter().map(|p| known.parameters.iter().position(|k| k == p)).collect();
    let scale = pixels(unknowns, &Model::of_rig(rig));
    let c = DMatrix::from_fn(at.len(), at.len(), |i, j| match (at[i], at[j]) {
        (Some(a), Some(b)) => known.matrix.get((a, b)).map_or(f64::NAN, |c| c / (scale[i] * scale[j])),
        _ => 0.0,
    });
    let some = at.iter().flatten().next().is_some();
    (some && c.iter().all(|x| x.is_finite()) && c.diagonal().iter().all(|v| *v >= 0.0)).then_some(c)
}

/// σ and correlations, NaN where a variance is zero: the units of a covariance differ by orders of magnitude.
pub(crate) fn correlations(c: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let sigma = c.diagonal().map(|v| v.max(0.0).sqrt());
    let correlations = c.map_with_location(|i, j, c| c / (sigma[i] * sigma[j]));
    (sigma, correlations)
}

/// A matrix F with F·Fᵀ equal to a covariance, by the eigenvectors of its correlations: singular ones have one, too.
pub(crate) fn factor(c: &DMatrix<f64>) -> DMatrix<f64> {
    let used: Vec<usize> = (0..c.nrows()).filter(|&i| c[(i, i)] > 0.0).collect();
    let mut factor = DMatrix::zeros(c.nrows(), used.len());
    if used.is_empty() {
        return factor;
    }
    let (sigma, correlations) = correlations(&c.select_rows(&used).select_columns(&used));
    let eigen = correlations.symmetric_eigen();
    for (row, &i) in used.iter().enumerate() {
        for k in 0..used.len() {
            factor[(i, k)] = sigma[row] * eigen.eigenvectors[(row, k)] * eigen.eigenvalues[k].max(0.0).sqrt();
        }
    }
    factor
}
