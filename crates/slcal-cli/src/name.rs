//! The names of files, and how they stand in messages.

use std::path::Path;

/// Where the studio notes down the commands that do what it did, one per line.
pub(crate) const STUDIO_COMMANDS: &str = "commands.txt";

/// Whether a path stands for stdin or stdout.
pub(crate) fn is_dash(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Whether a file has one of these extensions, in capitals or not.
pub(crate) fn has_extension(name: &Path, extensions: &[&str]) -> bool {
    name.extension().is_some_and(|found| extensions.iter().any(|e| found.eq_ignore_ascii_case(e)))
}

/// The name of an input in messages.
pub(crate) fn input_name(path: &Path) -> String {
    if is_dash(path) { "stdin".to_owned() } else { path.display().to_string() }
}

/// The name of a file without its folders, which would fill the headline.
pub(crate) fn short(name: &str) -> &str {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    if last.is_empty() { name } else { last }
}

/// The name under which a photograph stands among others: with its folders where it takes them to tell.
pub(crate) fn name_among<'a>(names: &[&'a str], i: usize) -> &'a str {
    let Some(&name) = names.get(i) else { return "photograph" };
    let unique = names.iter().enumerate().all(|(j, other)| j == i || short(other) != short(name));
    if unique { short(name) } else { name }
}
