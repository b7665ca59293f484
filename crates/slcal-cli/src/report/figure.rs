//! Plots for plotly.js, with their text alternatives.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};
use serde::Serialize;
use serde_json::{Value, json};

/// A plot: plotly's traces and layout. A text that begins with `$` is the name of one of the page's colours, so that plots
/// follow the light and the dark.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Figure {
    id: &'static str,
    data: Vec<Value>,
    layout: Value,
    /// Whether it is a 3D plot: those rotate, zoom and are printed as pictures.
    space: bool,
    /// What the reader may choose between.
    choices: Vec<Choice>,
    #[serde(skip)]
    choices_title: &'static str,
}

/// A choice of the reader: a change to some traces.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Choice {
    pub(super) label: &'static str,
    /// Indices of the traces that change.
    pub(super) traces: Vec<usize>,
    /// What plotly is to change about them.
    pub(super) change: Value,
}

/// The plots of a report, in the order in which they are drawn.
#[derive(Debug, Default)]
pub(super) struct Figures(Vec<Figure>);

impl Figures {
    /// Takes a flat plot and gives the place where it will be drawn. `alt` says in words what it shows.
    pub(super) fn flat(&mut self, id: &'static str, alt: &str, data: Vec<Value>, layout: Value) -> Markup {
        self.chosen(id, alt, data, layout, "", Vec::new())
    }

    /// The same with choices and their title.
    pub(super) fn chosen(
        &mut self,
        id: &'static str,
        alt: &str,
        data: Vec<Value>,
        layout: Value,
        choices_title: &'static str,
        choices: Vec<Choice>,
    ) -> Markup {
        self.add(Figure { id, data, layout, space: false, choices, choices_title }, alt)
    }

    /// The same for a 3D plot.
    pub(super) fn space(
        &mut self,
        id: &'static str,
        alt: &str,
        data: Vec<Value>,
        layout: Value,
        choices: Vec<Choice>,
    ) -> Markup {
        let choices_title = "Colour of the points";
        self.add(Figure { id, data, layout, space: true, choices, choices_title }, alt)
    }

    fn add(&mut self, figure: Figure, alt: &str) -> Markup {
        let markup = html! {
            @if !figure.choices.is_empty() {
                div.choices.screen-only role="group" aria-label=(figure.choices_title) data-for=(figure.id) hidden {
                    @for (i, choice) in figure.choices.iter().enumerate() {
                        button type="button" data-choice=(i) aria-pressed=(if i == 0 { "true" } else { "false" }) {
                            (choice.label)
                        }
                    }
                }
            }
            div.plot.space[figure.space] id=(figure.id) role="img" aria-label=(alt) {}
        };
        self.0.push(figure);
        markup
    }

    /// Whether nothing is to be drawn.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All of them as JSON that can stand in a script element.
    pub(super) fn json(&self) -> String {
        serde_json::to_string(&self.0).unwrap_or_else(|_| "[]".to_owned()).replace('<', "\\u003c")
    }
}

/// Numbers for plots: 16 bits each between the smallest and the largest, a fifth of their size as text. Numbers that are not finite
/// become gaps.
pub(super) fn packed(values: &[f64]) -> Value {
    const STEPS: f64 = 65_534.0;
    /// Stands for "no number".
    const GAP: u16 = u16::MAX;
    let finite = values.iter().copied().filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let step = if high > low { (high - low) / STEPS } else { 0.0 };
    let low = if low.is_finite() { low } else { 0.0 };
    let code = |x: &f64| match *x {
        x if !x.is_finite() => GAP,
        x if step > 0.0 => ((x - low) / step).round() as u16,
        _ => 0,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|x| code(x).to_le_bytes()).collect();
    json!({ "packed": "u16", "low": low, "step": step, "data": STANDARD.encode(bytes) })
}

/// Indices, packed as they are: 16 bits where that is enough.
pub(super) fn packed_indices(values: &[u32]) -> Value {
    let wide = values.iter().any(|i| *i > u32::from(u16::MAX));
    let bytes: Vec<u8> = if wide {
        values.iter().flat_map(|i| i.to_le_bytes()).collect()
    } else {
        values.iter().flat_map(|i| (*i as u16).to_le_bytes()).collect()
    };
    json!({ "packed": if wide { "index32" } else { "index16" }, "data": STANDARD.encode(bytes) })
}

/// sRGB colours, packed.
pub(super) fn packed_colours(values: impl Iterator<Item = [u8; 3]>) -> Value {
    let bytes: Vec<u8> = values.flatten().collect();
    json!({ "packed": "rgb", "data": STANDARD.encode(bytes) })
}

/// The layout that all flat plots share: `x` and `y` are plotly's axes.
pub(super) fn flat_layout(x: Value, y: Value) -> Value {
    json!({
        "xaxis": axis(x), "yaxis": axis(y),
        "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)",
        "font": { "family": "system-ui, sans-serif", "size": 13, "color": "$ink" },
        "margin": { "l": 58, "r": 14, "t": 12, "b": 46 },
        "legend": { "orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom" },
        "hoverlabel": { "bgcolor": "$panel", "bordercolor": "$line", "font": { "color": "$ink" } },
        "dragmode": false,
    })
}

fn axis(own: Value) -> Value {
    let mut axis = json!({
        "gridcolor": "$line", "linecolor": "$line", "zerolinecolor": "$line", "automargin": true, "fixedrange": true,
        "ticks": "outside", "tickcolor": "$line",
    });
    if let (Some(axis), Value::Object(own)) = (axis.as_object_mut(), own) {
        axis.extend(own);
    }
    axis
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_packed_to_their_range() {
        let packed = packed(&[1.0, f64::NAN, 3.0, 2.0]);
        let bytes = STANDARD.decode(packed["data"].as_str().unwrap()).unwrap();
        let codes: Vec<u16> = bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        assert_eq!(codes, [0, 65_535, 65_534, 32_767]);
        let step = packed["step"].as_f64().unwrap();
        assert!((packed["low"].as_f64().unwrap() + 32_767.0 * step - 2.0).abs() < step);
        // All alike, none at all.
        assert_eq!(super::packed(&[5.0, 5.0])["low"], 5.0);
        assert_eq!(super::packed(&[])["data"], "");
        assert_eq!(packed_indices(&[1, 70_000])["packed"], "index32");
        assert_eq!(packed_indices(&[1, 65_535])["packed"], "index16");
    }

    #[test]
    fn json_cannot_end_the_script_that_holds_it() {
        let mut figures = Figures::default();
        let trace = json!({ "name": "</script><!-- <script>alert(1)" });
        let place = figures.flat("id", "\"><script>", vec![trace], json!({}));
        assert!(!figures.json().contains('<'));
        assert!(!place.into_string().contains("<script>"));
    }
}
