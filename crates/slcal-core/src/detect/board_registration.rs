//! Registration of the detected grid to the pattern: which corner of the pattern each corner of the grid is.
//!
//! A grid is labelled up to a quarter turn and a shift. The colours of the squares and of the background resolve both.
//! The number of columns plus rows is odd, so that a half-turn inverts every square. A shift changes the border.

use std::collections::HashMap;

use nalgebra::{Point2, Vector2};

use super::checkerboard::LabelledCorner;
use crate::geometry::Homography;
use crate::pattern::{CheckerPattern, SquareColor};
use crate::photo::LinearPhoto;
use crate::solve::homography_from_points;

/// A corner of the photograph with its place in the pattern: column and row of the inner corner, 0-based.
#[derive(Debug, Clone, Copy)]
pub(super) struct RegisteredCorner {
    pub(super) index: [u32; 2],
    pub(super) position: Point2<f64>,
}

/// Why a grid could not be registered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unregistered {
    /// The grid is larger than the pattern, or too small or too curved for a homography.
    Misfit,
    /// Two placements explain the squares equally well.
    Ambiguous,
    /// The squares' colours are not those of the pattern.
    Colors,
}

/// A placement: label = turn(index) + shift.
#[derive(Debug, Clone, Copy)]
struct Placement {
    /// Columns of the quarter-turn matrix that takes pattern steps to label steps.
    right: [i32; 2],
    down: [i32; 2],
    /// Label of inner corner (0, 0).
    origin: [i32; 2],
}

impl Placement {
    fn label(&self, i: i32, j: i32) -> [i32; 2] {
        std::array::from_fn(|k| self.origin[k] + i * self.right[k] + j * self.down[k])
    }

    fn index(&self, label: [i32; 2]) -> [i32; 2] {
        let d = [label[0] - self.origin[0], label[1] - self.origin[1]];
        [d[0] * self.right[0] + d[1] * self.right[1], d[0] * self.down[0] + d[1] * self.down[1]]
    }
}

/// The four quarter turns: (right, down).
const TURNS: [([i32; 2], [i32; 2]); 4] =
    [([1, 0], [0, 1]), ([0, 1], [-1, 0]), ([-1, 0], [0, -1]), ([0, -1], [1, 0])];

/// Share of the discriminating pairs of squares that must support a placement. A quarter of them may be hidden, shaded
/// or glaring.
const MIN_VOTE: f64 = 0.75;
/// Fewest discriminating pairs.
const MIN_DECIDING_PAIRS: usize = 3;
/// Mean disagreement (0: every pair as predicted, 1: no relation, 2: inverted) above which the colours do not fit.
const MAX_DISAGREEMENT: f64 = 0.5;

/// Registers a grid to the pattern.
pub(super) fn register(
    photo: &LinearPhoto<'_>,
    grid: &[LabelledCorner],
    pattern: &CheckerPattern,
) -> Result<Vec<RegisteredCorner>, Unregistered> {
    let labels: Vec<(Point2<f64>, Point2<f64>)> = grid
        .iter()
        .map(|c| (Point2::new(f64::from(c.label[0]), f64::from(c.label[1])), c.position))
        .collect();
    let image_from_label = homography_from_points(&labels).map_err(|_| Unregistered::Misfit)?;
    // The projected pattern is never mirrored: a mirrored numbering comes from the detector and is reversed.
    let mirrored = image_from_label.jacobian(labels[0].0).determinant() < 0.0;
    let flip = if mirrored { -1 } else { 1 };
    let grid: Vec<LabelledCorner> =
        grid.iter().map(|c| LabelledCorner { label: [flip * c.label[0], c.label[1]], ..*c }).collect();
    let image_from_label = if mirrored {
        image_from_label
            .compose(&Homography(nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(-1.0, 1.0, 1.0))))
    } else {
        image_from_label
    };

    let cells = Cells::sample(photo, &image_from_label, &grid, pattern);
    let mut ranked: Vec<(f64, Placement)> =
        placements(&grid, pattern).into_iter().map(|p| (cells.disagreement(pattern, &p), p)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(disagreement, best)) = ranked.first() else { return Err(Unregistered::Misfit) };
    if disagreement.is_nan() || disagreement > MAX_DISAGREEMENT {
        return Err(Unregistered::Colors);
    }
    for (_, other) in &ranked[1..] {
        if !cells.prefer(pattern, &best, other) {
            return Err(Unregistered::Ambiguous);
        }
    }
    Ok(grid
        .iter()
        .map(|c| RegisteredCorner { index: best.index(c.label).map(|x| x as u32), position: c.position })
        .collect())
}

