//! `slcal evaluate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::headings::OUTPUT;

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// Surface to fit.
    #[arg(value_enum)]
    pub(crate) shape: ShapeArg,
    /// PLY file with the points; `-` for stdin.
    pub(crate) cloud: PathBuf,
    /// Draw the points as the camera sees them, coloured by their distance from the surface.
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShapeArg {
    /// A plane.
    Plane,
    /// A sphere.
    Sphere,
}
