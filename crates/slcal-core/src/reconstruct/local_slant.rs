//! The usual slant of a surface in each part of the image.

use super::triangle_metrics::TriangleMetrics;
use crate::solve::median;

/// Side of the cells that make up a neighbourhood, in median sides of triangles: about five stripes.
const CELL_SIDES: f64 = 5.0;
/// Largest number of cells along either side of the image; what lies beyond belongs to the last one.
const MOST_CELLS: usize = 1024;
/// The slant of a surface that faces the camera is about this quantile of all triangles.
const LEAST_QUANTILE: f64 = 0.1;
/// Upper limit for a neighbourhood of wrong triangles alone: four times the slant of a surface that faces the camera is
/// 75°.
const MOST_SLANTED: f64 = 4.0;

/// The median slant of the triangles in every cell of a grid over the image; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct LocalSlant {
    cell_px: f64,
    size: [usize; 2],
    /// Where each cell's triangles begin in `slants`, and the end.
    starts: Vec<u32>,
    slants: Vec<f64>,
    all: Vec<f64>,
    usual: Vec<f64>,
    least: f64,
}

impl LocalSlant {
    fn column_and_row(&self, s: &TriangleMetrics) -> [usize; 2] {
        // Casts saturate: what lies left of or above the image belongs to the first cell.
        [s.middle.x, s.middle.y].map(|x| ((x / self.cell_px) as usize).min(MOST_CELLS - 1))
    }

    fn cell(&self, s: &TriangleMetrics) -> usize {
        let [x, y] = self.column_and_row(s);
        y.min(self.size[1] - 1) * self.size[0] + x.min(self.size[0] - 1)
    }

    /// Computes the medians from the triangles that are not longer than `longest_px`; `usual_px` is their usual length.
    pub(super) fn learn(&mut self, shapes: &[TriangleMetrics], usual_px: f64, longest_px: f64) {
        let fine = |s: &&TriangleMetrics| s.slant.is_finite() && s.longest_px <= longest_px;
        self.cell_px = if usual_px > 0.0 { CELL_SIDES * usual_px } else { 1.0 };
        self.size = [1, 1];
        for s in shapes.iter().filter(fine) {
            let at = self.column_and_row(s);
            self.size = [0, 1].map(|k| self.size[k].max(at[k] + 1));
        }
        // Counting sort by cell.
        self.starts.clear();
        self.starts.resize(self.size[0] * self.size[1] + 1, 0);
        let mut n = 0;
        for s in shapes.iter().filter(fine) {
            let cell = self.cell(s);
            self.starts[cell] += 1;
            n += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.slants.clear();
        self.slants.resize(n, 0.0);
        for s in shapes.iter().filter(fine) {
            let cell = self.cell(s);
            self.starts[cell] -= 1;
            self.slants[self.starts[cell] as usize] = s.slant;
        }
        self.all.clear();
        self.all.extend_from_slice(&self.slants);
        self.least = quantile(&mut self.all, LEAST_QUANTILE);
        self.usual.clear();
        for range in self.starts.windows(2) {
            let of_cell = &mut self.slants[range[0] as usize..range[1] as usize];
            self.usual.push(median(of_cell).unwrap_or(self.least));
        }
    }

    /// The usual slant about a triangle.
    pub(super) fn usual_slant(&self, s: &TriangleMetrics) -> f64 {
        let here = self.usual.get(self.cell(s)).copied().unwrap_or(self.least);
        // No neighbourhood is less slanted than a surface can be: a cell with a single wrong triangle carries no
        // evidence.
        here.clamp(self.least, MOST_SLANTED * self.least)
    }
}

fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() - 1) as f64 * q) as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}
