//! A scan by a sequence: maps of its pixels, σ of their positions, and the counts of decoding.

use maud::{Markup, html};
use slcal_core::decode::SequenceDecodeReport;
use slcal_core::{DenseMatches, Reconstruction};

use super::number::{derived, fixed};
use super::page::Section;
use super::photo::Photo;
use super::plot::Colour;
use super::point_statistics::histogram;
use crate::exit::Outcome;
use crate::picture::Drawing;
use crate::picture::sequence::{PixelMap, UnderLight, counted, decoded_map, distance_map};
use crate::picture::stripes::thousands;

/// White of 8 bit: noise and contrast are told in its code values.
const CODE_VALUES: f64 = 255.0;
/// σ of about this many pixels make the histogram.
const SAMPLE: usize = 1 << 18;

/// Maps and σ of a scan.
pub(crate) struct SequenceMaps {
    maps: Vec<Map>,
    /// Which coordinates, and σ of a sample of them, panel px.
    sigmas: Vec<(&'static str, Vec<f64>)>,
}

struct Map {
    photo: Photo,
    /// Empty: the page has its own words.
    drawing: Drawing,
    words: String,
}

impl SequenceMaps {
    /// Draws them.
    pub(crate) fn new(
        name: &str,
        result: &Reconstruction,
        matches: &DenseMatches,
        light: &UnderLight,
    ) -> Outcome<Self> {
        let size = [matches.width as u32, matches.height as u32];
        let mut maps = Vec::new();
        if let Some(report) = result.sequence() {
            let decoded = decoded_map(name, matches, report, light);
            let words = format!(
                "Where each pixel lies on the projector’s panel: {}. Orange pixels are lit and have no certain position. {}.",
                decoded.words,
                counted(report)
            );
            maps.push(Map::new(decoded, words)?);
        }
        let distances = distance_map(name, &result.cloud, size, light);
        let words = format!("Distance of the points: {}. Light is near, dark is far.", distances.words);
        maps.push(Map::new(distances, words)?);
        let of_axis = [("column", &matches.sigma_column), ("row", &matches.sigma_row)];
        let sigmas = of_axis.into_iter().filter(|(_, values)| !values.is_empty());
        let sample = |values: &Vec<f32>| {
            let step = values.len().div_ceil(SAMPLE).max(1);
            values.iter().step_by(step).filter(|x| x.is_finite()).map(|x| f64::from(*x)).collect()
        };
        Ok(Self { maps, sigmas: sigmas.map(|(axis, values)| (axis, sample(values))).collect() })
    }

    /// The maps.
    pub(super) fn section(&self) -> Section {
        let content = html! {
            div.photos { @for map in &self.maps {
                figure {
                    (map.photo.under(&map.drawing))
                    figcaption { (map.words) }
                }
            } }
        };
        Section { id: "photographs", title: "Pixels", content }
    }

    /// σ of the positions on the panel.
    fn sigmas(&self) -> Markup {
        html! {
            div.pair { @for (axis, values) in &self.sigmas {
                figure {
                    (histogram(
                        &format!("sigma-{axis}"),
                        &format!("1σ of the projector {axis} of the pixels."),
                        values,
                        (&format!("1σ of the {axis}, px of the projector"), "px"),
                        Colour::Noise,
                    ))
                    figcaption { "1σ of the projector " (axis) " of a pixel, from the noise of the camera and the contrast of the pictures." }
                }
            } }
        }
    }
}

impl Map {
    fn new(map: PixelMap, words: String) -> Outcome<Self> {
        let photo = Photo::new(&map.picture, 1)?;
        let mut drawing = map.drawing;
        drawing.legend = None;
        Ok(Self { photo, drawing, words })
    }
}

/// Counts of decoding, noise and contrast.
pub(super) fn decoding(report: &SequenceDecodeReport, maps: Option<&SequenceMaps>) -> Section {
    let share = |n: usize| 100.0 * n as f64 / report.lit.max(1) as f64;
    let counts = [
        ("lit", report.lit, "the projector’s light is seen"),
        ("decoded", report.decoded, "became matches"),
        (
            "undecided",
            report.undecided,
            "bits without contrast, or no amplitude of the sinusoid: shadows, light from elsewhere",
        ),
        (
            "contradicting",
            report.contradicting,
            "bits that mean no place on the panel, or contradict the sinusoid",
        ),
    ];
    let position = |axis: &'static str, sigma: Option<f64>| {
        sigma.map(|s| (axis, fixed(s, 3), "px of the projector", "1σ of half of the pixels is smaller"))
    };
    let measures = [
        Some((
            "Noise of a pixel in a frame",
            fixed(CODE_VALUES * report.noise, 1),
            "levels of 255",
            "above 4: use more light or a lower gain",
        )),
        report.contrast.map(|contrast| {
            let judge = "below 40: use more light or a longer exposure";
            ("White less black", fixed(CODE_VALUES * contrast, 0), "levels of 255", judge)
        }),
        position("σ of a column, median", report.median_sigma_column_px),
        position("σ of a row, median", report.median_sigma_row_px),
    ];
    let content = html! {
        h3 { (thousands(report.pixels)) " pixels in " (report.frames) " photographs" }
        div.scroll { table {
            thead { tr {
                th scope="col" { "" } th.number scope="col" { "pixels" } th.number scope="col" { "% of the lit" } th scope="col" { "reason" }
            } }
            tbody { @for (name, count, why) in counts {
                tr {
                    th scope="row" { (name) }
                    td.number { (derived(&format!("sequence.{name}"), count as f64, &thousands(count))) }
                    td.number { (fixed(share(count), 1)) }
                    td.aside { (why) }
                }
            } }
        } }
        h3 { "The photographs" }
        div.scroll { table {
            thead { tr { th scope="col" { "" } th.number scope="col" { "value" } th scope="col" { "unit" } th scope="col" { "guide" } } }
            tbody { @for (name, value, unit, judge) in measures.into_iter().flatten() {
                tr { th scope="row" { (name) } td.number { (value) } td.aside { (unit) } td.aside { (judge) } }
            } }
        } }
        @if let Some(maps) = maps { (maps.sigmas()) }
    };
    Section { id: "decoding", title: "Decoding", content }
}
