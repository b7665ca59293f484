//! The panel position in the middle of a cell: an affine map fitted robustly to what the pixels differ from the map of the whole sheet.

use nalgebra::{Matrix2, Matrix3, Point2, Vector2, Vector3};

use super::cells::{Cell, Sample};
use crate::geometry::Homography;
use crate::solve::{Loss, robust_scale};

/// A cell needs so many pixels with a position, so that their scatter is known to a tenth.
const FEWEST_SAMPLES: usize = 64;
/// It needs so large a share of its pixels: fewer are left at a border of the light, and where something lies on the sheet.
const LEAST_KNOWN: f64 = 0.75;
/// It needs so large a share of these in the fit. A share of one plane and a share of another make no pair.
const LEAST_USED: f64 = 0.6;
/// Cutoff of Huber's loss in the first rounds and of Tukey's in the last ones, in standard deviations of both coordinates together.
const HUBER: f64 = 2.5;
const TUKEY: f64 = 5.0;
/// Rounds of each; weights change by less than a hundredth then.
const ROUNDS: usize = 4;
/// A cell is divided into so many blocks along each side, to see how far the errors of neighbouring pixels are alike.
const BLOCKS: usize = 4;
/// Unknowns of an affine map, per coordinate.
const UNKNOWNS: usize = 3;

/// What a cell says.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalFit {
    /// In its middle, px.
    pub(super) camera: Point2<f64>,
    /// The panel position there, px.
    pub(super) panel: Point2<f64>,
    /// The derivative of the panel position by the camera's.
    pub(super) panel_by_camera: Matrix2<f64>,
    /// Variance of column and row if the errors of all pixels were independent, px².
    pub(super) variance: [f64; 2],
    /// Variance by the scatter of blocks over that variance.
    pub(super) alike: [f64; 2],
    /// Width and height of the cell in the image, px: the larger.
    pub(super) extent_px: f64,
}

/// Fits a cell. `None` for one of too few pixels, or on which they do not agree.
pub(super) fn fit(cell: &Cell, panel_from_camera: &Homography) -> Option<LocalFit> {
    let n = cell.samples.len();
    if n < FEWEST_SAMPLES || (n as f64) < LEAST_KNOWN * cell.pixels as f64 {
        return None;
    }
    let origin = mean(&cell.samples, |_| 1.0)?;
    let mut differences = Vec::with_capacity(n);
    for sample in &cell.samples {
        let expected = panel_from_camera.map(sample.camera)?;
        differences.push([sample.panel[0] - expected.x, sample.panel[1] - expected.y]);
    }
    let mut weights = vec![1.0; n];
    let mut errors = differences.clone();
    let mut affine = [Vector3::zeros(); 2];
    let mut scale = [1.0; 2];
    for round in 0..2 * ROUNDS {
        for axis in 0..2 {
            let normal = normal_matrix(&cell.samples, &weights, axis, origin);
            let side: Vector3<f64> = cell
                .samples
                .iter()
                .zip(&weights)
                .zip(&differences)
                .map(|((s, w), d)| terms(s.camera, origin) * (w * d[axis] / s.sigma[axis].powi(2)))
                .sum();
            affine[axis] = normal.try_inverse()? * side;
            for ((e, d), s) in errors.iter_mut().zip(&differences).zip(&cell.samples) {
                e[axis] = d[axis] - affine[axis].dot(&terms(s.camera, origin));
            }
            let whitened = errors.iter().zip(&cell.samples).map(|(e, s)| (e[axis] / s.sigma[axis]).abs());
            // Positions without noise agree exactly.
            scale[axis] = robust_scale(whitened).max(f64::EPSILON.sqrt());
        }
        let loss = if round < ROUNDS { Loss::Huber(HUBER) } else { Loss::Tukey(TUKEY) };
        for ((w, e), s) in weights.iter_mut().zip(&errors).zip(&cell.samples) {
            let whitened = [0, 1].map(|axis| (e[axis] / (s.sigma[axis] * scale[axis])).powi(2));
            *w = loss.weight(whitened[0] + whitened[1]).min(1.0);
        }
    }
    if weights.iter().sum::<f64>() < LEAST_USED * n as f64 {
        return None;
    }
    let mut i = 0..n;
    let camera = mean(&cell.samples, |_| i.next().map_or(0.0, |i| weights[i]))?;
    let at = terms(camera, origin);
    let blocks = Blocks::of(&cell.samples);
    let mut result = LocalFit {
        camera,
        panel: panel_from_camera.map(camera)? + Vector2::from([0, 1].map(|axis| affine[axis].dot(&at))),
        panel_by_camera: panel_from_camera.jacobian(camera)
            + Matrix2::new(affine[0].y, affine[0].z, affine[1].y, affine[1].z),
        variance: [0.0; 2],
        alike: [1.0; 2],
        extent_px: blocks.size.amax() * BLOCKS as f64,
    };
    for axis in 0..2 {
        let inverse = normal_matrix(&cell.samples, &weights, axis, origin).try_inverse()?;
        let influence = inverse * at;
        result.variance[axis] = scale[axis].powi(2) * influence.dot(&at);
        let mut sums = [0.0; BLOCKS * BLOCKS];
        for ((s, w), e) in cell.samples.iter().zip(&weights).zip(&errors) {
            let weight = w / s.sigma[axis].powi(2);
            sums[blocks.index(s.camera)] += weight * e[axis] * influence.dot(&terms(s.camera, origin));
        }
        let count = sums.iter().filter(|s| **s != 0.0).count();
        if count > UNKNOWNS {
            let freedom = count as f64 / (count - UNKNOWNS) as f64;
            result.alike[axis] = freedom * sums.iter().map(|s| s * s).sum::<f64>() / result.variance[axis];
        }
    }
    Some(result)
}

/// What the coefficients of an affine map multiply.
fn terms(camera: Point2<f64>, origin: Point2<f64>) -> Vector3<f64> {
    Vector3::new(1.0, camera.x - origin.x, camera.y - origin.y)
}

fn normal_matrix(samples: &[Sample], weights: &[f64], axis: usize, origin: Point2<f64>) -> Matrix3<f64> {
    let mut sum = Matrix3::zeros();
    for (s, w) in samples.iter().zip(weights) {
        let x = terms(s.camera, origin);
        sum += x * x.transpose() * (w / s.sigma[axis].powi(2));
    }
    sum
}

fn mean(samples: &[Sample], mut weight: impl FnMut(&Sample) -> f64) -> Option<Point2<f64>> {
    let (mut sum, mut total) = (Vector2::zeros(), 0.0);
    for s in samples {
        let w = weight(s);
        sum += s.camera.coords * w;
        total += w;
    }
    (total > 0.0).then(|| Point2::from(sum / total))
}

/// The blocks of a cell.
struct Blocks {
    low: Point2<f64>,
    size: Vector2<f64>,
}

impl Blocks {
    fn of(samples: &[Sample]) -> Self {
        let first = samples.first().map_or(Point2::origin(), |s| s.camera);
        let (low, high) =
            samples.iter().fold((first, first), |(low, high), s| (low.inf(&s.camera), high.sup(&s.camera)));
        Self { low, size: (high - low).map(|x| (x / BLOCKS as f64).max(f64::MIN_POSITIVE)) }
    }

    fn index(&self, camera: Point2<f64>) -> usize {
        let at = (camera - self.low).component_div(&self.size).map(|x| (x as usize).min(BLOCKS - 1));
        at.y * BLOCKS + at.x
    }
}
