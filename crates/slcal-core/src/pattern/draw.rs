//! Rendering of patterns and pictures through a homography. Samples are averaged in linear light.

use image::{Rgb, RgbImage};
use nalgebra::{Matrix2, Matrix3, Point2, Vector2, Vector3};

use super::panel::check_panel;
use super::{Axis, CheckerPattern, SquareColor, StripePattern};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{Homography, Warp};
use crate::photo::Encoding;

/// Samples per side of a pixel to find out whether it contains an edge. Features thinner than a quarter of a pixel may be
/// missed.
const COARSE_SAMPLES: u32 = 4;
/// Samples per side of a pixel that holds an edge: 256 in all, one per level of an 8-bit image.
const FINE_SAMPLES: u32 = 16;
/// Largest supersampling per side when a picture is reduced; beyond it the picture is only a blur.
const MAX_REDUCTION: u32 = 16;

impl CheckerPattern {
    /// What to project, pixel by pixel.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a panel without pixels or wider than 16384 px.
    pub fn image(&self) -> Result<RgbImage> {
        let (upright, middle) = (Homography::identity().into(), Point2::origin());
        let (background, marks) = (shade(self.background), self.marks.as_ref());
        let row = |y| (self.row(y), marks.map(|m| m.row(y)));
        let light = self.light();
        let marked = |p| match marks.and_then(|m| m.at(p)) {
            None => light(p),
            Some(ring) => background.map(|c| if ring { 1.0 - c } else { c }),
        };
        draw(self.projector, &upright, middle, background, marked, |y| Some(row(y)))
    }

    /// The board rendered through the warp: a point of the pattern at panel pixel p is drawn at
    /// `panel_from_pattern`·p; around it lies the background, without marks. Edges are antialiased in linear light.
    ///
    /// # Errors
    /// [`Error::Degenerate`] for a singular homography; [`Error::Invalid`] as for [`CheckerPattern::image`].
    pub(crate) fn draw_warped(&self, panel_from_pattern: &Warp) -> Result<RgbImage> {
        let [cx, cy] = self.squares.map(|n| f64::from(n) / 2.0 * self.square_px);
        let centre = Point2::new(self.origin_px.x + cx, self.origin_px.y + cy);
        draw(self.projector, panel_from_pattern, centre, shade(self.background), self.light(), |_| None::<()>)
    }

    /// The light at a panel pixel.
    fn light(&self) -> impl Fn(Point2<f64>) -> [f64; 3] {
        let (first, background) = (shade(self.first_square), shade(self.background));
        let second = first.map(|c| 1.0 - c);
        let [columns, rows] = self.squares.map(f64::from);
        let (origin, scale) = (self.origin_px, self.square_px.recip());
        move |p| {
            let (i, j) = (((p.x - origin.x) * scale).floor(), ((p.y - origin.y) * scale).floor());
            if !(i >= 0.0 && j >= 0.0 && i < columns && j < rows) {
                return background;
            }
            if (i as u32 + j as u32).is_multiple_of(2) { first } else { second }
        }
    }

    /// Which row of squares a panel row shows; beyond the board all are alike.
    fn row(&self, y: f64) -> i64 {
        let j = ((y - self.origin_px.y) * self.square_px.recip()).floor();
        if j >= 0.0 && j < f64::from(self.squares[1]) { j as i64 } else { -1 }
    }
}

fn shade(color: SquareColor) -> [f64; 3] {
    if color == SquareColor::White { [1.0; 3] } else { [0.0; 3] }
}

impl StripePattern {
    /// What to project, pixel by pixel.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a panel without pixels or wider than 16384 px.
    pub fn image(&self) -> Result<RgbImage> {
        let (upright, middle) = (Homography::identity().into(), Point2::origin());
        draw(self.projector, &upright, middle, [0.0; 3], self.light(), |y| Some(self.row(y)))
    }

