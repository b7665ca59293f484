//! Opens the operator's page.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::io::write_private;

/// Opens a page whose address holds a secret. Arguments of programs are seen by other users, so that the browser gets a
/// file that only this user can read, which leads to the address.
pub(super) fn open(folder: &Path, address: &str) -> std::io::Result<()> {
    let file = folder.join(".slcal-studio.html");
    let page = format!(
        "<!doctype html><meta charset=\"utf-8\"><title>slcal studio</title><script>location.replace({})</script>\n",
        serde_json::Value::from(address)
    );
    write_private(&file, page.as_bytes())?;
    let file = std::fs::canonicalize(&file)?;
    let mut command = opener();
    command.arg(file).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
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
