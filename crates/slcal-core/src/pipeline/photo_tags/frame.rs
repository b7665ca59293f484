//! The size of a photograph against the size that its tags state.

use super::tags::PhotoTags;

/// Relative difference of two aspect ratios up to which one picture is the other resized: sizes are rounded to whole
/// blocks of JPEG, and what is cut off by that moves the centre by less than a quarter of its usual σ.
const SAME_SHAPE: f64 = 0.01;
/// Sides shorter than this, px, are no camera's: the tags are of a thumbnail, or empty.
const FEWEST_PIXELS: u32 = 16;

/// What happened to a photograph after the camera stored it, by the size that its tags state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum FrameChange {
    /// The sizes agree.
    Whole,
    /// The shape is the same, the size is not: resized, or cropped to the same shape.
    Scaled {
        /// Size of the photograph over the size in the tags.
        scale: f64,
    },
    /// The shape is another one: cropped, or stretched.
    Reshaped,
    /// The shape is another one, and the photograph is larger: the tags are those of another picture.
    Unrelated,
}

impl PhotoTags {
    /// What happened to the photograph, which has this width and height, px, turned or not; `None` where the tags state no
    /// size.
    #[must_use]
    pub fn frame_change(&self, size: [u32; 2]) -> Option<FrameChange> {
        let stated = self.pixels.filter(|p| p.iter().all(|side| *side >= FEWEST_PIXELS))?;
        // Programs that turn pixels do not all turn the tags as well.
        let sides = |[w, h]: [u32; 2]| [f64::from(w.max(h)), f64::from(w.min(h))];
        let ([long, short], [stated_long, stated_short]) = (sides(size), sides(stated));
        let [across, along] = [long / stated_long, short / stated_short];
        Some(if (across / along - 1.0).abs() > SAME_SHAPE {
            // No part of a picture is larger than the whole.
            if across.min(along) > 1.0 { FrameChange::Unrelated } else { FrameChange::Reshaped }
        } else if (across * along).sqrt() == 1.0 {
            FrameChange::Whole
        } else {
            FrameChange::Scaled { scale: (across * along).sqrt() }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(stated: [u32; 2], size: [u32; 2]) -> Option<FrameChange> {
        PhotoTags { pixels: Some(stated), ..PhotoTags::default() }.frame_change(size)
    }

    #[test]
    fn sizes_are_compared_turned_or_not() {
        assert_eq!(PhotoTags::default().frame_change([640, 480]), None);
        assert_eq!(change([0, 0], [640, 480]), None);
        for (stated, size) in [([640, 480], [640, 480]), ([640, 480], [480, 640]), ([480, 640], [640, 480])] {
            assert_eq!(change(stated, size), Some(FrameChange::Whole));
        }
        assert_eq!(change([1280, 960], [480, 640]), Some(FrameChange::Scaled { scale: 0.5 }));
        // Rounded to whole pixels.
        let rounded = change([4608, 3456], [1000, 750]);
        assert!(matches!(rounded, Some(FrameChange::Scaled { scale }) if (scale - 0.217).abs() < 0.001));
        assert_eq!(change([1280, 960], [1160, 900]), Some(FrameChange::Reshaped));
        assert_eq!(change([640, 480], [640, 512]), Some(FrameChange::Reshaped));
        assert_eq!(change([160, 120], [640, 400]), Some(FrameChange::Unrelated));
        assert_eq!(
            change([4000, 3000], [4000, 2992]),
            Some(FrameChange::Scaled { scale: (2992.0_f64 / 3000.0).sqrt() })
        );
    }
}
