//! YAML as OpenCV and ROS write it.

use std::borrow::Cow;

use saphyr_parser::{Event, Parser, Span};

use super::expecting::Expecting;
use super::node::{Field, Node};
use crate::error::Result;
use crate::format::budget::{Budget, DEEPEST};

/// Memory of the parser for an anchor, bytes.
const ANCHOR_MEMORY: usize = 128;

/// A list or a map that is not complete yet; a map with the name that waits for its value.
enum Open<'a> {
    List(Vec<Node<'a>>),
    Map(Vec<Field<'a>>, Option<Cow<'a, str>>),
}

/// The first document. Aliases are refused: no file of cameras has them, and they can make a small text gigantic.
pub(super) fn parse<'a>(text: &'a str, expecting: Expecting, budget: &Budget) -> Result<Node<'a>> {
    // OpenCV up to 4 begins its files with `%YAML:1.0`, which no version of YAML knows.
    let text = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => rest,
        _ => text,
    };
    let mut open: Vec<Open<'a>> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| expecting.malformed(format!("this is not YAML: {e}")))?;
        if open.len() > DEEPEST {
            return Err(expecting.too_deep());
        }
        if let Event::Scalar(_, _, 1.., _) | Event::SequenceStart(1.., _) | Event::MappingStart(1.., _) =
            event
        {
            budget.keep(ANCHOR_MEMORY)?;
        }
        let done = match event {
            Event::Scalar(value, ..) => Node::Scalar(word(value, span, text, budget)?),
            Event::SequenceStart(..) => {
                open.push(Open::List(Vec::new()));
                continue;
            }
            Event::MappingStart(..) => {
                open.push(Open::Map(Vec::new(), None));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(Open::List(items)) => Node::List(items),
                Some(Open::Map(fields, _)) => Node::Map(fields),
                None => continue,
            },
            Event::Alias(_) => return Err(expecting.malformed("expected plain values, found an alias (*)")),
            Event::DocumentEnd | Event::StreamEnd => break,
            _ => continue,
        };
        match open.last_mut() {
            None => return Ok(done),
            Some(Open::List(items)) => {
                budget.push::<Node<'_>>(items.len())?;
                items.push(done);
            }
            Some(Open::Map(fields, name)) => match (name.take(), done) {
                (Some(name), value) => {
                    budget.push::<Field<'_>>(fields.len())?;
                    fields.push((name, value));
                }
                (None, Node::Scalar(text)) => *name = Some(text),
                (None, _) => {
                    return Err(
                        expecting.malformed("expected names for values, found a list or a map as a name")
                    );
                }
            },
        }
    }
    Err(expecting.malformed("expected YAML with named values, found none"))
}

/// The word of a scalar: lent by the text where it stands there as it is, in quotes or not, else a copy as long as it is.
fn word<'a>(value: Cow<'a, str>, span: Span, text: &'a str, budget: &Budget) -> Result<Cow<'a, str>> {
    let Cow::Owned(owned) = value else { return Ok(value) };
    // The parser counts characters, which are bytes in the texts of all programs but those with words beyond ASCII.
    let start = span.start.index();
    let standing = [start, start + 1]
        .into_iter()
        .filter_map(|at| text.get(at..at + owned.len()))
        .find(|standing| *standing == owned);
    if let Some(standing) = standing {
        return Ok(standing.into());
    }
    budget.keep_text(&owned)?;
    Ok(Cow::Owned(owned.into_boxed_str().into_string()))
}
