//! Where the stripes of each hue are seen against those of green light: projectors with three panels and lenses with lateral
//! colour displace red and blue.
//!
//! A stripe is located in the sum of the channels. The stripe of a mixed hue is therefore displaced by the mean of its
//! primaries' displacements, weighted by their shares of its light.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use super::config::ScanDirection;
use super::rgb::total;
use crate::channel_registration::ChannelRegistration;
use crate::pattern::{Axis, StripePattern};

/// Red and blue: the primaries and channels that are displaced against green, as indices of RGB.
pub(super) const DISPLACED: [usize; 2] = [0, 2];

/// Shares of red and blue in the light of each hue.
#[derive(Debug, Clone, Default)]
pub(super) struct HueShares {
    /// Of the projector's primaries.
    pub(super) primaries: Vec<[f32; 2]>,
    /// Of the camera's channels.
    pub(super) channels: Vec<[f32; 2]>,
}

impl HueShares {
    /// From the measured colours of the hues and the light of each primary in each channel, where that is known.
    pub(super) fn set(&mut self, directions: &[[f32; 3]], mixing: Option<&Matrix3<f64>>) {
        let of = |light: [f32; 3]| {
            let sum = total(light).max(f32::MIN_POSITIVE);
            DISPLACED.map(|c| light[c] / sum)
        };
        let inverse = mixing.and_then(|m| Some((m, m.try_inverse()?)));
        self.channels.clear();
        self.channels.extend(directions.iter().map(|&d| of(d)));
        self.primaries.clear();
        self.primaries.extend(directions.iter().map(|&d| {
            let Some((m, inverse)) = inverse else { return of(d) };
            let primaries = inverse * Vector3::from(d.map(f64::from));
            of(std::array::from_fn(|p| (primaries[p].max(0.0) * m.column(p).sum()) as f32))
        }));
    }
}

/// Displacement of stripes along a scanline.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct HueShift {
    /// Of red and blue on the panel, in the order of the scanline, projector px, at the panel's middle.
    pub(super) panel_px: [f32; 2],
    /// Its change per projector px.
    pub(super) panel_scale: [f32; 2],
    /// Magnification of the camera's channels.
    pub(super) radial: [f32; 2],
}

/// Places about which channels and primaries are magnified.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Centres {
    /// In the image, along and across the scanline, px.
    pub(super) image: [f32; 2],
    /// On the panel, in the pattern's own direction, px.
    pub(super) panel: f32,
}

impl Centres {
    /// Those of a registration, or the middles of image and panel.
    pub(super) fn new(
        registration: Option<&ChannelRegistration>,
        image: [usize; 2],
        pattern: &StripePattern,
        scan: ScanDirection,
    ) -> Self {
        let middle = |size: f64| 0.5 * (size - 1.0);
        let [x, y] = registration.map_or_else(
            || image.map(|size| middle(size as f64)),
            |r| [r.camera_centre.x, r.camera_centre.y],
        );
        let along_columns = pattern.axis == Axis::Columns;
        let panel = registration.map_or_else(
            || middle(f64::from(pattern.projector[usize::from(!along_columns)])),
            |r| if along_columns { r.panel_centre.x } else { r.panel_centre.y },
        );
        let image = if scan == ScanDirection::Rows { [x, y] } else { [y, x] };
        Self { image: image.map(|x| x as f32), panel: panel as f32 }
    }
}

impl HueShift {
    /// That of a registration which was measured in white light: each channel then shows a mixture of the primaries, which
    /// `mixing` takes apart.
    pub(super) fn of(
        registration: &ChannelRegistration,
        axis: Axis,
        reversed: bool,
        mixing: Option<&Matrix3<f64>>,
    ) -> Self {
        let along = usize::from(axis != Axis::Columns);
        let sign = if reversed { -1.0 } else { 1.0 };
        let d = &registration.displacements;
        let of_channels = [&d.projector.red, &d.projector.blue];
        let shift = unmixed(Vector2::from(of_channels.map(|p| p.shift_px[along])), mixing);
        let scale = unmixed(Vector2::from(of_channels.map(|p| p.scale)), mixing);
        Self {
            panel_px: [shift.x, shift.y].map(|s| (sign * s) as f32),
            panel_scale: [scale.x, scale.y].map(|s| (sign * s) as f32),
            radial: [d.camera.red.radial, d.camera.blue.radial].map(|r| r as f32),
        }
    }

    /// The displacement of a stripe along the scanline, px. `place`: where it is from the centre, along and across the
    /// scanline, px; `panel`: where its slit is from the panel's middle, projector px; `scale`: image px per projector px.
    pub(super) fn displacement(
        &self,
        [primaries, channels]: [[f32; 2]; 2],
        place: [f32; 2],
        slope: f32,
        panel: f32,
        scale: f32,
    ) -> f32 {
        let mut px = 0.0;
        for k in 0..2 {
            px += scale * primaries[k] * (self.panel_px[k] + self.panel_scale[k] * panel)
                + channels[k] * self.radial[k] * across(place, slope);
        }
        px
    }
}

/// How far a magnification by one displaces a slanted stripe along the scanline, px.
pub(super) fn across([along, beside]: [f32; 2], slope: f32) -> f32 {
    along - slope * beside
}

/// The displacements of red and blue light from those of the red and the blue channel, both against green.
fn unmixed(channels: Vector2<f64>, mixing: Option<&Matrix3<f64>>) -> Vector2<f64> {
    let Some(m) = mixing else { return channels };
    // Shares of the primaries in what a channel sees of white.
    let share = |c: usize, p: usize| m[(c, p)] / m.row(c).sum();
    let matrix = Matrix2::from_fn(|c, p| share(DISPLACED[c], DISPLACED[p]) - share(1, DISPLACED[p]));
    matrix.try_inverse().map_or(channels, |inverse| inverse * channels)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The light of the primaries in the channels: each channel sees something of its neighbours.
    fn mix() -> Matrix3<f64> {
        Matrix3::new(1.0, 0.09, 0.02, 0.06, 1.0, 0.08, 0.01, 0.11, 1.0)
    }

    #[test]
    fn shares_are_those_of_the_primaries() {
        let hue = |p: [f64; 3]| (mix() * Vector3::from(p)).normalize();
        let directions =
            [[1.0, 0.0, 0.0], [0.2, 1.0, 0.0], [0.0, 1.0, 1.0]].map(|p| hue(p).map(|x| x as f32).into());
        let mut shares = HueShares::default();
        shares.set(&directions, Some(&mix()));
        let near = |a: [f32; 2], b: [f32; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
        assert!(near(shares.primaries[0], [1.0, 0.0]));
        let sums: Vec<f32> = (0..3).map(|p| mix().column(p).sum() as f32).collect();
        assert!(near(shares.primaries[1], [0.2 * sums[0] / (0.2 * sums[0] + sums[1]), 0.0]));
        assert!(near(shares.primaries[2], [0.0, sums[2] / (sums[1] + sums[2])]));
        shares.set(&directions, None);
        assert_eq!(shares.primaries, shares.channels);
    }

    #[test]
    fn channels_of_white_light_are_taken_apart() {
        let (red, blue) = (0.3, -0.24);
        let row = |c: usize| {
            let m = mix();
            (m[(c, 0)] * red + m[(c, 2)] * blue) / m.row(c).sum()
        };
        let seen = Vector2::new(row(0) - row(1), row(2) - row(1));
        let found = unmixed(seen, Some(&mix()));
        assert!((found - Vector2::new(red, blue)).norm() < 1e-12 && (seen - found).norm() > 0.02);
    }
}
