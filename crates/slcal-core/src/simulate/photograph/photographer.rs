//! Renders photographs of surfaces through a rig.

use image::{DynamicImage, RgbImage};
use nalgebra::{Point2, Vector2};

use super::config::RenderConfig;
use super::panel::Panel;
use super::ray_tracer::RayTracer;
use super::sensor::expose;
use super::surface::Surface;
use super::truth::{PixelTruth, StoredTruth, Truth};
use crate::error::{Error, ErrorSubject, Result};
use crate::rig::Rig;

/// A pixel is sampled by several rays where the second difference of the panel position between pixels exceeds this,
/// panel px. Below, the panel position is linear within a pixel to a two-hundredth of a panel pixel.
const BENT_PX: f64 = 0.1;
/// Subdivisions per side of the panel's area under a pixel. Its light is averaged over upright rectangles, which
/// together follow a slanted area well enough to leave no bias.
const PARTS: u32 = 2;
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
    truth: Truth,
    /// Square of the distance at which the projector's light is one, mm².
    reference2: f64,
}

impl Photographer {
    /// Traces one ray per pixel of the rig's camera.
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
        let (width, height) = (tracer.camera.width as usize, tracer.camera.height as usize);
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            pixels.extend((0..width).map(|x| tracer.pixel(x, y)));
        }
        let truth = Truth { width, height, pixels };
        let reference_mm = config.reference_mm.unwrap_or_else(|| median_distance(&tracer, &truth));
        Ok(Self { tracer, config: config.clone(), truth, reference2: reference_mm * reference_mm })
    }

    /// Light, lens and sensor.
    #[must_use]
    pub fn config(&self) -> &RenderConfig {
        &self.config
    }

    /// The ground truth of every pixel.
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

    /// A photograph, 8 or 16 bit RGB. `frame` counts the photographs with one seed: each has its own noise.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a picture of another size than the panel's.
    pub fn photograph(&self, shown: ProjectedImage<'_>, frame: u64) -> Result<DynamicImage> {
        let panel = self.panel(shown)?;
        let (width, height) = (self.truth.width, self.truth.height);
        let mut light = Vec::with_capacity(width * height);
        for y in 0..height {
            light.extend((0..width).map(|x| self.light(&panel, x, y)));
        }
        expose(light, [width as u32, height as u32], &self.config, frame)
    }

    fn panel(&self, shown: ProjectedImage<'_>) -> Result<Panel> {
        let size @ [w, h] = [self.tracer.projector.width, self.tracer.projector.height];
        let RenderConfig { projector_blur_px: blur, projector_black: black, .. } = self.config;
        let plain = |c| RgbImage::from_pixel(w, h, image::Rgb([c; 3]));
        match shown {
            ProjectedImage::White => Ok(Panel::new(&plain(255), blur, black)),
            ProjectedImage::Black => Ok(Panel::new(&plain(0), blur, black)),
            ProjectedImage::Picture(picture) if [picture.width(), picture.height()] == size => {
                Ok(Panel::new(picture, blur, black))
            }
            ProjectedImage::Picture(picture) => Err(Error::invalid(
                "projected picture",
                format!("{w}x{h}, the size of the rig's projector"),
                format!("{}x{}", picture.width(), picture.height()),
            )),
        }
    }

    /// Mean light of a pixel: in one step where it is smooth, by several rays elsewhere.
    fn light(&self, panel: &Panel, x: usize, y: usize) -> [f64; 3] {
        let Some(pixel) = self.truth.pixel(x, y) else { return self.config.background };
        match self.smooth(pixel, x, y) {
            Some(slope) if pixel.is_lit() => {
                let shone = mean_over(panel, pixel.panel.into(), slope);
                self.returned(pixel.surface as usize, f64::from(pixel.irradiance), shone)
            }
            Some(_) => self.returned(pixel.surface as usize, 0.0, [0.0; 3]),
            None => self.sampled(panel, x, y),
        }
    }

    /// The slope of the panel position over a pixel whose neighbours all see the same surface in the same light (zero
    /// where that light is not the projector's); `None` elsewhere, and on the border.
    fn smooth(&self, pixel: &StoredTruth, x: usize, y: usize) -> Option<[Vector2<f64>; 2]> {
        let (left, top) = (x.checked_sub(1)?, y.checked_sub(1)?);
        let alike = |p: &&StoredTruth| p.surface == pixel.surface && p.is_lit() == pixel.is_lit();
        for j in top..=y + 1 {
            for i in left..=x + 1 {
                self.truth.pixel(i, j).filter(alike)?;
            }
        }
        if !pixel.is_lit() {
            return Some([Vector2::zeros(); 2]);
        }
        let at = |i, j| self.truth.pixel(i, j).map(|p| Vector2::from(p.panel));
        let along = |a: Vector2<f64>, b: Vector2<f64>| {
            let bend = a + b - Vector2::from(pixel.panel) * 2.0;
            (bend.amax() <= BENT_PX).then(|| (b - a) / 2.0)
        };
        Some([along(at(left, y)?, at(x + 1, y)?)?, along(at(x, top)?, at(x, y + 1)?)?])
    }

    fn sampled(&self, panel: &Panel, x: usize, y: usize) -> [f64; 3] {
        let n = self.config.samples;
        let step = f64::from(n).recip();
        let offset = |k: u32| (f64::from(k) + 0.5) * step - 0.5;
        let mut sum = [0.0; 3];
        for k in 0..n * n {
            let p = Point2::new(x as f64 + offset(k % n), y as f64 + offset(k / n));
            let light = self.sample(panel, p, step);
            sum.iter_mut().zip(light).for_each(|(s, l)| *s += l);
        }
        sum.map(|s| s / f64::from(n * n))
    }

    /// Mean light of a part of a pixel, by one ray.
    fn sample(&self, panel: &Panel, p: Point2<f64>, step: f64) -> [f64; 3] {
        let Some(hit) = self.tracer.trace(p) else { return self.config.background };
        let Some(at) = hit.panel else { return self.returned(hit.surface, 0.0, [0.0; 3]) };
        let slope = self.tracer.slope(p, &hit, step).unwrap_or([Vector2::zeros(); 2]);
        self.returned(hit.surface, self.tracer.irradiance(&hit), mean_over(panel, at, slope))
    }

    /// The light reflected by a surface; that of the background where there is none.
    fn returned(&self, surface: usize, irradiance: f64, shone: [f64; 3]) -> [f64; 3] {
        let Some(Surface { albedo, .. }) = self.tracer.surfaces.get(surface) else {
            return self.config.background;
        };
        let share = irradiance * self.reference2;
        std::array::from_fn(|c| albedo[c] * (self.config.ambient[c] + share * shone[c]))
    }
}

