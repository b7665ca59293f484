//! The texts of `OpenCV`'s FileStorage: YAML, XML and JSON, laid out as `OpenCV` lays them out.

use std::fmt::Write as _;

use serde_json::{Map, Value};

use super::files::StorageText;
use super::text::{number, wrapped};

/// Words longer than this, bytes, are more than `OpenCV` reads.
const LONGEST_WORD: usize = 4000;

/// A value of a FileStorage.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Item {
    /// A matrix of doubles with this many columns, row by row.
    Matrix(usize, Vec<f64>),
    /// Numbers in order.
    Numbers(Vec<f64>),
    /// A whole number.
    Whole(u32),
    /// One number.
    Number(f64),
    /// Words.
    Word(String),
    /// Values in order.
    List(Vec<Item>),
    /// Values by name.
    Map(Vec<(String, Item)>),
}

impl Item {
    /// From what JSON has: rows of numbers become a matrix, nothing is written for null and for empty lists.
    pub(super) fn from_json(value: &Value) -> Option<Self> {
        Some(match value {
            Value::Null => return None,
            Value::Bool(yes) => Self::Whole((*yes).into()),
            Value::Number(n) => Self::Number(n.as_f64()?),
            Value::String(text) => Self::Word(text.clone()),
            Value::Object(fields) => Self::Map(named(fields)),
            Value::Array(items) if items.is_empty() => return None,
            Value::Array(items) => {
                if let Some(values) = numbers(value) {
                    return Some(Self::Numbers(values));
                }
                let rows: Option<Vec<Vec<f64>>> = items.iter().map(numbers).collect();
                match rows {
                    Some(rows) if rows.windows(2).all(|pair| pair[0].len() == pair[1].len()) => {
                        Self::Matrix(rows.first().map_or(1, Vec::len), rows.concat())
                    }
                    _ => Self::List(items.iter().filter_map(Self::from_json).collect()),
                }
            }
        })
    }
}

/// The values of an object that are there.
pub(super) fn named(fields: &Map<String, Value>) -> Vec<(String, Item)> {
    fields.iter().filter_map(|(n, v)| Some((n.clone(), Item::from_json(v)?))).collect()
}

/// A list that holds numbers and nothing else, one at least.
fn numbers(value: &Value) -> Option<Vec<f64>> {
    let items = value.as_array().filter(|items| !items.is_empty())?;
    items.iter().map(Value::as_f64).collect()
}

/// What a FileStorage can hold of words, and whether that is all: `OpenCV` reads no control characters but the usual ones, and
/// YAML breaks lines at two more.
fn readable(words: &str) -> (String, bool) {
    let unreadable = |c: char| {
        (c.is_control() && !matches!(c, '\n' | '\r' | '\t'))
            || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}')
    };
    let mut end = words.len().min(LONGEST_WORD);
    while !words.is_char_boundary(end) {
        end -= 1;
    }
    let kept: String = words[..end].chars().map(|c| if unreadable(c) { '\u{fffd}' } else { c }).collect();
    let whole = kept == words;
    (kept, whole)
}

/// Writes one.
pub(super) struct Writer {
    text: String,
    /// Whether words had to be changed.
    changed: bool,
}

/// The text of a FileStorage, and whether all words could be written as they are.
pub(super) fn written(items: &[(String, Item)], as_: StorageText, comment: &str) -> (String, bool) {
    let mut writer = Writer { text: String::new(), changed: false };
    match as_ {
        StorageText::Yaml => {
            let _ = write!(writer.text, "%YAML:1.0\n---\n# {comment}\n");
            writer.yaml_map(items, 0);
        }
        StorageText::Xml => {
            let _ = write!(writer.text, "<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- {comment} -->\n");
            for (name, item) in items {
                writer.xml(name, item);
            }
            writer.text.push_str("</opencv_storage>\n");
        }
        StorageText::Json => {
            writer.json(&Item::Map(items.to_vec()), 0);
            writer.text.push('\n');
        }
    }
    (writer.text, !writer.changed)
}

impl Writer {
    fn word(&mut self, words: &str) -> String {
        let (kept, whole) = readable(words);
        self.changed |= !whole;
        kept
    }

    /// In the quotes that YAML and JSON share.
    fn quoted(&mut self, words: &str) -> String {
        let escaped = self.word(words).replace('\\', "\\\\").replace('"', "\\\"");
        let escaped = escaped.replace('\n', "\\n").replace('\r', "\\r").replace('\t', "\\t");
        format!("\"{escaped}\"")
    }

    fn yaml_map(&mut self, items: &[(String, Item)], depth: usize) {
        for (name, item) in items {
            let _ = write!(self.text, "{}{name}:", "   ".repeat(depth));
            self.yaml(item, depth);
        }
    }

