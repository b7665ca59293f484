//! What both ways of writing a drawing have in common. Widths are in units of the drawing.

use super::primitive::Pen;

/// How much wider a halo is than its line, and its black.
pub(super) const HALO: f64 = 1.6;
pub(super) const HALO_OPACITY: f64 = 0.55;
/// That of words, as a share of their size; they are to be read.
pub(super) const TEXT_HALO: f64 = 0.24;
pub(super) const TEXT_HALO_OPACITY: f64 = 0.75;
/// Drawn and left out.
pub(super) const DASHES: [f64; 2] = [7.0, 6.0];
/// How much of the photograph's colour and brightness stays under curves, whose own colours would drown in it.
pub(super) const COLOR_KEPT: f64 = 0.6;
pub(super) const LIGHT_KEPT: f64 = 0.75;

/// The width of the dark line under a line, px.
pub(super) fn halo_width(pen: &Pen, unit: f64) -> f64 {
    (pen.width + HALO) * unit
}
