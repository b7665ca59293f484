//! The projector's primaries as the camera's channels see them.

use nalgebra::Matrix3;

/// Least squares for M in `M · palette = brightness · direction` over the hues; each column is divided by its largest
/// entry, which takes out the brightness of the primaries and leaves what spills into other channels. `None` where the
/// palette has fewer than three independent colours.
pub(super) fn crosstalk(
    palette: &[[f32; 3]],
    directions: &[[f32; 3]],
    brightness: &[f32],
) -> Option<[[f64; 3]; 3]> {
    let (mut pp, mut cp) = (Matrix3::<f64>::zeros(), Matrix3::<f64>::zeros());
    for ((p, d), b) in palette.iter().zip(directions).zip(brightness) {
        let p = nalgebra::Vector3::from(p.map(f64::from));
        // Light is counted as the sum over the channels.
        let c = nalgebra::Vector3::from(d.map(f64::from));
        let c = c * f64::from(*b) / c.sum().max(1e-9);
        pp += p * p.transpose();
        cp += c * p.transpose();
    }
    let scale = pp.trace();
    if pp.determinant() < 1e-6 * scale.powi(3) {
        return None;
    }
    let m = cp * pp.try_inverse()?;
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
