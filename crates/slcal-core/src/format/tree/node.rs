//! The tree: named values, lists and uninterpreted words.

use std::borrow::Cow;

/// A value of YAML, XML or JSON; its words are those of the text where they stand there as they are.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::format) enum Node<'a> {
    /// A word or a number, uninterpreted.
    Scalar(Cow<'a, str>),
    /// Values in order.
    List(Vec<Node<'a>>),
    /// Values by name, in the order of the file.
    Map(Vec<Field<'a>>),
}

/// A name and its value.
pub(in crate::format) type Field<'a> = (Cow<'a, str>, Node<'a>);

impl Node<'_> {
    /// The first value called `name`.
    pub(in crate::format) fn get(&self, name: &str) -> Option<&Self> {
        match self {
            Self::Map(fields) => fields.iter().find(|(n, _)| n == name).map(|(_, v)| v),
            _ => None,
        }
    }

    /// All words below, in order; of a list of lists those of its rows, of text its parts between spaces and commas.
    pub(in crate::format) fn words(&self) -> Vec<&str> {
        let mut words = Vec::new();
        self.add_words(&mut words);
        words
    }

    fn add_words<'n>(&'n self, words: &mut Vec<&'n str>) {
        match self {
            Self::Scalar(text) => {
                words.extend(text.split([' ', ',', '\n', '\t', '\r']).filter(|w| !w.is_empty()));
            }
            Self::List(items) => items.iter().for_each(|item| item.add_words(words)),
            Self::Map(_) => {}
        }
    }
}
