//! Sub-pixel positions of checkerboard corners: a model of two crossing blurred edges, integrated over the pixels.
//!
//! Around a corner c the light is m + g·q + (a + h·q)·E₁·E₂ with q = p − c and E_k = erf(n_k·q / (√2·s)), the two edges with
//! normals n₁, n₂ and blur s; m, g, a, h take up the illumination and its slope. Fitted by Levenberg–Marquardt to linear
//! light. The centre of the erf pair is the corner whatever the blur, so that defocus does not bias it.

use nalgebra::{DVector, Matrix2, Point2, SVector, Vector2};

use crate::photo::GreyImage;
use crate::solve::{Block, Linearised, Loss, Problem, Structure, covariance, minimise};

/// Parameters: c (2), θ₁, θ₂, s², m, g (2), a, h (2).
const N: usize = 11;
type Params = SVector<f64, N>;

/// The window reaches this part of the way to the nearest neighbouring corner, so that it stays inside the squares.
const WINDOW_FRACTION: f64 = 0.4;
/// Windows larger than this many samples are measured on the mean over blocks of pixels: what lies far from both
/// edges says nothing about the corner, and the model stays cheap at any resolution.
const MAX_RADIUS_SAMPLES: f64 = 12.0;
/// Windows below this radius hold too few samples for eleven parameters.
const MIN_RADIUS_SAMPLES: f64 = 2.5;
/// The pixel is integrated over this many points per side, each standing for its part of the pixel.
const SUBSAMPLES: usize = 4;
/// A blur of half their distance joins the subsamples: without it a sharp edge between two of them has no slope.
const SUBSAMPLE_VARIANCE: f64 = 0.25 / (SUBSAMPLES * SUBSAMPLES) as f64;
/// The blur's variance may take back nearly all of that, so that a perfectly sharp edge is an inner point of the fit.
const LEAST_VARIANCE: f64 = -0.8 * SUBSAMPLE_VARIANCE;
/// Squares that differ by less than twice this, in linear light, are below one step of an 8-bit photograph.
const MIN_AMPLITUDE: f64 = 1e-4;
/// What remains of perspective, shading and the pixel grid after the fit, in samples: measured on rendered boards with
/// exact truth, where positions scatter by this much with no noise.
const MODEL_SIGMA_SAMPLES: f64 = 0.01;

/// A refined corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Refined {
    pub(super) position: Point2<f64>,
    /// 1σ per coordinate, px.
    pub(super) sigma_px: f64,
}

/// Refines the corner near `start`; `steps` are the offsets to the neighbouring corners along the two grid
/// directions, px. `None` when the window leaves the frame, the fit does not converge, or what is there is no corner.
pub(super) fn refine(grey: &GreyImage, start: Point2<f64>, steps: [Vector2<f64>; 2]) -> Option<Refined> {
    let reach_px = WINDOW_FRACTION * steps[0].norm().min(steps[1].norm());
    let block = ((reach_px / MAX_RADIUS_SAMPLES).ceil() as usize).max(1);
    let radius = reach_px / block as f64;
    if radius.is_nan() || radius < MIN_RADIUS_SAMPLES {
        return None;
    }
    let window = Window::cut(grey, start, block, radius)?;
    let mut p = Params::zeros();
    p[2] = steps[0].y.atan2(steps[0].x);
    p[3] = steps[1].y.atan2(steps[1].x);
    p[4] = 0.6;
    window.solve_light(&mut p);
    let fit = window.fit(p)?;
    let c = Vector2::new(fit.params[0], fit.params[1]);
    // A fit that ran away from its start, or whose edges collapsed into one, has fitted something else.
    let crossing = (fit.params[2] - fit.params[3]).sin().abs();
    if c.norm() > 0.6 * radius || crossing < 0.2 || fit.params[8].abs() <= 3.0 * fit.rms + MIN_AMPLITUDE {
        return None;
    }
    let position = window.origin + c * block as f64;
    let variance = fit.covariance.trace() / 2.0 + MODEL_SIGMA_SAMPLES.powi(2);
    Some(Refined { position, sigma_px: variance.sqrt() * block as f64 })
}

/// The samples around a corner, relative to `origin`, in units of blocks.
struct Window {
    origin: Point2<f64>,
    samples: Vec<(Vector2<f64>, f64)>,
    radius: f64,
    block: Block,
}

