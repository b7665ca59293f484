//! The formats of clouds, told by the output's name.

use std::fs;
use std::path::Path;

use slcal_core::PointCloud;
use slcal_core::format::{write_glb, write_obj, write_pcd, write_ply, write_xyz};

use super::is_dash;
use crate::exit::{Failure, Outcome};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum CloudFormat {
    Ply,
    Pcd,
    Xyz,
    Obj,
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
