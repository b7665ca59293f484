//! Projected corners beside their predicted positions.

use nalgebra::Point2;
use slcal_core::Rig;
use slcal_core::detect::Detection;
use slcal_core::verify::{Verification, expected_corner};

use super::drawing::color::GREEN;
use super::drawing::{Drawing, Pen};
use super::{sheet, vector_scale};
use crate::name::short;

/// The corners found in a photograph called `name`, arrows to their predicted positions, and `verdict` in words.
pub(crate) fn drawing(
    size: [u32; 2],
    name: &str,
    verdict: &str,
    found: &Detection,
    rig: &Rig,
    result: &Verification,
) -> Drawing {
    let (name, view) = (short(name), &found.observation);
    let mut drawing = Drawing::new(size, format!("{name}: {verdict}"));
    sheet::draw_sheet(&mut drawing, view);
    let pose = &result.camera_from_sheet;
    let pairs: Vec<(Point2<f64>, Point2<f64>)> = view
        .pairs
        .iter()
        .filter_map(|p| Some((p.camera, expected_corner(rig, pose, p.projector)?)))
        .collect();
    let shown = vector_scale::SHOWN * drawing.unit();
    let factor = vector_scale::factor(pairs.iter().map(|(seen, there)| (there - seen).norm()), shown);
    let pen = Pen::new(GREEN).width(1.3);
    drawing.arrows(pairs.iter().map(|(seen, there)| (*seen, seen + (there - seen) * factor)), pen);
    sheet::draw_marks(&mut drawing, view);
    let mut legend = sheet::legend(format!("{name}: {verdict}"), [view]);
    if !pairs.is_empty() {
        let what = "to the predicted position of each corner";
        legend = vector_scale::explained(legend, &drawing, factor, pen, what);
    }
    drawing.legend = Some(legend);
    drawing
}