struct Fit {
    params: Params,
    rms: f64,
    covariance: Matrix2<f64>,
}

impl Window {
    fn cut(grey: &GreyImage, start: Point2<f64>, block: usize, radius: f64) -> Option<Self> {
        let half = radius.floor() as isize;
        let k = block as isize;
        // The block grid is laid so that the middle block is centred as near to `start` as whole pixels allow.
        let centre_offset = (block as f64 - 1.0) / 2.0;
        let x0 = (start.x - centre_offset).round() as isize;
        let y0 = (start.y - centre_offset).round() as isize;
        let origin = Point2::new(x0 as f64 + centre_offset, y0 as f64 + centre_offset);
        let fits = |v: isize, size: usize| v - half * k >= 0 && v + half * k + k <= size as isize;
        if !(fits(x0, grey.width()) && fits(y0, grey.height())) {
            return None;
        }
        let mut samples = Vec::with_capacity((2 * half as usize + 1).pow(2));
        for j in -half..=half {
            for i in -half..=half {
                let at = Vector2::new(i as f64, j as f64);
                if at.norm_squared() > radius * radius {
                    continue;
                }
                let (x, y) = ((x0 + i * k) as usize, (y0 + j * k) as usize);
                let sum: f32 = (y..y + block).map(|y| grey.row(y)[x..x + block].iter().sum::<f32>()).sum();
                samples.push((at, f64::from(sum) / (block * block) as f64));
            }
        }
        let block = Block { len: samples.len(), loss: Loss::Square };
        Some(Self { origin, samples, radius, block })
    }

    /// The mean over a sample of the product of edges, and its derivatives by c, θ₁, θ₂, s, and the mean of q·E.
    fn model(p: &Params, at: Vector2<f64>) -> (f64, Params) {
        let s = (p[4] + SUBSAMPLE_VARIANCE).sqrt();
        let (t1, t2) = (Vector2::new(p[2].cos(), p[2].sin()), Vector2::new(p[3].cos(), p[3].sin()));
        let (n1, n2) = (Vector2::new(-t1.y, t1.x), Vector2::new(-t2.y, t2.x));
        let root = 1.0 / (std::f64::consts::SQRT_2 * s);
        let slope = |d: f64| std::f64::consts::FRAC_2_SQRT_PI * (-(d * root).powi(2)).exp() * root;
        let (g, h) = (Vector2::new(p[6], p[7]), Vector2::new(p[9], p[10]));
        let mut value = 0.0;
        let mut derivative = Params::zeros();
        let step = 1.0 / SUBSAMPLES as f64;
        for j in 0..SUBSAMPLES {
            for i in 0..SUBSAMPLES {
                let sub = Vector2::new((i as f64 + 0.5) * step - 0.5, (j as f64 + 0.5) * step - 0.5);
                let q = at + sub - Vector2::new(p[0], p[1]);
                let (d1, d2) = (n1.dot(&q), n2.dot(&q));
                let (e1, e2) = (libm::erf(d1 * root), libm::erf(d2 * root));
                let (s1, s2) = (slope(d1), slope(d2));
                let amplitude = p[8] + h.dot(&q);
                let e = e1 * e2;
                value += p[5] + g.dot(&q) + amplitude * e;
                let dc = -(n1 * (s1 * e2) + n2 * (s2 * e1)) * amplitude - g - h * e;
                derivative += Params::from_column_slice(&[
                    dc.x,
                    dc.y,
                    amplitude * e2 * s1 * -t1.dot(&q),
                    amplitude * e1 * s2 * -t2.dot(&q),
                    -amplitude * (d1 * s1 * e2 + d2 * s2 * e1) / (2.0 * s * s),
                    1.0,
                    q.x,
                    q.y,
                    e,
                    e * q.x,
                    e * q.y,
                ]);
            }
        }
        let count = (SUBSAMPLES * SUBSAMPLES) as f64;
        (value / count, derivative / count)
    }

    /// Mean and amplitude by linear least squares for the given edges: the sign of the corner comes out of it.
    fn solve_light(&self, p: &mut Params) {
        let (mut n, mut e, mut ee, mut l, mut le) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &(at, light) in &self.samples {
            let edge = Self::model(p, at).1[8];
            n += 1.0;
            e += edge;
            ee += edge * edge;
            l += light;
            le += light * edge;
        }
        let det = n * ee - e * e;
        if det > 0.0 {
            p[8] = (n * le - e * l) / det;
            p[5] = (l - p[8] * e) / n;
        }
    }

