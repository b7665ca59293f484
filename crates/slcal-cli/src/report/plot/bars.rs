//! Bars that stand on zero.

use maud::{Markup, html};

use super::frame::Frame;
use super::mark::Mark;
use crate::picture::Number;

/// Share of its place that a bar fills.
const FILLED: f64 = 0.92;

/// Bars around their middles.
#[derive(Debug, Clone)]
pub(crate) struct Bars {
    /// From middle to middle.
    pub(crate) width: f64,
    /// Middle and height.
    pub(crate) bars: Vec<(f64, usize)>,
}

impl Mark for Bars {
    fn draw(&self, frame: &Frame) -> Markup {
        let half = 0.5 * FILLED * self.width;
        let zero = Number(frame.y.at(0.0));
        let bar = |(middle, count): &(f64, usize)| {
            let [left, right] = [middle - half, middle + half].map(|x| Number(frame.x.at(x)));
            format!("M{left} {zero}V{}H{right}V{zero}z", Number(frame.y.at(*count as f64)))
        };
        let bars: String = self.bars.iter().filter(|b| b.1 > 0).map(bar).collect();
        html! { path.area d=(bars) {} }
    }
}
