//! Which way round a sheet lies whose paper was named without saying it: both are tried in every photograph.

use super::outline_fit::Outlines;
use crate::calibrate::config::CalibrateConfig;
use crate::geometry::RectangleSize;
use crate::observations::Observations;

/// By how much χ² of one way must be below that of the other: 4σ.
const CLEARLY_LESS: f64 = 16.0;

/// How a sheet lies in a photograph.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SheetLies {
    /// Its shorter side along the image's x axis.
    Upright,
    /// Its longer side along the image's x axis.
    Across,
    /// Both fit as well; it is taken for upright.
    Undecided,
}

/// Finds how the sheets lie that are not in `known` yet, which has those of the first views, and sets their sizes. Each is
/// decided by its own photograph; where that does not tell, together with the photographs that are decided.
pub(crate) fn orient(all: &mut Observations, known: &mut Vec<SheetLies>, config: &CalibrateConfig) {
    for i in known.len()..all.views.len() {
        known.push(decide(all, &[], i, config));
        lay(&mut all.views[i].size, known[i]);
    }
    for i in 0..known.len() {
        let others: Vec<usize> = (0..known.len()).filter(|&i| known[i] != SheetLies::Undecided).collect();
        if known[i] == SheetLies::Undecided && !others.is_empty() {
            known[i] = decide(all, &others, i, config);
            lay(&mut all.views[i].size, known[i]);
        }
    }
}

/// Turns a size so that its sheet lies that way.
fn lay(size: &mut RectangleSize, lies: SheetLies) {
    let across = size.width_mm > size.height_mm;
    if across != (lies == SheetLies::Across) {
        *size = size.transposed();
    }
}

/// How the sheet of a view lies, by its photograph and those of others.
fn decide(all: &Observations, others: &[usize], view: usize, config: &CalibrateConfig) -> SheetLies {
    let mut some = Observations { projector: None, views: Vec::new(), ..*all };
    some.views.extend(others.iter().chain([&view]).map(|&i| all.views[i].clone()));
    let Some(outlines) = Outlines::new(&some, config) else { return SheetLies::Undecided };
    let mut sizes: Vec<RectangleSize> = some.views.iter().map(|v| v.size).collect();
    let last = sizes.len() - 1;
    let [upright, across] = [SheetLies::Upright, SheetLies::Across].map(|lies| {
        lay(&mut sizes[last], lies);
        outlines.chi2(&sizes)
    });
    match across - upright {
        less if less < -CLEARLY_LESS => SheetLies::Across,
        more if more > CLEARLY_LESS => SheetLies::Upright,
        _ => SheetLies::Undecided,
    }
}
