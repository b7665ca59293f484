//! Renders photographs of surfaces through a rig.

use image::imageops::flip_horizontal;
use image::{DynamicImage, RgbImage};
use nalgebra::Point2;

use super::channel_offset::ChannelOffset;
use super::config::RenderConfig;
use super::jpeg::MOST_SIDE_PX;
use super::panel::{Emission, Panel};
use super::pixel_light::PixelLight;
use super::ray_tracer::RayTracer;
use super::sensor::{Exposure, expose};
use super::surface::Surface;
use super::truth::{PixelTruth, Truth};
use crate::error::{Error, ErrorSubject, Result};
use crate::photo::Encoding;
use crate::rig::Rig;

/// Largest number of pixels of a device.
const MOST_PIXELS: u64 = 250_000_000;

/// The image that the projector shows.
#[derive(Debug, Clone, Copy)]
pub enum ProjectedImage<'a> {
    /// An sRGB picture of the panel's size.
    Picture(&'a RgbImage),
    /// Full light.
    White,
    /// No light (except [`RenderConfig::projector_black`]).
    Black,
}

/// A rig in front of its surfaces. The geometry is computed once; every photograph after that is cheap.
///
/// Geometrically exact: lenses with their distortion, occlusion, and shadow of a point light. Physically simple: matt
/// surfaces, no light from one surface to another. Details thinner than a pixel may be missed.
pub struct Photographer {
    pub(super) tracer: RayTracer,
    config: RenderConfig,
    /// Whether the projector exchanges left and right of its pictures.
    pub(super) mirrored: bool,
    truth: Truth,
    /// The same for red and blue light where it goes other ways than green.
    red_and_blue: [Option<(RayTracer, Truth)>; 2],
    /// Square of the distance at which the projector's light is one, mm².
    reference2: f64,
}

impl Photographer {
    /// Traces one ray per pixel of the rig's camera, and one more for red and for blue where they go other ways.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig without a projector, devices without pixels or with more than 250 million, and
    /// values out of range.
    pub fn new(rig: &Rig, surfaces: &[Surface], config: &RenderConfig) -> Result<Self> {
        config.validate()?;
        let tracer = RayTracer::new(rig, surfaces)?;
        for (name, device) in [("camera", &tracer.camera), ("projector", &tracer.projector)] {
            let (w, h) = (device.width, device.height);
            if !(1..=MOST_PIXELS).contains(&(u64::from(w) * u64::from(h))) {
                let expected = format!("1 to {MOST_PIXELS} pixels");
                return Err(Error::invalid(
                    ErrorSubject::Part { part: name, of: "rig" },
                    expected,
                    format!("{w}x{h}"),
                ));
            }
        }
        let [width, height] = [tracer.camera.width, tracer.camera.height];
        if config.jpeg_quality.is_some() && width.max(height) > MOST_SIDE_PX {
            return Err(Error::invalid(
                ErrorSubject::Photograph,
                format!("at most {MOST_SIDE_PX} px on each side as JPEG"),
                format!("{width}x{height}"),
            ));
        }
        let truth = tracer.picture();
        let red_and_blue = ChannelOffset::of_red_and_blue(config).map(|offset| {
            let tracer = tracer.shifted(offset?);
            let truth = tracer.picture();
            Some((tracer, truth))
        });
        let reference_mm = config.reference_mm.unwrap_or_else(|| median_distance(&tracer, &truth));
        Ok(Self {
            tracer,
            config: config.clone(),
            mirrored: rig.is_mirrored(),
            truth,
            red_and_blue,
            reference2: reference_mm * reference_mm,
        })
    }

    /// Light, lens and sensor.
    #[must_use]
    pub fn config(&self) -> &RenderConfig {
        &self.config
    }

    /// The ground truth of every pixel: that of green light, whose geometry is the rig's.
    #[must_use]
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// The ground truth at a position of the photograph, pixel centres at integers.
    #[must_use]
    pub fn trace(&self, p: Point2<f64>) -> Option<PixelTruth> {
        let hit = self.tracer.trace(p)?;
        Some(PixelTruth { point: hit.point, panel: hit.panel, surface: hit.surface })
    }

    /// The surfaces.
    #[must_use]
    pub fn surfaces(&self) -> &[Surface] {
        &self.tracer.surfaces
    }

    /// A photograph, 8 or 16 bit RGB; where the camera writes JPEG, as it is read from the file. `frame` counts the
    /// photographs with one seed: each has its own noise.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a picture of another size than the panel's.
    pub fn photograph(&self, shown: ProjectedImage<'_>, frame: u64) -> Result<DynamicImage> {
        Ok(self.exposure(shown, frame)?.picture)
    }

    /// The same, with the camera's file where it writes JPEG.
    ///
    /// # Errors
    /// As [`photograph`](Self::photograph).
    pub fn exposure(&self, shown: ProjectedImage<'_>, frame: u64) -> Result<Exposure> {
        let panel = self.panel(shown)?;
        let (width, height) = (self.truth.width, self.truth.height);
        let light_of =
            |tracer, truth| PixelLight { tracer, truth, config: &self.config, reference2: self.reference2 };
        let all = light_of(&self.tracer, &self.truth);
        let [red, blue] = self.red_and_blue.each_ref().map(|c| c.as_ref().map(|(r, t)| light_of(r, t)));
        let mut light = Vec::with_capacity(width * height);
        for y in 0..height {
            light.extend((0..width).map(|x| {
                let mut light = all.at(&panel, x, y);
                for (channel, apart) in [(0, &red), (2, &blue)] {
                    if let Some(apart) = apart {
                        light[channel] = apart.at(&panel, x, y)[channel];
                    }
                }
                light
            }));
        }
        expose(light, [width as u32, height as u32], &self.config, frame)
    }

    fn panel(&self, shown: ProjectedImage<'_>) -> Result<Panel> {
        let size @ [w, h] = [self.tracer.projector.width, self.tracer.projector.height];
        let config = &self.config;
        let emission = Emission {
            curve: config.projector_gamma.map_or(Encoding::Srgb, Encoding::Gamma),
            black: config.projector_black,
            blur_px: config.projector_blur_px,
            falloff: config.projector_falloff,
        };
        let plain = |c| RgbImage::from_pixel(w, h, image::Rgb([c; 3]));
        match shown {
            ProjectedImage::White => Ok(Panel::new(&plain(255), &emission)),
            ProjectedImage::Black => Ok(Panel::new(&plain(0), &emission)),
            ProjectedImage::Picture(picture) if [picture.width(), picture.height()] == size => {
                let flipped = self.mirrored.then(|| flip_horizontal(picture));
                Ok(Panel::new(flipped.as_ref().unwrap_or(picture), &emission))
            }
            ProjectedImage::Picture(picture) => Err(Error::invalid(
                "projected picture",
                format!("{w}x{h}, the size of the rig's projector"),
                format!("{}x{}", picture.width(), picture.height()),
            )),
        }
    }
}

/// Median distance of the lit pixels from the projector, mm; 1 where nothing is lit.
fn median_distance(tracer: &RayTracer, truth: &Truth) -> f64 {
    let lit = truth.pixels.iter().filter(|p| p.is_lit());
    let mut distances: Vec<f64> =
        lit.map(|p| (nalgebra::Point3::from(p.point) - tracer.lamp).norm()).collect();
    crate::solve::median(&mut distances).unwrap_or(1.0)
}
