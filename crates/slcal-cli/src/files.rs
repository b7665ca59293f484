//! Reading photographs and writing files and reports as the command does, for the Python package.

use std::io::Result;
use std::path::Path;

use image::DynamicImage;
use slcal_core::{Observations, PhotoTags, PointCloud, Rig, ViewResiduals};

pub use crate::io::exchange::{ExportPlaces, export_places, import_paths, storage_of};
pub use crate::io::input_kind::{InputKind, read_input};

use crate::io;
use crate::report::{Photo, RigPage, ShownCloud, rig_html};

/// A photograph from its file.
#[derive(Debug)]
#[non_exhaustive]
pub struct DecodedPhoto {
    /// Upright, with samples as sRGB codes them unless they were asked for as they are stored.
    pub photo: DynamicImage,
    /// How samples were converted, if they were.
    pub converted: Option<String>,
}

/// The photograph in the bytes of a file (PNG, JPEG, TIFF, WebP or BMP), turned upright by its EXIF orientation. Samples that the
/// file says to be coded otherwise than sRGB are converted unless they are wanted `as_stored`.
///
/// # Errors
/// A message that begins with `name` when the bytes are not such a picture, or are truncated.
pub fn decode_photo(bytes: &[u8], name: &str, as_stored: bool) -> std::result::Result<DecodedPhoto, String> {
    let samples = if as_stored { io::Samples::AsStored } else { io::Samples::AsFileSays };
    let io::Decoded { photo, converted, .. } =
        io::decode_photo_as(bytes, name, samples).map_err(|failure| failure.to_string())?;
    Ok(DecodedPhoto { photo, converted })
}

/// A format of photographs that takes a library of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForeignPhoto {
    /// HEIF with HEVC inside, as telephones write it.
    Heic,
    /// HEIF with AV1 inside.
    Avif,
}

impl ForeignPhoto {
    /// The format of a file by its bytes, if it is one of these.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Option<Self> {
        match io::Foreign::of(bytes, "")? {
            io::Foreign::Heic => Some(Self::Heic),
            io::Foreign::Avif => Some(Self::Avif),
            io::Foreign::Raw => None,
        }
    }
}

/// The EXIF tags in the bytes of a photograph's file; `None` where there are none that can be read.
#[must_use]
pub fn read_tags(bytes: &[u8]) -> Option<PhotoTags> {
    io::read_tags(bytes).ok()
}

/// Writes a file that appears under its name when it is complete; an existing file is replaced.
///
/// # Errors
/// The error of the system when the folder is missing or not writable.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    io::write_whole(path, bytes)
}

/// The HTML report on a rig, as `slcal report` writes it: with its photographs (none, or one per view, in display
/// encoding), the observations with their residuals, and a cloud, as far as they are given.
///
/// # Errors
/// A message when a photograph cannot be written into the page.
pub fn rig_report(
    rig: &Rig,
    photos: &[DynamicImage],
    measured: Option<(&Observations, Vec<ViewResiduals>)>,
    cloud: Option<&PointCloud>,
) -> std::result::Result<Vec<u8>, String> {
    let shown: crate::exit::Outcome<Vec<_>> =
        photos.iter().map(|p| Photo::new(p, photos.len()).map(Some)).collect();
    let mut photos = shown.map_err(|failure| failure.to_string())?;
    photos.resize_with(rig.views.len(), || None);
    let (observations, residuals) = match measured {
        Some((observations, residuals)) => (Some(observations), Ok(residuals)),
        None => (None, Err("the measurements were not given".to_owned())),
    };
    let page = RigPage {
        rig,
        rig_name: String::new(),
        checker_name: None,
        photos,
        observations,
        residuals,
        cloud: cloud.map(|cloud| ShownCloud { name: "the cloud".to_owned(), cloud }),
        made_by: Vec::new(),
    };
    Ok(rig_html(&page))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_needs_nothing_but_a_rig() {
        let rig = slcal_core::format::read_rig(include_bytes!("../demo/truth_rig.json").as_slice()).unwrap();
        let page = String::from_utf8(rig_report(&rig, &[], None, None).unwrap()).unwrap();
        assert!(page.starts_with("<!DOCTYPE html>") && page.contains("data-field=\"camera.K.0.0\""));
        assert!(page.contains("id=\"space\"") && !page.contains("slcal calibrate"));
    }
}
