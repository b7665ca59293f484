//! Expected σ of points over a rig's working volume.

use nalgebra::{Point2, Point3};

use super::synthetic_match::SyntheticMatches;
use super::triangulate::Triangulator;
use crate::cloud::PointCloud;
use crate::error::Result;
use crate::matches::Matches;
use crate::pattern::Axis;
use crate::rig::Rig;

/// 1σ of a point along the camera's ray.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ExpectedSigma {
    /// In all, mm: noise of the match and what is not known exactly of the rig. Without a covariance of the rig, noise alone.
    pub sigma_mm: f64,
    /// The part of it that differs from point to point, mm.
    pub noise_mm: f64,
}

/// Predicts the σ of points by triangulating a synthetic match for each, as reconstruction does.
#[derive(Debug, Clone)]
pub struct ExpectedUncertainty {
    synthetic: SyntheticMatches,
    triangulator: Triangulator,
    one: Matches,
    cloud: PointCloud,
}

impl ExpectedUncertainty {
    /// For slits along `axis`, whose matches have a noise of `match_sigma_px` camera px (1σ).
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a rig without a projector, or a noise that is negative or not finite.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::nalgebra::Point2;
    /// use slcal_core::pattern::Axis;
    /// use slcal_core::reconstruct::ExpectedUncertainty;
    ///
    /// # let rig = slcal_core::format::read_rig(&include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/truth_rig.json"))[..])?;
    /// let mut expected = ExpectedUncertainty::new(&rig, Axis::Columns, 0.1)?;
    /// let [near, far] = [900.0, 1100.0].map(|z| expected.at(Point2::new(640.0, 480.0), z).unwrap().noise_mm);
    /// assert!(far > near);
    /// # Ok::<(), slcal_core::Error>(())
    /// ```
    pub fn new(rig: &Rig, axis: Axis, match_sigma_px: f64) -> Result<Self> {
        let synthetic = SyntheticMatches::new(rig, axis, match_sigma_px)?;
        let triangulator = SyntheticMatches::triangulator(rig)?;
        Ok(Self { synthetic, triangulator, one: Matches::default(), cloud: PointCloud::default() })
    }

    /// 1σ of a point at `depth_mm` (along the optical axis) behind a camera pixel, on a surface at constant depth; `None`
    /// where the projector does not light it or its light cannot be distinguished from its neighbours'.
    pub fn at(&mut self, pixel: Point2<f64>, depth_mm: f64) -> Option<ExpectedSigma> {
        let point = Point3::from(self.synthetic.camera().bearing(pixel)? * depth_mm);
        self.one.items.clear();
        self.one.items.push(self.synthetic.seen(&point)?);
        self.triangulator.triangulate(&self.one, &mut self.cloud);
        let point = self.cloud.points.first()?;
        Some(ExpectedSigma { sigma_mm: point.sigma_mm, noise_mm: point.noise_mm })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::tests::scene::{calibrated, size};
    use crate::geometry::{Distortion, Intrinsics, Pose};

    #[test]
    fn the_middle_of_the_sheet_has_the_sigma_that_the_calibration_expects() {
        let rig = calibrated();
        let view = &rig.views[0];
        let middle = Point3::new(size().width_mm / 2.0, size().height_mm / 2.0, 0.0);
        let middle = view.camera_from_sheet.transform(&middle);
        let pixel = rig.camera.model.project(&middle).unwrap();
        let found = ExpectedUncertainty::new(&rig, Axis::Columns, 0.1).unwrap().at(pixel, middle.z).unwrap();
        let expected = rig.quality.unwrap().expected_point_sigma_mm.unwrap();
        assert!((found.sigma_mm / expected - 1.0).abs() < 0.01, "{} {expected}", found.sigma_mm);
    }

    #[test]
    fn noise_grows_with_the_square_of_the_distance() {
        // Side by side and looking the same way: σ_z = z² σ_px / (f b), along the ray through the middle.
        let mut rig = calibrated();
        rig.covariance = None;
        let mut projector = rig.projector.unwrap();
        projector.device.model = rig.camera.model;
        rig.projector = Some(projector);
        let between = Pose { translation: nalgebra::Vector3::new(-200.0, 0.0, 0.0), ..Pose::identity() };
        rig.projector.as_mut().unwrap().from_camera.pose = between;
        let k = rig.camera.model.intrinsics;
        let mut uncertainty = ExpectedUncertainty::new(&rig, Axis::Columns, 0.2).unwrap();
        for z in [800.0, 1600.0] {
            let found = uncertainty.at(k.principal_point(), z).unwrap();
            let expected = z * z * 0.2 / (k.fx * 200.0);
            assert!((found.noise_mm / expected - 1.0).abs() < 1e-9 && found.sigma_mm == found.noise_mm);
        }
        // Beside the panel's light, and behind the camera.
        assert_eq!(uncertainty.at(Point2::new(1279.0, 480.0), 100.0), None);
        assert_eq!(uncertainty.at(k.principal_point(), -800.0), None);
        assert_eq!(uncertainty.at(k.principal_point(), f64::NAN), None);
    }

    #[test]
    fn a_whole_coordinate_is_no_scanline() {
        // Light from above: rows of the panel tell depths, and move along the image's columns alone. A pixel with a whole
        // column and a row between two would pass for a stripe that was measured across its column.
        let mut rig = calibrated();
        let k = rig.camera.model.intrinsics;
        rig.camera.model.intrinsics = Intrinsics::square(k.fx, k.principal_point());
        rig.camera.model.distortion = Distortion::NONE;
        let mut projector = rig.projector.unwrap();
        projector.device.model = rig.camera.model;
        rig.projector = Some(projector);
        rig.covariance = None;
        let between = Pose { translation: nalgebra::Vector3::new(0.0, 200.0, 0.0), ..Pose::identity() };
        rig.projector.as_mut().unwrap().from_camera.pose = between;
        let expected = 1e6 * 0.1 / (rig.camera.model.intrinsics.fx * 200.0);
        let mut uncertainty = ExpectedUncertainty::new(&rig, Axis::Rows, 0.1).unwrap();
        let k = rig.camera.model.intrinsics;
        for pixel in [Point2::new(k.cx.round(), 400.0), Point2::new(640.3, 400.0), Point2::new(640.0, 400.4)]
        {
            let found = uncertainty.at(pixel, 1000.0).unwrap().noise_mm;
            let ray = rig.camera.model.bearing(pixel).unwrap().norm();
            assert!((found / (expected * ray) - 1.0).abs() < 1e-9, "{pixel}: {found} {expected}");
        }
    }

    #[test]
    fn a_camera_alone_is_refused() {
        let alone = Rig { projector: None, ..calibrated() };
        assert!(ExpectedUncertainty::new(&alone, Axis::Columns, 0.1).is_err());
        assert!(ExpectedUncertainty::new(&calibrated(), Axis::Columns, f64::NAN).is_err());
    }
}
