//! The letters of the pictures: how wide a text is, and its outline.

use nalgebra::Point2;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider as _};
use tiny_skia::{Path, PathBuilder};

/// `font/README.md` says what is in it.
const FILE: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");

/// Height of capitals as a share of the size: DejaVu Sans.
pub(crate) const CAPITALS: f64 = 0.73;
/// Taken for the width of a letter that the font does not have, as a share of the size.
const UNKNOWN_WIDTH: f64 = 1.0;

/// The embedded font.
pub(crate) struct Font(Option<FontRef<'static>>);

impl Font {
    pub(crate) fn embedded() -> Self {
        // A file that is part of the program; were it broken, pictures would come without letters.
        Self(FontRef::new(FILE).ok())
    }

    fn glyph(&self, letter: char) -> Option<GlyphId> {
        self.0.as_ref()?.charmap().map(letter)
    }

    /// Whether every letter can be drawn.
    pub(crate) fn has(&self, text: &str) -> bool {
        text.chars().all(|c| self.glyph(c).is_some())
    }

    /// The width of a text of the given size (that of a capital M's square), in the unit of the size.
    pub(crate) fn width(&self, text: &str, size: f64) -> f64 {
        text.chars().map(|c| self.advance(c)).sum::<f64>() * size
    }

    /// As a share of the size.
    fn advance(&self, letter: char) -> f64 {
        let metrics = self.0.as_ref().map(|f| f.glyph_metrics(Size::new(1.0), LocationRef::default()));
        let width = metrics.zip(self.glyph(letter)).and_then(|(m, g)| m.advance_width(g));
        width.map_or(UNKNOWN_WIDTH, f64::from)
    }

    /// The outline of a text whose baseline begins at `start`, y down; `None` where it leaves no mark.
    pub(crate) fn outline(&self, text: &str, start: Point2<f64>, size: f64) -> Option<Path> {
        let outlines = self.0.as_ref()?.outline_glyphs();
        let mut pen = Outline { path: PathBuilder::new(), x: 0.0, y: start.y as f32 };
        let mut x = start.x;
        for letter in text.chars() {
            if let Some(glyph) = outlines.get(self.glyph(letter).unwrap_or(GlyphId::NOTDEF)) {
                let settings = DrawSettings::unhinted(Size::new(size as f32), LocationRef::default());
                pen.x = x as f32;
                // A glyph that the file holds wrongly stays out; see `embedded`.
                let _ = glyph.draw(settings, &mut pen);
            }
            x += self.advance(letter) * size;
        }
        pen.path.finish()
    }

    /// The text in lines no wider than `width`, broken between words, and within words that are wider.
    pub(crate) fn wrap(&self, text: &str, size: f64, width: f64) -> Vec<String> {
        let mut lines = vec![String::new()];
        let last = |lines: &mut Vec<String>| lines.pop().unwrap_or_default();
        for word in text.split_whitespace() {
            let mut line = last(&mut lines);
            let gap = if line.is_empty() { "" } else { " " };
            if !line.is_empty() && self.width(&format!("{line} {word}"), size) > width {
                lines.push(std::mem::take(&mut line));
            } else {
                line.push_str(gap);
            }
            for letter in word.chars() {
                if !line.is_empty() && self.width(&line, size) + self.advance(letter) * size > width {
                    lines.push(std::mem::take(&mut line));
                }
                line.push(letter);
            }
            lines.push(line);
        }
        lines
    }
}

/// Puts glyphs, whose y points up from their origin, where they belong.
struct Outline {
    path: PathBuilder,
    x: f32,
    y: f32,
}

impl OutlinePen for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.x + x, self.y - y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.x + x, self.y - y);
    }
    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.path.quad_to(self.x + cx, self.y - cy, self.x + x, self.y - y);
    }
    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.path.cubic_to(self.x + ax, self.y - ay, self.x + bx, self.y - by, self.x + x, self.y - y);
    }
    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_the_font() {
        let font = Font::embedded();
        // Advances in the font's own units, 2048 per em, as `ttx` prints them: M 1767, i 569.
        assert!((font.width("M", 2048.0) - 1767.0).abs() < 1e-3, "{}", font.width("M", 2048.0));
        assert!((font.width("iiM", 20.48) - (2.0 * 5.69 + 17.67)).abs() < 1e-5);
    }

    #[test]
    fn the_signs_of_the_pictures_are_there() {
        let font = Font::embedded();
        assert!(font.has("AZaz09 ± σ × ° – — ’ → ← ² ³ µ … Ä ß é Ж я Ω \u{2212}"));
        assert!(!font.has("写真"));
    }

    #[test]
    fn lines_break_between_words_and_in_words_that_are_too_wide() {
        let font = Font::embedded();
        let width = font.width("one two", 10.0);
        assert_eq!(font.wrap("one two six", 10.0, width), ["one two", "six"]);
        assert_eq!(font.wrap("", 10.0, width), [""]);
        let lines = font.wrap("a_very_long_name_of_a_file.jpg", 10.0, width);
        assert!(lines.len() > 2 && lines.iter().all(|l| font.width(l, 10.0) <= width), "{lines:?}");
        assert_eq!(lines.concat(), "a_very_long_name_of_a_file.jpg");
        // No room at all: a letter a line, without end or panic.
        assert_eq!(font.wrap("abc", 10.0, 0.0), ["a", "b", "c"]);
    }
}
