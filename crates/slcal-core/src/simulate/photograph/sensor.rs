//! From light to a photograph: lens, crosstalk, exposure, the camera's pipeline, code values, file.

use image::{DynamicImage, ImageBuffer, Rgb};

use super::blur::{Border, blur};
use super::camera_pipeline::develop;
use super::config::RenderConfig;
use super::jpeg::through_jpeg;
use super::radial_falloff::RadialFalloff;
use crate::error::{Error, ErrorSubject, Result};

/// A photograph.
#[derive(Debug, Clone)]
pub struct Exposure {
    /// Its pixels, 8 or 16 bit RGB.
    pub picture: DynamicImage,
    /// The JPEG file from which they are read, where the camera writes one.
    pub file: Option<Vec<u8>>,
}

/// The photograph of this light. `frame` counts the photographs of one seed, so that each has its own noise.
pub(super) fn expose(
    mut light: Vec<[f64; 3]>,
    [width, height]: [u32; 2],
    config: &RenderConfig,
    frame: u64,
) -> Result<Exposure> {
    let columns = width as usize;
    if config.blur_px > 0.0 {
        blur(&mut light, columns, config.blur_px, Border::Repeat);
    }
    if config.vignetting > 0.0 || config.flicker.is_some() {
        darken(&mut light, columns, config);
    }
    for l in &mut light {
        let channel = |row: [f64; 3]| config.exposure * (row[0] * l[0] + row[1] * l[1] + row[2] * l[2]);
        *l = config.crosstalk.map(channel);
    }
    develop(&mut light, columns, config, frame);
    let size = || {
        Error::invalid(
            ErrorSubject::Photograph,
            "a size that fits into memory",
            format!("{width}x{height} px"),
        )
    };
    let values = light.as_flattened().iter();
    if config.bits == 16 {
        let samples = values.map(|v| (v * 65535.0).round() as u16).collect();
        let image = ImageBuffer::<Rgb<u16>, _>::from_raw(width, height, samples).ok_or_else(size)?;
        return Ok(Exposure { picture: DynamicImage::ImageRgb16(image), file: None });
    }
    let samples = values.map(|v| (v * 255.0).round() as u8).collect();
    let image = ImageBuffer::<Rgb<u8>, _>::from_raw(width, height, samples).ok_or_else(size)?;
    let Some(quality) = config.jpeg_quality else {
        return Ok(Exposure { picture: DynamicImage::ImageRgb8(image), file: None });
    };
    let (file, read) = through_jpeg(&image, quality)?;
    Ok(Exposure { picture: DynamicImage::ImageRgb8(read), file: Some(file) })
}

/// What the lens takes away towards the corners, and what the lamps of the room take away from some rows.
fn darken(light: &mut [[f64; 3]], width: usize, config: &RenderConfig) {
    let vignette = RadialFalloff::new(config.vignetting, width, light.len() / width);
    for (y, row) in light.chunks_exact_mut(width).enumerate() {
        let row_share = config.flicker.map_or(1.0, |f| f.at(y));
        for (x, l) in row.iter_mut().enumerate() {
            let share = row_share * vignette.at(x, y);
            *l = l.map(|v| v * share);
        }
    }
}
