//! What YAML, XML and JSON have in common.

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
pub(super) fn from_json(value: &serde_json::Value) -> Node {
    use serde_json::Value;
    match value {
        Value::Array(items) => Node::List(items.iter().map(from_json).collect()),
        Value::Object(fields) => Node::Map(fields.iter().map(|(n, v)| (n.clone(), from_json(v))).collect()),
        Value::String(text) => Node::Scalar(text.clone()),
        other => Node::Scalar(other.to_string()),
    }
}