/// Every placement for which the whole grid lies inside the pattern.
fn placements(grid: &[LabelledCorner], pattern: &CheckerPattern) -> Vec<Placement> {
    let inner = pattern.squares.map(|n| n as i32 - 1);
    let mut all = Vec::new();
    for (right, down) in TURNS {
        let turned = Placement { right, down, origin: [0, 0] };
        let indices = || grid.iter().map(|c| turned.index(c.label));
        let range = |k: usize| {
            let values = indices().map(move |i| i[k]);
            (values.clone().min().unwrap_or(0), values.max().unwrap_or(0))
        };
        let ((min_i, max_i), (min_j, max_j)) = (range(0), range(1));
        // The shift in pattern steps that keeps both ends inside.
        for di in -min_i..inner[0] - max_i {
            for dj in -min_j..inner[1] - max_j {
                all.push(Placement { right, down, origin: turned.label(-di, -dj) });
            }
        }
    }
    all
}

/// Mean light of the squares around the grid, keyed by the label of their upper-left corner.
struct Cells {
    light: HashMap<[i32; 2], f64>,
    /// Median difference of neighbours inside the grid, in the logarithm of light.
    contrast: f64,
}

impl Cells {
    fn sample(
        photo: &LinearPhoto<'_>,
        image_from_label: &Homography,
        grid: &[LabelledCorner],
        pattern: &CheckerPattern,
    ) -> Self {
        let reach = pattern.squares[0].max(pattern.squares[1]) as i32 + 1;
        let bounds = |k: usize| {
            let values = grid.iter().map(move |c| c.label[k]);
            (values.clone().min().unwrap_or(0) - reach, values.max().unwrap_or(0) + reach)
        };
        let ((u0, u1), (v0, v1)) = (bounds(0), bounds(1));
        let sign = image_from_label.0
            * nalgebra::Vector3::new(f64::from(grid[0].label[0]), f64::from(grid[0].label[1]), 1.0);
        let mut light = HashMap::new();
        for u in u0..=u1 {
            for v in v0..=v1 {
                // Beyond the horizon of the plane there is no square.
                let centre = nalgebra::Vector3::new(f64::from(u) + 0.5, f64::from(v) + 0.5, 1.0);
                if (image_from_label.0 * centre).z * sign.z <= 0.0 {
                    continue;
                }
                if let Some(mean) = cell_light(photo, image_from_label, u, v) {
                    light.insert([u, v], mean.max(1e-6).ln());
                }
            }
        }
        // Across an inner corner, the squares on both sides of an edge differ in colour.
        let inner = || grid.iter().map(|c| c.label);
        let mut differences: Vec<f64> = inner()
            .filter_map(|[u, v]| Some((light.get(&[u, v])? - light.get(&[u - 1, v])?).abs()))
            .collect();
        differences.sort_by(f64::total_cmp);
        let contrast = differences.get(differences.len() / 2).copied().unwrap_or(0.0);
        // Cells far darker than the black squares or brighter than the white ones are not on the sheet.
        let mut levels: Vec<f64> = inner().filter_map(|label| light.get(&label).copied()).collect();
        levels.sort_by(f64::total_cmp);
        if let (Some(black), Some(white)) = (levels.first(), levels.last()) {
            let (black, white) = (black - contrast / 2.0, white + contrast / 2.0);
            light.retain(|_, l| (black..=white).contains(l));
        }
        Self { light, contrast }
    }

