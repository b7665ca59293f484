//! The light on a pixel: of the panel's area under it, by as many rays as it takes.

use nalgebra::{Point2, Vector2};

use super::config::RenderConfig;
use super::panel::Panel;
use super::ray_tracer::RayTracer;
use super::surface::Surface;
use super::truth::{StoredTruth, Truth};

/// A pixel is sampled by several rays where the second difference of the panel position between pixels exceeds this,
/// panel px. Below, the panel position is linear within a pixel to a two-hundredth of a panel pixel.
const BENT_PX: f64 = 0.1;
/// Subdivisions per side of the panel's area under a pixel. Its light is averaged over upright rectangles, which
/// together follow a slanted area well enough to leave no bias.
const PARTS: u32 = 2;

/// The light of all pixels under one way of tracing rays.
pub(super) struct PixelLight<'a> {
    pub(super) tracer: &'a RayTracer,
    /// What these rays meet, pixel by pixel.
    pub(super) truth: &'a Truth,
    pub(super) config: &'a RenderConfig,
    /// Square of the distance at which the projector's light is one, mm².
    pub(super) reference2: f64,
}

impl PixelLight<'_> {
    /// Mean light of a pixel: in one step where it is smooth, by several rays elsewhere.
    pub(super) fn at(&self, panel: &Panel, x: usize, y: usize) -> [f64; 3] {
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
