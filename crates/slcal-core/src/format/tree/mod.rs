//! YAML, XML and JSON as one tree of named values, lists and uninterpreted words.

mod expecting;
mod node;
mod xml;
mod yaml;

use crate::error::Result;

pub(super) use expecting::Expecting;
pub(super) use node::Node;

/// The values of a text. The first character distinguishes the three formats.
pub(super) fn parse(text: &str, expecting: Expecting) -> Result<Node> {
    match text.as_bytes().first() {
        None => Err(expecting.malformed("expected YAML, XML or JSON, found nothing")),
        Some(b'<') => xml::parse(text, expecting),
        Some(b'{') => Ok(from_json(&expecting.json(text)?)),
        Some(_) => yaml::parse(text, expecting),
    }
}

/// The tree of a JSON value; the parser bounds its depth.
fn from_json(value: &serde_json::Value) -> Node {
    use serde_json::Value;
    match value {
        Value::Array(items) => Node::List(items.iter().map(from_json).collect()),
        Value::Object(fields) => Node::Map(fields.iter().map(|(n, v)| (n.clone(), from_json(v))).collect()),
        Value::String(text) => Node::Scalar(text.clone()),
        other => Node::Scalar(other.to_string()),
    }
}
