//! The formats, and the files of exports and imports.

use serde::{Deserialize, Serialize};

use crate::named::named;
use crate::rig::Rig;

/// A format of other programs for a rig, or part of one.
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
    /// Its conventions, in one line.
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
#[non_exhaustive]
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
    /// How FileStorage is written; ignored by other formats.
    pub storage: StorageText,
    /// Whether lens terms that the format does not have are left out and reported, instead of being an error.
    pub lossy: bool,
}

/// One file of an export.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct ExportedFile {
    /// Its usual name: `cameras.txt`.
    pub name: &'static str,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// A rig as files of another program.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Export {
    /// The files, at least one.
    pub files: Vec<ExportedFile>,
    /// What the format cannot represent or its readers ignore, one line each.
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

/// Values that complete the files of an import.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImportConfig {
    /// Width and height of the camera's images, px, for files that do not state it.
    pub camera_size: Option<[u32; 2]>,
    /// Width and height of the projector's panel, px, for files that do not state it.
    pub projector_size: Option<[u32; 2]>,
}

/// A rig from files of another program.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Imported {
    /// The rig.
    pub rig: Rig,
    /// The format of the files.
    pub format: ExchangeFormat,
    /// Assumptions that the files do not state, one line each.
    pub notes: Vec<String>,
}
