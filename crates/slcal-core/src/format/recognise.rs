//! Recognition of file kinds by their first bytes, for messages about the wrong file.

use std::io::Read;

use super::budget::Budget;
use super::json::json;
use crate::error::{Error, ErrorSubject, Result};

/// First bytes of files, and their kind.
const BEGINNINGS: [(&[u8], &str); 17] = [
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"II*\0", "a TIFF picture"),
    (b"MM\0*", "a TIFF picture"),
    (b"GIF8", "a GIF picture"),
    (b"%PDF", "a PDF document"),
    (b"glTF", "a GLB"),
    (b"ply\n", "a PLY"),
    (b"ply\r", "a PLY"),
    (b"# .PCD", "a PCD"),
    (b"PK\x03\x04", "a zip archive, as npz files are"),
    (b"\x93NUMPY", "an array of NumPy"),
    (b"<!doctype html", "an HTML page"),
    (b"<html", "an HTML page"),
    (b"<?xml", "XML text"),
    (b"%yaml", "YAML text"),
    (b"u,v,", "a file of matches (CSV)"),
];
/// Names of the schemas of this library's JSON files, and their content.
const SCHEMAS: [(&str, &str); 3] = [
    ("slcal-rig/", "a rig"),
    ("slcal-pattern/", "a pattern"),
    ("slcal-observations/", "a file of observations"),
];
/// The number of bytes that are searched for the schema, which is one of the first fields.
const SEARCHED_BYTES: usize = 1 << 14;

/// The kind of a file by its first bytes: "a pattern (slcal-pattern/1)", "a PNG picture", "YAML text".
/// `None` where the kind is not certain.
///
/// ```
/// use slcal_core::format::recognise;
///
/// assert_eq!(recognise(br#"{ "schema": "slcal-rig/1" }"#).unwrap(), "a rig (slcal-rig/1)");
/// assert_eq!(recognise(b"glTF\x02\0\0\0").unwrap(), "a GLB");
/// assert!(recognise(b"1 2 3").is_none());
/// ```
#[must_use]
pub fn recognise(bytes: &[u8]) -> Option<String> {
    let bytes = bytes[..bytes.len().min(SEARCHED_BYTES)].trim_ascii_start();
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let begins = |with: &[u8]| bytes.get(..with.len()).is_some_and(|b| b.eq_ignore_ascii_case(with));
    if let Some((_, kind)) = BEGINNINGS.iter().find(|(beginning, _)| begins(beginning)) {
        return Some((*kind).to_owned());
    }
    let text = String::from_utf8_lossy(bytes);
    if text.starts_with('{') {
        let (_, after) = text.split_once("\"schema\"")?;
        let value = after.trim_start().strip_prefix(':')?.trim_start().strip_prefix('"')?;
        let schema = value.split('"').next().filter(|name| name.len() < 40)?;
        let kind = SCHEMAS.iter().find(|(name, _)| schema.starts_with(name)).map(|(_, kind)| *kind);
        return kind
            .or(schema.starts_with("slcal-").then_some("a record"))
            .map(|kind| format!("{kind} ({schema})"));
    }
    let (key, value) = text.lines().next()?.split_once(':')?;
    let word = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    (word && (value.is_empty() || value.starts_with(' '))).then(|| "YAML text".to_owned())
}

/// Refuses a file of another kind than those `wanted`. The first of these names the expected kind.
pub(super) fn refuse_others(bytes: &[u8], what: ErrorSubject, wanted: &[&str]) -> Result<()> {
    match (recognise(bytes), wanted) {
        (Some(found), [first, ..]) if !wanted.iter().any(|kind| found.starts_with(kind)) => {
            Err(Error::malformed(what, format!("this is {found}, where {first} is expected")))
        }
        _ => Ok(()),
    }
}

/// The values of one of this library's own JSON files.
///
/// # Errors
/// [`Error::Malformed`] when the text is not JSON, or a file of another kind; [`Error::Io`] when the stream fails.
pub(super) fn read_json(mut input: impl Read, what: ErrorSubject, wanted: &str) -> Result<serde_json::Value> {
    let mut text = Vec::new();
    input.read_to_end(&mut text).map_err(|e| Error::reading(what, e))?;
    refuse_others(&text, what, &[wanted])?;
    json(&text, what, &Budget::new(what, text.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{
        read_camera, read_matches, read_obj, read_observations, read_pattern, read_ply, read_rig,
    };

    #[test]
    fn every_reader_says_what_a_file_of_another_kind_is() {
        let says = |error: Error, kind: &str, wanted: &str| {
            let text = error.to_string();
            assert!(text.ends_with(&format!("this is {kind}, where {wanted} is expected")), "{text}");
            assert!(matches!(error, Error::Malformed { .. }));
        };
        let rig = br#"{"units": "mm", "schema": "slcal-rig/1"}"#.as_slice();
        let pattern = br#"{ "schema" : "slcal-pattern/1" }"#.as_slice();
        says(read_rig(pattern).unwrap_err(), "a pattern (slcal-pattern/1)", "a rig");
        says(read_rig(&b"\xef\xbb\xbfimage_width: 640\n"[..]).unwrap_err(), "YAML text", "a rig");
        says(read_pattern(&b"\x89PNG\r\n\x1a\n"[..]).unwrap_err(), "a PNG picture", "a pattern");
        says(read_observations(rig).unwrap_err(), "a rig (slcal-rig/1)", "a file of observations");
        says(read_camera(pattern).unwrap_err(), "a pattern (slcal-pattern/1)", "a camera");
        says(read_ply(&b"glTF\x02\0\0\0"[..]).unwrap_err(), "a GLB", "a PLY");
        says(read_obj(&b"ply\nformat ascii 1.0\n"[..]).unwrap_err(), "a PLY", "an OBJ");
        let report = b"\n<!DOCTYPE html><title>slcal</title>".as_slice();
        says(read_matches(report).unwrap_err(), "an HTML page", "a file of matches");
        let record = br#"{"decoded": 4, "schema": "slcal-decode/1"}"#.as_slice();
        says(read_matches(record).unwrap_err(), "a record (slcal-decode/1)", "a file of matches");
    }
}
