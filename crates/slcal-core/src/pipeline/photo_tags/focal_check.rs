//! The focal length of a calibration against the one that a photograph's tags state.

use super::focal::TaggedFocal;
use super::frame::FrameChange;
use super::tags::PhotoTags;
use crate::rig::{Rig, Warning};

/// Distance, in σ of both together, from which the two contradict each other.
const CONTRADICTS: f64 = 3.0;
/// Distance from which σ of the result means little: as for a prior that the photographs contradict.
const MEANS_LITTLE: f64 = 6.0;

/// What the two focal lengths say of each other.
pub(super) struct Comparison {
    focal: TaggedFocal,
    /// Natural logarithm of the calibrated focal length over the stated one.
    ln_ratio: f64,
    /// 1σ of it.
    sigma: f64,
}

impl Comparison {
    /// Of a rig with what a photograph of this size states; `None` where it states nothing that can be used.
    pub(super) fn new(rig: &Rig, tags: &PhotoTags, size: [u32; 2]) -> Option<Self> {
        let focal = tags.focal(size).ok()?;
        let fx = rig.camera.model.intrinsics.fx;
        let own = rig.camera.sigma.map_or(0.0, |s| s.focal_px / fx);
        let (ln_ratio, sigma) = ((fx / focal.prior.focal_px).ln(), focal.prior.sigma_share.hypot(own));
        (ln_ratio.is_finite() && sigma.is_finite()).then_some(Self { focal, ln_ratio, sigma })
    }

    /// Distance in σ from what is stated, times `factor`.
    pub(super) fn distance(&self, factor: f64) -> f64 {
        (self.ln_ratio - factor.ln()).abs() / self.sigma
    }

    /// Whether the calibration contradicts what is stated, times `factor`.
    pub(super) fn contradicts(&self, factor: f64) -> bool {
        self.distance(factor) > CONTRADICTS
    }
}

/// The warning where the two contradict each other, and whether σ of the calibration means little then.
pub(in crate::pipeline) fn contradiction(
    rig: &Rig,
    title: &str,
    tags: &PhotoTags,
    size: [u32; 2],
) -> Option<(Warning, bool)> {
    let of = Comparison::new(rig, tags, size)?;
    of.contradicts(1.0).then(|| (warning(rig, title, tags, size, &of), of.distance(1.0) > MEANS_LITTLE))
}

fn warning(rig: &Rig, title: &str, tags: &PhotoTags, size: [u32; 2], of: &Comparison) -> Warning {
    let fx = rig.camera.model.intrinsics.fx;
    let own = rig.camera.sigma.map_or(String::new(), |s| format!(" ± {:.0}", s.focal_px));
    let TaggedFocal { prior, .. } = of.focal;
    let message = format!(
        "{title}: the camera's focal length came out as {fx:.0}{own} px, {:.2} times the {:.0} ± {:.0} px that the photograph's EXIF \
         tags state ({}): {:.1} σ apart",
        of.ln_ratio.exp(),
        prior.focal_px,
        prior.focal_px * prior.sigma_share,
        of.focal,
        of.distance(1.0)
    );
    let longer = of.ln_ratio > 0.0;
    let resized = matches!(tags.frame_change(size), Some(FrameChange::Scaled { .. }));
    let likely = match (longer, resized) {
        (true, true) => "the photograph was cropped or zoomed after it was taken, not only resized",
        (true, false) => "the photograph was cropped or zoomed",
        (false, _) => "the tags are those of another picture",
    };
    let advice = format!(
        "check whether {likely}, then the sheet's size and which of its sides is the width, then whether the lens of the camera or of the \
         projector is shifted sideways; a second photograph with the tilt reversed shows which of the two focal lengths is right"
    );
    Warning::new("exif-focal-differs", message, advice)
}
