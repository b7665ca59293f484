//! `slcal-simulate-scene/1`: the contents of a simulated photograph.

use serde::Serialize;

use super::{Photographer, RenderConfig};
use crate::matches::Matches;
use crate::simulate::bend::BendReport;

/// Counts and configuration of a simulated photograph.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneReport {
    pub(super) schema: &'static str,
    /// Width and height, px.
    pub camera: [u32; 2],
    /// Surfaces in front of the rig, including the wall.
    pub surfaces: usize,
    /// Pixels that see a surface.
    pub seen_pixels: usize,
    /// Those of them that the projector's light reaches.
    pub lit_pixels: usize,
    /// Least and greatest depth of the lit pixels, mm.
    pub depth_mm: Option<[f64; 2]>,
    /// True matches of the pattern.
    pub matches: usize,
    /// Light, lens and sensor.
    pub render: RenderConfig,
    /// The bend of the sheet, where it has one.
    pub bend: Option<BendReport>,
    /// The thickness of the sheet, mm, where it has one.
    pub thickness_mm: Option<f64>,
}

impl Photographer {
    /// The record of this scene, with the true matches of the pattern.
    #[must_use]
    pub fn report(&self, matches: &Matches) -> SceneReport {
        let truth = self.truth();
        let lit = || truth.pixels().flatten().filter(|s| s.panel.is_some()).map(|s| s.point.z);
        let depth = [lit().fold(f64::INFINITY, f64::min), lit().fold(f64::NEG_INFINITY, f64::max)];
        SceneReport {
            schema: "slcal-simulate-scene/1",
            camera: [truth.width() as u32, truth.height() as u32],
            surfaces: self.surfaces().len(),
            seen_pixels: truth.pixels().flatten().count(),
            lit_pixels: truth.lit(),
            depth_mm: (depth[0] <= depth[1]).then_some(depth),
            matches: matches.items.len(),
            render: self.config().clone(),
            bend: None,
            thickness_mm: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::{StripeConfig, StripePattern};
    use crate::simulate::{RigConfig, Scene, Shape, Surface};

    #[test]
    fn a_simulated_scene_counts_its_pixels() {
        let config = RigConfig { camera: [80, 64], camera_focal_px: 95.0, ..RigConfig::default() };
        let rig = Scene::new(&config, &[]).unwrap().rig();
        let ball = Shape::Sphere { centre: [0.0, 0.0, 1000.0].into(), radius_mm: 200.0 };
        let photographer = Photographer::new(
            &rig,
            &[Surface::object(ball)],
            &RenderConfig { bits: 16, ..RenderConfig::default() },
        )
        .unwrap();
        let stripes = StripePattern::new(config.projector, &StripeConfig::default()).unwrap();
        let report = photographer.report(&photographer.stripe_matches(&stripes));
        assert_eq!((report.camera, report.surfaces, report.render.bits), ([80, 64], 1, 16));
        assert!(report.lit_pixels > 0 && report.lit_pixels <= report.seen_pixels && report.matches > 0);
        // The disc of the sphere's outline: its radius is f·tan(asin(r / d)).
        let radius = 95.0 * (0.2_f64.asin()).tan();
        let disc = std::f64::consts::PI * radius * radius;
        assert!((report.seen_pixels as f64 / disc - 1.0).abs() < 0.05, "{report:?} for {disc}");
        let [near, far] = report.depth_mm.unwrap();
        assert!((800.0..802.0).contains(&near) && far < 1000.0);
        assert_eq!(serde_json::to_value(&report).unwrap()["schema"], "slcal-simulate-scene/1");
    }
}
