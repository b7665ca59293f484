//! Whether matches can have been made by the rig: light that does not come from the panel, and light that would fall on
//! two surfaces.

mod border;
mod checker;
mod findings;
mod panel_position;
mod scanline_runs;
mod shown_scale;
mod slit_ends;

pub(crate) use checker::RigChecker;
public_with! { "report": pub use findings::{RigCheckReport, SlitCount}; }
