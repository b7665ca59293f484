//! Options of clouds.

use clap::Args;
use slcal_core::Frame;

use super::headings::{OUTPUT, SETTINGS};
use super::value::{choice, parse_length};

/// The coordinates and the extent of clouds.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct CloudArgs {
    /// The frame of the coordinates: camera (x right, y down, z forward) or plane (the sheet of the rig's first view).
    #[arg(long, value_parser = choice::<Frame>(Frame::NAMES), default_value_t, help_heading = OUTPUT)]
    pub(crate) frame: Frame,
    /// Write the triangles between the points, too.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) mesh: bool,
    /// Leave out points nearer than this: distance along the camera's optical axis (300mm, 0.3m).
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) near: Option<f64>,
    /// Leave out points farther than this (2m, 2000mm).
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) far: Option<f64>,
}
