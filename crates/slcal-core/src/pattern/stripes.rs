//! Coloured slits whose neighbourhoods tell which they are.

use serde::{Deserialize, Serialize};

/// What the slits follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// Vertical slits, each at one projector column.
    Columns,
    /// Horizontal slits, each at one projector row.
    Rows,
}

/// A multi-slit pattern: coloured slits between black bands.
#[derive(Debug, Clone, PartialEq)]
pub struct StripePattern {
    /// Width and height of the panel, px.
    pub projector: [u32; 2],
    /// Direction of the slits.
    pub axis: Axis,
    /// Colours of the hues, sRGB code values.
    pub palette: Vec<[u8; 3]>,
    /// Hue of each slit: an index into `palette`.
    pub sequence: Vec<u8>,
    /// Projector column (row) of each slit's centre, px, ascending.
    pub centres_px: Vec<f64>,
    /// Width of the slits, px.
    pub width_px: f64,
    /// Every window of this many neighbouring colours occurs at most once.
    pub order: u32,
}
