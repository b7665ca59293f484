//! Numbers as they are shown, with their exact value for programs beside them.

use maud::{Markup, html};

/// A number of the rig file: `field` is its path there ("camera.K.0.0"), the exact value stands in `data-value`.
pub(super) fn field(path: &str, value: f64, shown: &str) -> Markup {
    html! { span.n data-field=(path) data-value=(exact(value)) { (shown) } }
}

/// A number that is computed from the rig, under a name of its own.
pub(super) fn derived(name: &str, value: f64, shown: &str) -> Markup {
    html! { span.n data-derived=(name) data-value=(exact(value)) { (shown) } }
}

/// The shortest text that reads back as the same number, as in JSON.
fn exact(value: f64) -> String {
    serde_json::Number::from_f64(value).map_or_else(|| "null".to_owned(), |n| n.to_string())
}

/// A number with so many decimals, and a minus sign as long as a plus.
pub(super) fn fixed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    // No "-0.0".
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_owned(),
        Some(digits) => format!("\u{2212}{digits}"),
        None => text,
    }
}

/// A number with so many significant digits, without an exponent as long as it is readable.
pub(super) fn significant(x: f64, digits: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".to_owned() } else { "unknown".to_owned() };
    }
    let mut order = x.abs().log10().floor() as i32;
    // 9.96 with two digits is 10.
    if (x.abs() * 10f64.powi(digits - 1 - order)).round() >= 10f64.powi(digits) {
        order += 1;
    }
    if !(-7..=15).contains(&order) {
        return format!("{x:.*e}", (digits - 1).max(0) as usize).replace('-', "\u{2212}");
    }
    let decimals = digits - 1 - order;
    if decimals < 0 {
        let step = 10f64.powi(-decimals);
        return fixed((x / step).round() * step, 0);
    }
    fixed(x, decimals as usize)
}

/// How many decimals of a value its σ warrants: two digits of σ.
pub(super) fn decimals_of(sigma: f64) -> usize {
    if !(sigma.is_finite() && sigma > 0.0) {
        return 1;
    }
    (1 - sigma.log10().floor() as i32).clamp(0, 9) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_with_the_digits_that_count() {
        assert_eq!(significant(22.29, 2), "22");
        assert_eq!(significant(9.96, 2), "10");
        assert_eq!(significant(0.099_6, 2), "0.10");
        assert_eq!(significant(1234.0, 2), "1200");
        assert_eq!(significant(-0.004_56, 2), "\u{2212}0.0046");
        assert_eq!(significant(0.0, 2), "0");
        assert_eq!(significant(1e-12, 2), "1.0e\u{2212}12");
        assert_eq!(fixed(-0.04, 1), "0.0");
        assert_eq!(
            [decimals_of(34.2), decimals_of(0.037), decimals_of(0.0), decimals_of(488.0)],
            [0, 3, 1, 0]
        );
    }

    #[test]
    fn the_exact_value_reads_back_as_the_same_number() {
        for x in [1536.0 + 1.0 / 3.0, 1e-300, -0.1, 5e20] {
            let text = field("a", x, "x").into_string();
            let value = text.split("data-value=\"").nth(1).unwrap().split('"').next().unwrap();
            assert_eq!(value.parse::<f64>().unwrap(), x, "{text}");
        }
    }
}