    /// The slits rendered through the warp, as [`CheckerPattern::draw_warped`].
    #[cfg(test)]
    pub(crate) fn draw_warped(&self, panel_from_pattern: &Warp) -> Result<RgbImage> {
        let [w, h] = self.projector.map(f64::from);
        let centre = Point2::new(w / 2.0, h / 2.0);
        draw(self.projector, panel_from_pattern, centre, [0.0; 3], self.light(), |_| None::<()>)
    }

    /// The light at a panel pixel.
    fn light(&self) -> impl Fn(Point2<f64>) -> [f64; 3] {
        let palette: Vec<[f64; 3]> = self.palette.iter().map(|&c| linear(c)).collect();
        let [w, h] = self.projector.map(f64::from);
        move |p| {
            if !(p.x >= -0.5 && p.y >= -0.5 && p.x < w - 0.5 && p.y < h - 0.5) {
                return [0.0; 3];
            }
            let (next, inside) = self.slit(if self.axis == Axis::Columns { p.x } else { p.y });
            let hue = self.sequence.get(next).map_or(usize::MAX, |&s| usize::from(s));
            if inside { palette.get(hue).copied().unwrap_or([0.0; 3]) } else { [0.0; 3] }
        }
    }

    /// The slit at a position across the slits or the next one after it, and whether it covers the position.
    fn slit(&self, at: f64) -> (usize, bool) {
        let half = self.width_px / 2.0;
        let next = self.centres_px.partition_point(|&c| c < at - half);
        (next, self.centres_px.get(next).is_some_and(|&c| c <= at + half))
    }

    /// Which slit or gap a panel row shows; rows across upright slits are all alike.
    fn row(&self, y: f64) -> i64 {
        if self.axis == Axis::Columns {
            return 0;
        }
        let (next, inside) = self.slit(y);
        2 * next as i64 + i64::from(inside)
    }
}

/// Any picture moved by a warp: Catmull–Rom interpolation in linear light, supersampled where the picture is
/// reduced; `background` where the picture does not reach.
///
/// # Errors
/// [`Error::Degenerate`] for a singular homography; [`Error::Invalid`] for sizes without pixels or beyond 16384 px.
pub(crate) fn warp_image(
    picture: &RgbImage,
    size: [u32; 2],
    target_from_source: &Warp,
    background: [u8; 3],
) -> Result<RgbImage> {
    check_panel([picture.width(), picture.height()])?;
    let [w, h] = [picture.width(), picture.height()].map(f64::from);
    let source = Inverse::new(target_from_source, Point2::new(w / 2.0, h / 2.0))?;
    check_panel(size)?;
    let table: Vec<f64> = (0..=255_u8).map(|c| Encoding::Srgb.to_linear(f64::from(c) / 255.0)).collect();
    let background = linear(background);
    Ok(RgbImage::from_fn(size[0], size[1], |x, y| {
        let Some(pixel) = source.pixel(x, y) else { return Rgb(encode(background)) };
        let n = source.reduction(&pixel).clamp(1.0, f64::from(MAX_REDUCTION)) as u32;
        Rgb(encode(mean(n, |d| {
            source.map(&pixel, d).and_then(|q| catmull_rom(picture, &table, q)).unwrap_or(background)
        })))
    }))
}

/// The map from the drawn picture back to its source, on the near side of the horizon.
struct Inverse<'a> {
    source_from_ideal: Matrix3<f64>,
    warp: &'a Warp,
}

/// An undistorted pixel of the drawn picture: its centre, and the Jacobian of the undistortion there. Within a pixel the
/// lens is linear to a millionth of a pixel.
struct Pixel {
    centre: Point2<f64>,
    slope: Matrix2<f64>,
}

impl<'a> Inverse<'a> {
    fn new(warp: &'a Warp, centre: Point2<f64>) -> Result<Self> {
        let flattens = "it flattens the pattern to a line or a point";
        let flat = || Error::undetermined(ErrorSubject::Homography, flattens);
        let inverse = warp.homography.inverse().ok_or_else(flat)?;
        // The near side of the horizon is the side of the source's centre.
        let side = (warp.homography.0 * Vector3::new(centre.x, centre.y, 1.0)).z;
        Ok(Self { source_from_ideal: if side < 0.0 { -inverse.0 } else { inverse.0 }, warp })
    }

