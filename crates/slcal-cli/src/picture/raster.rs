//! A drawing painted upon its photograph.

use image::{DynamicImage, RgbImage};
use nalgebra::Point2;
use skrifa::outline::OutlinePen;
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, PixmapMut, Stroke, StrokeDash, Transform,
};

use super::color::{BLACK, Color, luma};
use super::drawing::{Anchor, Drawing, Item, Pen, Shape};
use super::font::{CAPITALS, Font};
use super::style;
use crate::exit::{Exit, Failure, Outcome};

/// See [`Drawing::over`].
pub(super) fn over(drawing: &Drawing, photo: &DynamicImage) -> Outcome<DynamicImage> {
    let mut pixels = background(drawing, photo);
    let (w, h) = pixels.dimensions();
    let unpaintable = || {
        Failure::new(Exit::Other, format!("a picture of {w}x{h} pixels is too large or too small to draw on"))
    };
    let mut canvas = PixmapMut::from_bytes(&mut pixels, w, h).ok_or_else(unpaintable)?;
    let scale =
        [f64::from(w) / f64::from(drawing.size[0].max(1)), f64::from(h) / f64::from(drawing.size[1].max(1))];
    let mut painter = Painter {
        canvas: &mut canvas,
        // Pixel centres are integers in the drawing, and halves on the canvas.
        place: Transform::from_translate(0.5, 0.5).post_scale(scale[0] as f32, scale[1] as f32),
        unit: drawing.unit(),
        font: Font::embedded(),
    };
    for item in drawing.all_items() {
        painter.item(&item);
    }
    let rgb = without_alpha(pixels.into_raw());
    RgbImage::from_raw(w, h, rgb).map(DynamicImage::ImageRgb8).ok_or_else(unpaintable)
}

/// The photograph, opaque, at the size of the picture.
fn background(drawing: &Drawing, photo: &DynamicImage) -> image::RgbaImage {
    let mut pixels = photo.to_rgba8();
    for pixel in pixels.pixels_mut() {
        pixel.0[3] = u8::MAX;
    }
    if drawing.dimmed {
        pixels.pixels_mut().for_each(|p| dim(&mut p.0));
    }
    match drawing.enlarged() {
        1 => pixels,
        // Pixels stay squares: what the camera saw, not an invention between.
        k => image::imageops::resize(
            &pixels,
            pixels.width() * k,
            pixels.height() * k,
            image::imageops::FilterType::Nearest,
        ),
    }
}

/// Takes light and colour from a pixel.
fn dim([r, g, b, _]: &mut [u8; 4]) {
    let grey = luma([*r, *g, *b].map(f64::from));
    for c in [r, g, b] {
        let color = style::COLOR_KEPT * f64::from(*c) + (1.0 - style::COLOR_KEPT) * grey;
        *c = (style::LIGHT_KEPT * color).round() as u8;
    }
}

/// The same pixels with three bytes each, in the same memory.
fn without_alpha(mut rgba: Vec<u8>) -> Vec<u8> {
    let count = rgba.len() / 4;
    for i in 0..count {
        rgba.copy_within(4 * i..4 * i + 3, 3 * i);
    }
    rgba.truncate(3 * count);
    rgba
}

struct Painter<'a, 'b> {
    canvas: &'a mut PixmapMut<'b>,
    place: Transform,
    unit: f64,
    font: Font,
}

impl Painter<'_, '_> {
    fn item(&mut self, item: &Item) {
        let pen = &item.pen;
        match &item.shape {
            Shape::Text { at, text, size, anchor } => self.text((*at, text.as_str(), *size, *anchor), pen),
            Shape::Lines(_) | Shape::Rings(..) => {
                let Some(path) = path(&item.shape) else { return };
                if pen.halo {
                    let opacity = style::HALO_OPACITY * pen.opacity;
                    self.stroke(&path, BLACK, style::halo_width(pen, self.unit), opacity, pen.dashed);
                }
                self.stroke(&path, pen.color, pen.width * self.unit, pen.opacity, pen.dashed);
            }
            Shape::Areas(_) | Shape::Dots(..) => {
                let Some(path) = path(&item.shape) else { return };
                if pen.halo {
                    let opacity = style::HALO_OPACITY * pen.opacity;
                    self.stroke(&path, BLACK, style::HALO * self.unit, opacity, false);
                }
                self.fill(&path, pen.color, pen.opacity);
            }
        }
    }

    fn text(&mut self, (at, text, size, anchor): (Point2<f64>, &str, f64, Anchor), pen: &Pen) {
        let back = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * self.font.width(text, size),
            Anchor::End => self.font.width(text, size),
        };
        let start = Point2::new(at.x - back, at.y + 0.5 * CAPITALS * size);
        let mut outline = Outline(PathBuilder::new());
        self.font.draw(text, start, size, &mut outline);
        let Some(path) = outline.0.finish() else { return };
        if pen.halo {
            self.stroke(&path, BLACK, style::TEXT_HALO * size, style::TEXT_HALO_OPACITY, false);
        }
        self.fill(&path, pen.color, pen.opacity);
    }

    fn fill(&mut self, path: &Path, color: Color, opacity: f64) {
        self.canvas.fill_path(path, &paint(color, opacity), FillRule::Winding, self.place, None);
    }

    fn stroke(&mut self, path: &Path, color: Color, width: f64, opacity: f64, dashed: bool) {
        let dash = style::DASHES.map(|d| (d * self.unit) as f32).to_vec();
        let stroke = Stroke {
            width: width as f32,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            dash: if dashed { StrokeDash::new(dash, 0.0) } else { None },
            ..Stroke::default()
        };
        self.canvas.stroke_path(path, &paint(color, opacity), &stroke, self.place, None);
    }
}

fn paint([r, g, b]: Color, opacity: f64) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, (255.0 * opacity.clamp(0.0, 1.0)).round() as u8);
    paint
}

fn path(shape: &Shape) -> Option<Path> {
    let mut builder = PathBuilder::new();
    match shape {
        Shape::Lines(parts) | Shape::Areas(parts) => {
            for part in parts {
                for (i, p) in part.iter().enumerate() {
                    let (x, y) = (p.x as f32, p.y as f32);
                    if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
                }
                if matches!(shape, Shape::Areas(_)) {
                    builder.close();
                }
            }
        }
        Shape::Dots(centres, radius) | Shape::Rings(centres, radius) => {
            for c in centres {
                builder.push_circle(c.x as f32, c.y as f32, *radius as f32);
            }
        }
        Shape::Text { .. } => {}
    }
    builder.finish()
}

/// The outline of letters.
struct Outline(PathBuilder);

impl OutlinePen for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }
    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.0.quad_to(cx, cy, x, y);
    }
    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.0.cubic_to(ax, ay, bx, by, x, y);
    }
    fn close(&mut self) {
        self.0.close();
    }
}
