//! `slcal evaluate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// What to fit.
    #[arg(value_enum)]
    pub(crate) shape: ShapeArg,
    /// A PLY with the points; `-` for stdin.
    pub(crate) cloud: PathBuf,
    /// Print the result as JSON instead of a summary.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShapeArg {
    /// A plane.
    Plane,
    /// A sphere.
    Sphere,
}
