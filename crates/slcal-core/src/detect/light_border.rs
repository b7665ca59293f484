//! The border of the projector's light where it runs over the sheet: it belongs to the panel, whatever is shown there.
//!
//! The board predicts where the panel's border is seen when the picture is shown pixel for pixel. The border is searched for on
//! lines across the predicted one, as the last place towards the outside that is lit.

use nalgebra::Point2;

use super::panel_view::PanelView;
use crate::pattern::CheckerPattern;
use crate::solve::{Polynomial, median, robust_scale};

/// How far outwards from its expected place the border is searched for, as a part of the panel's side: up to a picture that is shown
/// at two thirds of its size.
const REACH: f64 = 0.25;
/// Lines across a border, over its whole length and [`BEYOND`] it.
const LINES: u32 = 48;
const BEYOND: f64 = 0.1;
/// Distance of samples along a line, camera px: a blurred step extends over several.
const STEP_PX: f64 = 1.5;
/// A place is lit from this share of the step between a black and a white square on. A white wall nearby, and the lens's own
/// stray light, add less to the unlit part of the sheet.
const LIT: f64 = 0.15;
/// The light inside the border must be this share of that step brighter than outside.
const CONTRAST: f64 = 0.15;
/// Samples beside the step from which its plateaus are measured, counted from the last lit sample, and the samples that the unlit
/// part has at least.
const PLATEAU: std::ops::RangeInclusive<usize> = 4..=8;
/// A border is straight and parallel to the expected one: its slope against it at most, and its distance from its line, as a part
/// of the panel's side and in samples.
const MAX_SLOPE: f64 = 0.02;
const STRAIGHT: f64 = 0.002;
const STRAIGHT_STEPS: f64 = 2.0;
/// Fewest lines on which a border is seen, and how many times as many as those on which it should be seen and is not.
const MIN_LINES: usize = 6;
const MAJORITY: usize = 3;
/// The border's blur (from 80 % to 20 % of the step) at most, as a part of the panel's side and in samples. A projector's focus is
/// sharper; the shadow of something between projector and sheet is softer.
const SHARP: f64 = 0.008;
const SHARP_STEPS: f64 = 3.0;
/// σ of a point is no less than this, camera px: samples are this far apart after interpolation.
const FLOOR_SIGMA_PX: f64 = 0.1;

/// A side of the panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PanelSide {
    /// The coordinate that is constant along it: 0 for x (left and right), 1 for y (upper and lower).
    pub(super) axis: usize,
    /// Whether it is the one at the end of that axis (right or lower).
    pub(super) far: bool,
}

impl PanelSide {
    /// Upper, right, lower and left, as the footprint has them.
    pub(super) const ALL: [Self; 4] = [
        Self { axis: 1, far: false },
        Self { axis: 0, far: true },
        Self { axis: 1, far: true },
        Self { axis: 0, far: false },
    ];

    /// Its coordinate on the panel: a pixel extends half a pixel beyond its centre.
    pub(super) fn coordinate(self, panel: [u32; 2]) -> f64 {
        if self.far { f64::from(panel[self.axis]) - 0.5 } else { -0.5 }
    }

    /// The panel's position at a coordinate across the side and one along it.
    fn join(self, across: f64, along: f64) -> Point2<f64> {
        if self.axis == 0 { Point2::new(across, along) } else { Point2::new(along, across) }
    }
}

/// A border of the light that was seen.
#[derive(Debug, Clone)]
pub(super) struct LightBorder {
    pub(super) side: PanelSide,
    /// Points on it in the photograph, px.
    pub(super) points: Vec<Point2<f64>>,
    /// 1σ of each across the border, px.
    pub(super) sigma_px: f64,
    /// Its mean coordinate in the pattern's pixels, to the accuracy of the board's homography.
    pub(super) coordinate: f64,
}

/// Borders of the light on the sheet.
pub(super) fn find(view: &PanelView<'_>, pattern: &CheckerPattern) -> Vec<LightBorder> {
    let Some([black, white]) = view.levels(pattern).filter(|[black, white]| white > black) else {
        return Vec::new();
    };
    let search = |side| Search { view, pattern, side, black, step: white - black }.run();
    PanelSide::ALL.into_iter().filter_map(search).collect()
}

/// The search for one border.
struct Search<'a> {
    view: &'a PanelView<'a>,
    pattern: &'a CheckerPattern,
    side: PanelSide,
    /// Light under black squares, and how much brighter it is under white ones.
    black: f64,
    step: f64,
}

/// A line across the border: where it is seen, in the pattern's pixels outwards from its start, and where the light ends on it.
struct Profile {
    along: f64,
    seen: f64,
    end: Option<End>,
}

/// Where the light ends on a line, and how far it is blurred there.
#[derive(Clone, Copy)]
struct End {
    at: f64,
    blur: f64,
}

