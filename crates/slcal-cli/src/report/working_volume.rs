//! Where one works with a rig, and how sure a point or a length will be there.

use nalgebra::{Point2, Point3, Vector3};
use slcal_core::geometry::Camera;
use slcal_core::pattern::Axis;
use slcal_core::reconstruct::{ExpectedSigma, SigmaForecast, length_sigma};
use slcal_core::{Match, Rig, Verdict};

/// Rows of the image that are tried for each of them: odd, so that the middle is one, and up to both edges.
const LAYERS: usize = 33;
/// Patterns have vertical stripes unless asked otherwise: horizontal ones are spoken of where their σ is below this share.
const CLEARLY_BETTER: f64 = 0.5;

/// Which place of the image the working distance is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Sheet,
    Image,
    Lit,
}

/// Where one works with a rig, and what σ is foretold there.
pub(super) struct WorkingVolume {
    /// The slits that tell depths better there.
    pub(super) axis: Axis,
    forecast: SigmaForecast,
    /// Where in the image.
    pixel: Point2<f64>,
    place: Place,
    /// The depth there.
    pub(super) distance_mm: f64,
    /// Whether that is the sheet's.
    pub(super) of_sheet: bool,
    /// Whether the rig's share of σ is known.
    pub(super) knows_rig: bool,
    pub(super) sigma: ExpectedSigma,
}

/// The middle of the first sheet, or of the image some baselines away, or else any place lit there; under the slits that tell
/// its depth better. `None` where nothing is lit there.
pub(super) fn working(rig: &Rig) -> slcal_core::Result<Option<WorkingVolume>> {
    let model = &rig.camera.model;
    let middle = rig.views.first().map(|v| {
        v.camera_from_sheet.transform(&Point3::new(v.size.width_mm / 2.0, v.size.height_mm / 2.0, 0.0))
    });
    let centre = Camera::image_centre(model.width, model.height);
    let (depths, of_sheet) = match middle {
        Some(m) => (vec![m.z], model.project(&m)),
        // Devices side by side overlap from some distance on.
        None => ([3.0, 6.0, 12.0, 24.0].map(|times| times * rig.baseline_mm().unwrap_or(0.0)).to_vec(), None),
    };
    let mut places = vec![(Place::Image, centre)];
    places.splice(0..0, of_sheet.map(|p| (Place::Sheet, p)));
    places.extend(grid(model).map(|p| (Place::Lit, p)));
    let mut forecasts = Vec::new();
    for axis in [Axis::Columns, Axis::Rows] {
        forecasts.push((axis, SigmaForecast::new(rig, axis, Match::DEFAULT_SIGMA_PX)?));
    }
    for ((place, pixel), depth) in places.iter().flat_map(|p| depths.iter().map(move |d| (*p, *d))) {
        let told: Vec<_> = forecasts
            .iter_mut()
            .enumerate()
            .filter_map(|(i, (_, f))| Some((i, f.at(pixel, depth)?)))
            .collect();
        let clearly = |a: &ExpectedSigma, b: &ExpectedSigma| b.sigma_mm < CLEARLY_BETTER * a.sigma_mm;
        let best = told.into_iter().reduce(|a, b| if clearly(&a.1, &b.1) { b } else { a });
        if let Some((i, sigma)) = best {
            let (axis, forecast) = forecasts.swap_remove(i);
            let (of_sheet, knows_rig) = (middle.is_some(), rig.covariance.is_some());
            return Ok(Some(WorkingVolume {
                axis,
                forecast,
                pixel,
                place,
                distance_mm: depth,
                of_sheet,
                knows_rig,
                sigma,
            }));
        }
    }
    Ok(None)
}

/// Slopes y/z of rows of the image, from its middle outwards, by turns up and down.
pub(super) fn slopes(model: &Camera) -> Vec<f64> {
    let h = f64::from(model.height);
    let row = |i: usize| {
        let off = i.div_ceil(2) as f64 / (LAYERS / 2) as f64 * h / 2.0;
        (h - 1.0) / 2.0 + if i % 2 == 1 { -off } else { off }
    };
    let slope = |i: usize| Some(model.bearing(Point2::new(model.intrinsics.cx, row(i)))?.y);
    (0..LAYERS).filter_map(slope).collect()
}

/// Pixels over the whole image.
fn grid(model: &Camera) -> impl Iterator<Item = Point2<f64>> {
    const SIDE: u32 = 12;
    let [w, h] = [model.width, model.height].map(f64::from);
    let at = |i: u32, length: f64| (f64::from(i) + 0.5) / f64::from(SIDE) * length - 0.5;
    (0..SIDE * SIDE).map(move |i| Point2::new(at(i % SIDE, w), at(i / SIDE, h)))
}