    /// `None` where the lens's model ends.
    fn pixel(&self, x: u32, y: u32) -> Option<Pixel> {
        let (centre, slope) = self.warp.ideal(Point2::new(f64::from(x), f64::from(y)))?;
        Some(Pixel { centre, slope })
    }

    fn map(&self, pixel: &Pixel, offset: Vector2<f64>) -> Option<Point2<f64>> {
        let p = pixel.centre + pixel.slope * offset;
        let q = self.source_from_ideal * Vector3::new(p.x, p.y, 1.0);
        let mapped = Point2::new(q.x / q.z, q.y / q.z);
        (q.z > 0.0 && mapped.x.is_finite() && mapped.y.is_finite()).then_some(mapped)
    }

    /// How many source pixels fall on a pixel of the target, per side.
    fn reduction(&self, pixel: &Pixel) -> f64 {
        let j = Homography(self.source_from_ideal).jacobian(pixel.centre) * pixel.slope;
        let longest = j.column(0).norm().max(j.column(1).norm());
        if longest.is_finite() { (longest - 1e-6).ceil() } else { 1.0 }
    }
}

/// Draws a function of the pattern's coordinates, antialiased. Two consecutive rows with the same `row` for all samples
/// are equal, and one of them is drawn. `row` is `None` where this is unknown.
fn draw<R: PartialEq + Copy>(
    size: [u32; 2],
    panel_from_pattern: &Warp,
    centre: Point2<f64>,
    background: [f64; 3],
    light: impl Fn(Point2<f64>) -> [f64; 3],
    row: impl Fn(f64) -> Option<R>,
) -> Result<RgbImage> {
    check_panel(size)?;
    let source = Inverse::new(panel_from_pattern, centre)?;
    let draw_pixel = |x, y| {
        let Some(pixel) = source.pixel(x, y) else { return encode(background) };
        let at = |d| source.map(&pixel, d).map_or(background, &light);
        let first = at(sample(COARSE_SAMPLES, 0));
        let flat = (1..COARSE_SAMPLES * COARSE_SAMPLES).all(|k| at(sample(COARSE_SAMPLES, k)) == first);
        encode(if flat { first } else { mean(FINE_SAMPLES, at) })
    };
    // The samples between the outermost ones have the same value.
    let reach = sample(FINE_SAMPLES, FINE_SAMPLES * FINE_SAMPLES - 1).y;
    let whole = |y: u32| {
        let [first, last] = [-reach, reach].map(|d| row(f64::from(y) + d));
        first.filter(|_| first == last)
    };
    let length = 3 * size[0] as usize;
    let mut picture = RgbImage::new(size[0], size[1]);
    for y in 0..size[1] {
        let start = y as usize * length;
        if y > 0 && whole(y).is_some() && whole(y) == whole(y - 1) {
            picture.copy_within(start - length..start, start);
            continue;
        }
        for x in 0..size[0] {
            picture.put_pixel(x, y, Rgb(draw_pixel(x, y)));
        }
    }
    Ok(picture)
}

/// The `k`-th of n×n sample positions in a pixel, row-major, from its centre.
fn sample(n: u32, k: u32) -> Vector2<f64> {
    let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(n) - 0.5;
    Vector2::new(offset(k % n), offset(k / n))
}

fn mean(n: u32, at: impl Fn(Vector2<f64>) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for k in 0..n * n {
        for (s, c) in sum.iter_mut().zip(at(sample(n, k))) {
            *s += c;
        }
    }
    sum.map(|s| s / f64::from(n * n))
}

fn linear(code: [u8; 3]) -> [f64; 3] {
    code.map(|c| Encoding::Srgb.to_linear(f64::from(c) / 255.0))
}

