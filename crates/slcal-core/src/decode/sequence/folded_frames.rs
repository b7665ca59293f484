//! Frames are folded into what is kept of every pixel, band by band of the image's rows.

use super::folded_band::FoldedBand;
use super::frame_plan::FramePlan;
use super::levels::LevelScale;
use super::sample_lines::SampleLines;
use crate::decode::in_threads::for_each;
use crate::pattern::{Axis, FrameLight, SequencePattern};
use crate::photo::PhotoView;

/// Pixels of a band: what is kept of them, and what is on the way, stays in the processor's cache.
const BAND: usize = 1 << 14;

/// What is kept while frames come.
#[derive(Debug, Clone)]
pub(super) struct FoldedFrames {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) scale: LevelScale,
    /// Rows of every band but the last, which may have fewer: a power of two.
    pub(super) band_rows: usize,
    pub(super) bands: Vec<FoldedBand>,
}

impl FoldedFrames {
    pub(super) fn new(
        pattern: &SequencePattern,
        plan: &FramePlan,
        photo: &PhotoView<'_>,
        scale: LevelScale,
    ) -> Self {
        let (width, height) = (photo.width(), photo.height());
        let codes = [Axis::Columns, Axis::Rows].map(|axis| pattern.code(axis));
        let band_rows = BAND.div_ceil(width).next_power_of_two();
        let bands = (0..height).step_by(band_rows).map(|first| {
            let rows = first..(first + band_rows).min(height);
            FoldedBand::new(codes, plan, [width, height], rows)
        });
        Self { width, height, scale, band_rows, bands: bands.collect() }
    }

    /// Folds one frame; `seen` are those that came, with this one.
    pub(super) fn fold(
        &mut self,
        plan: &FramePlan,
        seen: &[bool],
        frame: usize,
        photo: &PhotoView<'_>,
        parallel: bool,
    ) {
        let shown = |light| plan.position(light).is_some_and(|i| seen[i]);
        let levels_known = shown(FrameLight::White) && shown(FrameLight::Black);
        let is_first = seen.iter().filter(|s| **s).count() == 1;
        for_each(&mut self.bands, parallel, |(_, band)| {
            if is_first {
                band.clear();
            }
            band.fold(plan, levels_known, frame, photo);
        });
    }

    /// Folds all frames, which lie in memory, in the order of the plan.
    pub(super) fn fold_all(&mut self, plan: &FramePlan, frames: &[PhotoView<'_>], parallel: bool) {
        for_each(&mut self.bands, parallel, |(_, band)| {
            band.clear();
            for &i in &plan.reading_order {
                // White and black come first.
                band.fold(plan, true, i, &frames[i]);
            }
        });
    }

    /// Which band a row of the image is in, and which row of it.
    #[inline]
    pub(super) fn band_row(&self, y: usize) -> (usize, usize) {
        (y >> self.band_rows.trailing_zeros(), y & (self.band_rows - 1))
    }

    /// The band of a row of the image, and the row in it.
    #[inline]
    pub(super) fn band_of(&self, y: usize) -> (&FoldedBand, usize) {
        let (band, y) = self.band_row(y);
        (&self.bands[band], y)
    }

    /// What was kept along some lines.
    pub(super) fn samples(&self) -> SampleLines {
        let bands: Vec<_> = self.bands.iter().map(|band| &band.samples).collect();
        SampleLines::of([self.width, self.height], &bands)
    }
}
