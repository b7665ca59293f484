//! `slcal-evaluate/1`: how far a cloud lies from a surface, and by which rule that was counted.

use serde::Serialize;

use crate::evaluate::{FitConfig, FitReport, PlaneFit, SphereFit};

#[derive(Serialize)]
struct Evaluation {
    schema: &'static str,
    #[serde(flatten)]
    shape: Shape,
    /// Which points count as inliers.
    rule: String,
    #[serde(flatten)]
    report: FitReport,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Shape {
    /// The points X with normal · X + `offset_mm` = 0.
    Plane {
        normal: [f64; 3],
        offset_mm: f64,
    },
    Sphere {
        centre_mm: [f64; 3],
        radius_mm: f64,
    },
}

/// A plane and the figures over its inliers, as fitted with `config`.
#[must_use]
pub fn plane_evaluation(fit: &PlaneFit, config: &FitConfig) -> impl Serialize + use<> {
    let shape = Shape::Plane { normal: fit.plane.normal.into_inner().into(), offset_mm: fit.plane.offset_mm };
    evaluation(shape, fit.report, config)
}

/// A sphere and the figures over its inliers, as fitted with `config`.
#[must_use]
pub fn sphere_evaluation(fit: &SphereFit, config: &FitConfig) -> impl Serialize + use<> {
    let shape = Shape::Sphere { centre_mm: fit.centre.into(), radius_mm: fit.radius_mm };
    evaluation(shape, fit.report, config)
}

fn evaluation(shape: Shape, report: FitReport, config: &FitConfig) -> Evaluation {
    let rule = format!(
        "inliers lie within {} times their robust sigma (1.4826 x median distance)",
        config.inlier_sigmas
    );
    Evaluation { schema: "slcal-evaluate/1", shape, rule, report }
}