fn encode(light: [f64; 3]) -> [u8; 3] {
    light.map(|c| (Encoding::Srgb.from_linear(c) * 255.0).round() as u8)
}

/// Interpolates linear light; `None` outside the picture's pixels. Border pixels are repeated.
fn catmull_rom(picture: &RgbImage, table: &[f64], p: Point2<f64>) -> Option<[f64; 3]> {
    let (w, h) = (i64::from(picture.width()), i64::from(picture.height()));
    if !(p.x >= -0.5 && p.y >= -0.5 && p.x < w as f64 - 0.5 && p.y < h as f64 - 0.5) {
        return None;
    }
    let (x0, y0) = (p.x.floor(), p.y.floor());
    let (wx, wy) = (cubic_weights(p.x - x0), cubic_weights(p.y - y0));
    let mut sum = [0.0; 3];
    for (j, wj) in (-1..).zip(wy) {
        let y = (y0 as i64 + j).clamp(0, h - 1) as u32;
        for (i, wi) in (-1..).zip(wx) {
            let x = (x0 as i64 + i).clamp(0, w - 1) as u32;
            for (s, &c) in sum.iter_mut().zip(&picture.get_pixel(x, y).0) {
                *s += wi * wj * table[usize::from(c)];
            }
        }
    }
    Some(sum)
}

