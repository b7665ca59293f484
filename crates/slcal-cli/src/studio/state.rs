//! What the studio knows: one plain value, changed by named events and told to the pages as JSON.

use serde::{Deserialize, Serialize};
use slcal_core::{SheetSize, Warning};

use super::page_calibration::PageCalibration;

/// Name of the state's format.
pub(super) const SCHEMA: &str = "slcal-studio/1";

/// Longer side of live frames, px: enough to find the sheet, little enough to be sent many times a second.
pub(super) const LIVE_LONGEST_PX: u32 = 1280;

/// The four steps of the work, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Step {
    SetUp,
    Calibrate,
    Scan,
    Use,
}

impl Step {
    pub(super) const ALL: [Self; 4] = [Self::SetUp, Self::Calibrate, Self::Scan, Self::Use];
}

/// What was wrong and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Problem {
    /// Stable identifier.
    pub(super) code: &'static str,
    pub(super) message: String,
    pub(super) advice: String,
}

impl Problem {
    pub(super) fn new(code: &'static str, message: impl Into<String>, advice: impl Into<String>) -> Self {
        Self { code, message: message.into(), advice: advice.into() }
    }
}

/// Where photographs come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum CameraKind {
    /// A camera of the operator's browser.
    Webcam,
    /// A phone that uploads.
    Phone,
    /// A folder that a camera writes into.
    Folder,
    /// Files that the operator drops.
    Files,
    /// The simulated camera.
    Demo,
}

/// What the display is to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Picture {
    Black,
    White,
    /// Marks at the panel's corners, drawn by the page.
    Marks,
    Checker,
    Stripes,
    /// A picture of the sequence that is being photographed.
    Frame,
    /// The user's picture, without keystone.
    #[serde(rename = "picture")]
    Rectified,
}

impl Picture {
    /// The file of the project that holds it; those without one are drawn by the page, or when they are asked for.
    pub(super) fn file(self) -> Option<&'static str> {
        match self {
            Self::Black | Self::White | Self::Marks | Self::Frame => None,
            Self::Checker => Some("checker.png"),
            Self::Stripes => Some("stripes.png"),
            Self::Rectified => Some("picture.png"),
        }
    }

    /// Whether the page has to fetch it.
    pub(super) fn is_fetched(self) -> bool {
        self == Self::Frame || self.file().is_some()
    }
}

/// How an object is scanned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ScanMethod {
    /// One photograph under the stripes.
    #[default]
    Stripes,
    /// Many, under the pictures of a Gray code.
    Gray,
    /// Many, under a Gray code and a sinusoid that is shifted.
    Phase,
}

/// What is known before anything is photographed.
#[derive(Debug, Clone, Serialize)]
pub(super) struct SetUp {
    pub(super) projector: Option<[u32; 2]>,
    /// The sheet's size as it was typed.
    pub(super) size: Option<String>,
    /// Side of the checkerboard's squares, as a share of the usual one.
    pub(super) pattern_scale: f64,
    pub(super) camera: Option<CameraKind>,
    pub(super) done: bool,
    /// What is still to be set, in words.
    pub(super) missing: Option<&'static str>,
    pub(super) sizes: [&'static str; 6],
    /// The folder that is watched.
    pub(super) watch: Option<String>,
    pub(super) problem: Option<Problem>,
}

impl SetUp {
    /// The sheet's size.
    pub(super) fn sheet(&self) -> Option<SheetSize> {
        self.size.as_deref()?.parse().ok()
    }

    /// Panel and sheet, when both are known.
    pub(super) fn known(&self) -> Option<([u32; 2], SheetSize)> {
        self.projector.zip(self.sheet())
    }
}

/// A picture that the display is asked to show; each has its own number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Wanted {
    pub(super) kind: Picture,
    pub(super) sequence: u64,
    pub(super) url: Option<String>,
}

/// The display as its page measures it, in device pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Measured {
    pub(super) device_pixel_ratio: f64,
    pub(super) screen: [u32; 2],
    pub(super) viewport: [u32; 2],
    pub(super) fullscreen: bool,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct Display {
    pub(super) connected: bool,
    pub(super) wanted: Wanted,
    /// Number of the picture that was painted last.
    pub(super) painted: u64,
    pub(super) measured: Option<Measured>,
    pub(super) problem: Option<Problem>,
}

impl Display {
    /// Whether what is wanted is on the panel, pixel for pixel.
    pub(super) fn shows_what_is_wanted(&self) -> bool {
        self.connected && self.problem.is_none() && self.painted == self.wanted.sequence
    }
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct CameraState {
    pub(super) kind: Option<CameraKind>,
    pub(super) connected: bool,
    pub(super) size: Option<[u32; 2]>,
    /// What the camera's track holds: exposure, focus, white balance.
    pub(super) held: Vec<String>,
    pub(super) problem: Option<Problem>,
    /// From a change of the display to the frame that shows it.
    pub(super) latency_ms: Option<u32>,
    /// Longer side of the live frames that are wanted, px; 0: as large as they are.
    pub(super) live_longest_px: u32,
}

/// A photograph of the sheet.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Photograph {
    pub(super) id: u32,
    pub(super) name: String,
    pub(super) url: String,
    /// Whether the calibration takes it.
    pub(super) used: bool,
    /// Why nothing was found in it.
    pub(super) problem: Option<Problem>,
    /// Corners of the pattern that were found, of how many.
    pub(super) corners: usize,
    pub(super) of: usize,
    pub(super) rms_px: Option<f64>,
    pub(super) tilt_deg: Option<[f64; 2]>,
    /// The sheet's corners, px.
    pub(super) outline: Option<[[f64; 2]; 4]>,
    pub(super) size: Option<[u32; 2]>,
}

