//! XML as OpenCV writes it.

use roxmltree::{Document, ParsingOptions};

use super::expecting::{DEEPEST, Expecting};
use super::node::Node;
use crate::error::Result;

/// The name of a value in a list.
const ITEM: &str = "_";

/// What stands in `<opencv_storage>`. A document type is refused: entities can make a small text gigantic.
pub(super) fn parse(text: &str, expecting: Expecting) -> Result<Node> {
    let nodes_limit = u32::try_from(expecting.most_nodes).unwrap_or(u32::MAX);
    let options = ParsingOptions { nodes_limit, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|e| expecting.malformed(format!("this is not XML: {e}")))?;
    let root = document.root_element();
    if root.tag_name().name() != "opencv_storage" {
        return Err(expecting.malformed(format!(
            "expected XML of OpenCV's FileStorage (<opencv_storage>), found <{}>",
            root.tag_name().name()
        )));
    }
    node(root, 0, expecting)
}

fn node(element: roxmltree::Node<'_, '_>, depth: usize, expecting: Expecting) -> Result<Node> {
    if depth > DEEPEST {
        return Err(expecting.too_deep());
    }
    let children: Vec<_> = element.children().filter(roxmltree::Node::is_element).collect();
    if children.is_empty() {
        let text = element.text().unwrap_or_default().trim();
        let quoted = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
        return Ok(Node::Scalar(quoted.unwrap_or(text).to_owned()));
    }
    let inner = |c: roxmltree::Node<'_, '_>| node(c, depth + 1, expecting);
    if children.iter().all(|c| c.tag_name().name() == ITEM) {
        return Ok(Node::List(children.into_iter().map(inner).collect::<Result<_>>()?));
    }
    let fields = children.into_iter().map(|c| Ok((c.tag_name().name().to_owned(), inner(c)?)));
    Ok(Node::Map(fields.collect::<Result<_>>()?))
}
