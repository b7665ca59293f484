//! Photographs as the rest of the library sees them: borrowed pixels of any layout, and linear light.

mod encoding;
mod grey;
mod linear;
mod view;

pub use encoding::{Encoding, LinearTable};
pub use grey::GreyImage;
pub use linear::LinearPhoto;
pub use view::{Layout, PhotoView, Samples};
