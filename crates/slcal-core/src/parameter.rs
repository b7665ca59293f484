//! Names of the parameters that a calibration estimates.

use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

use crate::geometry::SheetBend;

/// A parameter of a camera or projector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LensParameter {
    /// Focal length, px.
    Focal,
    /// Principal point along x, px.
    Cx,
    /// Principal point along y, px.
    Cy,
    /// Radial distortion, r².
    K1,
    /// Radial distortion, r⁴.
    K2,
    /// Tangential distortion.
    P1,
    /// Tangential distortion.
    P2,
    /// Radial distortion, r⁶.
    K3,
    /// Height to width of a pixel's focal length, fy/fx (relative).
    Aspect,
}

impl LensParameter {
    /// All of them, in the order of the covariance.
    pub const ALL: [Self; 9] =
        [Self::Focal, Self::Cx, Self::Cy, Self::K1, Self::K2, Self::P1, Self::P2, Self::K3, Self::Aspect];

    /// The name in files, with its unit: `focal_px`, `k1`.
    #[must_use]
    pub fn name(self) -> &'static str {
        ["focal_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3", "aspect"][self as usize]
    }
}

/// A parameter of a pose `a_from_b`: a small rotation about a's axes (rad), or a translation along them (mm).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PoseParameter {
    /// Rotation about x.
    Rx,
    /// Rotation about y.
    Ry,
    /// Rotation about z.
    Rz,
    /// Translation along x.
    Tx,
    /// Translation along y.
    Ty,
    /// Translation along z.
    Tz,
}

impl PoseParameter {
    /// All of them, in the order of the covariance.
    pub const ALL: [Self; 6] = [Self::Rx, Self::Ry, Self::Rz, Self::Tx, Self::Ty, Self::Tz];

    /// The name in files, with its unit: `rx_rad`, `tx_mm`.
    #[must_use]
    pub fn name(self) -> &'static str {
        ["rx_rad", "ry_rad", "rz_rad", "tx_mm", "ty_mm", "tz_mm"][self as usize]
    }
}

/// A row of a rig's covariance. `Display` and `FromStr` use the names of rig files, such as `camera.focal_px`,
/// `projector_from_camera.rx_rad` or `views[0].tz_mm`.
///
/// # Examples
/// ```
/// use slcal_core::{LensParameter, Parameter};
///
/// let names: Vec<Parameter> = ["camera.focal_px", "views[0].tz_mm"].map(|n| n.parse().unwrap()).into();
/// assert_eq!(names[0], Parameter::Camera(LensParameter::Focal));
/// assert_eq!(names[1].to_string(), "views[0].tz_mm");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Of the camera.
    Camera(LensParameter),
    /// Of the projector.
    Projector(LensParameter),
    /// Of the transform between the devices.
    ProjectorFromCamera(PoseParameter),
    /// Of the sheet's pose in the camera frame in a view, counted from 0.
    View(usize, PoseParameter),
    /// A coefficient of the sheet's [bend](crate::SheetBend) in a view, mm; both counted from 0.
    Bend(usize, usize),
    /// A parameter that this library does not know, as in rigs from elsewhere.
    Other(String),
}

fn parse(text: &str) -> Option<Parameter> {
    let (of, name) = text.split_once('.')?;
    let lens = LensParameter::ALL.into_iter().find(|p| p.name() == name);
    let pose = PoseParameter::ALL.into_iter().find(|p| p.name() == name);
    match of {
        "camera" => lens.map(Parameter::Camera),
        "projector" => lens.map(Parameter::Projector),
        "projector_from_camera" => pose.map(Parameter::ProjectorFromCamera),
        _ => {
            let view = of.strip_prefix("views[")?.strip_suffix(']')?.parse().ok()?;
            let term = || name.strip_prefix("bend_mm[")?.strip_suffix(']')?.parse().ok();
            let bend = || term().filter(|k| *k < SheetBend::DEGREES.len()).map(|k| Parameter::Bend(view, k));
            pose.map(|p| Parameter::View(view, p)).or_else(bend)
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Camera(p) => write!(f, "camera.{}", p.name()),
            Self::Projector(p) => write!(f, "projector.{}", p.name()),
            Self::ProjectorFromCamera(p) => write!(f, "projector_from_camera.{}", p.name()),
            Self::View(i, p) => write!(f, "views[{i}].{}", p.name()),
            Self::Bend(i, k) => write!(f, "views[{i}].bend_mm[{k}]"),
            Self::Other(name) => f.write_str(name),
        }
    }
}

impl From<&str> for Parameter {
    fn from(text: &str) -> Self {
        // Spellings such as `views[007]` would come back as another name.
        parse(text).filter(|p| p.to_string() == text).unwrap_or_else(|| Self::Other(text.to_owned()))
    }
}

impl FromStr for Parameter {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(text.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed_and_printed_alike() {
        let known = [
            ("camera.focal_px", Parameter::Camera(LensParameter::Focal)),
            ("projector.k1", Parameter::Projector(LensParameter::K1)),
            ("projector_from_camera.rx_rad", Parameter::ProjectorFromCamera(PoseParameter::Rx)),
            ("views[12].tz_mm", Parameter::View(12, PoseParameter::Tz)),
            ("views[3].bend_mm[11]", Parameter::Bend(3, 11)),
            ("camera.aspect", Parameter::Camera(LensParameter::Aspect)),
        ];
        for (name, parameter) in known {
            assert_eq!((name.parse::<Parameter>(), parameter.to_string()), (Ok(parameter), name.to_owned()));
        }
        for name in [
            "projector.zoom",
            "views[0].bend_mm[12]",
            "views[0].bend_mm[01]",
            "views[01].tz_mm",
            "views[0].k1",
            "camera",
            "",
            "views[].tx_mm",
        ] {
            let parameter = Parameter::from(name);
            assert_eq!(parameter, Parameter::Other(name.to_owned()));
            assert_eq!(parameter.to_string(), name);
        }
    }
}
