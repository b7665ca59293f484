//! What the user may ask of a calibration.

use std::fmt;
use std::str::FromStr;

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::geometry::{Camera, FILM_DIAGONAL_MM};
use crate::named::{named, unnamed};

/// Fewest views in which the projector's distortion can be told from its principal point and from the camera's lens.
pub(crate) const VIEWS_FOR_PROJECTOR_DISTORTION: usize = 3;

/// What is known about a principal point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PrincipalPointRule {
    /// The image's centre, uncertain by [`CalibrateConfig::principal_point_sigma`] of the width along both axes.
    Prior,
    /// Exactly the image's centre.
    Centre,
    /// Unknown; only several well-spread views determine it.
    Free,
    /// Exactly this pixel.
    Exact(f64, f64),
    /// The horizontal centre as in [`Prior`](Self::Prior), the vertical one unknown (1σ of four times the panel's
    /// height): a projector with lens shift.
    Shift,
}

impl PrincipalPointRule {
    /// The names of the rules; a pixel has none.
    pub const NAMES: &'static [&'static str] = &["shift", "prior", "centre", "free"];

    /// Where the principal point of a device of width and height `size` is expected before anything was photographed, px:
    /// the stated one, the lower edge's middle where lens shift is expected, else the centre.
    #[must_use]
    pub fn expected(self, [width, height]: [u32; 2]) -> Point2<f64> {
        let centre = Camera::image_centre(width, height);
        match self {
            Self::Exact(x, y) => Point2::new(x, y),
            Self::Shift => Point2::new(centre.x, f64::from(height) - 0.5),
            Self::Prior | Self::Centre | Self::Free => centre,
        }
    }
}

impl fmt::Display for PrincipalPointRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shift => f.pad("shift"),
            Self::Prior => f.pad("prior"),
            Self::Centre => f.pad("centre"),
            Self::Free => f.pad("free"),
            Self::Exact(x, y) => write!(f, "{x},{y}"),
        }
    }
}

impl FromStr for PrincipalPointRule {
    type Err = Error;

    /// `shift`, `prior`, `centre`, `free`, or a pixel as `X,Y`.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists these.
    fn from_str(text: &str) -> Result<Self> {
        let number = |t: &str| t.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        Ok(match text.to_ascii_lowercase().as_str() {
            "shift" => Self::Shift,
            "prior" => Self::Prior,
            "centre" | "center" => Self::Centre,
            "free" => Self::Free,
            _ => {
                let point = text.split_once(',').and_then(|(x, y)| number(x).zip(number(y)));
                let wrong = || unnamed("principal point", Self::NAMES, " or X,Y in pixels", text);
                let (x, y) = point.ok_or_else(wrong)?;
                Self::Exact(x, y)
            }
        })
    }
}

/// What is known about the camera's focal length beforehand, as from a photograph's EXIF tags.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FocalPrior {
    /// The expected focal length, px.
    pub focal_px: f64,
    /// 1σ of it as a share of the focal length (of ln f).
    pub sigma_share: f64,
}

impl FocalPrior {
    /// From the focal length as its 35 mm equivalent (the EXIF tag `FocalLengthIn35mmFilm`), mm, for an uncropped image of
    /// this width and height: the angle of view over the diagonal is that of 36×24 mm film.
    ///
    /// σ is 5 % and what rounding to whole millimetres adds: some cameras mean the width instead of the diagonal (4 % for an
    /// image of 4:3), lenses focused at arm's length reach a few per cent further than their name, and makers round.
    #[must_use]
    pub fn from_35mm_equivalent(equivalent_mm: f64, [width, height]: [u32; 2]) -> Self {
        const MEANING: f64 = 0.05;
        let rounding = 1.0 / (12_f64.sqrt() * equivalent_mm);
        Self {
            focal_px: equivalent_mm / FILM_DIAGONAL_MM * f64::from(width).hypot(f64::from(height)),
            sigma_share: MEANING.hypot(rounding),
        }
    }
}

/// Which estimator to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Maximum likelihood of everything that was seen, with priors.
    #[default]
    Ml,
    /// The two vanishing points of R. Orghidan et al., "Structured light self-calibration with vanishing points",
    /// Machine Vision and Applications 25:489-500 (2014), for comparison and teaching.
    TwoVp,
}

named!(Method, "method", { Ml => "ml", TwoVp => "two-vp" });

/// Which distortion coefficients of a device are estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DistortionModel {
    /// k1 and k2 when they lower the residuals by more than chance would, else none.
    #[default]
    Auto,
    /// None: a pinhole.
    None,
    /// k1.
    K1,
    /// k1 and k2.
    K1K2,
    /// k1, k2, p1, p2, k3.
    Full,
}

named!(DistortionModel, "distortion", {
    Auto => "auto",
    None => "none",
    K1 => "k1",
    K1K2 => "k1k2",
    Full => "full",
});

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
    /// point and the camera's own distortion, so that coefficients ask for three photographs or more; `Auto` estimates
    /// none with fewer. Ignored without a projector; [`Method::TwoVp`] refuses it as for the camera.
    pub projector_distortion: DistortionModel,
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
    /// 1σ of k1 and of k2 when distortion is estimated; default 0.1. That of p1, p2 and k3 is 0.01.
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
    fn the_35_mm_equivalent_spans_the_diagonal() {
        // 36x24 at 100 px per mm: 50 mm are 5000 px.
        let prior = FocalPrior::from_35mm_equivalent(50.0, [3600, 2400]);
        assert!((prior.focal_px - 5000.0).abs() < 1e-9);
        assert!((0.05..0.051).contains(&prior.sigma_share));
        assert!(FocalPrior::from_35mm_equivalent(4.0, [3600, 2400]).sigma_share > 0.08);
    }

    #[test]
    fn principal_points_are_expected_where_the_rule_says() {
        let expected = |rule: PrincipalPointRule| rule.expected([1024, 768]);
        assert_eq!(expected(PrincipalPointRule::Prior), Point2::new(511.5, 383.5));
        assert_eq!(expected(PrincipalPointRule::Shift), Point2::new(511.5, 767.5));
        assert_eq!(expected(PrincipalPointRule::Exact(7.0, -9.0)), Point2::new(7.0, -9.0));
    }

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
