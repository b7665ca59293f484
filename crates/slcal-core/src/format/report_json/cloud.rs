//! What became of one frame: an entry of `clouds` in `slcal-reconstruct/1`.

use serde::Serialize;

use crate::decode::DecodeReport;
use crate::reconstruct::{CullReport, Reconstruction, TriangulateReport};

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

/// What is reported of one reconstruction.
#[must_use]
pub fn cloud(result: &Reconstruction) -> CloudReport {
    CloudReport {
        points: result.cloud.points.len(),
        triangles: result.cloud.triangles.len(),
        decode: result.decode.clone(),
        triangulate: result.triangulate,
        cull: result.cull,
    }
}
