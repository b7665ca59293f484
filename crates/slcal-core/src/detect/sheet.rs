//! The sheet's outline: the quadrilateral with its corners in order from the top left and its sides measured.

use nalgebra::{Point2, Vector2};

use super::downsampled::Downsampled;
use super::edge::{MeasuredSide, measure_side};
use super::edge_map::{DistortedEdges, Edgel};
use super::lines::find_lines;
use super::projector_footprint::{ProjectedEdges, ProjectorFootprint};
use super::quad::{Content, find_sheet};
use super::rough_undistort::RoughLens;
use crate::error::{Error, ErrorSubject, Result};
use crate::observations::SheetObservation;
use crate::photo::LinearPhoto;
use crate::rig::Warning;

/// Standard deviation of corners given by hand, as a part of the frame's diagonal.
const HAND_SIGMA: f64 = 0.002;
/// Search radius for sides around corners given by hand, as a part of the diagonal.
const HAND_REACH: f64 = 0.008;
/// Accuracy of the predicted border of the footprint on the sheet, in downsampled pixels.
const BORDER_DISTANCE: f64 = 2.0;

/// Accuracy of a side found in the downsampled image, in its pixels.
const UNCERTAINTY: f64 = 3.0;

/// The detected sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetDetection {
    /// Its outline.
    pub observation: SheetObservation,
    /// Remarks for the user: corners taken from the user.
    pub notes: Vec<String>,
    /// Parts of the outline that are not the plain edge of a sheet, and what was done about them.
    pub warnings: Vec<Warning>,
}

/// Checks corners given by hand.
pub(super) fn check_corners(corners: &[Point2<f64>; 4]) -> Result<()> {
    let turn = |i: usize| {
        let (a, b, c) = (corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]);
        (b - a).perp(&(c - b))
    };
    let convex = (0..4).all(|i| turn(i).is_finite() && turn(i) > 0.0);
    if convex {
        return Ok(());
    }
    Err(Error::invalid(
        ErrorSubject::SheetCorners,
        "the four corners of a convex quadrilateral in the order TL, TR, BR, BL as the camera sees them",
        format!("{:?}", corners.map(|c| (c.x, c.y))),
    ))
}

/// Whether a point lies inside a convex quadrilateral given clockwise in the image.
pub(super) fn contains(corners: &[Point2<f64>; 4], p: Point2<f64>) -> bool {
    (0..4).all(|i| (corners[(i + 1) % 4] - corners[i]).perp(&(p - corners[i])) > 0.0)
}

/// Finds the sheet around the points that the projector lights, or the brightest one.
pub(super) fn find(
    photo: &LinearPhoto<'_>,
    downsampled: &Downsampled,
    projected: &ProjectedEdges<'_>,
    by_hand: Option<[Point2<f64>; 4]>,
) -> Result<SheetDetection> {
    let (width, height) = (photo.width(), photo.height());
    let diagonal = (width as f64).hypot(height as f64);
    if let Some(corners) = by_hand {
        return Ok(
            match measure(
                photo,
                corners.map(|c| projected.lens.undistort(c)),
                HAND_REACH * diagonal,
                projected,
            ) {
                Ok(sides) => sides.into(),
                Err(i) => SheetDetection {
                    observation: SheetObservation::Corners { corners, sigma_px: Some(HAND_SIGMA * diagonal) },
                    notes: vec![format!(
                        "the {} side was not seen near the given corners: they are used as they are, uncertain by {:.1} px",
                        SIDES[i],
                        HAND_SIGMA * diagonal
                    )],
                    warnings: Vec::new(),
                },
            },
        );
    }
    let edges = DistortedEdges::new(downsampled);
    let outcome = if projected.lit.is_empty() {
        // Only the sheet's sides show the lens: under the right coefficient they are straight.
        TRIED_LENSES
            .iter()
            .map(|&k| search(&edges, projected, &RoughLens::radial(width, height, k)))
            .reduce(|best, next| if next.score > WORTHWHILE * best.score { next } else { best })
            .unwrap_or_else(|| search(&edges, projected, projected.lens))
    } else {
        search(&edges, projected, projected.lens)
    };
    let Some(corners) = outcome.corners else {
        // A side along the footprint's border is truncated where its edges are attributed to the border.
        let unlit = ProjectedEdges { footprint: &ProjectorFootprint::none(), ..*projected };
        let again = (!projected.lit.is_empty()).then(|| search(&edges, &unlit, projected.lens));
        let along = again.and_then(|again| {
            let corners = again.corners?;
            (0..4).find(|i| along_border(*i, &corners, again.uncertainty_px, projected))
        });
        return Err(along.map_or_else(|| not_found(outcome.seen), border));
    };
    let projected = ProjectedEdges { lens: &outcome.lens, ..*projected };
    let sides = measure(photo, corners, outcome.uncertainty_px, &projected).map_err(|i| {
        if along_border(i, &corners, outcome.uncertainty_px, &projected) {
            return border(i);
        }
        not_found(format!("a quadrilateral was seen, but its {} side is not a clean edge", SIDES[i]))
    })?;
    Ok(sides.into())
}

