//! How red and blue are displaced against green at the corners of the projected checkerboard.
//!
//! A photograph of a white checkerboard has little fine structure of colour: demosaicing, sharpening and above all the halved
//! resolution of colour in JPEG have removed it, and a corner fitted in each channel alone finds a fraction of its
//! displacement. What is left are low frequencies. All channels are therefore blurred by the same Gaussian, a tenth of a square wide.
//! With small displacements d a channel then is, to first order of the Taylor series (the equation of optical flow),
//!
//! ```text
//! C(p) = a G(p − d) + … = c₀ + c·p + (a + g·p) G − a d·∇G + b ΔG
//! ```
//!
//! where c₀, c and g model ambient light and shading, and b a difference in blur. This is linear in everything but the product a d, so that one
//! linear regression over the square around a corner gives d. Edges of both directions and of both signs meet there, so that
//! clipping and tone curves, which move edges towards the dark side, cancel. Code values do as well as linear light.

use nalgebra::{Point2, SMatrix, SVector, Vector2};

use super::board::Board;
use crate::channel_registration::RedBlue;
use crate::observations::{ChannelOffset, CornerPair};
use crate::photo::PhotoView;

/// The blur in squares: narrower, and what compression did to the colour is seen; wider, and neighbouring corners mix.
const BLUR_SQUARES: f64 = 0.1;
/// Small squares are blurred by this many pixels at least: demosaicing, sharpening and compression reach as far at any resolution.
const MIN_BLUR_PX: f64 = 4.0;
/// But by no more than this part of a square, which would leave nothing of it.
const MAX_BLUR_SQUARES: f64 = 0.2;
/// Half the window in squares: it ends in the middle of the four squares around its corner.
const HALF_WINDOW_SQUARES: f64 = 0.5;
/// Weights fall off as a Gaussian of this part of half the window.
const WEIGHT_SIGMA: f64 = 0.6;
/// The photograph is reduced to blocks of which at least this many make a square: the blur leaves no finer structure.
const BLOCKS_PER_SQUARE: f64 = 16.0;
/// Squares smaller than this many pixels have no low frequencies that survive the compression of colour.
const MIN_SQUARE_PX: f64 = 12.0;
/// Kernels are cut off at this many σ.
const KERNEL_SIGMAS: f64 = 3.0;
/// A channel whose contrast is below this part of green's holds nothing.
const MIN_GAIN: f64 = 0.05;
/// Regressors: 1, p (2), G, G p (2), ΔG, ∇G (2).
const N: usize = 9;
/// Samples beside the window that derivatives need.
const MARGIN: usize = 2;

/// The offsets at the corners of a board; none where the photograph has no colour. Their `projector` pixels are those of the board.
pub(super) fn channel_offsets(photo: &PhotoView<'_>, board: &Board, square_px: f64) -> Vec<ChannelOffset> {
    let mut corners = Vec::with_capacity(board.pairs.len());
    for pair in &board.pairs {
        // The smaller side of the square in the photograph.
        let steps = board.undistorted_from_projector.jacobian(pair.projector) * square_px;
        corners.push((pair, steps.column(0).norm().min(steps.column(1).norm())));
    }
    let mut squares: Vec<f64> = corners.iter().map(|(_, square)| *square).collect();
    squares.sort_by(f64::total_cmp);
    let square = squares.get(squares.len() / 2).copied().unwrap_or(0.0);
    if !photo.layout().has_color() || square.is_nan() || square < MIN_SQUARE_PX {
        return Vec::new();
    }
    let Some(channels) = Channels::around(photo, corners.iter().map(|(pair, _)| pair.camera), square) else {
        return Vec::new();
    };
    let offset = |(pair, square): (&CornerPair, f64)| {
        let (offset_px, sigma_px) = channels.offsets(pair.camera, square)?;
        let offset = ChannelOffset { camera: pair.camera, projector: pair.projector, offset_px, sigma_px };
        offset.is_valid().then_some(offset)
    };
    corners.into_iter().filter_map(offset).collect()
}

