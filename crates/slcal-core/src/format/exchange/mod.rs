//! Rigs as other programs' files, and back: `OpenCV`'s FileStorage, ROS camera_info, COLMAP, Kalibr, a script for Blender, and
//! arrays of `NumPy`. Each file of this folder says where its format puts the centre of a pixel, where its axes point and which
//! units it has, and what it cannot hold.
//!
//! What a format has no place for (σ, photographs) is left out and told. What would move projected points (a term of the lens that
//! a format does not have) is an error, unless it is asked for.

mod blender;
mod colmap;
mod extras;
mod guess;
mod kalibr;
mod losses;
#[cfg(feature = "npz")]
mod npy;
#[cfg(feature = "npz")]
mod npz;
mod opencv;
mod ros;
mod storage;
mod text;

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use self::losses::Losses;
use super::camera::KnownCamera;
use super::rig_json::exact_pose;
use super::tree::Expecting;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{Camera, Intrinsics, Pose};
use crate::named::named;
use crate::rig::{Device, Projector, Rig};

/// A format of other programs that holds a rig, or part of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ExchangeFormat {
    /// `OpenCV`'s FileStorage.
    OpenCv,
    /// `camera_info` YAML, a file per device.
    Ros,
    /// A sparse model as text.
    Colmap,
    /// A camchain YAML.
    Kalibr,
    /// A Python script that builds the scene.
    Blender,
    /// Arrays, as `numpy.savez` writes them.
    Npz,
}

named!(ExchangeFormat, "format", {
    OpenCv => "opencv",
    Ros => "ros",
    Colmap => "colmap",
    Kalibr => "kalibr",
    Blender => "blender",
    Npz => "npz",
});

impl ExchangeFormat {
    /// How it differs from this library's own conventions, in one line.
    #[must_use]
    pub fn convention(self) -> &'static str {
        match self {
            Self::OpenCv => {
                "integer pixel centres; x right, y down, z forward; mm; X_projector = R X_camera + T"
            }
            Self::Ros => "integer pixel centres; optical frames (x right, y down, z forward)",
            Self::Colmap => {
                "pixel centres at .5, so cx and cy are 0.5 larger; the world is the camera's frame, mm"
            }
            Self::Kalibr => {
                "integer pixel centres; x right, y down, z forward; metres; cam0 is the camera, cam1 the projector"
            }
            Self::Blender => "metres, z up; the camera stands at the origin and looks along +y",
            Self::Npz => {
                "integer pixel centres; x right, y down, z forward; mm; X_projector = R X_camera + t"
            }
        }
    }
}

/// How FileStorage is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StorageText {
    /// As YAML.
    #[default]
    Yaml,
    /// As XML.
    Xml,
    /// As JSON.
    Json,
}

/// How a rig is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ExportConfig {
    /// How FileStorage is written; other formats do not ask.
    pub storage: StorageText,
    /// Whether terms of the lens that the format does not have are left out (and told), instead of being an error.
    pub lossy: bool,
}

/// One file of an export.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportedFile {
    /// Its usual name: `cameras.txt`.
    pub name: &'static str,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// A rig as files of another program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Export {
    /// The files, one at least.
    pub files: Vec<ExportedFile>,
    /// What the format has no place for or its readers overlook, each in a line.
    pub left_out: Vec<String>,
}

/// One file of an import.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NamedBytes<'a> {
    /// Its name, without folders.
    pub name: &'a str,
    /// Its content.
    pub bytes: &'a [u8],
}

/// What an import should know beside its files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImportConfig {
    /// Width and height of the camera's images, px, for files that do not say.
    pub camera_size: Option<[u32; 2]>,
    /// Width and height of the projector's panel, px, for files that do not say.
    pub projector_size: Option<[u32; 2]>,
}

/// A rig from files of another program.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The rig.
    pub rig: Rig,
    /// Whose files they were.
    pub format: ExchangeFormat,
    /// What was taken to be so without the files saying it, each in a line.
    pub notes: Vec<String>,
}

/// Writes a rig as files of another program. Numbers have all their digits.
///
/// # Errors
/// [`Error::Invalid`] when the format has no place for a term of a lens (the message says how far pixels would move without it), for
/// numbers that are not finite, and for a projector without its place.
pub fn export_rig(rig: &Rig, format: ExchangeFormat, config: &ExportConfig) -> Result<Export> {
    // Refuses what no file should hold.
    super::write_rig(rig, std::io::sink())?;
    for (_, device) in rig.devices() {
        Intrinsics::from_matrix(&device.model.intrinsics.matrix())?;
    }
    let mut losses = Losses::new(format, config.lossy);
    let files = match format {
        ExchangeFormat::OpenCv => opencv::export(rig, config.storage, &mut losses)?,
        ExchangeFormat::Ros => ros::export(rig, &mut losses)?,
        ExchangeFormat::Colmap => colmap::export(rig, &mut losses)?,
        ExchangeFormat::Kalibr => kalibr::export(rig, &mut losses)?,
        ExchangeFormat::Blender => blender::export(rig, &mut losses)?,
        #[cfg(feature = "npz")]
        ExchangeFormat::Npz => npz::export(rig)?,
        #[cfg(not(feature = "npz"))]
        ExchangeFormat::Npz => return Err(without_npz()),
    };
    Ok(Export { files, left_out: losses.notes })
}

