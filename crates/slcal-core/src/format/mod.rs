//! Rigs, observations, patterns, matches and clouds as text and binary files, on any `Read` and `Write`.

#[cfg(feature = "exchange")]
mod camera;
mod cloud_format;
#[cfg(feature = "exchange")]
mod exchange;
mod glb;
mod matches_csv;
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

/// Four points and two triangles for the tests of the cloud formats.
#[cfg(test)]
pub(crate) fn test_cloud() -> crate::cloud::PointCloud {
    let point = |i: u16| crate::cloud::CloudPoint {
        position: nalgebra::Point3::new(f64::from(i), -0.5, 1000.25),
        pixel: nalgebra::Point2::new(f64::NAN, f64::NAN),
        color: [i as u8, 2, 255],
        sigma_mm: 0.125,
        noise_mm: 0.0625,
        slit: Some(60_000 + i),
        confidence: 0.75,
    };
    crate::cloud::PointCloud {
        points: (0..4).map(point).collect(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..crate::cloud::PointCloud::default()
    }
}
