//! Pictures of what was found: lines, dots and labels on the photograph.

use std::collections::BTreeMap;

use image::{DynamicImage, Rgb, RgbImage};
use nalgebra::Point2;
use slcal_core::{SheetObservation, ViewObservation};

/// Lines of one photographic pixel per this many pixels of the longer side, so that a figure looks the same at any
/// resolution.
const PIXELS_PER_LINE_WIDTH: f64 = 900.0;

/// How much of the photograph's colour and brightness stays under curves, whose own colours would drown in the stripes'.
const COLOR_KEPT: f32 = 0.6;
const LIGHT_KEPT: f32 = 0.75;
/// Points of one slit are joined over this many lines of the photograph at most, so that small gaps close and others show.
const JOINED_LINES: i64 = 3;
/// And when they are this much or less further across the stripes than along them: what leans more is two curves.
const JOINED_LEAN: f64 = 2.0;
/// A curve is at least this wide, px: thinner ones fade.
const MIN_CURVE_WIDTH: f64 = 1.2;
/// The least brightness of a curve's colour, 0-255: dark blues and reds do not show on dark photographs.
const LEAST_LUMA: f64 = 140.0;

const SHEET: Rgb<u8> = Rgb([255, 60, 200]);
const EDGE_POINT: Rgb<u8> = Rgb([255, 220, 0]);
const CORNER: Rgb<u8> = Rgb([0, 220, 255]);
const EXPECTED: Rgb<u8> = Rgb([80, 255, 80]);
const FIRST_CORNER: Rgb<u8> = Rgb([255, 120, 0]);

/// A photograph that is drawn upon.
pub(crate) struct Overlay {
    picture: RgbImage,
    /// Width of lines, px.
    line: f64,
}

impl Overlay {
    pub(crate) fn new(photo: &DynamicImage) -> Self {
        let picture = photo.to_rgb8();
        let line = (f64::from(picture.width().max(picture.height())) / PIXELS_PER_LINE_WIDTH).max(1.0);
        Self { picture, line }
    }

    pub(crate) fn into_picture(self) -> DynamicImage {
        DynamicImage::ImageRgb8(self.picture)
    }

    /// The sheet's outline with its corners named, the edge points that were measured, and the pattern's corners: a
    /// circle each, the first one in another colour, joined in the order in which they were drawn on the panel.
    pub(crate) fn draw_observation(&mut self, view: &ViewObservation) {
        if let Some(corners) = view.sheet.corners() {
            self.draw_sheet(&corners);
        }
        if let SheetObservation::Edges(sides) = &view.sheet {
            for point in sides.iter().flatten() {
                self.disc(point.position, 1.2 * self.line, EDGE_POINT);
            }
        }
        for pair in view.pairs.windows(2) {
            // Within a row only: the way back to the next row's start would cross the board.
            if (pair[0].projector.y - pair[1].projector.y).abs() < 1e-6 {
                self.segment(pair[0].camera, pair[1].camera, 0.5 * self.line, CORNER);
            }
        }
        for (i, pair) in view.pairs.iter().enumerate() {
            self.circle(pair.camera, 4.0 * self.line, if i == 0 { FIRST_CORNER } else { CORNER });
        }
    }

    /// Where points are expected: a line from each that was seen, and a dot at its end.
    pub(crate) fn draw_expected(
        &mut self,
        seen_and_expected: impl Iterator<Item = (Point2<f64>, Point2<f64>)>,
    ) {
        for (seen, expected) in seen_and_expected {
            self.segment(seen, expected, self.line, EXPECTED);
            self.disc(expected, 1.5 * self.line, EXPECTED);
        }
    }

