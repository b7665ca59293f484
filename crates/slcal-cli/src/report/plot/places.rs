//! Things that stand somewhere: devices with their names, sheets as lines.

use maud::{Markup, html};

use super::frame::Frame;
use super::mark::Mark;
use crate::picture::{Number, push_lines};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Symbol {
    Square,
    Diamond,
}

/// A symbol with its name at one side.
#[derive(Debug, Clone)]
pub(crate) struct NamedPlace {
    pub(crate) at: [f64; 2],
    pub(crate) symbol: Symbol,
    pub(crate) name: &'static str,
    pub(crate) name_at_left: bool,
}

impl Mark for NamedPlace {
    fn draw(&self, frame: &Frame) -> Markup {
        let [x, y] = frame.at(self.at);
        let shape = match self.symbol {
            Symbol::Square => "m-4.5-4.5h9v9h-9z",
            Symbol::Diamond => "m0-6l6 6l-6 6l-6-6z",
        };
        let beside = if self.name_at_left { x - 10.0 } else { x + 10.0 };
        html! {
            path.area d={ "M" (Number(x)) " " (Number(y)) (shape) } {}
            text.coloured.last[self.name_at_left] x=(Number(beside)) y=(Number(y + 4.5)) { (self.name) }
        }
    }
}

/// A black line with a white edge, to be seen on any colour.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    pub(crate) ends: [[f64; 2]; 2],
    pub(crate) name: String,
}

impl Mark for Segment {
    fn draw(&self, frame: &Frame) -> Markup {
        let mut data = String::new();
        push_lines(&mut data, self.ends.map(|p| frame.at(p)));
        html! { title { (self.name) } path.edge d=(data) {} path.edged d=(data) {} }
    }
}
