//! What is projected: checkerboards and De Bruijn stripes, and the drawing of them.

mod checker;
mod de_bruijn;
mod draw;
mod panel;
mod stripes;

pub use checker::{CheckerConfig, CheckerPattern, SquareColor};
pub use de_bruijn::{de_bruijn, unique_window};
pub use draw::warp_image;
pub use stripes::{Axis, StripeConfig, StripePattern};

/// Either kind of pattern.
#[derive(Debug, Clone, PartialEq)]
pub enum Pattern {
    /// For calibration.
    Checker(CheckerPattern),
    /// For reconstruction.
    Stripes(StripePattern),
}
