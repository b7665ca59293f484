//! The tree: named values, lists and uninterpreted words.

/// A value of YAML, XML or JSON.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::format) enum Node {
    /// A word or a number, uninterpreted.
    Scalar(String),
    /// Values in order.
    List(Vec<Node>),
    /// Values by name, in the order of the file.
    Map(Vec<(String, Node)>),
}

impl Node {
    /// The first value called `name`.
    pub(in crate::format) fn get(&self, name: &str) -> Option<&Node> {
        match self {
            Self::Map(fields) => fields.iter().find(|(n, _)| n == name).map(|(_, v)| v),
            _ => None,
        }
    }

    /// All words below, in order; of a list of lists those of its rows, of text its parts between spaces and commas.
    pub(in crate::format) fn words(&self) -> Vec<&str> {
        match self {
            Self::Scalar(text) => {
                text.split([' ', ',', '\n', '\t', '\r']).filter(|w| !w.is_empty()).collect()
            }
            Self::List(items) => items.iter().flat_map(Self::words).collect(),
            Self::Map(_) => Vec::new(),
        }
    }
}
