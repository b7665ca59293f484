//! The matches of a sequence on the sheet → [`pairs`](crate::ViewObservation::pairs), as those of a checkerboard.
//!
//! The sheet is cut into cells (`cells`). In each of them the map from camera to panel is that of the whole sheet, a homography, followed
//! by an affine map that takes up what the lenses and the bend of the sheet add over so short a way (`local_fit`): together a homography of
//! the neighbourhood. Its value in the middle of the cell is one pair (`thinned`).
//! σ of a pair has three parts: the noise of the pixels, with what neighbours have in common within the cell (`local_fit`), what makes whole
//! cells scatter (`scatter`), and the curvature of the map over a cell.

mod cells;
mod local_fit;
mod scatter;
#[cfg(test)]
mod tests;
mod thinned;

pub use thinned::{SheetPairs, sheet_pairs};
