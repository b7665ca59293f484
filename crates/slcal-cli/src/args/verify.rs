//! `slcal verify`.

use std::path::PathBuf;

use clap::Args;
use slcal_core::geometry::RectangleSize;

use super::headings::{INPUT, MODEL, OUTPUT, SETTINGS};
use super::photo::GammaArg;
use crate::args::value::{Corners, parse_corners, parse_size};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a command line is made of switches")]
pub(crate) struct VerifyArgs {
    /// A photograph of the sheet with the pattern on it; `-` for stdin.
    #[arg(value_name = "PHOTO")]
    pub(crate) photo: PathBuf,
    /// The rig to check.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    /// The checkerboard that was rectified (`slcal rectify --rig RIG.json --pattern FILE.json`) and is projected now.
    #[arg(long, value_name = "FILE.json", help_heading = INPUT)]
    pub(crate) pattern: PathBuf,
    /// The pattern is projected as `slcal pattern` drew it, not rectified; the sheet may then stand anywhere.
    #[arg(long, help_heading = INPUT)]
    pub(crate) as_drawn: bool,
    /// Size of the sheet, when it is not that of the rig's first view.
    #[arg(long, value_name = "SIZE", value_parser = parse_size, allow_hyphen_values = true, help_heading = INPUT)]
    pub(crate) size: Option<RectangleSize>,
    /// The sheet's corners "x,y x,y x,y x,y" (TL TR BR BL) by hand, when it is not found.
    #[arg(long, value_name = "CORNERS", value_parser = parse_corners, allow_hyphen_values = true, help_heading = INPUT)]
    pub(crate) corners: Option<Corners>,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
    /// How often an unmoved rig may be called moved.
    #[arg(long, value_name = "P", default_value_t = 0.001, allow_hyphen_values = true, help_heading = MODEL)]
    pub(crate) significance: f64,
    /// Exit with code 1 when the rig has moved, or the sheet (unless --as-drawn).
    #[arg(long, help_heading = SETTINGS)]
    pub(crate) fail_if_moved: bool,
    /// Draw what was found, and where the rig expects the pattern, on the photograph.
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
