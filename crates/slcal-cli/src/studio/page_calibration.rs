//! A calibration as the page tells it: verdict, figures with σ before and after, assumptions.

use serde::Serialize;
use slcal_core::{Assumption, AssumptionStatus, Rig, Verdict, Warning};

/// A value and its σ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct ValueSigma {
    pub(super) value: f64,
    pub(super) sigma: Option<f64>,
}

/// An estimate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Figure {
    pub(super) name: &'static str,
    #[serde(flatten)]
    pub(super) now: ValueSigma,
    pub(super) unit: &'static str,
    /// What it was before the last photograph.
    pub(super) before: Option<ValueSigma>,
}

/// What is assumed, and what it would cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct PageAssumption {
    pub(super) name: String,
    pub(super) text: String,
    pub(super) status: AssumptionStatus,
    pub(super) cost: String,
    pub(super) check: &'static str,
}

impl From<&Assumption> for PageAssumption {
    fn from(a: &Assumption) -> Self {
        Self {
            name: a.code.clone(),
            text: a.text.clone(),
            status: a.status,
            cost: a.cost(),
            check: a.check(),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct PageCalibration {
    pub(super) verdict: Verdict,
    pub(super) cause: String,
    pub(super) advice: String,
    pub(super) photographs: usize,
    pub(super) figures: Vec<Figure>,
    pub(super) warnings: Vec<Warning>,
    pub(super) assumptions: Vec<PageAssumption>,
    pub(super) report: &'static str,
}

impl PageCalibration {
    /// Of a rig; `before` is the calibration that it replaces.
    pub(super) fn new(rig: &Rig, before: Option<&Self>) -> Self {
        let quality = rig.quality.as_ref();
        let mut figures = figures(rig);
        for figure in &mut figures {
            let earlier = before.and_then(|b| b.figures.iter().find(|f| f.name == figure.name));
            figure.before = earlier.map(|f| f.now);
        }
        Self {
            verdict: quality.map_or(Verdict::Degenerate, |q| q.verdict),
            cause: quality.map_or_else(String::new, |q| q.cause.clone()),
            advice: quality.map_or_else(String::new, |q| q.advice.clone()),
            photographs: rig.views.len(),
            figures,
            warnings: quality.map_or_else(Vec::new, |q| q.warnings.clone()),
            assumptions: quality.iter().flat_map(|q| &q.assumptions).map(PageAssumption::from).collect(),
            report: "/report",
        }
    }
}

fn figures(rig: &Rig) -> Vec<Figure> {
    let figure = |name, value, sigma: Option<f64>, unit| Figure {
        name,
        now: ValueSigma { value, sigma: sigma.filter(|s| s.is_finite()) },
        unit,
        before: None,
    };
    let focal = |device: &slcal_core::Device| (device.model.intrinsics.fx, device.sigma.map(|s| s.focal_px));
    let (camera, sigma) = focal(&rig.camera);
    let mut all = vec![figure("camera focal length", camera, sigma, "px")];
    if let Some(projector) = &rig.projector {
        let (value, sigma) = focal(&projector.device);
        all.push(figure("projector focal length", value, sigma, "px"));
    }
    if let Some(baseline) = rig.baseline_mm() {
        all.push(figure("baseline", baseline, rig.baseline_sigma_mm(), "mm"));
    }
    all
}
