//! The formats of clouds, by the name of the output.

use std::fs;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;

use slcal_core::format::{CloudFormat, read_ply};

use super::input_kind::InputKind;
use crate::exit::{Failure, Outcome};
use crate::name::is_dash;

/// The header of a PCD stands in this many bytes.
const PCD_HEADER: u64 = 4096;

/// The format of an output by its extension; PLY for stdout and for devices.
pub(crate) fn cloud_format_of(path: &Path) -> Outcome<CloudFormat> {
    match path.extension().and_then(|e| e.to_str()?.parse().ok()) {
        Some(format) => Ok(format),
        None if is_dash(path) || is_device(path) => Ok(CloudFormat::Ply),
        None => Err(Failure::usage(format!(
            "{}: expected an output whose name ends in .ply, .pcd, .xyz, .obj or .glb, or - for a PLY on stdout",
            path.display()
        ))),
    }
}

/// Whether a file exists and holds a complete cloud, as far as its format shows: binary formats state their length,
/// text formats only end with a line.
pub(crate) fn cloud_is_complete(format: CloudFormat, path: &Path) -> bool {
    is_complete(format, path).unwrap_or(false)
}

fn is_complete(format: CloudFormat, path: &Path) -> std::io::Result<bool> {
    let mut file = InputKind::Own.open(path)?;
    let length = file.metadata()?.len();
    let mut start = Vec::new();
    Ok(match format {
        CloudFormat::Ply => read_ply(file).is_ok(),
        CloudFormat::Pcd => {
            file.take(PCD_HEADER).read_to_end(&mut start)?;
            pcd_length(&start) == usize::try_from(length).ok()
        }
        CloudFormat::Xyz | CloudFormat::Obj => {
            file.seek(SeekFrom::End(-1))?;
            file.read_to_end(&mut start)?;
            start == b"\n"
        }
        CloudFormat::Glb => {
            file.take(12).read_to_end(&mut start)?;
            let stated = start.get(8..12).and_then(|b| b.first_chunk()).map(|b| u32::from_le_bytes(*b));
            start.starts_with(b"glTF") && stated.map(u64::from) == Some(length)
        }
    })
}

fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir())
}

/// The length of a binary PCD according to its header.
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
    use slcal_core::{CloudPoint, PointCloud};

    use super::*;

    #[test]
    fn a_file_that_was_cut_off_is_not_complete() {
        let point = CloudPoint {
            position: nalgebra::Point3::new(1.0, 2.0, 1000.0),
            pixel: nalgebra::Point2::new(3.0, 4.0),
            color: [9, 8, 7],
            sigma_mm: 0.1,
            noise_mm: 0.05,
            slit: Some(3),
            confidence: 1.0,
        };
        let cloud = PointCloud { points: vec![point; 5], ..PointCloud::default() };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud");
        for format in CloudFormat::ALL {
            assert!(!cloud_is_complete(format, &folder.path().join("none")));
            let mut bytes = Vec::new();
            format.write(&cloud, &mut bytes).unwrap();
            for (cut, complete) in [(0, true), (1, false), (bytes.len(), false)] {
                fs::write(&path, &bytes[..bytes.len() - cut]).unwrap();
                assert_eq!(cloud_is_complete(format, &path), complete, "{format:?} less {cut} bytes");
            }
        }
    }
}
