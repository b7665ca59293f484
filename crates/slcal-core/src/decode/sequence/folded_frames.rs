//! Frames are folded into the planes as they come; what needs another frame first is held.

use super::frame_plan::FramePlan;
use super::levels::{LevelScale, levels};
use super::planes::{AxisPlanes, Planes};
use super::sample_lines::SampleLines;
use crate::pattern::{Axis, FrameLight, SequencePattern};
use crate::photo::PhotoView;

/// What is kept while frames come.
#[derive(Debug, Clone)]
pub(super) struct FoldedFrames {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) scale: LevelScale,
    pub(super) planes: Planes,
    pub(super) samples: SampleLines,
    /// Levels of frames whose partners have not come, with the first pixel that they are of.
    held: Vec<Held>,
    spare: Vec<Vec<u16>>,
}

#[derive(Debug, Clone)]
struct Held {
    frame: usize,
    start: usize,
    levels: Vec<u16>,
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
        let shown = |light| plan.position(light).is_some();
        let planes = Planes::new(codes, width * height, shown(FrameLight::White), shown(FrameLight::Black));
        let samples = SampleLines::new(width, height, plan.lights.len());
        Self { width, height, scale, planes, samples, held: Vec::new(), spare: Vec::new() }
    }

    pub(super) fn clear(&mut self) {
        self.planes.axes.iter_mut().flatten().for_each(AxisPlanes::clear);
        self.spare.extend(self.held.drain(..).map(|held| held.levels));
    }

    /// Folds rows of a frame into the planes, or holds them until the frames come that they need.
    pub(super) fn fold(
        &mut self,
        plan: &FramePlan,
        seen: &[bool],
        frame: usize,
        photo: &PhotoView<'_>,
        rows: std::ops::Range<usize>,
    ) {
        let levels_known =
            [FrameLight::White, FrameLight::Black].iter().all(|l| plan.position(*l).is_some_and(|i| seen[i]));
        let start = rows.start * self.width;
        let mut own = self.spare.pop().unwrap_or_default();
        levels(photo, rows.clone(), &mut own);
        self.samples.keep(frame, rows.start, &own);
        let range = start..start + own.len();
        match plan.lights[frame] {
            FrameLight::White => {
                self.planes.white[range.clone()].copy_from_slice(&own);
                for (to, i) in self.planes.color[range.clone()].iter_mut().zip(range.clone()) {
                    *to = photo.rgb_bytes(i % self.width, i / self.width);
                }
            }
            FrameLight::Black => self.planes.black[range.clone()].copy_from_slice(&own),
            FrameLight::Sinusoid { axis, step, of, .. } => {
                if let Some(planes) = self.planes.axis(axis) {
                    planes.fold_step(f64::from(step) / f64::from(of), start, &own);
                }
            }
            FrameLight::Bit { axis, bit, inverted } => {
                if let Some(partner) = plan.partners[frame] {
                    let Some(at) = self.held.iter().position(|h| h.frame == partner && h.start == start)
                    else {
                        self.held.push(Held { frame, start, levels: own });
                        return;
                    };
                    let other = self.held.swap_remove(at).levels;
                    let (set, unset) = if inverted { (&other, &own) } else { (&own, &other) };
                    if let Some(planes) = self.planes.axis(axis) {
                        let pairs = set.iter().zip(unset);
                        planes.fold_bit(bit, start, pairs.map(|(a, b)| i32::from(*a) - i32::from(*b)));
                    }
                    self.spare.push(other);
                } else if levels_known {
                    self.fold_single(axis, bit, inverted, start, &own);
                } else {
                    self.held.push(Held { frame, start, levels: own });
                    return;
                }
            }
        }
        self.spare.push(own);
        if levels_known {
            self.fold_waiting(plan);
        }
    }

    /// Folds bits without inverses that came before white and black.
    fn fold_waiting(&mut self, plan: &FramePlan) {
        let mut i = 0;
        while i < self.held.len() {
            match plan.lights[self.held[i].frame] {
                FrameLight::Bit { axis, bit, inverted } if plan.partners[self.held[i].frame].is_none() => {
                    let Held { start, levels, .. } = self.held.swap_remove(i);
                    self.fold_single(axis, bit, inverted, start, &levels);
                    self.spare.push(levels);
                }
                _ => i += 1,
            }
        }
    }

    /// Folds a bit without an inverse: its threshold is the mean of white and black.
    fn fold_single(&mut self, axis: Axis, bit: u32, inverted: bool, start: usize, own: &[u16]) {
        let Planes { white, black, axes, .. } = &mut self.planes;
        let Some(planes) = &mut axes[axis.index()] else { return };
        let sign = if inverted { -1 } else { 1 };
        let thresholds =
            white[start..].iter().zip(&black[start..]).map(|(w, b)| i32::from(*w) + i32::from(*b));
        planes.fold_bit(
            bit,
            start,
            own.iter().zip(thresholds).map(|(v, sum)| sign * (2 * i32::from(*v) - sum)),
        );
    }
}
