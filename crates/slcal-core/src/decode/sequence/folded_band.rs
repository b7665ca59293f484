//! Some rows of the image: frames are folded into their planes as they come; what needs another frame first is held.

use std::ops::Range;

use super::frame_plan::FramePlan;
use super::levels::{colors, levels};
use super::planes::Planes;
use super::sample_lines::BandSamples;
use crate::pattern::{Axis, AxisCode, FrameLight};
use crate::photo::PhotoView;

/// What is kept of the frames in some rows.
#[derive(Debug, Clone)]
pub(super) struct FoldedBand {
    pub(super) rows: Range<usize>,
    pub(super) planes: Planes,
    pub(super) samples: BandSamples,
    /// Levels of frames whose partners have not come.
    held: Vec<Held>,
    spare: Vec<Vec<u16>>,
}

#[derive(Debug, Clone)]
struct Held {
    frame: usize,
    levels: Vec<u16>,
}

impl FoldedBand {
    pub(super) fn new(
        codes: [Option<AxisCode>; 2],
        plan: &FramePlan,
        size: [usize; 2],
        rows: Range<usize>,
    ) -> Self {
        let planes = Planes::new(codes, rows.len() * size[0]);
        let samples = BandSamples::new(size, &rows, plan.lights.len());
        Self { rows, planes, samples, held: Vec::new(), spare: Vec::new() }
    }

    /// Forgets all frames.
    pub(super) fn clear(&mut self) {
        self.planes.axes.iter_mut().flatten().for_each(super::planes::AxisPlanes::clear);
        self.spare.extend(self.held.drain(..).map(|held| held.levels));
    }

    /// Folds a frame into the planes, or holds it until the frames come that it needs. `levels_known` says whether white and black have come.
    pub(super) fn fold(&mut self, plan: &FramePlan, levels_known: bool, frame: usize, photo: &PhotoView<'_>) {
        let mut own = self.spare.pop().unwrap_or_default();
        levels(photo, self.rows.clone(), &mut own);
        self.samples.keep(frame, &own);
        match plan.lights[frame] {
            FrameLight::White => {
                std::mem::swap(&mut self.planes.white, &mut own);
                colors(photo, self.rows.clone(), &mut self.planes.color);
            }
            FrameLight::Black => std::mem::swap(&mut self.planes.black, &mut own),
            FrameLight::Sinusoid { axis, step, of, .. } => {
                if let Some(planes) = self.planes.axis(axis) {
                    planes.fold_step(f64::from(step) / f64::from(of), &own);
                }
            }
            FrameLight::Bit { axis, bit, inverted } => {
                if let Some(partner) = plan.partners[frame] {
                    let Some(at) = self.held.iter().position(|h| h.frame == partner) else {
                        self.held.push(Held { frame, levels: own });
                        return;
                    };
                    let other = self.held.swap_remove(at).levels;
                    let (set, unset) = if inverted { (&other, &own) } else { (&own, &other) };
                    if let Some(planes) = self.planes.axis(axis) {
                        planes.fold_bit(bit, set.iter().zip(unset).map(|(a, b)| *a as i16 - *b as i16));
                    }
                    self.spare.push(other);
                } else if levels_known {
                    self.fold_single(axis, bit, inverted, &own);
                } else {
                    self.held.push(Held { frame, levels: own });
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
                    let Held { levels, .. } = self.held.swap_remove(i);
                    self.fold_single(axis, bit, inverted, &levels);
                    self.spare.push(levels);
                }
                _ => i += 1,
            }
        }
    }

    /// Folds a bit without an inverse: its threshold is the mean of white and black.
    fn fold_single(&mut self, axis: Axis, bit: u32, inverted: bool, own: &[u16]) {
        let Planes { white, black, axes, .. } = &mut self.planes;
        let Some(planes) = &mut axes[axis.index()] else { return };
        let contrasts = own.iter().zip(white.iter().zip(black.iter())).map(|(v, (w, b))| {
            // Of noise alone the sum may be larger than any contrast.
            let contrast = (*v as i16 - *w as i16).saturating_add(*v as i16 - *b as i16);
            contrast.max(-i16::MAX)
        });
        if inverted {
            planes.fold_bit(bit, contrasts.map(|c| -c));
        } else {
            planes.fold_bit(bit, contrasts);
        }
    }
}
