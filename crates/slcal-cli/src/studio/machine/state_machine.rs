//! The state, and what only the machine needs to know.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

use slcal_core::Rig;

use super::shooting::Sequence;
use crate::studio::auto_shot::AutoShot;
use crate::studio::event::OperatorEvent;
use crate::studio::flash::Delay;
use crate::studio::job::{Bench, Done, Job, LiveFrame};
use crate::studio::live::Look;
use crate::studio::project::{Purpose, Settings};
use crate::studio::simulated_camera::{FIRST_POSE, PHOTO_PX};
use crate::studio::state::{
    CameraKind, CameraState, DemoObject, DemoPose, DemoScene, Display, LIVE_LONGEST_PX, Picture, Problem,
    SCHEMA, Scan, SetUp, State, Step, Use, Wanted,
};
use crate::studio::words::command;

/// What a change asks for.
#[derive(Debug, Clone)]
pub(in crate::studio) enum Effect {
    Work(Job),
    Live(LiveFrame),
    /// The operator's page is to take a photograph with its camera.
    Shoot {
        shot: u64,
        purpose: Purpose,
    },
    /// Told to all pages.
    Look(Look),
    /// The newest cloud of a continuous scan, as pages draw it.
    LiveCloud {
        sequence: u64,
        bytes: Arc<[u8]>,
    },
    /// The state has changed, though nothing else follows.
    Tell,
    /// The settings are to be kept.
    Save,
    /// A command that does the same, for the log.
    Log(String),
}

/// How the studio was started.
#[derive(Debug, Clone, Default)]
pub(in crate::studio) struct Options {
    pub(in crate::studio) demo: bool,
    pub(in crate::studio) lan: bool,
    pub(in crate::studio) watch: Option<String>,
}

/// The state, and what only the machine needs to know.
pub(in crate::studio) struct Machine {
    pub(in crate::studio) state: State,
    pub(in crate::studio) rig: Option<Arc<Rig>>,
    pub(super) fingerprint: String,
    pub(super) left_out: BTreeSet<String>,
    pub(super) auto: AutoShot,
    pub(super) shots: u64,
    /// What the last shots were asked for: their photographs may arrive in another step.
    pub(super) asked: VecDeque<(u64, Purpose)>,
    /// A photograph that waits until the display has painted.
    pub(super) waiting: Option<Purpose>,
    /// When a photograph was asked for that is on its way.
    pub(super) shooting_since_ms: Option<u64>,
    pub(super) now_ms: u64,
    /// When the simulated camera was last asked for a frame, until the frame comes.
    pub(super) live_since_ms: Option<u64>,
    pub(super) last_live_ms: u64,
    pub(super) live_seq: u32,
    pub(super) last_cloud_ms: Option<u64>,
    /// Looking through photographs of an earlier run.
    pub(super) beginning: bool,
    pub(super) begun: Option<Bench>,
    /// Photographs of an earlier run that have no cloud yet.
    pub(super) clouds_missing: Vec<Job>,
    /// The sequence that is being photographed.
    pub(super) sequence: Option<Sequence>,
    /// That of display and camera, once it was measured.
    pub(super) delay: Option<Delay>,
    /// Why the display's page itself refuses to show a pattern.
    pub(super) refused_by_page: Option<Problem>,
    /// Where the sheet was photographed last.
    pub(super) last_pose: Option<DemoPose>,
}

impl Machine {
    /// The state in which a studio starts; what an earlier run kept is looked through first.
    pub(in crate::studio) fn new(settings: &Settings, options: Options) -> (Self, Vec<Effect>) {
        let demo = options.demo;
        let camera =
            if demo { Some(CameraKind::Demo) } else { settings.camera.filter(|c| *c != CameraKind::Demo) };
        let state = State {
            schema: SCHEMA,
            demo,
            lan: options.lan,
            step: settings.step,
            problem: None,
            busy: None,
            set_up: SetUp {
                projector: settings.projector,
                size: settings.size.clone(),
                pattern_scale: settings.pattern_scale,
                camera,
                done: false,
                missing: None,
                sizes: ["A4", "A3", "A2", "letter", "tabloid", "594x420mm"],
                watch: options.watch,
                problem: None,
            },
            display: Display {
                connected: false,
                wanted: Wanted { kind: Picture::Black, sequence: 0, url: None },
                painted: 0,
                measured: None,
                problem: None,
            },
            camera: CameraState {
                kind: camera,
                // Everything but a webcam is there before it was asked.
                connected: camera.is_some_and(|c| c != CameraKind::Webcam),
                size: demo.then_some(PHOTO_PX),
                held: Vec::new(),
                problem: None,
                latency_ms: None,
                live_longest_px: LIVE_LONGEST_PX,
            },
            auto_shot: true,
            photographs: Vec::new(),
            calibration: None,
            guide: None,
            scan: Scan { method: settings.scan_method, ..Scan::default() },
            in_use: Use {
                picture: settings.picture.clone(),
                picture_file: settings.picture_file.clone(),
                exports: vec!["opencv", "ros", "colmap", "kalibr", "blender", "npz"],
                ..Use::default()
            },
            demo_scene: demo.then_some(DemoScene { pose: FIRST_POSE, object: DemoObject::Sheet }),
        };
        let mut machine = Self {
            state,
            rig: None,
            fingerprint: String::new(),
            left_out: settings.left_out.iter().cloned().collect(),
            auto: AutoShot::default(),
            shots: 0,
            asked: VecDeque::new(),
            waiting: None,
            shooting_since_ms: None,
            now_ms: 0,
            live_since_ms: None,
            last_live_ms: 0,
            live_seq: 0,
            last_cloud_ms: None,
            beginning: false,
            begun: None,
            clouds_missing: Vec::new(),
            sequence: None,
            delay: None,
            refused_by_page: None,
            last_pose: None,
        };
        let effects = machine.begin();
        machine.set_up_changed();
        machine.check_display();
        machine.show_for_step();
        (machine, effects)
    }

