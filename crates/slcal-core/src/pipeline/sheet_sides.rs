//! Photographs of a sheet whose paper was named without saying which side is the width.

use crate::calibrate::{CalibrateConfig, SheetLies, orient};
use crate::detect::{DetectConfig, Detection, observe};
use crate::error::Result;
use crate::geometry::SheetSize;
use crate::observations::Observations;
use crate::pattern::CheckerPattern;
use crate::photo::PhotoView;
use crate::rig::Warning;

/// [`observe`](crate::detect::observe) for a size that may lie either way round: the way that fits the sheet's outline is taken,
/// upright where the photograph does not tell. `config` says what is known of the camera.
///
/// # Errors
/// As [`observe`](crate::detect::observe).
pub fn observe_sheet(
    photo: PhotoView<'_>,
    plain: Option<PhotoView<'_>>,
    sheet: SheetSize,
    pattern: Option<&CheckerPattern>,
    detect: &DetectConfig,
    config: &CalibrateConfig,
) -> Result<Detection> {
    let mut found = observe(photo, plain, sheet.upright(), pattern, detect)?;
    let camera = [photo.width() as u32, photo.height() as u32];
    SheetSides::default().settle(sheet, camera, std::slice::from_mut(&mut found), config);
    Ok(found)
}

/// How the sheets lie in the photographs so far.
#[derive(Debug, Clone, Default)]
pub(super) struct SheetSides(Vec<SheetLies>);

impl SheetSides {
    /// Finds how the sheets lie in the photographs that are new, and sets their sizes.
    pub(super) fn settle(
        &mut self,
        sheet: SheetSize,
        camera: [u32; 2],
        found: &mut [Detection],
        config: &CalibrateConfig,
    ) {
        if !sheet.is_either_way() {
            return;
        }
        let views = found.iter().map(|d| d.observation.clone()).collect();
        let mut all = Observations { camera, projector: None, mirrored: false, views };
        orient(&mut all, &mut self.0, config);
        for (found, view) in found.iter_mut().zip(all.views) {
            found.observation.size = view.size;
        }
    }

    /// Forgets one photograph.
    pub(super) fn remove(&mut self, index: usize) {
        if index < self.0.len() {
            self.0.remove(index);
        }
    }

    /// What was found of a sheet that somebody may have expected to stand upright; `titles` are the names of the photographs.
    pub(super) fn warnings(&self, sheet: SheetSize, titles: &[String]) -> Vec<Warning> {
        let of = |lies: SheetLies| {
            let those = self.0.iter().zip(titles).filter(|(l, _)| **l == lies);
            those.map(|(_, title)| title.as_str()).collect::<Vec<_>>().join(", ")
        };
        let across = sheet.upright().transposed();
        let swapped = Warning::new(
            "sides-swapped",
            format!(
                "{}: the sheet lies across ({} x {} mm), because {sheet} does not fit upright",
                of(SheetLies::Across),
                across.width_mm,
                across.height_mm
            ),
            format!(
                "nothing if it does; {sheet}-landscape says so beforehand. If the sheet stands upright there, it is no {sheet}: \
                 measure it"
            ),
        );
        let undecided = Warning::new(
            "sides-undecided",
            format!(
                "{}: {sheet} fits upright as well as across; it is taken for upright",
                of(SheetLies::Undecided)
            ),
            format!("give {sheet}-portrait or {sheet}-landscape, whichever it is"),
        );
        let happened = |lies| self.0.contains(&lies);
        let all = [(SheetLies::Across, swapped), (SheetLies::Undecided, undecided)];
        all.into_iter().filter(|(lies, _)| happened(*lies)).map(|(_, warning)| warning).collect()
    }
}