/// Coefficients tried when there are no points to estimate the lens from (r = 1 at half the diagonal). The values for barrel
/// distortion of common cameras come first.
const TRIED_LENSES: [f64; 7] = [0.0, 0.03, 0.06, 0.1, 0.14, -0.03, -0.06];
/// A coefficient is preferred over a smaller one when the score is better by this factor.
const WORTHWHILE: f64 = 1.1;

/// The result of a search of the whole photograph.
struct Outcome {
    lens: RoughLens,
    /// TL, TR, BR, BL, undistorted, px.
    corners: Option<[Point2<f64>; 4]>,
    score: f64,
    uncertainty_px: f64,
    /// For the message when there is no sheet.
    seen: String,
}

fn search(edges: &DistortedEdges, projected: &ProjectedEdges<'_>, lens: &RoughLens) -> Outcome {
    let map = edges.through(lens);
    let foreign = |e: &Edgel| {
        let p = map.to_photo(e.position);
        projected.footprint.explains(p, e.normal, BORDER_DISTANCE * map.factor as f64)
            || projected.board.is_some_and(|(board, pattern)| board.explains(pattern, p, e.normal))
    };
    let lines = find_lines(&map, |e| !foreign(e));
    let (content, toward) = if projected.lit.is_empty() {
        (Content::Anything, "inside")
    } else {
        let lit = projected.lit.iter().map(|p| map.to_working(lens.undistort(p.camera))).collect();
        (Content::Board(lit), "towards the pattern")
    };
    let found = find_sheet(&map, &lines, &content, foreign);
    let seen = format!(
        "{} straight edges were seen, {} of them with their bright side {toward}, and {} quadrilaterals among these",
        lines.len(),
        found.lines,
        found.quads
    );
    Outcome {
        lens: *lens,
        score: found.best.as_ref().map_or(0.0, |q| q.score),
        corners: found.best.map(|q| named(q.corners.map(|c| map.to_photo(c)))),
        uncertainty_px: UNCERTAINTY * map.factor as f64 + 1.0,
        seen,
    }
}

fn not_found(seen: String) -> Error {
    let advice = "show the whole sheet on a background that is darker than it, with its four sides free, or give its \
                  corners by hand";
    Error::NotFound { what: ErrorSubject::Sheet, seen, advice: advice.into() }
}

/// Whether a side of the outline lies too near to the border of the footprint to be distinguished from it.
pub(super) fn is_along_border(
    corners: &[Point2<f64>; 4],
    projected: &ProjectedEdges<'_>,
    uncertainty_px: f64,
) -> bool {
    let corners = corners.map(|c| projected.lens.undistort(c));
    (0..4).any(|i| along_border(i, &corners, uncertainty_px, projected))
}

/// Whether most of side `i` lies too near to the border of the footprint to be distinguished from it.
fn along_border(
    i: usize,
    corners: &[Point2<f64>; 4],
    uncertainty_px: f64,
    projected: &ProjectedEdges<'_>,
) -> bool {
    const PLACES: usize = 16;
    let (a, d) = (corners[i], corners[(i + 1) % 4] - corners[i]);
    let at = |k: usize| a + d * ((k as f64 + 0.5) / PLACES as f64);
    (0..PLACES).filter(|k| projected.footprint.distance_px(at(*k)) < uncertainty_px).count() > PLACES / 2
}

