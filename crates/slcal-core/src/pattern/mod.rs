//! What is projected: checkerboards and De Bruijn stripes, and the drawing of them.

mod checker;
mod stripes;

pub use checker::{CheckerPattern, SquareColor};
pub use stripes::{Axis, StripePattern};
