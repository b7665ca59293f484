//! The bytes of inputs: files and stdin, up to a limit.

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use crate::exit::{Failure, Outcome};
use crate::name::is_dash;
use crate::similar::nearest;

/// Limit of the size of inputs: above the largest accepted photographs, even uncompressed.
const MAX_INPUT_MIB: u64 = 2048;

/// Refuses a command line with several inputs from stdin.
pub(crate) fn check_one_stdin<'a>(inputs: impl IntoIterator<Item = &'a PathBuf>) -> Outcome {
    match inputs.into_iter().filter(|p| is_dash(p)).count() {
        0 | 1 => Ok(()),
        _ => Err(Failure::usage("only one input can come from stdin (-); give the others as files")),
    }
}

/// The bytes of an input file, or of stdin for `-`. `kind` is the expected kind of file ("a photograph").
pub(crate) fn read_bytes(path: &Path, kind: &str) -> Outcome<Vec<u8>> {
    read_at_most(path, kind, MAX_INPUT_MIB)
}

/// Limit of the names in a folder that are compared with a missing one.
const MOST_NAMES: usize = 10_000;

/// The message on a missing file, with the nearest name in its folder.
fn missing(path: &Path) -> String {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
    let Ok(entries) = fs::read_dir(folder.unwrap_or(Path::new("."))) else {
        return "no such file, and no such folder; check the name".to_owned();
    };
    let names = entries.take(MOST_NAMES).filter_map(|e| e.ok()?.file_name().into_string().ok());
    let word = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    match nearest(&word, names) {
        Some(name) => {
            let meant = folder.map_or_else(|| name.clone().into(), |f| f.join(&name));
            format!("no such file; did you mean {}?", meant.display())
        }
        None => "no such file; check the name".to_owned(),
    }
}

/// The same with another limit, MiB.
pub(crate) fn read_at_most(path: &Path, kind: &str, limit_mib: u64) -> Outcome<Vec<u8>> {
    let unreadable = |e: &std::io::Error| {
        let advice = match e.kind() {
            std::io::ErrorKind::NotFound => missing(path),
            std::io::ErrorKind::PermissionDenied => "no permission to read it".to_owned(),
            std::io::ErrorKind::IsADirectory => "it is a folder; give a file".to_owned(),
            _ => e.to_string(),
        };
        Failure::input(path, format!("expected {kind}: {advice}"))
    };
    let mut bytes = Vec::new();
    let limit = (limit_mib << 20) + 1;
    if is_dash(path) {
        std::io::stdin().lock().take(limit).read_to_end(&mut bytes).map_err(|e| unreadable(&e))?;
    } else {
        let file = fs::File::open(path).map_err(|e| unreadable(&e))?;
        file.take(limit).read_to_end(&mut bytes).map_err(|e| unreadable(&e))?;
    }
    if bytes.len() as u64 >= limit {
        let expected = format!("expected {kind} of at most {limit_mib} MiB");
        return Err(Failure::input(path, format!("{expected}, found a larger file; is it the right one?")));
    }
    if bytes.is_empty() {
        let found = if is_dash(path) { "no data; use - for one input only" } else { "an empty file" };
        return Err(Failure::input(path, format!("expected {kind}, found {found}")));
    }
    Ok(bytes)
}
