//! Whether observations can be calibrated from at all.

use nalgebra::Point2;

use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::RectangleSize;
use crate::observations::{Observations, SheetObservation, ViewObservation};

/// A sheet whose image covers less than this part of the image is a speck.
const SMALLEST_AREA_SHARE: f64 = 1e-5;
/// Sine of the angle at a corner below which three corners count as collinear.
const FLATTEST_SINE: f64 = 1e-3;
/// By how much the proportions of the sheet's image may differ from those of its size: a sheet is seen this much narrower
/// when it stands 3° from edge-on.
const MOST_FORESHORTENED: f64 = 20.0;
/// Fewest projected corners from which a homography follows.
const FEWEST_PAIRS: usize = 4;

/// Checks sizes, numbers, counts and the order of corners.
///
/// # Errors
/// [`Error::Invalid`] naming the view and what is wrong with it.
pub(crate) fn validate(observations: &Observations) -> Result<()> {
    if observations.views.is_empty() {
        return Err(Error::invalid(ErrorSubject::Observations, "at least one view of the sheet", "none"));
    }
    let panels =
        [Some(("camera image", observations.camera)), observations.projector.map(|p| ("projector panel", p))];
    for (name, [w, h]) in panels.into_iter().flatten() {
        if w < 2 || h < 2 {
            let what = ErrorSubject::Part { part: "size", of: name };
            return Err(Error::invalid(what, "at least 2x2 px", format!("{w}x{h}")));
        }
    }
    for (i, view) in observations.views.iter().enumerate() {
        check_view(view, i, observations)?;
    }
    Ok(())
}

fn check_view(view: &ViewObservation, i: usize, observations: &Observations) -> Result<()> {
    RectangleSize::new(view.size.width_mm, view.size.height_mm)?;
    let what = |part: &'static str| ErrorSubject::View { index: i, part };
    let (mut count, mut bad) = (0, 0);
    let mut number = |p: Point2<f64>, sigma: Option<f64>| {
        count += 1;
        let positive = sigma.is_none_or(|s| s.is_finite() && s > 0.0);
        bad += usize::from(!(p.x.is_finite() && p.y.is_finite() && positive));
    };
    match &view.sheet {
        SheetObservation::Corners { corners, sigma_px } => corners.iter().for_each(|c| number(*c, *sigma_px)),
        SheetObservation::Edges(sides) => {
            sides.iter().flatten().for_each(|p| number(p.position, p.sigma_px));
        }
    }
    for p in &view.pairs {
        number(p.camera, p.sigma_px);
        number(p.projector, None);
    }
    if bad > 0 {
        let found = format!("{bad} of {count} points without");
        return Err(Error::invalid(what("points"), "finite coordinates and positive σ", found));
    }
    let pairs = view.pairs.iter().map(|p| p.sigma_px.is_some());
    let sheet = view.sheet_sigmas().map(|s| s.is_some());
    if differ(pairs) || differ(sheet) {
        let expected = "of all points of a sheet or of a pattern, or of none";
        return Err(Error::invalid(what("σ"), expected, "of some"));
    }
    if let Some(wrong) = view.panel_points.iter().find(|p| !p.is_valid()) {
        let expected = "finite camera coordinates, one place on the panel at least, and a positive σ";
        return Err(Error::invalid(what("points of the panel"), expected, format!("{wrong:?}")));
    }
    if let Some(wrong) = view.channel_offsets.iter().find(|o| !o.is_valid()) {
        return Err(Error::invalid(
            what("offsets of the channels"),
            "finite coordinates and positive σ",
            format!("{wrong:?}"),
        ));
    }
    if let SheetObservation::Edges(sides) = &view.sheet
        && let Some(fewest) = sides.iter().map(Vec::len).min()
        && fewest < 2
    {
        return Err(Error::invalid(what("edge points"), "at least 2 on each side of the sheet", fewest));
    }
    if let Some(panel) = observations.projector {
        check_pairs(view, what("projected corners"))?;
        check_on_panel(view, panel, what("projected corners"))?;
    }
    let corners = view.sheet.corners().ok_or_else(|| {
        Error::invalid(
            what("the sheet's sides"),
            "four lines that meet in four corners",
            "parallel neighbours",
        )
    })?;
    check_corners(&corners, observations.camera, what("the sheet's corners"))?;
    check_proportions(&corners, view.size, what("the sheet's size"))
}

