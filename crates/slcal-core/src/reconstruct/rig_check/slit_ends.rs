//! What is seen of a slit: from where to where on the panel its light comes, and whether two surfaces share some of it.

use super::panel_position::{PanelPositions, coded};
use super::scanline_runs::Run;
use crate::matches::Match;

/// Ends this close to the border of the image are no ends of the light: scanlines, and a share of the image's side.
const NEAR_BORDER_LINES: f64 = 4.0;
const NEAR_BORDER_SHARE: f64 = 1.0 / 128.0;

/// An end of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct End {
    /// Its match.
    pub(super) index: usize,
    /// Position of its light along the slit, px on the panel.
    pub(super) at: f64,
    /// Positions per scanline there, px: no end is known better.
    pub(super) step: f64,
    /// Whether the photograph goes on beyond it.
    pub(super) in_frame: bool,
}

/// A run of which it is known from where on the panel its light comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocatedRun {
    slit: u16,
    coordinate: f64,
    /// Lower position first.
    ends: [End; 2],
}

/// Light of one slit that would fall on two surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overlap {
    /// Its length, px on the panel; negative for a gap between the surfaces.
    pub(super) px: f64,
    /// The end of one surface's light, and the beginning of the other's.
    pub(super) ends: [End; 2],
}

/// What is seen of a slit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SlitExtent {
    /// The coded coordinate, px on the panel.
    pub(super) coordinate: f64,
    /// The outermost ends: at the lowest and at the highest position.
    pub(super) ends: [End; 2],
    /// The longest overlap of two surfaces; `None` where only one is seen.
    pub(super) overlap: Option<Overlap>,
}

/// What matches say where.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen<'a> {
    pub(super) positions: &'a PanelPositions,
    pub(super) matches: &'a [Match],
    /// The image coordinate that was measured along scanlines.
    pub(super) across: usize,
    /// 0 for slits that are columns, 1 for rows.
    pub(super) axis: usize,
}

impl Seen<'_> {
    /// The extents of all slits whose coordinate is of the axis, in the order of their coordinates.
    pub(super) fn extents(&self, runs: &[Run], located: &mut Vec<LocatedRun>, out: &mut Vec<SlitExtent>) {
        located.clear();
        located.extend(runs.iter().filter_map(|run| {
            let (axis, coordinate) = coded(&self.matches[run.first[0]])?;
            let ends = (axis == self.axis).then(|| self.ends(run))??;
            Some(LocatedRun { slit: run.slit, coordinate, ends })
        }));
        out.clear();
        out.extend(located.chunk_by(|a, b| a.slit == b.slit).filter_map(extent));
        out.sort_unstable_by(|a, b| a.coordinate.total_cmp(&b.coordinate));
    }

    /// The ends of a run, lower position first.
    fn ends(&self, run: &Run) -> Option<[End; 2]> {
        let (a, b) = (self.end(run.first)?, self.end(run.last)?);
        Some(if a.at <= b.at { [a, b] } else { [b, a] })
    }

    fn end(&self, [index, inner]: [usize; 2]) -> Option<End> {
        let at = |i: usize| {
            let (axis, coordinate) = coded(&self.matches[i])?;
            self.positions.at(&self.matches[i], axis, coordinate)
        };
        let (outer, inner_at) = (at(index)?, at(inner)?);
        let line = |i: usize| self.matches[i].camera[1 - self.across];
        let lines = (line(index) - line(inner)).abs().max(1.0);
        let step = (outer - inner_at).abs() / lines;
        Some(End { index, at: outer, step, in_frame: self.in_frame(index) })
    }

    fn in_frame(&self, index: usize) -> bool {
        let (pixel, size) = (self.matches[index].camera, self.positions.image_px());
        (0..2).all(|k| {
            let near = if k == self.across { NEAR_BORDER_SHARE * size[k] } else { NEAR_BORDER_LINES };
            pixel[k] >= near && pixel[k] <= size[k] - 1.0 - near
        })
    }
}

/// What all runs of a slit say together.
fn extent(of_slit: &[LocatedRun]) -> Option<SlitExtent> {
    let first = of_slit.first()?;
    let mut extent = SlitExtent { coordinate: first.coordinate, ends: first.ends, overlap: None };
    for (i, LocatedRun { ends, .. }) in of_slit.iter().enumerate().skip(1) {
        for other in &of_slit[..i] {
            extent.overlap = longer(extent.overlap, Some(overlap_of(*ends, other.ends)));
        }
        if ends[0].at < extent.ends[0].at {
            extent.ends[0] = ends[0];
        }
        if ends[1].at > extent.ends[1].at {
            extent.ends[1] = ends[1];
        }
    }
    Some(extent)
}

fn overlap_of(a: [End; 2], b: [End; 2]) -> Overlap {
    let end = if a[1].at <= b[1].at { a[1] } else { b[1] };
    let beginning = if a[0].at >= b[0].at { a[0] } else { b[0] };
    Overlap { px: end.at - beginning.at, ends: [end, beginning] }
}

fn longer(a: Option<Overlap>, b: Option<Overlap>) -> Option<Overlap> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.px > a.px { b } else { a }),
        (one, other) => one.or(other),
    }
}
