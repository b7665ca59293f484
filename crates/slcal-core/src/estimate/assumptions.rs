//! What the estimator takes for known: which parameters it holds fixed, and where and how closely it expects the others.

use std::fmt;
use std::str::FromStr;

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use super::flatness::Flatness;
use crate::error::{Error, Result};
use crate::geometry::{Camera, FILM_DIAGONAL_MM};
use crate::named::{named, unnamed};
use crate::parameter::LensParameter;

/// Which of the two devices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lens {
    Camera,
    Projector,
}

impl Lens {
    pub(crate) const ALL: [Self; 2] = [Self::Camera, Self::Projector];

    pub(crate) fn name(self) -> &'static str {
        ["camera", "projector"][self as usize]
    }
}

/// 1σ of a principal point that is free, in widths: no information, but never a singular matrix.
const FREE_WIDTHS: f64 = 10.0;
/// 1σ of the vertical principal point of a lens-shifted projector, in heights around the centre; published ones lie 0.5
/// to 1.3 heights off, and a narrower prior would pull them inwards.
const SHIFT_HEIGHTS: f64 = 4.0;
/// 1σ of the tangential coefficients and of k3 of a model that is given by name; real lenses stay below.
const TANGENTIAL_SIGMA: f64 = 0.01;
/// 1σ of k1, k2, p1, p2 and k3 that ordinary lenses have, of camera and projector.
const ORDINARY_LENS: [[f64; 5]; 2] =
    [[0.2, 0.2, 0.000_7, 0.000_7, 0.1], [0.02, 0.02, 0.000_3, 0.000_3, 0.01]];
/// 1σ of fy/fx: pixels are square to this.
const SQUARE_SIGMA: f64 = 0.002;

/// What is known about a principal point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PrincipalPointRule {
    /// The image's centre, uncertain by [`CalibrateConfig::principal_point_sigma`](crate::CalibrateConfig::principal_point_sigma) of the width along both axes.
    Prior,
    /// Exactly the image's centre.
    Centre,
    /// Unknown; only several well-spread views determine it.
    Free,
    /// Exactly this pixel.
    Exact(f64, f64),
    /// The horizontal centre as in [`Prior`](Self::Prior), the vertical one unknown (1σ of four times the panel's
    /// height): a projector with lens shift. On a panel that stands upright, as that of a projector on its side, the two
    /// are exchanged.
    Shift,
}

impl PrincipalPointRule {
    /// The names of the rules; a pixel has none.
    pub const NAMES: &'static [&'static str] = &["shift", "prior", "centre", "free"];

    /// Whether the principal point is held fixed.
    pub(crate) fn is_exact(self) -> bool {
        matches!(self, Self::Centre | Self::Exact(..))
    }

    /// Where the estimate of the principal point of a device of this width and height starts, px: the stated one, else the
    /// centre. It is the mean of the prior, too.
    pub(crate) fn start(self, [width, height]: [u32; 2]) -> Point2<f64> {
        match self {
            Self::Exact(x, y) => Point2::new(x, y),
            _ => Camera::image_centre(width, height),
        }
    }

    /// Where the principal point of a device of width and height `size` is expected before anything was photographed, px:
    /// the stated one, the middle of the lower edge (of the right one of a panel that stands upright) where lens shift is
    /// expected, else the centre.
    #[must_use]
    pub fn expected(self, [width, height]: [u32; 2]) -> Point2<f64> {
        let centre = Camera::image_centre(width, height);
        let shifted = shift_axis([width, height], PixelAspect::Auto.of_projector([width, height]));
        match self {
            Self::Exact(x, y) => Point2::new(x, y),
            Self::Shift if shifted == LensParameter::Cx => Point2::new(f64::from(width) - 0.5, centre.y),
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

/// What is known about the shape of a projector's pixels: fy/fx, which is the width of a pixel over its height.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PixelAspect {
    /// 2 for the panels of diamond pixels, 912×1140 and 608×684, which are twice as dense along y; else 1. Uncertain by
    /// 0.2 % where the distortion is [`DistortionModel::Auto`].
    #[default]
    Auto,
    /// Exactly 1.
    Square,
    /// Exactly this: of a picture that is stretched over another panel, for instance.
    Ratio(f64),
}

/// Panels whose mirrors stand on their corners, in rows that are offset by half a mirror (Texas Instruments DLP4500, DLP3000).
const DIAMOND_PANELS: [[u32; 2]; 2] = [[912, 1140], [608, 684]];

impl PixelAspect {
    /// The names of the rules; a ratio has none.
    pub const NAMES: &'static [&'static str] = &["auto", "square"];

    /// The ratio that is expected of a projector of this width and height.
    #[must_use]
    pub fn of_projector(self, [width, height]: [u32; 2]) -> f64 {
        match self {
            Self::Auto if DIAMOND_PANELS.contains(&[width, height]) => 2.0,
            Self::Auto if DIAMOND_PANELS.contains(&[height, width]) => 0.5,
            Self::Auto | Self::Square => 1.0,
            Self::Ratio(ratio) => ratio,
        }
    }
}

