//! The formats of clouds, told by the output's name.

use std::fs;
use std::path::Path;

use clap::ValueEnum;
use slcal_core::PointCloud;
use slcal_core::format::{read_ply, write_glb, write_obj, write_pcd, write_ply, write_xyz};

use super::is_dash;
use crate::exit::{Failure, Outcome};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum CloudFormat {
    /// Binary, with all that is known of a point.
    #[default]
    Ply,
    /// Of the Point Cloud Library, binary; no triangles.
    Pcd,
    /// Plain text, a point a line; no triangles.
    Xyz,
    /// Wavefront, text.
    Obj,
    /// Binary glTF: metres, y upwards.
    Glb,
}

impl CloudFormat {
    /// By the extension; PLY for stdout and for devices, whose names say nothing.
    pub(crate) fn of(path: &Path) -> Outcome<Self> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("ply") => Ok(Self::Ply),
            Some("pcd") => Ok(Self::Pcd),
            Some("xyz") => Ok(Self::Xyz),
            Some("obj") => Ok(Self::Obj),
            Some("glb") => Ok(Self::Glb),
            _ if is_dash(path) || is_device(path) => Ok(Self::Ply),
            _ => Err(Failure::usage(format!(
                "{}: expected an output whose name ends in .ply, .pcd, .xyz, .obj or .glb, or - for a PLY on stdout",
                path.display()
            ))),
        }
    }

    /// The ending of its files' names.
    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::Pcd => "pcd",
            Self::Xyz => "xyz",
            Self::Obj => "obj",
            Self::Glb => "glb",
        }
    }

    /// Whether a file is there and holds a whole cloud, as far as its format can tell: the binary ones state their length,
    /// the text ones only how a line ends.
    pub(crate) fn is_complete(self, path: &Path) -> bool {
        let Ok(bytes) = fs::read(path) else { return false };
        match self {
            Self::Ply => read_ply(bytes.as_slice()).is_ok(),
            Self::Pcd => pcd_length(&bytes) == Some(bytes.len()),
            Self::Xyz | Self::Obj => bytes.ends_with(b"\n"),
            Self::Glb => {
                let length = bytes.get(8..12).and_then(|b| b.first_chunk()).map(|b| u32::from_le_bytes(*b));
                bytes.starts_with(b"glTF") && length.map(|n| n as usize) == Some(bytes.len())
            }
        }
    }

    /// The file.
    pub(crate) fn bytes(self, cloud: &PointCloud) -> Outcome<Vec<u8>> {
        let mut bytes = Vec::new();
        match self {
            Self::Ply => write_ply(cloud, &mut bytes),
            Self::Pcd => write_pcd(cloud, &mut bytes),
            Self::Xyz => write_xyz(cloud, &mut bytes),
            Self::Obj => write_obj(cloud, &mut bytes),
            Self::Glb => write_glb(cloud, &mut bytes),
        }?;
        Ok(bytes)
    }
}

fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir())
}

/// The length that a binary PCD must have by its header.
fn pcd_length(bytes: &[u8]) -> Option<usize> {
    const END: &[u8] = b"DATA binary\n";
    let start = bytes.windows(END.len()).position(|w| w == END)? + END.len();
    let header = std::str::from_utf8(&bytes[..start]).ok()?;
    let numbers = |key: &str| {
        let words = header.lines().find_map(|l| l.strip_prefix(key))?.split_whitespace();
        words.map(|w| w.parse::<usize>().ok()).collect::<Option<Vec<_>>>()
    };
    let record: usize = numbers("SIZE ")?.iter().sum();
    numbers("POINTS ")?.first()?.checked_mul(record)?.checked_add(start)
}

#[cfg(test)]
mod tests {
    use slcal_core::CloudPoint;

    use super::*;

    #[test]
    fn a_file_that_was_cut_off_is_not_complete() {
        let point = CloudPoint {
            position: nalgebra::Point3::new(1.0, 2.0, 1000.0),
            pixel: nalgebra::Point2::new(3.0, 4.0),
            color: [9, 8, 7],
            sigma_mm: 0.1,
            noise_mm: 0.05,
            slit: 3,
            confidence: 1.0,
        };
        let cloud = PointCloud { points: vec![point; 5], ..PointCloud::default() };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud");
        for format in CloudFormat::value_variants() {
            assert!(!format.is_complete(&folder.path().join("none")));
            let bytes = format.bytes(&cloud).unwrap();
            for (cut, complete) in [(0, true), (1, false), (bytes.len(), false)] {
                fs::write(&path, &bytes[..bytes.len() - cut]).unwrap();
                assert_eq!(format.is_complete(&path), complete, "{format:?} less {cut} bytes");
            }
        }
    }
}
