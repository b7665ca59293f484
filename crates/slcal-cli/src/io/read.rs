//! The bytes of inputs: files and stdin, up to a limit.

use std::fs;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};

use super::input_kind::{InputKind, read_input};
use crate::exit::{Failure, Outcome};
use crate::name::is_dash;
use crate::similar::nearest;

/// Refuses a command line with several inputs from stdin.
pub(crate) fn check_one_stdin<'a>(inputs: impl IntoIterator<Item = &'a PathBuf>) -> Outcome {
    match inputs.into_iter().filter(|p| is_dash(p)).count() {
        0 | 1 => Ok(()),
        _ => Err(Failure::usage("only one input can come from stdin (-); give the others as files")),
    }
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

/// The bytes of an input file, or of stdin for `-`.
pub(crate) fn read_bytes(path: &Path, kind: InputKind) -> Outcome<Vec<u8>> {
    let bytes = if is_dash(path) { kind.read(std::io::stdin().lock()) } else { read_input(path, kind) };
    let bytes = bytes.map_err(|e| unreadable(path, kind, &e))?;
    if bytes.is_empty() { Err(nothing(path, kind)) } else { Ok(bytes) }
}

/// An input file, or stdin for `-`, to be read piece by piece: what is kept of it may be much smaller.
pub(crate) fn open_stream(path: &Path, kind: InputKind) -> Outcome<impl BufRead> {
    let source: Box<dyn Read> = if is_dash(path) {
        Box::new(std::io::stdin().lock())
    } else {
        Box::new(kind.open(path).map_err(|e| unreadable(path, kind, &e))?)
    };
    let mut stream = BufReader::new(kind.limited(source, 0));
    let is_empty = stream.fill_buf().map_err(|e| unreadable(path, kind, &e))?.is_empty();
    if is_empty { Err(nothing(path, kind)) } else { Ok(stream) }
}

fn unreadable(path: &Path, kind: InputKind, error: &std::io::Error) -> Failure {
    let name = kind.name();
    let advice = match error.kind() {
        ErrorKind::NotFound => missing(path),
        ErrorKind::PermissionDenied => "no permission to read it".to_owned(),
        ErrorKind::IsADirectory => "it is a folder; give a file".to_owned(),
        ErrorKind::FileTooLarge => {
            let most = kind.most_mib();
            let message =
                format!("expected {name} of at most {most} MiB, found a larger file; is it the right one?");
            return Failure::input(path, message);
        }
        _ => error.to_string(),
    };
    Failure::input(path, format!("expected {name}: {advice}"))
}

fn nothing(path: &Path, kind: InputKind) -> Failure {
    let found = if is_dash(path) { "no data; use - for one input only" } else { "an empty file" };
    Failure::input(path, format!("expected {}, found {found}", kind.name()))
}
