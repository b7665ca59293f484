//! Devices, sheets and cloud in space: the page's script shows them with the view of clouds.

mod carried;
mod point_cloud;
mod scene;

use maud::html;
use slcal_core::Rig;

use self::carried::{bytes, json};
use self::scene::Scene;
use super::page::Section;
use super::rig_page::ShownCloud;
use crate::summary::working_volume::sheet_distance_mm;

/// Length of the drawn pyramids as a share of the distance of the sheet or cloud.
const PYRAMID: f64 = 0.22;
/// Assumed distance where there is neither a sheet nor a cloud, mm.
const NOTHING_SEEN_MM: f64 = 1000.0;

/// What is in view at the beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Begin {
    /// Devices, sheets and cloud.
    All,
    Cloud,
}

pub(super) fn section(rig: &Rig, beside: Option<&ShownCloud>, begin: Begin) -> Section {
    let shown = beside.map(|c| point_cloud::ShownPoints::new(rig, c.cloud));
    let distance = match (rig.views.is_empty(), &shown) {
        (false, _) => sheet_distance_mm(rig),
        (true, Some(cloud)) => cloud.median_depth_mm().unwrap_or(NOTHING_SEEN_MM),
        (true, None) => rig.baseline_mm().map_or(NOTHING_SEEN_MM, |b| 3.0 * b),
    };
    let alt = alt(rig, beside);
    let content = html! {
        p { (alt) }
        div.space id="space" data-label=(alt) data-whole[begin == Begin::All] {}
        noscript { p.note { "The 3D view needs JavaScript; everything else works without it." } }
        @if let (Some(shown), Some(cloud)) = (&shown, beside) {
            p.note id="not-unpacked" hidden { "The points are not shown: this browser cannot unpack them. Versions of the last years can." }
            (bytes("cloud", &shown.packed()))
            (bytes("noise", &shown.noise()))
            p.note { (shown.note(&cloud.name)) }
        }
        (json("scene", &Scene::new(rig, PYRAMID * distance)))
    };
    Section { id: "in-space", title: "3D view", content }
}

fn alt(rig: &Rig, beside: Option<&ShownCloud>) -> String {
    let mut parts = vec!["the camera".to_owned()];
    if let Some(baseline) = rig.baseline_mm() {
        parts.push(format!("the projector, {baseline:.0} mm from it"));
    }
    match rig.views.len() {
        0 => {}
        1 => parts.push(format!("the sheet, {:.0} mm from the camera", sheet_distance_mm(rig))),
        n => parts.push(format!(
            "the sheet in its {n} poses, {:.0} mm from the camera on average",
            sheet_distance_mm(rig)
        )),
    }
    if let Some(cloud) = beside {
        parts.push(format!("the points of {}", cloud.name));
    }
    let last = parts.pop().unwrap_or_default();
    let text = if parts.is_empty() { last } else { format!("{} and {last}", parts.join(", ")) };
    super::verdict::sentence(&text)
}
