//! All files: photographs and texts in, complete files out.

mod alpha;
mod cloud;
mod color_profile;
mod contained;
pub(crate) mod exchange;
mod exif;
mod folder;
pub(crate) mod input_kind;
mod jpeg_segments;
mod named_inks;
mod photo;
mod photo_kind;
mod picture_memory;
mod raw;
mod read;
mod sample_coding;
mod scan_frames;
mod signals;
mod temporary;
mod text;
mod tiff_tag;
mod transfer_curve;
mod write;

pub(crate) use crate::name::{input_name, is_dash};
pub(crate) use cloud::{cloud_format_of, cloud_is_complete};
pub(crate) use exchange::{export_places, import_paths, storage_of};
pub(crate) use exif::read_tags;
pub(crate) use folder::{files_of, is_named_photo, photographs};
pub(crate) use input_kind::InputKind;
pub(crate) use photo::{
    Decoded, Samples, decode_photo, decode_photo_as, load_photo, load_tagged_photo, read_photo,
};
pub(crate) use photo_kind::Foreign;
#[cfg(feature = "studio")]
pub(crate) use photo_kind::extension_of;
pub(crate) use raw::{RawFormat, RawFrame};
pub(crate) use read::{check_one_stdin, open_stream, read_bytes};
pub(crate) use scan_frames::{ScanFrames, scans, sequence_files};
#[cfg(feature = "studio")]
pub(crate) use signals::end_normally_on_signals;
pub(crate) use signals::end_whole_on_signals;
pub(crate) use text::{
    check_image_size, check_panel, check_projector, load_camera, load_checker, load_cloud, load_mesh,
    load_observations, load_pattern, load_rig, load_stripes, read_exchange,
};
pub(crate) use write::{
    Destination, Together, bytes_of, check_distinct, check_json, check_spares, jpeg_bytes, make_folder,
    png_bytes, write_all, write_whole,
};
#[cfg(feature = "studio")]
pub(crate) use write::{PHOTO_QUALITY, write_private};