    /// The time, before anything happens at it.
    pub(in crate::studio) fn at(&mut self, now_ms: u64) {
        self.now_ms = now_ms;
    }

    /// What is kept for the next start.
    pub(in crate::studio) fn settings(&self) -> Settings {
        let set_up = &self.state.set_up;
        Settings {
            projector: set_up.projector,
            size: set_up.size.clone(),
            pattern_scale: set_up.pattern_scale,
            camera: set_up.camera,
            step: self.state.step,
            demo: self.state.demo,
            left_out: self.left_out.iter().cloned().collect(),
            picture: self.state.in_use.picture.clone(),
            picture_file: self.state.in_use.picture_file.clone(),
            scan_method: self.state.scan.method,
            ..Settings::default()
        }
    }

    /// An event of the page that operates; an error says why it is refused.
    pub(in crate::studio) fn operate(&mut self, event: OperatorEvent) -> Result<Vec<Effect>, Problem> {
        match event {
            OperatorEvent::SetUp { projector, size, pattern_scale } => {
                self.set_up(projector, size, pattern_scale)
            }
            OperatorEvent::Step { step } => self.go_to(step),
            OperatorEvent::Camera { kind, size, held } => self.camera(kind, size, held),
            OperatorEvent::CameraLost { message } => {
                self.state.camera.connected = false;
                self.state.camera.problem = Some(Problem::new(
                    "camera-lost",
                    format!("the camera does not answer: {}", message.chars().take(200).collect::<String>()),
                    "plug it in again, close other programs that use it, and choose it again",
                ));
                self.camera_gone();
                if self.shooting_since_ms.take().is_some() {
                    self.state.busy = None;
                }
                Ok(Vec::new())
            }
            OperatorEvent::Take => {
                self.not_while_shooting()?;
                self.take(self.purpose()?)
            }
            OperatorEvent::AutoShot { on } => {
                self.state.auto_shot = on;
                Ok(Vec::new())
            }
            OperatorEvent::Photograph { id, used } => {
                self.not_while_shooting()?;
                self.use_photograph(id, used)
            }
            OperatorEvent::Scan { mode } => self.scan(mode),
            OperatorEvent::ScanMethod { method } => self.scan_method(method),
            OperatorEvent::Reconstruct { id } => self.reconstruct(id),
            OperatorEvent::Show { kind } => {
                self.not_while_shooting()?;
                if kind == Picture::Frame {
                    return Err(Problem::new("no-picture", "no sequence is being photographed", "scan"));
                }
                if kind == Picture::Rectified && self.state.in_use.picture.is_none() {
                    return Err(Problem::new(
                        "no-picture",
                        "there is no picture yet",
                        "choose a picture first",
                    ));
                }
                self.show(kind);
                Ok(Vec::new())
            }
            OperatorEvent::Export { format } => {
                self.need(Step::Use)?;
                Ok(vec![Effect::Work(Job::Export(format))])
            }
            OperatorEvent::Turn { pose } => {
                let limits = [pose.tilt_deg[0], pose.tilt_deg[1]].iter().all(|t| t.abs() <= 70.0)
                    && pose.roll_deg.abs() <= 180.0
                    && (300.0..=5000.0).contains(&pose.distance_mm)
                    && pose.aside_mm.iter().all(|a| a.abs() <= 1000.0);
                let scene = self.state.demo_scene.as_mut().filter(|_| limits);
                let scene = scene.ok_or_else(|| {
                    Problem::new(
                        "not-simulated",
                        "the sheet cannot be held so",
                        "tilt it by less than 70 degrees",
                    )
                })?;
                scene.pose = pose;
                self.check_straight();
                Ok(Vec::new())
            }
            OperatorEvent::Object { object } => {
                if let Some(scene) = &mut self.state.demo_scene {
                    scene.object = object;
                }
                Ok(Vec::new())
            }
            // The server knows who operates.
            OperatorEvent::TakeOver => Ok(Vec::new()),
            OperatorEvent::Dismiss => {
                self.state.problem = None;
                Ok(Vec::new())
            }
        }
    }

