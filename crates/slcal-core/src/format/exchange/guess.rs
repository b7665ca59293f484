//! Recognition of a file's format by its content.

use super::devices::expecting;
use super::files::{ExchangeFormat, NamedBytes};
use crate::error::{ErrorSubject, Result};
use crate::format::recognise::refuse_others;
use crate::format::tree::{Expecting, Node, parse};

const FILE: Expecting = expecting(ErrorSubject::ImportFile);

/// The format of these files.
pub(super) fn format_of(files: &[NamedBytes<'_>]) -> Result<ExchangeFormat> {
    let unknown = || {
        let all = ExchangeFormat::NAMES.join(", ");
        FILE.malformed(format!("its content is that of none of the formats ({all}); say which one it is"))
    };
    if files.iter().any(|f| f.name.eq_ignore_ascii_case("cameras.txt")) {
        return Ok(ExchangeFormat::Colmap);
    }
    let Some(first) = files.first() else { return Err(unknown()) };
    let wanted = ["a rig of another program", "a rig (slcal-", "a zip archive", "YAML", "XML"];
    refuse_others(first.bytes, ErrorSubject::ImportFile, &wanted)?;
    if first.bytes.starts_with(b"PK\x03\x04") {
        return Ok(ExchangeFormat::Npz);
    }
    let text = FILE.text(first.bytes)?;
    if text.contains("import bpy") {
        return Ok(ExchangeFormat::Blender);
    }
    if text.starts_with("%YAML") || text.starts_with(['<', '{']) {
        return Ok(ExchangeFormat::OpenCv);
    }
    let root = parse(text, FILE).map_err(|_| unknown())?;
    if root.get("cam0").is_some() {
        return Ok(ExchangeFormat::Kalibr);
    }
    let has = |name: &str| root.get(name).is_some();
    if files.len() > 1 || has("distortion_model") || has("projection_matrix") || has("rectification_matrix") {
        return Ok(ExchangeFormat::Ros);
    }
    if matches!(root, Node::Map(_)) { Ok(ExchangeFormat::OpenCv) } else { Err(unknown()) }
}
