//! Opens the operator's page.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::io::write_private;

/// Browsers with a kiosk mode, by the names of their programs.
const KIOSKS: [&str; 5] = ["chromium", "chromium-browser", "google-chrome", "chrome", "firefox"];

/// Opens a page in the usual browser.
pub(super) fn open(folder: &Path, address: &str) -> std::io::Result<()> {
    start(opener(), &leading_to(folder, address)?)
}

/// Opens a page that fills the screen, without anything around it; in the usual browser where none can do that.
pub(super) fn open_kiosk(folder: &Path, address: &str) -> std::io::Result<()> {
    let page = leading_to(folder, address)?;
    let kiosk = |name: &&str| {
        let mut command = Command::new(name);
        command.arg("--kiosk");
        start(command, &page).is_ok()
    };
    if KIOSKS.iter().any(kiosk) { Ok(()) } else { start(opener(), &page) }
}

/// A file that leads to an address which holds a secret. Arguments of programs are seen by other users; this file is read by
/// its owner alone.
fn leading_to(folder: &Path, address: &str) -> std::io::Result<PathBuf> {
    let file = folder.join(".slcal-studio.html");
    let page = format!(
        "<!doctype html><meta charset=\"utf-8\"><title>slcal studio</title><script>location.replace({})</script>\n",
        serde_json::Value::from(address)
    );
    write_private(&file, page.as_bytes())?;
    // Not the canonical path: on Windows that begins with `\\?\`, which `start` does not open.
    std::path::absolute(&file)
}

fn start(mut command: Command, page: &Path) -> std::io::Result<()> {
    command.arg(page).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().map(|_| ())
}

#[cfg(target_os = "macos")]
fn opener() -> Command {
    Command::new("open")
}

#[cfg(windows)]
fn opener() -> Command {
    let mut command = Command::new("cmd");
    command.args(["/C", "start", ""]);
    command
}

#[cfg(not(any(target_os = "macos", windows)))]
fn opener() -> Command {
    Command::new("xdg-open")
}
