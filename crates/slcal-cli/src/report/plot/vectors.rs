//! Small vectors over an image, points that are left out, and the bar that says how long they are.

use std::fmt::Write as _;

use maud::{Markup, html};

use super::frame::Frame;
use super::mark::Mark;
use crate::picture::{Number, push_lines};

/// Radius of the dot at which a vector starts, and half a cross.
const DOT: f64 = 1.4;
const CROSS: f64 = 2.6;

/// From point to point, with a dot at the first.
#[derive(Debug, Clone)]
pub(crate) struct Vectors {
    pub(crate) from_to: Vec<[[f64; 2]; 2]>,
    /// What the pointer says.
    pub(crate) name: String,
}

impl Mark for Vectors {
    fn draw(&self, frame: &Frame) -> Markup {
        let (mut lines, mut dots) = (String::new(), String::new());
        for [from, to] in &self.from_to {
            let [from, to] = [*from, *to].map(|p| frame.at(p));
            push_lines(&mut lines, [from, to]);
            let wide = Number(2.0 * DOT);
            // Writing into a string cannot fail.
            let _ = write!(dots, "M{} {}", Number(from[0] - DOT), Number(from[1]));
            let _ = write!(dots, "a{DOT} {DOT} 0 1 0 {wide} 0a{DOT} {DOT} 0 1 0-{wide} 0");
        }
        html! { title { (self.name) } path.line.thin d=(lines) {} path.area d=(dots) {} }
    }
}

/// Crosses at points.
#[derive(Debug, Clone)]
pub(crate) struct Crosses {
    pub(crate) at: Vec<[f64; 2]>,
    pub(crate) name: String,
}

impl Mark for Crosses {
    fn draw(&self, frame: &Frame) -> Markup {
        let mut lines = String::new();
        for [x, y] in self.at.iter().map(|p| frame.at(*p)) {
            push_lines(&mut lines, [[x - CROSS, y - CROSS], [x + CROSS, y + CROSS]]);
            push_lines(&mut lines, [[x - CROSS, y + CROSS], [x + CROSS, y - CROSS]]);
        }
        html! { title { (self.name) } path.line.thin d=(lines) {} }
    }
}

/// A bar of a length along the lower axis, with words beside it.
#[derive(Debug, Clone)]
pub(crate) struct ScaleBar {
    pub(crate) from: [f64; 2],
    pub(crate) length: f64,
    pub(crate) words: String,
}

impl Mark for ScaleBar {
    fn draw(&self, frame: &Frame) -> Markup {
        let [left, y] = frame.at(self.from);
        let right = frame.x.at(self.from[0] + self.length);
        html! {
            path.line.thick d={ "M" (Number(left)) " " (Number(y)) "H" (Number(right)) } {}
            text x=(Number(right + 6.0)) y=(Number(y + 4.5)) { (self.words) }
        }
    }
}
