//! What YAML, XML and JSON have in common: named values, lists of values, and words that are not interpreted yet.

mod xml;
mod yaml;

use crate::error::{Error, ErrorSubject, Result};

/// How deep values may lie in each other; files of cameras need four levels.
const DEEPEST: usize = 32;

/// What kind of text is read, and how much of it there may be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Expecting {
    /// The kind of file.
    pub(super) what: ErrorSubject,
    /// The most values that such a text has.
    pub(super) most_nodes: usize,
}

impl Expecting {
    pub(super) fn malformed(self, detail: impl Into<String>) -> Error {
        Error::malformed(self.what, detail)
    }

    fn too_deep(self) -> Error {
        self.malformed(format!("expected few levels of values, found more than {DEEPEST}"))
    }

    /// The text in these bytes, without the mark that some editors put before it.
    pub(super) fn text(self, bytes: &[u8]) -> Result<&str> {
        let text = std::str::from_utf8(bytes)
            .map_err(|_| self.malformed("expected YAML, XML or JSON as UTF-8 text, found other bytes"))?;
        Ok(text.trim_start_matches('\u{feff}').trim_start())
    }

    /// The values of a text; which of the three it is follows from its first letter.
    pub(super) fn parse(self, text: &str) -> Result<Node> {
        match text.as_bytes().first() {
            None => Err(self.malformed("expected YAML, XML or JSON, found nothing")),
            Some(b'<') => xml::parse(text, self),
            Some(b'{') => Ok(from_json(&self.json(text)?)),
            Some(_) => yaml::parse(text, self),
        }
    }

    /// The value of a text of JSON.
    pub(super) fn json(self, text: &str) -> Result<serde_json::Value> {
        serde_json::from_str(text).map_err(|e| Error::unparsable(self.what, "JSON", e))
    }
}

/// A value of any of the three.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    /// A word or a number, not interpreted yet.
    Scalar(String),
    /// Values in order.
    List(Vec<Node>),
    /// Values by name, in the order of the file.
    Map(Vec<(String, Node)>),
}

impl Node {
    /// The first value called `name`.
    pub(super) fn get(&self, name: &str) -> Option<&Node> {
        match self {
            Self::Map(fields) => fields.iter().find(|(n, _)| n == name).map(|(_, v)| v),
            _ => None,
        }
    }

    /// All words below, in order; of a list of lists those of its rows, of text its parts between spaces and commas.
    pub(super) fn words(&self) -> Vec<&str> {
        match self {
            Self::Scalar(text) => {
                text.split([' ', ',', '\n', '\t', '\r']).filter(|w| !w.is_empty()).collect()
            }
            Self::List(items) => items.iter().flat_map(Self::words).collect(),
            Self::Map(_) => Vec::new(),
        }
    }
}

/// JSON as it is; its parser bounds the depth.
fn from_json(value: &serde_json::Value) -> Node {
    use serde_json::Value;
    match value {
        Value::Array(items) => Node::List(items.iter().map(from_json).collect()),
        Value::Object(fields) => Node::Map(fields.iter().map(|(n, v)| (n.clone(), from_json(v))).collect()),
        Value::String(text) => Node::Scalar(text.clone()),
        other => Node::Scalar(other.to_string()),
    }
}
