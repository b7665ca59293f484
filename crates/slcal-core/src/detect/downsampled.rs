//! The downsampled photograph, in which the board and the sheet are searched for.

use crate::photo::{GreyImage, LinearPhoto};

/// The longer side of the downsampled image lies between this and twice this. That resolves every side of a sheet and
/// every square of a common board, and keeps the search over all combinations fast.
const SIDE_PX: usize = 700;

/// A photograph reduced by an integer factor, in linear light.
#[derive(Debug, Clone)]
pub(super) struct Downsampled {
    pub(super) image: GreyImage,
    /// Side of a downsampled pixel in pixels of the photograph.
    pub(super) factor: usize,
}

impl Downsampled {
    pub(super) fn new(photo: &LinearPhoto<'_>) -> Self {
        let factor = (photo.width().max(photo.height()) / SIDE_PX).max(1);
        Self { image: photo.reduced(factor), factor }
    }
}
