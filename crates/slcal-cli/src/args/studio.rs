//! `slcal studio`.

use std::path::PathBuf;

use clap::Args;
use slcal_core::SheetSize;

use super::headings::{INPUT, OUTPUT, SETTINGS};
use super::value::parse_pair;

#[derive(Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "options of a command line")]
pub(crate) struct StudioArgs {
    /// Folder for photographs, patterns, rig and clouds; created when it does not exist [default: slcal-studio, with --demo
    /// slcal-studio-demo].
    ///
    /// Everything is kept there as it is made. Starting again in the same folder continues where the work stopped.
    #[arg(long, value_name = "DIR", help_heading = OUTPUT)]
    pub(crate) dir: Option<PathBuf>,
    /// Native resolution of the projector; it can be set in the window, too.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) projector: Option<[u32; 2]>,
    /// Size of the sheet (A4, 594x420mm); it can be set in the window, too.
    #[arg(long, value_name = "SIZE", help_heading = INPUT)]
    pub(crate) size: Option<SheetSize>,
    /// Folder into which a camera writes its photographs; new ones are taken from there.
    #[arg(long, value_name = "DIR", help_heading = INPUT)]
    pub(crate) watch: Option<PathBuf>,
    /// Use a simulated projector, camera and sheet; no hardware is needed.
    #[arg(long, help_heading = INPUT)]
    pub(crate) demo: bool,
    /// Let phones and other computers of the network take part.
    ///
    /// The connection is not encrypted: anyone on that network can read along.
    #[arg(long, help_heading = SETTINGS)]
    pub(crate) lan: bool,
    /// Print the addresses as JSON.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Port of the server [default: 8642, or the next one that is free].
    #[arg(long, value_name = "N", help_heading = SETTINGS)]
    pub(crate) port: Option<u16>,
    /// Open the display page alone, in kiosk mode where the browser has one: for a machine at the projector.
    ///
    /// Operate from another machine, with --lan.
    #[arg(long, conflicts_with = "no_open", help_heading = SETTINGS)]
    pub(crate) display_only: bool,
    /// Print the addresses only; do not open a browser.
    #[arg(long, help_heading = SETTINGS)]
    pub(crate) no_open: bool,
}

impl StudioArgs {
    /// The folder of the project.
    pub(crate) fn folder(&self) -> PathBuf {
        let usual = if self.demo { "slcal-studio-demo" } else { "slcal-studio" };
        self.dir.clone().unwrap_or_else(|| usual.into())
    }
}
