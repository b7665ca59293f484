//! Features of crossings, and whether neighbouring ones lie on one continuous surface.

/// Cost of continuing with the next slit across an apparent change of surface: the crossings are more than `FAR` times
/// as far apart as their widths suggest, or their light differs by more than a factor of `BRIGHTER`. Twice that factor
/// costs twice as much.
const BREAK_COST: f32 = 2.5;
const FAR: f32 = 1.7;
pub(super) const BRIGHTER: f32 = 2.0;
/// A gap of one slit is between this many periods wide and one more.
const NEAR_TWO: f32 = 1.5;
/// Marks a slit or crossing without a match.
pub(super) const NONE: u16 = u16::MAX;

/// The features of a crossing that enter the alignment.
#[derive(Debug, Clone, Copy)]
pub(super) struct CrossingFeatures {
    /// Position along the scanline, px.
    pub(super) u: f32,
    /// Width, px.
    pub(super) width: f32,
    /// Light relative to what is usual for its class.
    pub(super) light: f32,
    /// The slit found by earlier passes, or [`NONE`], and its share of the votes along the track.
    pub(super) prior: (u16, f32),
}

/// The cost of a step from one crossing to another.
pub(super) struct StepCost {
    /// With the next slit.
    pub(super) next: f32,
    /// With the slit after the next.
    pub(super) missed: f32,
    /// Whether light and distance suggest one continuous surface.
    pub(super) continuity: Continuity,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Continuity {
    Continuous,
    /// The light differs: a shadow, a fold, or another surface.
    Uncertain,
    Broken,
}

/// Whether one number is more than `by` times the other.
#[inline]
pub(super) fn differ_by_factor(a: f32, b: f32, by: f32) -> bool {
    a > by * b || b > by * a
}

/// Whether the light of two neighbours differs by more than a factor. Where a surface turns away from the projector, a
/// slit's light spreads over more of it; light times width then changes less than light.
#[inline]
pub(super) fn differ_in_light(a: &CrossingFeatures, b: &CrossingFeatures, by: f32) -> bool {
    differ_by_factor(a.light, b.light, by) && differ_by_factor(a.light * a.width, b.light * b.width, by)
}

/// The step to crossing `i` from the one `back` before it.
#[inline]
pub(super) fn step(features: &[CrossingFeatures], i: usize, back: usize, period_per_width: f32) -> StepCost {
    let Some(a) = i.checked_sub(back).map(|i| &features[i]) else {
        return StepCost { next: 0.0, missed: 0.0, continuity: Continuity::Continuous };
    };
    let b = &features[i];
    let (distance, period) = (b.u - a.u, 0.5 * (a.width + b.width) * period_per_width);
    let (twice, much) = (differ_in_light(a, b, BRIGHTER), differ_in_light(a, b, 2.0 * BRIGHTER));
    let lit = BREAK_COST * (f32::from(u8::from(twice)) + f32::from(u8::from(much)));
    let spaced = |fits: bool| if fits { lit } else { BREAK_COST };
    let far = distance > FAR * period;
    let continuity = if far || much {
        Continuity::Broken
    } else if twice {
        Continuity::Uncertain
    } else {
        Continuity::Continuous
    };
    StepCost {
        next: spaced(!far),
        missed: spaced(distance >= NEAR_TWO * period && distance < (NEAR_TWO + 1.0) * period),
        continuity,
    }
}