    /// An outline TL, TR, BR, BL with its corners named.
    pub(crate) fn draw_sheet(&mut self, corners: &[Point2<f64>; 4]) {
        for i in 0..4 {
            self.segment(corners[i], corners[(i + 1) % 4], self.line, SHEET);
        }
        let centre = Point2::from(
            corners.iter().map(|c| c.coords).sum::<nalgebra::Vector2<f64>>() / corners.len() as f64,
        );
        for (corner, name) in corners.iter().zip(["TL", "TR", "BR", "BL"]) {
            let inwards = (centre - corner).try_normalize(0.0).unwrap_or_default();
            self.label(corner + inwards * (24.0 * self.line), name, SHEET);
        }
    }

    /// The stripes that were found as thin curves on the dimmed photograph, each in the colour of its slit (neighbouring
    /// slits far apart in colour); a point without neighbours on its stripe is a dot.
    pub(crate) fn draw_stripes(&mut self, points: impl Iterator<Item = (Point2<f64>, Option<u16>)>) {
        self.dim();
        let points: Vec<_> = points.filter(|(p, _)| p.x.is_finite() && p.y.is_finite()).collect();
        // Whichever coordinate is whole counts the lines that the decoder read.
        let whole = |axis: usize| points.iter().filter(|(p, _)| p[axis].fract() == 0.0).count();
        let along = usize::from(whole(1) >= whole(0));
        let mut by_place: BTreeMap<(u16, i64), Vec<Point2<f64>>> = BTreeMap::new();
        for (p, slit) in &points {
            by_place.entry((slit.unwrap_or(0), p[along].round() as i64)).or_default().push(*p);
        }
        let width = self.line.max(MIN_CURVE_WIDTH);
        for ((slit, line), here) in &by_place {
            let color = slit_color(*slit);
            for p in here {
                let next = (1..=JOINED_LINES).find_map(|step| {
                    let there = by_place.get(&(*slit, line + step))?;
                    let lean = |q: &Point2<f64>| (q[1 - along] - p[1 - along]).abs() / step as f64;
                    there.iter().filter(|q| lean(q) <= JOINED_LEAN).min_by(|a, b| lean(a).total_cmp(&lean(b)))
                });
                self.blend_segment(*p, *next.unwrap_or(p), width, color);
            }
        }
    }

    /// Takes light and colour from the photograph.
    fn dim(&mut self) {
        for pixel in self.picture.pixels_mut() {
            let grey = luma(pixel.0.map(f64::from)) as f32;
            pixel.0 = pixel.0.map(|c| {
                (LIGHT_KEPT * (COLOR_KEPT * f32::from(c) + (1.0 - COLOR_KEPT) * grey)).round() as u8
            });
        }
    }

