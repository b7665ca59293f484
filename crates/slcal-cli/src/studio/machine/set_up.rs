//! The step Set up: panel, sheet, pattern and camera.

use super::state_machine::{Effect, Machine};
use crate::studio::job::{Bench, Job};
use crate::studio::simulated_camera::PHOTO_PX;
use crate::studio::state::{CameraKind, Problem, Step};

/// Scale of the pattern, as a share of the usual one.
const PATTERN_SCALES: std::ops::RangeInclusive<f64> = 0.2..=1.2;
/// Sides of a panel, px.
const PANEL_SIDES: std::ops::RangeInclusive<u32> = 64..=16_384;

impl Machine {
    pub(super) fn set_up(
        &mut self,
        projector: Option<[u32; 2]>,
        size: Option<String>,
        scale: Option<f64>,
    ) -> Result<Vec<Effect>, Problem> {
        self.state.set_up.problem = None;
        let wrong = |problem: Problem, machine: &mut Self| {
            machine.state.set_up.problem = Some(problem.clone());
            Err(problem)
        };
        if projector.is_some_and(|p| p.iter().any(|side| !PANEL_SIDES.contains(side))) {
            let problem = Problem::new(
                "set-up-projector",
                "the projector's resolution is not that of a projector: its sides have 64 to 16384 pixels",
                "give its native resolution, for example 1920x1080; its manual and the display settings state it",
            );
            return wrong(problem, self);
        }
        if size.as_deref().is_some_and(|size| size.parse::<slcal_core::SheetSize>().is_err()) {
            let problem = Problem::new(
                "set-up-size",
                "this is not the size of a sheet",
                "type width x height with a unit, such as 297x210mm, or a paper: A4, letter",
            );
            return wrong(problem, self);
        }
        if scale.is_some_and(|s| !PATTERN_SCALES.contains(&s)) {
            let problem = Problem::new(
                "set-up-pattern",
                "the pattern would not fit",
                "choose a scale from 20 to 120 %",
            );
            return wrong(problem, self);
        }
        let set_up = &self.state.set_up;
        let other_pattern = projector.is_some_and(|p| set_up.projector.is_some_and(|q| q != p))
            || scale.is_some_and(|s| s != set_up.pattern_scale);
        if other_pattern && (self.beginning || !self.state.photographs.is_empty()) {
            let problem = Problem::new(
                "set-up-photographs",
                "there are photographs of the present pattern, which another one would contradict",
                "start slcal studio with another --dir for another pattern or projector",
            );
            return wrong(problem, self);
        }
        let set_up = &mut self.state.set_up;
        set_up.projector = projector.or(set_up.projector);
        set_up.size = size.or_else(|| set_up.size.take());
        set_up.pattern_scale = scale.unwrap_or(set_up.pattern_scale);
        self.check_display();
        let mut effects = self.begin();
        if !effects.is_empty() {
            (self.state.in_use.picture, self.state.in_use.picture_file) = (None, None);
        }
        self.set_up_changed();
        effects.push(Effect::Save);
        Ok(effects)
    }

    /// Has the patterns drawn and the photographs looked through when panel, sheet or pattern are new.
    pub(super) fn begin(&mut self) -> Vec<Effect> {
        let Some((projector, sheet)) = self.state.set_up.known() else { return Vec::new() };
        let bench = Bench { projector, sheet, pattern_scale: self.state.set_up.pattern_scale };
        if self.begun == Some(bench) {
            return Vec::new();
        }
        self.stop_sequence(None);
        self.begun = Some(bench);
        self.beginning = true;
        self.state.photographs.clear();
        self.state.scan.clouds.clear();
        self.state.scan.unfinished.clear();
        self.clouds_missing.clear();
        (self.state.guide, self.state.calibration, self.rig) = (None, None, None);
        self.state.busy = Some("drawing the patterns");
        vec![Effect::Work(Job::Begin(bench, self.left_out.clone()))]
    }

    pub(super) fn set_up_changed(&mut self) {
        let set_up = &mut self.state.set_up;
        set_up.missing = if set_up.projector.is_none() {
            Some("Open the display window on the projector: it measures the resolution. Or type it.")
        } else if set_up.sheet().is_none() {
            Some("Give the size of the white sheet.")
        } else if set_up.camera.is_none() {
            Some("Choose the camera.")
        } else {
            None
        };
        set_up.done = set_up.missing.is_none();
        if let Some(locked) =
            Some(self.state.step).filter(|s| *s > Step::Calibrate || !self.state.set_up.done)
        {
            // A calibration of an earlier run is looked through first.
            if self.state.locked(locked).is_some() && !self.beginning {
                self.state.step = if self.state.set_up.done { Step::Calibrate } else { Step::SetUp };
            }
        }
    }

    pub(super) fn camera(
        &mut self,
        kind: CameraKind,
        size: Option<[u32; 2]>,
        held: Vec<String>,
    ) -> Result<Vec<Effect>, Problem> {
        if (kind == CameraKind::Demo) != self.state.demo {
            return Err(Problem::new(
                "camera-other",
                "the simulated camera belongs to slcal studio --demo",
                "choose another camera",
            ));
        }
        if kind == CameraKind::Folder && self.state.set_up.watch.is_none() {
            return Err(Problem::new(
                "camera-no-folder",
                "no folder is watched",
                "start slcal studio with --watch FOLDER",
            ));
        }
        if self.state.camera.kind != Some(kind) || self.state.camera.size != size {
            (self.delay, self.state.camera.latency_ms) = (None, None);
        }
        if self.state.camera.kind != Some(kind) {
            self.stop_sequence(Some(Problem::new(
                "scan-interrupted",
                "another camera was chosen: the sequence is not complete",
                "scan again",
            )));
        }
        self.state.set_up.camera = Some(kind);
        let camera = &mut self.state.camera;
        camera.kind = Some(kind);
        camera.connected = kind != CameraKind::Webcam || size.is_some();
        camera.problem = None;
        camera.size = if kind == CameraKind::Demo { Some(PHOTO_PX) } else { size };
        camera.held = held.into_iter().take(8).map(|h| h.chars().take(40).collect()).collect();
        self.set_up_changed();
        let mut effects = vec![Effect::Save];
        effects.extend(self.ask_for_first_guide());
        Ok(effects)
    }

    /// Another page operates: a webcam of the one before has gone with it.
    pub(in crate::studio) fn operator_changed(&mut self) {
        if self.state.camera.kind == Some(CameraKind::Webcam) {
            self.state.camera.connected = false;
            self.camera_gone();
        }
    }
}
