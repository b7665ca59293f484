//! Edge pixels of a downsampled photograph, with their directions.

use nalgebra::{Point2, Vector2};

use super::downsampled::Downsampled;
use super::rough_undistort::RoughLens;
use crate::photo::GreyImage;

/// Edges weaker than this many times the median gradient are ignored: three standard deviations of noise.
const NOISE_MULTIPLE: f32 = 2.5;
/// At most this share of all pixels are edge pixels; in a textured photograph the threshold rises until this holds.
const MAX_EDGE_SHARE: f64 = 0.12;

/// An undistorted pixel on an edge, in pixels of the downsampled image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edgel {
    pub(super) position: Point2<f64>,
    /// Unit vector from dark to bright.
    pub(super) normal: Vector2<f64>,
    pub(super) strength: f32,
}

/// The edges of a photograph, with lens distortion.
#[derive(Debug, Clone)]
pub(super) struct DistortedEdges {
    edgels: Vec<Edgel>,
    factor: usize,
    tone: GreyImage,
}

/// The edges of a photograph after undistortion.
#[derive(Debug, Clone)]
pub(super) struct EdgeMap<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Side of a downsampled pixel in pixels of the photograph.
    pub(super) factor: usize,
    pub(super) edgels: Vec<Edgel>,
    /// The downsampled image as square roots of light: noise is then even, and dark edges count.
    pub(super) tone: &'a GreyImage,
}

impl DistortedEdges {
    pub(super) fn new(downsampled: &Downsampled) -> Self {
        let image = &downsampled.image;
        let root = |x: usize, y: usize| image.at(x, y).max(0.0).sqrt();
        let tone = smoothed(&GreyImage::from_fn(image.width(), image.height(), root));
        Self { edgels: find_edgels(&tone), factor: downsampled.factor, tone }
    }

    pub(super) fn through(&self, lens: &RoughLens) -> EdgeMap<'_> {
        let tone = &self.tone;
        let (width, height) = (tone.width(), tone.height());
        let mut map = EdgeMap { width, height, factor: self.factor, edgels: Vec::new(), tone };
        map.edgels = self.edgels.iter().map(|e| map.undistorted(e, lens)).collect();
        map
    }
}

impl EdgeMap<'_> {
    fn undistorted(&self, e: &Edgel, lens: &RoughLens) -> Edgel {
        let straight = |p: Point2<f64>| self.to_working(lens.undistort(self.to_photo(p)));
        let position = straight(e.position);
        let along = straight(e.position + Vector2::new(-e.normal.y, e.normal.x)) - position;
        let normal = Vector2::new(along.y, -along.x).normalize();
        Edgel { position, normal, ..*e }
    }

    /// From downsampled pixels to pixels of the photograph.
    pub(super) fn to_photo(&self, p: Point2<f64>) -> Point2<f64> {
        let f = self.factor as f64;
        p * f + Vector2::repeat((f - 1.0) / 2.0)
    }

    /// From pixels of the photograph to downsampled pixels.
    pub(super) fn to_working(&self, p: Point2<f64>) -> Point2<f64> {
        let f = self.factor as f64;
        (p - Vector2::repeat((f - 1.0) / 2.0)) / f
    }

    /// The diagonal, in downsampled pixels: the unit of lengths in a photograph.
    pub(super) fn diagonal(&self) -> f64 {
        (self.width as f64).hypot(self.height as f64)
    }
}

/// Two binomial 3×3 filters: σ = 1 px, which removes pixel noise and keeps neighbouring edges separate.
fn smoothed(image: &GreyImage) -> GreyImage {
    let pass = |image: &GreyImage| {
        let (w, h) = (image.width(), image.height());
        let rows = GreyImage::from_fn(w, h, |x, y| {
            let r = image.row(y);
            0.25 * (r[x.saturating_sub(1)] + r[(x + 1).min(w - 1)]) + 0.5 * r[x]
        });
        GreyImage::from_fn(w, h, |x, y| {
            0.25 * (rows.at(x, y.saturating_sub(1)) + rows.at(x, (y + 1).min(h - 1))) + 0.5 * rows.at(x, y)
        })
    };
    pass(&pass(image))
}

fn find_edgels(tone: &GreyImage) -> Vec<Edgel> {
    let (w, h) = (tone.width(), tone.height());
    if w < 8 || h < 8 {
        return Vec::new();
    }
    let gradient = |x: usize, y: usize| {
        Vector2::new(tone.at(x + 1, y) - tone.at(x - 1, y), tone.at(x, y + 1) - tone.at(x, y - 1)) * 0.5
    };
    let magnitude = GreyImage::from_fn(w, h, |x, y| {
        let inside = x > 0 && y > 0 && x + 1 < w && y + 1 < h;
        if inside { gradient(x, y).norm() } else { 0.0 }
    });
    let floor = threshold(&magnitude);
    let mut edgels = Vec::new();
    for y in 2..h - 2 {
        for x in 2..w - 2 {
            let m = magnitude.at(x, y);
            if m <= floor {
                continue;
            }
            let n = gradient(x, y) / m;
            // Non-maximum suppression along the gradient, with a parabola for the sub-pixel position.
            let (nx, ny) = (f64::from(n.x), f64::from(n.y));
            let beside =
                |s: f64| magnitude.bilinear(x as f64 + s * nx, y as f64 + s * ny).unwrap_or(0.0) as f32;
            let (before, after) = (beside(-1.0), beside(1.0));
            if m < before || m <= after {
                continue;
            }
            let bend = before - 2.0 * m + after;
            let shift =
                if bend < 0.0 { f64::from(0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
            edgels.push(Edgel {
                position: Point2::new(x as f64 + shift * nx, y as f64 + shift * ny),
                normal: Vector2::new(nx, ny),
                strength: m,
            });
        }
    }
    edgels
}

/// The gradient above which a pixel counts as an edge: a multiple of the noise, higher in textured photographs.
fn threshold(magnitude: &GreyImage) -> f32 {
    let noise = super::checkerboard::quantile(magnitude.data(), 0.5);
    let busy = super::checkerboard::quantile(magnitude.data(), 1.0 - MAX_EDGE_SHARE);
    // Rendered or denoised pictures have no noise. The minimum is then a step of a thousandth of the tone range.
    (NOISE_MULTIPLE * noise).max(busy).max(1e-3)
}
