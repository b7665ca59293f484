//! `slcal pattern`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use slcal_core::pattern::Axis;

use super::examples;
use super::headings::{INPUT, OUTPUT, SETTINGS};
use super::value::{choice, parse_pair};

#[derive(Debug, Subcommand)]
pub(crate) enum PatternVerb {
    /// Draw the checkerboard for calibration.
    #[command(after_help = examples::CHECKER)]
    Checker(CheckerArgs),
    /// Draw the coloured stripes for reconstruction.
    #[command(after_help = examples::STRIPES)]
    Stripes(StripesArgs),
}

#[derive(Debug, Args)]
pub(crate) struct PatternOutput {
    /// PNG file for the picture. The description is written beside it, with the ending .json.
    ///
    /// `-` prints the picture alone to stdout.
    #[arg(short, long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckerArgs {
    /// Native resolution of the projector.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) projector: [u32; 2],
    /// Columns and rows of squares; their sum must be odd.
    ///
    /// With an odd sum the pattern differs from itself turned by 180°.
    #[arg(long, value_name = "CxR", value_parser = parse_pair, default_value = "11x8", help_heading = SETTINGS)]
    pub(crate) squares: [u32; 2],
    /// Side of a square in projector pixels [default: a sixteenth of the panel height].
    #[arg(long, value_name = "PX", allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) square: Option<u32>,
    /// Draw small marks at the corners of the panel and at the middles of its sides.
    ///
    /// Where they or the border of the light are seen on the sheet, `slcal calibrate` tests whether the picture was shown full screen,
    /// unscaled and not mirrored.
    #[arg(long, help_heading = SETTINGS)]
    pub(crate) marks: bool,
    #[command(flatten)]
    pub(crate) to: PatternOutput,
}

#[derive(Debug, Args)]
pub(crate) struct StripesArgs {
    /// Native resolution of the projector.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) projector: [u32; 2],
    /// Number of colours, from 2 to 12.
    #[arg(long, value_name = "N", default_value_t = 4, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) hues: u32,
    /// Length of the window: any ORDER neighbouring stripes identify their place.
    #[arg(long, value_name = "M", default_value_t = 3, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) order: u32,
    /// Number of stripes [default: 64, or as many as --hues and --order allow].
    #[arg(long, value_name = "K", allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) slits: Option<u32>,
    /// Direction of the stripes: columns (vertical) or rows (horizontal).
    ///
    /// Use columns for a projector beside the camera, and rows for a projector above or below the camera.
    #[arg(long, value_parser = choice::<Axis>(Axis::NAMES), default_value_t, help_heading = SETTINGS)]
    pub(crate) axis: Axis,
    #[command(flatten)]
    pub(crate) to: PatternOutput,
}
