//! The rendered scenes beside the repository, for tests; `SLCAL_SHARED` names another place.

use std::io::Write;
use std::path::{Path, PathBuf};

/// A file or folder of the scenes. Where it is not at hand a line on the terminal says that the test was skipped.
pub(crate) fn rendered_scenes(path: &str) -> Option<PathBuf> {
    shared_data(&format!("rendered/{path}"))
}

/// The same of all data beside the repository.
pub(crate) fn shared_data(path: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let shared = std::env::var_os("SLCAL_SHARED").map_or_else(beside, PathBuf::from);
    let path = shared.join("data").join(path);
    if path.exists() {
        return Some(path);
    }
    // Not by `eprintln!`, which the test runner captures.
    let test = std::thread::current().name().unwrap_or("a test").to_owned();
    let _ = writeln!(std::io::stderr(), "skipped: {test} needs {}", path.display());
    None
}
