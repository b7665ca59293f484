//! Takes photographs of a stage.

use image::{DynamicImage, RgbImage};
use nalgebra::{Point2, Vector2};

use super::config::RenderConfig;
use super::panel::Panel;
use super::sensor::expose;
use super::stage::Stage;
use super::surface::Surface;
use super::truth::{PixelTruth, StoredTruth, Truth};
use crate::error::{Error, Result};
use crate::rig::Rig;

/// Where the panel position bends by more than this from a pixel to the next (its second difference, panel px), a pixel is
/// sampled by several rays: below, it is straight within a pixel to a two-hundredth of a panel pixel.
const BENT_PX: f64 = 0.1;
/// Parts per side into which the panel's piece under a pixel is divided: its light is averaged over upright
/// rectangles, which together follow a slanted piece well enough for no bias to be left.
const PARTS: u32 = 2;
/// More pixels than any camera or projector has.
const MOST_PIXELS: u64 = 250_000_000;

/// What the projector shows.
#[derive(Debug, Clone, Copy)]
pub enum ProjectedImage<'a> {
    /// An sRGB picture of the panel's size.
    Picture(&'a RgbImage),
    /// Full light.
    White,
    /// No light (beyond [`RenderConfig::projector_black`]).
    Black,
}

/// A rig before its surfaces. The geometry is computed once; every photograph after that is cheap.
///
/// Geometrically exact: lenses with their distortion, occlusion, and shadow of a point light. Physically simple: matt surfaces,
/// no light from one surface to another. What is thinner than a pixel may be missed.
pub struct Photographer {
    pub(super) stage: Stage,
    config: RenderConfig,
    truth: Truth,
    /// Square of the distance at which the projector's light is one, mm².
    reference2: f64,
}

impl Photographer {
    /// Looks at the surfaces through the rig's camera, one ray per pixel.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig without a projector, devices without pixels or with more than 250 million, and values
    /// out of range.
    pub fn new(rig: &Rig, surfaces: &[Surface], config: &RenderConfig) -> Result<Self> {
        config.validate()?;
        let stage = Stage::new(rig, surfaces)?;
        for (name, device) in [("camera", &stage.camera), ("projector", &stage.projector)] {
            let (w, h) = (device.width, device.height);
            if !(1..=MOST_PIXELS).contains(&(u64::from(w) * u64::from(h))) {
                let expected = format!("1 to {MOST_PIXELS} pixels");
                return Err(Error::invalid(format!("{name} of the rig"), expected, format!("{w}x{h}")));
            }
        }
        let (width, height) = (stage.camera.width as usize, stage.camera.height as usize);
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            pixels.extend((0..width).map(|x| stage.pixel(x, y)));
        }
        let truth = Truth { width, height, pixels };
        let reference_mm = config.reference_mm.unwrap_or_else(|| median_distance(&stage, &truth));
        Ok(Self { stage, config: config.clone(), truth, reference2: reference_mm * reference_mm })
    }

    /// How it photographs.
    #[must_use]
    pub fn config(&self) -> &RenderConfig {
        &self.config
    }

    /// What every pixel sees.
    #[must_use]
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// What a position of the photograph sees, pixel centres at integers.
    #[must_use]
    pub fn look(&self, p: Point2<f64>) -> Option<PixelTruth> {
        let look = self.stage.look(p)?;
        Some(PixelTruth { point: look.point, panel: look.panel, surface: look.surface })
    }

    /// The surfaces.
    #[must_use]
    pub fn surfaces(&self) -> &[Surface] {
        &self.stage.surfaces
    }

    /// A photograph, 8 or 16 bit RGB. `frame` numbers the photographs that are taken with one seed: each number has noise of
    /// its own.
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
        let size @ [w, h] = [self.stage.projector.width, self.stage.projector.height];
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

    /// Mean light of a pixel: at once where it is smooth, by several rays where it is not.
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

    /// The slope of the panel position over a pixel whose neighbours all see the same surface in the same light (zero where
    /// that light is not the projector's); `None` elsewhere, and on the border.
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
        let Some(look) = self.stage.look(p) else { return self.config.background };
        let Some(at) = look.panel else { return self.returned(look.surface, 0.0, [0.0; 3]) };
        let slope = self.stage.slope(p, &look, step).unwrap_or([Vector2::zeros(); 2]);
        self.returned(look.surface, self.stage.irradiance(&look), mean_over(panel, at, slope))
    }

    /// The light that a surface returns; that of the background where there is none.
    fn returned(&self, surface: usize, irradiance: f64, shone: [f64; 3]) -> [f64; 3] {
        let Some(Surface { albedo, .. }) = self.stage.surfaces.get(surface) else {
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
fn median_distance(stage: &Stage, truth: &Truth) -> f64 {
    let lit = truth.pixels.iter().filter(|p| p.is_lit());
    let mut distances: Vec<f64> =
        lit.map(|p| (nalgebra::Point3::from(p.point) - stage.lamp).norm()).collect();
    crate::solve::median(&mut distances).unwrap_or(1.0)
}