    fn fit(&self, start: Params) -> Option<Fit> {
        let count = self.samples.len();
        let freedom = count as f64 - N as f64;
        if freedom <= 0.0 {
            return None;
        }
        let minimum = minimise(self, start)?;
        let variance = minimum.cost / freedom;
        let jacobian = &minimum.at.jacobian;
        let covariance = covariance(&self.structure(), jacobian, &[])?.fixed_view::<2, 2>(0, 0) * variance;
        Some(Fit { params: minimum.state, rms: variance.sqrt(), covariance })
    }
}

impl Problem for Window {
    type State = Params;

    fn blocks(&self) -> &[Block] {
        std::slice::from_ref(&self.block)
    }

    /// Eight are usual. Sharp edges along the pixel grid have a cost that is rough below a thousandth of a pixel: more
    /// steps would only follow that.
    fn max_iterations(&self) -> usize {
        30
    }

    fn structure(&self) -> Structure<'_> {
        Structure::dense(N)
    }

    fn linearise(&self, p: &Params, to: &mut Linearised) -> Option<()> {
        for (i, (at, light)) in self.samples.iter().enumerate() {
            let (value, derivative) = Self::model(p, *at);
            to.residuals[i] = value - light;
            to.jacobian.row_mut(i).copy_from(&derivative.transpose());
        }
        Some(())
    }

    fn step(&self, p: &Params, delta: &DVector<f64>) -> Option<Params> {
        let mut next = p + Params::from_column_slice(delta.as_slice());
        next[4] = next[4].max(LEAST_VARIANCE);
        // A corner that leaves its window, or is blurred beyond it, is none.
        (next.fixed_rows::<2>(0).norm() < self.radius && next[4] < self.radius.powi(2)).then_some(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corner of two edges, drawn by 16×16 supersampling of the ideal one and a blur by the pixel alone.
    fn drawn(c: Point2<f64>, angles: [f64; 2], size: usize) -> GreyImage {
        let [n1, n2] = angles.map(|a| Vector2::new(-a.sin(), a.cos()));
        GreyImage::from_fn(size, size, |x, y| {
            let mut sum = 0.0;
            for j in 0..16 {
                for i in 0..16 {
                    let q = Point2::new(
                        x as f64 + (f64::from(i) + 0.5) / 16.0 - 0.5,
                        y as f64 + (f64::from(j) + 0.5) / 16.0 - 0.5,
                    ) - c;
                    sum += if n1.dot(&q) * n2.dot(&q) > 0.0 { 0.8 } else { 0.1 };
                }
            }
            (sum / 256.0) as f32
        })
    }

    #[test]
    fn finds_sharp_corners_at_any_phase_angle_and_scale() {
        for (size, square) in [(41_usize, 14.0), (161, 60.0)] {
            for k in 0..12 {
                let phase = f64::from(k) * 0.083;
                let mid = size as f64 / 2.0;
                let c = Point2::new(mid + phase, mid - 0.7 * phase);
                let angles = [0.02 + f64::from(k) * 0.05, 1.45];
                let image = drawn(c, angles, size);
                let steps = angles.map(|a| Vector2::new(a.cos(), a.sin()) * square);
                let found = refine(&image, c + Vector2::new(0.3, -0.25), steps).unwrap();
                let error = (found.position - c).norm();
                assert!(error < 0.02 * square / 14.0, "{size} {k}: {error}");
            }
        }
    }

    #[test]
    fn what_is_no_corner_is_refused() {
        let steps = [Vector2::new(20.0, 0.0), Vector2::new(0.0, 20.0)];
        let flat = GreyImage::from_fn(60, 60, |_, _| 0.5);
        assert!(refine(&flat, Point2::new(30.0, 30.0), steps).is_none());
        let edge = GreyImage::from_fn(60, 60, |x, _| if x < 30 { 0.1 } else { 0.9 });
        assert!(refine(&edge, Point2::new(30.0, 30.0), steps).is_none());
        assert!(refine(&flat, Point2::new(2.0, 30.0), steps).is_none());
        assert!(refine(&flat, Point2::new(f64::NAN, 30.0), steps).is_none());
    }
}
