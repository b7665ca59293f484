//! Crosstalk: how the projector's primaries mix in the camera's channels, and hues that no mixing explains.

use nalgebra::{Matrix3, Vector3};

use super::code_check::another_pattern;
use crate::error::{ErrorSubject, Result};

/// Largest angle between a hue and the mixture of the palette's primaries, rad. It is 1.3° with the right palette. It
/// is 3° (with seven hues and crosstalk 7°) where the projector's gamma is 1.8 or 2.6 instead of sRGB's. It is mostly
/// 5° to 30° when one of five or more hues belongs to another palette. Four hues or fewer always fit.
const MAX_HUE_MISFIT: f64 = 0.12;
/// Smallest angle between hues over the palette's: from 0.52 where channels mix, below 0.17 where two hues of the
/// palette stand for one.
const MIN_HUE_ANGLE: f64 = 0.3;
/// Rounds in which the brightness of the hues is fitted: enough for a surface that reflects a tenth of a channel.
const MIX_ROUNDS: usize = 200;

/// Least squares for M in `M · palette = brightness · direction` over the hues: the light of each primary (columns) in each
/// channel (rows). `None` where the palette has fewer than three independent colours.
pub(super) fn mixing(
    palette: &[[f32; 3]],
    directions: &[[f32; 3]],
    brightness: &[f32],
) -> Option<Matrix3<f64>> {
    let mut cp = Matrix3::<f64>::zeros();
    for ((p, d), b) in palette.iter().zip(directions).zip(brightness) {
        let p = vector(*p);
        // Light is the sum over the channels.
        let c = vector(*d);
        let c = c * f64::from(*b) / c.sum().max(1e-9);
        cp += c * p.transpose();
    }
    Some(cp * inverse_products(palette)?)
}

/// [`mixing`] with each column divided by its largest entry, which removes the brightness of the primaries and leaves the
/// crosstalk.
pub(super) fn crosstalk(m: &Matrix3<f64>) -> Option<[[f64; 3]; 3]> {
    let mut out = [[0.0; 3]; 3];
    for k in 0..3 {
        let top = m.column(k).amax();
        if top <= 0.0 {
            return None;
        }
        for (row, out) in out.iter_mut().enumerate() {
            out[k] = m[(row, k)] / top;
        }
    }
    Some(out)
}

/// Refuses hues that cannot be the palette's under any mixing of the channels and colour of the surface.
pub(super) fn check_hues(palette: &[[f32; 3]], directions: &[[f32; 3]]) -> Result<()> {
    let misfit = hue_misfit(palette, directions).unwrap_or(0.0);
    let seen = if misfit > MAX_HUE_MISFIT {
        format!(
            "stripes with one hue {:.0}° away from any mixture of the palette's primaries",
            misfit.to_degrees()
        )
    } else if smallest_angle(directions) < MIN_HUE_ANGLE * smallest_angle(palette) {
        format!("stripes of fewer hues than the {} of the palette", palette.len())
    } else {
        return Ok(());
    };
    Err(another_pattern(ErrorSubject::PatternHues, seen))
}

fn vector(color: [f32; 3]) -> Vector3<f64> {
    Vector3::from(color.map(f64::from))
}

/// (Σ p·pᵀ)⁻¹ over the palette, from the normal equations of the mixing matrix. `None` where it has fewer than three
/// independent colours.
fn inverse_products(palette: &[[f32; 3]]) -> Option<Matrix3<f64>> {
    let products = palette.iter().fold(Matrix3::zeros(), |sum, &p| sum + vector(p) * vector(p).transpose());
    if products.determinant() < 1e-6 * products.trace().powi(3) {
        return None;
    }
    products.try_inverse()
}

/// The largest angle between a hue's direction and M · its colour in the palette, rad. The matrix M and the brightness
/// of the hues are fitted in turn. `None` where the palette has fewer than three independent colours.
fn hue_misfit(palette: &[[f32; 3]], directions: &[[f32; 3]]) -> Option<f64> {
    let inverse = inverse_products(palette)?;
    let hues = || palette.iter().zip(directions).map(|(&p, &d)| (vector(p), vector(d)));
    let fit = |brightness: &dyn Fn(&Vector3<f64>, &Vector3<f64>) -> f64| {
        hues().fold(Matrix3::zeros(), |sum, (p, d)| sum + d * brightness(&p, &d) * p.transpose()) * inverse
    };
    let mut mix = fit(&|p, _| p.norm());
    for _ in 0..MIX_ROUNDS {
        let last = mix / mix.norm().max(f64::MIN_POSITIVE);
        mix = fit(&|p, d| (last * p).dot(d).max(1e-3));
    }
    let angle = |(p, d): (Vector3<f64>, Vector3<f64>)| (mix * p).angle(&d);
    hues().map(angle).reduce(f64::max).filter(|a| a.is_finite())
}

/// The smallest angle between two colours, rad.
fn smallest_angle(colors: &[[f32; 3]]) -> f64 {
    let others = |i: usize| colors[i + 1..].iter().map(move |&c| vector(c).angle(&vector(colors[i])));
    (0..colors.len()).flat_map(others).fold(std::f64::consts::PI, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIVE: [[f32; 3]; 5] =
        [[1.0, 0.0, 0.0], [0.6, 1.0, 0.0], [0.0, 1.0, 0.13], [0.0, 0.13, 1.0], [0.6, 0.0, 1.0]];

    #[test]
    fn hues_fit_only_their_own_palette_under_any_mixing() {
        let mixed = |m: Matrix3<f64>, palette: &[[f32; 3]]| -> Vec<[f32; 3]> {
            palette.iter().map(|&p| (m * vector(p)).normalize().map(|x| x as f32).into()).collect()
        };
        let mix = Matrix3::new(0.6, 0.12, 0.0, 0.1, 0.4, 0.05, 0.02, 0.2, 0.3);
        let seen = mixed(mix, &FIVE);
        assert!(hue_misfit(&FIVE, &seen).unwrap() < 0.01);
        assert!(check_hues(&FIVE, &seen).is_ok());
        // The first five of six evenly spaced hues; two equal ones; too few primaries to decide.
        let six = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
        assert!(check_hues(&FIVE, &mixed(mix, &six)).is_err());
        let mut same = seen;
        same[2] = same[1];
        assert!(check_hues(&FIVE, &same).is_err());
        assert!(hue_misfit(&FIVE[..2], &same[..2]).is_none());
        assert!(check_hues(&[], &[]).is_ok());
    }
}
