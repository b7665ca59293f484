//! The camera's delay, measured by a flash: the display turns from black to white, and the frame in which that arrives is looked for.

/// The picture before may be seen for so long after black was painted, ms.
const DARK_MS: u64 = 800;
/// So long after white was painted the camera has adapted to nothing yet, and shows all of the light, ms.
const LIGHT_MS: u64 = 800;
/// White that has not arrived after this time and so many frames does not come.
const LATEST_MS: u64 = 4000;
const MOST_FRAMES: usize = 8;
/// A camera that sends no frame for so long sends none any more, ms: the simulated one traces a new scene first.
const NO_FRAME_MS: u64 = 30_000;
/// Frames under black that tell how much the level changes by itself.
const DARK_FRAMES: usize = 4;
/// They differ by less than this share of full scale, or so many frames were waited for: the light flickers.
const STEADY: f64 = 0.005;
const MOST_DARK_FRAMES: usize = 20;
/// Frames that show white before its level is believed.
const LIGHT_FRAMES: usize = 3;
/// White differs from black by this many times what the level changes by itself, and by this share of full scale.
const BY_ITSELF: f64 = 5.0;
const LEAST_RISE: f64 = 0.004;
/// Share of the rise at which white has arrived: a frame that was exposed half before it shows half of it.
const ARRIVED: f64 = 0.9;
/// Least time after the frame in which white arrived, ms.
const LEAST_MARGIN_MS: u64 = 50;

/// What the flash says after a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seen {
    /// More frames are needed.
    Wait,
    /// Black is known: show white.
    ShowWhite,
    Delay(Delay),
    /// The camera does not see the projector's light.
    Nothing,
}

/// The delay of display and camera together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Delay {
    /// From what was painted to the frame in which it arrives, ms.
    pub(super) latency_ms: u64,
    /// How long to wait after a picture was painted, ms: that, and the time from one frame to the next.
    pub(super) wait_ms: u64,
}

/// A measurement that is under way.
#[derive(Debug, Clone, Default)]
pub(super) struct Flash {
    /// When black, then white, was painted, ms.
    black_ms: Option<u64>,
    white_ms: Option<u64>,
    /// When something was painted or a frame came last, ms.
    last_ms: u64,
    /// Whether white was asked for.
    is_asked: bool,
    /// Levels of the newest frames under black.
    dark: Vec<f64>,
    /// How many came.
    dark_frames: usize,
    /// Time after white was painted, and the level of each frame.
    light: Vec<(u64, f64)>,
}

impl Flash {
    /// The display has painted what was wanted last: black first, then white.
    pub(super) fn painted(&mut self, now_ms: u64) {
        self.last_ms = now_ms;
        if self.black_ms.is_none() {
            self.black_ms = Some(now_ms);
        } else if self.white_ms.is_none() {
            self.white_ms = Some(now_ms);
        }
    }

    /// Takes the mean level of a frame, as a share of full scale.
    pub(super) fn frame(&mut self, now_ms: u64, level: f64) -> Seen {
        self.last_ms = now_ms;
        if let Some(white) = self.white_ms {
            self.light.push((now_ms.saturating_sub(white), level));
            return self.delay();
        }
        let Some(black) = self.black_ms else { return Seen::Wait };
        // Once white was asked for, it may be seen before the display says so.
        if self.is_asked {
            return Seen::Wait;
        }
        if self.dark.len() >= DARK_FRAMES {
            self.dark.remove(0);
        }
        self.dark.push(level);
        self.dark_frames += 1;
        // One that was under way when black was painted shows the picture before.
        let is_steady = self.dark_by_itself() < STEADY || self.dark_frames > MOST_DARK_FRAMES;
        let is_known = self.dark.len() == DARK_FRAMES && is_steady;
        self.is_asked = is_known && now_ms.saturating_sub(black) >= DARK_MS;
        if self.is_asked { Seen::ShowWhite } else { Seen::Wait }
    }

    /// Whether a frame should have come by now.
    pub(super) fn is_late(&self, now_ms: u64) -> bool {
        self.black_ms.is_some() && now_ms.saturating_sub(self.last_ms) > NO_FRAME_MS
    }

    fn dark_level(&self) -> f64 {
        self.dark.iter().sum::<f64>() / self.dark.len().max(1) as f64
    }

    /// How much the level under black changes by itself.
    fn dark_by_itself(&self) -> f64 {
        let dark = self.dark_level();
        self.dark.iter().map(|level| (level - dark).abs()).fold(0.0, f64::max)
    }

