//! What clouds are to be.

use clap::{Args, ValueEnum};

/// What the clouds are to be.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct CloudArgs {
    /// Whose coordinates the cloud has.
    #[arg(long, value_enum, default_value = "camera")]
    pub(crate) frame: FrameArg,
    /// Write the triangles between the points too.
    #[arg(long)]
    pub(crate) mesh: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FrameArg {
    /// The camera's: x right, y down, z forward.
    Camera,
    /// The sheet of the rig's first view.
    Plane,
}

/// Which triangles are removed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum CullArg {
    /// Those far larger than their neighbourhood's.
    Auto,
    /// None.
    Off,
    /// Those above an area, mm².
    Area(f64),
}

pub(super) fn parse_cull(text: &str) -> Result<CullArg, String> {
    match text {
        "auto" => Ok(CullArg::Auto),
        "off" => Ok(CullArg::Off),
        number => match number.parse::<f64>() {
            Ok(area) if area.is_finite() && area > 0.0 => Ok(CullArg::Area(area)),
            _ => Err("expected auto, off or an area in mm² above zero".to_owned()),
        },
    }
}
