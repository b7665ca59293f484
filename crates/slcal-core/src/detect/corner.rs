//! Sub-pixel positions of checkerboard corners: a model of two crossing blurred edges, integrated over the pixels.
//!
//! Around a corner c the light is m + g·q + (a + h·q)·E₁·E₂ with q = p − c and E_k = erf(n_k·q / (√2·s)), the two edges with
//! normals n₁, n₂ and blur s; m, g, a, h model the illumination and its gradient. The model is fitted to
//! linear light by damped Gauss–Newton steps. Its centre is the corner for every blur, so that defocus does not bias it.

use nalgebra::{Matrix2, Point2, SMatrix, SVector, Vector2};

use super::erf::ErfTable;
use crate::photo::LinearPhoto;

/// Parameters: c (2), θ₁, θ₂, s², m, g (2), a, h (2).
const N: usize = 11;
type Params = SVector<f64, N>;
type Normal = SMatrix<f64, N, N>;

/// The window reaches this part of the way to the nearest neighbouring corner, so that it stays inside the squares.
const WINDOW_FRACTION: f64 = 0.4;
/// Windows larger than this many samples are measured on means over blocks of pixels. Samples far from both edges hold no
/// information on the corner, and the cost stays the same at any resolution.
const MAX_RADIUS_SAMPLES: f64 = 12.0;
/// Windows below this radius hold too few samples for eleven parameters.
const MIN_RADIUS_SAMPLES: f64 = 2.5;
/// Where edges are sharp, the pixel is integrated over this many evenly spaced points per side.
const SUBSAMPLES: usize = 4;
/// Offset from the centre of the two Gauss points per side. They integrate cubics exactly, and an edge of the least blur
/// below to 5e-4 of its step, with either sign along it.
const GAUSS_OFFSET: f64 = 0.288_675_134_594_812_9;
const GAUSS_POINTS: usize = 4;
/// Least blur for the Gauss points, in samples.
const GAUSS_BLUR: f64 = 0.7;
/// Least variance of the blur with the Gauss points: that of half their distance.
const GAUSS_LEAST_VARIANCE: f64 = 0.07;
const POINTS: usize = SUBSAMPLES * SUBSAMPLES;
/// Additional variance of half the distance of subsamples: without it a sharp edge between two of them has no slope.
const SUBSAMPLE_VARIANCE: f64 = 0.25 / POINTS as f64;
/// The blur's variance may compensate nearly all of that, so that a perfectly sharp edge is an inner point of the fit.
const LEAST_VARIANCE: f64 = -0.9 * SUBSAMPLE_VARIANCE;
/// Beyond this many s plus half a pixel's diagonal an edge does not affect a sample: erf is then within 1e-5 of one.
const EDGE_REACH_SIGMAS: f64 = 4.5;
const HALF_DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Weakest contrast of a corner, linear light.
const MIN_AMPLITUDE: f64 = 1e-4;
/// Model error by perspective, shading and the pixel grid, in samples: the scatter of positions on rendered boards without
/// noise, against exact ground truth.
const MODEL_SIGMA_SAMPLES: f64 = 0.003;

/// Maximum number of steps; five are usual. The cost of sharp edges along the pixel grid is not smooth below a thousandth
/// of a pixel, so that more steps gain nothing.
const MAX_STEPS: usize = 30;
/// A step that moves the corner by less than this many samples ends the fit: a tenth of the model error.
const LAST_STEP: f64 = 3e-4;
/// The same for the first fit, from which the final fit converges in one step.
const LAST_STEP_OF_APPROACH: f64 = 1e-2;
const INITIAL_DAMPING: f64 = 1e-4;
/// A step reduces the blur's variance to this part at most. With almost no blur the cost is not smooth, and the fit would
/// not leave that region.
const MAX_SHARPENING: f64 = 0.25;

/// A refined corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Refined {
    pub(super) position: Point2<f64>,
    /// 1σ per coordinate, px.
    pub(super) sigma_px: f64,
}

/// Refines the corners of a photograph one after the other.
#[derive(Debug)]
pub(super) struct Refiner<'a> {
    photo: &'a LinearPhoto<'a>,
    erf: ErfTable,
    window: Window,
}

