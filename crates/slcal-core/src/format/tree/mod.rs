//! YAML, XML and JSON as one tree of named values, lists and uninterpreted words.

mod expecting;
mod node;
mod xml;
mod yaml;

use std::borrow::Cow;

use serde_json::Value;

use crate::error::Result;
use crate::format::budget::Budget;

pub(super) use expecting::Expecting;
pub(super) use node::Node;

/// The values of a text. The first character distinguishes the three formats.
pub(super) fn parse<'a>(text: &'a str, expecting: Expecting, budget: &Budget) -> Result<Node<'a>> {
    match text.as_bytes().first() {
        None => Err(expecting.malformed("expected YAML, XML or JSON, found nothing")),
        Some(b'<') => xml::parse(text, expecting, budget),
        Some(b'{') => from_json(expecting.json(text, budget)?, budget),
        Some(_) => yaml::parse(text, expecting, budget),
    }
}

/// The tree of a JSON value; the parser bounds its depth.
pub(super) fn from_json(value: Value, budget: &Budget) -> Result<Node<'static>> {
    Ok(match value {
        Value::Array(items) => {
            budget.keep_list::<Node<'_>>(items.len())?;
            Node::List(items.into_iter().map(|item| from_json(item, budget)).collect::<Result<_>>()?)
        }
        Value::Object(fields) => {
            budget.keep_list::<node::Field<'_>>(fields.len())?;
            let named = fields.into_iter().map(|(n, v)| Ok((Cow::Owned(n), from_json(v, budget)?)));
            Node::Map(named.collect::<Result<_>>()?)
        }
        Value::String(text) => Node::Scalar(text.into()),
        other => {
            let text = other.to_string();
            budget.keep_text(&text)?;
            Node::Scalar(text.into())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorSubject;

    const FILE: Expecting = Expecting(ErrorSubject::CameraFile);

    fn read(text: &str, spent: usize) -> Result<Node<'_>> {
        let budget = Budget::new(ErrorSubject::CameraFile, text.len());
        budget.keep(spent)?;
        parse(text, FILE, &budget)
    }

    #[test]
    fn values_are_counted_in_every_format() {
        for [before, item, after] in [
            ["a: [", "0,", "0]"],
            ["a: [", "[0],", "0]"],
            ["a: [", "{a: 0},", "0]"],
            ["a: [", "\"\\n\",", "0]"],
            ["a: [", "&a 0,", "0]"],
            ["<opencv_storage>", "<_/>", "</opencv_storage>"],
            ["<opencv_storage>", "<_>0</_>", "</opencv_storage>"],
            ["{\"a\": [", "0,", "0]}"],
            ["{\"a\": [", "[0],", "0]}"],
        ] {
            let text = [before, &item.repeat(1000), after].concat();
            assert!(read(&text, 0).is_ok(), "{item}");
            let said = read(&text, 48_000_000 + 16 * text.len() - 10_000).unwrap_err().to_string();
            assert!(said.contains("MB of memory"), "{item}: {said}");
        }
    }

    #[test]
    fn levels_are_counted_in_every_format() {
        for [before, open, inner, close, after] in [
            ["a: ", "[", "0", "]", ""],
            ["<opencv_storage>", "<_>", "0", "</_>", "</opencv_storage>"],
            ["{\"a\": ", "[", "0", "]", "}"],
        ] {
            let of =
                |levels: usize| [before, &open.repeat(levels), inner, &close.repeat(levels), after].concat();
            assert!(read(&of(31), 0).is_ok(), "{open}");
            let said = read(&of(40), 0).unwrap_err().to_string();
            assert!(said.contains("at most 32 levels of values, found more"), "{said}");
        }
    }

    #[test]
    fn words_of_yaml_are_lent_by_the_text() {
        let text = "numbers: [ 1.5, -2e3,\n  'word', \"two words\" ]\nname: plain words \nother: \"\\t\"\n";
        let Node::Map(fields) = read(text, 0).unwrap() else { panic!("a map") };
        let [(name, Node::List(numbers)), (_, plain), (_, escaped)] = fields.as_slice() else {
            panic!("{fields:?}")
        };
        let lent = |node: &Node<'_>| matches!(node, Node::Scalar(Cow::Borrowed(_)));
        assert!(matches!(name, Cow::Borrowed("numbers")) && numbers.iter().all(lent) && lent(plain));
        assert_eq!((plain, escaped), (&Node::Scalar("plain words".into()), &Node::Scalar("\t".into())));
        assert!(!lent(escaped));
    }

    #[test]
    fn attributes_and_namespaces_of_xml_are_limited() {
        let said = |inner: &str| {
            let text = format!("<?xml version=\"1.0\"?><opencv_storage>{inner}</opencv_storage>");
            read(&text, 0).err().map_or(String::new(), |e| e.to_string())
        };
        assert_eq!(said("<K type_id='opencv-matrix' note='a > b'><data>1</data></K>"), "");
        assert_eq!(said("<!-- <a xmlns=''> --><b><![CDATA[<a xmlns=''>]]></b><c>\"xmlns = x\"</c>"), "");
        assert!(said("<a xmlns:b='c'/>").contains("xmlns"));
        let many = [" a=\"\""; 17].concat();
        assert!(
            said(&format!("<a{many}/>")).contains("at most 16 attributes"),
            "{}",
            said(&format!("<a{many}/>"))
        );
    }
}
