//! Work for the worker, and what comes back.

use std::collections::BTreeSet;
use std::sync::Arc;

use image::RgbImage;
use slcal_core::pattern::SequencePattern;
use slcal_core::{Rig, SheetSize};

use super::auto_shot::Quad;
use super::live::Look;
use super::project::{Purpose, StoredPhoto};
use super::scan_folder::ScanFolder;
use super::state::{CloudEntry, DemoScene, Guide, Problem, Unfinished};

/// What panel, sheet and pattern are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bench {
    pub(super) projector: [u32; 2],
    pub(super) sheet: SheetSize,
    pub(super) pattern_scale: f64,
}

/// What a live frame is looked at for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LookFor {
    /// Nothing: it is only shown.
    Nothing,
    Sheet,
    /// A cloud of each frame.
    Cloud,
}

/// A frame of the live picture.
#[derive(Debug, Clone)]
pub(super) struct LiveFrame {
    pub(super) seq: u32,
    /// The frame; `None`: the simulated camera takes one.
    pub(super) picture: Option<Arc<RgbImage>>,
    pub(super) look_for: LookFor,
    /// Where the sheet is wanted, and the size of the picture in which that is.
    pub(super) wanted: Option<([u32; 2], Quad)>,
    /// What the simulated camera sees.
    pub(super) scene: Option<DemoScene>,
}

#[derive(Debug, Clone)]
pub(super) enum Job {
    /// Draws the patterns, and looks through all photographs that are there; those with these names were left out.
    Begin(Bench, BTreeSet<String>),
    /// Advises the first pose for a camera with images of this size.
    FirstGuide([u32; 2]),
    /// Looks for the sheet in a photograph of the project.
    Sheet(StoredPhoto),
    /// Calibrates from these photographs.
    Calibrate(Vec<u32>),
    /// There is nothing to calibrate from any more.
    Forget,
    /// Takes a photograph with the simulated camera.
    TakeSimulated(Purpose, DemoScene),
    /// Makes a cloud of a photograph of the project.
    Cloud(StoredPhoto),
    /// Makes the folder for a scan by this sequence.
    BeginScan(Arc<SequencePattern>),
    /// Makes a cloud of the photographs in such a folder.
    SequenceCloud(ScanFolder),
    /// Keeps the last frame of a continuous scan and its cloud.
    KeepLive,
    /// Draws a picture so that it appears without keystone.
    Rectify { name: String, bytes: Arc<[u8]> },
    /// Writes the rig for another program.
    Export(String),
}

/// What was found of the sheet in a photograph.
#[derive(Debug, Clone)]
pub(super) struct SheetFound {
    pub(super) corners: usize,
    pub(super) of: usize,
    pub(super) outline: Option<Quad>,
    pub(super) size: [u32; 2],
}

/// A calibration.
#[derive(Debug, Clone)]
pub(super) struct Calibrated {
    pub(super) rig: Arc<Rig>,
    /// [`fingerprint`](super::cloud_note::fingerprint) of its file.
    pub(super) fingerprint: String,
    /// The photographs it was made from, in the order of the rig's views.
    pub(super) used: Vec<u32>,
    pub(super) guide: Option<Guide>,
}

#[derive(Debug, Clone)]
pub(super) enum Done {
    /// The patterns are drawn.
    Begun,
    Nothing,
    /// The patterns could not be drawn.
    NotBegun(Problem),
    /// A scan of an earlier run whose cloud is not there: what makes it.
    CloudMissing(Job),
    /// A scan of an earlier run of which photographs are missing.
    Unfinished(Unfinished),
    /// The folder for a scan is there.
    ScanBegun(ScanFolder),
    /// All photographs that were there are looked through.
    Looked,
    FirstGuide(Option<Guide>),
    Sheet {
        photo: StoredPhoto,
        found: Result<SheetFound, Problem>,
    },
    Calibrated(Result<Calibrated, Problem>),
    /// A photograph was taken and kept.
    Kept(Purpose, StoredPhoto),
    Look(Look),
    /// A cloud of a continuous scan; the bytes are as pages draw it.
    LiveCloud {
        look: Look,
        points: usize,
        bytes: Arc<[u8]>,
    },
    Cloud(CloudEntry),
    /// A picture is drawn; its name for people and its file.
    Picture {
        name: String,
        file: String,
    },
    Exported {
        files: Vec<String>,
        left_out: Vec<String>,
    },
    /// Something could not be done.
    Failed(Problem),
}
