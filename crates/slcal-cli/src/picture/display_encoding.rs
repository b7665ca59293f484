//! Photographs whose values are not sRGB, made to look as they should on a screen.

use image::{DynamicImage, RgbImage};
use slcal_core::photo::Encoding;

/// The photograph as a screen shows it: one in linear light would be almost black.
pub(crate) fn for_display(photo: DynamicImage, encoding: Encoding) -> DynamicImage {
    if encoding == Encoding::Srgb {
        return photo;
    }
    let pixels = if photo.color().bytes_per_pixel() == photo.color().channel_count() {
        let table = table(encoding, usize::from(u8::MAX));
        photo.to_rgb8().into_raw().into_iter().map(|v| table[usize::from(v)]).collect()
    } else {
        let table = table(encoding, usize::from(u16::MAX));
        photo.to_rgb16().into_raw().into_iter().map(|v| table[usize::from(v)]).collect()
    };
    RgbImage::from_raw(photo.width(), photo.height(), pixels).map_or(photo, DynamicImage::ImageRgb8)
}

/// The sRGB value of every value up to `most`.
fn table(encoding: Encoding, most: usize) -> Vec<u8> {
    (0..=most)
        .map(|v| {
            let share = v as f64 / most as f64;
            let light = match encoding {
                Encoding::Gamma(gamma) => share.powf(gamma),
                _ => share,
            };
            // IEC 61966-2-1.
            let value =
                if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
            (255.0 * value).round().clamp(0.0, 255.0) as u8
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_light_is_shown_as_bright_as_it_is() {
        // A fifth of the light is 124 of 255 in sRGB, by its definition.
        let photo = DynamicImage::ImageLuma16(image::ImageBuffer::from_pixel(3, 2, image::Luma([13107])));
        let seen = for_display(photo.clone(), Encoding::Linear).to_rgb8();
        assert_eq!(seen.get_pixel(2, 1).0, [124; 3]);
        assert_eq!(for_display(photo, Encoding::Srgb).to_rgb8().get_pixel(0, 0).0, [51; 3]);
        let eight = DynamicImage::ImageRgb8(RgbImage::from_pixel(2, 2, image::Rgb([51, 0, 255])));
        assert_eq!(for_display(eight.clone(), Encoding::Linear).to_rgb8().get_pixel(1, 1).0, [124, 0, 255]);
        // Almost what sRGB is.
        let near = for_display(eight, Encoding::Gamma(2.2)).to_rgb8().get_pixel(0, 0).0;
        assert!(near[0].abs_diff(51) <= 4 && near[1..] == [0, 255], "{near:?}");
    }
}
