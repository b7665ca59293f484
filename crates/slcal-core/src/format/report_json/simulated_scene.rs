//! `slcal-simulate-scene/1`: what a simulated photograph shows.

use serde::Serialize;

use crate::matches::Matches;
use crate::simulate::{Photographer, RenderConfig};

/// A simulated photograph in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneReport {
    schema: &'static str,
    /// Width and height, px.
    pub camera: [u32; 2],
    /// Surfaces before the rig, the wall among them.
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
}

/// What a photographer saw, with the true matches of its pattern.
#[must_use]
pub fn simulated_scene(photographer: &Photographer, matches: &Matches) -> SceneReport {
    let truth = photographer.truth();
    let lit = || truth.pixels().flatten().filter(|s| s.panel.is_some()).map(|s| s.point.z);
    let depth = [lit().fold(f64::INFINITY, f64::min), lit().fold(f64::NEG_INFINITY, f64::max)];
    SceneReport {
        schema: "slcal-simulate-scene/1",
        camera: [truth.width() as u32, truth.height() as u32],
        surfaces: photographer.surfaces().len(),
        seen_pixels: truth.pixels().flatten().count(),
        lit_pixels: truth.lit(),
        depth_mm: (depth[0] <= depth[1]).then_some(depth),
        matches: matches.items.len(),
        render: photographer.config().clone(),
    }
}