    /// A line with soft edges; what lies outside the frame is left out.
    fn blend_segment(&mut self, from: Point2<f64>, to: Point2<f64>, width: f64, color: Rgb<u8>) {
        let reach = 0.5 * width + 0.5;
        let along = to - from;
        let length = along.norm_squared();
        let size = [self.picture.width(), self.picture.height()].map(f64::from);
        let span = |k: usize| {
            let (low, high) = (from[k].min(to[k]) - reach, from[k].max(to[k]) + reach);
            ((low.ceil().clamp(0.0, size[k]) as u32), (high.floor().clamp(-1.0, size[k] - 1.0) + 1.0) as u32)
        };
        let ((left, right), (top, bottom)) = (span(0), span(1));
        for y in top..bottom {
            for x in left..right {
                let at = Point2::new(f64::from(x), f64::from(y));
                let share =
                    if length > 0.0 { ((at - from).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
                let cover = (reach - (at - (from + along * share)).norm()).clamp(0.0, 1.0) as f32;
                let pixel = self.picture.get_pixel_mut(x, y);
                for (old, new) in pixel.0.iter_mut().zip(color.0) {
                    *old = (f32::from(*old) * (1.0 - cover) + f32::from(new) * cover).round() as u8;
                }
            }
        }
    }

    fn disc(&mut self, centre: Point2<f64>, radius: f64, color: Rgb<u8>) {
        self.paint(centre, radius, color, |d| d <= radius);
    }

    fn circle(&mut self, centre: Point2<f64>, radius: f64, color: Rgb<u8>) {
        let half = 0.5 * self.line;
        self.paint(centre, radius + half, color, |d| (d - radius).abs() <= half);
    }

    /// Colours the pixels around a point whose distance from it passes the test.
    fn paint(&mut self, centre: Point2<f64>, reach: f64, color: Rgb<u8>, test: impl Fn(f64) -> bool) {
        let [w, h] = [self.picture.width(), self.picture.height()].map(f64::from);
        let span = |c: f64, size: f64| {
            ((c - reach).ceil().clamp(0.0, size) as u32)
                ..((c + reach).floor().clamp(-1.0, size - 1.0) + 1.0) as u32
        };
        if !(centre.x.is_finite() && centre.y.is_finite()) {
            return;
        }
        for y in span(centre.y, h) {
            for x in span(centre.x, w) {
                if test((Point2::new(f64::from(x), f64::from(y)) - centre).norm()) {
                    self.picture.put_pixel(x, y, color);
                }
            }
        }
    }

    /// A line between two points, of which only what lies in the frame is walked along.
    fn segment(&mut self, from: Point2<f64>, to: Point2<f64>, width: f64, color: Rgb<u8>) {
        let Some((from, to)) = self.clip(from, to) else { return };
        let steps = (to - from).norm().ceil().max(1.0);
        let mut step = 0.0;
        while step <= steps {
            self.disc(from + (to - from) * (step / steps), 0.5 * width.max(1.0), color);
            step += 1.0;
        }
    }

    /// The part of a segment within the frame: corners may lie far outside it.
    fn clip(&self, from: Point2<f64>, to: Point2<f64>) -> Option<(Point2<f64>, Point2<f64>)> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let size = [self.picture.width(), self.picture.height()].map(|n| f64::from(n) - 1.0);
        let direction = to - from;
        for axis in 0..2 {
            let (d, p) = (direction[axis], from[axis]);
            if d.abs() < 1e-9 {
                if !(0.0..=size[axis]).contains(&p) {
                    return None;
                }
            } else {
                let (a, b) = ((0.0 - p) / d, (size[axis] - p) / d);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
        }
        (enter <= leave).then(|| (from + direction * enter, from + direction * leave))
    }

    /// A name in block letters around a point.
    fn label(&mut self, centre: Point2<f64>, text: &str, color: Rgb<u8>) {
        let cell = (2.0 * self.line).round();
        let width = 6.0 * text.len() as f64 - 1.0;
        let start = centre - nalgebra::Vector2::new(width, 7.0) * (cell / 2.0);
        for (i, letter) in text.chars().enumerate() {
            for (row, bits) in glyph(letter).iter().enumerate() {
                for column in (0..5).filter(|c| bits >> (4 - c) & 1 == 1) {
                    let at = nalgebra::Vector2::new(6.0 * i as f64 + f64::from(column), row as f64) * cell;
                    self.square(start + at, cell, color);
                }
            }
        }
    }

    fn square(&mut self, corner: Point2<f64>, side: f64, color: Rgb<u8>) {
        let [w, h] = [self.picture.width(), self.picture.height()].map(f64::from);
        let range = |c: f64, size: f64| (c.clamp(0.0, size) as u32)..((c + side).clamp(0.0, size) as u32);
        for y in range(corner.y, h) {
            for x in range(corner.x, w) {
                self.picture.put_pixel(x, y, color);
            }
        }
    }
}

/// The letters that corners are named with, 5×7 dots, the highest of five bits at the left.
fn glyph(letter: char) -> [u8; 7] {
    match letter {
        'T' => [31, 4, 4, 4, 4, 4, 4],
        'B' => [30, 17, 17, 30, 17, 17, 30],
        'L' => [16, 16, 16, 16, 16, 16, 31],
        'R' => [30, 17, 17, 30, 20, 18, 17],
        _ => [0; 7],
    }
}

/// A bright colour per slit: hues step by the golden angle, so that neighbours differ most.
fn slit_color(slit: u16) -> Rgb<u8> {
    const GOLDEN_SHARE: f64 = 0.618_033_988_75;
    let hue = (f64::from(slit) * GOLDEN_SHARE).fract() * 6.0;
    let pure = [5.0, 3.0, 1.0].map(|n: f64| {
        let k = (n + hue) % 6.0;
        255.0 * (1.0 - k.min(4.0 - k).clamp(0.0, 1.0))
    });
    let white = ((LEAST_LUMA - luma(pure)) / (255.0 - luma(pure))).clamp(0.0, 1.0);
    Rgb(pure.map(|c| (c + (255.0 - c) * white).round() as u8))
}

/// Brightness of a colour as the eye weighs it (Rec. 709).
fn luma([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_outside_the_frame_and_not_finite_draw_nothing_there() {
        let mut overlay = Overlay::new(&DynamicImage::new_rgb8(40, 30));
        let far = Point2::new(1e12, -1e12);
        overlay.draw_sheet(&[
            Point2::new(-50.0, 10.0),
            far,
            Point2::new(f64::NAN, 3.0),
            Point2::new(20.0, 5e9),
        ]);
        overlay.disc(far, 3.0, CORNER);
        overlay.disc(Point2::new(39.4, 29.4), 3.0, CORNER);
        let picture = overlay.into_picture().to_rgb8();
        assert_eq!(*picture.get_pixel(39, 29), CORNER);
    }

    #[test]
    fn a_segment_is_drawn_where_it_crosses_the_frame() {
        let mut overlay = Overlay::new(&DynamicImage::new_rgb8(40, 30));
        overlay.segment(Point2::new(-100.0, 15.0), Point2::new(100.0, 15.0), 1.0, SHEET);
        let picture = overlay.into_picture().to_rgb8();
        assert!((0..40).all(|x| *picture.get_pixel(x, 15) == SHEET));
        assert!((0..40).all(|x| *picture.get_pixel(x, 18) != SHEET));
    }

    #[test]
    fn points_of_one_slit_become_a_curve_whichever_way_the_lines_run() {
        // Two slits a row apart from each other in every line but some, and a point alone.
        let curve = |u: f64, slit: u16| {
            let lines = (0..40).filter(|l| *l != 8 && !(20..30).contains(l));
            lines.map(move |l| (Point2::new(u + 0.25 * f64::from(l), f64::from(l)), Some(slit)))
        };
        let points: Vec<_> =
            curve(10.2, 3).chain(curve(20.2, 4)).chain([(Point2::new(35.3, 5.0), Some(9))]).collect();
        let draw = |turned: bool| {
            let mut overlay = Overlay::new(&DynamicImage::new_rgb8(48, 48));
            let turn = |p: Point2<f64>| if turned { Point2::new(p.y, p.x) } else { p };
            overlay.draw_stripes(points.iter().map(|(p, slit)| (turn(*p), *slit)));
            let picture = overlay.into_picture().to_rgb8();
            if turned {
                image::imageops::flip_horizontal(&image::imageops::rotate90(&picture))
            } else {
                picture
            }
        };
        let (upright, turned) = (draw(false), draw(true));
        assert_eq!(upright, turned);
        let drawn = |x: u32, y: u32| upright.get_pixel(x, y).0.iter().any(|c| *c > 60);
        // A gap of one line closes, one of ten shows.
        assert!((0..20).all(|y| drawn((10.2 + 0.25 * f64::from(y)).round() as u32, y)));
        assert!((21..29).all(|y| !(0..48).any(|x| drawn(x, y))));
        assert!(drawn(35, 5) && !drawn(35, 8));
    }

    #[test]
    fn neighbouring_slits_differ_in_colour() {
        for slit in 0..63_u16 {
            let (a, b) = (slit_color(slit), slit_color(slit + 1));
            let apart: i32 = (0..3).map(|c| (i32::from(a[c]) - i32::from(b[c])).abs()).sum();
            assert!(apart > 150, "{slit}: {a:?} {b:?}");
        }
    }
}
