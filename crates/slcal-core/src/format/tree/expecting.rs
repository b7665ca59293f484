//! The kind of text that is read, its limits, and its messages.

use crate::error::{Error, ErrorSubject, Result};

/// Maximum nesting of values; camera files need four levels.
pub(super) const DEEPEST: usize = 32;

/// The expected kind of text, and its maximum size.
#[derive(Debug, Clone, Copy)]
pub(in crate::format) struct Expecting {
    /// The kind of file.
    pub(in crate::format) what: ErrorSubject,
    /// Maximum number of values.
    pub(in crate::format) most_nodes: usize,
}

impl Expecting {
    pub(in crate::format) fn malformed(self, detail: impl Into<String>) -> Error {
        Error::malformed(self.what, detail)
    }

    pub(super) fn too_deep(self) -> Error {
        self.malformed(format!("expected few levels of values, found more than {DEEPEST}"))
    }

    /// The text in these bytes, without a byte order mark.
    pub(in crate::format) fn text(self, bytes: &[u8]) -> Result<&str> {
        let text = std::str::from_utf8(bytes)
            .map_err(|_| self.malformed("expected YAML, XML or JSON as UTF-8 text, found other bytes"))?;
        Ok(text.trim_start_matches('\u{feff}').trim_start())
    }

    /// The value of a text of JSON.
    pub(in crate::format) fn json(self, text: &str) -> Result<serde_json::Value> {
        serde_json::from_str(text).map_err(|e| Error::unparsable(self.what, "JSON", e))
    }
}
