//! The check of a rig by the matches of one photograph.
//!
//! A slit is a plane of light, and a plane meets every ray: most motion of the camera only shifts the depth. What can
//! contradict the rig is the position along the slit, which no stripe codes (see [`panel_position`](super::panel_position)):
//! light does not come from outside the panel, no two surfaces are lit by the same part of a slit, and where the ends of
//! most slits lie on a line parallel to the panel's border, it is that border. A contradiction is one beyond what scanlines,
//! the noise of the match and the rig's own uncertainty explain.

use super::border::{BorderPoint, border_at};
use super::findings::{RigCheckReport, SlitCount};
use super::panel_position::{PanelPositions, coded};
use super::scanline_runs::RunFinder;
use super::shown_scale::shown_scale;
use super::slit_ends::{End, LocatedRun, Seen, SlitExtent};
use crate::error::Result;
use crate::matches::Matches;
use crate::rig::Rig;
use crate::solve::median;

/// The last crossing of a slit is found to this many scanlines: the light fades over some of them.
const END_LINES: f64 = 3.0;
/// Where the end should lie farther out: decoding loses the ends where the light is weak.
const LOST_LINES: f64 = 8.0;
/// σ of the rig's uncertainty. Its error is common to all slits, so that with 4σ less than one right rig in a thousand is
/// called wrong.
const RIG_SIGMAS: f64 = 4.0;
/// σ of the noise of a match, which is independent from slit to slit: a quarter of the slits are never off by so much.
const NOISE_SIGMAS: f64 = 2.0;
/// Allowed for a rig without a covariance, as a share of the panel: twice what a careful calibration leaves.
const UNSTATED: f64 = 0.0025;
/// A border of the light farther inside the panel than this, as a share of it, is rather the edge of an object.
const BORDER_WITHIN: f64 = 0.03;

/// Checks matches of one frame after another against a rig; keeps its buffers.
#[derive(Debug, Clone)]
pub(crate) struct RigChecker {
    positions: PanelPositions,
    runs: RunFinder,
    located: Vec<LocatedRun>,
    extents: Vec<SlitExtent>,
    points: Vec<BorderPoint>,
    buffer: Vec<f64>,
}

impl RigChecker {
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a rig without a projector.
    pub(crate) fn new(rig: &Rig, min_angle_rad: f64) -> Result<Self> {
        Ok(Self {
            positions: PanelPositions::new(rig, min_angle_rad)?,
            runs: RunFinder::default(),
            located: Vec::new(),
            extents: Vec::new(),
            points: Vec::new(),
            buffer: Vec::new(),
        })
    }

    /// What the matches say about the rig. Nothing when they are not of stripes on scanlines, or few.
    pub(crate) fn check(&mut self, matches: &Matches) -> RigCheckReport {
        let matches = &matches.items;
        let mut report = RigCheckReport::default();
        let axis = matches.first().and_then(coded).map(|(axis, _)| axis);
        let Some((axis, (runs, across))) = axis.zip(self.runs.find(matches)) else { return report };
        let seen = Seen { positions: &self.positions, matches, across, axis };
        seen.extents(runs, &mut self.located, &mut self.extents);
        (report.slits, report.slits_are_rows) = (self.extents.len(), axis == 1);
        report.shown_scale = shown_scale(seen, &self.extents, &mut self.points, &mut self.buffer);
        report.outside_start = outside(seen, &self.extents, 0, &mut self.buffer);
        report.outside_end = outside(seen, &self.extents, 1, &mut self.buffer);
        report.lit_twice = lit_twice(seen, &self.extents, &mut self.buffer);
        let mut inside = |side| inside(seen, &self.extents, side, &mut self.points, &mut self.buffer);
        (report.inside_start, report.inside_end) = (inside(0), inside(1));
        report
    }
}

