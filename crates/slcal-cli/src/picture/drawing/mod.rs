//! A drawing upon a photograph: made once as vectors, written twice.
//!
//! A [`Drawing`] (`canvas`) holds `shape`s and a `legend`, which says what they mean; `layout` puts that into lines, `placing`
//! where it hides least. `svg` writes all of it for pages, `raster` paints it upon the photograph.

mod canvas;
pub(super) mod clip;
pub(super) mod color;
pub(super) mod font;
mod layout;
pub(crate) mod legend;
pub(super) mod placing;
mod raster;
pub(super) mod shape;
mod style;
mod svg;

pub(crate) use canvas::Drawing;
pub(super) use shape::{Anchor, Pen};