/// Red, green and blue around the board: means over blocks of pixels, blurred.
struct Channels {
    /// The pixel at the middle of the first block.
    origin: Point2<f64>,
    /// Side of a block, px.
    block: usize,
    width: usize,
    height: usize,
    planes: [Vec<f32>; 3],
    /// σ of the blur, blocks.
    blur: f64,
}

impl Channels {
    /// `None` where all channels are the same, as in a grey photograph that is stored in colour.
    fn around(
        photo: &PhotoView<'_>,
        corners: impl Iterator<Item = Point2<f64>>,
        square: f64,
    ) -> Option<Self> {
        let block = ((square / BLOCKS_PER_SQUARE) as usize).max(1);
        // All that the blur at the outermost corners' windows reaches, within the photograph.
        let reach = 2.0 * HALF_WINDOW_SQUARES * square + KERNEL_SIGMAS * blur_px(square);
        let (mut low, mut high) = (Point2::new(f64::MAX, f64::MAX), Point2::new(f64::MIN, f64::MIN));
        for c in corners {
            low = low.inf(&c);
            high = high.sup(&c);
        }
        let end = |v: f64, size: usize| ((v + reach).clamp(0.0, size as f64)) as usize;
        let [x0, y0] = [low.x, low.y].map(|v| (v - reach).max(0.0) as usize);
        let width = end(high.x, photo.width()).checked_sub(x0)? / block;
        let height = end(high.y, photo.height()).checked_sub(y0)? / block;
        if width <= 2 * MARGIN || height <= 2 * MARGIN {
            return None;
        }
        let mut planes = [0; 3].map(|_| vec![0.0_f32; width * height]);
        let mut sums = vec![[0_u32; 3]; width];
        let mut colored = false;
        for (j, row) in (0..height).map(|j| (j, j * width..(j + 1) * width)) {
            sums.fill([0; 3]);
            for y in (y0 + j * block..).take(block) {
                for (i, sum) in sums.iter_mut().enumerate() {
                    for x in (x0 + i * block..).take(block) {
                        let code = photo.rgb_codes(x, y);
                        for (s, c) in sum.iter_mut().zip(code) {
                            *s += u32::from(c);
                        }
                    }
                }
            }
            colored |= sums.iter().any(|[r, g, b]| r != g || b != g);
            for (channel, plane) in planes.iter_mut().enumerate() {
                for (out, sum) in plane[row.clone()].iter_mut().zip(&sums) {
                    *out = sum[channel] as f32;
                }
            }
        }
        if !colored {
            return None;
        }
        // The mean over a block has already blurred by the variance of its pixels.
        let side = block as f64;
        let blur = ((blur_px(square) / side).powi(2) - (1.0 - side.powi(-2)) / 12.0).max(0.0).sqrt();
        let kernel = gaussian(blur);
        let mut scratch = vec![0.0; width * height];
        for plane in &mut planes {
            blur_rows(plane, width, &kernel, &mut scratch);
            blur_columns(&scratch, width, &kernel, plane);
        }
        let middle = (side - 1.0) / 2.0;
        let origin = Point2::new(x0 as f64 + middle, y0 as f64 + middle);
        Some(Self { origin, block, width, height, planes, blur })
    }