/// By how much more than a number of scanlines something is off, and what else is allowed: both px on the panel.
fn beyond(seen: Seen<'_>, px: f64, lines: f64, ends: &[End]) -> Option<f64> {
    let step = ends.iter().map(|e| e.step).fold(0.0, f64::max);
    if px.is_nan() || px <= lines * step {
        return None;
    }
    let of = |end: &End| &seen.matches[end.index];
    let noise = ends.iter().map(|e| seen.positions.noise_px(of(e), seen.across)).sum::<Option<f64>>()?;
    let of_rig = seen.positions.rig_sigma_px(of(ends.first()?), ends.get(1).map(of));
    let of_rig = of_rig.map_or(UNSTATED * seen.positions.length_px(seen.axis), |sigma| RIG_SIGMAS * sigma);
    let allowed = lines * step + NOISE_SIGMAS * noise + of_rig;
    (px > allowed).then_some(allowed)
}

/// Counts pairs of what was found and what is allowed.
#[derive(Default)]
struct Counting {
    tested: usize,
    contradicting: usize,
    allowed: f64,
}

impl Counting {
    fn add(&mut self, px: f64, allowed: Option<f64>, found: &mut Vec<f64>) {
        self.tested += 1;
        if let Some(allowed) = allowed {
            self.contradicting += 1;
            self.allowed += allowed;
            found.push(px);
        }
    }

    fn finish(self, found: &mut [f64]) -> SlitCount {
        SlitCount {
            tested: self.tested,
            contradicting: self.contradicting,
            median_px: median(found).unwrap_or(0.0),
            allowed_px: self.allowed / self.contradicting.max(1) as f64,
        }
    }
}

/// How far an end lies outside the panel on a side, px; negative inside.
fn outside_px(seen: Seen<'_>, end: &End, side: usize) -> f64 {
    if side == 0 { -0.5 - end.at } else { end.at - (seen.positions.length_px(seen.axis) - 0.5) }
}

/// Slits whose light would come from outside the panel.
fn outside(seen: Seen<'_>, extents: &[SlitExtent], side: usize, found: &mut Vec<f64>) -> SlitCount {
    found.clear();
    let mut counting = Counting::default();
    for extent in extents {
        let end = extent.ends[side];
        let px = outside_px(seen, &end, side);
        if end.in_frame || px > 0.0 {
            counting.add(px, beyond(seen, px, END_LINES, &[end]), found);
        }
    }
    counting.finish(found)
}

/// Slits of which some light would fall on two surfaces.
fn lit_twice(seen: Seen<'_>, extents: &[SlitExtent], found: &mut Vec<f64>) -> SlitCount {
    found.clear();
    let mut counting = Counting::default();
    for overlap in extents.iter().filter_map(|e| e.overlap.as_ref()) {
        counting.add(overlap.px, beyond(seen, overlap.px, END_LINES, &overlap.ends), found);
    }
    counting.finish(found)
}

/// Slits that end on the border of the light, which lies inside the panel. None are tested where no border is seen.
fn inside(
    seen: Seen<'_>,
    extents: &[SlitExtent],
    side: usize,
    points: &mut Vec<BorderPoint>,
    found: &mut Vec<f64>,
) -> SlitCount {
    points.clear();
    let point = |e: &SlitExtent| {
        let End { at, step, in_frame, .. } = e.ends[side];
        in_frame.then_some(BorderPoint { coordinate: e.coordinate, at, step })
    };
    points.extend(extents.iter().filter_map(point));
    let (width, length) = (seen.positions.width_px(seen.axis), seen.positions.length_px(seen.axis));
    let Some(border) = border_at(points, extents.len(), width, found) else { return SlitCount::default() };
    let mut counting = Counting::default();
    found.clear();
    let off = if side == 0 { border + 0.5 } else { length - 0.5 - border };
    for end in extents.iter().map(|e| e.ends[side]).filter(|end| end.in_frame) {
        let px = -outside_px(seen, &end, side);
        let near = off <= BORDER_WITHIN * length && px <= 2.0 * BORDER_WITHIN * length;
        counting.add(px, near.then(|| beyond(seen, px, LOST_LINES, &[end])).flatten(), found);
    }
    counting.finish(found)
}
