//! A field of values over a grid: a colour per step between levels, and lines of equal values with their labels.

use maud::{Markup, html};

use super::frame::Frame;
use super::levels::Levels;
use super::mark::Mark;
use super::outline::{Cut, Outline};
use crate::picture::{Number, push_lines};

/// Labels keep this distance from each other and from the field's border, units.
const APART: f64 = 34.0;
const INSIDE: f64 = 16.0;

/// Values over a grid, row by row, with gaps where there are none.
#[derive(Debug, Clone)]
pub(crate) struct Contours {
    pub(crate) xs: Vec<f64>,
    pub(crate) ys: Vec<f64>,
    pub(crate) values: Vec<Vec<Option<f64>>>,
    pub(crate) levels: Levels,
}

/// A place on the page and the value there.
type Sample = ([f64; 2], f64);

impl Contours {
    /// Half of each cell; where three corners have a value, that half alone.
    fn triangles(&self, frame: &Frame) -> Vec<[Sample; 3]> {
        let sample = |i: usize, j: usize| -> Option<Sample> {
            let value = self.values.get(j)?.get(i).copied()??;
            Some((frame.at([*self.xs.get(i)?, *self.ys.get(j)?]), value))
        };
        let mut all = Vec::new();
        for j in 1..self.ys.len() {
            for i in 1..self.xs.len() {
                let corners = [sample(i - 1, j - 1), sample(i, j - 1), sample(i, j), sample(i - 1, j)];
                // Along the diagonal whose corners are known.
                let halves = if corners[0].is_some() && corners[2].is_some() {
                    [[0, 1, 2], [0, 2, 3]]
                } else {
                    [[0, 1, 3], [1, 2, 3]]
                };
                for [a, b, c] in halves {
                    if let (Some(a), Some(b), Some(c)) = (corners[a], corners[b], corners[c]) {
                        all.push([a, b, c]);
                    }
                }
            }
        }
        all
    }
}

impl Mark for Contours {
    fn draw(&self, frame: &Frame) -> Markup {
        let triangles = self.triangles(frame);
        // From the lowest to the highest: each covers a part of the one before, so that no seams show.
        let above: Vec<Outline> = (0..self.levels.steps)
            .map(|i| {
                let level = if i == 0 { f64::NEG_INFINITY } else { self.levels.at(i) };
                let mut outline = Outline::default();
                for t in &triangles {
                    outline.add(&higher(t, level));
                }
                outline
            })
            .collect();
        let lines: Vec<_> = above.iter().map(Outline::of_level).collect();
        let border = above.first().map(Outline::around).unwrap_or_default();
        let drawn = |lines: &[Vec<[f64; 2]>]| {
            let mut data = String::new();
            for line in lines {
                push_lines(&mut data, line.iter().copied());
            }
            data
        };
        html! {
            @for (i, outline) in above.iter().enumerate() { path fill=(self.levels.colour(i)) d=(drawn(&outline.around())) {} }
            path.level d=(lines.iter().map(|l| drawn(l)).collect::<String>()) {}
            @for (i, [x, y]) in labelled(&lines, &border) {
                text.level-label x=(Number(x)) y=(Number(y + 4.0)) { (self.levels.label(i)) }
            }
        }
    }
}

/// The part of a triangle whose values are at least `level`.
fn higher(triangle: &[Sample; 3], level: f64) -> Vec<Cut> {
    let mut kept = Vec::with_capacity(4);
    for (i, a) in triangle.iter().enumerate() {
        let b = &triangle[(i + 1) % 3];
        if a.1 >= level {
            kept.push(Cut { at: a.0, on_level: a.1 == level });
        }
        if (a.1 >= level) != (b.1 >= level) {
            kept.push(Cut { at: crossing(a, b, level), on_level: true });
        }
    }
    kept
}

/// Where an edge crosses a level. Both triangles at an edge find the same place: it is reckoned from the lower end.
fn crossing(a: &Sample, b: &Sample, level: f64) -> [f64; 2] {
    let (low, high) = if a.1 < b.1 { (a, b) } else { (b, a) };
    let share = (level - low.1) / (high.1 - low.1);
    [0, 1].map(|k| low.0[k] + share * (high.0[k] - low.0[k]))
}

/// A place on the line of each level for its label, as far as possible from labels before; none where there is no room.
fn labelled(lines: &[Vec<Vec<[f64; 2]>>], border: &[Vec<[f64; 2]>]) -> Vec<(usize, [f64; 2])> {
    let sides = || border.iter().flat_map(|line| line.windows(2));
    let inside = |p: &[f64; 2]| sides().all(|side| distance_from_line(*p, side[0], side[1]) > INSIDE);
    let mut labels: Vec<(usize, [f64; 2])> = Vec::new();
    for (i, level) in lines.iter().enumerate() {
        let apart = |p: &[f64; 2]| labels.iter().map(|l| distance(l.1, *p)).fold(2.0 * APART, f64::min);
        let free = level.iter().flatten().filter(|p| inside(p)).map(|p| (apart(p), *p));
        let best = free.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(apart, _)| *apart > APART);
        labels.extend(best.map(|(_, p)| (i, p)));
    }
    labels
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn distance_from_line(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / squared.max(f64::MIN_POSITIVE);
    let share = share.clamp(0.0, 1.0);
    distance(p, [a[0] + share * along[0], a[1] + share * along[1]])
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;

    #[test]
    fn levels_cut_the_field_where_values_reach_them() {
        let triangle = [([0.0, 0.0], 0.0), ([10.0, 0.0], 10.0), ([0.0, 10.0], 0.0)];
        let cut = higher(&triangle, 5.0);
        assert_eq!(cut.iter().map(|c| c.at).collect::<Vec<_>>(), [[5.0, 0.0], [10.0, 0.0], [5.0, 5.0]]);
        assert_eq!(cut.iter().map(|c| c.on_level).collect::<Vec<_>>(), [true, false, true]);
        assert!(higher(&triangle, 11.0).is_empty());
        assert_eq!(higher(&triangle, f64::NEG_INFINITY).len(), 3);
    }

    #[test]
    fn gaps_stay_free_and_one_level_is_one_line() {
        let axis: Vec<f64> = (0..11).map(f64::from).collect();
        let value = |i: usize, j: usize| (i < 8 || j < 8).then_some(i as f64);
        let values = (0..11).map(|j| (0..11).map(|i| value(i, j)).collect()).collect();
        let levels = Levels::over((0..11).map(f64::from));
        let field = Contours { xs: axis.clone(), ys: axis, values, levels };
        let (x, y) = (Axis::even("", [0.0, 10.0]), Axis::even("", [0.0, 10.0]));
        let frame = Frame::new(&x, &y, true, 0.0);
        // One cell has but one corner without a value: half of it is left.
        assert_eq!(field.triangles(&frame).len(), 2 * (100 - 9) + 1);
        let text = field.draw(&frame).into_string();
        assert!(text.matches("<path fill").count() >= 5 && !text.contains("NaN"));
        let lines = text.split("class=\"level\" d=\"").nth(1).unwrap().split('"').next().unwrap();
        assert_eq!(lines.matches('M').count(), levels.steps - 1, "{lines}");
    }
}
