//! The one least-squares problem: everything that needs its residuals, derivatives or covariance asks here.
//!
//! Unknown are the lenses of camera and projector, the transform between them and the sheet's pose in each view (`model`,
//! `unknowns`). `measurement` lists what was seen or would be seen, `residual` its derivatives, `prior` what is known
//! beforehand. `problem` puts all of it into rows, `robust` fits them, and `covariance` and `propagation` say how well
//! parameters and functions of them are known. Calibration, verification and advice differ in what they hold fixed.

pub(crate) mod assumptions;
pub(crate) mod covariance;
pub(crate) mod expected_view;
pub(crate) mod flatness;
pub(crate) mod hyperparameters;
pub(crate) mod implied_noise;
pub(crate) mod measurement;
pub(crate) mod model;
pub(crate) mod planar_pose;
pub(crate) mod prior;
pub(crate) mod problem;
pub(crate) mod propagation;
pub(crate) mod residual;
pub(crate) mod robust;
pub(crate) mod sheet;
pub(crate) mod side;
pub(crate) mod solution;
#[cfg(test)]
mod tests;
pub(crate) mod unknowns;
pub(crate) mod validate;

pub(crate) use assumptions::Lens;
pub(crate) use expected_view::ExpectedView;
pub(crate) use flatness::Flatness;
pub(crate) use measurement::{Kind, Measurement, Target, measurements};
pub(crate) use model::Model;
pub(crate) use prior::Priors;
pub(crate) use problem::BundleAdjustment;
pub(crate) use sheet::Sheet;
pub(crate) use solution::Solution;
pub(crate) use unknowns::Unknowns;
