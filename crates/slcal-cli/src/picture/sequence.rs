//! What was decoded of a sequence, pixel by pixel, over its photograph under white.

use image::{DynamicImage, RgbImage};
use slcal_core::decode::SequenceDecodeReport;
use slcal_core::{DenseMatches, PointCloud};

use super::drawing::Drawing;
use super::drawing::color::{Color, VERMILLION, WHITE, luma, mix, ramp};
use super::drawing::legend::{Legend, Swatch};
use super::stripes::{reach_mm, thousands};
use crate::name::short;
use crate::quantile::Sorted;

/// Share of the photograph's light that is left below the colours.
const LIGHT_KEPT: f64 = 0.45;
/// Share of a colour that lies over it.
const COVER: f64 = 0.65;
/// Lines of equal coordinate across what is seen, about: enough to see where they bend, few enough to be told apart.
const LINES: f32 = 16.0;
/// Share of the values at either end that the ramp leaves out.
const STRAY_SHARE: f64 = 0.005;
/// A line is a pixel wide for so many pixels of the image's longer side.
const LINE_PER_PX: u32 = 1600;
/// A pixel is lit where white is lighter than black by this many σ of their difference, as the decoder has it.
const LIT_SIGMAS: f64 = 5.0;
/// Of a photograph without a white one: what lies below the colours.
const GROUND: Color = [40; 3];

/// Photographs of a scan under white and black, as far as it has them.
#[derive(Debug, Default)]
pub(crate) struct UnderLight {
    pub(crate) white: Option<DynamicImage>,
    pub(crate) black: Option<DynamicImage>,
}

/// A picture of all pixels, and what is drawn over it: its legend.
pub(crate) struct PixelMap {
    pub(crate) picture: DynamicImage,
    pub(crate) drawing: Drawing,
    /// What the colours mean, as a sentence for a caption.
    pub(crate) words: String,
}

/// Coordinates of the panel as colours, with lines at every so many of them, and lit pixels without any.
///
/// Of columns and rows that are both coded, the columns have the colours, and both have lines.
pub(crate) fn decoded_map(
    name: &str,
    matches: &DenseMatches,
    report: &SequenceDecodeReport,
    light: &UnderLight,
) -> PixelMap {
    let axes = [("columns", &matches.column), ("rows", &matches.row)];
    let coded: Vec<_> = axes.into_iter().filter(|(_, values)| !values.is_empty()).collect();
    let size = [matches.width as u32, matches.height as u32];
    let mut picture = ground(size, light.white.as_ref());
    let lit = lit_pixels(light, report.noise);
    let mut parts = Vec::new();
    if let Some((axis, values)) = coded.first() {
        let [low, high] = range(values);
        for (i, pixel) in picture.pixels_mut().enumerate() {
            let cover = if values[i].is_finite() {
                ramp(share(f64::from(values[i]), [low, high]))
            } else if lit.get(i).is_some_and(|lit| *lit) {
                VERMILLION
            } else {
                continue;
            };
            pixel.0 = mix(pixel.0, cover, COVER);
        }
        parts.push(format!("{axis} {low:.0} … {high:.0} of the projector"));
    }
    for (axis, values) in &coded {
        let step = line_step(range(values));
        draw_lines(&mut picture, values, matches.width, step);
        parts.push(format!("a line every {step} {axis}"));
    }
    let words = parts.join(", ");
    let name = short(name);
    let mut legend = Legend::new(format!("{name}: {}", counted(report))).entry(Swatch::Ramp, words.clone());
    if report.undecided + report.contradicting > 0 {
        let text = format!(
            "lit without a position: undecided {}, contradicting {}",
            thousands(report.undecided),
            thousands(report.contradicting)
        );
        legend = if lit.is_empty() {
            legend.note(text)
        } else {
            legend.entry(Swatch::Colors(vec![mix(GROUND, VERMILLION, COVER)]), text)
        };
    }
    finished(picture, format!("{name}: decoded sequence"), legend, words)
}

/// Points of a cloud as colours of their distance from the camera; near is light.
pub(crate) fn distance_map(name: &str, cloud: &PointCloud, size: [u32; 2], light: &UnderLight) -> PixelMap {
    let mut picture = ground(size, light.white.as_ref());
    let [near, far] = reach_mm(cloud);
    for (point, distance) in cloud.points.iter().zip(cloud.distances_mm()) {
        let [x, y] = [point.pixel.x, point.pixel.y].map(f64::round);
        if x >= 0.0 && y >= 0.0 && x < f64::from(size[0]) && y < f64::from(size[1]) {
            let pixel = picture.get_pixel_mut(x as u32, y as u32);
            pixel.0 = mix(pixel.0, ramp(1.0 - share(distance, [near, far])), COVER);
        }
    }
    let decimals = usize::from(far - near < 10.0);
    let words = format!("{far:.decimals$} … {near:.decimals$} mm from the camera");
    let name = short(name);
    let title = format!("{name}: {} points", thousands(cloud.points.len()));
    let legend = Legend::new(title).entry(Swatch::Ramp, words.clone());
    finished(picture, format!("{name}: distances of the points"), legend, words)
}

fn finished(picture: RgbImage, title: String, legend: Legend, words: String) -> PixelMap {
    let mut drawing = Drawing::new([picture.width(), picture.height()], title);
    drawing.legend = Some(legend);
    PixelMap { picture: DynamicImage::ImageRgb8(picture), drawing, words }
}

