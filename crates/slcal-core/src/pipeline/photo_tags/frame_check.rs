//! Photographs that are not what the camera stored: cropped, or perhaps cropped.

use super::focal_check::Comparison;
use super::frame::FrameChange;
use super::tags::PhotoTags;
use crate::rig::{Rig, Warning};

/// Above this scale a picture of the same shape is rather cropped than resized: who resizes a photograph wants it clearly
/// smaller.
const SELDOM_RESIZED: f64 = 0.75;
/// Above this one it lost rows and columns by rounding; its middle moves by less than an eighth of its usual σ.
const ROUNDED: f64 = 0.995;
/// A principal point whose σ is below this part of the image's width is known from the photographs, not from the middle of
/// the picture (which is good for 2 %).
const DETERMINED: f64 = 0.005;

/// What is wrong with the frame of a photograph.
pub(in crate::pipeline) struct Finding {
    pub(in crate::pipeline) warning: Warning,
    /// Whether the result rests on the middle of a picture that is not the middle of the sensor.
    pub(in crate::pipeline) doubtful: bool,
}

/// Looks at the size of a photograph in the light of its tags and of the rig that was calibrated from it.
pub(in crate::pipeline) fn examine(
    rig: &Rig,
    title: &str,
    tags: &PhotoTags,
    size: [u32; 2],
) -> Option<Finding> {
    let certain = match tags.frame_change(size)? {
        FrameChange::Reshaped => true,
        FrameChange::Scaled { scale } if scale < ROUNDED => {
            let focal = Comparison::new(rig, tags, size);
            let [resized, cropped] =
                [1.0, scale.recip()].map(|factor| focal.as_ref().map(|f| !f.contradicts(factor)));
            let resized_by_focal = resized == Some(true) && cropped == Some(false);
            let cropped_by_focal = resized == Some(false) && cropped == Some(true);
            if !cropped_by_focal && (resized_by_focal || scale < SELDOM_RESIZED) {
                return None;
            }
            cropped_by_focal
        }
        _ => return None,
    };
    let determined = is_determined(rig);
    Some(Finding {
        warning: warning(title, tags.pixels?, size, certain, determined),
        doubtful: certain && !determined,
    })
}

/// Whether the photographs themselves tell where the lens's axis meets the image.
fn is_determined(rig: &Rig) -> bool {
    let below = DETERMINED * f64::from(rig.camera.model.width);
    // What was held fixed is not determined.
    rig.camera.sigma.is_some_and(|s| s.cx_px.min(s.cy_px) > 0.0 && s.cx_px.max(s.cy_px) < below)
}

fn warning(title: &str, stated: [u32; 2], size: [u32; 2], certain: bool, determined: bool) -> Warning {
    let what = if certain { "it was cropped" } else { "it was cropped, or resized," };
    let consequence = if determined {
        "the photographs themselves determine where the lens's axis meets the picture, so that the result does not suffer"
    } else {
        "the middle of a cropped picture need not be where the lens's axis meets it, which the result rests on"
    };
    let message = format!(
        "{title}: the photograph has {}x{} pixels, the camera stored {}x{} by its EXIF tags: {what} after it was taken; {consequence}",
        size[0], size[1], stated[0], stated[1]
    );
    let advice = if determined {
        "crop later photographs in exactly the same way, or calibrate again with photographs as the camera stored them"
    } else {
        "give the photograph as the camera stored it, or the principal point in the cropped picture if you know it; a second photograph \
         with the tilt reversed, cropped in the same way, determines it as well"
    };
    Warning::new("cropped", message, advice)
}
