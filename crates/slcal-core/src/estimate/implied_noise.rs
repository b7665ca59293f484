//! The noise of a rig's photographs, from what its covariance knows.

use nalgebra::{DMatrix, DMatrixView};

use super::covariance::correlations;
use super::expected_view::{ExpectedSheet, ExpectedView, POINTS_PER_SIDE};
use super::model::Model;
use super::prior::Priors;
use super::residual::POSE;
use super::sheet::Sheet;
use super::unknowns::Unknowns;
use crate::parameter::{Parameter, PoseParameter};
use crate::rig::Rig;

/// σ of the sheet's measurements and of the projected corners of an expected view, px: the information on the first view's
/// pose and on the transform between the devices that the rig's covariance holds, against that of the same views at 1 px.
/// `None` where the covariance does not give it.
pub(crate) fn implied_noise(rig: &Rig, model: &Model, view: &ExpectedView) -> Option<[f64; 2]> {
    let information = information(&rig.covariance.as_ref()?.matrix)?;
    let block = |first: Parameter| {
        let at = rig.covariance.as_ref()?.parameters.iter().position(|p| *p == first)?;
        (at + POSE <= information.nrows()).then(|| information.view((at, at), (POSE, POSE)).into_owned())
    };
    let unit = view.clone().with_noise([1.0; 2]);
    let unknowns = Unknowns::all(1, false);
    let jacobian = |sheet: &Sheet| {
        let (problem, model) = unit.problem(model, &[*sheet], &unknowns, &Priors::default())?;
        Some(problem.at(&model)?.jacobian)
    };
    let gram = |j: DMatrixView<f64>| j.transpose() * j;
    let first = jacobian(model.views.first()?)?;
    let edges = if matches!(view.sheet, ExpectedSheet::Corners(_)) { 8 } else { 4 * POINTS_PER_SIDE };
    let sheet = gram(first.view((0, 0), (edges, POSE)));
    let of_pairs = gram(first.view((edges, 0), (first.nrows() - edges, POSE)));
    let mean = |unit: DMatrix<f64>, found: &DMatrix<f64>| -> Option<f64> {
        let share = unit.lu().solve(found)?.trace() / POSE as f64;
        (share > 0.0 && share.is_finite()).then_some(share)
    };
    let mut weight = 0.0;
    if model.projector.is_some() {
        let at = POSE + unknowns.projector_from_camera()?;
        let mut between = DMatrix::zeros(POSE, POSE);
        for sheet in &model.views {
            let j = jacobian(sheet)?;
            between += gram(j.view((0, at), (j.nrows(), POSE)));
        }
        weight = mean(between, &block(Parameter::ProjectorFromCamera(PoseParameter::Rx))?)?;
    }
    let of_view = block(Parameter::View(0, PoseParameter::Rx))?;
    let on_sheet = mean(sheet, &(of_view - of_pairs * weight))?;
    Some([on_sheet, weight].map(|w| if w > 0.0 { w.sqrt().recip() } else { 1.0 }))
}

/// The inverse of a covariance, on correlations; `None` for one that is singular.
fn information(covariance: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (sigma, correlations) = correlations(covariance);
    let inverse = correlations.cholesky()?.inverse();
    Some(inverse.map_with_location(|i, j, x| x / (sigma[i] * sigma[j])))
}
