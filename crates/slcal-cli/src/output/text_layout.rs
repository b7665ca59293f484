//! Texts of at most [`MAX_WIDTH`] columns: labelled lines with hanging indents, and tables.

use std::io::IsTerminal as _;

use anstyle::Style;
use terminal_size::{Width, terminal_size_of};
use unicode_width::UnicodeWidthChar as _;

use super::style::{BOLD, DIM, styled};

/// The greatest width of a text, and the width where there is no terminal, so that pipes get the same text everywhere.
pub(crate) const MAX_WIDTH: usize = 80;
/// Least width: narrower terminals would break columns.
const MIN_WIDTH: usize = 40;
/// Width of the label column, including the space after it.
const LABEL: usize = 11;
/// Between the columns of a table.
const GAP: usize = 2;
/// A space at which no line breaks. No text contains it, as [`sanitized`] removes control characters.
const GLUE: char = '\u{1f}';
/// Begins a style sequence.
const ESCAPE: char = '\u{1b}';

/// The width of stdout, columns.
pub(crate) fn width() -> usize {
    let out = std::io::stdout();
    let columns = if out.is_terminal() { terminal_size_of(&out) } else { None };
    columns.map_or(MAX_WIDTH, |(Width(columns), _)| fitting(columns))
}

fn fitting(columns: u16) -> usize {
    // A terminal that does not know its size reports zero.
    if columns == 0 { MAX_WIDTH } else { usize::from(columns).clamp(MIN_WIDTH, MAX_WIDTH) }
}

/// A message for stderr: one line for programs, wrapped on a terminal.
pub(super) fn for_stderr(label: &str, message: &str) -> String {
    let out = std::io::stderr();
    let columns = if out.is_terminal() { terminal_size_of(&out) } else { None };
    let Some((Width(columns), _)) = columns else { return format!("{label}{message}") };
    let indent = display_width(label);
    let lines: Vec<String> = message
        .split('\n')
        // Lines that fit keep their layout.
        .map(|line| {
            if display_width(line) + indent <= usize::from(columns) {
                line.to_owned()
            } else {
                wrapped(line, fitting(columns), indent)
            }
        })
        .collect();
    format!("{label}{}", lines.join("\n"))
}

/// A text from outside, such as a file's name or a message that quotes one, in one line: without control characters, which could
/// move the terminal's cursor or pretend another message, and without marks that change the order in which it is read.
pub(crate) fn sanitized(text: &str) -> String {
    text.chars().map(shown).collect()
}

/// A character, or what stands for one that a terminal would obey instead of showing it.
fn shown(c: char) -> char {
    // Marks, embeddings, overrides and isolates of bidirectional text; separators of lines and paragraphs.
    let obeyed =
        matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if c.is_control() || obeyed { char::REPLACEMENT_CHARACTER } else { c }
}

/// A text without style sequences, for places other than a terminal.
pub(crate) fn without_style(text: &str) -> String {
    // First, since glue is a control character, which would be stripped.
    anstream::adapter::strip_str(&text.replace(GLUE, " ")).to_string()
}

/// A text whose spaces do not break.
pub(crate) fn unbroken(text: &str) -> String {
    text.replace(' ', &GLUE.to_string())
}

/// The width of a text on a terminal, columns.
pub(crate) fn display_width(text: &str) -> usize {
    let mut columns = 0;
    let mut in_style = false;
    for c in text.chars() {
        match c {
            ESCAPE => in_style = true,
            _ if in_style => in_style = c != 'm',
            GLUE => columns += 1,
            _ => columns += c.width().unwrap_or(0),
        }
    }
    columns
}

/// Words that stay with the number before them.
const UNITS: [&str; 9] = ["%", "mm", "mm²", "px", "σ", "ms", "s", "±", "x"];

