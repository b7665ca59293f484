//! A vector drawing over a photograph, written as SVG or as pixels.
//!
//! A [`Drawing`] (`canvas`) holds `primitive`s and a `legend`. `legend_layout` arranges the legend, `legend_placement` puts it where it
//! covers least. `svg` writes the drawing for pages with `path_data`, `raster` paints it over the photograph.

mod appearance;
mod canvas;
pub(super) mod clip;
pub(super) mod color;
pub(super) mod font;
pub(crate) mod legend;
mod legend_layout;
pub(super) mod legend_placement;
pub(super) mod path_data;
pub(super) mod primitive;
mod raster;
mod svg;

pub(crate) use canvas::Drawing;
pub(super) use primitive::{Anchor, Pen};
