//! XML as OpenCV writes it.

use roxmltree::{Document, ParsingOptions};

use super::expecting::Expecting;
use super::node::{Field, Node};
use crate::error::Result;
use crate::format::budget::{Budget, DEEPEST};

/// The name of a value in a list.
const ITEM: &str = "_";
/// Attributes of an element; OpenCV writes one. The parser compares each with all others of its element.
const MOST_ATTRIBUTES: usize = 16;
/// Memory of the parser for an element or a text, bytes.
const NODE_MEMORY: usize = 100;

/// What stands in `<opencv_storage>`. A document type is refused: entities can make a small text gigantic.
pub(super) fn parse<'a>(text: &'a str, expecting: Expecting, budget: &Budget) -> Result<Node<'a>> {
    check_tags(text, expecting)?;
    let nodes_limit = u32::try_from(budget.left() / NODE_MEMORY as u64).unwrap_or(u32::MAX);
    let options = ParsingOptions { nodes_limit, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| match e {
        roxmltree::Error::NodesLimitReached => budget.spent(),
        e => expecting.malformed(format!("this is not XML: {e}")),
    })?;
    budget.keep(document.descendants().count().saturating_mul(NODE_MEMORY))?;
    let root = document.root_element();
    if root.tag_name().name() != "opencv_storage" {
        return Err(expecting.malformed(format!(
            "expected XML of OpenCV's FileStorage (<opencv_storage>), found <{}>",
            root.tag_name().name()
        )));
    }
    node(root, 0, expecting, budget)
}

/// Refuses what takes the parser more time than the text is long: many attributes of an element, and namespaces, which every
/// element copies from the one around it.
fn check_tags(text: &str, expecting: Expecting) -> Result<()> {
    let mut rest = text;
    while let Some((_, after)) = rest.split_once('<') {
        let skipped = [("!--", "-->"), ("![CDATA[", "]]>"), ("?", "?>")]
            .into_iter()
            .find_map(|(open, close)| Some(after.strip_prefix(open)?.split_once(close)));
        rest = match skipped {
            Some(Some((_, behind))) => behind,
            // The parser says what is wrong.
            Some(None) => return Ok(()),
            None => behind_tag(after, expecting)?,
        };
    }
    Ok(())
}

/// What stands behind a tag, of which `<` is read.
fn behind_tag(tag: &str, expecting: Expecting) -> Result<&str> {
    let mut attributes = 0;
    let mut rest = tag;
    while let Some(at) = rest.find(['>', '=', '"', '\'']) {
        let (before, found) = rest.split_at(at);
        if before.contains("xmlns") {
            return Err(
                expecting.malformed("expected XML without namespaces, as OpenCV writes it, found xmlns")
            );
        }
        let mut characters = found.chars();
        let mark = characters.next();
        rest = characters.as_str();
        match mark {
            Some('>') => break,
            Some('=') => attributes += 1,
            Some(quote) => rest = rest.split_once(quote).map_or("", |(_, behind)| behind),
            None => {}
        }
        if attributes > MOST_ATTRIBUTES {
            return Err(expecting.malformed(format!(
                "expected elements with at most {MOST_ATTRIBUTES} attributes, as OpenCV writes them, found more"
            )));
        }
    }
    Ok(rest)
}

fn node<'a>(
    element: roxmltree::Node<'_, 'a>,
    depth: usize,
    expecting: Expecting,
    budget: &Budget,
) -> Result<Node<'a>> {
    if depth > DEEPEST {
        return Err(expecting.too_deep());
    }
    let children = || element.children().filter(roxmltree::Node::is_element);
    if children().next().is_none() {
        let text = element.text().unwrap_or_default().trim();
        let quoted = text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or(text);
        budget.keep_text(quoted)?;
        return Ok(Node::Scalar(quoted.to_owned().into()));
    }
    let inner = |c: roxmltree::Node<'_, 'a>| node(c, depth + 1, expecting, budget);
    if children().all(|c| c.tag_name().name() == ITEM) {
        let mut items = Vec::new();
        for child in children() {
            budget.push::<Node<'_>>(items.len())?;
            items.push(inner(child)?);
        }
        return Ok(Node::List(items));
    }
    let mut fields: Vec<Field<'a>> = Vec::new();
    for child in children() {
        budget.push::<Field<'_>>(fields.len())?;
        fields.push((child.tag_name().name().into(), inner(child)?));
    }
    Ok(Node::Map(fields))
}
