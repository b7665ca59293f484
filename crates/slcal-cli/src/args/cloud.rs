//! Options of clouds.

use clap::Args;
use slcal_core::Frame;

use super::headings::{OUTPUT, SETTINGS};
use super::value::{choice, parse_length};

/// The coordinates and the extent of clouds.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct CloudArgs {
    /// Coordinate frame: camera (x right, y down, z forward) or plane (the sheet of the first view of the rig).
    #[arg(long, value_parser = choice::<Frame>(Frame::NAMES), default_value_t, help_heading = OUTPUT)]
    pub(crate) frame: Frame,
    /// Write triangles between the points, too.
    ///
    /// .pcd and .xyz have no place for them.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) mesh: bool,
    /// Leave out points nearer than this (300mm, 0.3m), measured along the optical axis of the camera.
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, allow_hyphen_values = true,
          help_heading = SETTINGS)]
    pub(crate) near: Option<f64>,
    /// Leave out points farther than this (2000mm, 2m), measured along the optical axis of the camera.
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, allow_hyphen_values = true,
          help_heading = SETTINGS)]
    pub(crate) far: Option<f64>,
}
