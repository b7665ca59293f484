//! One pair of every cell, with its σ.

use nalgebra::Point2;

use super::cells::{Cell, Sample, cells};
use super::local_fit::{LocalFit, fit};
use super::scatter::excess;
use crate::dense_matches::DenseMatches;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Homography;
use crate::observations::{CornerPair, SheetObservation};
use crate::solve::{homography_from_points, median, robust_scale};

/// Fewest pairs from which the map of the sheet is sure: as of a checkerboard.
const FEWEST_PAIRS: usize = 12;
/// Rounds in which cells that lie beside the map of the whole sheet are dropped from it.
const ROUNDS: usize = 3;
/// They lie beside it beyond so many standard deviations of all cells.
const OUTLIER_SIGMAS: f64 = 4.0;
/// The variance of a cell by the scatter of its blocks exceeds the true one so many times in one cell of a thousand: the quantile of χ² with
/// 13 degrees of freedom, over 13.
const CHANCE: f64 = 2.65;
/// Error by the curvature of the map over a cell, as a part of the cell's width: found in renders with k1 = -0.08 and phases of little noise,
/// against exact ground truth.
const CURVATURE_SHARE: f64 = 1e-4;

/// Pairs on a sheet.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SheetPairs {
    /// One of every cell that has one, row by row of the sheet.
    pub pairs: Vec<CornerPair>,
    /// Number of all cells.
    pub cells: usize,
}

/// Thins the matches of all pixels on a sheet to some two hundred pairs of a camera point and the panel point seen there. The panel
/// point is the one that is measured; its uncertainty is stated as that of the camera point.
///
/// # Errors
/// [`Error::Invalid`] for matches without columns or without rows; [`Error::NotFound`] when too few parts of the sheet have pixels whose
/// position is known.
pub fn sheet_pairs(matches: &DenseMatches, sheet: &SheetObservation) -> Result<SheetPairs> {
    check_axes(matches)?;
    let cells = cells(matches, sheet);
    let not_found = |found: usize| {
        Error::NotFound {
        what: ErrorSubject::PatternCode,
        seen: format!(
            "{found} of {} parts of the sheet have enough pixels whose place on the panel is certain, {FEWEST_PAIRS} are needed",
            cells.len()
        ),
        advice: "light the whole sheet with the projector, fill the frame with it, darken the room, and keep camera, projector and sheet \
                 still from the first photograph to the last"
            .into(),
    }
    };
    let panel_from_camera = of_sheet(&cells).ok_or_else(|| not_found(0))?;
    let fits: Vec<LocalFit> = cells.iter().filter_map(|cell| fit(cell, &panel_from_camera)).collect();
    let alike =
        [0, 1].map(|axis| median(&mut fits.iter().map(|f| f.alike[axis]).collect::<Vec<_>>()).unwrap_or(1.0));
    let variances: Vec<[f64; 2]> = fits
        .iter()
        .map(|f| [0, 1].map(|axis| f.variance[axis] * alike[axis].max(f.alike[axis] / CHANCE).max(1.0)))
        .collect();
    let beyond = beyond_pixels(&fits, &variances, &panel_from_camera);
    let sum = |v: &[f64; 2]| [v[0] + beyond[0], v[1] + beyond[1]];
    let pairs: Vec<CornerPair> = fits.iter().zip(&variances).filter_map(|(f, v)| pair(f, sum(v))).collect();
    if pairs.len() < FEWEST_PAIRS {
        return Err(not_found(pairs.len()));
    }
    Ok(SheetPairs { pairs, cells: cells.len() })
}

fn check_axes(matches: &DenseMatches) -> Result<()> {
    let missing = match (matches.column.is_empty(), matches.row.is_empty()) {
        (false, false) => return Ok(()),
        (true, false) => "rows alone",
        (false, true) => "columns alone",
        (true, true) => "neither",
    };
    Err(Error::invalid(
        ErrorSubject::Pattern,
        "columns and rows, as calibration needs (a sequence of the axis \"both\")",
        missing,
    ))
}

/// `panel_from_camera` of the whole sheet, by the middles of the cells.
fn of_sheet(cells: &[Cell]) -> Option<Homography> {
    let mut points: Vec<(Point2<f64>, Point2<f64>)> = cells.iter().filter_map(middle).collect();
    if points.len() < FEWEST_PAIRS {
        return None;
    }
    let all = points.clone();
    for round in 0..=ROUNDS {
        let panel_from_camera = homography_from_points(&points).ok()?;
        if round == ROUNDS {
            return Some(panel_from_camera);
        }
        let error = |(c, p): &(Point2<f64>, Point2<f64>)| {
            panel_from_camera.map(*c).map_or(f64::INFINITY, |q| (q - p).norm())
        };
        let limit = OUTLIER_SIGMAS * robust_scale(all.iter().map(error));
        points = all.iter().filter(|p| error(p) <= limit).copied().collect();
        if points.len() < FEWEST_PAIRS {
            return homography_from_points(&all).ok();
        }
    }
    None
}

/// The medians of the camera's and the panel's coordinates over a cell: rough, and few outliers do not matter.
fn middle(cell: &Cell) -> Option<(Point2<f64>, Point2<f64>)> {
    let of = |value: fn(&Sample) -> f64| median(&mut cell.samples.iter().map(value).collect::<Vec<_>>());
    let camera = Point2::new(of(|s| s.camera.x)?, of(|s| s.camera.y)?);
    Some((camera, Point2::new(of(|s| s.panel[0])?, of(|s| s.panel[1])?)))
}

/// The variance of columns and of rows that whole cells have beyond that of their pixels.
fn beyond_pixels(fits: &[LocalFit], variances: &[[f64; 2]], panel_from_camera: &Homography) -> [f64; 2] {
    let places: Vec<_> = fits.iter().map(|f| f.camera).collect();
    [0, 1].map(|axis| {
        let value = |f: &LocalFit| panel_from_camera.map(f.camera).map_or(0.0, |p| f.panel[axis] - p[axis]);
        let values: Vec<f64> = fits.iter().map(value).collect();
        excess(&places, &values, &variances.iter().map(|v| v[axis]).collect::<Vec<_>>())
    })
}

/// The pair of a fit with this variance of its column and row.
fn pair(fit: &LocalFit, variance: [f64; 2]) -> Option<CornerPair> {
    let camera_by_panel = fit.panel_by_camera.try_inverse()?;
    let by_axis = |axis: usize| camera_by_panel.column(axis).norm_squared() * variance[axis];
    let sigma_px = f64::midpoint(by_axis(0), by_axis(1)).sqrt().hypot(CURVATURE_SHARE * fit.extent_px);
    let is_finite = sigma_px.is_finite() && fit.camera.iter().chain(fit.panel.iter()).all(|x| x.is_finite());
    (is_finite && sigma_px > 0.0).then_some(CornerPair {
        camera: fit.camera,
        projector: fit.panel,
        sigma_px: Some(sigma_px),
    })
}
