//! What follows from what: events change the state, and ask for work.

use std::collections::BTreeSet;
use std::sync::Arc;

use slcal_core::Rig;

use super::auto_shot::{AutoShot, Seen, is_tilted};
use super::display_check;
use super::event::{DisplayEvent, OperatorEvent, ScanMode};
use super::job::{Bench, Calibrated, Done, Job, LiveFrame, LookFor};
use super::live::Look;
use super::page_calibration::PageCalibration;
use super::pose_angles::{demo_pose, tilt_deg};
use super::project::{Purpose, Settings, StoredPhoto};
use super::simulated_camera::{FIRST_POSE, PHOTO_PX};
use super::state::{
    CameraKind, CameraState, CloudEntry, DemoObject, DemoPose, DemoScene, Display, LiveCloud, Photograph,
    Picture, Problem, SCHEMA, Scan, SetUp, State, Step, Use, Wanted,
};
use super::words::command;

/// Longer side of live frames, px: enough to find the sheet, little enough to be sent many times a second.
const LIVE_LONGEST_PX: u32 = 1280;
/// The simulated camera takes a live frame this often, ms, and at the latest after the second time where one is lost.
const DEMO_LIVE_MS: u64 = 200;
const DEMO_LOST_MS: u64 = 5000;
/// A photograph that has not arrived after this time does not come any more, ms.
const SHOT_LOST_MS: u64 = 20_000;
/// Weight of the newest interval in the rate of clouds.
const RATE_WEIGHT: f64 = 0.2;
/// Scale of the pattern, as a share of the usual one.
const PATTERN_SCALES: std::ops::RangeInclusive<f64> = 0.2..=1.2;
/// Sides of a panel, px.
const PANEL_SIDES: std::ops::RangeInclusive<u32> = 64..=16_384;

/// What a change asks for.
#[derive(Debug, Clone)]
pub(super) enum Effect {
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
    /// The settings are to be kept.
    Save,
    /// A command that does the same, for the log.
    Log(String),
}

/// How the studio was started.
#[derive(Debug, Clone, Default)]
pub(super) struct Options {
    pub(super) demo: bool,
    pub(super) lan: bool,
    pub(super) watch: Option<String>,
}

/// The state, and what only the machine needs to know.
pub(super) struct Machine {
    pub(super) state: State,
    pub(super) rig: Option<Arc<Rig>>,
    left_out: BTreeSet<String>,
    auto: AutoShot,
    shots: u64,
    /// A photograph that waits until the display has painted.
    waiting: Option<Purpose>,
    /// When a photograph was asked for that is on its way.
    shooting_since_ms: Option<u64>,
    now_ms: u64,
    /// When the simulated camera was last asked for a frame, until the frame comes.
    live_since_ms: Option<u64>,
    last_live_ms: u64,
    live_seq: u32,
    last_cloud_ms: Option<u64>,
    /// Looking through photographs of an earlier run.
    beginning: bool,
    begun: Option<Bench>,
    /// Where the sheet was photographed last.
    last_pose: Option<DemoPose>,
}