/// The samples around a corner, relative to `origin`, in units of blocks.
#[derive(Debug, Default)]
struct Window {
    origin: Point2<f64>,
    samples: Vec<(Vector2<f64>, f64)>,
    radius: f64,
}

struct Fit {
    params: Params,
    rms: f64,
    covariance: Matrix2<f64>,
}

impl<'a> Refiner<'a> {
    pub(super) fn new(photo: &'a LinearPhoto<'a>) -> Self {
        Self { photo, erf: ErfTable::new(), window: Window::default() }
    }

    /// Refines the corner near `start`; `steps` are the offsets to the neighbouring corners along the two grid
    /// directions, px. `None` when the window leaves the frame, the fit does not converge, or there is no corner.
    pub(super) fn refine(&mut self, start: Point2<f64>, steps: [Vector2<f64>; 2]) -> Option<Refined> {
        let reach_px = WINDOW_FRACTION * steps[0].norm().min(steps[1].norm());
        let block = ((reach_px / MAX_RADIUS_SAMPLES).ceil() as usize).max(1);
        let radius = reach_px / block as f64;
        if radius.is_nan() || radius < MIN_RADIUS_SAMPLES {
            return None;
        }
        self.window.cut(self.photo, start, block, radius)?;
        let mut p = Params::zeros();
        p[2] = steps[0].y.atan2(steps[0].x);
        p[3] = steps[1].y.atan2(steps[1].x);
        p[4] = 0.6;
        self.window.solve_light(&self.erf, &mut p);
        let near = self.window.fit(&self.erf, p, Rule::Gauss, LAST_STEP_OF_APPROACH)?.params;
        let rule = if near[4] >= GAUSS_BLUR * GAUSS_BLUR { Rule::Gauss } else { Rule::Even };
        let fit = self.window.fit(&self.erf, near, rule, LAST_STEP)?;
        let c = Vector2::new(fit.params[0], fit.params[1]);
        // A fit far from its start, or with coinciding edges, has converged to another feature.
        let crossing = (fit.params[2] - fit.params[3]).sin().abs();
        if c.norm() > 0.6 * radius || crossing < 0.2 || fit.params[8].abs() <= 3.0 * fit.rms + MIN_AMPLITUDE {
            return None;
        }
        let position = self.window.origin + c * block as f64;
        let variance = fit.covariance.trace() / 2.0 + MODEL_SIGMA_SAMPLES.powi(2);
        Some(Refined { position, sigma_px: variance.sqrt() * block as f64 })
    }
}

impl Window {
    fn cut(&mut self, photo: &LinearPhoto<'_>, start: Point2<f64>, block: usize, radius: f64) -> Option<()> {
        let half = radius.floor() as isize;
        let k = block as isize;
        // The middle block is centred as near to `start` as whole pixels allow.
        let centre_offset = (block as f64 - 1.0) / 2.0;
        let x0 = (start.x - centre_offset).round() as isize;
        let y0 = (start.y - centre_offset).round() as isize;
        let fits = |v: isize, size: usize| v - half * k >= 0 && v + half * k + k <= size as isize;
        if !(fits(x0, photo.width()) && fits(y0, photo.height())) {
            return None;
        }
        self.origin = Point2::new(x0 as f64 + centre_offset, y0 as f64 + centre_offset);
        self.radius = radius;
        self.samples.clear();
        for j in -half..=half {
            for i in -half..=half {
                let at = Vector2::new(i as f64, j as f64);
                if at.norm_squared() > radius * radius {
                    continue;
                }
                let (x, y) = ((x0 + i * k) as usize, (y0 + j * k) as usize);
                let row = |y: usize| (x..x + block).map(|x| photo.at(x, y)).sum::<f32>();
                let sum: f32 = (y..y + block).map(row).sum();
                self.samples.push((at, f64::from(sum) / (block * block) as f64));
            }
        }
        Some(())
    }

