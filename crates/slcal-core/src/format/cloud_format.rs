//! The file formats of clouds, chosen by the extension of the file name.

use std::io::Write;

use super::{write_glb, write_obj, write_pcd, write_ply, write_xyz};
use crate::cloud::PointCloud;
use crate::error::Result;
use crate::named::named;

/// A file format of clouds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CloudFormat {
    /// Binary, with all values of a point.
    #[default]
    Ply,
    /// The format of the Point Cloud Library, binary; no triangles.
    Pcd,
    /// Plain text, one point per line; no triangles.
    Xyz,
    /// Wavefront, text.
    Obj,
    /// Binary glTF: metres, y upwards.
    Glb,
}

// The names are the file extensions.
named!(CloudFormat, "format", { Ply => "ply", Pcd => "pcd", Xyz => "xyz", Obj => "obj", Glb => "glb" });

impl CloudFormat {
    /// Whether its files are text.
    #[must_use]
    pub fn is_text(self) -> bool {
        matches!(self, Self::Xyz | Self::Obj)
    }

    /// Writes a cloud.
    ///
    /// # Errors
    /// As the writer of the format.
    pub fn write(self, cloud: &PointCloud, output: impl Write) -> Result<()> {
        match self {
            Self::Ply => write_ply(cloud, output),
            Self::Pcd => write_pcd(cloud, output),
            Self::Xyz => write_xyz(cloud, output),
            Self::Obj => write_obj(cloud, output),
            Self::Glb => write_glb(cloud, output),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_name_formats_in_upper_and_lower_case() {
        for format in CloudFormat::ALL {
            assert_eq!(format.name().to_uppercase().parse(), Ok(format));
            let mut bytes = Vec::new();
            format.write(&crate::for_tests::test_cloud(), &mut bytes).unwrap();
            assert_eq!(std::str::from_utf8(&bytes).is_ok(), format.is_text(), "{format:?}");
        }
        assert!("stl".parse::<CloudFormat>().is_err());
        assert!("".parse::<CloudFormat>().is_err());
    }
}
