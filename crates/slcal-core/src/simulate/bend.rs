//! The bend of a sheet as a few numbers.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::geometry::RectangleSize;
use crate::named::named;

/// Largest sag as a share of the shorter side. Slopes stay below 35°, where every surface is a graph over its plane.
const MOST_SHARE: f64 = 0.1;
/// Largest angle of the axis, degrees: a whole turn.
const MOST_AXIS_DEG: f64 = 360.0;

/// The shape of a bend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BendKind {
    /// A circular cylinder.
    #[default]
    Curl,
    /// A cylinder with an S-shaped section.
    Wave,
    /// Opposite corners to the front, the others to the back: proportional to u·v. Paper stretches a little in this shape.
    Twist,
}

named!(BendKind, "kind of bend", { Curl => "curl", Wave => "wave", Twist => "twist" });

/// A length, or a share of the sheet's width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sag {
    /// Millimetres.
    Mm(f64),
    /// Per cent of the sheet's width.
    PercentOfWidth(f64),
}

/// A bend. Its text is `SAG[,AXIS_DEG[,KIND]]`: `3mm`, `0.5%`, `0.5%,20` or `-3mm,90,wave`.
///
/// The sag is measured across the whole sheet, from corner to corner where the axis is oblique:
/// - curl: the depth of the arc below its chord. The middle lies farther from the viewer where it is positive.
/// - wave: the largest distance from the chord to either side. The half to the right lies farther (the lower one with an
///   axis at 90°).
/// - twist: the distance of the corners from the mean plane. The corners top left and bottom right lie farther.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct BendConfig {
    /// Sag; negative ones bend to the other side.
    pub sag: Sag,
    /// Angle of the axis, to which the lines that stay straight are parallel, from the sheet's height, clockwise as the viewer
    /// sees it, degrees. At 0 the width is bent, at 90 the height. A twist needs a multiple of 90.
    pub axis_deg: f64,
    /// Shape.
    pub kind: BendKind,
}

/// A bend with its sag as a length.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BendReport {
    /// Shape.
    pub kind: BendKind,
    /// Angle of the axis, degrees.
    pub axis_deg: f64,
    /// Sag, mm.
    pub sag_mm: f64,
}

impl BendConfig {
    /// Checks the values for a sheet.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a sag above a tenth of the shorter side, angles beyond a whole turn, and a twist about an
    /// oblique axis.
    pub fn validate(&self, size: RectangleSize) -> Result<()> {
        let most = MOST_SHARE * size.width_mm.min(size.height_mm);
        if !(-most..=most).contains(&self.sag_mm(size)) {
            return Err(Error::invalid(
                "sag of the bent sheet",
                format!("at most {most} mm (a tenth of the shorter side) to either side"),
                format!("{} mm", self.sag_mm(size)),
            ));
        }
        if !(-MOST_AXIS_DEG..=MOST_AXIS_DEG).contains(&self.axis_deg) {
            let expected = format!("-{MOST_AXIS_DEG}° to {MOST_AXIS_DEG}°");
            return Err(Error::invalid("axis of the bend", expected, format!("{}°", self.axis_deg)));
        }
        if self.kind == BendKind::Twist && self.axis_deg % 90.0 != 0.0 {
            return Err(Error::invalid(
                "axis of the bend",
                "0 or 90 for a twist, whose straight lines are parallel to the sides",
                format!("{}°", self.axis_deg),
            ));
        }
        Ok(())
    }

    /// The sag on a sheet, mm.
    #[must_use]
    pub fn sag_mm(&self, size: RectangleSize) -> f64 {
        match self.sag {
            Sag::Mm(mm) => mm,
            Sag::PercentOfWidth(percent) => percent / 100.0 * size.width_mm,
        }
    }

    /// The record of the bend of a sheet.
    #[must_use]
    pub fn report(&self, size: RectangleSize) -> BendReport {
        BendReport { kind: self.kind, axis_deg: self.axis_deg, sag_mm: self.sag_mm(size) }
    }
}

impl fmt::Display for BendReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} with a sag of {:.3} mm", self.kind, self.sag_mm)?;
        if self.kind == BendKind::Twist { Ok(()) } else { write!(f, ", axis at {}°", self.axis_deg) }
    }
}

impl fmt::Display for Sag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mm(mm) => write!(f, "{mm}mm"),
            Self::PercentOfWidth(percent) => write!(f, "{percent}%"),
        }
    }
}

impl FromStr for Sag {
    type Err = Error;

