//! Units of length: as they are typed, and the one that a size was probably measured in.

use super::paper;
use super::rectangle::RectangleSize;

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LengthUnit {
    /// As it is typed behind a number.
    pub(crate) symbol: &'static str,
    /// In the plural.
    pub(crate) name: &'static str,
    /// Its length, mm.
    pub(crate) mm: f64,
}

/// All units; metres are last, because the others end with their symbol.
const UNITS: [LengthUnit; 4] = [
    LengthUnit { symbol: "mm", name: "millimetres", mm: 1.0 },
    LengthUnit { symbol: "cm", name: "centimetres", mm: 10.0 },
    LengthUnit { symbol: "in", name: "inches", mm: 25.4 },
    LengthUnit { symbol: "m", name: "metres", mm: 1000.0 },
];

/// Diagonal of a bank card, mm, rounded up. A sheet that is smaller was probably measured in another unit.
const CARD_DIAGONAL_MM: f64 = 100.0;
/// The largest sheet that somebody prints or lays out, mm: a wall of a room.
const LARGEST_DIAGONAL_MM: f64 = 8_000.0;

impl LengthUnit {
    /// As a unit is typed whose name this is.
    pub(crate) fn symbol_of(name: &str) -> &'static str {
        UNITS.iter().find(|unit| unit.name == name).map_or("mm", |unit| unit.symbol)
    }
}

/// A text without the unit of length that it ends with, and that unit.
pub(super) fn with_unit(text: &str) -> Option<(&str, LengthUnit)> {
    UNITS.iter().find_map(|unit| Some((text.strip_suffix(unit.symbol)?, *unit)))
}

/// A length with a unit, such as `0.5mm`, in mm.
pub(crate) fn length_mm(text: &str) -> Option<f64> {
    let (number, unit) = with_unit(text)?;
    number.trim().parse().ok().map(|n: f64| n * unit.mm).filter(|l| l.is_finite())
}

impl RectangleSize {
    /// Units that a size was probably measured in that is stated in millimetres: the name of the unit in the plural and the
    /// size, the likelier one first. Empty for ordinary sizes. A size is suspected where it is a common paper in another unit, or
    /// where it is smaller than a bank card.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::RectangleSize;
    ///
    /// let letter = RectangleSize::new(8.5, 11.0)?.likely_units()[0];
    /// assert_eq!(letter, ("inches", "letter".parse()?));
    /// assert!(RectangleSize::new(594.0, 420.0)?.likely_units().is_empty());
    /// # Ok::<(), slcal_core::Error>(())
    /// ```
    #[must_use]
    pub fn likely_units(&self) -> Vec<(&'static str, Self)> {
        // Without the last bit of the product: 8.5 inches are 215.9 mm, as the paper's own size says.
        let to_micrometre = |mm: f64| (mm * 1e3).round() / 1e3;
        let scaled = |mm: f64| Self {
            width_mm: to_micrometre(mm * self.width_mm),
            height_mm: to_micrometre(mm * self.height_mm),
        };
        let others = UNITS[1..].iter().map(|unit| (unit.name, scaled(unit.mm)));
        let diagonal = |size: &Self| size.width_mm.hypot(size.height_mm);
        let sheets = CARD_DIAGONAL_MM..=LARGEST_DIAGONAL_MM;
        let mut likely: Vec<_> = others.filter(|(_, size)| sheets.contains(&diagonal(size))).collect();
        let small = diagonal(self) < CARD_DIAGONAL_MM;
        if likely.iter().any(|(_, size)| paper::is_paper(*size)) || !small {
            likely.retain(|(_, size)| paper::is_paper(*size));
        }
        // Stable: of those that are boards, and of those that are not, the more usual unit comes first.
        likely.sort_by_key(|(_, size)| !paper::is_board(*size));
        likely
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn likely(width_mm: f64, height_mm: f64) -> Vec<(&'static str, [f64; 2])> {
        let all = RectangleSize { width_mm, height_mm }.likely_units();
        all.into_iter().map(|(unit, s)| (unit, [s.width_mm, s.height_mm].map(f64::round))).collect()
    }

    #[test]
    fn a_paper_in_another_unit_is_recognised_upright_and_across() {
        let cases = [
            (59.4, 42.0, "centimetres", [594.0, 420.0]),
            (21.0, 29.7, "centimetres", [210.0, 297.0]),
            (29.7, 42.0, "centimetres", [297.0, 420.0]),
            (84.1, 118.9, "centimetres", [841.0, 1189.0]),
            (21.59, 27.94, "centimetres", [216.0, 279.0]),
            (8.5, 11.0, "inches", [216.0, 279.0]),
            (17.0, 11.0, "inches", [432.0, 279.0]),
            (0.594, 0.42, "metres", [594.0, 420.0]),
            (0.21, 0.297, "metres", [210.0, 297.0]),
        ];
        for (w, h, unit, mm) in cases {
            assert_eq!(likely(w, h), [(unit, mm)], "{w} x {h}");
        }
    }

    #[test]
    fn smaller_than_a_card_in_no_usual_size_may_be_several_units() {
        assert_eq!(likely(60.0, 40.0), [("centimetres", [600.0, 400.0]), ("inches", [1524.0, 1016.0])]);
        // A poster that is sold in inches.
        assert_eq!(likely(24.0, 36.0)[0], ("inches", [610.0, 914.0]));
        assert_eq!(likely(1.2, 1.6), [("metres", [1200.0, 1600.0])]);
    }

    #[test]
    fn ordinary_sizes_are_not_suspected() {
        let papers = RectangleSize::paper_names().map(|name| name.parse().unwrap());
        let others = [[105.0, 148.0], [200.0, 100.0], [70.0, 100.0], [2000.0, 1500.0], [5940.0, 4200.0]];
        let others = others.map(|[width_mm, height_mm]| RectangleSize { width_mm, height_mm });
        for size in papers.chain(others) {
            assert_eq!(size.likely_units(), [], "{size}");
        }
    }
}
