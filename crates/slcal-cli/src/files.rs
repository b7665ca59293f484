//! Photographs read and files written as the command does it, for the Python package.

use std::io::Result;
use std::path::Path;

use image::DynamicImage;

pub use crate::io::exchange::{ExportPlaces, export_places, import_paths, storage_of};

use crate::io;

/// The photograph in the bytes of a file (PNG, JPEG or TIFF), turned upright by its EXIF orientation.
///
/// # Errors
/// A message that begins with `name` when the bytes are not such a picture, or not a whole one.
pub fn decode_photo(bytes: &[u8], name: &str) -> std::result::Result<DynamicImage, String> {
    io::decode_photo(bytes, name).map(|(photo, _)| photo).map_err(|failure| failure.to_string())
}

/// Writes a file that appears under its name when it is complete; an existing one is replaced then.
///
/// # Errors
/// What the system says, when its folder is missing or cannot be written into.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    io::write_whole(path, bytes)
}
