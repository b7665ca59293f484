//! When a photograph is taken by itself: the sheet near the wanted pose, sharp, and still.

/// The sheet counts as still when no corner moves by more than this share of its diagonal between frames.
const STILL_SHARE: f64 = 0.004;
/// For this long.
const STILL_MS: u64 = 600;
/// Nearness, 0 to 1, from which on the wanted pose is reached.
const NEAR: f64 = 0.55;
/// Sharpness, 0 to 1, below which the picture is blurred.
const SHARP: f64 = 0.35;
/// After a photograph the sheet must move by this share of its diagonal before the next.
const MOVED_SHARE: f64 = 0.05;

/// The corners of a sheet, px.
pub(super) type Quad = [[f64; 2]; 4];

/// A side is longer than the opposite one by this factor when the sheet is tilted enough to say something about focal lengths.
const TILTED: f64 = 1.1;

/// Whether perspective shows: a sheet that is seen face-on says nothing about focal lengths.
pub(super) fn is_tilted(quad: &Quad) -> bool {
    let side = |i: usize| {
        let (a, b) = (quad[i], quad[(i + 1) % 4]);
        (a[0] - b[0]).hypot(a[1] - b[1]).max(1.0)
    };
    let ratio = |i: usize| (side(i) / side(i + 2)).max(side(i + 2) / side(i));
    ratio(0).max(ratio(1)) >= TILTED
}

/// What one frame shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) quad: Quad,
    /// Nearness to the wanted pose; `None` where any pose will do.
    pub(super) near: Option<f64>,
    pub(super) sharpness: f64,
    /// Whether all that calibration needs was found.
    pub(super) complete: bool,
}

/// What follows from the frames so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Decision {
    pub(super) still: bool,
    /// Whether everything is as a photograph needs it.
    pub(super) ready: bool,
}

/// The frames so far, as far as they matter.
#[derive(Debug, Clone, Default)]
pub(super) struct AutoShot {
    last: Option<Quad>,
    still_since_ms: Option<u64>,
    /// Where the sheet was in the last photograph.
    taken_at: Option<Quad>,
}

impl AutoShot {
    /// Takes a frame; `None` where no sheet is seen.
    pub(super) fn frame(&mut self, now_ms: u64, seen: Option<Seen>) -> Decision {
        let Some(seen) = seen else {
            (self.last, self.still_since_ms) = (None, None);
            return Decision::default();
        };
        let moved = self.last.map_or(f64::INFINITY, |last| moved_share(&last, &seen.quad));
        self.last = Some(seen.quad);
        if moved > STILL_SHARE {
            self.still_since_ms = None;
            return Decision::default();
        }
        let since = *self.still_since_ms.get_or_insert(now_ms);
        let still = now_ms.saturating_sub(since) >= STILL_MS;
        let elsewhere = self.taken_at.is_none_or(|taken| moved_share(&taken, &seen.quad) > MOVED_SHARE);
        let good = seen.complete && seen.sharpness >= SHARP && seen.near.is_none_or(|near| near >= NEAR);
        Decision { still, ready: still && good && elsewhere }
    }

    /// A photograph was taken with the sheet where it is now.
    pub(super) fn taken(&mut self) {
        // Where no sheet is seen it was not moved either.
        self.taken_at = self.last.or(self.taken_at);
        self.still_since_ms = None;
    }
}

/// Largest movement of a corner, in diagonals of the sheet.
fn moved_share(from: &Quad, to: &Quad) -> f64 {
    let far = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let moved = from.iter().zip(to).map(|(a, b)| far(*a, *b)).fold(0.0, f64::max);
    moved / far(to[0], to[2]).max(1.0)
}

/// How near a sheet is to the wanted one: 1 at the same place, 0 when corners are a quarter of the diagonal apart.
pub(super) fn nearness(seen: &Quad, wanted: &Quad) -> f64 {
    const FAR_SHARE: f64 = 0.25;
    (1.0 - moved_share(seen, wanted) / FAR_SHARE).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(shift: f64) -> Seen {
        let quad =
            [[100.0, 100.0], [500.0, 100.0], [500.0, 400.0], [100.0, 400.0]].map(|[x, y]| [x + shift, y]);
        Seen { quad, near: Some(1.0), sharpness: 1.0, complete: true }
    }

    #[test]
    fn a_still_sheet_is_taken_once() {
        let mut shots = AutoShot::default();
        let ready: Vec<bool> = (0..8).map(|i| shots.frame(200 * i, Some(seen(0.0))).ready).collect();
        assert_eq!(ready, [false, false, false, false, true, true, true, true]);
        shots.taken();
        assert!((8..20).all(|i| !shots.frame(200 * i, Some(seen(0.0))).ready));
        // Moved, and held still again.
        assert!((20..30).any(|i| shots.frame(200 * i, Some(seen(60.0))).ready));
    }

    #[test]
    fn what_moves_is_blurred_incomplete_or_far_is_not_taken() {
        let never = |change: fn(usize, &mut Seen)| {
            let mut shots = AutoShot::default();
            (0..20).all(|i| {
                let mut s = seen(0.0);
                change(i, &mut s);
                !shots.frame(200 * i as u64, Some(s)).ready
            })
        };
        assert!(never(|i, s| *s = seen(3.0 * i as f64)));
        assert!(never(|_, s| s.sharpness = 0.1));
        assert!(never(|_, s| s.complete = false));
        assert!(never(|_, s| s.near = Some(0.2)));
        assert!(!never(|_, s| s.near = None));
    }

    #[test]
    fn only_perspective_is_tilt() {
        assert!(!is_tilted(&seen(0.0).quad));
        assert!(!is_tilted(&[[0.0, 0.0], [400.0, 50.0], [350.0, 350.0], [-50.0, 300.0]]));
        assert!(is_tilted(&[[0.0, 0.0], [400.0, 40.0], [400.0, 260.0], [0.0, 300.0]]));
    }

    #[test]
    fn nearness_falls_with_the_distance_of_the_corners() {
        let quad = seen(0.0).quad;
        assert_eq!(nearness(&quad, &quad), 1.0);
        assert!(nearness(&seen(50.0).quad, &quad) < 0.7);
        assert_eq!(nearness(&seen(200.0).quad, &quad), 0.0);
    }
}