    pub(super) fn go_to(&mut self, step: Step) -> Result<Vec<Effect>, Problem> {
        self.need(step)?;
        if step == self.state.step && self.sequence.is_some() {
            return Ok(Vec::new());
        }
        let mut effects = if step == self.state.step { Vec::new() } else { self.end_scan() };
        self.state.step = step;
        self.waiting = None;
        if let Some(scene) = &mut self.state.demo_scene {
            match step {
                Step::SetUp | Step::Calibrate | Step::Use => scene.object = DemoObject::Sheet,
                Step::Scan => scene.object = DemoObject::Sphere,
            }
        }
        self.put_sheet_back();
        self.show_for_step();
        effects.push(Effect::Save);
        if step == Step::Calibrate {
            effects.extend(self.ask_for_first_guide());
        }
        Ok(effects)
    }

    /// In the step Use the simulated sheet hangs where it was photographed last: the picture is drawn for that.
    pub(super) fn put_sheet_back(&mut self) {
        if let (Step::Use, Some(scene)) = (self.state.step, &mut self.state.demo_scene) {
            scene.pose = self.last_pose.unwrap_or(scene.pose);
        }
        self.check_straight();
    }

    fn check_straight(&mut self) {
        self.state.in_use.straight =
            self.state.demo_scene.as_ref().map(|scene| self.last_pose.is_none_or(|pose| scene.pose == pose));
    }

    pub(super) fn need(&self, step: Step) -> Result<(), Problem> {
        match self.state.locked(step) {
            Some(why) => Err(Problem::new("step-locked", why, "")),
            None => Ok(()),
        }
    }

    /// What the worker found.
    pub(in crate::studio) fn done(&mut self, done: Done, now_ms: u64) -> Vec<Effect> {
        match done {
            Done::Begun => {
                self.show_for_step();
                self.ask_for_first_guide().into_iter().collect()
            }
            Done::Looked => {
                self.state.busy = None;
                if std::mem::take(&mut self.beginning) { self.recalibrate() } else { Vec::new() }
            }
            Done::FirstGuide(guide) => {
                if self.state.calibration.is_none() {
                    self.state.guide = guide;
                    self.keep_turn_to_demo();
                }
                Vec::new()
            }
            Done::Kept(purpose, photo) => self.kept(purpose, photo),
            Done::Sheet { photo, found } => self.sheet_found(photo, found),
            Done::Calibrated(result) => self.calibrated(result),
            Done::Look(look) => self.looked(look, now_ms),
            Done::LiveCloud { look, points, bytes } => {
                let mut effects = self.looked(look, now_ms);
                effects.extend(self.live_cloud(points, bytes, now_ms));
                effects
            }
            Done::Cloud(entry) => self.cloud(entry),
            Done::Picture { name, file } => {
                self.state.busy = None;
                (self.state.in_use.picture, self.state.in_use.picture_file) = (Some(name), Some(file));
                self.show(Picture::Rectified);
                vec![Effect::Save, Effect::Log(command(&self.state).unwrap_or_default())]
            }
            Done::Exported { files, left_out } => {
                (self.state.in_use.exported, self.state.in_use.left_out) = (files, left_out);
                Vec::new()
            }
            Done::Nothing => {
                self.state.busy = None;
                Vec::new()
            }
            Done::CloudMissing(job) => {
                self.clouds_missing.push(job);
                Vec::new()
            }
            Done::Unfinished(scan) => {
                self.state.scan.unfinished.push(scan);
                Vec::new()
            }
            Done::ScanBegun(folder) => self.scan_begun(folder),
            Done::NotBegun(problem) => {
                (self.state.busy, self.beginning, self.begun) = (None, false, None);
                self.state.problem = Some(problem);
                Vec::new()
            }
            Done::Failed(problem) if self.sequence.is_some() => {
                self.stop_sequence(Some(problem));
                Vec::new()
            }
            Done::Failed(problem) => {
                (self.state.busy, self.shooting_since_ms) = (None, None);
                self.state.problem = Some(problem);
                Vec::new()
            }
        }
    }
}