impl fmt::Display for PixelAspect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.pad("auto"),
            Self::Square => f.pad("square"),
            Self::Ratio(ratio) => write!(f, "{ratio}"),
        }
    }
}

impl FromStr for PixelAspect {
    type Err = Error;

    /// `auto`, `square`, or a ratio above zero.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists these.
    fn from_str(text: &str) -> Result<Self> {
        Ok(match text.to_ascii_lowercase().as_str() {
            "auto" => Self::Auto,
            "square" => Self::Square,
            _ => {
                let ratio = text.trim().parse::<f64>().ok().filter(|r| r.is_finite() && *r > 0.0);
                Self::Ratio(
                    ratio.ok_or_else(|| {
                        unnamed("pixel aspect", Self::NAMES, " or a ratio above zero", text)
                    })?,
                )
            }
        })
    }
}

/// The axis along which a lens shift is expected: the shorter one of the panel, whose pixels are `aspect` times as wide as
/// high. A projector that lies on its side has an upright panel.
pub(crate) fn shift_axis([width, height]: [u32; 2], aspect: f64) -> LensParameter {
    if f64::from(width) < f64::from(height) / aspect { LensParameter::Cx } else { LensParameter::Cy }
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

/// Which distortion coefficients of a device are estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum DistortionModel {
    /// k1, k2, p1, p2, k3 and the ratio of fy to fx, all of them near what ordinary lenses have: 1σ of 0.2, 0.2, 0.0007, 0.0007, 0.1
    /// around zero for cameras, a tenth of it (0.0003 for p1 and p2) for projectors, and 0.2 % for the ratio. Those of the other models are
    /// uncertain by far more, and pixels are exactly square there.
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

/// What is known of one device before the estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LensAssumptions {
    /// Every parameter is held fixed.
    pub(crate) known: bool,
    pub(crate) principal_point: PrincipalPointRule,
    pub(crate) distortion: DistortionModel,
    pub(crate) focal: Option<FocalPrior>,
    pub(crate) pixel_aspect: PixelAspect,
}

/// What is known of both devices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Assumptions {
    /// Of camera and projector.
    pub(crate) lenses: [LensAssumptions; 2],
    /// 1σ of a principal point under [`PrincipalPointRule::Prior`], in widths.
    pub(crate) principal_point_sigma: f64,
    /// 1σ of k1 and of k2 of a model that is given by name.
    pub(crate) distortion_sigma: f64,
    /// How far sheets may bend.
    pub(crate) flatness: Flatness,
}

