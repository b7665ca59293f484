//! `slcal pattern`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use slcal_core::pattern::Axis;

use super::examples;
use super::headings::{INPUT, OUTPUT, SETTINGS};
use super::value::{choice, parse_pair};

#[derive(Debug, Subcommand)]
pub(crate) enum PatternVerb {
    /// The checkerboard that calibration needs.
    #[command(after_help = examples::CHECKER)]
    Checker(CheckerArgs),
    /// The coloured stripes that reconstruction needs.
    #[command(after_help = examples::STRIPES)]
    Stripes(StripesArgs),
}

#[derive(Debug, Args)]
pub(crate) struct PatternOutput {
    /// The picture, a PNG; the description goes beside it with the ending .json. `-` writes the picture alone to stdout.
    #[arg(short, long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckerArgs {
    /// The projector's native resolution.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) projector: [u32; 2],
    /// Columns and rows of squares; their sum must be odd.
    #[arg(long, value_name = "CxR", value_parser = parse_pair, default_value = "11x8", help_heading = SETTINGS)]
    pub(crate) squares: [u32; 2],
    /// Side of a square in projector pixels [default: a sixteenth of the panel's height].
    #[arg(long, value_name = "PX", allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) square: Option<u32>,
    #[command(flatten)]
    pub(crate) to: PatternOutput,
}

#[derive(Debug, Args)]
pub(crate) struct StripesArgs {
    /// The projector's native resolution.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) projector: [u32; 2],
    /// Number of colours.
    #[arg(long, value_name = "N", default_value_t = 4, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) hues: u32,
    /// How many neighbouring stripes tell which they are.
    #[arg(long, value_name = "M", default_value_t = 3, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) order: u32,
    /// Number of stripes [default: 64, or as many as the colours and the order allow].
    #[arg(long, value_name = "K", allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) slits: Option<u32>,
    /// Direction of the stripes: columns (vertical, for a projector beside the camera) or rows (horizontal, for a projector
    /// above or below the camera).
    #[arg(long, value_parser = choice::<Axis>(Axis::NAMES), default_value_t, help_heading = SETTINGS)]
    pub(crate) axis: Axis,
    #[command(flatten)]
    pub(crate) to: PatternOutput,
}