fn differ(mut values: impl Iterator<Item = bool>) -> bool {
    values.next().is_some_and(|first| values.any(|v| v != first))
}

fn check_pairs(view: &ViewObservation, what: ErrorSubject) -> Result<()> {
    if view.pairs.len() < FEWEST_PAIRS {
        let expected = "at least 4 pairs of camera and projector pixels (or no projector)";
        return Err(Error::invalid(what, expected, view.pairs.len()));
    }
    for (name, points) in [
        ("camera", view.pairs.iter().map(|p| p.camera).collect::<Vec<_>>()),
        ("projector", view.pairs.iter().map(|p| p.projector).collect()),
    ] {
        let line = crate::geometry::Line::fit(points.iter().map(|p| (*p, 1.0)));
        let mean = points.iter().fold(nalgebra::Vector2::zeros(), |s, p| s + p.coords) / points.len() as f64;
        let spread = points.iter().map(|p| (p.coords - mean).norm()).fold(0.0, f64::max);
        let off =
            line.map_or(0.0, |l| points.iter().map(|p| l.signed_distance_px(*p).abs()).fold(0.0, f64::max));
        if off <= FLATTEST_SINE * spread {
            let found = format!("{name} pixels on one line");
            return Err(Error::invalid(what, "pairs spread over an area", found));
        }
    }
    Ok(())
}

fn check_on_panel(view: &ViewObservation, panel: [u32; 2], what: ErrorSubject) -> Result<()> {
    let [w, h] = panel.map(f64::from);
    let on = |p: Point2<f64>| (-1.0..=w).contains(&p.x) && (-1.0..=h).contains(&p.y);
    match view.pairs.iter().find(|p| !on(p.projector)) {
        None => Ok(()),
        Some(p) => Err(Error::invalid(
            what,
            format!("projector pixels on the {w}x{h} panel"),
            format!("{:.1},{:.1}: is the pattern one for another panel?", p.projector.x, p.projector.y),
        )),
    }
}

/// A size with proportions far from what is seen was mistyped; the homography to it would be singular to rounding.
fn check_proportions(corners: &[Point2<f64>; 4], size: RectangleSize, what: ErrorSubject) -> Result<()> {
    let side = |i: usize| (corners[(i + 1) % 4] - corners[i]).norm();
    let seen = (side(0) + side(2)) / (side(1) + side(3));
    let given = size.width_mm / size.height_mm;
    if (given / seen).max(seen / given) <= MOST_FORESHORTENED {
        return Ok(());
    }
    Err(Error::invalid(
        what,
        format!("width and height near {seen:.2} to 1, as the sheet is seen"),
        format!("{}x{} mm", size.width_mm, size.height_mm),
    ))
}

fn check_corners(corners: &[Point2<f64>; 4], image: [u32; 2], what: ErrorSubject) -> Result<()> {
    let shown = || corners.map(|c| format!("{:.1},{:.1}", c.x, c.y)).join(" ");
    let turns: [f64; 4] = std::array::from_fn(|i| {
        let a = corners[(i + 1) % 4] - corners[i];
        let b = corners[(i + 2) % 4] - corners[(i + 1) % 4];
        a.perp(&b) / (a.norm() * b.norm())
    });
    if turns.iter().all(|&t| t < -FLATTEST_SINE) {
        let expected = "TL, TR, BR, BL, clockwise as the image shows them";
        return Err(Error::invalid(what, expected, format!("{} (anticlockwise: a mirror image)", shown())));
    }
    if !turns.iter().all(|&t| t > FLATTEST_SINE) {
        let expected = "a convex quadrilateral TL, TR, BR, BL without three corners on a line";
        return Err(Error::invalid(what, expected, shown()));
    }
    let area = (0..4).map(|i| corners[i].coords.perp(&corners[(i + 1) % 4].coords)).sum::<f64>() / 2.0;
    let least = SMALLEST_AREA_SHARE * f64::from(image[0]) * f64::from(image[1]);
    if area.is_nan() || area < least {
        let expected = format!("a sheet that covers more than {least:.1} px²");
        return Err(Error::invalid(what, expected, format!("{area:.1} px²")));
    }
    Ok(())
}
