//! Channels of opacity, which say nothing about light: what is hidden is told, and the channel dropped.

use image::{DynamicImage, ImageBuffer};

/// How many of a picture's pixels are hidden.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opacity {
    /// Fully transparent, %.
    pub(super) hidden: f64,
    /// Fully opaque, %.
    pub(super) opaque: f64,
}

impl Opacity {
    /// Of a picture that has such a channel.
    pub(super) fn of(photo: &DynamicImage) -> Option<Self> {
        let [hidden, opaque] = match photo {
            DynamicImage::ImageLumaA8(i) => count(i.pixels().map(|p| (p.0[1] == 0, p.0[1] == u8::MAX))),
            DynamicImage::ImageRgba8(i) => count(i.pixels().map(|p| (p.0[3] == 0, p.0[3] == u8::MAX))),
            DynamicImage::ImageLumaA16(i) => count(i.pixels().map(|p| (p.0[1] == 0, p.0[1] == u16::MAX))),
            DynamicImage::ImageRgba16(i) => count(i.pixels().map(|p| (p.0[3] == 0, p.0[3] == u16::MAX))),
            _ => return None,
        };
        let all = u64::from(photo.width()) * u64::from(photo.height());
        let percent = |count: u64| 100.0 * count as f64 / all as f64;
        Some(Self { hidden: percent(hidden), opaque: percent(opaque) })
    }
}

/// The numbers of pixels that are fully transparent, and fully opaque.
fn count(pixels: impl Iterator<Item = (bool, bool)>) -> [u64; 2] {
    pixels.fold([0; 2], |[hidden, opaque], (h, o)| [hidden + u64::from(h), opaque + u64::from(o)])
}

/// The picture without the channel, in its own memory.
pub(super) fn without_alpha(photo: DynamicImage) -> DynamicImage {
    let (width, height) = (photo.width(), photo.height());
    let plain = match photo {
        DynamicImage::ImageLumaA8(i) => {
            ImageBuffer::from_raw(width, height, firsts::<_, 2>(i.into_raw())).map(DynamicImage::ImageLuma8)
        }
        DynamicImage::ImageRgba8(i) => {
            ImageBuffer::from_raw(width, height, firsts::<_, 4>(i.into_raw())).map(DynamicImage::ImageRgb8)
        }
        DynamicImage::ImageLumaA16(i) => {
            ImageBuffer::from_raw(width, height, firsts::<_, 2>(i.into_raw())).map(DynamicImage::ImageLuma16)
        }
        DynamicImage::ImageRgba16(i) => {
            ImageBuffer::from_raw(width, height, firsts::<_, 4>(i.into_raw())).map(DynamicImage::ImageRgb16)
        }
        other => return other,
    };
    plain.unwrap_or_default()
}

/// All but the last of every N samples.
fn firsts<S: Copy, const N: usize>(mut samples: Vec<S>) -> Vec<S> {
    let pixels = samples.len() / N;
    for i in 1..pixels {
        samples.copy_within(N * i..N * i + N - 1, (N - 1) * i);
    }
    samples.truncate((N - 1) * pixels);
    samples.shrink_to_fit();
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_stay_and_opacity_goes() {
        let picture =
            image::RgbaImage::from_fn(5, 3, |x, y| image::Rgba([x as u8, y as u8, 7, (x * 60) as u8]));
        let source = DynamicImage::from(picture);
        for photo in [
            source.clone(),
            source.to_luma_alpha8().into(),
            source.to_rgba16().into(),
            source.to_luma_alpha16().into(),
            source.to_rgb8().into(),
        ] {
            let plain = without_alpha(photo.clone());
            assert!(!plain.color().has_alpha());
            assert_eq!(plain.to_rgb16(), photo.to_rgb16(), "{:?}", photo.color());
        }
        let found = Opacity::of(&source).unwrap();
        assert_eq!((found.hidden, found.opaque), (20.0, 0.0));
        assert_eq!(Opacity::of(&source.to_rgb8().into()), None);
    }
}
