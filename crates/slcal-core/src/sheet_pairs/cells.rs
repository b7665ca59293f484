//! The sheet cut into cells of equal size, with the pixels of each.

use nalgebra::Point2;

use crate::dense_matches::DenseMatches;
use crate::geometry::{Homography, Line};
use crate::observations::SheetObservation;
use crate::solve::homography_from_points;

/// Cells along the longer side of the sheet. What lenses and bends do over a cell is then nearly affine: of a radial coefficient k
/// the middle of a cell keeps an error of k/4 of the square of its width, in focal lengths, below 1e-4 of the focal length for k = 0.25.
/// With two hundred cells the noise is not what limits a calibration.
const ALONG: f64 = 20.0;
/// Shortest side of a cell, px: blocks of a sixteenth of it then hold enough pixels to measure how they scatter.
const SHORTEST_PX: f64 = 12.0;
/// The grid keeps this part of a cell from the sides of the sheet, where a pixel sees what is behind it, too.
const MARGIN: f64 = 0.25;
/// Of cells of more pixels than this, an evenly spread part is used: their noise averages to far below the errors that they share.
const MOST_PIXELS: f64 = 4096.0;

/// A pixel with both panel coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) camera: Point2<f64>,
    /// Panel column and row, px.
    pub(super) panel: [f64; 2],
    /// 1σ of them, px.
    pub(super) sigma: [f64; 2],
}

/// The pixels of a cell.
#[derive(Debug, Clone, Default)]
pub(super) struct Cell {
    /// Pixels that were looked at.
    pub(super) pixels: usize,
    /// Those with both coordinates.
    pub(super) samples: Vec<Sample>,
}

/// All cells, row by row of the sheet; none where the sheet is too small.
pub(super) fn cells(matches: &DenseMatches, sheet: &SheetObservation) -> Vec<Cell> {
    let Some(grid) = Grid::new(sheet) else { return Vec::new() };
    let mut cells = vec![Cell::default(); grid.columns * grid.rows];
    let bounds = |of: fn(&Point2<f64>) -> f64, most: usize| {
        let values = grid.outline.iter().map(of);
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
        // Out of the frame there are no pixels.
        [low.ceil().max(0.0) as usize, ((high.floor() + 1.0).max(0.0) as usize).min(most)]
    };
    let [left, right] = bounds(|c| c.x, matches.width);
    let [top, bottom] = bounds(|c| c.y, matches.height);
    for v in (top..bottom).step_by(grid.step) {
        for u in (left..right).step_by(grid.step) {
            let camera = Point2::new(u as f64, v as f64);
            let Some(index) = grid.cell_of(camera) else { continue };
            let cell = &mut cells[index];
            cell.pixels += 1;
            cell.samples.extend(sample(matches, v * matches.width + u, camera));
        }
    }
    cells
}

fn sample(matches: &DenseMatches, pixel: usize, camera: Point2<f64>) -> Option<Sample> {
    let value = |of: &[f32]| of.get(pixel).copied().filter(|x| x.is_finite()).map(f64::from);
    let positive = |of: &[f32]| value(of).filter(|s| *s > 0.0);
    Some(Sample {
        camera,
        panel: [value(&matches.column)?, value(&matches.row)?],
        sigma: [positive(&matches.sigma_column)?, positive(&matches.sigma_row)?],
    })
}

/// A grid on the sheet.
struct Grid {
    columns: usize,
    rows: usize,
    /// Cells (column, row) of camera pixels.
    cell_from_camera: Homography,
    /// Corners of the grid, px.
    outline: [Point2<f64>; 4],
    /// Of so many pixels one is used, along rows and columns of the image.
    step: usize,
}

impl Grid {
    fn new(sheet: &SheetObservation) -> Option<Self> {
        let corners = inner_corners(sheet)?;
        let length = |i: usize| (corners[(i + 1) % 4] - corners[i]).norm();
        let [width, height] = [0, 1].map(|i: usize| f64::midpoint(length(i), length(i + 2)));
        let side = (width.max(height) / ALONG).max(SHORTEST_PX);
        let count = |extent: f64| (extent / side - 2.0 * MARGIN).floor().max(0.0);
        let [columns, rows] = [count(width), count(height)];
        if columns < 1.0 || rows < 1.0 {
            return None;
        }
        let [m, right, bottom] = [-MARGIN, columns + MARGIN, rows + MARGIN];
        let cells = [(m, m), (right, m), (right, bottom), (m, bottom)];
        let pairs: Vec<_> = corners.into_iter().zip(cells.map(|(x, y)| Point2::new(x, y))).collect();
        let cell_from_camera = homography_from_points(&pairs).ok()?;
        let camera_from_cell = cell_from_camera.inverse()?;
        let ends = [(0.0, 0.0), (columns, 0.0), (columns, rows), (0.0, rows)];
        let mut outline = corners;
        for (to, (x, y)) in outline.iter_mut().zip(ends) {
            *to = camera_from_cell.map(Point2::new(x, y))?;
        }
        let pixels = width * height / (columns * rows);
        let step = (pixels / MOST_PIXELS).sqrt().ceil().max(1.0) as usize;
        Some(Self { columns: columns as usize, rows: rows as usize, cell_from_camera, outline, step })
    }

    fn cell_of(&self, camera: Point2<f64>) -> Option<usize> {
        let at = self.cell_from_camera.map(camera)?;
        let inside = |v: f64, n: usize| (v >= 0.0 && v < n as f64).then_some(v as usize);
        Some(inside(at.y, self.rows)? * self.columns + inside(at.x, self.columns)?)
    }
}

/// The corners of a quadrilateral inside the sheet: its sides run through the innermost points that were measured, because the image of a
/// side is bent by the lens.
fn inner_corners(sheet: &SheetObservation) -> Option<[Point2<f64>; 4]> {
    let corners = sheet.corners()?;
    let SheetObservation::Edges(sides) = sheet else { return Some(corners) };
    let middle = Point2::from(corners.iter().map(|c| c.coords).sum::<nalgebra::Vector2<f64>>() / 4.0);
    let mut lines = [Line(nalgebra::Vector3::zeros()); 4];
    for (i, (line, points)) in lines.iter_mut().zip(sides).enumerate() {
        let straight = Line::through_pixels(corners[i], corners[(i + 1) % 4]).normalized()?;
        let inward = straight.signed_distance_px(middle).signum();
        let deepest =
            points.iter().map(|p| inward * straight.signed_distance_px(p.position)).fold(0.0, f64::max);
        let shift = straight.normal() * (inward * deepest);
        *line = Line::through_pixels(corners[i] + shift, corners[(i + 1) % 4] + shift);
    }
    let [top, right, bottom, left] = lines;
    Some([
        left.meet(top).pixel()?,
        top.meet(right).pixel()?,
        right.meet(bottom).pixel()?,
        bottom.meet(left).pixel()?,
    ])
}
