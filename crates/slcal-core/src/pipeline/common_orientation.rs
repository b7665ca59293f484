//! Photographs of one camera whose tags turn them differently: one of them is turned to lie like the others where they fit
//! together only so.
//!
//! The tag follows gravity. A camera that looks down often writes the wrong one, and photographs that are upright do not show
//! the sensor in the same way, which a calibration takes for granted.

use nalgebra::Vector2;

use super::photo_tags::{Orientation, Turn};
use super::taken::Taken;
use crate::calibrate::{CalibrateConfig, misfit_per_residual};
use crate::channel_registration::RedBlue;
use crate::error::{Error, ErrorSubject, Result};
use crate::observations::{Observations, SheetObservation, ViewObservation};
use crate::rig::Warning;

/// χ² per residual up to which photographs fit together; noise stays within a few per cent of one.
const FITS: f64 = 2.0;
/// The other way round is taken where it lowers χ² to this part.
const CLEARLY: f64 = 0.25;

/// What was done with photographs that their tags turn differently.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// They lie as they did, and fit.
    Kept,
    /// They fit either way: nothing tells which is right.
    Untold,
    /// They fit neither way.
    Neither,
    /// Some were turned, which left this part of χ² per residual; `None` where they had different sizes before.
    Turned(Option<f64>),
}

/// The orientation that most photographs have, or the first of those that are as many; with a known camera, the first.
fn common(taken: &[Taken], known_camera: bool) -> Option<Orientation> {
    let first = taken.first()?.orientation();
    if known_camera {
        return Some(first);
    }
    let count = |o: Orientation| taken.iter().filter(|t| t.orientation() == o).count();
    let all = taken.iter().map(Taken::orientation);
    Some(all.fold(first, |best, o| if count(o) > count(best) { o } else { best }))
}

/// Whether tags turn the photographs differently, in a way that can be turned back.
pub(super) fn differ(taken: &[Taken]) -> bool {
    let first = taken.first().map(Taken::orientation).unwrap_or_default();
    taken.iter().any(|t| t.orientation().turn_to(first).is_some_and(|turn| turn.0 != 0))
        && taken.iter().all(|t| t.orientation().turn_to(first).is_some())
}

/// The ways to turn them alike: to lie like most of them, and as the camera stored them.
fn ways(taken: &[Taken], known_camera: bool) -> Vec<Vec<Turn>> {
    let common = common(taken, known_camera);
    let stored = Some(Orientation::AsStored).filter(|o| !known_camera && common != Some(*o));
    let to = |o: Orientation| taken.iter().map(|t| t.orientation().turn_to(o)).collect::<Option<Vec<Turn>>>();
    common.into_iter().chain(stored).filter_map(to).collect()
}

/// The observations that fit best, how each photograph was turned for them, and what that means.
pub(super) fn settle(
    observations: &Observations,
    taken: &[Taken],
    config: &CalibrateConfig,
) -> Result<(Observations, Vec<Turn>, Outcome)> {
    let alike = taken.iter().all(|t| t.size == taken[0].size);
    let as_they_are = if alike { misfit_per_residual(observations, config) } else { f64::INFINITY };
    let ways = ways(taken, config.known_camera.is_some());
    let tried = ways.into_iter().flat_map(|turns| {
        let sideways = turns.iter().any(|t| t.is_sideways());
        let sheets = [false, true].into_iter().filter(move |with_sheet| sideways || !with_sheet);
        sheets.map(move |with_sheet| (turned(observations, taken, &turns, with_sheet), turns.clone()))
    });
    let tried = tried.map(|(o, turns)| (misfit_per_residual(&o, config), o, turns));
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    let (misfit, best, turns) = best.ok_or_else(|| different_sizes(taken))?;
    if !alike {
        let fits = misfit.is_finite();
        return if fits { Ok((best, turns, Outcome::Turned(None))) } else { Err(different_sizes(taken)) };
    }
    let outcome = match (as_they_are < FITS, misfit < FITS) {
        (_, true) if misfit < CLEARLY * as_they_are => Outcome::Turned(Some(misfit / as_they_are)),
        (true, false) => Outcome::Kept,
        (true, true) if as_they_are < CLEARLY * misfit => Outcome::Kept,
        (_, true) => Outcome::Untold,
        (false, false) => Outcome::Neither,
    };
    if matches!(outcome, Outcome::Turned(_)) {
        return Ok((best, turns, outcome));
    }
    Ok((observations.clone(), vec![Turn(0); taken.len()], outcome))
}

/// The warning about photographs that their tags turn differently.
pub(super) fn warning(taken: &[Taken], outcome: &Outcome, known_camera: bool) -> Option<Warning> {
    let common = common(taken, known_camera)?;
    let like = taken.iter().find(|t| t.orientation() == common)?;
    let others = taken.iter().filter(|t| t.orientation() != common);
    let names = others.map(|t| format!("{} ({})", t.title, t.orientation().tag())).collect::<Vec<_>>();
    let told = format!(
        "the EXIF orientation of {} differs from that of {} ({})",
        names.join(", "),
        like.title,
        common.tag()
    );
    let hold = "hold the camera in the same way for all photographs, or remove or correct the tag";
    let (done, advice) = match outcome {
        Outcome::Kept => return None,
        Outcome::Turned(left) => {
            let (how, lie) = match taken.iter().find(|t| t.turn.0 == 0) {
                Some(like) => (format!("turned to lie like {}", like.title), format!("like {}", like.title)),
                None => ("taken as the camera stored them".to_owned(), "as the camera stores them".to_owned()),
            };
            let why = match left {
                Some(left) => format!("their residuals are {:.1} times smaller so", left.sqrt().recip()),
                None => "their sizes are the same so, and they fit together".to_owned(),
            };
            (format!("all were {how}: {why}"), format!("{hold}; photographs that the rig is used with must lie {lie}"))
        }
        Outcome::Untold => (
            "the photographs fit together as their tags turn them and as the camera stored them; the tags were followed".to_owned(),
            format!("{hold}: where the tag is wrong, the principal point is as well"),
        ),
        Outcome::Neither => (
            "the photographs do not fit together, neither as their tags turn them nor as the camera stored them".to_owned(),
            format!("{hold}; then check that they show the same sheet and the same pattern"),
        ),
    };
    Some(Warning::new("orientation-differs", format!("{told}: {done}"), advice))
}