    /// Mean and amplitude by linear least squares for the given edges: this gives the sign of the corner.
    fn solve_light(&self, erf: &ErfTable, p: &mut Params) {
        let model = Model::new(erf, p, Rule::Gauss);
        let (mut n, mut e, mut ee, mut l, mut le) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &(at, light) in &self.samples {
            let edge = model.sample(at).1[8];
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

    /// The least squares of the window at some parameters.
    fn equations(&self, erf: &ErfTable, p: &Params, rule: Rule) -> Equations {
        let model = Model::new(erf, p, rule);
        let mut e = Equations { normal: Normal::zeros(), gradient: Params::zeros(), cost: 0.0 };
        for &(at, light) in &self.samples {
            let (value, derivative) = model.sample(at);
            let residual = value - light;
            e.cost += residual * residual;
            e.gradient.axpy(residual, &derivative, 1.0);
            // The factorisation reads the lower triangle only.
            for j in 0..N {
                let d = derivative[j];
                for i in j..N {
                    e.normal[(i, j)] += d * derivative[i];
                }
            }
        }
        e
    }

    fn fit(&self, erf: &ErfTable, start: Params, rule: Rule, last_step: f64) -> Option<Fit> {
        let freedom = self.samples.len() as f64 - N as f64;
        if freedom <= 0.0 {
            return None;
        }
        let mut params = start;
        let mut at = self.equations(erf, &params, rule);
        let mut damping = INITIAL_DAMPING;
        for _ in 0..MAX_STEPS {
            let step = at.step(damping)?;
            let mut next = params + step;
            let sharpest = MAX_SHARPENING * (params[4] + SUBSAMPLE_VARIANCE) - SUBSAMPLE_VARIANCE;
            next[4] = next[4].max(sharpest).max(rule.least_variance());
            // Rejected: a corner outside its window, or blurred beyond it.
            let inside = next.fixed_rows::<2>(0).norm() < self.radius && next[4] < self.radius.powi(2);
            let small = step.fixed_rows::<2>(0).norm() < last_step;
            let tried = inside.then(|| self.equations(erf, &next, rule)).filter(|e| e.cost < at.cost);
            if let Some(better) = tried {
                (params, at) = (next, better);
                damping *= 0.1;
            } else {
                damping *= 10.0;
            }
            if small && damping <= INITIAL_DAMPING || damping > 1e8 {
                break;
            }
        }
        let variance = at.cost / freedom;
        Some(Fit { params, rms: variance.sqrt(), covariance: at.position_covariance()? * variance })
    }
}

/// JᵀJ (lower triangle), Jᵀr and rᵀr. In units of samples the unknowns are of one order of magnitude, so that the normal
/// equations are well conditioned.
struct Equations {
    normal: Normal,
    gradient: Params,
    cost: f64,
}

impl Equations {
    fn step(&self, damping: f64) -> Option<Params> {
        let mut a = self.normal;
        for i in 0..N {
            a[(i, i)] += damping * a[(i, i)] + f64::MIN_POSITIVE;
        }
        let step = -a.cholesky()?.solve(&self.gradient);
        step.iter().all(|x| x.is_finite()).then_some(step)
    }

    /// The corner's part of (JᵀJ)⁻¹.
    fn position_covariance(&self) -> Option<Matrix2<f64>> {
        let factor = self.normal.cholesky()?;
        let unit = SMatrix::<f64, N, 2>::identity();
        let columns = factor.solve(&unit);
        columns.iter().all(|x| x.is_finite()).then(|| columns.fixed_view::<2, 2>(0, 0).into_owned())
    }
}

/// The quadrature points of a pixel, all of equal weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rule {
    Gauss,
    Even,
}

impl Rule {
    fn least_variance(self) -> f64 {
        match self {
            Self::Gauss => GAUSS_LEAST_VARIANCE,
            Self::Even => LEAST_VARIANCE,
        }
    }

    fn points(self) -> usize {
        match self {
            Self::Gauss => GAUSS_POINTS,
            Self::Even => POINTS,
        }
    }

