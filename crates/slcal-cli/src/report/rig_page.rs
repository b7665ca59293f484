//! The content of a report on a rig.

use slcal_core::{Observations, PointCloud, Rig, ViewResiduals};

use super::photo::Photo;
use crate::name::name_among;
use crate::picture::sheet::pairs_word;

/// The content of a report on a rig. Names are as they were typed.
pub(crate) struct RigPage<'a> {
    pub(crate) rig: &'a Rig,
    /// The rig's file; empty when it has none.
    pub(crate) rig_name: String,
    /// One entry per view, where the photograph is available.
    pub(crate) photos: Vec<Option<Photo>>,
    /// What was measured in them.
    pub(crate) observations: Option<&'a Observations>,
    /// The residuals, or why they are not known.
    pub(crate) residuals: Result<Vec<ViewResiduals>, String>,
    /// The checkerboard's file, for the commands to run next.
    pub(crate) checker_name: Option<String>,
    pub(crate) cloud: Option<ShownCloud<'a>>,
    /// The commands that created the rig, in order.
    pub(crate) made_by: Vec<String>,
}

impl RigPage<'_> {
    /// What the page calls the rig.
    pub(super) fn name(&self) -> &str {
        if self.rig_name.is_empty() { "calibration" } else { &self.rig_name }
    }

    /// What the pairs of the pattern are called: corners of a checkerboard, unless the observations say otherwise.
    pub(super) fn pairs_word(&self) -> &'static str {
        pairs_word(self.observations.iter().flat_map(|o| &o.views))
    }
}

/// What the page calls the photograph of view `i`.
pub(super) fn photo_name(rig: &Rig, i: usize) -> &str {
    let names: Vec<&str> = rig.views.iter().map(|v| v.photo.as_deref().unwrap_or("photograph")).collect();
    name_among(&names, i)
}

/// A cloud beside the rig.
pub(crate) struct ShownCloud<'a> {
    pub(crate) name: String,
    pub(crate) cloud: &'a PointCloud,
}
