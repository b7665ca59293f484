//! Projected patterns: checkerboards and De Bruijn stripes, and their rendering.

mod checker;
mod de_bruijn;
mod draw;
mod panel;
mod stripes;

pub use checker::{CheckerConfig, CheckerPattern, SquareColor};
public_with! { "stages": pub use de_bruijn::{de_bruijn, unique_window}; }
pub(crate) use draw::warp_image;
pub use stripes::{Axis, StripeConfig, StripePattern};

/// Either kind of pattern.
#[derive(Debug, Clone, PartialEq)]
pub enum Pattern {
    /// A checkerboard, for calibration.
    Checker(CheckerPattern),
    /// Stripes, for reconstruction.
    Stripes(StripePattern),
}
