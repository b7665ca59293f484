//! Photographs: borrowed pixels of any layout, and linear light.

mod encoding;
mod grey;
mod linear;
mod view;

pub use encoding::{Encoding, LinearTable};
pub use grey::GreyImage;
pub use linear::LinearPhoto;
#[cfg(test)]
pub(crate) use view::layouts;
pub use view::{Layout, PhotoView, Samples};
