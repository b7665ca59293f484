//! Live frames, and the photograph that is taken by itself.

use std::sync::Arc;

use image::RgbImage;

use super::state_machine::{Effect, Machine};
use crate::studio::auto_shot::{Seen, is_tilted};
use crate::studio::job::{LiveFrame, LookFor};
use crate::studio::live::Look;
use crate::studio::project::Purpose;
use crate::studio::state::{CameraKind, Picture, Step};

/// The simulated camera takes a live frame this often, ms, and at the latest after the second time where one is lost.
const DEMO_LIVE_MS: u64 = 200;
const DEMO_LOST_MS: u64 = 5000;

impl Machine {
    /// A live frame of the operator's camera.
    pub(in crate::studio) fn frame(&mut self, seq: u32, picture: Arc<RgbImage>) -> Vec<Effect> {
        if self.state.camera.kind != Some(CameraKind::Webcam) {
            return Vec::new();
        }
        vec![Effect::Live(self.live_frame(seq, Some(picture)))]
    }

    pub(super) fn live_frame(&self, seq: u32, picture: Option<Arc<RgbImage>>) -> LiveFrame {
        let look_for = match self.state.step {
            Step::Calibrate if self.state.display.wanted.kind == Picture::Checker => LookFor::Sheet,
            Step::Scan if self.state.scan.continuous => LookFor::Cloud,
            _ => LookFor::Nothing,
        };
        LiveFrame {
            seq,
            picture,
            look_for,
            wanted: self.state.guide.as_ref().map(|g| (g.size, g.quad)),
            scene: self.state.demo_scene,
        }
    }

    /// Time passes: the simulated camera takes its live frames. `watched` says whether a page looks on.
    pub(in crate::studio) fn tick(&mut self, now_ms: u64, watched: bool) -> Vec<Effect> {
        self.now_ms = now_ms;
        let sequence = self.sequence_tick();
        if !sequence.is_empty() {
            return sequence;
        }
        // Its photographs are its live picture; others would have to be traced at another size.
        let shoots = self.sequence.is_some() && !self.flashes();
        if shoots || !self.state.demo || !watched || self.begun.is_none() {
            return Vec::new();
        }
        let lost = self.live_since_ms.is_none_or(|since| now_ms.saturating_sub(since) > DEMO_LOST_MS);
        let pause = if self.state.scan.continuous || self.flashes() { 0 } else { DEMO_LIVE_MS };
        if !lost || now_ms.saturating_sub(self.last_live_ms) < pause {
            return Vec::new();
        }
        self.live_since_ms = Some(now_ms);
        self.last_live_ms = now_ms;
        self.live_seq = self.live_seq.wrapping_add(1);
        vec![Effect::Live(self.live_frame(self.live_seq, None))]
    }

    pub(super) fn looked(&mut self, mut look: Look, now_ms: u64) -> Vec<Effect> {
        self.live_since_ms = None;
        self.now_ms = now_ms;
        let flash = self.flash_seen(look.level);
        // Before anything is calibrated the guide's pose is a guess: any tilt will do.
        let first = self.state.calibration.is_none();
        let seen = look.sheet.map(|quad| Seen {
            quad,
            near: look.near.filter(|_| !first),
            sharpness: look.sharpness.unwrap_or(0.0),
            complete: look.is_complete() && (!first || is_tilted(&quad)),
        });
        let decision = self.auto.frame(now_ms, seen);
        (look.still, look.ready) = (decision.still, decision.ready);
        let wanted = first || self.state.guide.as_ref().is_some_and(|g| g.needed);
        let now = self.state.auto_shot
            && wanted
            && look.ready
            && self.state.step == Step::Calibrate
            && self.state.display.shows_what_is_wanted()
            && self.state.busy.is_none()
            && self.shooting_since_ms.is_none();
        let mut effects = vec![Effect::Look(look)];
        effects.extend(flash);
        if now {
            effects.extend(self.shoot(Purpose::Sheet));
        }
        effects
    }
}
