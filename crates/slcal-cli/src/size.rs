//! Sizes as people write them: `594x420mm`, `11x8.5in`, `A4-landscape`; and panels, points and corners.

use nalgebra::Point2;
use slcal_core::geometry::RectangleSize;

use crate::similar::did_you_mean;

/// What `--size` accepts.
const SIZE_FORMS: &str = "expected a width and a height with a unit (594x420mm, 59.4x42cm, 11x8.5in) or a name (A0 to A6, \
     letter, legal, upright; A4-landscape for the paper turned)";

/// Sides that a sheet may have, mm. Beyond them a unit was mistaken: no sheet of a millimetre is calibrated from, and no
/// projector lights a hundred metres.
const SIDE_RANGE_MM: std::ops::RangeInclusive<f64> = 1.0..=100_000.0;

/// Paper sizes upright, mm.
const NAMED_SIZES: [(&str, f64, f64); 9] = [
    ("a0", 841.0, 1189.0),
    ("a1", 594.0, 841.0),
    ("a2", 420.0, 594.0),
    ("a3", 297.0, 420.0),
    ("a4", 210.0, 297.0),
    ("a5", 148.0, 210.0),
    ("a6", 105.0, 148.0),
    ("letter", 215.9, 279.4),
    ("legal", 215.9, 355.6),
];

/// Parses the size of a sheet.
pub(crate) fn parse_size(text: &str) -> Result<RectangleSize, String> {
    let lower = text.trim().to_lowercase();
    let wrong = |why: &str| format!("{why}; {SIZE_FORMS}");
    let (name, landscape) = match lower.strip_suffix("-landscape") {
        Some(name) => (name, true),
        None => (lower.strip_suffix("-portrait").unwrap_or(&lower), false),
    };
    if let Some(&(_, width, height)) = NAMED_SIZES.iter().find(|n| n.0 == name) {
        let size = RectangleSize::new(width, height).map_err(|e| e.to_string())?;
        return Ok(if landscape { size.transposed() } else { size });
    }
    let (number, millimetres) = [("mm", 1.0), ("cm", 10.0), ("in", 25.4)]
        .iter()
        .find_map(|&(unit, mm)| Some((lower.strip_suffix(unit)?, mm)))
        .ok_or_else(|| wrong(&format!("{}the size has no unit and is no known name", meant(&lower))))?;
    let sides: Vec<f64> = number
        .split(['x', '×'])
        .map(|side| side.trim().parse::<f64>().map(|v| v * millimetres))
        .collect::<Result<_, _>>()
        .map_err(|_| wrong("the sides are not two numbers"))?;
    let &[width, height] = sides.as_slice() else {
        return Err(wrong("there are not two sides"));
    };
    if ![width, height].iter().all(|s| SIDE_RANGE_MM.contains(s)) {
        return Err(wrong("a side is not between 1 mm and 100 m"));
    }
    RectangleSize::new(width, height).map_err(|e| e.to_string())
}

/// What was probably meant by a size without a unit, as a question.
fn meant(text: &str) -> String {
    if parse_pair(text).is_ok() {
        return format!("did you mean {text}mm? ");
    }
    let names = NAMED_SIZES.iter().flat_map(|(name, ..)| {
        // As papers are called.
        let name = name.strip_prefix('a').map_or((*name).to_owned(), |n| format!("A{n}"));
        [format!("{name}-landscape"), format!("{name}-portrait"), name]
    });
    did_you_mean(text, names)
}

/// Parses a length with its unit, mm.
pub(crate) fn parse_length(text: &str) -> Result<f64, String> {
    let wrong = || "expected a length above zero with a unit, such as 1100mm, 110cm, 1.1m or 43in".to_owned();
    let lower = text.trim().to_lowercase();
    // "m" last: it ends the others as well.
    let (number, unit) = [("mm", 1.0), ("cm", 10.0), ("in", 25.4), ("m", 1000.0)]
        .iter()
        .find_map(|&(unit, mm)| Some((lower.strip_suffix(unit)?, mm)))
        .ok_or_else(wrong)?;
    let length = number.trim().parse::<f64>().map_err(|_| wrong())? * unit;
    if length.is_finite() && length > 0.0 { Ok(length) } else { Err(wrong()) }
}

/// Parses two whole numbers with an x between: a panel in pixels, a board in squares.
pub(crate) fn parse_pair(text: &str) -> Result<[u32; 2], String> {
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
pub(crate) fn parse_point(text: &str) -> Result<Point2<f64>, String> {
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
pub(crate) fn parse_corners(text: &str) -> Result<Corners, String> {
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

    fn mm(text: &str) -> (f64, f64) {
        let s = parse_size(text).unwrap();
        (s.width_mm, s.height_mm)
    }

    #[test]
    fn units_and_names() {
        assert_eq!(mm("594x420mm"), (594.0, 420.0));
        assert_eq!(mm("59.4 x 42 cm"), (594.0, 420.0));
        assert_eq!(mm("10x20in"), (254.0, 508.0));
        assert_eq!(mm("A4"), (210.0, 297.0));
        assert_eq!(mm("a2-landscape"), (594.0, 420.0));
        assert_eq!(mm("Letter-Landscape"), (279.4, 215.9));
    }

    #[test]
    fn nonsense_is_told_what_is_expected() {
        for text in [
            "0x420mm",
            "NaNx420mm",
            "-594x420mm",
            "594x420",
            "594mm",
            "1x2x3mm",
            "infx1mm",
            "A7",
            "",
            "1e9x1e9mm",
        ] {
            let message = parse_size(text).unwrap_err();
            assert!(message.contains("594x420mm"), "{text}: {message}");
        }
        for (text, meant) in [
            ("A44", "A4?"),
            ("a3-landscpe", "A3-landscape?"),
            ("300x200", "300x200mm?"),
            ("leter", "letter?"),
        ] {
            let message = parse_size(text).unwrap_err();
            assert!(message.starts_with(&format!("did you mean {meant}")), "{text}: {message}");
        }
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
