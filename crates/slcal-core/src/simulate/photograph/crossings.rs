//! Exact correspondences: where the camera sees slits and corners of a pattern.

use nalgebra::{Point2, Point3};

use super::photographer::Photographer;
use super::ray_tracer::RayTracer;
use super::truth::StoredTruth;
use crate::geometry::Ray;
use crate::matches::{Match, Matches};
use crate::pattern::{Axis, CheckerPattern, StripePattern};

/// Stated σ of the matches, px: the smallest that files hold.
const SIGMA_PX: f64 = 1e-5;
/// A crossing has converged when the panel position is right to this, panel px.
const FOUND_PX: f64 = 1e-9;
/// A crossing that never comes closer than this is a jump between parts of the surface, panel px.
const JUMP_PX: f64 = 1e-6;
/// The false position method halves at least every other step: more than doubles have bits.
const MOST_STEPS: usize = 120;
/// A point is occluded when a device sees a surface nearer by this share of its distance.
const HIDDEN: f64 = 1e-7;

impl Photographer {
    /// The true crossings of every scanline of the photograph with the middle of every visible slit, ordered by line
    /// and position. Scanlines are image rows or columns, whichever the stripes cross: rows for vertical slits and an
    /// upright camera.
    #[must_use]
    pub fn stripe_matches(&self, pattern: &StripePattern) -> Matches {
        let truth = self.truth();
        let k = usize::from(pattern.axis == Axis::Rows);
        // As it lies on the panel. Slits keep the numbers that the pattern as drawn gives them.
        let on_panel = if self.mirrored { pattern.mirrored() } else { pattern.clone() };
        let number = |slit| if self.mirrored && k == 0 { on_panel.sequence.len() - 1 - slit } else { slit };
        let along_rows = self.varies_along_rows(k);
        let (lines, length) =
            if along_rows { (truth.height, truth.width) } else { (truth.width, truth.height) };
        let place = |line: usize, i: f64| {
            if along_rows { Point2::new(i, line as f64) } else { Point2::new(line as f64, i) }
        };
        let pixel = |line, i| if along_rows { truth.pixel(i, line) } else { truth.pixel(line, i) };
        let mut items = Vec::new();
        for line in 0..lines {
            for i in 1..length {
                let Some((a, b)) = pixel(line, i - 1).zip(pixel(line, i)) else { continue };
                if a.surface != b.surface || !(a.is_lit() && b.is_lit()) {
                    continue;
                }
                for slit in between(&on_panel.centres_px, a.panel[k], b.panel[k]) {
                    let centre = on_panel.centres_px[slit];
                    let at = |t: f64| place(line, i as f64 - 1.0 + t);
                    let Some(t) = crossing(&self.tracer, (a, b), k, centre, at) else { continue };
                    let (column, row) = if k == 0 { (Some(centre), None) } else { (None, Some(centre)) };
                    items.push(exact(at(t), column, row, u16::try_from(number(slit)).ok()));
                }
            }
        }
        Matches { items }
    }

    /// The visible inner corners of a checkerboard, row by row of the panel, with projector column and row.
    #[must_use]
    pub fn corner_matches(&self, pattern: &CheckerPattern) -> Matches {
        let seen = |q: Point2<f64>| Some(exact(self.corner(q)?, Some(q.x), Some(q.y), None));
        let on_panel = if self.mirrored { pattern.mirrored() } else { pattern.clone() };
        Matches { items: on_panel.inner_corners().into_iter().filter_map(seen).collect() }
    }

    /// The camera pixel at which the light of panel position `q` is seen.
    fn corner(&self, q: Point2<f64>) -> Option<Point2<f64>> {
        let tracer = &self.tracer;
        let out = tracer.projector_from_camera.rotation.inverse() * tracer.projector.bearing(q)?;
        let beam = Ray { origin: tracer.lamp, direction: out };
        let (surface, distance, _) = tracer.nearest(&beam)?;
        let point = beam.origin + beam.direction * distance;
        let p = tracer.camera.project(&point)?;
        let inside = |v: f64, n: u32| v >= -0.5 && v <= f64::from(n) - 0.5;
        if !(inside(p.x, tracer.camera.width) && inside(p.y, tracer.camera.height)) {
            return None;
        }
        let hit = tracer.trace(p)?;
        let nearer = (hit.point - Point3::origin()).norm() < (1.0 - HIDDEN) * point.coords.norm();
        (hit.surface == surface && hit.panel.is_some() && !nearer).then_some(p)
    }

    /// Whether the panel's column (`k` = 0) or row (1) changes more from pixel to pixel along image rows than along columns.
    fn varies_along_rows(&self, k: usize) -> bool {
        let truth = self.truth();
        let change = |a: &StoredTruth, b: Option<&StoredTruth>| {
            let step = b.filter(|b| b.surface == a.surface).map_or(f64::NAN, |b| b.panel[k] - a.panel[k]);
            if step.is_nan() { 0.0 } else { step.abs() }
        };
        let mut sums = [0.0; 2];
        for (i, pixel) in truth.pixels.iter().enumerate() {
            let (x, y) = (i % truth.width, i / truth.width);
            sums[0] += change(pixel, truth.pixel(x + 1, y));
            sums[1] += change(pixel, truth.pixel(x, y + 1));
        }
        sums[0] >= sums[1]
    }
}

/// The indices of the slits between two panel positions, in the order from the first to the second. Of two pixels that
/// share an end, one has it.
fn between(centres: &[f64], a: f64, b: f64) -> Vec<usize> {
    let below = |v: f64| centres.partition_point(|c| *c < v);
    let up_to = |v: f64| centres.partition_point(|c| *c <= v);
    if a < b { (below(a)..below(b)).collect() } else { (up_to(b)..up_to(a)).rev().collect() }
}

/// Where, from pixel `a` (0) to pixel `b` (1), the panel position is `centre`: by false position, halving the weight of
/// an end that stays.
fn crossing(
    tracer: &RayTracer,
    (a, b): (&StoredTruth, &StoredTruth),
    k: usize,
    centre: f64,
    at: impl Fn(f64) -> Point2<f64>,
) -> Option<f64> {
    let (mut low, mut high) = ((0.0, a.panel[k] - centre), (1.0, b.panel[k] - centre));
    let mut best = if low.1.abs() < high.1.abs() { low } else { high };
    let mut stayed = 0;
    for _ in 0..MOST_STEPS {
        if best.1.abs() <= FOUND_PX {
            break;
        }
        let t = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let hit = tracer.trace(at(t)).filter(|l| l.surface == a.surface as usize)?;
        let f = hit.panel?[k] - centre;
        if f.abs() < best.1.abs() {
            best = (t, f);
        }
        if (f > 0.0) == (high.1 > 0.0) {
            high = (t, f);
            low.1 = if stayed == 1 { low.1 / 2.0 } else { low.1 };
            stayed = 1;
        } else {
            low = (t, f);
            high.1 = if stayed == 2 { high.1 / 2.0 } else { high.1 };
            stayed = 2;
        }
    }
    (best.1.abs() <= JUMP_PX).then_some(best.0)
}

fn exact(
    camera: Point2<f64>,
    projector_column: Option<f64>,
    projector_row: Option<f64>,
    slit: Option<u16>,
) -> Match {
    Match {
        camera,
        projector_column,
        projector_row,
        slit,
        confidence: 1.0,
        sigma_px: SIGMA_PX,
        color: [255; 3],
    }
}
