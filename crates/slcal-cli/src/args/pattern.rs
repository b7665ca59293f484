//! `slcal pattern`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use slcal_core::pattern::{Axis, SequenceAxes, SequencePreset};

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
    /// Draw a sequence of Gray code, to be photographed picture by picture.
    #[command(after_help = examples::GRAY)]
    Gray(GrayArgs),
    /// Draw a sequence of Gray code and shifted sinusoids, to be photographed picture by picture.
    #[command(after_help = examples::PHASE)]
    Phase(PhaseArgs),
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

#[derive(Debug, Args)]
pub(crate) struct GrayArgs {
    #[command(flatten)]
    pub(crate) of: SequenceArgs,
    /// Draw the pictures of another program, in its order, instead.
    ///
    /// opencv-gray: those of GrayCodePattern of OpenCV: the bits of the columns, the most significant first, each followed by its
    /// inverse, then those of the rows, white, black. slstudio-gray: those of SLStudio: white, black, the bits of the columns, the most
    /// significant first, without inverses.
    #[arg(long, value_parser = choice::<SequencePreset>(SequencePreset::NAMES), conflicts_with = "axis",
          help_heading = SETTINGS)]
    pub(crate) preset: Option<SequencePreset>,
    #[command(flatten)]
    pub(crate) to: SequenceOutput,
}

#[derive(Debug, Args)]
pub(crate) struct PhaseArgs {
    #[command(flatten)]
    pub(crate) of: SequenceArgs,
    /// Period of the sinusoid in projector pixels, 4 or more.
    ///
    /// A shorter period is more precise, as long as projector and camera show it with contrast.
    #[arg(long, value_name = "PX", default_value_t = 16.0, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) period: f64,
    /// Number of shifts of the sinusoid within its period, from 3 to 64; from 5 on an unknown gamma does not matter.
    #[arg(long, value_name = "N", default_value_t = 8, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) steps: u32,
    #[command(flatten)]
    pub(crate) to: SequenceOutput,
}

/// What all sequences have.
#[derive(Debug, Args)]
pub(crate) struct SequenceArgs {
    /// Native resolution of the projector.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) projector: [u32; 2],
    /// What is coded: columns, rows, or both.
    ///
    /// Use columns for a projector beside the camera, rows for a projector above or below the camera, and both for calibration.
    #[arg(long, value_parser = choice::<SequenceAxes>(SequenceAxes::NAMES), default_value_t, help_heading = SETTINGS)]
    pub(crate) axis: SequenceAxes,
    /// Number of bits of the Gray code, the most significant ones [default: all, with a sinusoid one more
    /// than tell its periods apart].
    #[arg(long, value_name = "N", allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) bits: Option<u32>,
}

#[derive(Debug, Args)]
pub(crate) struct SequenceOutput {
    /// Write the description alone, for pictures that another program shows.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) no_frames: bool,
    /// Folder for frame_000.png, frame_001.png, ... and sequence.json; created when it does not exist.
    #[arg(long, value_name = "DIR", help_heading = OUTPUT)]
    pub(crate) out_dir: PathBuf,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
