//! A drawing painted over its photograph.

use image::{DynamicImage, RgbImage};
use nalgebra::Point2;
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, PixmapMut, Stroke, StrokeDash, Transform,
};

use super::appearance;
use super::canvas::Drawing;
use super::color::{BLACK, Color, luma};
use super::font::{CAPITALS, Font};
use super::primitive::{Anchor, Item, Pen, Primitive};
use crate::exit::{Exit, Failure, Outcome};

impl Drawing {
    /// The photograph with the drawing over it, 8-bit RGB; a tiny photograph is enlarged.
    pub(crate) fn over(&self, photo: &DynamicImage) -> Outcome<DynamicImage> {
        over(self, photo)
    }
}

fn over(drawing: &Drawing, photo: &DynamicImage) -> Outcome<DynamicImage> {
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
        // Nearest neighbour: pixels stay squares.
        k => image::imageops::resize(
            &pixels,
            pixels.width() * k,
            pixels.height() * k,
            image::imageops::FilterType::Nearest,
        ),
    }
}

/// Dims a pixel and reduces its saturation.
fn dim([r, g, b, _]: &mut [u8; 4]) {
    let grey = luma([*r, *g, *b].map(f64::from));
    for c in [r, g, b] {
        let color = appearance::COLOR_KEPT * f64::from(*c) + (1.0 - appearance::COLOR_KEPT) * grey;
        *c = (appearance::LIGHT_KEPT * color).round() as u8;
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
        match &item.primitive {
            Primitive::Text { at, text, size, anchor } => {
                self.text((*at, text.as_str(), *size, *anchor), pen);
            }
            Primitive::Lines(_) | Primitive::Rings(..) => {
                let Some(path) = path(&item.primitive) else { return };
                if pen.halo {
                    let opacity = appearance::HALO_OPACITY * pen.opacity;
                    self.stroke(&path, BLACK, appearance::halo_width(pen, self.unit), opacity, pen.dashed);
                }
                self.stroke(&path, pen.color, pen.width * self.unit, pen.opacity, pen.dashed);
            }
            Primitive::Areas(_) | Primitive::Dots(..) => {
                let Some(path) = path(&item.primitive) else { return };
                if pen.halo {
                    let opacity = appearance::HALO_OPACITY * pen.opacity;
                    self.stroke(&path, BLACK, appearance::HALO * self.unit, opacity, false);
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
        let Some(path) = self.font.outline(text, start, size) else { return };
        if pen.halo {
            self.stroke(&path, BLACK, appearance::TEXT_HALO * size, appearance::TEXT_HALO_OPACITY, false);
        }
        self.fill(&path, pen.color, pen.opacity);
    }

    fn fill(&mut self, path: &Path, color: Color, opacity: f64) {
        self.canvas.fill_path(path, &paint(color, opacity), FillRule::Winding, self.place, None);
    }

    fn stroke(&mut self, path: &Path, color: Color, width: f64, opacity: f64, dashed: bool) {
        let dash = appearance::DASHES.map(|d| (d * self.unit) as f32).to_vec();
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

fn path(primitive: &Primitive) -> Option<Path> {
    let mut builder = PathBuilder::new();
    match primitive {
        Primitive::Lines(parts) | Primitive::Areas(parts) => {
            for part in parts {
                for (i, p) in part.iter().enumerate() {
                    let (x, y) = (p.x as f32, p.y as f32);
                    if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
                }
                if matches!(primitive, Primitive::Areas(_)) {
                    builder.close();
                }
            }
        }
        Primitive::Dots(centres, radius) | Primitive::Rings(centres, radius) => {
            for c in centres {
                builder.push_circle(c.x as f32, c.y as f32, *radius as f32);
            }
        }
        Primitive::Text { .. } => {}
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use image::{GrayImage, ImageBuffer, Luma, Rgb, RgbaImage};

    use super::*;
    use crate::picture::drawing::color::{ORANGE, WHITE};
    use crate::picture::drawing::legend::{Legend, Swatch};

    fn black(w: u32, h: u32) -> DynamicImage {
        DynamicImage::new_rgb8(w, h)
    }

    fn plain() -> Pen {
        Pen::new(WHITE).plain()
    }

    /// The centre of all light, pixel centres at integers.
    fn centroid(picture: &DynamicImage) -> Point2<f64> {
        let grey = picture.to_luma8();
        let (mut sum, mut at) = (0.0, [0.0, 0.0]);
        for (x, y, p) in grey.enumerate_pixels() {
            let weight = f64::from(p.0[0]);
            sum += weight;
            at = [at[0] + weight * f64::from(x), at[1] + weight * f64::from(y)];
        }
        Point2::new(at[0] / sum, at[1] / sum)
    }

    #[test]
    fn a_dot_lands_where_it_was_put() {
        for [w, h] in [[64, 48], [320, 240], [640, 480], [1921, 1083], [480, 3000]] {
            let mut drawing = Drawing::new([w, h], "");
            let at = Point2::new(0.35 * f64::from(w) + 0.3, 0.6 * f64::from(h) + 0.7);
            drawing.dots([at], 3.0, plain());
            let picture = drawing.over(&black(w, h)).unwrap();
            let k = drawing.enlarged();
            assert_eq!([picture.width(), picture.height()], [k * w, k * h]);
            let found = centroid(&picture);
            // Pixel x of the photograph spans k pixels around (x + 0.5) k - 0.5.
            let found = found.coords.map(|c| (c + 0.5) / f64::from(k) - 0.5);
            assert!((found - at.coords).norm() < 0.05, "{w}x{h}: {found} {at}");
        }
    }

    #[test]
    fn only_tiny_photographs_are_enlarged() {
        let enlarged = |w, h| Drawing::new([w, h], "").enlarged();
        assert_eq!(
            [enlarged(64, 48), enlarged(320, 240), enlarged(480, 100), enlarged(6000, 4000)],
            [8, 2, 1, 1]
        );
        // Letters are at least ten pixels high in the picture.
        for size in [[64, 48], [320, 240], [479, 20], [640, 480]] {
            let drawing = Drawing::new(size, "");
            assert!(14.0 * drawing.unit() * f64::from(drawing.enlarged()) > 10.0);
        }
    }

    #[test]
    fn lines_have_soft_edges() {
        let mut drawing = Drawing::new([300, 200], "");
        drawing.polyline(&[Point2::new(20.0, 30.0), Point2::new(280.0, 155.0)], plain().width(3.0));
        let picture = drawing.over(&black(300, 200)).unwrap().to_luma8();
        let between = picture.pixels().filter(|p| (40..215).contains(&p.0[0])).count();
        assert!(between > 300, "{between}");
        assert!(picture.pixels().any(|p| p.0[0] == 255));
    }

    #[test]
    fn a_line_shows_on_white_and_on_black() {
        for ground in [0_u8, 255] {
            let photo = DynamicImage::ImageLuma8(GrayImage::from_pixel(900, 600, Luma([ground])));
            let mut drawing = Drawing::new([900, 600], "");
            drawing
                .polyline(&[Point2::new(-50.0, 300.0), Point2::new(2e9, 300.0)], Pen::new(ORANGE).width(2.0));
            let picture = drawing.over(&photo).unwrap().to_rgb8();
            // On the line its colour, right across; beside it the dark outline; far from it the photograph.
            assert!((0..900).all(|x| picture.get_pixel(x, 300).0 == ORANGE));
            assert!(picture.get_pixel(450, 301).0.iter().all(|c| *c < 200));
            assert_eq!(picture.get_pixel(450, 310).0, [ground; 3]);
        }
    }

    #[test]
    fn photographs_of_every_kind_come_out_as_they_look() {
        let kinds = [
            DynamicImage::ImageLuma8(GrayImage::from_pixel(500, 9, Luma([77]))),
            DynamicImage::ImageLuma16(ImageBuffer::from_pixel(500, 9, Luma([77 * 257]))),
            DynamicImage::ImageRgb16(ImageBuffer::from_pixel(500, 9, Rgb([77 * 257; 3]))),
            // Transparent, but the camera saw it.
            DynamicImage::ImageRgba8(RgbaImage::from_pixel(500, 9, image::Rgba([77, 77, 77, 0]))),
            DynamicImage::ImageLumaA8(ImageBuffer::from_pixel(500, 9, image::LumaA([77, 9]))),
        ];
        for photo in kinds {
            let picture = Drawing::new([500, 9], "").over(&photo).unwrap();
            assert_eq!(picture.color(), image::ColorType::Rgb8);
            assert!(picture.to_rgb8().pixels().all(|p| p.0 == [77; 3]), "{:?}", photo.color());
        }
    }

    #[test]
    fn nothing_is_drawn_outside_or_at_no_number() {
        let mut drawing = Drawing::new([500, 400], "");
        let far = [[f64::NAN, 3.0], [1e300, -1e300], [f64::INFINITY, 0.0], [-1e9, 2e9]].map(Point2::from);
        drawing.polyline(&far, Pen::new(WHITE));
        drawing.outline(&far, Pen::new(WHITE));
        drawing.dots(far, 3.0, Pen::new(WHITE));
        drawing.rings(far, 3.0, Pen::new(WHITE));
        drawing.arrows(far.iter().zip(far.iter().rev()).map(|(a, b)| (*a, *b)), Pen::new(WHITE));
        drawing.label(far[0], "?", 1.0, Anchor::Middle, WHITE);
        drawing.polyline(&[], plain());
        assert!(drawing.items.is_empty(), "{:?}", drawing.items);
        let picture = drawing.over(&black(500, 400)).unwrap().to_rgb8();
        assert!(picture.pixels().all(|p| p.0 == [0; 3]));
    }

    #[test]
    fn a_large_photograph_is_drawn_upon_in_a_moment() {
        let size = [6000, 4000];
        let mut drawing = Drawing::new(size, "large");
        drawing.dimmed = true;
        let at = Point2::new(4321.0, 1234.0);
        drawing.dots([at], 3.0, plain());
        drawing.legend = Some(Legend::new("A legend").entry(Swatch::Ring(plain()), "that is in the frame"));
        let picture = drawing.over(&black(size[0], size[1])).unwrap();
        assert_eq!([picture.width(), picture.height()], size);
        assert_eq!(picture.to_rgb8().get_pixel(4321, 1234).0, WHITE);
    }

    #[test]
    fn a_smaller_copy_of_the_photograph_is_drawn_upon_at_its_scale() {
        let mut drawing = Drawing::new([1200, 800], "");
        drawing.dots([Point2::new(600.0, 200.0)], 4.0, plain());
        let found = centroid(&drawing.over(&black(600, 400)).unwrap());
        let expected = Point2::new(600.5 / 2.0 - 0.5, 200.5 / 2.0 - 0.5);
        assert!((found - expected).norm() < 0.05, "{found}");
    }

    #[test]
    fn words_stand_where_they_should() {
        for (anchor, middle) in [(Anchor::Start, 1.0), (Anchor::Middle, 0.0), (Anchor::End, -1.0)] {
            let mut drawing = Drawing::new([900, 600], "");
            drawing.words(Point2::new(450.0, 300.0), "HHHH".to_owned(), 40.0, anchor, plain());
            let found = centroid(&drawing.over(&black(900, 600)).unwrap());
            let half = 0.5 * Font::embedded().width("HHHH", 40.0);
            assert!((found.x - (450.0 + middle * half)).abs() < 2.0, "{anchor:?}: {found}");
            assert!((found.y - 300.0).abs() < 1.0, "{anchor:?}: {found}");
        }
    }
}
