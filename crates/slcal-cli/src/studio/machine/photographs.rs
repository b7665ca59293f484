//! Photographs: asked for, kept, looked through, left out.

use super::state_machine::{Effect, Machine};
use crate::studio::job::{Job, SheetFound};
use crate::studio::project::{Purpose, StoredPhoto};
use crate::studio::state::{CameraKind, Photograph, Problem, Step};

/// A photograph that has not arrived after this time does not come any more, ms.
pub(super) const SHOT_LOST_MS: u64 = 20_000;
/// Photographs that may be under way at a time.
const SHOTS_REMEMBERED: usize = 8;

impl Machine {
    /// What a photograph shows that is taken now.
    pub(super) fn purpose(&self) -> Result<Purpose, Problem> {
        if let Some(purpose) = self.purpose_in_sequence() {
            return purpose;
        }
        match self.state.step {
            Step::Calibrate => Ok(Purpose::Sheet),
            Step::Scan => Ok(Purpose::Scan),
            Step::SetUp | Step::Use => Err(Problem::new(
                "photograph-unasked",
                "no photograph is expected in this step",
                "go to the step Calibrate or Scan first",
            )),
        }
    }

    /// What a photograph shows that arrives: what its shot was asked for, whatever the step is by now.
    pub(in crate::studio) fn purpose_of(&self, shot: Option<u64>) -> Result<Purpose, Problem> {
        let asked = shot.and_then(|shot| self.asked.iter().find(|(number, _)| *number == shot));
        asked.map_or_else(|| self.purpose(), |(_, purpose)| Ok(*purpose))
    }

    /// Takes a photograph, when the display shows what it should.
    pub(super) fn take(&mut self, purpose: Purpose) -> Result<Vec<Effect>, Problem> {
        self.need(if purpose == Purpose::Scan { Step::Scan } else { Step::Calibrate })?;
        match self.state.camera.kind {
            Some(CameraKind::Webcam | CameraKind::Demo) => {}
            _ => {
                return Err(Problem::new(
                    "camera-own-button",
                    "this camera is released by its own button",
                    "take the photograph with the camera; it appears here by itself",
                ));
            }
        }
        if let Some(problem) = &self.state.camera.problem {
            return Err(problem.clone());
        }
        let display = &self.state.display;
        if let Some(problem) = display.problem.as_ref().filter(|_| display.connected || self.state.demo) {
            return Err(problem.clone());
        }
        if display.connected && display.painted != display.wanted.sequence {
            self.waiting = Some(purpose);
            return Ok(Vec::new());
        }
        Ok(self.shoot(purpose))
    }

    pub(super) fn shoot(&mut self, purpose: Purpose) -> Vec<Effect> {
        self.waiting = None;
        self.shooting_since_ms = Some(self.now_ms);
        if purpose == Purpose::Sheet {
            self.auto.taken();
        }
        if self.sequence.is_none() {
            self.state.busy = Some("taking a photograph");
        }
        if let Some(scene) = self.state.demo_scene {
            return vec![Effect::Work(Job::TakeSimulated(purpose, scene))];
        }
        self.shots += 1;
        self.asked.push_back((self.shots, purpose));
        if self.asked.len() > SHOTS_REMEMBERED {
            self.asked.pop_front();
        }
        vec![Effect::Shoot { shot: self.shots, purpose }]
    }

    /// A photograph was kept in the project's folder.
    pub(in crate::studio) fn kept(&mut self, purpose: Purpose, photo: StoredPhoto) -> Vec<Effect> {
        self.shooting_since_ms = None;
        match purpose {
            Purpose::Sheet => {
                self.state.busy = Some("finding the sheet");
                vec![Effect::Work(Job::Sheet(photo))]
            }
            Purpose::Scan => {
                self.state.busy = Some("reconstructing");
                vec![Effect::Work(Job::Cloud(photo))]
            }
            Purpose::Frame { scan, frame } => self.frame_kept(scan, frame),
        }
    }

    /// Gives a photograph up that does not come; whether there was one.
    pub(in crate::studio) fn give_up(&mut self, now_ms: u64) -> bool {
        if self.give_up_flash(now_ms) {
            return true;
        }
        let late = self.shooting_since_ms.is_some_and(|since| now_ms.saturating_sub(since) > SHOT_LOST_MS);
        if late {
            self.stop_sequence(None);
            (self.shooting_since_ms, self.state.busy) = (None, None);
            self.state.problem = Some(Problem::new(
                "photograph-lost",
                "the photograph did not arrive",
                "take it again; if that fails too, reload the page or choose the camera again",
            ));
        }
        late
    }

    pub(super) fn sheet_found(
        &mut self,
        photo: StoredPhoto,
        found: Result<SheetFound, Problem>,
    ) -> Vec<Effect> {
        let used = !self.left_out.contains(&photo.name);
        let (found, problem) = match found {
            Ok(found) => (Some(found), None),
            Err(problem) => (None, Some(problem)),
        };
        if let Some(problem) = problem.as_ref().filter(|_| used && !self.beginning) {
            let told = format!("{}: {}", photo.name, problem.message);
            self.state.problem = Some(Problem::new("photograph-refused", told, problem.advice.clone()));
        }
        if let Some(size) = found.as_ref().map(|f| f.size).filter(|_| self.state.camera.size.is_none()) {
            self.state.camera.size = Some(size);
        }
        self.state.photographs.retain(|p| p.id != photo.id);
        self.state.photographs.push(Photograph {
            id: photo.id,
            url: format!("/api/photographs/{}.jpg", photo.id),
            name: photo.name,
            used,
            corners: found.as_ref().map_or(0, |f| f.corners),
            of: found.as_ref().map_or(0, |f| f.of),
            rms_px: None,
            tilt_deg: None,
            outline: found.as_ref().and_then(|f| f.outline),
            size: found.as_ref().map(|f| f.size),
            problem,
        });
        self.state.photographs.sort_by_key(|p| p.id);
        if self.beginning {
            return Vec::new();
        }
        self.state.busy = None;
        if found.is_none() || !used {
            return Vec::new();
        }
        self.recalibrate()
    }

    pub(super) fn use_photograph(&mut self, id: u32, used: bool) -> Result<Vec<Effect>, Problem> {
        let photo = self.state.photographs.iter_mut().find(|p| p.id == id);
        let photo = photo.ok_or_else(|| Problem::new("no-photograph", "there is no such photograph", ""))?;
        photo.used = used;
        if used {
            self.left_out.remove(&photo.name);
        } else {
            self.left_out.insert(photo.name.clone());
        }
        let mut effects = vec![Effect::Save];
        if !used && self.state.photographs.iter().any(|p| p.problem.is_some()) {
            // It may have hindered the others: the first photograph says which size all have.
            self.begun = None;
            effects.extend(self.begin());
        } else {
            effects.extend(self.recalibrate());
        }
        Ok(effects)
    }
}