    /// What the frames under white say so far.
    fn delay(&self) -> Seen {
        let Some(&(elapsed, _)) = self.light.last() else { return Seen::Wait };
        let is_late = elapsed > LATEST_MS && self.light.len() >= MOST_FRAMES;
        let late = if is_late { Seen::Nothing } else { Seen::Wait };
        if elapsed < LIGHT_MS || self.light.len() < LIGHT_FRAMES {
            return late;
        }
        let (dark, by_itself) = (self.dark_level(), self.dark_by_itself());
        // The last frames agree on how bright white is, or it has not arrived whole.
        let last = &self.light[self.light.len() - LIGHT_FRAMES..];
        let white = last.iter().map(|(_, level)| *level).fold(f64::INFINITY, f64::min);
        let rise = white - dark;
        if rise < LEAST_RISE.max(BY_ITSELF * by_itself) {
            return late;
        }
        let arrived = self.light.iter().find(|(_, level)| *level >= dark + ARRIVED * rise);
        let Some(&(latency_ms, _)) = arrived else { return late };
        let between = elapsed / self.light.len().max(1) as u64;
        Seen::Delay(Delay { latency_ms, wait_ms: latency_ms + between.max(LEAST_MARGIN_MS) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames every `pause` ms of a camera that sees a change after `latency` ms; the last word and when it came.
    fn measured(pause: u64, latency: u64, rise: f64, noise: f64) -> Seen {
        let mut flash = Flash::default();
        flash.painted(1000);
        let mut white = None;
        for i in 0.. {
            let now = 1000 + i * pause;
            let lit = white.is_some_and(|at| now >= at + latency);
            let level = 0.1 + if lit { rise } else { 0.0 } + if i % 2 == 0 { noise } else { -noise };
            match flash.frame(now, level) {
                Seen::Wait => assert!(now < 20_000, "nothing was decided"),
                Seen::ShowWhite => {
                    assert!(white.is_none() && now >= 1000 + DARK_MS);
                    white = Some(now + 30);
                    flash.painted(now + 30);
                }
                done => return done,
            }
        }
        Seen::Wait
    }

    #[test]
    fn the_delay_is_that_of_the_frame_in_which_white_arrives() {
        for (pause, latency) in [(33, 120), (66, 40), (200, 350), (10, 0)] {
            let Seen::Delay(delay) = measured(pause, latency, 0.2, 0.001) else {
                panic!("{pause} {latency}")
            };
            assert!(
                (latency..latency + 2 * pause).contains(&delay.latency_ms),
                "{pause} {latency} {delay:?}"
            );
            assert!(delay.wait_ms >= delay.latency_ms + LEAST_MARGIN_MS.max(pause / 2), "{delay:?}");
        }
    }

    #[test]
    fn a_camera_that_sees_no_light_is_told() {
        assert_eq!(measured(33, 100, 0.002, 0.0), Seen::Nothing);
        // A lamp that flickers is no flash.
        assert_eq!(measured(33, 100, 0.03, 0.02), Seen::Nothing);
        assert_eq!(measured(33, 9000, 0.3, 0.0), Seen::Nothing);
        let mut flash = Flash::default();
        assert!(!flash.is_late(90_000));
        flash.painted(0);
        assert!(!flash.is_late(NO_FRAME_MS) && flash.is_late(NO_FRAME_MS + 1));
    }

    #[test]
    fn white_may_be_seen_before_the_display_says_that_it_was_painted() {
        let mut flash = Flash::default();
        flash.painted(0);
        let asked =
            (0..10_000).map(|i| 50 * i).find(|now| flash.frame(*now, 0.1) == Seen::ShowWhite).unwrap();
        (1..6).for_each(|i| assert_eq!(flash.frame(asked + 10 * i, 0.3), Seen::Wait));
        flash.painted(asked + 60);
        let found = (7..200).map(|i| flash.frame(asked + 10 * i, 0.3)).find(|seen| *seen != Seen::Wait);
        assert!(matches!(found, Some(Seen::Delay(Delay { latency_ms: 10, .. }))), "{found:?}");
    }

    #[test]
    fn a_slow_camera_may_still_show_the_picture_before_black() {
        let mut flash = Flash::default();
        flash.painted(0);
        let levels = [0.3, 0.3, 0.1, 0.1, 0.1, 0.1];
        let seen: Vec<Seen> = levels.iter().zip(1..).map(|(level, i)| flash.frame(900 * i, *level)).collect();
        assert_eq!(seen.iter().position(|s| *s == Seen::ShowWhite), Some(5));
        flash.painted(6000);
        let found = (1..9).map(|i| flash.frame(6000 + 900 * i, 0.3)).find(|seen| *seen != Seen::Wait);
        assert!(matches!(found, Some(Seen::Delay(Delay { latency_ms: 900, .. }))), "{found:?}");
    }

    #[test]
    fn a_frame_that_was_exposed_half_before_white_does_not_count() {
        let mut flash = Flash::default();
        flash.painted(0);
        (0..40).for_each(|i| assert_ne!(flash.frame(i * 50, 0.1), Seen::Nothing));
        flash.painted(2000);
        assert_eq!(flash.frame(2100, 0.1), Seen::Wait);
        assert_eq!(flash.frame(2200, 0.2), Seen::Wait);
        let seen: Vec<Seen> = (3..20).map(|i| flash.frame(2000 + 100 * i, 0.3)).collect();
        let found = seen.iter().find(|seen| **seen != Seen::Wait).unwrap();
        assert!(matches!(found, Seen::Delay(Delay { latency_ms: 300, .. })), "{found:?}");
    }
}
