//! From light to a photograph: lens blur, crosstalk, exposure, noise, code values.

use image::{DynamicImage, ImageBuffer, Rgb};

use super::blur::{Border, blur};
use super::config::RenderConfig;
use crate::error::{Error, ErrorSubject, Result};
use crate::simulate::draws::Draws;

/// The photograph of this light. `frame` counts the photographs of one seed, so that each has its own noise.
pub(super) fn expose(
    mut light: Vec<[f64; 3]>,
    [width, height]: [u32; 2],
    config: &RenderConfig,
    frame: u64,
) -> Result<DynamicImage> {
    if config.blur_px > 0.0 {
        blur(&mut light, width as usize, config.blur_px, Border::Repeat);
    }
    let mut draws = Draws::new(config.seed, frame);
    let mut code = |light: f64| {
        let noise =
            if config.noise_levels > 0.0 { draws.normal() * config.noise_levels / 255.0 } else { 0.0 };
        (config.encoding.from_linear(light) + noise).clamp(0.0, 1.0)
    };
    let samples = light.iter().flat_map(|l| {
        let channel = |row: [f64; 3]| config.exposure * (row[0] * l[0] + row[1] * l[1] + row[2] * l[2]);
        config.crosstalk.map(channel)
    });
    let size = || {
        Error::invalid(
            ErrorSubject::Photograph,
            "a size that fits into memory",
            format!("{width}x{height} px"),
        )
    };
    if config.bits == 16 {
        let samples = samples.map(|l| (code(l) * 65535.0).round() as u16).collect();
        let image = ImageBuffer::<Rgb<u16>, _>::from_raw(width, height, samples).ok_or_else(size)?;
        return Ok(DynamicImage::ImageRgb16(image));
    }
    let samples = samples.map(|l| (code(l) * 255.0).round() as u8).collect();
    let image = ImageBuffer::<Rgb<u8>, _>::from_raw(width, height, samples).ok_or_else(size)?;
    Ok(DynamicImage::ImageRgb8(image))
}
