//! How red and blue differ from green, whose geometry is the rig's: panels of the projector that do not coincide, and a
//! camera's lens with lateral colour.

use nalgebra::{Point2, Vector2};

use super::config::RenderConfig;

/// Where a channel lies against green.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ChannelOffset {
    /// What green shows at `u`, this channel shows at centre + (u − centre) · (1 + radial) in the photograph; the centre is
    /// the principal point.
    pub(super) radial: f64,
    /// Light of panel position `p` falls where green's of p + shift falls, panel px.
    pub(super) shift_px: Vector2<f64>,
}

impl ChannelOffset {
    /// Those of red and blue; `None` where the channel coincides with green.
    pub(super) fn of_red_and_blue(config: &RenderConfig) -> [Option<Self>; 2] {
        [0, 1].map(|k| {
            let offset = Self {
                radial: config.lateral_colour[k],
                shift_px: Vector2::from(config.channel_shift_px[k]),
            };
            (offset.radial != 0.0 || offset.shift_px != Vector2::zeros()).then_some(offset)
        })
    }

    /// The position at which green shows what this channel shows at `p`.
    pub(super) fn green_position(&self, p: Point2<f64>, centre: Point2<f64>) -> Point2<f64> {
        centre + (p - centre) / (1.0 + self.radial)
    }

    /// The panel position of this channel whose light falls where green's of `q` falls.
    pub(super) fn panel_position(&self, q: Point2<f64>) -> Point2<f64> {
        q - self.shift_px
    }
}