    fn offset(self, k: usize) -> Vector2<f64> {
        let at = |k: usize| (k as f64 + 0.5) / SUBSAMPLES as f64 - 0.5;
        match self {
            Self::Gauss => {
                Vector2::new(k as f64 % 2.0 * 2.0 - 1.0, (k / 2) as f64 * 2.0 - 1.0) * GAUSS_OFFSET
            }
            Self::Even => Vector2::new(at(k % SUBSAMPLES), at(k / SUBSAMPLES)),
        }
    }
}

/// A point of a pixel, relative to its centre, and its distances from there across and along the two edges.
struct Subsample {
    offset: Vector2<f64>,
    across: [f64; 2],
    along: [f64; 2],
}

/// The light around a corner at some parameters.
struct Model<'a> {
    erf: &'a ErfTable,
    p: &'a Params,
    /// s.
    sigma: f64,
    /// 1/(√2·s).
    root: f64,
    along: [Vector2<f64>; 2],
    normals: [Vector2<f64>; 2],
    points: [Subsample; POINTS],
    rule: Rule,
}

/// Means over a pixel.
#[derive(Default)]
struct Means {
    /// E₁E₂ and E₁E₂·(offset from the pixel's centre).
    edge: f64,
    edge_offset: Vector2<f64>,
    /// E₁′E₂ and E₁E₂′.
    slopes: [f64; 2],
    /// The same times the distance along the edge from the pixel's centre.
    turns: [f64; 2],
    /// d₁E₁′E₂ + d₂E₁E₂′.
    blur: f64,
}

impl<'a> Model<'a> {
    fn new(erf: &'a ErfTable, p: &'a Params, rule: Rule) -> Self {
        let sigma = (p[4] + SUBSAMPLE_VARIANCE).sqrt();
        let along = [2, 3].map(|i| Vector2::new(p[i].cos(), p[i].sin()));
        let normals = along.map(|t| Vector2::new(-t.y, t.x));
        let points = std::array::from_fn(|k| {
            let offset = rule.offset(k);
            let of = |v: [Vector2<f64>; 2]| v.map(|v| v.dot(&offset));
            Subsample { offset, across: of(normals), along: of(along) }
        });
        Self { erf, p, sigma, root: 1.0 / (std::f64::consts::SQRT_2 * sigma), along, normals, points, rule }
    }

    /// The light of the sample centred at `at`, and its derivatives by the parameters. The amplitude is taken
    /// at the sample's centre in the derivatives, which changes them by less than a pixel's share of its slope.
    fn sample(&self, at: Vector2<f64>) -> (f64, Params) {
        let p = self.p;
        let q = at - Vector2::new(p[0], p[1]);
        let distances = self.normals.map(|n| n.dot(&q));
        let means = self.means(distances);
        let (g, h) = (Vector2::new(p[6], p[7]), Vector2::new(p[9], p[10]));
        let amplitude = p[8] + h.dot(&q);
        let value = p[5] + g.dot(&q) + amplitude * means.edge + h.dot(&means.edge_offset);
        let [s1, s2] = means.slopes;
        let dc = -(self.normals[0] * s1 + self.normals[1] * s2) * amplitude - g - h * means.edge;
        let derivative = Params::from_column_slice(&[
            dc.x,
            dc.y,
            -amplitude * (s1 * self.along[0].dot(&q) + means.turns[0]),
            -amplitude * (s2 * self.along[1].dot(&q) + means.turns[1]),
            -amplitude * means.blur / (2.0 * self.sigma * self.sigma),
            1.0,
            q.x,
            q.y,
            means.edge,
            means.edge * q.x + means.edge_offset.x,
            means.edge * q.y + means.edge_offset.y,
        ]);
        (value, derivative)
    }

