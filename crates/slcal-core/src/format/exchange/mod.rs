//! Import and export of rigs as files of other programs: `OpenCV`'s FileStorage, ROS camera_info, COLMAP, Kalibr, a script for Blender, and
//! arrays of `NumPy`. Each file of this folder states the pixel centre, the axes and the units of its format, and what the
//! format cannot represent.
//!
//! Values without a place in a format (σ, photographs) are left out and reported. A loss that would move projected points (a lens
//! term that the format does not have) is an error, unless a lossy export is requested.

mod blender;
mod colmap;
mod devices;
mod extras;
mod files;
mod guess;
mod kalibr;
mod losses;
#[cfg(feature = "npz")]
pub(super) mod npy;
#[cfg(feature = "npz")]
pub(super) mod npz;
mod opencv;
mod ros;
mod storage;
mod text;

use self::guess::Source;
use self::losses::Losses;
use super::budget::Budget;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Intrinsics;
use crate::rig::Rig;

pub use files::{
    ExchangeFormat, Export, ExportConfig, ExportedFile, ImportConfig, Imported, NamedBytes, StorageText,
};

/// Exports a rig as files of another program, with all digits of the numbers.
///
/// # Errors
/// [`Error::Invalid`] when the format cannot represent a term of a lens (the message states how far pixels would move without it), and
/// for numbers that are not finite.
///
/// # Examples
/// ```
/// use slcal_core::format::{ExchangeFormat, ExportConfig, NamedBytes, export_rig, import_rig};
///
/// # let rig = slcal_core::format::read_rig(&include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/truth_rig.json"))[..])?;
/// let export = export_rig(&rig, ExchangeFormat::OpenCv, &ExportConfig::default())?;
/// let files: Vec<_> = export.files.iter().map(|f| NamedBytes { name: f.name, bytes: &f.bytes }).collect();
/// let imported = import_rig(None, &files, &Default::default())?;
/// assert_eq!(imported.rig.camera, rig.camera);
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn export_rig(rig: &Rig, format: ExchangeFormat, config: &ExportConfig) -> Result<Export> {
    // Refuses numbers that are not finite.
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
    let told = matches!(format, ExchangeFormat::OpenCv | ExchangeFormat::Npz);
    if rig.is_mirrored() && !told {
        losses.notes.push(format!(
            "{} has no place for: pictures appear mirrored (column c of a picture is column width - 1 - c of the panel that is \
             written)",
            format.name()
        ));
    }
    Ok(Export { files, left_out: losses.notes })
}

/// Imports a rig, or a camera alone, from files of another program.
///
/// `format` may be `None` where the content identifies it. Files written by this library are read with all that the format
/// represents; those of other programs need only the devices and their poses.
///
/// # Errors
/// [`Error::Malformed`] when the files are of none of the formats or of another one, or when something is missing or
/// inconsistent; [`Error::Invalid`] when the size of an image is unknown.
pub fn import_rig(
    format: Option<ExchangeFormat>,
    files: &[NamedBytes<'_>],
    config: &ImportConfig,
) -> Result<Imported> {
    if files.is_empty() {
        return Err(Error::invalid(ErrorSubject::Import, "one at least", "none"));
    }
    let length = files.iter().map(|f| f.bytes.len()).sum();
    let budget = Budget::new(ErrorSubject::ImportFile, length);
    let (format, mut first_tree) = match format {
        Some(format) => (format, None),
        None => guess::format_of(files, &budget)?,
    };
    let mut source = |bytes| first_tree.take().map_or(Source::Bytes(bytes), Source::Tree);
    let mut notes = Vec::new();
    let rig = match format {
        ExchangeFormat::OpenCv => {
            opencv::import(source(one_of(files, "an OpenCV file")?), config, &mut notes, &budget)?
        }
        ExchangeFormat::Ros => {
            let sources = files.iter().map(|f| source(f.bytes)).collect();
            ros::import(sources, config, &mut notes, &budget)?
        }
        ExchangeFormat::Colmap => colmap::import(files, &mut notes)?,
        ExchangeFormat::Kalibr => kalibr::import(source(one_of(files, "a camchain")?), &mut notes, &budget)?,
        ExchangeFormat::Blender => blender::import(one_of(files, "a script for Blender")?)?,
        #[cfg(feature = "npz")]
        ExchangeFormat::Npz => npz::import(one_of(files, "an npz file")?, config, &mut notes, &budget)?,
        #[cfg(not(feature = "npz"))]
        ExchangeFormat::Npz => return Err(without_npz()),
    };
    Ok(Imported { rig, format, notes })
}

#[cfg(not(feature = "npz"))]
fn without_npz() -> Error {
    Error::invalid("format", "one that this build has (npz is the cargo feature `npz`)", "npz")
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

#[cfg(all(test, feature = "npz"))]
mod tests;
