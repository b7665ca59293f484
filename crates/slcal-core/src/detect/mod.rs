//! Photograph → observations: the checkerboard's corners and the sheet's edges, to sub-pixel.
//!
//! Bands of flicker (`row_flicker`) are divided out of the photograph first (`steady`).
//! `observe` then finds the projected checkerboard. `checkerboard` labels its corners, `board_registration` finds their
//! place in the pattern, `corner` refines their positions, and
//! `channel_offsets` finds how red and blue lie beside green there. The border of the projector footprint on the sheet follows
//! (`projector_footprint`), and is looked for where it is seen, with the marks beside it (`panel_points`). The sheet is the quadrilateral of straight edges (`edge_map`, `lines`, `quad`) that holds the
//! board. Its sides are measured on linear light at full resolution (`edge`). `find_corners` and `find_sheet` do one of
//! the two; `lit_sheet` is for a sheet under white light of the projector. These functions are public with the feature `stages`.

mod board;
mod board_registration;
mod channel_offsets;
mod checkerboard;
mod clipping;
mod corner;
mod detection;
mod downsampled;
mod edge;
mod edge_map;
mod erf;
#[cfg(test)]
mod flicker_tests;
mod light_border;
mod lines;
mod lit_sheet;
mod marks;
mod panel_points;
mod panel_view;
mod projector_footprint;
mod quad;
mod rough_undistort;
mod row_flicker;
mod row_profile;
mod sheet;
#[cfg(test)]
mod side_tests;
mod steady;
#[cfg(test)]
mod tests;

pub(crate) use clipping::{CLIPPED, CLIPPED_COST_PERCENT};
pub use detection::Detection;
pub(crate) use lit_sheet::find_lit_sheet;
public_with! { "stages": pub use detection::{CornerDetection, DetectConfig, find_corners, find_sheet, observe}; }
public_with! { "stages": pub use sheet::SheetDetection; }