/// Reads a rig, or a camera alone, from files of another program.
///
/// `format` may be left open where the content tells. Files that this library wrote give back all that the format holds; those of
/// other programs need not have more than the devices and their poses.
///
/// # Errors
/// [`Error::Malformed`] when the files are of none of the formats or of another one, or when something is missing or not what its
/// name says; [`Error::Invalid`] when the size of an image is nowhere to be found.
pub fn import_rig(
    format: Option<ExchangeFormat>,
    files: &[NamedBytes<'_>],
    config: &ImportConfig,
) -> Result<Imported> {
    if files.is_empty() {
        return Err(Error::invalid(ErrorSubject::Import, "one at least", "none"));
    }
    let format = match format {
        Some(format) => format,
        None => guess::format_of(files)?,
    };
    let mut notes = Vec::new();
    let rig = match format {
        ExchangeFormat::OpenCv => opencv::import(one_of(files, "an OpenCV file")?, config, &mut notes)?,
        ExchangeFormat::Ros => ros::import(files, config, &mut notes)?,
        ExchangeFormat::Colmap => colmap::import(files, &mut notes)?,
        ExchangeFormat::Kalibr => kalibr::import(one_of(files, "a camchain")?, &mut notes)?,
        ExchangeFormat::Blender => blender::import(one_of(files, "a script for Blender")?)?,
        #[cfg(feature = "npz")]
        ExchangeFormat::Npz => npz::import(one_of(files, "an npz file")?, config, &mut notes)?,
        #[cfg(not(feature = "npz"))]
        ExchangeFormat::Npz => return Err(without_npz()),
    };
    Ok(Imported { rig, format, notes })
}

#[cfg(not(feature = "npz"))]
fn without_npz() -> Error {
    Error::invalid("format", "one that this build has (npz is the cargo feature `npz`)", "npz")
}

/// Files of hundreds of views have some hundred thousand numbers, most of them in the covariance.
const MOST_NODES: usize = 4_000_000;

const fn expecting(what: ErrorSubject) -> Expecting {
    Expecting { what, most_nodes: MOST_NODES }
}

/// The only file of a format that has one.
fn one_of<'a>(files: &[NamedBytes<'a>], what: &str) -> Result<&'a [u8]> {
    match files {
        [file] => Ok(file.bytes),
        _ => Err(Error::invalid(
            ErrorSubject::Import,
            format!("one file, {what}"),
            format!("{} files", files.len()),
        )),
    }
}

/// A device as a file describes it, its size told beside the file where it is not in there.
fn device(
    known: KnownCamera,
    given: Option<[u32; 2]>,
    name: &'static str,
    notes: &mut Vec<String>,
) -> Result<Device> {
    let what = ErrorSubject::Part { part: "image size", of: name };
    if let (Some(found), Some(given)) = (known.size, given)
        && found != given
    {
        let shown = |[w, h]: [u32; 2]| format!("{w}x{h} px");
        return Err(Error::invalid(what, format!("{}, as the file says", shown(found)), shown(given)));
    }
    let Some([width, height]) = known.size.or(given) else {
        let expected = "one in the file, or given beside it";
        return Err(Error::invalid(what, expected, "none"));
    };
    notes.extend(known.notes);
    Ok(Camera { width, height, intrinsics: known.intrinsics, distortion: known.distortion }.into())
}

/// A pose as a file has it, mm.
fn pose_of(r: &Matrix3<f64>, t: Vector3<f64>, expecting: Expecting, place: &str) -> Result<Pose> {
    exact_pose(r, t).map_err(|e| expecting.malformed(format!("{place}: {e}")))
}

/// A rig of devices from elsewhere, of which nothing else is known.
fn plain_rig(camera: Device, projector: Option<(Device, Pose)>, format: ExchangeFormat) -> Rig {
    Rig {
        camera,
        projector: projector.map(|(device, pose)| Projector { device, from_camera: pose.into() }),
        views: Vec::new(),
        method: format.name().to_owned(),
        quality: None,
        covariance: None,
    }
}

#[cfg(all(test, feature = "npz"))]
mod tests;