/// The pose to photograph next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Guide {
    /// Size of the picture in which `quad` is drawn.
    pub(super) size: [u32; 2],
    /// The sheet's corners TL, TR, BR, BL, px.
    pub(super) quad: [[f64; 2]; 4],
    /// How to hold the sheet.
    pub(super) words: String,
    /// What σ becomes.
    pub(super) gain: String,
    /// Whether the verdict asks for it.
    pub(super) needed: bool,
    /// Tilts about the horizontal and the vertical axis.
    #[serde(skip)]
    pub(super) tilt_rad: [f64; 2],
    /// The same pose for the simulated sheet; only the demonstration has it.
    pub(super) turn: Option<DemoPose>,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct CloudEntry {
    pub(super) id: u32,
    pub(super) name: String,
    pub(super) points: usize,
    pub(super) triangles: usize,
    pub(super) url: String,
    pub(super) photo: String,
    /// Name of the photograph's file, or of the folder with those of a sequence.
    pub(super) photo_name: String,
    /// How many photographs of a sequence it is made of; `None`: a single one under stripes.
    pub(super) frames: Option<usize>,
    pub(super) saved: Vec<String>,
    pub(super) warnings: Vec<Warning>,
    /// Fingerprint of the rig that it was made with.
    pub(super) rig: String,
    /// Whether that is not the rig of now.
    pub(super) outdated: bool,
}

/// The newest cloud of a continuous scan.
#[derive(Debug, Clone, Serialize)]
pub(super) struct LiveCloud {
    pub(super) sequence: u64,
    pub(super) points: usize,
    pub(super) url: String,
}

/// How far the photographs of a sequence are.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Shots {
    /// The picture that is shown, counted from 1; 0 while the camera's delay is measured.
    pub(super) frame: usize,
    pub(super) of: usize,
    /// What it shows, in words.
    pub(super) light: String,
    /// Whether somebody releases the camera.
    pub(super) by_hand: bool,
    /// Whether the display shows it and the photograph can be taken.
    pub(super) shown: bool,
}

/// A scan by a sequence of which photographs are missing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Unfinished {
    /// Its folder.
    pub(super) name: String,
    /// Photographs that are there, of how many.
    pub(super) have: usize,
    pub(super) of: usize,
}

#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct Scan {
    pub(super) method: ScanMethod,
    pub(super) continuous: bool,
    pub(super) fps: f64,
    pub(super) clouds: Vec<CloudEntry>,
    pub(super) live: Option<LiveCloud>,
    /// The sequence that is being photographed.
    pub(super) shots: Option<Shots>,
    pub(super) unfinished: Vec<Unfinished>,
}

#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct Use {
    /// Name of the picture that is projected without keystone.
    pub(super) picture: Option<String>,
    /// Its file in the project's folder.
    pub(super) picture_file: Option<String>,
    /// Whether the sheet is where the picture was drawn for; only the demonstration knows.
    pub(super) straight: Option<bool>,
    pub(super) exports: Vec<&'static str>,
    /// Files that were written for other programs, within the project's folder.
    pub(super) exported: Vec<String>,
    /// What that format cannot hold.
    pub(super) left_out: Vec<String>,
    pub(super) reports: Vec<&'static str>,
}

/// Where the simulated sheet is held.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct DemoPose {
    pub(super) tilt_deg: [f64; 2],
    pub(super) roll_deg: f64,
    pub(super) distance_mm: f64,
    #[serde(default)]
    pub(super) aside_mm: [f64; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum DemoObject {
    Sheet,
    Sphere,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct DemoScene {
    #[serde(flatten)]
    pub(super) pose: DemoPose,
    pub(super) object: DemoObject,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct State {
    pub(super) schema: &'static str,
    pub(super) demo: bool,
    pub(super) lan: bool,
    pub(super) step: Step,
    pub(super) problem: Option<Problem>,
    pub(super) busy: Option<&'static str>,
    pub(super) set_up: SetUp,
    pub(super) display: Display,
    pub(super) camera: CameraState,
    pub(super) auto_shot: bool,
    pub(super) photographs: Vec<Photograph>,
    pub(super) calibration: Option<PageCalibration>,
    pub(super) guide: Option<Guide>,
    pub(super) scan: Scan,
    #[serde(rename = "use")]
    pub(super) in_use: Use,
    pub(super) demo_scene: Option<DemoScene>,
}

impl State {
    /// Photographs in which everything was found and that were not left out.
    pub(super) fn used(&self) -> Vec<u32> {
        self.photographs.iter().filter(|p| p.used && p.problem.is_none()).map(|p| p.id).collect()
    }

    /// Why a step cannot be entered yet.
    pub(super) fn locked(&self, step: Step) -> Option<&'static str> {
        match step {
            Step::SetUp => None,
            Step::Calibrate if self.set_up.done => None,
            Step::Calibrate => Some("Set the projector's resolution, the sheet's size and the camera first."),
            Step::Scan | Step::Use if self.calibration.is_some() => None,
            Step::Scan | Step::Use => Some("Calibrate first."),
        }
    }
}
