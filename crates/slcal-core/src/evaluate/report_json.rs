//! `slcal-evaluate/1`: the distances of a cloud from a fitted surface, and the rule for its inliers.

use serde::Serialize;

use super::{FitConfig, FitReport, PlaneFit, SphereFit};

#[derive(Serialize)]
struct Evaluation {
    schema: &'static str,
    #[serde(flatten)]
    fitted: Fitted,
    /// Which points count as inliers.
    rule: String,
    #[serde(flatten)]
    report: FitReport,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Fitted {
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

impl PlaneFit {
    /// The record of this plane: its parameters and the statistics over its inliers, as fitted with `config`.
    #[must_use]
    pub fn to_json(&self, config: &FitConfig) -> impl Serialize + use<> {
        let (normal, offset_mm) = (self.plane.normal.into_inner().into(), self.plane.offset_mm);
        evaluation(Fitted::Plane { normal, offset_mm }, self.report, config)
    }
}

impl SphereFit {
    /// The record of this sphere: its parameters and the statistics over its inliers, as fitted with `config`.
    #[must_use]
    pub fn to_json(&self, config: &FitConfig) -> impl Serialize + use<> {
        let fitted = Fitted::Sphere { centre_mm: self.centre.into(), radius_mm: self.radius_mm };
        evaluation(fitted, self.report, config)
    }
}

fn evaluation(fitted: Fitted, report: FitReport, config: &FitConfig) -> Evaluation {
    let rule = format!(
        "inliers lie within {} times their robust sigma (1.4826 x median distance)",
        config.inlier_sigmas
    );
    Evaluation { schema: "slcal-evaluate/1", fitted, rule, report }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Unit, Vector3};
    use serde_json::json;

    use super::*;
    use crate::cloud::PointCloud;
    use crate::evaluate::{fit_plane, fit_sphere};

    /// Points of a plane 1 m away and of a sphere before it.
    fn cloud_of(points: impl Iterator<Item = Point3<f64>>) -> PointCloud {
        let like = crate::for_tests::test_cloud().points[0];
        let points = points.map(|position| crate::cloud::CloudPoint { position, ..like }).collect();
        PointCloud { points, ..PointCloud::default() }
    }

    #[test]
    fn a_record_has_the_surface_the_rule_and_the_figures_in_this_order() {
        let config = FitConfig { inlier_sigmas: 3.5, ..FitConfig::default() };
        let grid = (0..400).map(|i| (f64::from(i % 20) * 5.0 - 50.0, f64::from(i / 20) * 5.0 - 50.0));
        let plane: PlaneFit =
            fit_plane(&cloud_of(grid.clone().map(|(x, y)| Point3::new(x, y, 1000.0))), &config).unwrap();
        let printed = serde_json::to_string(&plane.to_json(&config)).unwrap();
        assert!(
            printed.starts_with(r#"{"schema":"slcal-evaluate/1","plane":{"normal":["#)
                && printed.contains(
                    r#","rule":"inliers lie within 3.5 times their robust sigma (1.4826 x median distance)","points":400,"#
                ),
            "{printed}"
        );
        let ball = grid.map(|(x, y)| {
            let out = Unit::new_normalize(Vector3::new(x, y, -40.0)).into_inner();
            Point3::new(0.0, 0.0, 900.0) + out * 60.0
        });
        let sphere: SphereFit = fit_sphere(&cloud_of(ball), &config).unwrap();
        let sphere = serde_json::to_value(sphere.to_json(&config)).unwrap();
        assert!((sphere["sphere"]["radius_mm"].as_f64().unwrap() - 60.0).abs() < 1e-6, "{sphere}");
        assert_eq!(sphere["inliers"], json!(400));
    }
}
