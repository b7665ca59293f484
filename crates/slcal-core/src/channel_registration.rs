//! How red and blue are displaced against green, in the projector and in the camera.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

/// What red and blue have each.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct RedBlue<T> {
    /// Of red.
    pub red: T,
    /// Of blue.
    pub blue: T,
}

/// A primary of the projector against green: light of panel pixel q falls where green light of
/// c + (q − c)(1 + scale) + shift falls, with c the middle of the panel.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PanelDisplacement {
    /// Shift to the right and down, px of the panel.
    pub shift_px: [f64; 2],
    /// Magnification beyond that of green.
    #[serde(default)]
    pub scale: f64,
}

/// A channel of the camera against green (lateral colour): what green sees at u appears at c + (u − c)(1 + radial), with c the
/// principal point.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LateralColor {
    /// Magnification beyond that of green.
    pub radial: f64,
}

/// Displacements of projector and camera.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ChannelDisplacements {
    /// Of the projector's primaries.
    pub projector: RedBlue<PanelDisplacement>,
    /// Of the camera's channels.
    pub camera: RedBlue<LateralColor>,
}

impl ChannelDisplacements {
    /// All of them: of red and of blue the shift, the projector's scale and the camera's radial.
    pub(crate) fn numbers(&self) -> [f64; 8] {
        let of = |p: PanelDisplacement, c: LateralColor| [p.shift_px[0], p.shift_px[1], p.scale, c.radial];
        let [a, b, c, d] = of(self.projector.red, self.camera.red);
        let [e, f, g, h] = of(self.projector.blue, self.camera.blue);
        [a, b, c, d, e, f, g, h]
    }
}

/// What a registration was measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RegistrationSource {
    /// The corners of the projected checkerboard.
    Checker,
    /// The stripes of a photograph.
    Stripes,
}

/// The registration of the colour channels of projector and camera. Green is the reference: the camera matrices of a rig are
/// those of green.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelRegistration {
    /// The displacements.
    pub displacements: ChannelDisplacements,
    /// 1σ of each of them.
    pub sigma: ChannelDisplacements,
    /// What they were measured from.
    pub from: RegistrationSource,
    /// The camera's principal point, px, about which its channels are magnified.
    pub camera_centre: Point2<f64>,
    /// The middle of the panel, px, about which its primaries are magnified.
    pub panel_centre: Point2<f64>,
}

impl ChannelRegistration {
    /// Whether something is displaced by more than this many of its σ.
    #[must_use]
    pub fn exceeds(&self, sigmas: f64) -> bool {
        let each = self.displacements.numbers().into_iter().zip(self.sigma.numbers());
        each.into_iter().any(|(x, s)| x.abs() > sigmas * s)
    }
}