impl WorkingVolume {
    /// The share of σ that is common to all points, mm.
    pub(super) fn rig_mm(&self) -> f64 {
        (self.sigma.sigma_mm.powi(2) - self.sigma.noise_mm.powi(2)).max(0.0).sqrt()
    }

    /// Where in the image that is.
    pub(super) fn place_in_words(&self) -> &'static str {
        match self.place {
            Place::Sheet => "the middle of the sheet",
            Place::Image => "the middle of the image",
            Place::Lit => "a place that is lit",
        }
    }

    /// σ along the line of sight through that place.
    pub(super) fn at_depth(&mut self, depth_mm: f64) -> Option<ExpectedSigma> {
        self.forecast.at(self.pixel, depth_mm)
    }

    /// σ at a place seen from above, whatever its height: at the row of the image nearest to the middle that is lit there.
    pub(super) fn seen_from_above(
        &mut self,
        model: &Camera,
        slopes: &[f64],
        x: f64,
        z: f64,
    ) -> Option<ExpectedSigma> {
        let [w, h] = [model.width, model.height].map(f64::from);
        slopes.iter().find_map(|slope| {
            let pixel = model.project(&Point3::new(x, slope * z, z))?;
            let inside = (-0.5..=w - 0.5).contains(&pixel.x) && (-0.5..=h - 0.5).contains(&pixel.y);
            if inside { self.forecast.at(pixel, z) } else { None }
        })
    }
}

/// How a reader knows the slits.
pub(super) fn stripes(axis: Axis) -> &'static str {
    match axis {
        Axis::Columns => "vertical stripes",
        Axis::Rows => "horizontal stripes",
    }
}

/// A length near the first sheet, and its σ across and along the line of sight, mm: the worst of the middle and a quarter of
/// the sheet beside, before and behind it, as the sheet pins what lies at its own place. `None` for rigs that are too unsure
/// for a first-order σ to mean anything.
pub(super) fn lengths(rig: &Rig, axis: Axis) -> Option<(f64, [f64; 2])> {
    if rig.quality.as_ref()?.verdict > Verdict::Fair {
        return None;
    }
    let view = rig.views.first()?;
    let (w, h) = (view.size.width_mm, view.size.height_mm);
    let middle = view.camera_from_sheet.transform(&Point3::new(w / 2.0, h / 2.0, 0.0));
    // As long as things are that one measures there: at most half of the sheet, in round numbers.
    let length = [1000.0, 100.0, 10.0].into_iter().find(|l| *l <= w.max(h) / 2.0)?;
    let along = middle.coords.try_normalize(0.0)?;
    let across = Vector3::y().cross(&along).try_normalize(0.0)?;
    let upright = along.cross(&across);
    let aside = w.max(h) / 4.0;
    let sigma = |at: Point3<f64>, direction: Vector3<f64>| {
        let step = direction * (length / 2.0);
        let found = length_sigma(rig, axis, Match::DEFAULT_SIGMA_PX, [at - step, at + step]).ok()??;
        Some(found.total_mm())
    };
    let worst = |directions: &[Vector3<f64>]| {
        let offsets = [Vector3::zeros(), across * aside, -across * aside, along * aside, -along * aside];
        // Places that are not lit say nothing.
        let all = offsets
            .iter()
            .flat_map(|o| directions.iter().map(move |d| (*o, *d)))
            .filter_map(|(o, d)| sigma(middle + o, d));
        all.reduce(f64::max)
    };
    Some((length, [worst(&[across, upright])?, worst(&[along])?]))
}

#[cfg(test)]
mod tests {
    use slcal_core::geometry::{Distortion, Intrinsics};

    use super::*;

    #[test]
    fn rows_are_tried_from_the_middle_outwards_up_to_both_edges() {
        let lens = Intrinsics { fx: 500.0, fy: 400.0, cx: 320.0, cy: 100.0, skew: 0.0 };
        let model = Camera { width: 640, height: 480, intrinsics: lens, distortion: Distortion::default() };
        let found = slopes(&model);
        let row = |i: usize| found[i] * 400.0 + 100.0;
        assert_eq!(found.len(), LAYERS);
        assert!(
            (row(0) - 239.5).abs() < 1e-9 && (row(1) - 224.5).abs() < 1e-9 && (row(2) - 254.5).abs() < 1e-9
        );
        assert!((row(LAYERS - 2) + 0.5).abs() < 1e-9 && (row(LAYERS - 1) - 479.5).abs() < 1e-9);
    }
}
