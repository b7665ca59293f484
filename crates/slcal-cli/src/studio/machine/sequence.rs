//! Scans by a sequence: each picture is shown, acknowledged and photographed, and the next one follows.

use std::sync::Arc;

use slcal_core::Rig;
use slcal_core::pattern::{SequenceAxes, SequenceConfig, SequencePattern, SinusoidConfig};

use super::shooting::{Phase, Sequence};
use super::state_machine::{Effect, Machine};
use crate::studio::flash::{Flash, Seen};
use crate::studio::job::Job;
use crate::studio::project::Purpose;
use crate::studio::scan_folder::ScanFolder;
use crate::studio::state::{CameraKind, Picture, Problem, ScanMethod, Shots, Step, Unfinished};

impl Machine {
    /// Stripes or a sequence.
    pub(super) fn scan_method(&mut self, method: ScanMethod) -> Result<Vec<Effect>, Problem> {
        self.not_while_shooting()?;
        let mut effects = self.end_scan();
        (self.state.scan.method, self.waiting) = (method, None);
        if self.state.step == Step::Scan {
            self.show_for_step();
        }
        effects.push(Effect::Save);
        Ok(effects)
    }

    /// Refuses what would disturb a sequence that is being photographed.
    pub(super) fn not_while_shooting(&self) -> Result<(), Problem> {
        if self.sequence.is_none() { Ok(()) } else { Err(under_way()) }
    }

    /// Begins a scan by the sequence that was chosen.
    pub(super) fn start_sequence(&mut self) -> Result<Vec<Effect>, Problem> {
        self.need(Step::Scan)?;
        self.not_while_shooting()?;
        let missing = || Problem::new("not-set-up", "the projector is not set up", "set it up first");
        let (projector, rig) = self.state.set_up.projector.zip(self.rig.as_ref()).ok_or_else(missing)?;
        if self.state.camera.kind.is_none() || !self.state.camera.connected {
            return Err(Problem::new("camera-missing", "no camera is there", "choose or start a camera"));
        }
        if let Some(problem) = self.state.camera.problem.as_ref().or(self.state.display.problem.as_ref()) {
            return Err(problem.clone());
        }
        if !self.state.display.connected {
            return Err(Problem::new(
                "display-missing",
                "the display window, which shows one picture after another, is not open",
                "open the display window on the projector",
            ));
        }
        let pattern = pattern(self.state.scan.method, projector, rig)
            .map_err(|e| Problem::new("sequence-impossible", e.to_string(), "scan with the stripes"))?;
        let folder = Effect::Work(Job::BeginScan(Arc::new(pattern.clone())));
        let measures = !self.is_released_by_hand() && self.delay.is_none();
        let phase = if measures { Phase::Flash(Flash::default()) } else { Phase::Folder };
        self.sequence = Some(Sequence { pattern: Arc::new(pattern), folder: None, frame: 0, phase });
        (self.state.busy, self.waiting) = (Some("photographing"), None);
        self.tell_shots();
        if measures {
            self.show(Picture::Black);
            return Ok(Vec::new());
        }
        Ok(vec![folder])
    }

    /// Whether somebody releases the camera.
    fn is_released_by_hand(&self) -> bool {
        !matches!(self.state.camera.kind, Some(CameraKind::Webcam | CameraKind::Demo))
    }

    /// The picture that the display is to show, of a sequence.
    pub(in crate::studio) fn wanted_frame(&self) -> Option<(Arc<SequencePattern>, usize)> {
        let sequence = self.sequence.as_ref().filter(|_| self.state.display.wanted.kind == Picture::Frame)?;
        Some((sequence.pattern.clone(), sequence.frame))
    }

    /// What a photograph shows that comes now without having been asked for; `None` while there is no sequence.
    pub(super) fn purpose_in_sequence(&self) -> Option<Result<Purpose, Problem>> {
        let sequence = self.sequence.as_ref()?;
        if !self.is_released_by_hand() {
            return Some(Err(under_way()));
        }
        Some(match (&sequence.phase, &sequence.folder) {
            (Phase::Shooting, Some(folder)) => Ok(Purpose::Frame { scan: folder.id, frame: sequence.frame }),
            _ => Err(Problem::new(
                FRAME_NOT_SHOWN,
                format!("a photograph came before picture {} was shown; it is not used", sequence.frame + 1),
                "take one photograph of each picture, after the page asks for it",
            )),
        })
    }

    /// The folder of the scan is there: the first picture comes.
    pub(super) fn scan_begun(&mut self, folder: ScanFolder) -> Vec<Effect> {
        if let Some(sequence) = &mut self.sequence {
            sequence.folder = Some(folder);
            self.show_frame();
        }
        Vec::new()
    }

    fn show_frame(&mut self) {
        if let Some(sequence) = &mut self.sequence {
            sequence.phase = Phase::Showing;
            self.show(Picture::Frame);
            self.tell_shots();
        }
    }

    /// The display has painted what is wanted.
    pub(super) fn painted_in_sequence(&mut self) {
        let by_hand = self.is_released_by_hand();
        let (now_ms, delay) = (self.now_ms, self.delay);
        let Some(sequence) = &mut self.sequence else { return };
        match &mut sequence.phase {
            Phase::Flash(flash) => flash.painted(now_ms),
            Phase::Showing if by_hand => {
                sequence.phase = Phase::Shooting;
                self.tell_shots();
            }
            Phase::Showing => {
                let until_ms = now_ms + delay.map_or(0, |delay| delay.wait_ms);
                sequence.phase = Phase::Settling { until_ms };
            }
            Phase::Folder | Phase::Settling { .. } | Phase::Shooting => {}
        }
    }

