//! Flat plots as SVG, drawn when the report is written: they need no script, follow the page's colours and print as they are.
//!
//! A [`Plot`] (`chart`) has two `axis`es with their `ticks` and a `scale` each, which a `frame` joins; and marks, one kind per file:
//! `bars`, `curve`, `vectors`, `places`, and `contours` with `levels`, `outline` and `colour_bar`. `hover` says values under the
//! pointer, `choice` shows one of several plots. Colours and letters are in the page's style.

mod axis;
mod bars;
mod chart;
mod choice;
mod colour_bar;
mod contours;
mod curve;
mod frame;
mod hover;
mod levels;
mod mark;
mod outline;
mod places;
mod scale;
mod ticks;
mod vectors;

pub(super) use self::axis::Axis;
pub(super) use self::bars::Bars;
pub(super) use self::chart::Plot;
pub(super) use self::choice::chosen;
pub(super) use self::colour_bar::ColourBar;
pub(super) use self::contours::Contours;
pub(super) use self::curve::{Curve, UprightLine};
pub(super) use self::hover::{Cells, Strips};
pub(super) use self::levels::Levels;
pub(super) use self::mark::{Colour, Key};
pub(super) use self::places::{NamedPlace, Segment, Symbol};
pub(super) use self::vectors::{Crosses, ScaleBar, Vectors};