/// The error for such a side.
fn border(i: usize) -> Error {
    let side = SIDES[i];
    Error::NotFound {
        what: ErrorSubject::Sheet,
        seen: format!(
            "four sides were seen, but the {side} one runs along the border of the projector footprint and cannot be distinguished from it"
        ),
        advice: "move the sheet or the projector so that the footprint ends well inside the sheet or well beyond it; or \
                 give the sheet's corners by hand"
            .into(),
    }
}

/// The clockwise corners from TL on: the corner whose direction to the next one is nearest to +x.
fn named(corners: [Point2<f64>; 4]) -> [Point2<f64>; 4] {
    let along = |i: usize| (corners[(i + 1) % 4] - corners[i]).normalize().x;
    let first = (0..4).max_by(|&a, &b| along(a).total_cmp(&along(b))).unwrap_or(0);
    std::array::from_fn(|i| corners[(first + i) % 4])
}

/// The sides in the order of the corners.
const SIDES: [&str; 4] = ["top", "right", "bottom", "left"];

/// The four sides as they were measured.
struct Sides([MeasuredSide; 4]);

/// Measures the four sides between undistorted corners. The error is the first side that is not visible.
fn measure(
    photo: &LinearPhoto<'_>,
    corners: [Point2<f64>; 4],
    uncertainty_px: f64,
    projected: &ProjectedEdges<'_>,
) -> std::result::Result<Sides, usize> {
    let side = |i: usize, with_face: bool| {
        /// Enough to follow the curvature by a lens.
        const PATH_POINTS: u32 = 17;
        let (a, d) = (corners[i], corners[(i + 1) % 4] - corners[i]);
        let on = |k: u32| projected.lens.distort(a + d * (f64::from(k) / f64::from(PATH_POINTS - 1)));
        let path: Vec<Point2<f64>> = (0..PATH_POINTS).map(on).collect();
        let inward = Vector2::new(-d.y, d.x);
        // A face that cannot be measured leaves the side as it is without one.
        let measured = |with_face| measure_side(photo, &path, inward, uncertainty_px, projected, with_face);
        measured(with_face).or_else(|| with_face.then(|| measured(false)).flatten()).ok_or(i)
    };
    let mut sides = [side(0, true)?, side(1, true)?, side(2, true)?, side(3, true)?];
    // Of a board at most two neighbouring side faces are turned towards the camera. Lines along opposite sides are printed,
    // or the border of something else.
    let has_face = [0, 1, 2, 3].map(|i: usize| sides[i].face_px.is_some());
    if (has_face[0] && has_face[2]) || (has_face[1] && has_face[3]) {
        for i in (0..4).filter(|&i| has_face[i]) {
            sides[i] = side(i, false)?;
        }
    }
    Ok(Sides(sides))
}

impl From<Sides> for SheetDetection {
    fn from(Sides(sides): Sides) -> Self {
        let warnings = sides.iter().zip(SIDES).flat_map(|(side, name)| remarks(side, name)).collect();
        let observation = SheetObservation::Edges(sides.map(|side| side.points));
        Self { observation, notes: Vec::new(), warnings }
    }
}

/// What the user should know about a side.
fn remarks(side: &MeasuredSide, name: &str) -> Vec<Warning> {
    let mut remarks = Vec::new();
    if let Some([least, most]) = side.face_px {
        remarks.push(Warning::new(
            "side-face",
            format!(
                "the {name} side of the sheet shows two parallel edges, {least:.1} to {most:.1} px apart, as the front and the side \
                 face of a thick board do; the inner one was taken for the edge of the sheet"
            ),
            "look whether that is so; a thin sheet, or side faces painted black, leave no doubt",
        ));
    }
    let percent = |share: f64| (100.0 * share).max(1.0);
    if side.covered > 0.0 {
        remarks.push(Warning::new(
            "side-covered",
            format!(
                "{:.0} % of the {name} side of the sheet is not seen as an edge: something covers it or shades it, the projector's light ends there, or it \
                 bends away; that part is left out",
                percent(side.covered)
            ),
            "keep clips, tape, fingers and hard shadows away from the sides of the sheet",
        ));
    }
    if side.bent > 0.0 {
        remarks.push(Warning::new(
            "side-curled",
            format!(
                "the end of the {name} side of the sheet bends away from the rest of it; the last {:.0} % are left out",
                percent(side.bent)
            ),
            "press the corners of the sheet flat, or fasten it to a board",
        ));
    }
    remarks
}