    /// Whether live frames are wanted as fast as they come: the flash is looked for in them.
    pub(super) fn flashes(&self) -> bool {
        self.sequence.as_ref().is_some_and(|sequence| matches!(sequence.phase, Phase::Flash(_)))
    }

    /// A live frame with this mean level, as a share of full scale.
    pub(super) fn flash_seen(&mut self, level: f64) -> Vec<Effect> {
        let now_ms = self.now_ms;
        let Some(Sequence { phase: Phase::Flash(flash), pattern, .. }) = &mut self.sequence else {
            return Vec::new();
        };
        let pattern = pattern.clone();
        match flash.frame(now_ms, level) {
            Seen::Wait => {}
            Seen::ShowWhite => {
                self.show(Picture::White);
                return vec![Effect::Tell];
            }
            Seen::Delay(delay) => {
                self.delay = Some(delay);
                self.state.camera.latency_ms = u32::try_from(delay.latency_ms).ok();
                if let Some(sequence) = &mut self.sequence {
                    sequence.phase = Phase::Folder;
                }
                return vec![Effect::Work(Job::BeginScan(pattern))];
            }
            Seen::Nothing => {
                self.stop_sequence(Some(no_flash()));
                return vec![Effect::Tell];
            }
        }
        Vec::new()
    }

    /// Time passes: the photograph is taken when the camera shows the picture.
    pub(super) fn sequence_tick(&mut self) -> Vec<Effect> {
        let now_ms = self.now_ms;
        let shows = self.state.display.shows_what_is_wanted();
        let Some(sequence) = &mut self.sequence else { return Vec::new() };
        match (&sequence.phase, &sequence.folder) {
            (Phase::Settling { until_ms }, Some(folder)) if shows && now_ms >= *until_ms => {
                let purpose = Purpose::Frame { scan: folder.id, frame: sequence.frame };
                sequence.phase = Phase::Shooting;
                self.tell_shots();
                self.shoot(purpose)
            }
            _ => Vec::new(),
        }
    }

    /// Gives a flash up that does not come; whether there was one.
    pub(super) fn give_up_flash(&mut self, now_ms: u64) -> bool {
        let Some(Sequence { phase: Phase::Flash(flash), .. }) = &self.sequence else { return false };
        let is_late = flash.is_late(now_ms);
        if is_late {
            self.stop_sequence(Some(no_flash()));
        }
        is_late
    }

    /// The photograph of a picture was kept: the next picture, or the cloud.
    pub(super) fn frame_kept(&mut self, scan: u32, frame: usize) -> Vec<Effect> {
        let Some(sequence) = &mut self.sequence else { return Vec::new() };
        let Some(folder) = sequence.folder.clone().filter(|f| f.id == scan && sequence.frame == frame) else {
            // One of a scan that was stopped.
            return Vec::new();
        };
        sequence.frame += 1;
        if sequence.frame < sequence.pattern.frames.len() {
            self.show_frame();
            return Vec::new();
        }
        (self.sequence, self.state.scan.shots) = (None, None);
        self.state.busy = Some("reconstructing");
        self.show_for_step();
        vec![Effect::Work(Job::SequenceCloud(folder))]
    }

    /// Ends a sequence before its last photograph; what is there stays in its folder, and is told as unfinished.
    pub(super) fn stop_sequence(&mut self, why: Option<Problem>) {
        let Some(Sequence { folder, frame, pattern, .. }) = self.sequence.take() else { return };
        (self.state.scan.shots, self.state.busy, self.shooting_since_ms) = (None, None, None);
        if let Some(ScanFolder { name, .. }) = folder {
            self.state.scan.unfinished.push(Unfinished { name, have: frame, of: pattern.frames.len() });
        }
        if why.is_some() {
            self.state.problem = why;
        }
        self.show_for_step();
    }

    /// Ends a sequence that the display does not show pixel for pixel any more.
    pub(super) fn check_sequence(&mut self) {
        if let Some(problem) = self.state.display.problem.clone().filter(|_| self.sequence.is_some()) {
            self.stop_sequence(Some(problem));
        }
    }

    fn tell_shots(&mut self) {
        let by_hand = self.is_released_by_hand();
        self.state.scan.shots = self.sequence.as_ref().map(|sequence| {
            let frames = &sequence.pattern.frames;
            let shows = matches!(sequence.phase, Phase::Showing | Phase::Settling { .. } | Phase::Shooting);
            Shots {
                frame: if shows { sequence.frame + 1 } else { 0 },
                of: frames.len(),
                light: frames.get(sequence.frame).map(|f| f.light.to_string()).unwrap_or_default(),
                by_hand,
                shown: matches!(sequence.phase, Phase::Shooting),
            }
        });
    }
}

/// Code of a photograph that comes before its picture is shown.
pub(in crate::studio) const FRAME_NOT_SHOWN: &str = "frame-not-shown";

fn under_way() -> Problem {
    Problem::new("scan-under-way", "a sequence is being photographed", "wait for its end, or stop it")
}

fn no_flash() -> Problem {
    Problem::new(
        "flash-not-seen",
        "the camera's picture did not change when the display turned from black to white",
        "see that the projector shows the display window, that the camera looks at what it lights, and that the room is not too bright",
    )
}

/// The sequence of a method. It codes what lies along the baseline: the columns of a projector beside the camera, the rows of one above it.
fn pattern(method: ScanMethod, projector: [u32; 2], rig: &Rig) -> slcal_core::Result<SequencePattern> {
    let t = rig.require_projector()?.from_camera.pose.translation;
    let axes = if t.x.abs() >= t.y.abs() { SequenceAxes::Columns } else { SequenceAxes::Rows };
    let sinusoid = (method == ScanMethod::Phase).then(SinusoidConfig::default);
    SequencePattern::new(projector, &SequenceConfig { axes, sinusoid, ..SequenceConfig::default() })
}
