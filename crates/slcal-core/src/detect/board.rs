//! The projected checkerboard, with every corner identified in the pattern and refined.

use nalgebra::{Point2, Vector2};

use super::board_registration::{RegisteredCorner, Unregistered, register};
use super::checkerboard::labelled_grids;
use super::corner::Refiner;
use super::downsampled::Downsampled;
use super::rough_undistort::RoughLens;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Homography;
use crate::observations::CornerPair;
use crate::pattern::{CheckerPattern, PanelMarks};
use crate::photo::LinearPhoto;

use crate::solve::homography_from_points;

/// The checkerboard detected in a photograph.
#[derive(Debug, Clone)]
pub(super) struct Board {
    /// Refined corners, row-major.
    pub(super) pairs: Vec<CornerPair>,
    /// The lens estimated from them.
    pub(super) lens: RoughLens,
    /// Fitted to the undistorted corners.
    pub(super) undistorted_from_projector: Homography,
    projector_from_undistorted: Homography,
    /// Number of corners of the whole pattern.
    pub(super) expected: usize,
}

/// Fewest corners from which a homography separates the sheet from the projector footprint reliably.
const MIN_CORNERS: usize = 12;
/// With more corners than this the squares would be too small for any photograph.
const MAX_CORNERS: usize = 10_000;
/// Largest distance of a refined corner from its first position, in squares. Beyond it the fit has converged to another
/// feature.
const MAX_SHIFT_SQUARES: f64 = 0.15;

/// An edge pixel belongs to an edge between squares when it lies within this part of a square from it.
const GRID_TOLERANCE: f64 = 0.15;

/// The same for an edge of a mark, as a part of its side: the border of the panel is predicted less well than the board.
const MARK_TOLERANCE: f64 = 0.1;

impl Board {
    /// Detects the pattern.
    ///
    /// # Errors
    /// [`Error::NotFound`] with what was detected instead.
    pub(super) fn find(
        photo: &LinearPhoto<'_>,
        downsampled: &Downsampled,
        pattern: &CheckerPattern,
    ) -> Result<Self> {
        let [columns, rows] = pattern.squares.map(|n| n.saturating_sub(1) as usize);
        let expected = columns.saturating_mul(rows);
        if expected > MAX_CORNERS {
            return Err(Error::invalid(
                ErrorSubject::Checkerboard,
                format!("at most {MAX_CORNERS} inner corners"),
                expected,
            ));
        }
        let grids = labelled_grids(photo, downsampled, expected);
        let largest = grids.first().map_or(0, Vec::len);
        let mut refusal = None;
        for grid in grids.iter().filter(|g| g.len() >= MIN_CORNERS.min(expected)) {
            match register(photo, grid, pattern) {
                Ok(corners) => {
                    if let Some(board) = Self::refined(photo, &corners, pattern, expected) {
                        return Ok(board);
                    }
                }
                Err(reason) => refusal = refusal.or(Some(reason)),
            }
        }
        Err(not_found(largest, expected, pattern, refusal))
    }

    fn refined(
        photo: &LinearPhoto<'_>,
        corners: &[RegisteredCorner],
        pattern: &CheckerPattern,
        expected: usize,
    ) -> Option<Self> {
        let projector = |c: &RegisteredCorner| pattern.inner_corner(c.index[0], c.index[1]);
        let raw: Vec<_> = corners.iter().map(|c| (projector(c), c.position)).collect();
        let rough = homography_from_points(&raw).ok()?;
        let mut refiner = Refiner::new(photo);
        let mut pairs: Vec<([u32; 2], CornerPair)> = Vec::with_capacity(corners.len());
        for corner in corners {
            let at = projector(corner);
            let jacobian = rough.jacobian(at) * pattern.square_px;
            let steps: [Vector2<f64>; 2] = [jacobian.column(0).into_owned(), jacobian.column(1).into_owned()];
            let Some(found) = refiner.refine(corner.position, steps) else { continue };
            let limit = MAX_SHIFT_SQUARES * steps[0].norm().min(steps[1].norm()).max(4.0);
            if (found.position - corner.position).norm() <= limit {
                let pair =
                    CornerPair { camera: found.position, projector: at, sigma_px: Some(found.sigma_px) };
                pairs.push((corner.index, pair));
            }
        }
        if pairs.len() < MIN_CORNERS.min(expected) {
            return None;
        }
        pairs.sort_by_key(|(index, _)| (index[1], index[0]));
        let pairs: Vec<CornerPair> = pairs.into_iter().map(|(_, pair)| pair).collect();
        let lens = RoughLens::from_corners(photo.width(), photo.height(), &pairs);
        let (undistorted_from_projector, projector_from_undistorted) = fit(&pairs, &lens)?;
        Some(Self { pairs, lens, undistorted_from_projector, projector_from_undistorted, expected })
    }

