//! The expected uncertainty of points and lengths in the working volume: what is visible to the camera and lit by the projector.

use nalgebra::{Point2, Point3, Vector3};
use slcal_core::geometry::Camera;
use slcal_core::pattern::Axis;
use slcal_core::reconstruct::{ExpectedSigma, ExpectedUncertainty, length_sigma};
use slcal_core::{Match, Rig, Verdict, View};

/// Image rows that are tried for a place seen from above: an odd number, so that the middle is one of them, and up to both edges.
const LAYERS: usize = 33;
/// Patterns have vertical stripes by default. Horizontal ones are reported where their σ is below this share.
const CLEARLY_BETTER: f64 = 0.5;

/// The place in the image at which the working distance is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Sheet,
    Image,
    Lit,
}

/// A place in the working volume and the σ that is expected there.
pub(crate) struct WorkingVolume {
    /// The direction of slits with the smaller σ there.
    pub(crate) axis: Axis,
    uncertainty: ExpectedUncertainty,
    /// Where in the image.
    pixel: Point2<f64>,
    place: Place,
    /// The depth there.
    pub(crate) distance_mm: f64,
    /// Whether that is the sheet's.
    pub(crate) of_sheet: bool,
    /// Whether the rig's share of σ is known.
    pub(crate) knows_rig: bool,
    pub(crate) sigma: ExpectedSigma,
}

/// The middle of the first sheet, or of the image some baselines away, or else any place that is lit; with the slits that give the
/// smaller σ. `None` where nothing is lit.
pub(crate) fn working_volume(rig: &Rig) -> slcal_core::Result<Option<WorkingVolume>> {
    let model = &rig.camera.model;
    let middle = rig.views.first().map(sheet_centre);
    let centre = Camera::image_centre(model.width, model.height);
    let (depths, of_sheet) = match middle {
        Some(m) => (vec![m.z], model.project(&m)),
        // Devices side by side overlap from some distance on.
        None => ([3.0, 6.0, 12.0, 24.0].map(|times| times * rig.baseline_mm().unwrap_or(0.0)).to_vec(), None),
    };
    let mut places = vec![(Place::Image, centre)];
    places.splice(0..0, of_sheet.map(|p| (Place::Sheet, p)));
    places.extend(grid(model).map(|p| (Place::Lit, p)));
    let mut uncertainties = Vec::new();
    for axis in [Axis::Columns, Axis::Rows] {
        uncertainties.push((axis, ExpectedUncertainty::new(rig, axis, Match::DEFAULT_SIGMA_PX)?));
    }
    for ((place, pixel), depth) in places.iter().flat_map(|p| depths.iter().map(move |d| (*p, *d))) {
        let expected: Vec<_> = uncertainties
            .iter_mut()
            .enumerate()
            .filter_map(|(i, (_, f))| Some((i, f.at(pixel, depth)?)))
            .collect();
        let clearly = |a: &ExpectedSigma, b: &ExpectedSigma| b.sigma_mm < CLEARLY_BETTER * a.sigma_mm;
        let best = expected.into_iter().reduce(|a, b| if clearly(&a.1, &b.1) { b } else { a });
        if let Some((i, sigma)) = best {
            let (axis, uncertainty) = uncertainties.swap_remove(i);
            let (of_sheet, knows_rig) = (middle.is_some(), rig.covariance.is_some());
            return Ok(Some(WorkingVolume {
                axis,
                uncertainty,
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
pub(crate) fn slopes(model: &Camera) -> Vec<f64> {
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
    let [w, h] = model.size().map(f64::from);
    let at = |i: u32, length: f64| (f64::from(i) + 0.5) / f64::from(SIDE) * length - 0.5;
    (0..SIDE * SIDE).map(move |i| Point2::new(at(i % SIDE, w), at(i / SIDE, h)))
}

impl WorkingVolume {
    /// The share of σ that is common to all points, mm.
    pub(crate) fn rig_mm(&self) -> f64 {
        (self.sigma.sigma_mm.powi(2) - self.sigma.noise_mm.powi(2)).max(0.0).sqrt()
    }

    /// Where in the image that is.
    pub(crate) fn place_in_words(&self) -> &'static str {
        match self.place {
            Place::Sheet => "the middle of the sheet",
            Place::Image => "the middle of the image",
            Place::Lit => "a place that is lit",
        }
    }

    /// σ along the line of sight through that place.
    pub(crate) fn at_depth(&mut self, depth_mm: f64) -> Option<ExpectedSigma> {
        self.uncertainty.at(self.pixel, depth_mm)
    }

    /// σ at a place seen from above, whatever its height: at the row of the image nearest to the middle that is lit there.
    pub(crate) fn seen_from_above(
        &mut self,
        model: &Camera,
        slopes: &[f64],
        x: f64,
        z: f64,
    ) -> Option<ExpectedSigma> {
        slopes.iter().find_map(|slope| {
            let pixel = model.project(&Point3::new(x, slope * z, z))?;
            if model.holds(pixel) { self.uncertainty.at(pixel, z) } else { None }
        })
    }
}

/// The direction of slits in words.
pub(crate) fn stripes(axis: Axis) -> &'static str {
    match axis {
        Axis::Columns => "vertical stripes",
        Axis::Rows => "horizontal stripes",
    }
}

/// A length near the first sheet, and its σ across and along the line of sight, mm: the largest over the middle of the sheet and
/// places a quarter of the sheet beside, before and behind it, since calibration determines lengths at the sheet itself best. `None`
/// for verdicts worse than fair, for which a first-order σ means nothing.
pub(crate) fn lengths(rig: &Rig, axis: Axis) -> Option<(f64, [f64; 2])> {
    if rig.quality.as_ref()?.verdict > Verdict::Fair {
        return None;
    }
    let view = rig.views.first()?;
    let (w, h) = (view.size.width_mm, view.size.height_mm);
    let middle = sheet_centre(view);
    // The size of typical objects: at most half of the sheet, in round numbers.
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
        // Places that are not lit are skipped.
        let all = offsets
            .iter()
            .flat_map(|o| directions.iter().map(move |d| (*o, *d)))
            .filter_map(|(o, d)| sigma(middle + o, d));
        all.reduce(f64::max)
    };
    Some((length, [worst(&[across, upright])?, worst(&[along])?]))
}

/// Mean distance of the sheets' centres from the camera, mm.
pub(crate) fn sheet_distance_mm(rig: &Rig) -> f64 {
    rig.views.iter().map(view_distance_mm).sum::<f64>() / rig.views.len().max(1) as f64
}

/// Distance of a sheet's centre from the camera, mm.
pub(crate) fn view_distance_mm(view: &View) -> f64 {
    sheet_centre(view).coords.norm()
}

/// A sheet's centre in the camera's frame.
fn sheet_centre(view: &View) -> Point3<f64> {
    view.camera_from_sheet.lift(view.size.centre())
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
