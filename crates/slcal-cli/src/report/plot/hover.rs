//! Values under the pointer: clear areas over a plot, each with its words.

use maud::{Markup, html};

use super::frame::Frame;
use super::mark::Mark;
use crate::picture::Number;

/// Upright strips over the whole height: their middles, and what they say.
#[derive(Debug, Clone)]
pub(crate) struct Strips {
    pub(crate) width: f64,
    pub(crate) strips: Vec<(f64, String)>,
}

impl Mark for Strips {
    fn draw(&self, frame: &Frame) -> Markup {
        let [top, bottom] = frame.y.reach();
        let [first, last] = frame.x.reach();
        html! {
            @for (middle, words) in &self.strips {
                @let [left, right] = [-0.5, 0.5].map(|s| frame.x.at(middle + s * self.width).clamp(first, last));
                rect.hit x=(Number(left)) y=(Number(top)) width=(Number(right - left)) height=(Number(bottom - top)) {
                    title { (words) }
                }
            }
        }
    }
}

/// Cells around their middles, and what they say.
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    pub(crate) size: [f64; 2],
    pub(crate) cells: Vec<([f64; 2], String)>,
}

impl Mark for Cells {
    fn draw(&self, frame: &Frame) -> Markup {
        let corner = |[x, y]: [f64; 2], s: f64| frame.at([x + s * self.size[0], y + s * self.size[1]]);
        html! {
            @for (middle, words) in &self.cells {
                @let ([left, bottom], [right, top]) = (corner(*middle, -0.5), corner(*middle, 0.5));
                rect.hit x=(Number(left)) y=(Number(top)) width=(Number(right - left)) height=(Number(bottom - top)) {
                    title { (words) }
                }
            }
        }
    }
}
