//! Photographs of a rig with exact truth: for tests, for benches, and for those who plan a rig.
//!
//! ```
//! use slcal_core::pattern::{StripeConfig, StripePattern};
//! use slcal_core::simulate::{
//!     PoseConfig, Photographer, RenderConfig, RigConfig, Scene, Shape, ProjectedImage, Surface,
//! };
//! # fn main() -> slcal_core::Result<()> {
//! let config = RigConfig { camera: [160, 120], camera_focal_px: 190.0, ..RigConfig::default() };
//! let rig = Scene::new(&config, &[PoseConfig::tilted(25.0, 28.0)])?.rig();
//! let ball = Shape::Sphere { centre: [0.0, 0.0, 1000.0].into(), radius_mm: 200.0 };
//! let photographer = Photographer::new(&rig, &[Surface::object(ball)], &RenderConfig::default())?;
//! let stripes = StripePattern::new(config.projector, &StripeConfig::default())?;
//! let photo = photographer.photograph(ProjectedImage::Picture(&stripes.image()?), 0)?;
//! let seen = photographer.truth().at(80, 60).expect("the ball stands in the middle");
//! assert!((seen.point.z - 800.0).abs() < 1.0 && photo.width() == 160);
//! let exact = photographer.stripe_matches(&stripes);
//! # assert!(!exact.items.is_empty());
//! # Ok(())
//! # }
//! ```

mod blur;
mod camera_pipeline;
mod channel_offset;
mod config;
mod crossings;
mod demosaic;
mod flicker;
mod hit;
mod jpeg;
mod mesh;
mod panel;
mod photographer;
mod pixel_light;
mod radial_falloff;
mod ray_tracer;
mod report_json;
mod scene_object;
mod sensor;
mod setup;
mod sharpen;
mod sheet_object;
mod simulated;
mod surface;
mod tone;
mod truth;

pub use config::RenderConfig;
pub use demosaic::Demosaic;
pub use flicker::Flicker;
pub use mesh::TriangleMesh;
pub use photographer::{Photographer, ProjectedImage};
pub use report_json::SceneReport;
pub use scene_object::{Placement, SceneObject};
pub use sensor::Exposure;
pub use setup::{PatternKind, PreparedScene, SceneSetup, SurfaceKind, WallKind};
pub use sharpen::Sharpen;
pub use sheet_object::SheetObject;
pub use simulated::SimulatedScene;
pub use surface::{Shape, Surface};
pub use truth::{PixelTruth, Truth};

#[cfg(test)]
mod tests;
