//! Recognition of a file's format by its content.

use super::files::{ExchangeFormat, NamedBytes};
use crate::error::{ErrorSubject, Result};
use crate::format::budget::Budget;
use crate::format::recognise::refuse_others;
use crate::format::tree::{Expecting, Node, parse};

const FILE: Expecting = Expecting(ErrorSubject::ImportFile);

/// A file as its reader gets it: its tree, where that was needed to recognise it, or its bytes.
pub(super) enum Source<'a> {
    Bytes(&'a [u8]),
    Tree(Node<'a>),
}

impl<'a> Source<'a> {
    /// The values of a text.
    pub(super) fn tree(self, expecting: Expecting, budget: &Budget) -> Result<Node<'a>> {
        match self {
            Self::Tree(root) => Ok(root),
            Self::Bytes(bytes) => parse(expecting.text(bytes)?, expecting, budget),
        }
    }
}

/// The format of these files, and the tree of the first one where it was read.
pub(super) fn format_of<'a>(
    files: &[NamedBytes<'a>],
    budget: &Budget,
) -> Result<(ExchangeFormat, Option<Node<'a>>)> {
    let unknown = || {
        let all = ExchangeFormat::NAMES.join(", ");
        FILE.malformed(format!("its content is that of none of the formats ({all}); say which one it is"))
    };
    if files.iter().any(|f| f.name.eq_ignore_ascii_case("cameras.txt")) {
        return Ok((ExchangeFormat::Colmap, None));
    }
    let Some(first) = files.first() else { return Err(unknown()) };
    let wanted = ["a rig of another program", "a rig (slcal-", "a zip archive", "YAML", "XML"];
    refuse_others(first.bytes, ErrorSubject::ImportFile, &wanted)?;
    if first.bytes.starts_with(b"PK\x03\x04") {
        return Ok((ExchangeFormat::Npz, None));
    }
    let text = FILE.text(first.bytes)?;
    if text.contains("import bpy") {
        return Ok((ExchangeFormat::Blender, None));
    }
    if text.starts_with("%YAML") || text.starts_with(['<', '{']) {
        return Ok((ExchangeFormat::OpenCv, None));
    }
    let root = parse(text, FILE, budget).map_err(|e| if budget.left() == 0 { e } else { unknown() })?;
    let has = |name: &str| root.get(name).is_some();
    let format = if has("cam0") {
        ExchangeFormat::Kalibr
    } else if files.len() > 1
        || has("distortion_model")
        || has("projection_matrix")
        || has("rectification_matrix")
    {
        ExchangeFormat::Ros
    } else if matches!(root, Node::Map(_)) {
        ExchangeFormat::OpenCv
    } else {
        return Err(unknown());
    };
    Ok((format, Some(root)))
}
