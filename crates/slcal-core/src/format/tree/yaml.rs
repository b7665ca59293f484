//! YAML as OpenCV and ROS write it.

use saphyr_parser::{Event, Parser};

use super::expecting::{DEEPEST, Expecting};
use super::node::Node;
use crate::error::Result;

/// A list or a map that is not complete yet; a map with the name that waits for its value.
enum Open {
    List(Vec<Node>),
    Map(Vec<(String, Node)>, Option<String>),
}

/// The first document. Aliases are refused: no file of cameras has them, and they can make a small text gigantic.
pub(super) fn parse(text: &str, expecting: Expecting) -> Result<Node> {
    // OpenCV up to 4 begins its files with `%YAML:1.0`, which no version of YAML knows.
    let text = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => rest,
        _ => text,
    };
    let mut open: Vec<Open> = Vec::new();
    let most = expecting.most_nodes;
    let mut nodes = 0;
    for event in Parser::new_from_str(text) {
        let (event, _) = event.map_err(|e| expecting.malformed(format!("this is not YAML: {e}")))?;
        nodes += 1;
        if nodes > most || open.len() > DEEPEST {
            return Err(expecting.malformed(format!(
                "expected at most {most} values, {DEEPEST} levels deep; found more values or levels"
            )));
        }
        let done = match event {
            Event::Scalar(value, ..) => Node::Scalar(value.into_owned()),
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
            Some(Open::List(items)) => items.push(done),
            Some(Open::Map(fields, name)) => match (name.take(), done) {
                (Some(name), value) => fields.push((name, value)),
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
