//! Numbers and words as the formats' readers take them.

use nalgebra::Matrix3;

/// Columns after which lists of numbers go on in the next line.
const LINE: usize = 78;

/// The fewest digits that read back to the same number, with a point always and a sign in every exponent: YAML 1.1 takes
/// `1e-7` for a word.
pub(super) fn number(x: f64) -> String {
    let text = format!("{x:?}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let point = if mantissa.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with('-') { "" } else { "+" };
    format!("{mantissa}{point}e{sign}{exponent}")
}

/// Numbers between `separator`s.
pub(super) fn joined(numbers: impl IntoIterator<Item = f64>, separator: &str) -> String {
    numbers.into_iter().map(number).collect::<Vec<_>>().join(separator)
}

/// Numbers between `separator`s, in lines that go on at `indent`.
pub(super) fn wrapped(numbers: &[f64], separator: &str, indent: &str) -> String {
    let mut text = String::new();
    let mut column = LINE;
    for (i, x) in numbers.iter().enumerate() {
        let word = number(*x);
        if i == 0 {
            column = indent.len();
        } else {
            text.push_str(separator.trim_end());
            if column + separator.len() + word.len() > LINE {
                text.push('\n');
                text.push_str(indent);
                column = indent.len();
            } else {
                text.push(' ');
                column += separator.len();
            }
        }
        column += word.len();
        text.push_str(&word);
    }
    text
}

/// A matrix row by row.
pub(super) fn rows(m: &Matrix3<f64>) -> [f64; 9] {
    std::array::from_fn(|i| m[(i / 3, i % 3)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_point_and_a_signed_exponent() {
        for (x, text) in [
            (100.0, "100.0"),
            (-0.1, "-0.1"),
            (1e-17, "1.0e-17"),
            (-1.5e300, "-1.5e+300"),
            (1e16, "1.0e+16"),
            (0.1 + 0.2, "0.30000000000000004"),
        ] {
            assert_eq!(number(x), text);
            assert_eq!(text.parse::<f64>().unwrap(), x);
        }
    }

    #[test]
    fn long_lists_are_broken() {
        let text = wrapped(&[0.123_456_789; 20], ", ", "   ");
        assert!(text.lines().all(|l| l.len() <= LINE) && text.lines().count() > 3, "{text}");
        assert_eq!(wrapped(&[1.0, 2.0], " ", ""), "1.0 2.0");
        assert_eq!(wrapped(&[], ", ", ""), "");
    }
}
