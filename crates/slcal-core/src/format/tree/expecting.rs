//! The kind of text that is read, and its messages.

use crate::error::{Error, ErrorSubject, Result};
use crate::format::budget::{Budget, DEEPEST};
use crate::format::json::json;

/// The expected kind of text.
#[derive(Debug, Clone, Copy)]
pub(in crate::format) struct Expecting(pub(in crate::format) ErrorSubject);

impl Expecting {
    pub(in crate::format) fn malformed(self, detail: impl Into<String>) -> Error {
        Error::malformed(self.0, detail)
    }

    pub(super) fn too_deep(self) -> Error {
        self.malformed(format!("expected at most {DEEPEST} levels of values, found more"))
    }

    /// The text in these bytes, without a byte order mark.
    pub(in crate::format) fn text(self, bytes: &[u8]) -> Result<&str> {
        let text = std::str::from_utf8(bytes)
            .map_err(|_| self.malformed("expected YAML, XML or JSON as UTF-8 text, found other bytes"))?;
        Ok(text.trim_start_matches('\u{feff}').trim_start())
    }

    /// The value of a text of JSON.
    pub(in crate::format) fn json(self, text: &str, budget: &Budget) -> Result<serde_json::Value> {
        json(text.as_bytes(), self.0, budget)
    }
}
