//! Colours that eyes of every kind can tell apart.

/// Red, green, blue, sRGB.
pub(crate) type Color = [u8; 3];

// The palette of M. Okabe and K. Ito, "Color universal design" (2008), which people with any colour blindness can tell
// apart. Its blue and black are left out: they do not show on a dark photograph.
pub(crate) const ORANGE: Color = [230, 159, 0];
pub(crate) const SKY: Color = [86, 180, 233];
pub(crate) const GREEN: Color = [0, 178, 130];
pub(crate) const YELLOW: Color = [240, 228, 66];
pub(crate) const VERMILLION: Color = [236, 104, 10];
pub(crate) const PINK: Color = [224, 140, 190];
pub(crate) const WHITE: Color = [255, 255, 255];
pub(crate) const BLACK: Color = [0, 0, 0];

/// The least brightness of a stripe's colour, 0-255: dark blues and reds do not show on dark photographs.
const LEAST_LUMA: f64 = 140.0;

/// Corners of the ramp, dark to light, evenly spaced: brightness rises all the way, and the hue goes from blue to yellow,
/// so that it reads in grey and with every colour blindness. The darkest is light enough for a dimmed photograph.
const RAMP: [Color; 5] = [[78, 92, 190], [46, 138, 190], [56, 182, 150], [150, 216, 84], [255, 240, 70]];

/// The colour at a share, 0 to 1, of the ramp for quantities; outside of it and for NaN the nearest end's.
pub(crate) fn ramp(share: f64) -> Color {
    let at = if share > 0.0 { share.min(1.0) } else { 0.0 } * (RAMP.len() - 1) as f64;
    let i = (at.floor() as usize).min(RAMP.len() - 2);
    mix(RAMP[i], RAMP[i + 1], at - i as f64)
}

/// `share` of the second colour in the first.
pub(crate) fn mix(a: Color, b: Color, share: f64) -> Color {
    let channel = |k: usize| (f64::from(a[k]) * (1.0 - share) + f64::from(b[k]) * share).round() as u8;
    [channel(0), channel(1), channel(2)]
}

/// A bright colour per slit: hues step by the golden angle, so that neighbours differ most.
pub(crate) fn slit_color(slit: u16) -> Color {
    const GOLDEN_SHARE: f64 = 0.618_033_988_75;
    let hue = (f64::from(slit) * GOLDEN_SHARE).fract() * 6.0;
    let pure = [5.0, 3.0, 1.0].map(|n: f64| {
        let k = (n + hue) % 6.0;
        255.0 * (1.0 - k.min(4.0 - k).clamp(0.0, 1.0))
    });
    let white = ((LEAST_LUMA - luma(pure)) / (255.0 - luma(pure))).clamp(0.0, 1.0);
    pure.map(|c| (c + (255.0 - c) * white).round() as u8)
}

/// Brightness of a colour as the eye weighs it (Rec. 709).
pub(crate) fn luma([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_slits_differ_in_colour() {
        for slit in 0..63_u16 {
            let (a, b) = (slit_color(slit), slit_color(slit + 1));
            let apart: i32 = (0..3).map(|c| (i32::from(a[c]) - i32::from(b[c])).abs()).sum();
            assert!(apart > 150, "{slit}: {a:?} {b:?}");
        }
    }

    #[test]
    fn the_ramp_grows_brighter_and_has_ends() {
        let light = |s: f64| luma(ramp(s).map(f64::from));
        assert!((0..100).all(|i| light(f64::from(i + 1) / 100.0) > light(f64::from(i) / 100.0)));
        assert_eq!([ramp(-3.0), ramp(f64::NAN), ramp(9.0)], [RAMP[0], RAMP[0], RAMP[4]]);
    }
}
