//! `slcal simulate`.

mod devices;
mod noise;
mod rig;
mod scene;
mod values;
mod views;

use clap::Subcommand;

pub(crate) use self::noise::NoiseArgs;
pub(crate) use self::scene::{Crosstalk, LightArgs, MeshFrameArg, PlaceArgs, SceneArgs, WallArg};
pub(crate) use self::views::ViewsArgs;
use super::examples;

#[derive(Debug, Subcommand)]
pub(crate) enum SimulateVerb {
    /// Calibrate repeatedly under increasing noise, with both methods, and compare with the ground truth.
    #[command(after_help = examples::NOISE)]
    Noise(Box<NoiseArgs>),
    /// Write noisy observations of a sheet in several poses, and the true rig.
    #[command(after_help = examples::VIEWS)]
    Views(Box<ViewsArgs>),
    /// Render photographs of a surface under the projector light, with ground truth for every pixel.
    #[command(after_help = examples::SCENE)]
    Scene(Box<SceneArgs>),
}