    /// The displacement of red and blue from green at a corner with squares of this size, px, and its σ. `None` where the window
    /// leaves the photograph, or a channel does not show the corner.
    fn offsets(&self, corner: Point2<f64>, square: f64) -> Option<(RedBlue<Vector2<f64>>, RedBlue<f64>)> {
        let side = self.block as f64;
        let at = (corner - self.origin) / side;
        let half = (HALF_WINDOW_SQUARES * square / side) as usize;
        let first = |v: f64, size: usize| {
            let first = (v.round() as isize).checked_sub_unsigned(half + MARGIN)?;
            let first = usize::try_from(first).ok()?;
            (first + 2 * (half + MARGIN) < size).then_some(first + MARGIN)
        };
        let (x0, y0) = (first(at.x, self.width)?, first(at.y, self.height)?);
        let [red, green, blue] = &self.planes;
        let w = self.width;
        // Central differences of fourth order: those of second order lose some per cent of a slope this steep.
        let slope = |k: usize, step: usize| {
            f64::from(8.0 * (green[k + step] - green[k - step]) - (green[k + 2 * step] - green[k - 2 * step]))
                / 12.0
        };
        let scale = 1.0 / half.max(1) as f64;
        let mut normal = SMatrix::<f64, N, N>::zeros();
        let mut sides = SMatrix::<f64, N, 2>::zeros();
        let (mut squares, mut weights) = ([0.0; 2], 0.0);
        for j in 0..=2 * half {
            for i in 0..=2 * half {
                let k = (y0 + j) * w + x0 + i;
                let (x, y) = ((i as f64 - half as f64) * scale, (j as f64 - half as f64) * scale);
                let weight = (-(x * x + y * y) / (2.0 * WEIGHT_SIGMA * WEIGHT_SIGMA)).exp();
                let g = f64::from(green[k]);
                let around = f64::from(green[k - 1] + green[k + 1] + green[k - w] + green[k + w]);
                let terms = SVector::<f64, N>::from([
                    1.0,
                    x,
                    y,
                    g,
                    g * x,
                    g * y,
                    around - 4.0 * g,
                    slope(k, 1),
                    slope(k, w),
                ]);
                let seen = [f64::from(red[k]), f64::from(blue[k])];
                for column in 0..N {
                    let t = weight * terms[column];
                    for row in column..N {
                        normal[(row, column)] += t * terms[row];
                    }
                    sides[(column, 0)] += t * seen[0];
                    sides[(column, 1)] += t * seen[1];
                }
                squares[0] += weight * seen[0] * seen[0];
                squares[1] += weight * seen[1] * seen[1];
                weights += weight;
            }
        }
        let factor = normal.cholesky()?;
        let solved = factor.solve(&sides);
        let unit = SMatrix::<f64, N, 2>::from_fn(|i, j| if i == j + N - 2 { 1.0 } else { 0.0 });
        let variance = factor.solve(&unit).fixed_view::<2, 2>(N - 2, 0).trace() / 2.0;
        // Blurred noise is the same over an area of 4π σ².
        let correlated = (4.0 * std::f64::consts::PI * self.blur * self.blur).max(1.0);
        let of = |channel: usize| {
            let q = solved.column(channel);
            let gain = q[3];
            let offset = Vector2::new(q[N - 2], q[N - 1]) * (-side / gain);
            let misfit = (squares[channel] - q.dot(&sides.column(channel))).max(0.0) / weights;
            let sigma = side / gain * (misfit * correlated * variance).sqrt();
            // A longer displacement is beyond the first order.
            let small = offset.norm() < self.blur * side;
            (gain > MIN_GAIN && small && sigma > 0.0).then_some((offset, sigma))
        };
        let ((red, of_red), (blue, of_blue)) = (of(0)?, of(1)?);
        Some((RedBlue { red, blue }, RedBlue { red: of_red, blue: of_blue }))
    }
}

/// σ of the blur for squares of this size, px.
fn blur_px(square: f64) -> f64 {
    (BLUR_SQUARES * square).max(MIN_BLUR_PX.min(MAX_BLUR_SQUARES * square))
}

/// Half of a Gaussian kernel, from its middle on; all of it has the sum 1.
fn gaussian(sigma: f64) -> Vec<f32> {
    let reach = (KERNEL_SIGMAS * sigma).ceil() as usize;
    let at = |i: usize| if i == 0 { 1.0 } else { (-((i * i) as f64) / (2.0 * sigma * sigma)).exp() };
    let sum: f64 = (0..=reach).map(|i| if i == 0 { 1.0 } else { 2.0 * at(i) }).sum();
    (0..=reach).map(|i| (at(i) / sum) as f32).collect()
}

