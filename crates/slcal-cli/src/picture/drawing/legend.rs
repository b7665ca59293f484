//! The legend: what the marks of a picture mean.

use super::color::Color;
use super::primitive::Pen;

/// What stands before an entry.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Swatch {
    /// Nothing: the text begins at the left.
    Note,
    Line(Pen),
    Dot(Pen),
    Ring(Pen),
    Arrow(Pen),
    Cross(Pen),
    /// A scale: a bar of this length, px of the photograph.
    Bar(Pen, f64),
    /// Several colours side by side.
    Colors(Vec<Color>),
    /// The ramp for quantities.
    Ramp,
}

/// What a mark means.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) swatch: Swatch,
    pub(crate) text: String,
}

/// A headline, which says the result in words, and what the marks mean.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Legend {
    pub(crate) title: String,
    pub(crate) entries: Vec<Entry>,
}

impl Legend {
    pub(crate) fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), entries: Vec::new() }
    }

    pub(crate) fn entry(mut self, swatch: Swatch, text: impl Into<String>) -> Self {
        self.entries.push(Entry { swatch, text: text.into() });
        self
    }

    /// The same for a picture that is shown at a scale: bars are as long as what they stand for is shown.
    pub(crate) fn with_bars(mut self, scale: f64) -> Self {
        for entry in &mut self.entries {
            if let Swatch::Bar(_, length) = &mut entry.swatch {
                *length *= scale;
            }
        }
        self
    }

    pub(crate) fn note(self, text: impl Into<String>) -> Self {
        self.entry(Swatch::Note, text)
    }
}