/// How many of the lit pixels have a position.
pub(crate) fn counted(report: &SequenceDecodeReport) -> String {
    format!("{} of {} lit pixels decoded", thousands(report.decoded), thousands(report.lit))
}

/// The photograph in dark grey.
fn ground([width, height]: [u32; 2], white: Option<&DynamicImage>) -> RgbImage {
    let Some(white) = white.filter(|w| [w.width(), w.height()] == [width, height]) else {
        return RgbImage::from_pixel(width, height, image::Rgb(GROUND));
    };
    let mut picture = white.to_rgb8();
    for pixel in picture.pixels_mut() {
        pixel.0 = [(LIGHT_KEPT * luma(pixel.0.map(f64::from))).round() as u8; 3];
    }
    picture
}

/// Which pixels the projector lights; empty where white or black was not photographed. `noise` is that of a level, as a share of white.
fn lit_pixels(light: &UnderLight, noise: f64) -> Vec<bool> {
    let (Some(white), Some(black)) = (&light.white, &light.black) else { return Vec::new() };
    let least = LIT_SIGMAS * std::f64::consts::SQRT_2 * noise * f64::from(u16::MAX);
    let [white, black] = [white, black].map(DynamicImage::to_luma16);
    let levels = white.pixels().zip(black.pixels());
    levels.map(|(w, b)| f64::from(w.0[0]) - f64::from(b.0[0]) > least).collect()
}

/// The range of finite values without strays.
fn range(values: &[f32]) -> [f64; 2] {
    let finite = values.iter().filter(|x| x.is_finite()).map(|x| f64::from(*x));
    Sorted::new(finite).range([STRAY_SHARE, 1.0 - STRAY_SHARE])
}

fn share(x: f64, [low, high]: [f64; 2]) -> f64 {
    if high > low { ((x - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 }
}

/// A power of two, so that lines are borders of the code.
fn line_step([low, high]: [f64; 2]) -> u32 {
    let wanted = ((high - low) as f32 / LINES).max(1.0);
    1 << (wanted.log2().round() as u32).min(12)
}

/// Whitens pixels at which a multiple of `step` lies between a pixel and its right or lower neighbour.
fn draw_lines(picture: &mut RgbImage, values: &[f32], width: usize, step: u32) {
    let (w, h) = picture.dimensions();
    let thick = (w.max(h) / LINE_PER_PX).max(1);
    let band = |i: usize| values.get(i).filter(|x| x.is_finite()).map(|x| (x / step as f32).floor());
    for y in 0..h {
        for x in 0..w {
            let i = y as usize * width + x as usize;
            let Some(here) = band(i) else { continue };
            let right = (x + 1 < w).then(|| band(i + 1)).flatten();
            let below = band(i + width);
            // A larger step is a jump of depth, along which no line runs.
            let crosses = |there: Option<f32>| there.is_some_and(|there| (there - here).abs() == 1.0);
            if crosses(right) || crosses(below) {
                for (dx, dy) in (0..thick).flat_map(|dx| (0..thick).map(move |dy| (dx, dy))) {
                    if x + dx < w && y + dy < h {
                        picture.get_pixel_mut(x + dx, y + dy).0 = WHITE;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use image::{GrayImage, Luma};

    use super::*;

    #[test]
    fn columns_are_colours_with_lines_and_what_is_lit_without_one_is_marked() {
        let (width, height) = (64_usize, 8_usize);
        let column = (0..width * height).map(|i| match i % width {
            x if x < 48 => 4.0 * x as f32 + 1.0,
            _ => f32::NAN,
        });
        let matches = DenseMatches { width, height, column: column.collect(), ..DenseMatches::default() };
        let under = |level: &dyn Fn(u32) -> u8| {
            Some(DynamicImage::ImageLuma8(GrayImage::from_fn(64, 8, |x, _| Luma([level(x)]))))
        };
        // Columns 48 to 55 of the image are lit and were not decoded; those after them are dark.
        let light = UnderLight { white: under(&|x| if x < 56 { 200 } else { 20 }), black: under(&|_| 20) };
        let mut report = SequenceDecodeReport::default();
        (report.lit, report.decoded, report.undecided, report.noise) = (56 * 8, 48 * 8, 8 * 8, 1.0 / 255.0);
        let map = decoded_map("scan", &matches, &report, &light);
        let picture = map.picture.to_rgb8();
        let at = |x: u32| picture.get_pixel(x, 3).0;
        // A line is seen where the next multiple begins.
        assert!(
            map.words.contains("a line every 16 columns") && map.words.contains("columns 1 … 189"),
            "{}",
            map.words
        );
        let white: Vec<u32> = (0..64).filter(|x| at(*x) == WHITE).collect();
        assert_eq!(white, (3..47).step_by(4).collect::<Vec<u32>>());
        let bright = |c: Color| luma(c.map(f64::from));
        assert!(
            bright(at(40)) > bright(at(2)) && at(50)[0] > 150 && at(50)[2] < 60,
            "{:?} {:?}",
            at(40),
            at(50)
        );
        assert_eq!(at(60), [9; 3]);
        let legend = map.drawing.legend.unwrap();
        assert!(legend.title.contains("384 of 448 lit pixels decoded"), "{}", legend.title);
        assert!(legend.entries.iter().any(|e| e.text.contains("undecided 64")));
        // Without photographs under white and black nothing is known of the others.
        let map = decoded_map("scan", &matches, &report, &UnderLight::default());
        assert_eq!(map.picture.to_rgb8().get_pixel(50, 3).0, GROUND);
    }
}
