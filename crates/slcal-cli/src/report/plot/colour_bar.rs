//! What the colours between levels mean.

use maud::{Markup, html};

use super::frame::{Frame, WIDTH};
use super::levels::Levels;
use super::mark::Mark;
use crate::picture::Number;

/// Room at the right of a plot, and width of the bar.
pub(super) const ROOM: f64 = 74.0;
const WIDE: f64 = 13.0;
/// Between the plot and the bar.
const GAP: f64 = 14.0;
/// More labels than these come too close to each other.
const MOST_LABELS: usize = 10;

/// A bar over the whole height with the colours of all steps.
#[derive(Debug, Clone)]
pub(crate) struct ColourBar {
    pub(crate) levels: Levels,
    pub(crate) title: &'static str,
}

impl Mark for ColourBar {
    fn draw(&self, frame: &Frame) -> Markup {
        let (levels, [top, bottom]) = (&self.levels, frame.y.reach());
        let left = WIDTH - ROOM + GAP;
        let high = (bottom - top) / levels.steps as f64;
        let y = |i: usize| bottom - i as f64 * high;
        let every = (levels.steps + 1).div_ceil(MOST_LABELS);
        html! {
            @for i in 0..levels.steps {
                rect x=(Number(left)) y=(Number(y(i + 1))) width=(WIDE) height=(Number(high)) fill=(levels.colour(i)) {}
            }
            @for i in (0..=levels.steps).step_by(every) {
                text x=(Number(left + WIDE + 6.0)) y=(Number(y(i) + 4.5)) { (levels.label(i)) }
            }
            text.title x=(Number(left)) y="13" { (self.title) }
        }
    }
}
