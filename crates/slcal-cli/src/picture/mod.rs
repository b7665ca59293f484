//! Pictures of detections and residuals. `drawing` draws over a photograph; `sheet`, `residual_drawing`, `stripes` and `verification`
//! choose what is drawn; `sequence` colours pixel by pixel; `contact_sheet` puts several photographs on one picture; `deviation_map` shows a cloud, `depth_map` its depths.

pub(crate) mod contact_sheet;
mod depth_map;
pub(crate) mod deviation_map;
mod display_encoding;
mod drawing;
pub(crate) mod residual_drawing;
pub(crate) mod sequence;
pub(crate) mod sheet;
pub(crate) mod stripes;
pub(crate) mod vector_scale;
pub(crate) mod verification;

pub(crate) use depth_map::depth_file;
pub(crate) use display_encoding::for_display;
pub(crate) use drawing::Drawing;
pub(crate) use drawing::color::ramp;
pub(crate) use drawing::legend::Swatch;
pub(crate) use drawing::path_data::{Number, push_lines};
