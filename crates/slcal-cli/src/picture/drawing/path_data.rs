//! Coordinates and paths as SVG writes them.

use std::fmt::{self, Write as _};

/// A coordinate in hundredths, as short as it can be written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Number(pub(crate) f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.2}", if self.0.is_finite() { self.0 } else { 0.0 });
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}

/// Appends straight lines through points, x and y, to the data of a path.
pub(crate) fn push_lines(data: &mut String, points: impl IntoIterator<Item = [f64; 2]>) {
    for (i, [x, y]) in points.into_iter().enumerate() {
        let letter = if i == 0 { 'M' } else { 'L' };
        // Writing into a string cannot fail.
        let _ = write!(data, "{letter}{} {}", Number(x), Number(y));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_never_nan() {
        let words = [0.0, -0.001, 1.0, 100.0, 2.50, -3.456, 1e7, f64::NAN, f64::INFINITY];
        let texts = words.map(|x| Number(x).to_string());
        assert_eq!(texts, ["0", "0", "1", "100", "2.5", "-3.46", "10000000", "0", "0"]);
    }

    #[test]
    fn lines_follow_each_other_in_one_path() {
        let mut data = String::new();
        push_lines(&mut data, [[1.0, 2.0], [3.123_456, 4.0]]);
        push_lines(&mut data, [[0.5, -0.5]]);
        assert_eq!(data, "M1 2L3.12 4M0.5 -0.5");
    }
}
