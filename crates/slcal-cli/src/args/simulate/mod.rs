//! `slcal simulate`.

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
    /// Calibrate again and again under rising noise, by both methods, and compare with the truth.
    #[command(after_help = examples::NOISE)]
    Noise(Box<NoiseArgs>),
    /// Observations of a sheet in several poses, with noise, and the rig that is the truth behind them.
    #[command(after_help = examples::VIEWS)]
    Views(Box<ViewsArgs>),
    /// Photographs of a plane, a sphere, a step, a sheet or a mesh under the projector's light, with the truth of every pixel.
    #[command(after_help = examples::SCENE)]
    Scene(Box<SceneArgs>),
}
