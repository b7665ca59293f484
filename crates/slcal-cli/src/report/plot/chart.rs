//! A plot: axes, marks and legend.

use maud::{Markup, html};

use super::axis::Axis;
use super::colour_bar::{ColourBar, ROOM};
use super::frame::{Frame, WIDTH};
use super::mark::{Colour, Key, Mark};
use super::ticks::Tick;
use crate::picture::Number;

/// Marks of one colour.
struct Group {
    colour: Colour,
    mark: Box<dyn Mark>,
}

/// A plot with both axes.
pub(crate) struct Plot {
    x: Axis,
    y: Axis,
    to_scale: bool,
    groups: Vec<Group>,
    legend: Vec<(Key, Colour, String)>,
    colour_bar: Option<ColourBar>,
}

impl Plot {
    pub(crate) fn new(x: Axis, y: Axis) -> Self {
        Self { x, y, to_scale: false, groups: Vec::new(), legend: Vec::new(), colour_bar: None }
    }

    /// With units that are as long on both axes.
    pub(crate) fn with_equal_units(self) -> Self {
        Self { to_scale: true, ..self }
    }

    /// With marks over those before.
    pub(crate) fn with(mut self, colour: Colour, mark: impl Mark + 'static) -> Self {
        self.groups.push(Group { colour, mark: Box::new(mark) });
        self
    }

    /// With marks that the legend names.
    pub(crate) fn named(
        mut self,
        name: impl Into<String>,
        key: Key,
        colour: Colour,
        mark: impl Mark + 'static,
    ) -> Self {
        self.legend.push((key, colour, name.into()));
        self.with(colour, mark)
    }

    /// With a bar at the right that says what colours mean.
    pub(crate) fn colour_bar(self, bar: ColourBar) -> Self {
        Self { colour_bar: Some(bar), ..self }
    }

    /// Its place in the page. `alt` says in words what it shows.
    pub(crate) fn markup(&self, id: &str, alt: &str) -> Markup {
        html! {
            div.plot id=(id) {
                (self.legend())
                (self.picture(alt))
            }
        }
    }

    fn legend(&self) -> Markup {
        html! {
            @if !self.legend.is_empty() {
                ul.legend { @for (key, colour, name) in &self.legend { li { (key.picture(*colour)) (name) } } }
            }
        }
    }

    fn picture(&self, alt: &str) -> Markup {
        let frame =
            Frame::new(&self.x, &self.y, self.to_scale, self.colour_bar.as_ref().map_or(0.0, |_| ROOM));
        html! {
            svg viewBox={ "0 0 " (WIDTH) " " (Number(frame.height)) } role="img" aria-label=(alt) {
                (self.grid(&frame))
                @for group in &self.groups { g class={ "plotted " (group.colour.class()) } { (group.mark.draw(&frame)) } }
                @if let Some(bar) = &self.colour_bar { (bar.draw(&frame)) }
            }
        }
    }

    /// Lines and labels at the ticks, and the titles.
    fn grid(&self, frame: &Frame) -> Markup {
        let ([left, right], [top, bottom]) = (frame.x.reach(), frame.y.reach());
        let upright =
            |t: &Tick| format!("M{} {}V{}", Number(frame.x.at(t.value)), Number(top), Number(bottom));
        let level = |t: &Tick| format!("M{} {}H{}", Number(left), Number(frame.y.at(t.value)), Number(right));
        let mut lines: String = frame.x_ticks.iter().map(upright).collect();
        lines.extend(frame.y_ticks.iter().map(level));
        html! {
            path.grid d=(lines) {}
            g.across { @for t in &frame.x_ticks { text x=(Number(frame.x.at(t.value))) y=(Number(bottom + 17.0)) { (t.label) } } }
            g.up { @for t in &frame.y_ticks { text x=(Number(left - 6.0)) y=(Number(frame.y.at(t.value) + 4.5)) { (t.label) } } }
            text.title.last x=(Number(right)) y=(Number(bottom + 36.0)) { (self.x.title) }
            text.title x="0" y="13" { (self.y.title) }
        }
    }
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::super::{Bars, Curve};
    use super::*;

    #[test]
    fn names_are_only_text_and_the_picture_is_whole() {
        let nasty = "</svg><script>alert('x')</script> & \"";
        let plot = Plot::new(Axis::even(nasty, [0.0, 10.0]), Axis::from_zero(nasty, 5.0))
            .named(nasty, Key::Bar, Colour::Cloud, Bars { width: 1.0, bars: vec![(0.5, 3), (1.5, 0)] })
            .named(
                nasty,
                Key::Line,
                Colour::Ink,
                Curve { points: vec![Some([0.0, 1.0]), None, Some([2.0, f64::NAN])], dashed: false },
            );
        let text = plot.markup("id", nasty).into_string();
        let page = Document::parse(&text).unwrap();
        assert!(!page.descendants().any(|n| n.has_tag_name("script")));
        assert!(!text.contains("NaN"));
        let svg = page.descendants().find(|n| n.attribute("role") == Some("img")).unwrap();
        assert_eq!(svg.attribute("aria-label"), Some(nasty));
        assert_eq!(
            svg.descendants().filter(|n| n.text() == Some(nasty) && n.has_tag_name("text")).count(),
            2
        );
        assert_eq!(page.descendants().filter(|n| n.has_tag_name("li")).count(), 2);
    }
}