impl Machine {
    /// The state in which a studio starts; what an earlier run kept is looked through first.
    pub(super) fn new(settings: &Settings, options: Options) -> (Self, Vec<Effect>) {
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
            scan: Scan::default(),
            in_use: Use {
                picture: settings.picture.clone(),
                exports: vec!["opencv", "ros", "colmap", "kalibr", "blender", "npz"],
                ..Use::default()
            },
            demo_scene: demo.then_some(DemoScene { pose: FIRST_POSE, object: DemoObject::Sheet }),
        };
        let mut machine = Self {
            state,
            rig: None,
            left_out: settings.left_out.iter().cloned().collect(),
            auto: AutoShot::default(),
            shots: 0,
            waiting: None,
            shooting_since_ms: None,
            now_ms: 0,
            live_since_ms: None,
            last_live_ms: 0,
            live_seq: 0,
            last_cloud_ms: None,
            beginning: false,
            begun: None,
            last_pose: None,
        };
        let effects = machine.begin();
        machine.set_up_changed();
        machine.check_display(None);
        machine.show_for_step();
        (machine, effects)
    }

    /// What is kept for the next start.
    pub(super) fn settings(&self) -> Settings {
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
            ..Settings::default()
        }
    }

    /// An event of the page that operates; an error says why it is refused.
    pub(super) fn operate(&mut self, event: OperatorEvent) -> Result<Vec<Effect>, Problem> {
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
                self.stop_scanning();
                if self.shooting_since_ms.take().is_some() {
                    self.state.busy = None;
                }
                Ok(Vec::new())
            }
            OperatorEvent::Take => self.take(self.purpose()),
            OperatorEvent::AutoShot { on } => {
                self.state.auto_shot = on;
                Ok(Vec::new())
            }
            OperatorEvent::Photograph { id, used } => self.use_photograph(id, used),
            OperatorEvent::Scan { mode } => self.scan(mode),
            OperatorEvent::Show { kind } => {
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

    fn set_up(
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
                "the projector's resolution is not that of a projector",
                "give its native resolution, for example 1920x1080; its manual and the display settings state it",
            );
            return wrong(problem, self);
        }
        if let Some(Err(error)) = size.as_deref().map(str::parse::<slcal_core::SheetSize>) {
            let problem = Problem::new("set-up-size", error.to_string(), "measure the sheet with a ruler");
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
        if other_pattern && !self.state.photographs.is_empty() {
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
        self.check_display(None);
        let mut effects = self.begin();
        self.set_up_changed();
        effects.push(Effect::Save);
        Ok(effects)
    }

    /// Has the patterns drawn and the photographs looked through when panel, sheet or pattern are new.
    fn begin(&mut self) -> Vec<Effect> {
        let Some((projector, sheet)) = self.state.set_up.known() else { return Vec::new() };
        let bench = Bench { projector, sheet, pattern_scale: self.state.set_up.pattern_scale };
        if self.begun == Some(bench) {
            return Vec::new();
        }
        self.begun = Some(bench);
        self.beginning = true;
        self.state.photographs.clear();
        self.state.scan.clouds.clear();
        self.state.guide = None;
        self.state.busy = Some("drawing the patterns");
        vec![Effect::Work(Job::Begin(bench))]
    }

    fn set_up_changed(&mut self) {
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

    fn need(&self, step: Step) -> Result<(), Problem> {
        match self.state.locked(step) {
            Some(why) => Err(Problem::new("step-locked", why, "")),
            None => Ok(()),
        }
    }

    fn go_to(&mut self, step: Step) -> Result<Vec<Effect>, Problem> {
        self.need(step)?;
        if step != self.state.step {
            self.stop_scanning();
        }
        self.state.step = step;
        if let Some(scene) = &mut self.state.demo_scene {
            match step {
                Step::SetUp => {}
                Step::Calibrate => scene.object = DemoObject::Sheet,
                // A picture is drawn for the sheet where it was photographed last.
                Step::Use => {
                    (scene.object, scene.pose) = (DemoObject::Sheet, self.last_pose.unwrap_or(scene.pose));
                }
                Step::Scan => scene.object = DemoObject::Sphere,
            }
        }
        self.show_for_step();
        let mut effects = vec![Effect::Save];
        if step == Step::Calibrate {
            effects.extend(self.ask_for_first_guide());
        }
        Ok(effects)
    }

    /// The first pose can be advised when the size of the photographs is known.
    fn ask_for_first_guide(&self) -> Option<Effect> {
        let missing = self.state.guide.is_none() && self.state.calibration.is_none();
        let size = self.state.camera.size.filter(|_| missing && self.begun.is_some())?;
        Some(Effect::Work(Job::FirstGuide(size)))
    }

    fn camera(
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

    /// What a photograph shows that is taken now.
    pub(super) fn purpose(&self) -> Purpose {
        if self.state.step == Step::Scan { Purpose::Scan } else { Purpose::Sheet }
    }

    /// Takes a photograph, when the display shows what it should.
    fn take(&mut self, purpose: Purpose) -> Result<Vec<Effect>, Problem> {
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

    fn shoot(&mut self, purpose: Purpose) -> Vec<Effect> {
        self.waiting = None;
        self.shooting_since_ms = Some(self.now_ms);
        self.auto.taken();
        self.state.busy = Some("taking a photograph");
        if let Some(scene) = self.state.demo_scene {
            return vec![Effect::Work(Job::TakeSimulated(purpose, scene))];
        }
        self.shots += 1;
        vec![Effect::Shoot { shot: self.shots, purpose }]
    }

    /// A photograph was kept in the project's folder.
    pub(super) fn kept(&mut self, purpose: Purpose, photo: StoredPhoto) -> Vec<Effect> {
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
        }
    }

    fn use_photograph(&mut self, id: u32, used: bool) -> Result<Vec<Effect>, Problem> {
        let photo = self.state.photographs.iter_mut().find(|p| p.id == id);
        let photo = photo.ok_or_else(|| Problem::new("no-photograph", "there is no such photograph", ""))?;
        photo.used = used;
        if used {
            self.left_out.remove(&photo.name);
        } else {
            self.left_out.insert(photo.name.clone());
        }
        let mut effects = vec![Effect::Save];
        effects.extend(self.recalibrate());
        Ok(effects)
    }

    fn recalibrate(&mut self) -> Option<Effect> {
        let used = self.state.used();
        if used.is_empty() {
            (self.state.calibration, self.rig, self.state.guide) = (None, None, None);
            for photo in &mut self.state.photographs {
                (photo.rms_px, photo.tilt_deg) = (None, None);
            }
            return self.ask_for_first_guide();
        }
        self.state.busy = Some("calibrating");
        Some(Effect::Work(Job::Calibrate(used)))
    }

    fn scan(&mut self, mode: ScanMode) -> Result<Vec<Effect>, Problem> {
        match mode {
            ScanMode::Once => self.take(Purpose::Scan),
            ScanMode::Start => {
                self.need(Step::Scan)?;
                if !matches!(self.state.camera.kind, Some(CameraKind::Webcam | CameraKind::Demo)) {
                    return Err(Problem::new(
                        "camera-not-live",
                        "this camera has no live picture",
                        "take single photographs, or choose a webcam",
                    ));
                }
                self.state.scan.continuous = true;
                self.state.scan.fps = 0.0;
                self.state.camera.live_longest_px = 0;
                self.last_cloud_ms = None;
                Ok(Vec::new())
            }
            ScanMode::Stop => {
                let scanned = self.state.scan.continuous && self.state.scan.live.is_some();
                self.stop_scanning();
                Ok(if scanned { vec![Effect::Work(Job::KeepLive)] } else { Vec::new() })
            }
        }
    }

    fn stop_scanning(&mut self) {
        self.state.scan.continuous = false;
        self.state.scan.live = None;
        self.state.camera.live_longest_px = LIVE_LONGEST_PX;
    }

    /// What the display shows in a step.
    fn show_for_step(&mut self) {
        let kind = match self.state.step {
            Step::SetUp => Picture::Marks,
            Step::Calibrate => Picture::Checker,
            Step::Scan => Picture::Stripes,
            Step::Use if self.state.in_use.picture.is_some() => Picture::Rectified,
            Step::Use => Picture::Black,
        };
        self.show(kind);
    }

    fn show(&mut self, kind: Picture) {
        let sequence = self.state.display.wanted.sequence + 1;
        // Until the patterns are drawn there is nothing to show.
        let kind = if kind.file().is_some() && self.begun.is_none() { Picture::Black } else { kind };
        let url = kind.file().map(|_| format!("/api/shown.png?sequence={sequence}"));
        self.state.display.wanted = Wanted { kind, sequence, url };
    }

    /// Another page operates: a webcam of the one before has gone with it.
    pub(super) fn operator_changed(&mut self) {
        if self.state.camera.kind == Some(CameraKind::Webcam) {
            self.state.camera.connected = false;
            self.stop_scanning();
        }
    }

    /// How many display pages are there.
    pub(super) fn displays(&mut self, count: usize) {
        self.state.display.connected = count > 0;
        if count == 0 {
            self.state.display.measured = None;
            self.state.display.painted = 0;
        }
        self.check_display(None);
    }

    fn check_display(&mut self, of_page: Option<Problem>) {
        let State { display, set_up, demo, .. } = &mut self.state;
        display.problem = match set_up.projector {
            // The simulated projector shows the page's canvas, however large its window is.
            Some(_) if *demo && display.connected => None,
            Some(_) if *demo => Some(Problem::new(
                "display-missing",
                "the display window, which is the simulated projector, is not open",
                "open the display window",
            )),
            Some(panel) => match display_check::check(panel, display.measured.as_ref()) {
                // The page sees what covers it.
                Some(found) if found.code == display_check::NOT_FULL_SCREEN => of_page.or(Some(found)),
                found => found.or(of_page),
            },
            None => None,
        };
    }

    /// An event of the display's page.
    pub(super) fn display(&mut self, event: DisplayEvent) -> Vec<Effect> {
        match event {
            DisplayEvent::Measured { measured, problem } => {
                self.state.display.measured = Some(measured);
                let limited = |text: String| text.chars().take(400).collect::<String>();
                let of_page =
                    problem.map(|p| Problem::new("display-refuses", limited(p.message), limited(p.advice)));
                self.check_display(of_page);
                Vec::new()
            }
            DisplayEvent::Painted { sequence } => {
                if sequence <= self.state.display.wanted.sequence {
                    self.state.display.painted = sequence;
                }
                match self.waiting {
                    Some(purpose) if self.state.display.shows_what_is_wanted() => self.shoot(purpose),
                    _ => Vec::new(),
                }
            }
        }
    }

    /// A live frame of the operator's camera.
    pub(super) fn frame(&mut self, seq: u32, bytes: Arc<[u8]>) -> Vec<Effect> {
        if self.state.camera.kind != Some(CameraKind::Webcam) {
            return Vec::new();
        }
        vec![Effect::Live(self.live_frame(seq, Some(bytes)))]
    }

    fn live_frame(&self, seq: u32, bytes: Option<Arc<[u8]>>) -> LiveFrame {
        let look_for = match self.state.step {
            Step::Calibrate if self.state.display.wanted.kind == Picture::Checker => LookFor::Sheet,
            Step::Scan if self.state.scan.continuous => LookFor::Cloud,
            _ => LookFor::Nothing,
        };
        LiveFrame {
            seq,
            bytes,
            look_for,
            wanted: self.state.guide.as_ref().map(|g| (g.size, g.quad)),
            scene: self.state.demo_scene,
        }
    }

    /// Time passes: the simulated camera takes its live frames. `watched` says whether a page looks on.
    pub(super) fn tick(&mut self, now_ms: u64, watched: bool) -> Vec<Effect> {
        self.now_ms = now_ms;
        if !self.state.demo || !watched || self.begun.is_none() {
            return Vec::new();
        }
        let lost = self.live_since_ms.is_none_or(|since| now_ms.saturating_sub(since) > DEMO_LOST_MS);
        let pause = if self.state.scan.continuous { 0 } else { DEMO_LIVE_MS };
        if !lost || now_ms.saturating_sub(self.last_live_ms) < pause {
            return Vec::new();
        }
        self.live_since_ms = Some(now_ms);
        self.last_live_ms = now_ms;
        self.live_seq = self.live_seq.wrapping_add(1);
        vec![Effect::Live(self.live_frame(self.live_seq, None))]
    }

    /// Gives a photograph up that does not come; whether there was one.
    pub(super) fn give_up(&mut self, now_ms: u64) -> bool {
        let late = self.shooting_since_ms.is_some_and(|since| now_ms.saturating_sub(since) > SHOT_LOST_MS);
        if late {
            (self.shooting_since_ms, self.state.busy) = (None, None);
            self.state.problem = Some(Problem::new(
                "photograph-lost",
                "the photograph did not arrive",
                "take it again; if that fails too, reload the page or choose the camera again",
            ));
        }
        late
    }

    /// What the worker found.
    pub(super) fn done(&mut self, done: Done, now_ms: u64) -> Vec<Effect> {
        match done {
            Done::Begun => {
                self.show_for_step();
                self.ask_for_first_guide().into_iter().collect()
            }
            Done::Looked => {
                self.state.busy = None;
                if std::mem::take(&mut self.beginning) {
                    self.recalibrate().into_iter().collect()
                } else {
                    Vec::new()
                }
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
            Done::Picture(name) => {
                self.state.busy = None;
                self.state.in_use.picture = Some(name);
                self.show(Picture::Rectified);
                vec![Effect::Save, Effect::Log(command(&self.state).unwrap_or_default())]
            }
            Done::Exported { files, left_out } => {
                (self.state.in_use.exported, self.state.in_use.left_out) = (files, left_out);
                Vec::new()
            }
            Done::Failed(problem) => {
                (self.state.busy, self.shooting_since_ms, self.beginning) = (None, None, false);
                self.state.problem = Some(problem);
                Vec::new()
            }
        }
    }

    fn sheet_found(
        &mut self,
        photo: StoredPhoto,
        found: Result<super::job::SheetFound, Problem>,
    ) -> Vec<Effect> {
        let used = !self.left_out.contains(&photo.name);
        let (found, problem) = match found {
            Ok(found) => (Some(found), None),
            Err(problem) => (None, Some(problem)),
        };
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
        if self.beginning {
            return Vec::new();
        }
        self.state.busy = None;
        if found.is_none() || !used {
            return Vec::new();
        }
        self.recalibrate().into_iter().collect()
    }

    fn calibrated(&mut self, result: Result<Calibrated, Problem>) -> Vec<Effect> {
        self.state.busy = None;
        match result {
            Err(problem) => {
                (self.state.calibration, self.rig) = (None, None);
                self.state.problem = Some(problem);
                Vec::new()
            }
            Ok(Calibrated { rig, used, guide }) => {
                for photo in &mut self.state.photographs {
                    let view = used.iter().position(|id| *id == photo.id).and_then(|i| rig.views.get(i));
                    photo.rms_px = view.and_then(|v| v.rms_px).map(|r| r.corners.unwrap_or(r.edges));
                    photo.tilt_deg = view.map(|v| tilt_deg(&v.camera_from_sheet));
                }
                self.state.calibration = Some(PageCalibration::new(&rig, self.state.calibration.as_ref()));
                self.state.guide = guide;
                self.keep_turn_to_demo();
                self.state.problem = None;
                self.state.in_use.reports = vec!["/report"];
                self.last_pose = rig.views.last().map(|v| demo_pose(&v.camera_from_sheet, v.size));
                self.rig = Some(rig);
                command(&self.state)
                    .filter(|_| self.state.step == Step::Calibrate)
                    .map(Effect::Log)
                    .into_iter()
                    .collect()
            }
        }
    }

    /// Only a simulated sheet can be told where to go.
    fn keep_turn_to_demo(&mut self) {
        if !self.state.demo
            && let Some(guide) = &mut self.state.guide
        {
            guide.turn = None;
        }
    }

    fn looked(&mut self, mut look: Look, now_ms: u64) -> Vec<Effect> {
        self.live_since_ms = None;
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
        if now {
            effects.extend(self.shoot(Purpose::Sheet));
        }
        effects
    }

    fn live_cloud(&mut self, points: usize, bytes: Arc<[u8]>, now_ms: u64) -> Vec<Effect> {
        let scan = &mut self.state.scan;
        if !scan.continuous {
            return Vec::new();
        }
        if let Some(last) = self.last_cloud_ms {
            let rate = 1000.0 / now_ms.saturating_sub(last).max(1) as f64;
            scan.fps = if scan.fps > 0.0 { scan.fps + RATE_WEIGHT * (rate - scan.fps) } else { rate };
        }
        self.last_cloud_ms = Some(now_ms);
        let sequence = scan.live.as_ref().map_or(1, |l| l.sequence + 1);
        scan.live = Some(LiveCloud { sequence, points, url: format!("/api/cloud/live?sequence={sequence}") });
        vec![Effect::LiveCloud { sequence, bytes }]
    }

    fn cloud(&mut self, entry: CloudEntry) -> Vec<Effect> {
        self.state.scan.clouds.retain(|c| c.id != entry.id);
        self.state.scan.clouds.push(entry);
        if self.beginning {
            return Vec::new();
        }
        self.state.busy = None;
        command(&self.state).filter(|_| self.state.step == Step::Scan).map(Effect::Log).into_iter().collect()
    }

    /// A picture that is to be projected without keystone.
    pub(super) fn project_picture(&mut self, name: String, bytes: Arc<[u8]>) -> Result<Vec<Effect>, Problem> {
        self.need(Step::Use)?;
        self.state.busy = Some("drawing the picture");
        Ok(vec![Effect::Work(Job::Rectify { name, bytes })])
    }
}

#[cfg(test)]
mod tests {
    use slcal_core::CheckerConfig;

    use super::super::job::SheetFound;
    use super::super::state::Measured;
    use super::*;

    const PANEL: [u32; 2] = [1024, 768];

    fn settings(size: Option<&str>) -> Settings {
        Settings { projector: Some(PANEL), size: size.map(str::to_owned), ..Settings::default() }
    }

    fn demo() -> Machine {
        let options = Options { demo: true, ..Options::default() };
        let (mut machine, effects) = Machine::new(&settings(Some("594x420mm")), options);
        assert!(matches!(effects[..], [Effect::Work(Job::Begin(_))]));
        machine.done(Done::Begun, 0);
        machine.done(Done::Looked, 0);
        machine
    }

    fn with_display(machine: &mut Machine) {
        machine.displays(1);
        let sequence = machine.state.display.wanted.sequence;
        machine.display(DisplayEvent::Painted { sequence });
    }

    fn photo(id: u32) -> StoredPhoto {
        StoredPhoto { id, name: format!("sheet-{id:03}.jpg") }
    }

    fn found() -> SheetFound {
        SheetFound { corners: 70, of: 70, outline: None, size: PHOTO_PX }
    }

    /// A calibration of photographs as a machine is told it: from rendered observations.
    fn calibrated(used: &[u32]) -> Done {
        use slcal_core::simulate::{Draws, NoiseModel, PoseConfig, RigConfig, Scene};
        let poses: Vec<_> =
            (0..used.len()).map(|i| PoseConfig::tilted(25.0, 28.0 - 56.0 * (i % 2) as f64)).collect();
        let scene = Scene::new(&RigConfig::default(), &poses).unwrap();
        let observations = scene.observe(&NoiseModel::default(), &mut Draws::new(1, 0)).unwrap();
        let calibration =
            slcal_core::calibrate_observations(&observations, &slcal_core::CalibrateConfig::default())
                .unwrap();
        let rig = Arc::new(calibration.rig);
        let checker = slcal_core::CheckerPattern::new(PANEL, &CheckerConfig::default()).unwrap();
        let guide = super::super::guide::next(&rig, &checker).unwrap();
        Done::Calibrated(Ok(Calibrated { rig, used: used.to_vec(), guide }))
    }

    fn step(machine: &mut Machine, step: Step) -> Result<Vec<Effect>, Problem> {
        machine.operate(OperatorEvent::Step { step })
    }

    #[test]
    fn what_is_missing_is_asked_for_one_by_one() {
        let (mut machine, effects) = Machine::new(&Settings::default(), Options::default());
        assert!(effects.is_empty() && machine.state.set_up.missing.unwrap().contains("resolution"));
        assert_eq!(step(&mut machine, Step::Calibrate).unwrap_err().code, "step-locked");
        let set = |m: &mut Machine, projector, size: Option<&str>| {
            m.operate(OperatorEvent::SetUp { projector, size: size.map(str::to_owned), pattern_scale: None })
        };
        assert_eq!(set(&mut machine, Some([10, 10]), None).unwrap_err().code, "set-up-projector");
        set(&mut machine, Some(PANEL), None).unwrap();
        assert!(machine.state.set_up.missing.unwrap().contains("sheet"));
        assert_eq!(set(&mut machine, None, Some("A44")).unwrap_err().code, "set-up-size");
        let effects = set(&mut machine, None, Some("A4")).unwrap();
        assert!(matches!(effects[..], [Effect::Work(Job::Begin(b)), Effect::Save] if b.projector == PANEL));
        assert!(machine.state.set_up.missing.unwrap().contains("camera"));
        machine.operate(OperatorEvent::Camera { kind: CameraKind::Files, size: None, held: vec![] }).unwrap();
        assert!(machine.state.set_up.done);
        step(&mut machine, Step::Calibrate).unwrap();
        assert_eq!(step(&mut machine, Step::Scan).unwrap_err().code, "step-locked");
        let kept = machine.settings();
        assert_eq!(
            (kept.projector, kept.size.as_deref(), kept.step),
            (Some(PANEL), Some("A4"), Step::Calibrate)
        );
    }

    #[test]
    fn a_photograph_waits_until_the_display_has_painted() {
        let mut machine = demo();
        machine.displays(1);
        step(&mut machine, Step::Calibrate).unwrap();
        assert!(machine.operate(OperatorEvent::Take).unwrap().is_empty());
        let before = machine.state.display.wanted.sequence - 1;
        assert!(machine.display(DisplayEvent::Painted { sequence: before }).is_empty());
        let sequence = machine.state.display.wanted.sequence;
        let effects = machine.display(DisplayEvent::Painted { sequence });
        assert!(matches!(effects[..], [Effect::Work(Job::TakeSimulated(Purpose::Sheet, _))]));
    }

    #[test]
    fn a_display_that_scales_is_refused() {
        let (mut machine, _) = Machine::new(&settings(Some("A4")), Options::default());
        machine.done(Done::Begun, 0);
        let webcam = OperatorEvent::Camera { kind: CameraKind::Webcam, size: Some(PHOTO_PX), held: vec![] };
        machine.operate(webcam).unwrap();
        step(&mut machine, Step::Calibrate).unwrap();
        machine.displays(1);
        let measured = Measured {
            device_pixel_ratio: 1.25,
            screen: [1280, 960],
            viewport: [1280, 960],
            fullscreen: true,
        };
        machine.display(DisplayEvent::Measured { measured, problem: None });
        assert_eq!(machine.operate(OperatorEvent::Take).unwrap_err().code, "display-scaled");
        let measured = Measured { screen: PANEL, viewport: PANEL, ..measured };
        machine.display(DisplayEvent::Measured { measured, problem: None });
        let sequence = machine.state.display.wanted.sequence;
        machine.display(DisplayEvent::Painted { sequence });
        let effects = machine.operate(OperatorEvent::Take).unwrap();
        assert!(matches!(effects[..], [Effect::Shoot { shot: 1, purpose: Purpose::Sheet }]));
        // The page does not deliver it.
        assert!(!machine.give_up(SHOT_LOST_MS) && machine.state.busy.is_some());
        assert!(machine.give_up(SHOT_LOST_MS + 1) && machine.state.busy.is_none());
        assert_eq!(machine.state.problem.as_ref().unwrap().code, "photograph-lost");
        // Somebody zooms the page.
        machine.display(DisplayEvent::Measured {
            measured: Measured { screen: [1126, 845], ..measured },
            problem: None,
        });
        assert!(!machine.state.display.shows_what_is_wanted());
    }

    #[test]
    fn two_photographs_lead_to_a_scan() {
        let mut machine = demo();
        with_display(&mut machine);
        step(&mut machine, Step::Calibrate).unwrap();
        for id in [1, 2] {
            let effects = machine.done(Done::Kept(Purpose::Sheet, photo(id)), 0);
            assert!(matches!(&effects[..], [Effect::Work(Job::Sheet(p))] if p.id == id));
            let effects = machine.done(Done::Sheet { photo: photo(id), found: Ok(found()) }, 0);
            let all: Vec<u32> = (1..=id).collect();
            assert!(matches!(&effects[..], [Effect::Work(Job::Calibrate(used))] if *used == all));
            let effects = machine.done(calibrated(&all), 0);
            assert!(
                matches!(&effects[..], [Effect::Log(c)] if c.starts_with("slcal calibrate sheet-001.jpg"))
            );
        }
        let calibration = machine.state.calibration.as_ref().unwrap();
        assert!(calibration.figures[0].before.is_some() && calibration.photographs == 2);
        assert!(machine.state.photographs.iter().all(|p| p.rms_px.is_some() && p.tilt_deg.is_some()));
        step(&mut machine, Step::Scan).unwrap();
        assert_eq!(machine.state.display.wanted.kind, Picture::Stripes);
        assert_eq!(machine.state.demo_scene.unwrap().object, DemoObject::Sphere);
        // Without photographs there is no calibration, and no scan.
        let leave = |m: &mut Machine, id| m.operate(OperatorEvent::Photograph { id, used: false }).unwrap();
        assert!(matches!(leave(&mut machine, 1)[..], [Effect::Save, Effect::Work(Job::Calibrate(_))]));
        leave(&mut machine, 2);
        assert!(machine.state.calibration.is_none() && machine.state.locked(Step::Scan).is_some());
        assert_eq!(machine.settings().left_out, ["sheet-001.jpg", "sheet-002.jpg"]);
    }

    #[test]
    fn another_pattern_would_contradict_the_photographs() {
        let mut machine = demo();
        machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
        let scale = OperatorEvent::SetUp { projector: None, size: None, pattern_scale: Some(0.6) };
        assert_eq!(machine.operate(scale).unwrap_err().code, "set-up-photographs");
        assert_eq!(machine.state.set_up.pattern_scale, 1.0);
    }

    #[test]
    fn a_continuous_scan_counts_its_clouds() {
        let mut machine = demo();
        with_display(&mut machine);
        machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
        machine.done(calibrated(&[1]), 0);
        step(&mut machine, Step::Scan).unwrap();
        machine.operate(OperatorEvent::Scan { mode: ScanMode::Start }).unwrap();
        assert_eq!(machine.state.camera.live_longest_px, 0);
        let frame = image::RgbImage::new(4, 4);
        for i in 1..=20 {
            let look = Look::at(i, &frame);
            let done = Done::LiveCloud { look, points: 99, bytes: Arc::new([]) };
            let effects = machine.done(done, 50 * u64::from(i));
            assert!(effects.iter().any(|e| matches!(e, Effect::LiveCloud { .. })));
        }
        assert!((machine.state.scan.fps - 20.0).abs() < 0.5);
        let effects = machine.operate(OperatorEvent::Scan { mode: ScanMode::Stop }).unwrap();
        assert!(matches!(effects[..], [Effect::Work(Job::KeepLive)]) && machine.state.scan.live.is_none());
    }

    #[test]
    fn the_simulated_camera_rests_when_nobody_looks() {
        let mut machine = demo();
        assert!(machine.tick(1000, false).is_empty());
        assert!(matches!(machine.tick(1000, true)[..], [Effect::Live(_)]));
        // One frame at a time.
        assert!(machine.tick(2000, true).is_empty());
        machine.done(Done::Look(Look::at(1, &image::RgbImage::new(4, 4))), 2000);
        assert!(matches!(machine.tick(2001, true)[..], [Effect::Live(_)]));
    }
}