    /// A number with mm, cm, in, m or %.
    ///
    /// # Errors
    /// [`Error::Invalid`] that says so.
    fn from_str(text: &str) -> Result<Self> {
        let lower = text.trim().to_lowercase();
        let number = |t: &str| t.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let percent = lower.strip_suffix('%').and_then(number).map(Self::PercentOfWidth);
        // "m" is last because the others end with it, too.
        let length = [("mm", 1.0), ("cm", 10.0), ("in", 25.4), ("m", 1000.0)]
            .iter()
            .find_map(|&(unit, mm)| Some((lower.strip_suffix(unit)?, mm)))
            .and_then(|(t, mm)| Some(Self::Mm(number(t)? * mm)));
        percent.or(length).ok_or_else(|| wrong(text))
    }
}

impl fmt::Display for BendConfig {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{}", self.sag, self.axis_deg, self.kind)
    }
}

impl FromStr for BendConfig {
    type Err = Error;

    /// `SAG[,AXIS_DEG[,KIND]]`.
    ///
    /// # Errors
    /// [`Error::Invalid`] that says so.
    fn from_str(text: &str) -> Result<Self> {
        let mut parts = text.split(',');
        let sag = parts.next().unwrap_or_default().parse().map_err(|_| wrong(text))?;
        let axis = parts.next().map(|t| t.trim().parse::<f64>().ok().filter(|x| x.is_finite()));
        let kind = parts.next().map(|t| t.trim().parse::<BendKind>());
        match (axis, kind, parts.next()) {
            (Some(None), ..) | (_, Some(Err(_)), _) | (.., Some(_)) => Err(wrong(text)),
            (axis, kind, None) => Ok(Self {
                sag,
                axis_deg: axis.flatten().unwrap_or(0.0),
                kind: kind.transpose()?.unwrap_or_default(),
            }),
        }
    }
}

impl TryFrom<String> for BendConfig {
    type Error = Error;

    fn try_from(text: String) -> Result<Self> {
        text.parse()
    }
}

impl From<BendConfig> for String {
    fn from(bend: BendConfig) -> Self {
        bend.to_string()
    }
}

fn wrong(text: &str) -> Error {
    let shown: String = text.chars().take(40).collect();
    let expected = "SAG[,AXIS_DEG[,curl|wave|twist]], the sag a length with a unit or a share of the sheet's width: 3mm, \
                    0.5%, 3mm,20 or 0.5%,20,wave";
    Error::invalid("bend", expected, format!("\"{shown}\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    const A2: RectangleSize = RectangleSize { width_mm: 594.0, height_mm: 420.0 };

    #[test]
    fn bends_are_read_as_they_are_printed() {
        let bend: BendConfig = "0.5%".parse().unwrap();
        assert_eq!(bend, BendConfig { sag: Sag::PercentOfWidth(0.5), axis_deg: 0.0, kind: BendKind::Curl });
        assert!((bend.sag_mm(A2) - 2.97).abs() < 1e-12);
        for (text, printed) in [
            ("3mm", "3mm,0,curl"),
            ("-0.3cm, 20", "-3mm,20,curl"),
            ("1%,-90,WAVE", "1%,-90,wave"),
            ("0.1in,0,twist", "2.54mm,0,twist"),
        ] {
            let bend: BendConfig = text.parse().unwrap();
            assert_eq!(bend.to_string(), printed);
            assert_eq!(printed.parse(), Ok(bend));
            assert_eq!(serde_json::to_value(bend).unwrap(), printed);
            assert_eq!(serde_json::from_str::<BendConfig>(&format!("\"{printed}\"")).unwrap(), bend);
        }
        for text in [
            "",
            "3",
            "nan%",
            "infmm",
            "3mm,",
            "3mm,nan",
            "3mm,0,fold",
            "3mm,0,curl,1",
            "curl",
            "3mm,wave",
            "%",
        ] {
            let error = text.parse::<BendConfig>().unwrap_err().to_string();
            assert!(error.contains("SAG[,AXIS_DEG") && error.contains(&format!("\"{text}\"")), "{error}");
        }
    }

    #[test]
    fn bends_that_no_sheet_has_are_refused() {
        for (text, words) in [
            ("200%", "found 1188 mm"),
            ("-43mm", "found -43 mm"),
            ("1mm,361", "axis of the bend"),
            ("1mm,45,twist", "0 or 90"),
        ] {
            let error = text.parse::<BendConfig>().unwrap().validate(A2).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        for text in ["42mm", "-42mm", "0mm", "1mm,90,twist", "1mm,-360,wave"] {
            assert_eq!(text.parse::<BendConfig>().unwrap().validate(A2), Ok(()));
        }
    }
}
