//! What became of one frame: an entry of `clouds` in `slcal-reconstruct/1`.

use serde::Serialize;

use super::{CullReport, Reconstruction, TriangulateReport};
use crate::decode::DecodeReport;

/// A cloud in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CloudReport {
    /// Points of the cloud.
    pub points: usize,
    /// Its triangles; none without a mesh.
    pub triangles: usize,
    /// What was seen in the photograph; null when the matches were given.
    pub decode: Option<DecodeReport>,
    /// Matches that became no point.
    pub triangulate: TriangulateReport,
    /// What was removed.
    pub cull: CullReport,
}

impl Reconstruction {
    /// The record of this reconstruction.
    #[must_use]
    pub fn report(&self) -> CloudReport {
        CloudReport {
            points: self.cloud.points.len(),
            triangles: self.cloud.triangles.len(),
            decode: self.decode.clone(),
            triangulate: self.triangulate,
            cull: self.cull,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cloud_is_counted() {
        let cloud = crate::format::test_cloud();
        let printed =
            serde_json::to_string(&Reconstruction { cloud, ..Reconstruction::default() }.report()).unwrap();
        assert!(
            printed.starts_with(r#"{"points":4,"triangles":2,"decode":null,"triangulate":{"#)
                && printed.contains(r#""cull":{"#),
            "{printed}"
        );
    }
}
