//! The photograph at the scale at which it is searched.

use crate::photo::{GreyImage, LinearPhoto};

/// The longer side of the working image lies between this and twice this: enough to see every side of a sheet and every
/// square of a common board, few enough pixels to look at all combinations.
const SIDE_PX: usize = 700;

/// A photograph reduced by a whole factor, in linear light.
#[derive(Debug, Clone)]
pub(super) struct Downsampled {
    pub(super) image: GreyImage,
    /// One working pixel is this many pixels of the photograph.
    pub(super) factor: usize,
}

impl Downsampled {
    pub(super) fn new(photo: &LinearPhoto<'_>) -> Self {
        let factor = (photo.width().max(photo.height()) / SIDE_PX).max(1);
        Self { image: photo.reduced(factor), factor }
    }
}