/// Whether no line may break between two words: a number stays with its unit and its ±.
fn belong(word: &str, next: &str) -> bool {
    let number =
        |w: &str| w.trim_start_matches(['(', '-', '+', '"']).starts_with(|c: char| c.is_ascii_digit());
    let unit = next.trim_end_matches([',', ';', '.', ':', ')']);
    (number(word) && UNITS.contains(&unit)) || (["±", "x"].contains(&word) && number(next))
}

/// Wraps a text between words and indents all lines but the first. A word longer than a line stays whole.
pub(crate) fn wrapped(text: &str, width: usize, indent: usize) -> String {
    let words: Vec<&str> = text.split(' ').filter(|w| !w.is_empty()).collect();
    let (mut out, mut at) = (String::new(), indent);
    for part in words.chunk_by(|a, b| belong(a, b)) {
        let part = part.join(" ");
        let columns = display_width(&part);
        if at > indent && at + 1 + columns > width {
            out.push('\n');
            out.push_str(&" ".repeat(indent));
            at = indent;
        } else if at > indent {
            out.push(' ');
            at += 1;
        }
        out.push_str(&part);
        at += columns;
    }
    out.replace(GLUE, " ")
}

/// A text built from top to bottom.
#[derive(Debug)]
pub(crate) struct TextLayout {
    text: String,
    width: usize,
}

impl TextLayout {
    /// As wide as stdout.
    pub(crate) fn new() -> Self {
        Self { text: String::new(), width: width() }
    }

    /// A label and its content. A line without a label belongs to the line above.
    pub(crate) fn line(&mut self, label: &str, content: impl AsRef<str>) {
        self.styled_line(BOLD, label, content);
    }

    /// The same with a style for the label.
    pub(crate) fn styled_line(&mut self, style: Style, label: &str, content: impl AsRef<str>) {
        if !label.is_empty() {
            self.text.push_str(&styled(style, label));
        }
        let space = LABEL.saturating_sub(display_width(label)).max(usize::from(!label.is_empty()));
        self.text.push_str(&" ".repeat(space));
        self.text.push_str(&wrapped(content.as_ref(), self.width, LABEL));
        self.text.push('\n');
    }

    /// A paragraph at the left margin.
    pub(crate) fn paragraph(&mut self, content: impl AsRef<str>) {
        self.text.push_str(&wrapped(content.as_ref(), self.width, 0));
        self.text.push('\n');
    }

    /// An empty line.
    pub(crate) fn gap(&mut self) {
        self.text.push('\n');
    }

    pub(crate) fn table(&mut self, table: &Table) {
        table.write(&mut self.text, self.width);
    }

    /// The text, ready to be printed.
    pub(crate) fn into_text(self) -> String {
        self.text
    }
}