    /// A value after `name:` or `-`.
    fn yaml(&mut self, item: &Item, depth: usize) {
        let indent = "   ".repeat(depth + 1);
        let _ = match item {
            Item::Matrix(columns, values) => write!(
                self.text,
                " !!opencv-matrix\n{indent}rows: {}\n{indent}cols: {columns}\n{indent}dt: d\n{indent}data: [ {} ]\n",
                values.len() / columns,
                wrapped(values, ", ", &format!("{indent}    "))
            ),
            Item::Numbers(values) => {
                writeln!(self.text, " [ {} ]", wrapped(values, ", ", &format!("{indent}    ")))
            }
            Item::Whole(n) => writeln!(self.text, " {n}"),
            Item::Number(x) => writeln!(self.text, " {}", number(*x)),
            Item::Word(words) => {
                let words = self.quoted(words);
                writeln!(self.text, " {words}")
            }
            Item::List(items) => {
                self.text.push('\n');
                for item in items {
                    let _ = write!(self.text, "{indent}-");
                    self.yaml(item, depth + 1);
                }
                Ok(())
            }
            Item::Map(items) => {
                self.text.push('\n');
                self.yaml_map(items, depth + 1);
                Ok(())
            }
        };
    }

    fn xml(&mut self, name: &str, item: &Item) {
        let _ = match item {
            Item::Matrix(columns, values) => writeln!(
                self.text,
                "<{name} type_id=\"opencv-matrix\">\n  <rows>{}</rows>\n  <cols>{columns}</cols>\n  <dt>d</dt>\n  <data>\n    \
                 {}</data></{name}>",
                values.len() / columns,
                wrapped(values, " ", "    ")
            ),
            Item::Numbers(values) => {
                writeln!(self.text, "<{name}>\n  {}</{name}>", wrapped(values, " ", "  "))
            }
            Item::Whole(n) => writeln!(self.text, "<{name}>{n}</{name}>"),
            Item::Number(x) => writeln!(self.text, "<{name}>{}</{name}>", number(*x)),
            Item::Word(words) => {
                let words = self.word(words).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
                let words = words.replace('"', "&quot;").replace('\'', "&apos;");
                let words = words.replace('\n', "&#x0a;").replace('\r', "&#x0d;").replace('\t', "&#x09;");
                writeln!(self.text, "<{name}>\"{words}\"</{name}>")
            }
            Item::List(items) => {
                let _ = writeln!(self.text, "<{name}>");
                for item in items {
                    self.xml("_", item);
                }
                writeln!(self.text, "</{name}>")
            }
            Item::Map(items) => {
                let _ = writeln!(self.text, "<{name}>");
                for (name, item) in items {
                    self.xml(name, item);
                }
                writeln!(self.text, "</{name}>")
            }
        };
    }

    fn json(&mut self, item: &Item, depth: usize) {
        let indent = "    ".repeat(depth + 1);
        let list = |values: &[f64]| format!("[ {} ]", wrapped(values, ", ", &indent));
        match item {
            Item::Matrix(columns, values) => {
                let head = format!(
                    "{{\n{indent}\"type_id\": \"opencv-matrix\",\n{indent}\"rows\": {},\n{indent}\"cols\": {columns},\n{indent}\"dt\": \"d\",\
                     \n{indent}\"data\": {}\n{}}}",
                    values.len() / columns,
                    list(values),
                    &indent[4..]
                );
                self.text.push_str(&head);
            }
            Item::Numbers(values) => self.text.push_str(&list(values)),
            Item::Whole(n) => self.text.push_str(&n.to_string()),
            Item::Number(x) => self.text.push_str(&number(*x)),
            Item::Word(words) => {
                let words = self.quoted(words);
                self.text.push_str(&words);
            }
            Item::List(items) => {
                self.json_between('[', ']', depth, items, |writer, item| writer.json(item, depth + 1));
            }
            Item::Map(items) => self.json_between('{', '}', depth, items, |writer, (name, item)| {
                let _ = write!(writer.text, "\"{name}\": ");
                writer.json(item, depth + 1);
            }),
        }
    }

    fn json_between<T>(
        &mut self,
        open: char,
        close: char,
        depth: usize,
        items: &[T],
        mut each: impl FnMut(&mut Self, &T),
    ) {
        self.text.push(open);
        for (i, item) in items.iter().enumerate() {
            self.text.push_str(if i > 0 { ",\n" } else { "\n" });
            self.text.push_str(&"    ".repeat(depth + 1));
            each(self, item);
        }
        let _ = write!(self.text, "\n{}{close}", "    ".repeat(depth));
    }
}
