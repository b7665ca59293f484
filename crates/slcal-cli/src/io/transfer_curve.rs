//! From samples to light by what a file says, and on to the sRGB samples that everything else takes.

use image::{DynamicImage, ImageBuffer};
use slcal_core::photo::Encoding;

/// Exponents beyond these are mistakes of whoever wrote the file; they are those that may be typed.
const EXPONENTS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// Curves that differ by less than this share of full light are one: 2.2, as in Adobe RGB, and sRGB differ by 0.8 %.
const SAME_LIGHT: f64 = 0.01;

/// Light (0 to 1) as a function of the sample (0 to 1).
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Curve {
    Srgb,
    Linear,
    Power(f64),
    /// ITU-R BT.709, as cameras apply it.
    Bt709,
    /// (aX + b)^g + e from d on, cX + f below.
    Parametric {
        g: f64,
        a: f64,
        b: f64,
        c: f64,
        d: f64,
        e: f64,
        f: f64,
    },
    /// Values of 16 bit at equal steps.
    Table(Vec<u16>),
}

impl Curve {
    /// An exponent that makes sense.
    pub(super) fn power(exponent: f64) -> Option<Self> {
        EXPONENTS.contains(&exponent).then_some(Self::Power(exponent))
    }

    pub(super) fn light(&self, value: f64) -> f64 {
        match *self {
            Self::Srgb => Encoding::Srgb.to_linear(value),
            Self::Linear => value,
            Self::Power(exponent) => value.powf(exponent),
            Self::Bt709 if value < 0.081 => value / 4.5,
            Self::Bt709 => ((value + 0.099) / 1.099).powf(1.0 / 0.45),
            Self::Parametric { c, d, f, .. } if value < d => c * value + f,
            Self::Parametric { g, a, b, e, .. } => (a * value + b).max(0.0).powf(g) + e,
            Self::Table(ref values) => {
                let at = value.clamp(0.0, 1.0) * (values.len() - 1) as f64;
                let (low, share) = (at.floor(), at.fract());
                let value = |i: usize| f64::from(values[i.min(values.len() - 1)]);
                (value(low as usize) * (1.0 - share) + value(low as usize + 1) * share) / 65535.0
            }
        }
    }

    /// Whether black stays darker than white, and nothing is undefined.
    pub(super) fn is_sound(&self) -> bool {
        let light = |i: i32| self.light(f64::from(i) / 255.0);
        (0..=255).all(|i| light(i).is_finite()) && light(255) - light(0) > 0.1
    }

    /// Whether samples may be taken for those of sRGB.
    pub(super) fn is_srgb(&self) -> bool {
        (0..=255)
            .map(|i| f64::from(i) / 255.0)
            .all(|v| (self.light(v) - Curve::Srgb.light(v)).abs() < SAME_LIGHT)
    }

    /// In words, behind "samples are".
    pub(super) fn named(&self) -> String {
        match self {
            Self::Srgb => "sRGB".to_owned(),
            Self::Linear => "linear in the light".to_owned(),
            Self::Power(exponent) if (exponent - 1.0).abs() < 0.005 => Self::Linear.named(),
            Self::Power(exponent) => {
                format!("light to the power of 1/{}", (exponent * 100.0).round() / 100.0)
            }
            Self::Bt709 => "coded by BT.709".to_owned(),
            Self::Parametric { .. } | Self::Table(_) => "coded by a curve of its own".to_owned(),
        }
    }
}

/// The samples as sRGB has them, 16 bit, so that nothing is lost of 8-bit ones. `curves` are one for all channels or one for
/// each; video has its black at 16 of 255 and its white at 235 (`narrow`). Alpha stays; so do floating-point pictures.
pub(super) fn to_srgb(photo: DynamicImage, curves: &[Curve], narrow: bool) -> DynamicImage {
    let (width, height, color) = (photo.width(), photo.height(), photo.color());
    let channels = usize::from(color.channel_count());
    let tables = |bits: u32| -> Vec<Vec<u16>> { curves.iter().map(|c| table(c, bits, narrow)).collect() };
    let colors = channels - usize::from(color.has_alpha());
    let samples = match photo {
        DynamicImage::ImageLuma16(i) => deep(i.into_raw(), channels, colors, &tables(16)),
        DynamicImage::ImageLumaA16(i) => deep(i.into_raw(), channels, colors, &tables(16)),
        DynamicImage::ImageRgb16(i) => deep(i.into_raw(), channels, colors, &tables(16)),
        DynamicImage::ImageRgba16(i) => deep(i.into_raw(), channels, colors, &tables(16)),
        photo if usize::from(color.bytes_per_pixel()) == channels => {
            widened(&photo.into_bytes(), channels, colors, &tables(8))
        }
        other => return other,
    };
    let recoded = match channels {
        1 => ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageLuma16),
        2 => ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageLumaA16),
        3 => ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageRgb16),
        _ => ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageRgba16),
    };
    recoded.unwrap_or_default()
}

