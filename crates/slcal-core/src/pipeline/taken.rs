//! What is known of a photograph besides what was found in it.

use super::photo_tags::{FrameChange, Orientation, PhotoTags, Turn};

/// A photograph that was added to a calibration.
#[derive(Debug, Clone)]
pub(super) struct Taken {
    /// For messages.
    pub(super) title: String,
    /// Width and height as it was added, px.
    pub(super) size: [u32; 2],
    pub(super) tags: Option<PhotoTags>,
    /// How it was turned afterwards, to lie like the others.
    pub(super) turn: Turn,
}

impl Taken {
    /// By its tags; without tags nobody has turned it.
    pub(super) fn orientation(&self) -> Orientation {
        self.tags.as_ref().map_or(Orientation::AsStored, |t| t.orientation)
    }

    /// Whether its tags state the size that it has: nobody cropped it, or whoever did rewrote the tags.
    pub(super) fn is_whole(&self) -> bool {
        self.tags.as_ref().is_some_and(|t| t.frame_change(self.size) == Some(FrameChange::Whole))
    }

    /// A remark on a photograph that has the shape that its tags state, but another size.
    pub(super) fn resized(&self) -> Option<String> {
        let tags = self.tags.as_ref()?;
        let ([w, h], Some(FrameChange::Scaled { .. })) = (tags.pixels?, tags.frame_change(self.size)) else {
            return None;
        };
        Some(format!(
            "{}x{} pixels of a photograph that the camera stored as {w}x{h} by its EXIF tags: resized, or cropped to the same shape",
            self.size[0], self.size[1]
        ))
    }

    /// Width and height as it counts, px.
    pub(super) fn turned_size(&self) -> [u32; 2] {
        self.turn.size(self.size)
    }
}