/// Mean light of the panel over the parallelogram around `centre` with these sides.
fn mean_over(panel: &Panel, centre: Point2<f64>, [x, y]: [Vector2<f64>; 2]) -> [f64; 3] {
    let part = f64::from(PARTS).recip();
    // An upright rectangle of the same second moments as the slanted part.
    let [width, height] = [0, 1].map(|k| x[k].hypot(y[k]) * part);
    let offset = |k: u32| (f64::from(k) + 0.5) * part - 0.5;
    let mut sum = [0.0; 3];
    for k in 0..PARTS * PARTS {
        let at = centre + x * offset(k % PARTS) + y * offset(k / PARTS);
        let light = panel.mean(at.x, at.y, width, height);
        sum.iter_mut().zip(light).for_each(|(s, l)| *s += l);
    }
    sum.map(|s| s * part * part)
}

/// Median distance of the lit pixels from the projector, mm; 1 where nothing is lit.
fn median_distance(tracer: &RayTracer, truth: &Truth) -> f64 {
    let lit = truth.pixels.iter().filter(|p| p.is_lit());
    let mut distances: Vec<f64> =
        lit.map(|p| (nalgebra::Point3::from(p.point) - tracer.lamp).norm()).collect();
    crate::solve::median(&mut distances).unwrap_or(1.0)
}
