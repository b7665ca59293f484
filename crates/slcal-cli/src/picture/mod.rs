//! Pictures of what was found and how well it fits: made once as a drawing of vectors (`drawing`), written twice, as SVG
//! for pages (`svg`) and painted upon the photograph (`raster`). `sheet`, `stripes` and `expected` say what is drawn.

mod clip;
mod color;
mod drawing;
pub(crate) mod expected;
mod font;
mod legend;
mod magnify;
mod raster;
pub(crate) mod sheet;
pub(crate) mod stripes;
mod style;
#[allow(dead_code, reason = "pages are written by another part of the command")]
mod svg;

pub(crate) use drawing::Drawing;
