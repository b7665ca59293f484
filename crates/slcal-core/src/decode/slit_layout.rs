//! The geometry of the pattern in the order of a scanline: the edges of the slits on the panel, and weights that are
//! the same for every photograph.

/// Slits on the panel, in projector px.
#[derive(Debug, Clone, Default)]
pub(super) struct SlitLayout {
    /// Distance from each slit's centre to the next one's.
    gaps_px: Vec<f32>,
    half_px: f32,
    /// For each slit, one over the width of the dark band before it, and after the last one.
    per_gap: Vec<f32>,
    cubics: Vec<Cubic>,
}

/// The cubic through a slit's edges and the next ones on either side, evaluated at the slit's centre.
#[derive(Debug, Clone, Copy)]
struct Cubic {
    /// Weights of its left and right edge, the one before and the one after.
    weights: [f32; 4],
    /// σ over that of an edge.
    gain: f32,
}

/// No dark band is narrower, projector px.
const MIN_GAP_PX: f32 = 1e-3;

impl SlitLayout {
    /// `gaps_px`: distances between the centres of neighbouring slits, in the order of a scanline.
    pub(super) fn set(&mut self, gaps_px: impl Iterator<Item = f32>, half_px: f32) {
        self.gaps_px.clear();
        self.gaps_px.extend(gaps_px);
        self.set_half_width(half_px);
    }

    /// Sets the width of the slits as measured in the photograph.
    pub(super) fn set_half_width(&mut self, half_px: f32) {
        self.half_px = half_px;
        self.per_gap.clear();
        self.cubics.clear();
        for label in 0..=self.gaps_px.len() {
            let (before, after) = (self.gap_px(label, 0), self.gap_px(label, 1));
            self.per_gap.push(1.0 / (before - 2.0 * half_px).max(MIN_GAP_PX));
            let edges = [-half_px, half_px, half_px - before, after - half_px];
            let one = |i: usize| std::array::from_fn(|k| (edges[k], f32::from(u8::from(k == i))));
            let weight = |i: usize| polynomial_at_zero::<4>(&one(i)).0;
            let weights = [weight(0), weight(1), weight(2), weight(3)];
            self.cubics.push(Cubic { weights, gain: polynomial_at_zero::<4>(&one(0)).1 });
        }
    }

    /// Half the width of the slits.
    pub(super) fn half_px(&self) -> f32 {
        self.half_px
    }

    /// Distance to the slit before (side 0) or after (1); four half-widths beyond the ends of the pattern.
    pub(super) fn gap_px(&self, label: usize, side: usize) -> f32 {
        let at = if side == 0 { label.wrapping_sub(1) } else { label };
        self.gaps_px.get(at).copied().unwrap_or(4.0 * self.half_px)
    }

    /// One over the width of the dark band before or after a slit.
    pub(super) fn per_gap(&self, label: usize, side: usize) -> f32 {
        self.per_gap.get(label + side).copied().unwrap_or(0.5 / self.half_px)
    }

    /// Weights of five centres of neighbouring slits: the middle one minus the cubic through the others.
    pub(super) fn misfit_weights(&self, label: usize) -> [f32; 5] {
        let gap = |slit: usize| self.gap_px(slit, 1);
        let (before, after) = (gap(label.saturating_sub(1)), gap(label));
        let at = [-before - gap(label.saturating_sub(2)), -before, after, after + gap(label + 1)];
        let one = |i: usize| {
            polynomial_at_zero::<4>(&std::array::from_fn(|k| (at[k], f32::from(u8::from(k == i))))).0
        };
        [-one(0), -one(1), 1.0, -one(2), -one(3)]
    }

    /// The weights of the edges of the stripe before, of a stripe's own edges together, and of the stripe after in the cubic.
    pub(super) fn weights_of_stripes(&self, label: usize) -> [f32; 3] {
        self.cubics.get(label).map_or([0.0, 1.0, 0.0], |Cubic { weights: [l, r, b, a], .. }| [*b, l + r, *a])
    }

    /// The cubic through a slit's own edges and the next ones on either side at its centre, and its σ over that of an
    /// edge.
    pub(super) fn cubic(&self, label: usize, own: (f32, f32), before: f32, after: f32) -> (f32, f32) {
        let Some(Cubic { weights: [l, r, b, a], gain }) = self.cubics.get(label) else {
            return (0.5 * (own.0 + own.1), std::f32::consts::FRAC_1_SQRT_2);
        };
        (l * own.0 + r * own.1 + b * before + a * after, *gain)
    }
}

/// Lagrange's polynomial through (projector px, image px) at zero, and its σ over that of the image positions.
pub(super) fn polynomial_at_zero<const N: usize>(nodes: &[(f32, f32); N]) -> (f32, f32) {
    let (mut u, mut variance) = (0.0, 0.0);
    for (i, &(x, at)) in nodes.iter().enumerate() {
        let (mut above, mut below) = (1.0, 1.0);
        for (j, &(other, _)) in nodes.iter().enumerate() {
            if i != j {
                above *= other;
                below *= other - x;
            }
        }
        let weight = above / below;
        u += weight * at;
        variance += weight * weight;
    }
    (u, variance.sqrt())
}