    /// Whether an edge at the undistorted point `p` with unit normal `normal` is one between squares of the pattern.
    pub(super) fn explains(&self, pattern: &CheckerPattern, p: Point2<f64>, normal: Vector2<f64>) -> bool {
        let Some(at) = self.projector_from_undistorted.map(p) else { return false };
        let of_mark = |m: &PanelMarks| m.edge_distance_px(at) <= MARK_TOLERANCE * m.side_px;
        if pattern.marks.as_ref().is_some_and(of_mark) {
            return true;
        }
        let square = (at - pattern.origin_px) / pattern.square_px;
        let [columns, rows] = pattern.squares.map(f64::from);
        let inside = |v: f64, n: f64| (-GRID_TOLERANCE..=n + GRID_TOLERANCE).contains(&v);
        if !(inside(square.x, columns) && inside(square.y, rows)) {
            return false;
        }
        // Normals map by the transposed Jacobian. The larger component gives the direction of the edge.
        let n = self.undistorted_from_projector.jacobian(at).transpose() * normal;
        let along = if n.x.abs() > n.y.abs() { square.x } else { square.y };
        (along - along.round()).abs() <= GRID_TOLERANCE
    }

    /// Distance of an undistorted point from the nearest edge between squares or of a mark, px; infinite beyond the horizon.
    pub(super) fn edge_distance_px(&self, pattern: &CheckerPattern, p: Point2<f64>) -> f64 {
        let Some(at) = self.projector_from_undistorted.map(p) else { return f64::INFINITY };
        let square = (at - pattern.origin_px) / pattern.square_px;
        let [columns, rows] = pattern.squares.map(f64::from);
        let scale = self.undistorted_from_projector.jacobian(at) * pattern.square_px;
        // Outside the pattern this is the distance from its outline.
        let nearest = |v: f64, n: f64| (v - v.round().clamp(0.0, n)).abs();
        let (dx, dy) = (nearest(square.x, columns), nearest(square.y, rows));
        let beside = |v: f64, n: f64| (-v).max(v - n).max(0.0);
        let (bx, by) = (beside(square.x, columns), beside(square.y, rows));
        let (px, py) = (scale.column(0).norm(), scale.column(1).norm());
        let from_square = (dx.max(by) * px).min(dy.max(bx) * py).max((bx * px).hypot(by * py));
        let smaller = px.min(py) / pattern.square_px;
        pattern.marks.as_ref().map_or(from_square, |m| from_square.min(m.edge_distance_px(at) * smaller))
    }

    /// The same board without the corners for which `keep` is false; `None` when too few are left.
    pub(super) fn retain(mut self, keep: impl Fn(Point2<f64>) -> bool) -> Option<Self> {
        self.pairs.retain(|pair| keep(pair.camera));
        if self.pairs.len() < MIN_CORNERS.min(self.expected) {
            return None;
        }
        Some(self)
    }
}

/// `undistorted_from_projector` and its inverse.
pub(super) fn fit(pairs: &[CornerPair], lens: &RoughLens) -> Option<(Homography, Homography)> {
    let points: Vec<_> = pairs.iter().map(|p| (p.projector, lens.undistort(p.camera))).collect();
    let h = homography_from_points(&points).ok()?;
    // The sign that gives points of the board positive weight. A negative weight is then beyond the horizon.
    let w = (h.0 * points[0].0.to_homogeneous()).z;
    let h = Homography(h.0 * w.signum());
    Some((h, h.inverse()?))
}

fn not_found(
    largest: usize,
    expected: usize,
    pattern: &CheckerPattern,
    refusal: Option<Unregistered>,
) -> Error {
    let [columns, rows] = pattern.squares;
    let seen = match refusal {
        None if largest == 0 => "no grid of checkerboard corners was seen in the photograph".to_string(),
        None => format!("{largest} of {expected} corners of a {columns}x{rows} board were seen"),
        Some(Unregistered::Misfit) => {
            format!("a grid of {largest} corners was seen that is not part of a {columns}x{rows} board")
        }
        Some(Unregistered::Colors) => format!(
            "a grid of {largest} corners was seen, but its squares and border are not those of the {columns}x{rows} pattern"
        ),
        Some(Unregistered::Ambiguous) => format!(
            "{largest} of {expected} corners were seen, and they fit the {columns}x{rows} pattern in more than one place"
        ),
    };
    Error::NotFound {
        what: ErrorSubject::Checkerboard,
        seen,
        advice: "project the pattern of this file so that all of its squares and the border around them fall on the sheet, \
                 sharp and inside the frame, with the room dark enough for the squares to be seen"
            .into(),
    }
}
