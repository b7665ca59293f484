//! What σ a point would have that is not there yet: how sure a rig is over its working volume.

use nalgebra::{Point2, Point3};

use super::triangulate::{TriangulateConfig, Triangulator};
use crate::cloud::PointCloud;
use crate::error::{Error, Result};
use crate::geometry::{Camera, Pose};
use crate::matches::{Match, Matches};
use crate::pattern::Axis;
use crate::rig::Rig;

/// 1σ of a point along the camera's ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedSigma {
    /// In all, mm: noise of the match and what is not known exactly of the rig. Without a covariance of the rig, noise alone.
    pub sigma_mm: f64,
    /// The part of it that differs from point to point, mm.
    pub noise_mm: f64,
}

/// Foretells the σ of points by making a match for each and triangulating it: what is told is what reconstruction says.
#[derive(Debug, Clone)]
pub struct SigmaForecast {
    triangulator: Triangulator,
    camera: Camera,
    projector: Camera,
    projector_from_camera: Pose,
    axis: Axis,
    one: Matches,
    cloud: PointCloud,
}

impl SigmaForecast {
    /// For slits along `axis`, whose matches have a noise of `match_sigma_px` camera px (1σ).
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig without a projector, or a noise that is negative or not finite.
    pub fn new(rig: &Rig, axis: Axis, match_sigma_px: f64) -> Result<Self> {
        if !(match_sigma_px.is_finite() && match_sigma_px >= 0.0) {
            return Err(Error::invalid("the noise of matches", "zero or more pixels", match_sigma_px));
        }
        let triangulator = Triangulator::new(rig, TriangulateConfig::default())?;
        let (Some(projector), Some(stereo)) = (rig.projector, rig.stereo) else {
            return Err(Error::invalid("rig", "a calibrated projector", "a rig that holds the camera alone"));
        };
        let one = Match {
            camera: Point2::origin(),
            projector_column: None,
            projector_row: None,
            slit: None,
            confidence: 1.0,
            sigma_px: match_sigma_px,
            color: [0; 3],
        };
        Ok(Self {
            triangulator,
            camera: rig.camera.model,
            projector: projector.model,
            projector_from_camera: stereo.projector_from_camera,
            axis,
            one: Matches { items: vec![one] },
            cloud: PointCloud::default(),
        })
    }

    /// 1σ of a point at `depth_mm` (along the optical axis) behind a camera pixel, on a surface at constant depth; `None`
    /// where the projector does not light it or its light cannot be told from its neighbours'.
    pub fn at(&mut self, pixel: Point2<f64>, depth_mm: f64) -> Option<ExpectedSigma> {
        let bearing = self.camera.bearing(pixel)?;
        let point = Point3::from(bearing * depth_mm);
        let lit = self.projector.project(&self.projector_from_camera.transform(&point))?;
        let one = self.one.items.first_mut()?;
        one.camera = pixel;
        (one.projector_column, one.projector_row) = match self.axis {
            Axis::Columns => (Some(lit.x), None),
            Axis::Rows => (None, Some(lit.y)),
        };
        let [w, h] = [self.projector.width, self.projector.height].map(f64::from);
        if !((-0.5..=w - 0.5).contains(&lit.x) && (-0.5..=h - 0.5).contains(&lit.y)) {
            return None;
        }
        self.triangulator.triangulate(&self.one, &mut self.cloud);
        let point = self.cloud.points.first()?;
        Some(ExpectedSigma { sigma_mm: point.sigma_mm, noise_mm: point.noise_mm })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::tests::scene::{observe, pose, rig, rng, size, with_edges};
    use crate::calibrate::{CalibrateConfig, calibrate_observations};

    fn calibrated() -> Rig {
        let truth = rig(700.0, vec![pose(25.0, 28.0)]);
        let mut rng = rng(3);
        let seen = observe(&truth, 0.1, 0.1, &mut rng);
        let seen = with_edges(seen, &truth, 40, 0.1, &mut rng);
        calibrate_observations(&seen, &CalibrateConfig::default()).unwrap().rig
    }

    #[test]
    fn the_middle_of_the_sheet_has_the_sigma_that_the_calibration_expects() {
        let rig = calibrated();
        let view = &rig.views[0];
        let middle = Point3::new(size().width_mm / 2.0, size().height_mm / 2.0, 0.0);
        let middle = view.camera_from_sheet.transform(&middle);
        let pixel = rig.camera.model.project(&middle).unwrap();
        let found = SigmaForecast::new(&rig, Axis::Columns, 0.1).unwrap().at(pixel, middle.z).unwrap();
        let expected = rig.quality.unwrap().expected_point_sigma_mm.unwrap();
        assert!((found.sigma_mm / expected - 1.0).abs() < 0.01, "{} {expected}", found.sigma_mm);
    }

    #[test]
    fn noise_grows_with_the_square_of_the_distance() {
        // Side by side and looking the same way: σ_z = z² σ_px / (f b), along the ray through the middle.
        let mut rig = calibrated();
        rig.covariance = None;
        let mut projector = rig.projector.unwrap();
        projector.model = rig.camera.model;
        rig.projector = Some(projector);
        let between = Pose { translation: nalgebra::Vector3::new(-200.0, 0.0, 0.0), ..Pose::identity() };
        rig.stereo.as_mut().unwrap().projector_from_camera = between;
        let k = rig.camera.model.intrinsics;
        let mut forecast = SigmaForecast::new(&rig, Axis::Columns, 0.2).unwrap();
        for z in [800.0, 1600.0] {
            let found = forecast.at(k.principal_point(), z).unwrap();
            let expected = z * z * 0.2 / (k.fx * 200.0);
            assert!((found.noise_mm / expected - 1.0).abs() < 1e-9 && found.sigma_mm == found.noise_mm);
        }
        // Beside the panel's light, and behind the camera.
        assert_eq!(forecast.at(Point2::new(1279.0, 480.0), 100.0), None);
        assert_eq!(forecast.at(k.principal_point(), -800.0), None);
        assert_eq!(forecast.at(k.principal_point(), f64::NAN), None);
    }

    #[test]
    fn a_camera_alone_is_refused() {
        let alone = Rig { projector: None, stereo: None, ..calibrated() };
        assert!(SigmaForecast::new(&alone, Axis::Columns, 0.1).is_err());
        assert!(SigmaForecast::new(&calibrated(), Axis::Columns, f64::NAN).is_err());
    }
}
