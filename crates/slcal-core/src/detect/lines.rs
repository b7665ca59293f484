//! Straight edges of a photograph: a Hough transform over oriented edge pixels.

use nalgebra::{Point2, Vector3};

use super::edge_map::{EdgeMap, Edgel};
use crate::geometry::Line;

/// Bins of the normal's direction over the full circle: dark-to-bright distinguishes opposite sides of a sheet.
const ANGLE_BINS: usize = 360;
/// An edge pixel votes for the bins within this many of its direction: the scatter of the gradients of weak edges.
const ANGLE_SPREAD: isize = 3;
/// Width of a bin of the distance, in downsampled pixels.
const DISTANCE_BIN: f64 = 1.5;
/// Pixels within this distance of a line support it, in downsampled pixels: sides of a sheet seen through an ordinary
/// lens are curved by less.
const SUPPORT_DISTANCE: f64 = 2.5;
/// cos 12°.
const SUPPORT_COSINE: f64 = 0.978;
/// Shortest supported length of a line, as a part of the diagonal.
const MIN_LENGTH: f64 = 0.06;
/// Largest number of lines kept. Sheets have four sides; clutter, print and texture add others.
const MAX_LINES: usize = 48;

/// A straight edge; its normal points to the bright side.
#[derive(Debug, Clone)]
pub(super) struct EdgeLine {
    /// Normalized, in downsampled pixels.
    pub(super) line: Line,
    /// Number of supported unit steps before each position along the line, counted from `first`.
    cumulative: Vec<u32>,
    first: f64,
}

impl EdgeLine {
    fn direction(&self) -> nalgebra::Vector2<f64> {
        nalgebra::Vector2::new(-self.line.0.y, self.line.0.x)
    }

    /// Position along the line of the foot of `p`.
    pub(super) fn along(&self, p: Point2<f64>) -> f64 {
        self.direction().dot(&p.coords)
    }

    /// The share of an interval along the line that edge pixels support.
    pub(super) fn support(&self, from: f64, to: f64) -> f64 {
        let (from, to) = (from.min(to), from.max(to));
        let index = |s: f64| ((s - self.first).round().max(0.0) as usize).min(self.cumulative.len() - 1);
        let count = self.cumulative[index(to)] - self.cumulative[index(from)];
        f64::from(count) / (to - from).max(1.0)
    }

    /// The length that edge pixels support, in downsampled pixels.
    pub(super) fn length(&self) -> f64 {
        f64::from(*self.cumulative.last().unwrap_or(&0))
    }
}

/// The most supported straight edges among the edge pixels that `keep` admits, the longest first.
pub(super) fn find_lines(map: &EdgeMap<'_>, keep: impl Fn(&Edgel) -> bool) -> Vec<EdgeLine> {
    let mut edgels: Vec<Edgel> = map.edgels.iter().copied().filter(keep).collect();
    let mut votes = Votes::new(map);
    for e in &edgels {
        votes.cast(e, 1);
    }
    let least = MIN_LENGTH * map.diagonal();
    let mut lines: Vec<EdgeLine> = Vec::new();
    // Peaks with too short a line are skipped. The number of attempts is bounded for textured photographs.
    for _ in 0..4 * MAX_LINES {
        let Some(peak) = votes.peak(least) else { break };
        let (supporting, line) = refine(&edgels, peak);
        let taken: Vec<Edgel> = if supporting.is_empty() {
            edgels.iter().copied().filter(|e| supports(&peak, e)).collect()
        } else {
            supporting
        };
        if taken.is_empty() {
            votes.clear(&peak);
            continue;
        }
        for e in &taken {
            votes.cast(e, -1);
        }
        let line = line.unwrap_or(peak);
        edgels.retain(|e| !supports(&line, e));
        let found = EdgeLine::new(line, &taken);
        if found.length() >= least {
            lines.push(found);
            if lines.len() == MAX_LINES {
                break;
            }
        }
    }
    lines.sort_by(|a, b| b.length().total_cmp(&a.length()));
    lines
}

fn supports(line: &Line, e: &Edgel) -> bool {
    line.signed_distance_px(e.position).abs() <= SUPPORT_DISTANCE
        && line.normal().dot(&e.normal) >= SUPPORT_COSINE
}

