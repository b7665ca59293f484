//! Propagation of covariance to functions of the unknowns, to first order.

use nalgebra::{DMatrix, DVector, Point2};

use super::model::Model;
use super::sheet::Sheet;
use super::unknowns::Unknowns;

/// Usual step of the differences, in σ of the unknown: far above rounding, far below curvature.
pub(crate) const STEP_SIGMAS: f64 = 1e-3;
/// 1σ of a stripe's position in the camera image that the expected σ of a point assumes, px.
pub(crate) const STRIPE_NOISE_PX: f64 = 0.1;

/// 1σ of functions of the unknowns, by central differences with steps of `step_sigmas` σ. `values` gives them after a step of the unknowns; `None` where
/// they are not defined.
pub(crate) fn propagate<const N: usize>(
    covariance: &DMatrix<f64>,
    step_sigmas: f64,
    values: impl Fn(&DVector<f64>) -> Option<[f64; N]>,
) -> Option<[f64; N]> {
    let n = covariance.nrows();
    let mut gradient = DMatrix::zeros(N, n);
    for i in 0..n {
        let h = step_sigmas * covariance[(i, i)].max(0.0).sqrt();
        if h > 0.0 {
            let mut step = DVector::zeros(n);
            step[i] = h;
            let (up, down) = (values(&step)?, values(&-step)?);
            for r in 0..N {
                gradient[(r, i)] = (up[r] - down[r]) / (2.0 * h);
            }
        }
    }
    let c = &gradient * covariance * gradient.transpose();
    let sigma: [f64; N] = std::array::from_fn(|i| c[(i, i)].max(0.0).sqrt());
    sigma.iter().all(|s| s.is_finite()).then_some(sigma)
}

/// 1σ along the camera's ray of a point at the middle of a sheet, mm, and the point's distance from the camera, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DepthSigma {
    /// What the rig's own uncertainty contributes.
    pub(crate) of_rig: f64,
    /// What the noise of a stripe contributes.
    pub(crate) of_stripe: f64,
    pub(crate) distance: f64,
}

impl DepthSigma {
    /// Both together, mm.
    pub(crate) fn total(&self) -> f64 {
        self.of_rig.hypot(self.of_stripe)
    }
}

/// The σ of a point's depth from stripe noise and a covariance whose first unknowns are those that all views share.
pub(crate) fn depth_sigma(
    model: &Model,
    unknowns: &Unknowns,
    covariance: &DMatrix<f64>,
    sheet: &Sheet,
) -> Option<DepthSigma> {
    let middle = sheet.lift(sheet.size.centre());
    let pixel = model.camera.project(&middle)?;
    let lit = model.projector.as_ref()?.project(&model.projector_from_camera.transform(&middle))?;
    let length = model.camera.bearing(pixel)?.norm();
    let depth = |m: &Model, shift: f64| {
        Some(m.depth_on_column(Point2::new(pixel.x + shift, pixel.y), lit.x, lit.y)? * length)
    };
    let noise = (depth(model, 0.5)? - depth(model, -0.5)?) * STRIPE_NOISE_PX;
    // The poses of the sheet play no part.
    let devices = model.with_views(&[]);
    let shared = covariance.view((0, 0), (unknowns.shared, unknowns.shared)).into_owned();
    let [of_rig] =
        propagate(&shared, STEP_SIGMAS, |step| Some([depth(&devices.moved(unknowns, step)?, 0.0)?]))?;
    let sigma = DepthSigma { of_rig, of_stripe: noise.abs(), distance: middle.coords.norm() };
    sigma.total().is_finite().then_some(sigma)
}