    /// Predicted and measured difference of the pairs of neighbouring squares of which one lies in the pattern, in units
    /// of the contrast, behind the two squares.
    fn pairs<'a>(
        &'a self,
        pattern: &'a CheckerPattern,
        placement: &'a Placement,
    ) -> impl Iterator<Item = ([[i32; 2]; 2], f64, f64)> + 'a {
        let [columns, rows] = pattern.squares.map(|n| n as i32);
        let cells = (-1..=columns).flat_map(move |i| (-1..=rows).map(move |j| [i, j]));
        cells.flat_map(move |[i, j]| {
            [[1, 0], [0, 1]].into_iter().filter_map(move |[di, dj]| {
                let (a, b) = ([i, j], [i + di, j + dj]);
                if !(inside(pattern, a) || inside(pattern, b)) {
                    return None;
                }
                let measured = self.cell(placement, b)? - self.cell(placement, a)?;
                let predicted = color(pattern, b) - color(pattern, a);
                Some(([a, b], predicted, (measured / self.contrast).clamp(-1.5, 1.5)))
            })
        })
    }

    /// Light of square (i, j) of the pattern under a placement.
    fn cell(&self, placement: &Placement, [i, j]: [i32; 2]) -> Option<f64> {
        // Square (i, j) has inner corners (i−1, j−1) and (i, j) at its ends; the label of the cell is the smaller one.
        let (a, b) = (placement.label(i - 1, j - 1), placement.label(i, j));
        self.light.get(&[a[0].min(b[0]), a[1].min(b[1])]).copied()
    }

    /// Mean of |predicted − measured| over the pairs.
    fn disagreement(&self, pattern: &CheckerPattern, placement: &Placement) -> f64 {
        let (sum, n) = self
            .pairs(pattern, placement)
            .fold((0.0, 0), |(sum, n), (_, predicted, measured)| (sum + (predicted - measured).abs(), n + 1));
        sum / f64::from(n)
    }

    /// Whether the pairs of squares in which two placements differ support the first one.
    fn prefer(&self, pattern: &CheckerPattern, first: &Placement, second: &Placement) -> bool {
        let mut votes = (0, 0);
        let mut count = |of: &Placement, against: &Placement, for_first: bool| {
            // What the other placement predicts for the same square of the picture.
            let there = |[i, j]: [i32; 2]| {
                let [p, q] = [of.label(i - 1, j - 1), of.label(i, j)].map(|label| against.index(label));
                color(pattern, [p[0].max(q[0]), p[1].max(q[1])])
            };
            for ([a, b], predicted, measured) in self.pairs(pattern, of) {
                let other = there(b) - there(a);
                if (predicted - other).abs() > 0.5 {
                    let closer = (predicted - measured).abs() < (other - measured).abs();
                    votes.0 += usize::from(closer == for_first);
                    votes.1 += 1;
                }
            }
        };
        count(first, second, true);
        count(second, first, false);
        votes.1 >= MIN_DECIDING_PAIRS && votes.0 as f64 >= MIN_VOTE * votes.1 as f64
    }
}

fn inside(pattern: &CheckerPattern, [i, j]: [i32; 2]) -> bool {
    (0..pattern.squares[0] as i32).contains(&i) && (0..pattern.squares[1] as i32).contains(&j)
}

/// 1 for white, 0 for black, of a square or the background around the pattern.
fn color(pattern: &CheckerPattern, [i, j]: [i32; 2]) -> f64 {
    let first = f64::from(u8::from(pattern.first_square == SquareColor::White));
    if inside(pattern, [i, j]) {
        if (i + j) % 2 == 0 { first } else { 1.0 - first }
    } else {
        f64::from(u8::from(pattern.background == SquareColor::White))
    }
}

/// Mean light over the middle of a cell; `None` unless all of it lies in the frame.
fn cell_light(photo: &LinearPhoto<'_>, image_from_label: &Homography, u: i32, v: i32) -> Option<f64> {
    const OFFSETS: [f64; 3] = [0.35, 0.5, 0.65];
    let mut sum = 0.0;
    for du in OFFSETS {
        for dv in OFFSETS {
            let p = image_from_label.map(Point2::from(Vector2::new(f64::from(u) + du, f64::from(v) + dv)))?;
            sum += photo.bilinear(p)?;
        }
    }
    Some(sum / 9.0)
}
