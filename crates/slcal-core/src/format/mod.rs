//! Rigs, observations, patterns, matches and clouds as text and binary files, on any `Read` and `Write`.

mod budget;
mod buffered;
#[cfg(feature = "exchange")]
mod camera;
mod cloud_format;
#[cfg(feature = "exchange")]
mod exchange;
mod glb;
mod json;
mod matches_csv;
#[cfg(feature = "npz")]
mod matches_npz;
mod obj;
mod obj_reader;
mod observations_json;
mod pattern_json;
mod pcd;
mod pfm;
mod ply;
mod recognise;
mod rig_json;
#[cfg(feature = "exchange")]
mod tree;
mod xyz;

#[cfg(feature = "exchange")]
pub use camera::{KnownCamera, read_camera};
pub use cloud_format::CloudFormat;
#[cfg(feature = "exchange")]
pub use exchange::{
    ExchangeFormat, Export, ExportConfig, ExportedFile, ImportConfig, Imported, NamedBytes, StorageText,
    export_rig, import_rig,
};
pub use glb::write_glb;
pub use matches_csv::{read_matches, write_matches};
#[cfg(feature = "npz")]
pub use matches_npz::{read_dense_matches, write_dense_matches};
pub use obj::write_obj;
pub use obj_reader::read_obj;
pub use observations_json::{read_observations, write_observations};
pub use pattern_json::{read_pattern, write_pattern};
pub use pcd::write_pcd;
pub use pfm::write_pfm;
pub use ply::{read_ply, write_ply};
pub use recognise::recognise;
pub use rig_json::{read_rig, write_rig};
pub use xyz::write_xyz;