/// The sRGB value of 16 bit of every value of `bits`.
fn table(curve: &Curve, bits: u32, narrow: bool) -> Vec<u16> {
    let most = (1_u32 << bits) - 1;
    let step = f64::from(1_u32 << (bits - 8));
    let share = |value: u32| {
        if narrow { (f64::from(value) / step - 16.0) / 219.0 } else { f64::from(value) / f64::from(most) }
    };
    (0..=most)
        .map(|value| Encoding::Srgb.from_linear(curve.light(share(value).clamp(0.0, 1.0))))
        .map(|code| (65535.0 * code).round() as u16)
        .collect()
}

fn deep(mut samples: Vec<u16>, channels: usize, colors: usize, tables: &[Vec<u16>]) -> Vec<u16> {
    for pixel in samples.chunks_exact_mut(channels) {
        for (sample, table) in pixel[..colors].iter_mut().zip(tables.iter().cycle()) {
            *sample = table[usize::from(*sample)];
        }
    }
    samples
}

fn widened(samples: &[u8], channels: usize, colors: usize, tables: &[Vec<u16>]) -> Vec<u16> {
    let mut wide: Vec<u16> = samples.iter().map(|&sample| 257 * u16::from(sample)).collect();
    for (pixel, stored) in wide.chunks_exact_mut(channels).zip(samples.chunks_exact(channels)) {
        for ((sample, stored), table) in pixel[..colors].iter_mut().zip(stored).zip(tables.iter().cycle()) {
            *sample = table[usize::from(*stored)];
        }
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgb, Rgba};

    #[test]
    fn curves_have_their_known_values() {
        // BT.709: a fifth of the light is coded as 1.099 · 0.2^0.45 − 0.099.
        let code = 1.099 * 0.2_f64.powf(0.45) - 0.099;
        assert!((Curve::Bt709.light(code) - 0.2).abs() < 1e-12);
        assert!((Curve::Bt709.light(0.045) - 0.01).abs() < 1e-12);
        // sRGB by its parameters.
        let (a, b) = (1.0 / 1.055, 0.055 / 1.055);
        let srgb = Curve::Parametric { g: 2.4, a, b, c: 1.0 / 12.92, d: 0.04045, e: 0.0, f: 0.0 };
        for i in 0..=50 {
            let v = f64::from(i) / 50.0;
            assert!((srgb.light(v) - Curve::Srgb.light(v)).abs() < 1e-9);
        }
        assert!(srgb.is_srgb() && Curve::Power(2.2).is_srgb());
        assert!(
            ![Curve::Linear, Curve::Bt709, Curve::Power(1.8), Curve::Power(2.8)].iter().any(Curve::is_srgb)
        );
        assert!(Curve::power(0.0).is_none() && Curve::power(f64::NAN).is_none());
    }

    #[test]
    fn linear_samples_become_those_of_srgb_and_alpha_stays() {
        // A fifth of the light is 124 of 255 in sRGB, by its definition: 0.484529.
        let fifth = (65535.0 * 0.484_529_f64).round() as u16;
        let pixel = Rgba([13107_u16, 0, 65535, 777]);
        let photo = DynamicImage::ImageRgba16(ImageBuffer::from_pixel(3, 2, pixel));
        let seen = to_srgb(photo, &[Curve::Linear], false).to_rgba16();
        let seen = seen.get_pixel(2, 1).0;
        assert!(seen[0].abs_diff(fifth) <= 1 && seen[1..] == [0, 65535, 777], "{seen:?}");
        let photo = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(3, 2, Rgb([51, 0, 255])));
        let seen = to_srgb(photo, &[Curve::Linear, Curve::Srgb, Curve::Srgb], false);
        let DynamicImage::ImageRgb16(seen) = seen else { panic!("16 bit") };
        let seen = seen.get_pixel(0, 0).0;
        assert!(seen[0].abs_diff(fifth) <= 1 && seen[1..] == [0, 65535], "{seen:?}");
    }

    #[test]
    fn codes_of_8_bit_stay_apart() {
        // By an exponent of 2.8 the darkest codes have less light than a step of 16 bit.
        for (curve, from) in [(Curve::Linear, 0), (Curve::Bt709, 0), (Curve::Srgb, 0), (Curve::Power(2.8), 4)]
        {
            let table = table(&curve, 8, false);
            assert!(table[from..].windows(2).all(|w| w[0] < w[1]), "{curve:?}");
        }
        let narrow = table(&Curve::Srgb, 8, true);
        assert!(narrow[..=16].iter().all(|v| *v == 0) && narrow[235..].iter().all(|v| *v == 65535));
    }
}
