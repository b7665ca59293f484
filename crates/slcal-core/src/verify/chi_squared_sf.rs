//! The survival function of χ².

/// Γ(x) in logarithm for x > 0 (C. Lanczos, 1964, with P. Godfrey's coefficients: 15 digits).
fn ln_gamma(x: f64) -> f64 {
    const G: f64 = 7.0;
    const C: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let sum = C.iter().zip(1..).fold(0.999_999_999_999_809_9, |s, (c, i)| s + c / (x + f64::from(i)));
    let t = x + G + 0.5;
    0.5 * (2.0 * std::f64::consts::PI).ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// The probability that χ² with `freedom` degrees exceeds `value`: the upper incomplete gamma function Q(k/2, x/2), by its
/// series below the mode and by Lentz's continued fraction above (Press et al., "Numerical recipes", section 6.2). 1 for
/// values that are not positive, 0 degrees included.
pub(super) fn chi_squared_sf(value: f64, freedom: usize) -> f64 {
    const TERMS: usize = 10_000;
    const TINY: f64 = 1e-300;
    let (a, x) = (freedom as f64 / 2.0, value / 2.0);
    if x.is_nan() || x <= 0.0 || freedom == 0 {
        return 1.0;
    }
    if !x.is_finite() {
        return 0.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..TERMS {
            term *= x / (a + n as f64);
            sum += term;
            if term < sum * 1e-16 {
                break;
            }
        }
        return (1.0 - front * sum).clamp(0.0, 1.0);
    }
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut h = d;
    for n in 1..TERMS {
        let n = n as f64;
        let an = -n * (n - a);
        b += 2.0;
        d = an * d + b;
        d = 1.0 / if d.abs() < TINY { TINY } else { d };
        c = b + an / c;
        c = if c.abs() < TINY { TINY } else { c };
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    (front * h).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabulated_quantiles() {
        // (quantile, degrees, upper tail) as in any table.
        for (x, k, p) in [
            (3.841_458_820_694_124, 1, 0.05),
            (16.811_893_829_770_927, 6, 0.01),
            (26.124_481_558_376_14, 8, 0.001),
            (7.344_121_497_701_792, 8, 0.5),
            (2.732_636_793_499_664, 8, 0.95),
        ] {
            assert!((chi_squared_sf(x, k) / p - 1.0).abs() < 1e-9, "{x} {k}: {}", chi_squared_sf(x, k));
        }
        // Two degrees: exp(−x/2) exactly.
        for x in [1e-3, 1.0, 40.0, 700.0] {
            assert!((chi_squared_sf(x, 2) / (-x / 2.0f64).exp() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn odd_values_have_an_answer() {
        for (x, p) in [(f64::NAN, 1.0), (-1.0, 1.0), (f64::INFINITY, 0.0), (1e9, 0.0), (0.0, 1.0)] {
            assert_eq!(chi_squared_sf(x, 6), p);
        }
        assert_eq!(chi_squared_sf(5.0, 0), 1.0);
    }
}