/// Blurs along rows; beyond its ends a row goes on with its last value.
fn blur_rows(from: &[f32], width: usize, kernel: &[f32], to: &mut [f32]) {
    for (row, out) in from.chunks_exact(width).zip(to.chunks_exact_mut(width)) {
        for (x, o) in out.iter_mut().enumerate() {
            *o = kernel[0] * row[x];
            for (i, k) in kernel.iter().enumerate().skip(1) {
                *o += k * (row[x.saturating_sub(i)] + row[(x + i).min(width - 1)]);
            }
        }
    }
}

/// The same along columns.
fn blur_columns(from: &[f32], width: usize, kernel: &[f32], to: &mut [f32]) {
    let height = from.len() / width;
    let row = |y: usize| &from[y * width..(y + 1) * width];
    for (y, out) in to.chunks_exact_mut(width).enumerate() {
        out.iter_mut().zip(row(y)).for_each(|(o, v)| *o = kernel[0] * v);
        for (i, k) in kernel.iter().enumerate().skip(1) {
            let (above, below) = (row(y.saturating_sub(i)), row((y + i).min(height - 1)));
            out.iter_mut().zip(above.iter().zip(below)).for_each(|(o, (a, b))| *o += k * (a + b));
        }
    }
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, RgbImage};

    use super::*;
    use crate::detect::tests::{Drawn, pattern};
    use crate::detect::{DetectConfig, observe};
    use crate::geometry::{Homography, RectangleSize};

    /// A drawn sheet whose red light is shifted on the panel by `red`, blue by `blue`.
    fn offsets(width: u32, red: Vector2<f64>, blue: Vector2<f64>) -> (Drawn, Vec<ChannelOffset>) {
        let drawn = Drawn::tilted(width);
        let channel = |by: Vector2<f64>| {
            let moved = drawn.camera_from_projector.map(|h| h.compose(&shift(by)));
            Drawn { camera_from_projector: moved, ..Drawn::tilted(width) }.draw().into_luma8()
        };
        let channels = [channel(red), channel(Vector2::zeros()), channel(blue)];
        let [w, h] = drawn.size;
        let image =
            RgbImage::from_fn(w, h, |x, y| image::Rgb([0, 1, 2].map(|c| channels[c].get_pixel(x, y).0[0])));
        let image = DynamicImage::ImageRgb8(image);
        let size = RectangleSize::new(594.0, 420.0).unwrap();
        let view = PhotoView::try_from(&image).unwrap();
        let found = observe(view, None, size, Some(&pattern()), &DetectConfig::default()).unwrap();
        (drawn, found.observation.channel_offsets)
    }

    fn shift(by: Vector2<f64>) -> Homography {
        Homography(nalgebra::Matrix3::new_translation(&by))
    }

    #[test]
    fn known_displacements_are_found_at_any_size() {
        let (red, blue) = (Vector2::new(0.6, -0.3), Vector2::new(-0.4, 0.5));
        for width in [640, 1280, 2600] {
            let (drawn, found) = offsets(width, red, blue);
            assert!(found.len() >= 60, "{}", found.len());
            let h = drawn.camera_from_projector.unwrap();
            let at = |q: Point2<f64>| h.map(q).unwrap();
            let (mut mean, mut rms) = ([Vector2::zeros(); 2], [0.0; 2]);
            for o in &found {
                let expected = [red, blue].map(|by| at(o.projector + by) - at(o.projector));
                let errors = [o.offset_px.red - expected[0], o.offset_px.blue - expected[1]];
                mean.iter_mut().zip(errors).for_each(|(m, e)| *m += e / found.len() as f64);
                rms.iter_mut().zip(errors).for_each(|(r, e)| *r += e.norm_squared() / found.len() as f64);
            }
            // The code values of edges without any blur depend on where the pixels lie.
            assert!(mean.iter().all(|m| m.norm() < 0.02), "{width}: {mean:?}");
            assert!(rms.iter().all(|r| r.sqrt() < 0.1), "{width}: {rms:?}");
        }
    }

    #[test]
    fn a_grey_photograph_stored_in_colour_has_none() {
        assert!(offsets(640, Vector2::zeros(), Vector2::zeros()).1.is_empty());
    }
}
