//! The area of a plot within its picture: margins for labels, and both scales.

use super::axis::Axis;
use super::scale::Scale;
use super::ticks::Tick;

/// The picture is as wide as this, in units; the page's letters are about 14 of them.
pub(super) const WIDTH: f64 = 420.0;
/// Height of the area where nothing else decides.
const HEIGHT: f64 = 250.0;
/// The area is no higher than this.
const HIGHEST: f64 = 330.0;
/// Above the area is the title of the upright axis, below it labels and title of the other.
const ABOVE: f64 = 26.0;
const BELOW: f64 = 44.0;
/// At the right half a label of the lower axis.
const RIGHT: f64 = 18.0;
/// Width of a digit, and between a label and the area.
const DIGIT: f64 = 8.6;
const GAP: f64 = 9.0;

/// Where an area is, and the scales of its axes.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    pub(super) x: Scale,
    pub(super) y: Scale,
    pub(super) x_ticks: Vec<Tick>,
    pub(super) y_ticks: Vec<Tick>,
    /// Height of the picture.
    pub(super) height: f64,
}

impl Frame {
    /// `to_scale`: a unit is as long on both axes. `beside` units at the right are for something else.
    pub(super) fn new(x: &Axis, y: &Axis, to_scale: bool, beside: f64) -> Self {
        let most = WIDTH - RIGHT - beside;
        let length = |a: &Axis| (a.range[1] - a.range[0]).abs();
        let ratio = length(y) / length(x);
        let height_of = |wide: f64| if to_scale { (wide * ratio).min(HIGHEST) } else { HEIGHT };
        // Labels decide the margin, the margin the height, and the height the labels; a guess of the margin is enough for them.
        let y_ticks = y.ticks_up(height_of(most - 50.0));
        let longest = y_ticks.iter().map(|t| t.label.chars().count()).max().unwrap_or(1);
        let left = GAP + DIGIT * longest as f64;
        let high = height_of(most - left);
        let wide = if to_scale { (high / ratio).min(most - left) } else { most - left };
        let [left, right] = [left, left + wide].map(|p| p + (most - left - wide) / 2.0);
        Self {
            x: x.between([left, right]),
            y: y.between([ABOVE + high, ABOVE]),
            x_ticks: x.ticks_across(wide),
            y_ticks,
            height: ABOVE + high + BELOW,
        }
    }

    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.at(x), self.y.at(y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_to_scale_keep_their_shape_and_fit() {
        for (x, y) in
            [([0.0, 1280.0], [960.0, -96.0]), ([0.0, 900.0], [0.0, 2400.0]), ([0.0, 9e9], [0.0, 1.0])]
        {
            let frame = Frame::new(&Axis::even("", x), &Axis::even("", y), true, 60.0);
            let ([left, right], [top, bottom]) = (frame.x.reach(), frame.y.reach());
            assert!(left > 0.0 && right <= WIDTH - 60.0 && bottom < frame.height, "{frame:?}");
            let ratio = (y[1] - y[0]).abs() / (x[1] - x[0]);
            assert!(((bottom - top) - (right - left) * ratio).abs() < 1e-9, "{frame:?}");
        }
    }
}
