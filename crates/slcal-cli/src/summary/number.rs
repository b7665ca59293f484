//! Numbers as the summaries print them.

/// A number that prints with `decimals`, without the sign of a zero.
pub(crate) fn unsigned(x: f64, decimals: usize) -> f64 {
    let unit = 10_f64.powi(decimals as i32);
    (x * unit).round() / unit + 0.0
}

/// A number with `decimals`, or with as many more as a small one needs to show two digits.
pub(super) fn rounded(x: f64, decimals: usize) -> String {
    let small = x != 0.0 && x.abs() < 0.1;
    let decimals = if small { (1.0 - x.abs().log10().floor()).min(6.0) as usize } else { decimals };
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_keep_two_digits() {
        assert_eq!([34.21, 0.42, 0.0514, 0.0031].map(|x| rounded(x, 1)), ["34.2", "0.4", "0.051", "0.0031"]);
        assert_eq!([rounded(0.0, 2), rounded(2.234, 2)], ["0.00", "2.23"]);
    }
}