/// Rows of cells under headings, aligned by their width on a terminal. The first column holds labels. A last column that does not fit,
/// such as long names, goes below each row.
#[derive(Debug)]
pub(crate) struct Table {
    heads: Vec<String>,
    right: Vec<bool>,
    gap: usize,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Headings. One that begins with `>` aligns its column to the right.
    pub(crate) fn new<'a>(heads: impl IntoIterator<Item = &'a str>) -> Self {
        let heads: Vec<&str> = heads.into_iter().collect();
        let right = heads.iter().map(|h| h.starts_with('>')).collect();
        let heads = heads.iter().map(|h| h.strip_prefix('>').unwrap_or(h).to_owned()).collect();
        Self { heads, right, gap: GAP, rows: Vec::new() }
    }

    /// With a gap of one space between columns.
    pub(crate) fn tight(mut self) -> Self {
        self.gap = 1;
        self
    }

    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    fn write(&self, text: &mut String, width: usize) {
        let all = || std::iter::once(&self.heads).chain(&self.rows);
        let last = self.heads.len().saturating_sub(1);
        let widths: Vec<usize> = (0..=last)
            .map(|i| {
                let widest =
                    all().filter_map(|row| row.get(i)).map(|cell| display_width(cell)).max().unwrap_or(0);
                if i == 0 { widest.max(LABEL - self.gap) } else { widest }
            })
            .collect();
        let beneath = widths.iter().sum::<usize>() + self.gap * last > width;
        for (number, row) in all().enumerate() {
            if row.iter().all(String::is_empty) {
                continue;
            }
            let mut line = String::new();
            let mut space = 0;
            for (i, cell) in row.iter().enumerate().take(if beneath { last } else { last + 1 }) {
                let pad = widths[i].saturating_sub(display_width(cell));
                let (before, after) = if self.right[i] { (pad, 0) } else { (0, pad) };
                let style = if number == 0 { Some(DIM) } else { (i == 0).then_some(BOLD) };
                let cell = style.filter(|_| !cell.is_empty()).map_or(cell.clone(), |s| styled(s, cell));
                if !cell.is_empty() {
                    line.push_str(&" ".repeat(space + before));
                    line.push_str(&cell);
                    space = 0;
                }
                space += if cell.is_empty() { pad } else { after } + self.gap;
            }
            if beneath && let Some(cell) = row.get(last).filter(|c| number > 0 && !c.is_empty()) {
                line.push('\n');
                line.push_str(&" ".repeat(LABEL));
                line.push_str(cell);
            }
            text.push_str(&line.replace(GLUE, " "));
            text.push('\n');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(width: usize) -> TextLayout {
        TextLayout { text: String::new(), width }
    }

    fn bare(layout: TextLayout) -> String {
        anstream::adapter::strip_str(&layout.into_text()).to_string()
    }

    #[test]
    fn lines_are_broken_between_words_and_indented() {
        let mut p = layout(30);
        p.line("label", "one two three four five six");
        p.line("", format!("seven {}", unbroken("8 mm away")));
        assert_eq!(
            bare(p),
            "label      one two three four\n           five six\n           seven 8 mm away\n"
        );
    }

    #[test]
    fn numbers_stay_with_their_units() {
        let broken = |text: &str, width| wrapped(text, width, 0);
        assert_eq!(broken("it is 12.5 %) off", 10), "it is\n12.5 %)\noff");
        assert_eq!(broken("a 12.5 ± 0.5 px, b", 12), "a\n12.5 ± 0.5 px,\nb");
        assert_eq!(broken("a 594 x 420 mm", 9), "a\n594 x 420 mm");
    }

    #[test]
    fn what_is_wide_on_a_terminal_counts_so() {
        assert_eq!(display_width("写真.jpg"), 8);
        assert_eq!(display_width("e\u{301}"), 1);
        assert_eq!(display_width(&styled(BOLD, "good")), 4);
        let mut p = layout(20);
        p.line("", "写真写真 写真");
        assert_eq!(bare(p), "           写真写真\n           写真\n");
    }

    #[test]
    fn a_long_word_stays_whole() {
        let mut p = layout(20);
        p.line("file", "a aVeryLongNameThatDoesNotFit b");
        assert_eq!(bare(p), "file       a\n           aVeryLongNameThatDoesNotFit\n           b\n");
    }

    #[test]
    fn columns_are_aligned_and_long_names_go_beneath() {
        let rows = |name: &str| {
            let mut t = Table::new(["", ">px", "name"]);
            t.row(["view 1", "9.5", "写.jpg"]);
            t.row(["view 2", "10.25", name]);
            let mut p = layout(40);
            p.table(&t);
            bare(p)
        };
        assert_eq!(
            rows("b.jpg"),
            "              px  name\nview 1       9.5  写.jpg\nview 2     10.25  b.jpg\n"
        );
        assert_eq!(
            rows("b_name_that_takes_all_of_the_line.jpg"),
            "              px\nview 1       9.5\n           写.jpg\nview 2     10.25\n           \
             b_name_that_takes_all_of_the_line.jpg\n"
        );
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        assert_eq!(sanitized("a\u{1b}[31m\r\u{7}b\n"), "a\u{fffd}[31m\u{fffd}\u{fffd}b\u{fffd}");
        assert_eq!(sanitized("gnp.\u{202e}png\u{2066}é"), "gnp.\u{fffd}png\u{fffd}é");
    }
}