/// Least squares over the supporting pixels, twice, so that the fit does not depend on the bins.
fn refine(edgels: &[Edgel], peak: Line) -> (Vec<Edgel>, Option<Line>) {
    let mut line = peak;
    let mut supporting = Vec::new();
    for _ in 0..2 {
        supporting = edgels.iter().copied().filter(|e| supports(&line, e)).collect();
        let points = supporting.iter().map(|e: &Edgel| (e.position, f64::from(e.strength)));
        let Some(fitted) = Line::fit(points) else { return (Vec::new(), None) };
        let sign = fitted.normal().dot(&line.normal()).signum();
        line = Line(fitted.0 * sign);
    }
    supporting.retain(|e| supports(&line, e));
    (supporting, Some(line))
}

impl EdgeLine {
    fn new(line: Line, supporting: &[Edgel]) -> Self {
        let direction = nalgebra::Vector2::new(-line.0.y, line.0.x);
        let positions: Vec<f64> = supporting.iter().map(|e| direction.dot(&e.position.coords)).collect();
        let first = positions.iter().copied().fold(f64::INFINITY, f64::min).floor() - 1.0;
        let last = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max).ceil() + 1.0;
        let bins = if last >= first { (last - first) as usize + 2 } else { 1 };
        let mut filled = vec![false; bins];
        for s in positions {
            // A line at 45° has an edge pixel every 1.4 px: each fills its neighbours as well.
            let at = (s - first).round() as usize;
            for bin in filled.iter_mut().take((at + 2).min(bins)).skip(at.saturating_sub(1)) {
                *bin = true;
            }
        }
        let mut cumulative = Vec::with_capacity(bins + 1);
        cumulative.push(0);
        for f in filled {
            cumulative.push(cumulative[cumulative.len() - 1] + u32::from(f));
        }
        Self { line, cumulative, first }
    }
}

/// The accumulator over direction and distance of the normal.
struct Votes {
    bins: Vec<i32>,
    distances: usize,
    offset: f64,
}

impl Votes {
    fn new(map: &EdgeMap<'_>) -> Self {
        let offset = map.diagonal();
        let distances = (2.0 * offset / DISTANCE_BIN).ceil() as usize + 1;
        Self { bins: vec![0; ANGLE_BINS * distances], distances, offset }
    }

    fn cast(&mut self, e: &Edgel, weight: i32) {
        let own = (e.normal.y.atan2(e.normal.x).to_degrees()).round() as isize;
        for k in -ANGLE_SPREAD..=ANGLE_SPREAD {
            let bin = (own + k).rem_euclid(ANGLE_BINS as isize) as usize;
            let (sin, cos) = (bin as f64).to_radians().sin_cos();
            let distance = cos * e.position.x + sin * e.position.y;
            let d = ((distance + self.offset) / DISTANCE_BIN).round() as usize;
            self.bins[bin * self.distances + d.min(self.distances - 1)] += weight;
        }
    }

    /// The line of the highest bin, if it has at least `least` votes.
    fn peak(&self, least: f64) -> Option<Line> {
        let (at, &count) = self.bins.iter().enumerate().max_by_key(|&(i, &v)| (v, std::cmp::Reverse(i)))?;
        // A line between two bins splits its votes.
        if f64::from(count) < 0.5 * least {
            return None;
        }
        let (bin, d) = (at / self.distances, at % self.distances);
        let (sin, cos) = (bin as f64).to_radians().sin_cos();
        Some(Line(Vector3::new(cos, sin, self.offset - d as f64 * DISTANCE_BIN)))
    }

    /// Empties the bin of a peak that no pixel supports.
    fn clear(&mut self, peak: &Line) {
        let bin =
            peak.0.y.atan2(peak.0.x).to_degrees().round().rem_euclid(ANGLE_BINS as f64) as usize % ANGLE_BINS;
        let d = ((self.offset - peak.0.z) / DISTANCE_BIN).round() as usize;
        self.bins[bin * self.distances + d.min(self.distances - 1)] = 0;
    }
}
