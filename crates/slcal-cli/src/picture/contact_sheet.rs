//! Several photographs on one picture, each with its drawing and its name.

use image::{DynamicImage, GenericImage as _, Rgb, RgbImage};
use nalgebra::{Point2, Vector2};

use super::drawing::color::{Color, VERMILLION, WHITE};
use super::drawing::font::Font;
use super::drawing::legend::Legend;
use super::drawing::legend_placement;
use super::drawing::{Anchor, Drawing, Pen};
use crate::exit::{Exit, Failure, Outcome};

/// Approximate longer side of the picture, px: a large screen.
const WHOLE_PX: u32 = 2400;
/// Least width of each photograph, px.
const LEAST_WIDTH_PX: u32 = 320;
const GREY: Color = [34, 34, 34];
/// Gap between and around the photographs, as a share of their width.
const GAP_SHARE: f64 = 0.02;
/// Size of captions as a share of the width of a photograph.
const TEXT_SHARE: f64 = 0.034;
/// Most lines of a caption.
const LINES: usize = 4;
const LEADING: f64 = 1.35;

/// A photograph on the sheet.
pub(crate) struct Tile {
    /// With its drawing; all tiles have the same size.
    pub(crate) picture: DynamicImage,
    /// The caption below: name, residuals.
    pub(crate) caption: Vec<String>,
    /// Why this one stands out, when it does.
    pub(crate) odd: Option<String>,
}

fn columns(count: usize) -> usize {
    (count as f64).sqrt().ceil().max(1.0) as usize
}

/// The size in which `count` photographs of a size are put on the sheet, and how much coarser lines are drawn on them so
/// that they show there.
pub(crate) fn tile_size(size: [u32; 2], count: usize) -> ([u32; 2], f64) {
    let columns = columns(count);
    let width = (WHOLE_PX / columns as u32).max(LEAST_WIDTH_PX).min(size[0].max(1));
    let height = (f64::from(size[1]) * f64::from(width) / f64::from(size[0].max(1))).round().max(1.0) as u32;
    ([width, height], (0.6 * columns as f64).max(1.0))
}

/// All photographs, row by row, and a legend for all of them beneath.
pub(crate) fn sheet(tiles: &[Tile], title: &str, legend: &Legend) -> Outcome<DynamicImage> {
    let [w, h] = tiles.first().map_or([1, 1], |t| [t.picture.width(), t.picture.height()]);
    let columns = columns(tiles.len());
    let rows = tiles.len().div_ceil(columns);
    let gap = (GAP_SHARE * f64::from(w)).ceil() as u32;
    let text = TEXT_SHARE * f64::from(w);
    let captions: Vec<_> = tiles.iter().map(|tile| caption(tile, f64::from(w), text)).collect();
    let lines = captions.iter().map(Vec::len).max().unwrap_or(0);
    let below = (LEADING * text * (lines as f64 + 0.5)).ceil() as u32;
    let width = columns as u32 * (w + gap) + gap;
    let above_legend = rows as u32 * (h + below + gap) + gap;
    // Its unit follows the width alone, which is known already.
    let unit = Drawing::new([width, 1], "").unit();
    let corner = Point2::new(f64::from(gap), f64::from(above_legend));
    let placed = legend_placement::at(legend, unit, f64::from(width - 2 * gap), corner);
    let height = (placed.panel.high.y + f64::from(gap)).ceil() as u32;

    let mut canvas = RgbImage::from_pixel(width, height, Rgb(GREY));
    let mut drawing = Drawing::new([width, height], title);
    for (i, tile) in tiles.iter().enumerate() {
        let at = [(i % columns) as u32 * (w + gap) + gap, (i / columns) as u32 * (h + below + gap) + gap];
        canvas.copy_from(&tile.picture.to_rgb8(), at[0], at[1]).map_err(|e| {
            Failure::new(Exit::Other, format!("photographs of one size do not fit a sheet: {e}"))
        })?;
        let low = Point2::from(at.map(f64::from)) - Vector2::new(0.5, 0.5);
        let size = Vector2::new(f64::from(w), f64::from(h));
        if tile.odd.is_some() {
            let corners =
                [low, Point2::new(low.x + size.x, low.y), low + size, Point2::new(low.x, low.y + size.y)];
            drawing.outline(&corners, Pen::new(VERMILLION).width(3.0));
        }
        for (k, (line, color)) in captions[i].iter().enumerate() {
            let at = low + Vector2::new(0.0, size.y + LEADING * text * (k as f64 + 0.75));
            drawing.words(at, line.clone(), text, Anchor::Start, Pen::new(*color).plain());
        }
    }
    drawing.items.extend(placed.items);
    drawing.over(&DynamicImage::ImageRgb8(canvas))
}

/// The lines beneath a photograph, each with its colour.
fn caption(tile: &Tile, width: f64, size: f64) -> Vec<(String, Color)> {
    let font = Font::embedded();
    let odd = tile.odd.iter().map(|t| (t, VERMILLION));
    let lines = tile.caption.iter().map(|t| (t, WHITE)).chain(odd);
    let wrapped = lines
        .flat_map(|(text, color)| font.wrap(text, size, width).into_iter().map(move |line| (line, color)));
    wrapped.take(LINES).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photographs_stand_in_rows_and_the_odd_one_is_framed() {
        let colors = [[200, 0, 0], [0, 200, 0], [0, 0, 200]];
        let tile = |i: usize| Tile {
            picture: DynamicImage::ImageRgb8(RgbImage::from_pixel(400, 300, Rgb(colors[i]))),
            caption: vec![format!("{i}.jpg"), "sides 0.05 px".to_owned()],
            odd: (i == 1).then(|| "fits 4 times worse than the others".to_owned()),
        };
        let tiles: Vec<_> = (0..3).map(tile).collect();
        let legend = Legend::new("3 photographs").note("n");
        let picture = sheet(&tiles, "t", &legend).unwrap().to_rgb8();
        let middle = |column: u32, y: u32| picture.get_pixel(8 + column * 408 + 200, y).0;
        assert_eq!([middle(0, 150), middle(1, 150)], [colors[0], colors[1]]);
        assert_eq!(picture.width(), 2 * 408 + 8);
        assert!((300..700).any(|y| middle(0, y) == colors[2]));
        let frame = |x: u32| picture.get_pixel(x, 150).0;
        assert!((410..420).any(|x| frame(x) == VERMILLION) && (2..12).all(|x| frame(x) != VERMILLION));
    }

    #[test]
    fn a_hundred_large_photographs_stay_a_picture_that_can_be_opened() {
        for count in [1, 2, 3, 9, 100] {
            let ([w, h], coarser) = tile_size([6000, 4000], count);
            assert!(u64::from(w) * u64::from(h) * count as u64 <= 12_000_000, "{count}: {w}x{h}");
            assert!(coarser >= 1.0);
        }
        assert_eq!(tile_size([64, 48], 4), ([64, 48], 1.2));
        assert!(sheet(&[], "", &Legend::default()).is_ok());
    }
}
