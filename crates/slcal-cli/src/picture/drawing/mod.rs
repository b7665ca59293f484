//! A drawing upon a photograph: made once as vectors, written twice.
//!
//! A [`Drawing`] (`canvas`) holds `shape`s and a `legend`, which says what they mean; `layout` puts that into lines, `legend_placement`
//! where it hides least. `svg` writes all of it for pages, `raster` paints it upon the photograph.

mod appearance;
mod canvas;
pub(super) mod clip;
pub(super) mod color;
pub(super) mod font;
pub(crate) mod legend;
mod legend_layout;
pub(super) mod legend_placement;
pub(super) mod primitive;
mod raster;
mod svg;

pub(crate) use canvas::Drawing;
pub(super) use primitive::{Anchor, Pen};