impl Search<'_> {
    fn run(&self) -> Option<LightBorder> {
        let panel = self.pattern.projector.map(f64::from);
        let (axis, side) = (self.side.axis, self.side);
        let length = panel[1 - axis];
        let at = |k: u32| length * ((1.0 + 2.0 * BEYOND) * (f64::from(k) + 0.5) / f64::from(LINES) - BEYOND);
        let middle = side.join(side.coordinate(self.pattern.projector), length / 2.0);
        let step = STEP_PX / self.view.scale(middle)[axis];
        let (start, outwards) = self.start();
        let reach = (side.coordinate(self.pattern.projector) - start) * outwards + REACH * panel[axis];
        let profiles: Vec<Profile> = (0..LINES)
            .map(at)
            .filter(|along| !self.is_marked(*along))
            .filter_map(|along| self.profile(along, start, step * outwards, reach))
            .collect();
        let tolerance = (STRAIGHT * panel[axis]).max(STRAIGHT_STEPS * step);
        let ends = consensus(&profiles, tolerance, 2.0 * *PLATEAU.end() as f64 * step)?;
        let blur = median(&mut ends.iter().map(|(_, end)| end.blur).collect::<Vec<_>>())?;
        if blur > (SHARP * panel[axis]).max(SHARP_STEPS * step) {
            return None;
        }
        let straight: Vec<(f64, f64, f64)> = ends.iter().map(|(along, end)| (*along, end.at, 1.0)).collect();
        let line = Polynomial::fit(&straight, 1)?;
        let scatter = robust_scale(straight.iter().map(|(along, at, _)| (at - line.value(*along)).abs()));
        let on_panel = |at: f64| start + at * outwards;
        let points: Vec<_> = straight
            .iter()
            .filter_map(|(along, at, _)| self.view.camera(side.join(on_panel(*at), *along)))
            .collect();
        let mean = straight.iter().map(|s| s.1).sum::<f64>() / straight.len() as f64;
        Some(LightBorder {
            side,
            points,
            sigma_px: (scatter * STEP_PX / step).max(FLOOR_SIGMA_PX),
            coordinate: on_panel(mean),
        })
    }

    /// Where lines across begin: outside of the board, half way to the border at most; and the direction of the border.
    fn start(&self) -> (f64, f64) {
        let [tl, _, br, _] = self.pattern.outline();
        let board = if self.side.far { br } else { tl }[self.side.axis];
        let border = self.side.coordinate(self.pattern.projector);
        let outwards = if self.side.far { 1.0 } else { -1.0 };
        let gap = ((border - board) * outwards).max(0.0);
        (board + outwards * (0.5 * gap).min(0.5 * self.pattern.square_px), outwards)
    }

    /// Whether a mark stands at this place of the border: its ring is as dark as the unlit sheet.
    fn is_marked(&self, along: f64) -> bool {
        let Some(marks) = &self.pattern.marks else { return false };
        let border = self.side.coordinate(self.pattern.projector);
        let near = |c: &Point2<f64>| {
            (c[self.side.axis] - border).abs() < marks.side_px
                && (c[1 - self.side.axis] - along).abs() < marks.side_px
        };
        marks.centres_px.iter().any(near)
    }

    /// The light along a line; `None` where its start is not lit.
    fn profile(&self, along: f64, start: f64, step: f64, reach: f64) -> Option<Profile> {
        let samples = (reach / step.abs()) as u32;
        let light = |k: u32| self.view.light(self.side.join(start + f64::from(k) * step, along));
        let light: Vec<f64> = (0..samples).map_while(light).map(|l| (l - self.black) / self.step).collect();
        let lit_start =
            light.iter().take(*PLATEAU.end()).all(|l| *l > LIT) && light.len() > 2 * PLATEAU.end();
        let step = step.abs();
        lit_start.then(|| Profile { along, seen: light.len() as f64 * step, end: light_end(&light, step) })
    }
}

/// Where the light ends for good; `None` where it does not, or not in a step.
fn light_end(light: &[f64], step: f64) -> Option<End> {
    let last = light.iter().rposition(|l| *l > LIT)?;
    let outside = light.get(last + PLATEAU.start()..=last + PLATEAU.end())?;
    let inside = light.get(last.checked_sub(*PLATEAU.end())?..=last - PLATEAU.start())?;
    let [inside, outside] = [inside, outside].map(|plateau| median(&mut plateau.to_vec()));
    let (inside, outside) = (inside?, outside?);
    if inside - outside < CONTRAST {
        return None;
    }
    let around = last - PLATEAU.end()..last + PLATEAU.end();
    // The last place at which a share of the step is passed.
    let passed = |share: f64| {
        let level = outside + share * (inside - outside);
        let k = around.clone().rev().find(|&k| light[k] >= level && light[k + 1] < level)?;
        Some((k as f64 + (light[k] - level) / (light[k] - light[k + 1])) * step)
    };
    Some(End { at: passed(0.5)?, blur: passed(0.2)? - passed(0.8)? })
}

/// The ends that lie on one line almost parallel to the border; `None` where too few do. Lines on which it should be seen, `clear`
/// of their end, and is not, count against it.
fn consensus(profiles: &[Profile], tolerance: f64, clear: f64) -> Option<Vec<(f64, End)>> {
    let ends: Vec<(f64, End)> = profiles.iter().filter_map(|p| Some((p.along, p.end?))).collect();
    let mut best: Option<(usize, Vec<(f64, End)>)> = None;
    for (i, a) in ends.iter().enumerate() {
        for b in &ends[i + 1..] {
            let slope = (b.1.at - a.1.at) / (b.0 - a.0);
            if slope.abs() > MAX_SLOPE {
                continue;
            }
            let line = |along: f64| a.1.at + slope * (along - a.0);
            let on_line = |(along, end): &&(f64, End)| (end.at - line(*along)).abs() <= tolerance;
            let count = ends.iter().filter(on_line).count();
            if best.as_ref().is_some_and(|(most, _)| count <= *most) {
                continue;
            }
            let expected = profiles.iter().filter(|p| p.seen > line(p.along) + clear).count();
            let missing = expected.saturating_sub(count);
            if count >= MIN_LINES && count >= MAJORITY * missing {
                best = Some((count, ends.iter().filter(on_line).copied().collect()));
            }
        }
    }
    best.map(|(_, ends)| ends)
}
