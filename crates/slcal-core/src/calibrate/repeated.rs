//! The same photograph given twice: it counts once.

use std::borrow::Cow;

use crate::observations::{EdgePoint, Observations, SheetObservation, UNKNOWN_SIGMA_PX, ViewObservation};
use crate::rig::Warning;

/// Two photographs of one scene differ by their noise, √2 σ or, for correlated points, a fourth of that; the same
/// photograph, encoded again, by less than this part of σ.
const SAME: f64 = 0.05;

/// Points and σ of everything that was measured in a view.
fn points(view: &ViewObservation) -> Vec<EdgePoint> {
    let mut all: Vec<EdgePoint> = match &view.sheet {
        SheetObservation::Edges(sides) => sides.iter().flatten().copied().collect(),
        SheetObservation::Corners { corners, sigma_px } => {
            corners.iter().map(|&position| EdgePoint { position, sigma_px: *sigma_px }).collect()
        }
    };
    all.extend(view.pairs.iter().map(|p| EdgePoint { position: p.camera, sigma_px: p.sigma_px }));
    all
}

fn same(a: &[EdgePoint], b: &[EdgePoint]) -> bool {
    let off = |(p, q): (&EdgePoint, &EdgePoint)| {
        (p.position - q.position).norm() / p.sigma_px.unwrap_or(UNKNOWN_SIGMA_PX)
    };
    a.len() == b.len() && a.iter().zip(b).all(|pair| off(pair) < SAME)
}

/// For each view the first one that is the same photograph, itself if there is none before.
fn firsts(observations: &Observations) -> Vec<usize> {
    if observations.views.len() == 1 {
        return vec![0];
    }
    let seen: Vec<_> = observations.views.iter().map(points).collect();
    (0..seen.len()).map(|j| (0..j).find(|&i| same(&seen[i], &seen[j])).unwrap_or(j)).collect()
}

/// How often each view's photograph was given.
pub(crate) fn copies(observations: &Observations) -> Vec<usize> {
    let firsts = firsts(observations);
    firsts.iter().map(|first| firsts.iter().filter(|f| *f == first).count()).collect()
}

/// The observations with the σ of a photograph that is given n times √n times as large, so that all together weigh what one
/// does; and a warning about the first repetition.
pub(crate) fn counted_once(observations: &Observations) -> (Cow<'_, Observations>, Option<Warning>) {
    let firsts = firsts(observations);
    let Some(j) = (0..firsts.len()).find(|&j| firsts[j] != j) else {
        return (Cow::Borrowed(observations), None);
    };
    let copies = copies(observations);
    let mut all = observations.clone();
    for (view, first) in all.views.iter_mut().zip(&firsts) {
        let times = (copies[*first] as f64).sqrt();
        let wider = |sigma: Option<f64>| sigma.map(|s| s * times);
        view.map_sigma(wider, wider);
    }
    let warning = Warning::new(
        "photograph-repeated",
        format!("photographs {} and {} are the same one: together they count once", firsts[j] + 1, j + 1),
        "give each photograph once, and photograph the sheet with its tilt reversed for more certainty",
    );
    (Cow::Owned(all), Some(warning))
}
