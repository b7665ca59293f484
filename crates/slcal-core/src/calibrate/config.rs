//! What the user may ask of a calibration.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::estimate::Flatness;
use crate::estimate::assumptions::{
    Assumptions, DistortionModel, FocalPrior, LensAssumptions, PixelAspect, PrincipalPointRule, shift_axis,
};
use crate::geometry::Camera;
use crate::named::named;
use crate::parameter::LensParameter;

/// Fewest views that separate the projector's distortion from its principal point and from the camera's lens.
pub(crate) const VIEWS_FOR_PROJECTOR_DISTORTION: usize = 3;

/// Which estimator to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Method {
    /// Maximum likelihood of everything that was seen, with priors.
    #[default]
    Ml,
    /// The two vanishing points of R. Orghidan et al., "Structured light self-calibration with vanishing points",
    /// Machine Vision and Applications 25:489-500 (2014), for comparison and teaching.
    TwoVp,
}

named!(Method, "method", { Ml => "ml", TwoVp => "two-vp" });

/// Parameters of [`calibrate_observations`](crate::calibrate::calibrate_observations).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CalibrateConfig {
    /// The camera's principal point; default [`PrincipalPointRule::Prior`].
    pub camera_pp: PrincipalPointRule,
    /// The projector's principal point; default [`PrincipalPointRule::Shift`]. [`Method::TwoVp`], which needs an exact
    /// one, takes the centre for `Prior` and `Shift` of either device and refuses `Free`.
    pub projector_pp: PrincipalPointRule,
    /// The estimator; default [`Method::Ml`].
    pub method: Method,
    /// Distortion of the camera; default [`DistortionModel::Auto`]. Ignored when the camera is known;
    /// [`Method::TwoVp`], which knows none, refuses anything but `Auto` and `None`.
    pub distortion: DistortionModel,
    /// Distortion of the projector; default [`DistortionModel::Auto`]. It bends the same residuals as a wrong principal
    /// point and the camera's own distortion, so that a model given by name asks for three photographs or
    /// more. Ignored without a projector; [`Method::TwoVp`] refuses it as for the camera.
    pub projector_distortion: DistortionModel,
    /// Shape of the projector's pixels; default [`PixelAspect::Auto`]. [`Method::TwoVp`] takes them for square.
    pub projector_pixel_aspect: PixelAspect,
    /// How flat the sheet is; default [`Flatness::Paper`]. [`Method::TwoVp`] takes it for flat.
    pub flatness: Flatness,
    /// The camera's focal length as it is expected, uncertain; default none. Ignored when the camera is known;
    /// [`Method::TwoVp`], which knows no priors, refuses one.
    pub focal_prior: Option<FocalPrior>,
    /// A camera whose intrinsics and distortion are known and held fixed; default none.
    pub known_camera: Option<Camera>,
    /// Return a rig with the verdict `degenerate` instead of an error; default `false`. An imaginary focal length stays
    /// an error.
    pub allow_degenerate: bool,
    /// 1σ of a principal point under `Prior`, as a share of the image's width; default 0.02 (published consumer cameras
    /// lie 0.5–3.5 % off the centre).
    pub principal_point_sigma: f64,
    /// 1σ of k1 and of k2 of a model that is given by name; default 0.1. That of p1, p2 and k3 is 0.01.
    pub distortion_sigma: f64,
}

impl Default for CalibrateConfig {
    fn default() -> Self {
        Self {
            camera_pp: PrincipalPointRule::Prior,
            projector_pp: PrincipalPointRule::Shift,
            method: Method::Ml,
            distortion: DistortionModel::Auto,
            projector_distortion: DistortionModel::Auto,
            projector_pixel_aspect: PixelAspect::Auto,
            flatness: Flatness::Paper,
            focal_prior: None,
            known_camera: None,
            allow_degenerate: false,
            principal_point_sigma: 0.02,
            distortion_sigma: 0.1,
        }
    }
}

