//! Synthetic rigs with ground truth: their observations under noise, and the accuracy of the estimators.
//!
//! [`RigConfig`] describes a camera, a projector and a sheet; [`Scene`] is that rig in given poses and makes
//! [`Observations`](crate::Observations) with seeded noise. [`NoiseExperiment`] is the synthetic experiment of R.
//! Orghidan, J. Salvi, M. Gordan, C. Florea, J. Batlle, "Structured light self-calibration with vanishing points",
//! Machine Vision and Applications 25:489-500 (2014), Fig. 7–11, together with the Cramér–Rao bound. [`Photographer`]
//! renders photographs of surfaces through a rig, with the ground truth of every pixel; [`SceneSetup`] sets all of that
//! up with a few numbers. Compiled with the feature `simulate`.

mod bend;
mod bent_sheet;
mod bound;
mod csv;
mod cube;
mod draws;
mod experiment;
mod experiment_json;
mod photograph;
mod poses;
mod rig_config;
mod scene;
mod spread;
mod statistics;
mod trial;

pub use bend::{BendConfig, BendKind, BendReport, Sag};
pub use bent_sheet::{BentSheet, BentSheetHit};
pub use bound::{Bound, PrincipalPointSigma, bound};
pub use cube::{Cube, CubeError};
pub use draws::Draws;
pub use experiment::{LevelReport, NoiseConfig, NoiseExperiment, NoiseReport, PrincipalPoints, TrueValues};
pub use photograph::{
    Demosaic, Exposure, Flicker, PatternKind, Photographer, PixelTruth, Placement, PreparedScene,
    ProjectedImage, RenderConfig, SceneObject, SceneReport, SceneSetup, Shape, Sharpen, SheetObject,
    SimulatedScene, Surface, SurfaceKind, TriangleMesh, Truth, WallKind,
};
pub use poses::PoseConfig;
pub use rig_config::RigConfig;
pub use scene::{NoiseModel, Scene};
pub use spread::{SpreadConfig, spread_poses};
pub use statistics::{Coverage, ErrorStatistics, Statistics};
pub use trial::{MethodName, MethodReport};

#[cfg(test)]
mod tests;