/// Catmull–Rom weights of the four neighbours at fraction `t` after the second.
fn cubic_weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t + 2.0 * t2 - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (t3 - t2),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::rendered_scenes;
    use crate::pattern::{CheckerConfig, StripeConfig};

    fn shared(name: &str) -> Option<RgbImage> {
        let path = rendered_scenes(&format!("paper_tilted/patterns/{name}"))?;
        Some(image::open(path).unwrap().to_rgb8())
    }

    #[test]
    fn defaults_are_what_was_projected_in_the_rendered_scenes() {
        let checker = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
        if let Some(truth) = shared("checker.png") {
            assert!(checker.image().unwrap() == truth);
        }
        let stripes = StripePattern::new([1024, 768], &StripeConfig::default()).unwrap();
        if let Some(truth) = shared("stripes.png") {
            assert!(stripes.image().unwrap() == truth);
        }
    }

    #[test]
    fn rows_that_are_not_drawn_are_those_that_would_look_like_the_one_above() {
        let upright: Warp = Homography::identity().into();
        let config = CheckerConfig { squares: [5, 4], ..CheckerConfig::default() };
        let mut checker = CheckerPattern::new([160, 120], &config).unwrap();
        for (origin, square_px) in
            [(checker.origin_px, 7.5), (Point2::new(3.3, -4.1), 9.37), (Point2::new(150.2, 100.6), 12.0)]
        {
            (checker.origin_px, checker.square_px) = (origin, square_px);
            assert!(
                checker.image().unwrap() == checker.draw_warped(&upright).unwrap(),
                "{origin} {square_px}"
            );
        }
        for axis in [Axis::Columns, Axis::Rows] {
            let config = StripeConfig { axis, slits: Some(20), ..StripeConfig::default() };
            let mut stripes = StripePattern::new([160, 120], &config).unwrap();
            // Slits as drawn, and such as lie within a pixel.
            for width_px in [stripes.width_px, 2.71, 0.6] {
                stripes.width_px = width_px;
                assert!(
                    stripes.image().unwrap() == stripes.draw_warped(&upright).unwrap(),
                    "{axis:?} {width_px}"
                );
            }
        }
    }

    #[test]
    fn marks_are_drawn_where_they_are_described_and_change_nothing_else() {
        for background in [SquareColor::White, SquareColor::Black] {
            let config = CheckerConfig { marks: true, background, ..CheckerConfig::default() };
            let marked = CheckerPattern::new([640, 480], &config).unwrap();
            let plain = CheckerPattern { marks: None, ..marked.clone() }.image().unwrap();
            let marks = marked.marks.as_ref().unwrap();
            let (ring, hole) = if background == SquareColor::White { (0, 255) } else { (255, 0) };
            for (x, y, pixel) in marked.image().unwrap().enumerate_pixels() {
                let expected = match marks.at(Point2::new(f64::from(x), f64::from(y))) {
                    None => *plain.get_pixel(x, y),
                    Some(on_ring) => Rgb([if on_ring { ring } else { hole }; 3]),
                };
                assert_eq!(*pixel, expected, "{x}, {y}");
            }
        }
    }

    #[test]
    fn a_shift_by_half_a_pixel_mixes_light_and_not_code() {
        let checker = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
        let shift = Homography(Matrix3::new(1.0, 0.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
        let drawn = checker.draw_warped(&shift.into()).unwrap();
        assert_eq!(drawn.get_pixel(247, 200).0, [255; 3]);
        assert_eq!(drawn.get_pixel(248, 200).0, [188; 3], "half the light is sRGB 188");
        assert_eq!(drawn.get_pixel(249, 200).0, [0; 3]);
    }

    #[test]
    fn corners_are_drawn_where_the_homography_takes_them() {
        let checker = CheckerPattern::new([800, 600], &CheckerConfig::default()).unwrap();
        let h = Homography(Matrix3::new(0.9, 0.05, 30.0, -0.04, 0.85, 60.0, 1e-4, -5e-5, 1.0));
        for h in [h, Homography(-h.0)] {
            let drawn = checker.draw_warped(&h.into()).unwrap();
            for (i, j) in [(0, 0), (9, 6), (4, 3)] {
                let c = h.map(checker.inner_corner(i, j)).unwrap();
                let at = |dx: f64, dy: f64| drawn.get_pixel((c.x + dx) as u32, (c.y + dy) as u32).0[0];
                let white = u8::from((i + j) % 2 == 1) * 255;
                assert_eq!([at(-8.0, -8.0), at(8.0, 8.0)], [white; 2]);
                assert_eq!([at(8.0, -8.0), at(-8.0, 8.0)], [255 - white; 2]);
            }
        }
    }

    #[test]
    fn nothing_is_drawn_beyond_the_horizon() {
        let stripes = StripePattern::new([640, 480], &StripeConfig::default()).unwrap();
        let h = Homography(Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0 / 300.0, 1.0));
        assert!(stripes.draw_warped(&h.into()).unwrap().pixels().any(|p| p.0 != [0; 3]));
        assert!(stripes.draw_warped(&Homography(Matrix3::zeros()).into()).is_err());
    }

    #[test]
    fn warping_keeps_whole_pixel_shifts_exact_and_straight_ramps_straight() {
        let picture = RgbImage::from_fn(40, 30, |x, y| Rgb([(x * 6) as u8, (y * 8) as u8, 200]));
        let shift = Homography(Matrix3::new(1.0, 0.0, 3.0, 0.0, 1.0, -2.0, 0.0, 0.0, 1.0));
        let moved = warp_image(&picture, [40, 30], &shift.into(), [9, 8, 7]).unwrap();
        assert_eq!(moved.get_pixel(13, 8), picture.get_pixel(10, 10));
        assert_eq!(moved.get_pixel(1, 8).0, [9, 8, 7]);
        // Reduced to a third: each pixel is the mean light of its nine.
        let third =
            Homography(Matrix3::new(1.0 / 3.0, 0.0, -1.0 / 3.0, 0.0, 1.0 / 3.0, -1.0 / 3.0, 0.0, 0.0, 1.0));
        let board = RgbImage::from_fn(30, 30, |x, _| Rgb([if x % 3 == 0 { 255 } else { 0 }; 3]));
        let small = warp_image(&board, [10, 10], &third.into(), [0; 3]).unwrap();
        let expected = (Encoding::Srgb.from_linear(1.0 / 3.0) * 255.0).round() as u8;
        assert!(small.get_pixel(5, 5).0[0].abs_diff(expected) <= 1);
    }
}
