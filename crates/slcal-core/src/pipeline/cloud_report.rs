//! The record of one frame: an entry of `clouds` in `slcal-reconstruct/1`.

use serde::Serialize;

use super::reconstructor::Reconstruction;
use crate::decode::{DecodeReport, SequenceDecodeReport};
use crate::reconstruct::{CullReport, RigCheckReport, TriangulateReport};
use crate::rig::Warning;

/// Counts of a cloud and reports of its stages.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CloudReport {
    /// Points of the cloud.
    pub points: usize,
    /// Its triangles; none without a mesh.
    pub triangles: usize,
    /// Report of decoding; null when the matches were given.
    pub decode: Option<DecodeReport>,
    /// Report of decoding a sequence of photographs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sequence: Option<SequenceDecodeReport>,
    /// Counts of matches that gave no point.
    pub triangulate: TriangulateReport,
    /// Counts of removed triangles and points.
    pub cull: CullReport,
    /// How the matches agree with the rig.
    pub rig_check: RigCheckReport,
    /// What makes the cloud doubtful.
    pub warnings: Vec<Warning>,
}

#[cfg(feature = "report")]
impl Reconstruction {
    /// The record of this reconstruction.
    #[must_use]
    pub fn report(&self) -> CloudReport {
        CloudReport {
            points: self.cloud.points.len(),
            triangles: self.cloud.triangles.len(),
            decode: self.decode.clone(),
            sequence: self.sequence.clone(),
            triangulate: self.triangulate,
            cull: self.cull,
            rig_check: self.rig_check,
            warnings: self.warnings(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cloud_is_counted() {
        let cloud = crate::for_tests::test_cloud();
        let printed =
            serde_json::to_string(&Reconstruction { cloud, ..Reconstruction::default() }.report()).unwrap();
        assert!(
            printed.starts_with(r#"{"points":4,"triangles":2,"decode":null,"triangulate":{"#)
                && printed.contains(r#""cull":{"#),
            "{printed}"
        );
    }
}
