//! What becomes of each frame of a sequence, and in which order frames are best read.

use crate::pattern::{FrameLight, SequencePattern};

/// The frames of a sequence, with the partners of those that are folded in pairs.
#[derive(Debug, Clone)]
pub(super) struct FramePlan {
    pub(super) lights: Vec<FrameLight>,
    /// For a bit that is shown as it is and inverted, the other of its two frames.
    pub(super) partners: Vec<Option<usize>>,
    /// First those that others need, then pairs together: nothing is held for longer than its partner takes.
    pub(super) reading_order: Vec<usize>,
}

impl FramePlan {
    pub(super) fn of(pattern: &SequencePattern) -> Self {
        let lights: Vec<FrameLight> = pattern.frames.iter().map(|f| f.light).collect();
        let partner = |light: &FrameLight| {
            let FrameLight::Bit { axis, bit, inverted } = *light else { return None };
            let other = FrameLight::Bit { axis, bit, inverted: !inverted };
            lights.iter().position(|l| *l == other)
        };
        let partners: Vec<_> = lights.iter().map(partner).collect();
        let is_level = |i: &usize| matches!(lights[*i], FrameLight::White | FrameLight::Black);
        let mut reading_order: Vec<usize> = (0..lights.len()).filter(is_level).collect();
        for i in (0..lights.len()).filter(|i| !is_level(i)) {
            if !reading_order.contains(&i) {
                reading_order.push(i);
                reading_order.extend(partners[i]);
            }
        }
        Self { lights, partners, reading_order }
    }

    /// Where a frame stands in the sequence.
    pub(super) fn position(&self, light: FrameLight) -> Option<usize> {
        self.lights.iter().position(|l| *l == light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::{SequencePattern, SequencePreset};

    #[test]
    fn white_and_black_come_first_and_pairs_together() {
        let pattern = SequencePattern::preset([1024, 768], SequencePreset::OpencvGray, None).unwrap();
        let plan = FramePlan::of(&pattern);
        assert_eq!(plan.reading_order[..4], [40, 41, 0, 1]);
        let mut all = plan.reading_order.clone();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..42));
        assert_eq!(plan.partners[7], Some(6));
        // All bits, then all inverses.
        let mut far = pattern.clone();
        far.frames = [0, 1]
            .iter()
            .flat_map(|odd| (0..20).map(move |i| 2 * i + odd))
            .map(|i| pattern.frames[i].clone())
            .collect();
        assert_eq!(FramePlan::of(&far).reading_order[..4], [0, 20, 1, 21]);
    }
}