fn different_sizes(taken: &[Taken]) -> Error {
    let first = &taken[0];
    let other = taken.iter().find(|t| t.size != first.size).unwrap_or(first);
    let in_words = |t: &Taken| {
        format!(
            "{}x{} pixels, turned by the EXIF orientation {}",
            t.size[0],
            t.size[1],
            t.orientation().tag()
        )
    };
    let expected = format!(
        "{} as in {} (all photographs come from one camera at one setting)",
        in_words(first),
        first.title
    );
    let found =
        format!("{} in {}; turned back they do not fit together either", in_words(other), other.title);
    Error::invalid(ErrorSubject::Photograph, expected, found)
}

/// The observations in photographs that are turned. The width of a sheet belongs to the side that then runs along the image's
/// x axis, unless the sheet was turned together with the camera (`with_sheet`).
fn turned(observations: &Observations, taken: &[Taken], turns: &[Turn], with_sheet: bool) -> Observations {
    let mut all = observations.clone();
    for ((view, taken), turn) in all.views.iter_mut().zip(taken).zip(turns).filter(|(_, t)| t.0 != 0) {
        turn_view(view, taken.size, *turn, with_sheet);
    }
    if let Some((taken, turn)) = taken.iter().zip(turns).next() {
        all.camera = turn.size(taken.size);
    }
    all
}

fn turn_view(view: &mut ViewObservation, size: [u32; 2], turn: Turn, with_sheet: bool) {
    match &mut view.sheet {
        SheetObservation::Edges(sides) => {
            sides.iter_mut().flatten().for_each(|p| p.position = turn.point(p.position, size));
        }
        SheetObservation::Corners { corners, .. } => *corners = corners.map(|c| turn.point(c, size)),
    }
    view.pairs.iter_mut().for_each(|p| p.camera = turn.point(p.camera, size));
    view.panel_points.iter_mut().for_each(|p| p.camera = turn.point(p.camera, size));
    view.channel_offsets.iter_mut().for_each(|o| {
        // A displacement turns as the line to the point that it leads to.
        let turned = |v: Vector2<f64>| turn.point(o.camera + v, size) - turn.point(o.camera, size);
        o.offset_px = RedBlue { red: turned(o.offset_px.red), blue: turned(o.offset_px.blue) };
        o.camera = turn.point(o.camera, size);
    });
    // Sides and corners are named anew, from the corner on from which the side to the next runs most nearly along x.
    let Some(corners) = view.sheet.corners() else { return };
    let along_x = |i: &usize| (corners[(i + 1) % 4] - corners[*i]).normalize().x;
    let first = (0..4).max_by(|i, j| along_x(i).total_cmp(&along_x(j))).unwrap_or(0);
    match &mut view.sheet {
        SheetObservation::Edges(sides) => sides.rotate_left(first),
        SheetObservation::Corners { corners, .. } => corners.rotate_left(first),
    }
    if with_sheet && first % 2 == 1 {
        view.size = view.size.transposed();
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::geometry::RectangleSize;
    use crate::observations::ChannelOffset;

    #[test]
    fn displacements_of_the_channels_turn_along() {
        let offset = ChannelOffset {
            camera: Point2::new(30.0, 20.0),
            projector: Point2::new(5.0, 6.0),
            offset_px: RedBlue { red: Vector2::new(0.3, -0.1), blue: Vector2::new(0.0, 0.2) },
            sigma_px: RedBlue { red: 0.01, blue: 0.02 },
        };
        let corners =
            [(10.0, 10.0), (90.0, 10.0), (90.0, 70.0), (10.0, 70.0)].map(|(x, y)| Point2::new(x, y));
        let mut view = ViewObservation {
            photo: None,
            size: RectangleSize::new(80.0, 60.0).unwrap(),
            sheet: SheetObservation::Corners { corners, sigma_px: None },
            pairs: Vec::new(),
            panel_points: Vec::new(),
            channel_offsets: vec![offset],
        };
        // Clockwise, (x, y) of an image with 80 rows comes to (79 - y, x).
        turn_view(&mut view, [100, 80], Turn(1), true);
        let turned = view.channel_offsets[0];
        assert_eq!((turned.camera, turned.projector), (Point2::new(59.0, 30.0), offset.projector));
        assert!((turned.offset_px.red - Vector2::new(0.1, 0.3)).norm() < 1e-12);
        assert!((turned.offset_px.blue - Vector2::new(-0.2, 0.0)).norm() < 1e-12);
        assert_eq!(view.sheet.corners().unwrap()[0], Point2::new(9.0, 10.0));
    }
}
