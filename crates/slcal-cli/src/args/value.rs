//! Parsers of values: options of the core, lengths, panels, points and corners.

use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use nalgebra::Point2;
use slcal_core::geometry::{RectangleSize, SheetSize};
use slcal_core::photo::Encoding;
use slcal_core::reconstruct::CullRule;
use slcal_core::{Error, Flatness, PixelAspect, PrincipalPointRule};

use crate::similar::did_you_mean;

/// Parses an option of the core whose values are names; help and shells list them.
pub(super) fn choice<T>(names: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = Error> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

/// Parses an option of the core; an unknown word is answered with the nearest of `names`.
fn option<T: FromStr<Err = Error>>(
    text: &str,
    names: impl IntoIterator<Item = impl Into<String>>,
) -> Result<T, String> {
    text.parse().map_err(|error| match error {
        Error::Invalid { expected, .. } => format!("{}expected {expected}", did_you_mean(text, names)),
        other => other.to_string(),
    })
}

/// Parses the encoding of photographs.
pub(super) fn parse_encoding(text: &str) -> Result<Encoding, String> {
    option(text, Encoding::NAMES.iter().copied())
}

/// Parses the rule for removing triangles.
pub(super) fn parse_cull(text: &str) -> Result<CullRule, String> {
    option(text, CullRule::NAMES.iter().copied())
}

/// Parses the rule for the principal point of the projector.
pub(super) fn parse_projector_pp(text: &str) -> Result<PrincipalPointRule, String> {
    option(text, PrincipalPointRule::NAMES.iter().copied())
}

/// Parses the rule for the principal point of the camera.
pub(super) fn parse_camera_pp(text: &str) -> Result<PrincipalPointRule, String> {
    match parse_projector_pp(text)? {
        PrincipalPointRule::Shift => {
            Err("expected prior, centre, free or X,Y (shift is for projectors)".to_owned())
        }
        rule => Ok(rule),
    }
}

/// Parses how flat a sheet is.
pub(super) fn parse_flatness(text: &str) -> Result<Flatness, String> {
    text.parse().map_err(|e: slcal_core::Error| e.to_string())
}

/// Parses the shape of a projector's pixels.
pub(super) fn parse_pixel_aspect(text: &str) -> Result<PixelAspect, String> {
    text.parse().map_err(|e: slcal_core::Error| e.to_string())
}

/// Parses the size of a sheet of which it matters which side is the width.
pub(super) fn parse_size(text: &str) -> Result<RectangleSize, String> {
    parse_sheet(text)
}

/// Parses the size of a sheet in photographs: a name may stand for either way round.
pub(super) fn parse_sheet_size(text: &str) -> Result<SheetSize, String> {
    parse_sheet(text)
}

fn parse_sheet<T: FromStr<Err = Error>>(text: &str) -> Result<T, String> {
    if let Some(unit) = RectangleSize::unit_that_is_missing(text) {
        return Err(format!("did you mean {}{unit}? the size has no unit", text.trim()));
    }
    let papers = || RectangleSize::paper_names();
    let turned = papers().flat_map(|name| [format!("{name}-landscape"), format!("{name}-portrait")]);
    option(text, papers().map(str::to_owned).chain(turned))
}

/// Parses a length with its unit, mm.
pub(super) fn parse_length(text: &str) -> Result<f64, String> {
    let wrong = || "expected a length above zero with a unit, such as 1100mm, 110cm, 1.1m or 43in".to_owned();
    let lower = text.trim().to_lowercase();
    // "m" is last because the others end with it, too.
    let (number, unit) = [("mm", 1.0), ("cm", 10.0), ("in", 25.4), ("m", 1000.0)]
        .iter()
        .find_map(|&(unit, mm)| Some((lower.strip_suffix(unit)?, mm)))
        .ok_or_else(wrong)?;
    let length = number.trim().parse::<f64>().map_err(|_| wrong())? * unit;
    if length.is_finite() && length > 0.0 { Ok(length) } else { Err(wrong()) }
}

/// Parses two whole numbers with an x between: a panel in pixels, a board in squares.
pub(super) fn parse_pair(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "expected two whole numbers above zero with an x between, such as 1024x768".to_owned();
    let numbers: Vec<u32> = text
        .trim()
        .to_lowercase()
        .split(['x', '×'])
        .map(str::parse)
        .collect::<Result<_, _>>()
        .map_err(|_| wrong())?;
    match *numbers.as_slice() {
        [a, b] if a > 0 && b > 0 => Ok([a, b]),
        _ => Err(wrong()),
    }
}

/// Parses `x,y`.
pub(super) fn parse_point(text: &str) -> Result<Point2<f64>, String> {
    let wrong = || "expected x,y with two finite numbers, such as 639.5,479.5".to_owned();
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    match (number(x), number(y)) {
        (Some(x), Some(y)) => Ok(Point2::new(x, y)),
        _ => Err(wrong()),
    }
}

/// The corners of one sheet, TL TR BR BL.
pub(crate) type Corners = [Point2<f64>; 4];

/// Parses `x,y x,y x,y x,y`.
pub(super) fn parse_corners(text: &str) -> Result<Corners, String> {
    let points: Vec<Point2<f64>> = text
        .split(|c: char| c.is_whitespace() || c == ';')
        .filter(|t| !t.is_empty())
        .map(parse_point)
        .collect::<Result<_, _>>()?;
    points.try_into().map_err(|p: Vec<_>| {
        format!("expected four corners \"x,y x,y x,y x,y\" in the order TL TR BR BL, found {}", p.len())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_errors_are_answered_with_what_was_meant() {
        for (text, meant) in [
            ("A44", "A4?"),
            ("a3-landscpe", "A3-landscape?"),
            ("300x200", "300x200mm?"),
            ("21x29.7", "21x29.7cm?"),
            ("8.5x11", "8.5x11in?"),
            ("0.594x0.42", "0.594x0.42m?"),
            ("leter", "letter?"),
            ("tabloyd", "tabloid?"),
        ] {
            let message = parse_size(text).unwrap_err();
            assert!(message.starts_with(&format!("did you mean {meant}")), "{text}: {message}");
        }
        assert!(parse_projector_pp("shif").unwrap_err().starts_with("did you mean shift? expected"));
        assert!(parse_camera_pp("shift").unwrap_err().contains("projectors"));
        assert!(parse_encoding("linaer").unwrap_err().starts_with("did you mean linear?"));
    }

    #[test]
    fn lengths_have_units() {
        let mm = ["1100mm", "110 cm", "1.1m", "10in"].map(|t| parse_length(t).unwrap());
        assert!(mm.iter().zip([1100.0, 1100.0, 1100.0, 254.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{mm:?}");
        for text in ["1100", "-1m", "nanm", "0mm", "m", "infcm"] {
            assert!(parse_length(text).is_err(), "{text}");
        }
    }

    #[test]
    fn panels_and_corners() {
        assert_eq!(parse_pair("1024x768"), Ok([1024, 768]));
        for text in ["1024", "0x768", "1024x-1", "1.5x2", "1x2x3"] {
            assert!(parse_pair(text).is_err(), "{text}");
        }
        let corners = parse_corners("-12,40 10.5,2  3,4;5,6").unwrap();
        assert_eq!(corners[0], Point2::new(-12.0, 40.0));
        assert!(parse_corners("1,2 3,4 5,6").unwrap_err().contains("found 3"));
        assert!(parse_corners("1,2 3,4 5,6 7,nan").is_err());
    }
}