impl Assumptions {
    /// Whether a parameter is estimated, or else held fixed.
    pub(crate) fn estimates(&self, lens: Lens, parameter: LensParameter) -> bool {
        let of = &self.lenses[lens as usize];
        let coefficients = match of.distortion {
            DistortionModel::None => 0,
            DistortionModel::K1 => 1,
            DistortionModel::K1K2 => 2,
            DistortionModel::Full | DistortionModel::Auto => 5,
        };
        !of.known
            && match parameter {
                LensParameter::Focal => true,
                LensParameter::Cx | LensParameter::Cy => !of.principal_point.is_exact(),
                LensParameter::Aspect => {
                    of.distortion == DistortionModel::Auto && of.pixel_aspect == PixelAspect::Auto
                }
                coefficient => (coefficient as usize) < LensParameter::K1 as usize + coefficients,
            }
    }

    /// fy/fx that is expected of a device.
    pub(crate) fn aspect(&self, lens: Lens, size: [u32; 2]) -> f64 {
        match lens {
            Lens::Camera => 1.0,
            Lens::Projector => self.lenses[lens as usize].pixel_aspect.of_projector(size),
        }
    }

    /// Mean and 1σ of a parameter of a device of this width and height (focal length and aspect as logarithms); `None`
    /// where nothing is known.
    pub(crate) fn prior(
        &self,
        lens: Lens,
        parameter: LensParameter,
        [width, height]: [u32; 2],
    ) -> Option<(f64, f64)> {
        let of = &self.lenses[lens as usize];
        let centre = of.principal_point.start([width, height]);
        let aspect = self.aspect(lens, [width, height]);
        let shifted = shift_axis([width, height], aspect);
        let principal_point = |extent: u32, pixels_per_width: f64| match of.principal_point {
            PrincipalPointRule::Shift if parameter == shifted => SHIFT_HEIGHTS * f64::from(extent),
            PrincipalPointRule::Shift | PrincipalPointRule::Prior => {
                self.principal_point_sigma * pixels_per_width
            }
            _ => FREE_WIDTHS * pixels_per_width,
        };
        let width_px = f64::from(width);
        Some(match (parameter, of.principal_point) {
            (LensParameter::Focal, _) => of.focal.map(|f| (f.focal_px.ln(), f.sigma_share))?,
            (LensParameter::Cx, _) => (centre.x, principal_point(width, width_px)),
            // The same length on the panel is `aspect` times as many pixels along y.
            (LensParameter::Cy, _) => (centre.y, principal_point(height, width_px * aspect)),
            (LensParameter::Aspect, _) => (aspect.ln(), SQUARE_SIGMA),
            (coefficient, _) if of.distortion == DistortionModel::Auto => {
                (0.0, ORDINARY_LENS[lens as usize][coefficient as usize - LensParameter::K1 as usize])
            }
            (LensParameter::K1 | LensParameter::K2, _) => (0.0, self.distortion_sigma),
            (LensParameter::P1 | LensParameter::P2 | LensParameter::K3, _) => (0.0, TANGENTIAL_SIGMA),
        })
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
        assert_eq!(PrincipalPointRule::Shift.expected([768, 1024]), Point2::new(767.5, 511.5));
        // 912×1140 diamond pixels are wider than high together.
        assert_eq!(PrincipalPointRule::Shift.expected([912, 1140]), Point2::new(455.5, 1139.5));
    }

    #[test]
    fn diamond_pixels_are_known_by_their_panel() {
        let aspects = [[912, 1140], [1140, 912], [608, 684], [1024, 768]];
        assert_eq!(aspects.map(|panel| PixelAspect::Auto.of_projector(panel)), [2.0, 0.5, 2.0, 1.0]);
        assert_eq!(PixelAspect::Square.of_projector([912, 1140]), 1.0);
        let parsed = ["AUTO", "square", "1.2"].map(|t| t.parse::<PixelAspect>().unwrap());
        assert_eq!(parsed, [PixelAspect::Auto, PixelAspect::Square, PixelAspect::Ratio(1.2)]);
        assert!(["0", "-1", "wide", "nan"].into_iter().all(|t| t.parse::<PixelAspect>().is_err()));
    }
}
