//! `slcal verify`.

use std::path::PathBuf;

use clap::Args;
use slcal_core::geometry::SheetSize;

use super::headings::{INPUT, MODEL, OUTPUT, SETTINGS};
use super::photo::{GammaArg, MirrorArg};
use crate::args::value::{Corners, parse_corners, parse_sheet_size};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a command line is made of switches")]
pub(crate) struct VerifyArgs {
    /// Photograph of the sheet with the projected pattern; `-` for stdin.
    #[arg(value_name = "PHOTO")]
    pub(crate) photo: PathBuf,
    /// Rig to check.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    /// Checkerboard that was rectified and is projected now.
    ///
    /// `slcal rectify --rig RIG.json --pattern FILE.json` draws the rectified picture.
    #[arg(long, value_name = "FILE.json", help_heading = INPUT)]
    pub(crate) pattern: PathBuf,
    /// The pattern is projected as `slcal pattern` drew it, not rectified. The sheet may then stand anywhere.
    #[arg(long, help_heading = INPUT)]
    pub(crate) as_drawn: bool,
    /// Size of the sheet [default: that of the first view of the rig].
    #[arg(long, value_name = "SIZE", value_parser = parse_sheet_size, allow_hyphen_values = true,
          help_heading = INPUT)]
    pub(crate) size: Option<SheetSize>,
    /// Corners of the sheet by hand as "x,y x,y x,y x,y" (TL TR BR BL), when the sheet is not found.
    #[arg(long, value_name = "CORNERS", value_parser = parse_corners, allow_hyphen_values = true,
          help_heading = INPUT)]
    pub(crate) corners: Option<Corners>,
    #[command(flatten)]
    pub(crate) mirror: MirrorArg,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
    /// False-alarm rate of the tests: the probability that an unmoved rig is reported as moved.
    #[arg(long, value_name = "P", default_value_t = 0.001, allow_hyphen_values = true, help_heading = MODEL)]
    pub(crate) significance: f64,
    /// Exit with code 1 when the rig has moved, or the sheet (unless --as-drawn).
    #[arg(long, help_heading = SETTINGS)]
    pub(crate) fail_if_moved: bool,
    /// Draw on the photograph what was found, and where the rig expects the pattern.
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
