//! The step Calibrate: the rig and the pose to photograph next.

use super::state_machine::{Effect, Machine};
use crate::studio::job::{Calibrated, Job};
use crate::studio::page_calibration::PageCalibration;
use crate::studio::pose_angles::{demo_pose, tilt_deg};
use crate::studio::state::{Problem, Step};
use crate::studio::words::command;

impl Machine {
    /// The first pose can be advised when the size of the photographs is known.
    pub(super) fn ask_for_first_guide(&self) -> Option<Effect> {
        let missing = self.state.guide.is_none() && self.state.calibration.is_none();
        let size = self.state.camera.size.filter(|_| missing && self.begun.is_some())?;
        Some(Effect::Work(Job::FirstGuide(size)))
    }

    pub(super) fn recalibrate(&mut self) -> Vec<Effect> {
        let used = self.state.used();
        if used.is_empty() {
            (self.state.calibration, self.rig, self.state.guide) = (None, None, None);
            for photo in &mut self.state.photographs {
                (photo.rms_px, photo.tilt_deg) = (None, None);
            }
            let forget = Effect::Work(Job::Forget);
            return std::iter::once(forget).chain(self.ask_for_first_guide()).collect();
        }
        self.state.busy = Some("calibrating");
        vec![Effect::Work(Job::Calibrate(used))]
    }

    pub(super) fn calibrated(&mut self, result: Result<Calibrated, Problem>) -> Vec<Effect> {
        self.state.busy = None;
        match result {
            Err(problem) => {
                (self.state.calibration, self.rig) = (None, None);
                self.state.problem = Some(problem);
                Vec::new()
            }
            Ok(Calibrated { rig, fingerprint, used, guide }) => {
                for photo in &mut self.state.photographs {
                    let view = used.iter().position(|id| *id == photo.id).and_then(|i| rig.views.get(i));
                    photo.rms_px = view.and_then(|v| v.rms_px).map(|r| r.corners.unwrap_or(r.edges));
                    photo.tilt_deg = view.map(|v| tilt_deg(&v.camera_from_sheet));
                }
                if self.state.calibration.is_some() {
                    // It was drawn for the rig before.
                    (self.state.in_use.picture, self.state.in_use.picture_file) = (None, None);
                }
                self.state.calibration = Some(PageCalibration::new(&rig, self.state.calibration.as_ref()));
                self.state.guide = guide;
                self.keep_turn_to_demo();
                self.state.problem = None;
                self.state.in_use.reports = vec!["/report"];
                self.last_pose = rig.views.last().map(|v| demo_pose(&v.camera_from_sheet, v.size));
                self.put_sheet_back();
                (self.rig, self.fingerprint) = (Some(rig), fingerprint);
                self.compare_clouds();
                let log =
                    command(&self.state).filter(|_| self.state.step == Step::Calibrate).map(Effect::Log);
                let clouds = self.clouds_missing.drain(..).map(Effect::Work);
                log.into_iter().chain(clouds).collect()
            }
        }
    }

    /// Only a simulated sheet can be told where to go.
    pub(super) fn keep_turn_to_demo(&mut self) {
        if !self.state.demo
            && let Some(guide) = &mut self.state.guide
        {
            guide.turn = None;
        }
    }
}
