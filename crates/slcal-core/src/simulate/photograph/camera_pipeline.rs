//! From linear light on the sensor to encoded values: noise, one colour per pixel, tone and sharpening.

use super::config::RenderConfig;
use super::demosaic::measured;
use super::tone::curved;
use crate::simulate::draws::Draws;

/// Turns linear light (1 is full scale) into encoded values (0–1), in place. `frame` counts the photographs of one seed, so
/// that each has its own noise.
///
/// The noise is that of a sample of the sensor, stated in grey levels of its encoded value; with a mosaic there is one sample
/// per pixel. In linear light it grows with the signal, as photon noise does.
pub(super) fn develop(light: &mut [[f64; 3]], width: usize, config: &RenderConfig, frame: u64) {
    let mut draws = Draws::new(config.seed, frame);
    let mut sample = |light: f64| {
        let noise =
            if config.noise_levels > 0.0 { draws.normal() * config.noise_levels / 255.0 } else { 0.0 };
        (config.encoding.from_linear(light) + noise).clamp(0.0, 1.0)
    };
    if let Some(demosaic) = config.demosaic {
        let raw = |(i, light): (usize, &[f64; 3])| {
            config.encoding.to_linear(sample(light[measured(i % width, i / width)]))
        };
        let mosaic: Vec<f64> = light.iter().enumerate().map(raw).collect();
        let filled = demosaic.fill(&mosaic, width);
        light.iter_mut().zip(filled).for_each(|(l, f)| *l = f.map(|f| config.encoding.from_linear(f)));
    } else {
        for l in light.iter_mut() {
            *l = l.map(&mut sample);
        }
    }
    if config.tone > 0.0 {
        light.as_flattened_mut().iter_mut().for_each(|v| *v = curved(*v, config.tone));
    }
    if let Some(sharpen) = config.sharpen {
        sharpen.apply(light, width);
    }
}