impl CalibrateConfig {
    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`] for numbers that are not finite, widths that are not positive, or what the method cannot do.
    pub fn validate(&self) -> Result<()> {
        for (name, rule) in [("camera_pp", self.camera_pp), ("projector_pp", self.projector_pp)] {
            if let PrincipalPointRule::Exact(x, y) = rule
                && !(x.is_finite() && y.is_finite())
            {
                return Err(Error::invalid(name, "two finite pixel coordinates", format!("{x},{y}")));
            }
        }
        for (name, sigma) in [
            ("principal_point_sigma", self.principal_point_sigma),
            ("distortion_sigma", self.distortion_sigma),
        ] {
            if !(sigma.is_finite() && sigma > 0.0) {
                return Err(Error::invalid(name, "a positive number", sigma));
            }
        }
        if let PixelAspect::Ratio(ratio) = self.projector_pixel_aspect
            && !(ratio.is_finite() && ratio > 0.0)
        {
            return Err(Error::invalid("projector_pixel_aspect", "a ratio above zero", ratio));
        }
        if let Flatness::Sigma(mm) = self.flatness
            && !(mm.is_finite() && mm >= 0.0)
        {
            return Err(Error::invalid("flatness", "a length that is not negative", format!("{mm} mm")));
        }
        if let Some(FocalPrior { focal_px, sigma_share }) = self.focal_prior
            && !(focal_px.is_finite() && focal_px > 0.0 && sigma_share.is_finite() && sigma_share > 0.0)
        {
            let found = format!("{focal_px} px, σ {sigma_share}");
            return Err(Error::invalid("focal_prior", "a positive focal length and a positive σ", found));
        }
        if self.method == Method::TwoVp {
            self.validate_two_vp()?;
        }
        if let Some(camera) = &self.known_camera {
            let k = &camera.intrinsics;
            let finite = camera.distortion.to_array().iter().all(|x| x.is_finite());
            if !(finite && k.matrix().iter().all(|x| x.is_finite()) && k.fx > 0.0 && k.fy > 0.0) {
                return Err(Error::invalid(
                    "known_camera",
                    "positive focal lengths and finite coefficients",
                    format!("{:?}", k.matrix().as_slice()),
                ));
            }
        }
        Ok(())
    }
}

impl CalibrateConfig {
    /// The axis along which a shift of the projector's lens is expected, and the one across.
    pub(crate) fn shift_axes(&self, panel: [u32; 2]) -> [LensParameter; 2] {
        let along = shift_axis(panel, self.projector_pixel_aspect.of_projector(panel));
        let across = if along == LensParameter::Cy { LensParameter::Cx } else { LensParameter::Cy };
        [along, across]
    }

    /// What the estimator takes for known.
    pub(crate) fn assumptions(&self) -> Assumptions {
        let camera = LensAssumptions {
            known: self.known_camera.is_some(),
            principal_point: self.camera_pp,
            distortion: self.distortion,
            focal: self.focal_prior,
            pixel_aspect: PixelAspect::Auto,
        };
        let projector = LensAssumptions {
            known: false,
            principal_point: self.projector_pp,
            distortion: self.projector_distortion,
            focal: None,
            pixel_aspect: self.projector_pixel_aspect,
        };
        Assumptions {
            lenses: [camera, projector],
            principal_point_sigma: self.principal_point_sigma,
            distortion_sigma: self.distortion_sigma,
            flatness: self.flatness,
        }
    }

    /// Checks the values for this many photographs, with a projected pattern or without.
    ///
    /// # Errors
    /// As [`validate`](Self::validate), and [`Error::Invalid`] for coefficients of the projector's distortion with fewer than
    /// three photographs.
    pub fn validate_for(&self, photographs: usize, with_projector: bool) -> Result<()> {
        self.validate()?;
        let asked = !matches!(self.projector_distortion, DistortionModel::Auto | DistortionModel::None);
        if asked && with_projector && photographs < VIEWS_FOR_PROJECTOR_DISTORTION {
            return Err(Error::invalid(
                "projector distortion",
                "at least three photographs of the sheet in different poses (or auto, or none)",
                photographs,
            ));
        }
        Ok(())
    }

    /// Refuses what that method cannot do, rather than leaving it out silently.
    fn validate_two_vp(&self) -> Result<()> {
        let unknown = self.known_camera.is_none();
        let free = PrincipalPointRule::Free;
        if self.camera_pp == free && unknown || self.projector_pp == free {
            return Err(Error::invalid(
                "principal point for the two-vp method",
                "an exact one (the centre, or X,Y): two vanishing points determine the focal length alone",
                "a free one",
            ));
        }
        let asked = |model| !matches!(model, DistortionModel::Auto | DistortionModel::None);
        if unknown && asked(self.distortion) || asked(self.projector_distortion) {
            return Err(Error::invalid(
                "distortion for the two-vp method",
                "auto or none, as the method takes lenses for undistorted (or a known camera)",
                "coefficients to estimate",
            ));
        }
        if unknown && self.focal_prior.is_some() {
            return Err(Error::invalid(
                "focal length for the two-vp method",
                "none beforehand, as the method computes it from the vanishing points alone",
                "an expected one",
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid_and_nonsense_is_not() {
        assert!(CalibrateConfig::default().validate().is_ok());
        let d = CalibrateConfig::default;
        assert!(CalibrateConfig { principal_point_sigma: 0.0, ..d() }.validate().is_err());
        assert!(CalibrateConfig { distortion_sigma: f64::NAN, ..d() }.validate().is_err());
        let prior = |focal_px, sigma_share| Some(FocalPrior { focal_px, sigma_share });
        assert!(CalibrateConfig { focal_prior: prior(1500.0, 0.05), ..d() }.validate().is_ok());
        assert!(CalibrateConfig { focal_prior: prior(-1.0, 0.05), ..d() }.validate().is_err());
        assert!(CalibrateConfig { focal_prior: prior(1500.0, 0.0), ..d() }.validate().is_err());
        let nan = PrincipalPointRule::Exact(f64::NAN, 1.0);
        assert!(CalibrateConfig { camera_pp: nan, ..d() }.validate().is_err());
    }
}
