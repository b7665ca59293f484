//! Lines through points.

use maud::{Markup, html};

use super::frame::Frame;
use super::mark::Mark;
use crate::picture::{Number, push_lines};

/// A line through points, with gaps where there is none.
#[derive(Debug, Clone)]
pub(crate) struct Curve {
    pub(crate) points: Vec<Option<[f64; 2]>>,
    pub(crate) dashed: bool,
}

impl Mark for Curve {
    fn draw(&self, frame: &Frame) -> Markup {
        let mut data = String::new();
        let places: Vec<_> = self
            .points
            .iter()
            .map(|p| p.map(|p| frame.at(p)).filter(|p| p.iter().all(|x| x.is_finite())))
            .collect();
        for part in places.split(Option::is_none) {
            push_lines(&mut data, part.iter().copied().flatten());
        }
        html! { path.line.dashed[self.dashed] d=(data) {} }
    }
}

/// A line over the whole height at a value, with a name.
#[derive(Debug, Clone)]
pub(crate) struct UprightLine {
    pub(crate) x: f64,
    pub(crate) name: &'static str,
}

impl Mark for UprightLine {
    fn draw(&self, frame: &Frame) -> Markup {
        if !frame.x.holds(self.x) {
            return html! {};
        }
        let (x, [top, bottom]) = (frame.x.at(self.x), frame.y.reach());
        html! {
            path.line.thin.dotted d={ "M" (Number(x)) " " (Number(top)) "V" (Number(bottom)) } {}
            text x=(Number(x + 5.0)) y=(Number(top + 13.0)) { (self.name) }
        }
    }
}
