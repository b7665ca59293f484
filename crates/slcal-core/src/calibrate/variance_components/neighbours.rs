//! Correlation of neighbouring edge points: if they counted as independent, σ of the result would be too small.

use crate::estimate::side::SideInImage;
use crate::estimate::{Model, Target, measurements};
use crate::geometry::Side;
use crate::observations::Observations;

/// Residuals beyond this many σ are outliers.
const OUTLIER: f64 = 4.7;
/// Neighbours are never taken for more alike than this: what they have in common then is the model's error.
const MOST_ALIKE: f64 = 0.9;

/// One side of one view: signed residuals, each with its place along the side.
struct SideResiduals {
    view: usize,
    side: Side,
    list: Vec<(f64, f64)>,
}

/// By how much σ of the edge points of the wanted views is to be widened so that they may count as independent: as for
/// sequences in which each residual resembles the one before by ρ, √((1 + ρ)/(1 − ρ)); 1 when chance explains ρ.
pub(crate) fn widening(all: &Observations, wanted: &[bool], model: &Model, sigma_px: f64) -> f64 {
    let (mut products, mut squares, mut count) = (0.0, 0.0, 0.0);
    for mut side in residuals(all, wanted, model) {
        side.list.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in side.list.windows(2) {
            let [a, b] = [pair[0].1, pair[1].1];
            if a.abs().max(b.abs()) < OUTLIER * sigma_px {
                products += a * b;
                squares += f64::midpoint(a * a, b * b);
                count += 1.0;
            }
        }
    }
    let alike: f64 = if squares > 0.0 { products / squares } else { 0.0 };
    // Chance stays within 2/√n of zero 95 % of the time.
    if alike * f64::sqrt(count) <= 2.0 {
        return 1.0;
    }
    let alike = alike.min(MOST_ALIKE);
    ((1.0 + alike) / (1.0 - alike)).sqrt()
}

fn residuals(all: &Observations, wanted: &[bool], model: &Model) -> Vec<SideResiduals> {
    let mut sides: Vec<SideResiduals> = Vec::new();
    let corners: Vec<_> = all.views.iter().map(|v| v.sheet.corners()).collect();
    for m in measurements(all).into_iter().filter(|m| wanted[m.view]) {
        let Target::Edge(side) = m.of else { continue };
        let (Some(sheet), Some(c)) = (model.views.get(m.view), corners[m.view]) else { continue };
        let found = SideInImage::new(&model.camera, sheet, side).and_then(|s| s.residual(m.seen));
        let Some(r) = found else { continue };
        let along = c[(side as usize + 1) % 4] - c[side as usize];
        let point = ((m.seen - c[side as usize]).dot(&along), r.value.x);
        match sides.last_mut() {
            Some(last) if last.view == m.view && last.side == side => last.list.push(point),
            _ => sides.push(SideResiduals { view: m.view, side, list: vec![point] }),
        }
    }
    sides
}
