//! Photographs: borrowed pixels of any layout, and linear light.

mod bilinear;
mod encoding;
mod grey;
mod linear;
mod view;

pub use encoding::Encoding;
pub(crate) use encoding::LinearTable;
pub(crate) use grey::GreyImage;
pub(crate) use linear::{DividedPhoto, LinearPhoto};
pub use view::{Layout, PhotoView, Samples};
