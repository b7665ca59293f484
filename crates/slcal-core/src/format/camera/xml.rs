//! XML as OpenCV writes it.

use roxmltree::{Document, ParsingOptions};

use super::malformed;
use super::tree::Node;
use crate::error::Result;

const MOST_NODES: u32 = 10_000;
const DEEPEST: usize = 32;

/// What stands in `<opencv_storage>`. A document type is refused: entities can make a small text gigantic.
pub(super) fn parse(text: &str) -> Result<Node> {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|e| malformed(format!("this is not XML: {e}")))?;
    let root = document.root_element();
    if root.tag_name().name() != "opencv_storage" {
        return Err(malformed(format!(
            "expected XML of OpenCV's FileStorage (<opencv_storage>), found <{}>",
            root.tag_name().name()
        )));
    }
    node(root, 0)
}

fn node(element: roxmltree::Node<'_, '_>, depth: usize) -> Result<Node> {
    if depth > DEEPEST {
        return Err(malformed(format!("expected few levels of values, found more than {DEEPEST}")));
    }
    let children: Vec<_> = element.children().filter(roxmltree::Node::is_element).collect();
    if children.is_empty() {
        return Ok(Node::Scalar(element.text().unwrap_or_default().trim().trim_matches('"').to_owned()));
    }
    let fields = children.into_iter().map(|c| Ok((c.tag_name().name().to_owned(), node(c, depth + 1)?)));
    Ok(Node::Map(fields.collect::<Result<_>>()?))
}
