//! The running mean along a scanline.

/// Up to this reach a mean is a sum of all its pixels; beyond, a sliding sum.
const SUMMED_REACH: usize = 3;

/// Writes the running mean over `reach` pixels to either side, narrower at the ends, into `out`.
pub(super) fn smooth(light: &[f32], reach: usize, out: &mut Vec<f32>) {
    let n = light.len();
    let width = 2 * reach + 1;
    out.clear();
    out.resize(n, 0.0);
    if n >= width {
        let inner = &mut out[reach..n - reach];
        if reach <= SUMMED_REACH {
            // Whole rows, so that the compiler vectorises the loop.
            for shift in 0..width {
                for (o, v) in inner.iter_mut().zip(&light[shift..]) {
                    *o += v;
                }
            }
            for o in inner {
                *o *= 1.0 / width as f32;
            }
        } else {
            let mut sum: f64 = light[..width - 1].iter().map(|&v| f64::from(v)).sum();
            for ((o, new), old) in inner.iter_mut().zip(&light[width - 1..]).zip(light) {
                sum += f64::from(*new);
                *o = (sum * (1.0 / width as f64)) as f32;
                sum -= f64::from(*old);
            }
        }
    }
    for x in (0..reach.min(n)).chain(n.saturating_sub(reach).max(reach.min(n))..n) {
        let about = &light[x.saturating_sub(reach)..(x + reach + 1).min(n)];
        out[x] = about.iter().sum::<f32>() / about.len() as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_running_mean_keeps_level_light_and_slopes() {
        let ramp: Vec<f32> = (0..20).map(|x| x as f32).collect();
        let mut out = Vec::new();
        smooth(&ramp, 2, &mut out);
        assert!((2..18).all(|x| (out[x] - x as f32).abs() < 1e-5));
        assert!((out[0] - 1.0).abs() < 1e-6);
        smooth(&[3.0; 5], 9, &mut out);
        assert!(out.len() == 5 && out.iter().all(|v| (v - 3.0).abs() < 1e-6));
    }
}