    fn means(&self, distances: [f64; 2]) -> Means {
        let reach = EDGE_REACH_SIGMAS * self.sigma + HALF_DIAGONAL;
        let near = distances.map(|d| d.abs() < reach);
        let mut sum = Means::default();
        if near == [false, false] {
            sum.edge = distances[0].signum() * distances[1].signum();
            return sum;
        }
        let count = self.rule.points();
        for point in &self.points[..count] {
            let edge = |k: usize| {
                let d = distances[k] + point.across[k];
                if near[k] {
                    let (e, slope) = self.erf.at(d * self.root);
                    (d, e, slope * self.root)
                } else {
                    (d, distances[k].signum(), 0.0)
                }
            };
            let ((d1, e1, s1), (d2, e2, s2)) = (edge(0), edge(1));
            let e = e1 * e2;
            sum.edge += e;
            sum.edge_offset += point.offset * e;
            let slopes = [s1 * e2, s2 * e1];
            for (k, slope) in slopes.into_iter().enumerate() {
                sum.slopes[k] += slope;
                sum.turns[k] += slope * point.along[k];
            }
            sum.blur += d1 * slopes[0] + d2 * slopes[1];
        }
        let scale = 1.0 / count as f64;
        sum.edge *= scale;
        sum.edge_offset *= scale;
        sum.slopes = sum.slopes.map(|s| s * scale);
        sum.turns = sum.turns.map(|s| s * scale);
        sum.blur *= scale;
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::{Encoding, Layout, PhotoView, Samples};

    struct Image(usize, Vec<u16>);

    impl Image {
        fn new(size: usize, light: impl Fn(usize, usize) -> f64) -> Self {
            let code = |i: usize| (light(i % size, i / size) * 65535.0).round() as u16;
            Self(size, (0..size * size).map(code).collect())
        }

        /// A corner of two edges, drawn by 16×16 supersampling of the ideal one and a blur by the pixel alone.
        fn drawn(c: Point2<f64>, angles: [f64; 2], size: usize) -> Self {
            let [n1, n2] = angles.map(|a| Vector2::new(-a.sin(), a.cos()));
            Self::new(size, |x, y| {
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
                sum / 256.0
            })
        }

        fn refine(&self, start: Point2<f64>, steps: [Vector2<f64>; 2]) -> Option<Refined> {
            let view = PhotoView::new(Samples::U16(&self.1), self.0, self.0, self.0, Layout::Grey).unwrap();
            Refiner::new(&LinearPhoto::new(view, Encoding::Linear)).refine(start, steps)
        }
    }

    #[test]
    fn finds_sharp_corners_at_any_phase_angle_and_scale() {
        for (size, square) in [(41_usize, 14.0), (161, 60.0)] {
            for k in 0..12 {
                let phase = f64::from(k) * 0.083;
                let mid = size as f64 / 2.0;
                let c = Point2::new(mid + phase, mid - 0.7 * phase);
                let angles = [0.02 + f64::from(k) * 0.05, 1.45];
                let image = Image::drawn(c, angles, size);
                let steps = angles.map(|a| Vector2::new(a.cos(), a.sin()) * square);
                let found = image.refine(c + Vector2::new(0.3, -0.25), steps).unwrap();
                let error = (found.position - c).norm();
                assert!(error < 0.02 * square / 14.0, "{size} {k}: {error}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let erf = ErfTable::new();
        let p = Params::from_column_slice(&[0.2, -0.3, 0.3, 1.7, 0.4, 0.4, 0.01, -0.02, 0.3, 0.004, 0.006]);
        for at in [(0.0, 1.0), (2.0, -1.0), (-3.0, 0.0), (5.0, 6.0)] {
            let at = Vector2::new(at.0, at.1);
            let (_, derivative) = Model::new(&erf, &p, Rule::Even).sample(at);
            for i in 0..N {
                let light = |h: f64| {
                    let mut p = p;
                    p[i] += h;
                    Model::new(&erf, &p, Rule::Even).sample(at).0
                };
                let slope = (light(1e-4) - light(-1e-4)) / 2e-4;
                assert!((slope - derivative[i]).abs() < 4e-3 * (1.0 + slope.abs()), "{at} {i}: {slope}");
            }
        }
    }

    #[test]
    fn flat_areas_edges_and_windows_outside_the_frame_are_rejected() {
        let steps = [Vector2::new(20.0, 0.0), Vector2::new(0.0, 20.0)];
        let flat = Image::new(60, |_, _| 0.5);
        assert!(flat.refine(Point2::new(30.0, 30.0), steps).is_none());
        let edge = Image::new(60, |x, _| if x < 30 { 0.1 } else { 0.9 });
        assert!(edge.refine(Point2::new(30.0, 30.0), steps).is_none());
        assert!(flat.refine(Point2::new(2.0, 30.0), steps).is_none());
        assert!(flat.refine(Point2::new(f64::NAN, 30.0), steps).is_none());
    }
}
