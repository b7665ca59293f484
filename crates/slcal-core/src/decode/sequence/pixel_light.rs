//! Whether the projector lights a pixel, and what the noise of its levels lets be told apart.

use super::frame_noise::NoiseOfSums;
use super::pixel_code::{UNLIT, least_contrast};
use super::planes::{AxisPlanes, Planes};

/// A pixel is lit when white less black is more than this many times the noise of a level: five times its own.
const LIT: f32 = 5.0 * std::f32::consts::SQRT_2;

/// The noise of pixels by their light.
#[derive(Debug)]
pub(super) struct PixelLight {
    pub(super) noise: NoiseOfSums,
    /// 1σ of a level where white or black are not shown.
    pub(super) unshown: f32,
    /// Whether bits have inverses.
    pub(super) paired: bool,
}

impl PixelLight {
    /// White less black of a pixel, where both are shown.
    #[inline]
    pub(super) fn lit(planes: &Planes, pixel: usize) -> Option<f32> {
        let white = planes.white.get(pixel)?;
        Some(f32::from(*white) - f32::from(*planes.black.get(pixel)?))
    }

    /// 1σ of a pixel's levels.
    #[inline]
    pub(super) fn sigma(&self, planes: &Planes, pixel: usize) -> f32 {
        match (planes.white.get(pixel), planes.black.get(pixel)) {
            (Some(w), Some(b)) => self.noise.at(w + b),
            (Some(w), None) => self.noise.at(*w),
            _ => self.unshown,
        }
    }

    /// 1σ of a bit's contrast at a pixel.
    #[inline]
    pub(super) fn contrast_sigma(&self, planes: &Planes, pixel: usize) -> f32 {
        self.of_noise() * self.sigma(planes, pixel)
    }

    /// The noise of a contrast over that of a level: a bit less its inverse; or twice a bit less white and black.
    #[inline]
    fn of_noise(&self) -> f32 {
        if self.paired { std::f32::consts::SQRT_2 } else { 2.449_489_7 }
    }

    /// Whether the projector lights a pixel, as far as this axis shows it.
    #[inline]
    pub(super) fn is_lit(&self, planes: &Planes, axis: &AxisPlanes, pixel: usize) -> bool {
        let least = LIT * self.sigma(planes, pixel);
        match Self::lit(planes, pixel) {
            Some(lit) => lit > least,
            None if axis.word.is_empty() => true,
            // The second least contrast of all: one bit may be undecided.
            None => f32::from(axis.second[pixel]) > least,
        }
    }

    /// How small a contrast of this axis may be to be certain.
    #[inline]
    pub(super) fn least_contrast(&self, planes: &Planes, pixel: usize) -> i16 {
        least_contrast(self.contrast_sigma(planes, pixel), Self::lit(planes, pixel))
    }

    /// The [least contrasts](Self::least_contrast) of all pixels; [`UNLIT`] for those that the projector does not light.
    pub(super) fn least_contrasts(&self, planes: &Planes, axis: &AxisPlanes, out: &mut Vec<i16>) {
        out.clear();
        if planes.white.is_empty() || planes.black.is_empty() {
            out.extend((0..axis.word.len()).map(|pixel| {
                let is_lit = self.is_lit(planes, axis, pixel);
                if is_lit { self.least_contrast(planes, pixel) } else { UNLIT }
            }));
            return;
        }
        let of_noise = self.of_noise();
        out.extend(planes.white.iter().zip(&planes.black).map(|(white, black)| {
            let sigma = self.noise.at(white + black);
            let lit = f32::from(*white as i16 - *black as i16);
            let least = least_contrast(of_noise * sigma, Some(lit));
            if lit > LIT * sigma { least } else { UNLIT }
        }));
    }
}
