//! The deviation of a cloud from a fitted surface, as the camera sees the points.

use image::DynamicImage;
use nalgebra::{Point2, Point3, Vector3};
use slcal_core::PointCloud;
use slcal_core::evaluate::FitReport;

use super::drawing::color::{Color, mix};
use super::drawing::legend::{Legend, Swatch};
use super::drawing::{Drawing, Pen};
use super::stripes::thousands;
use super::vector_scale::{plain, round_up, two_digits};
use crate::exit::Outcome;
use crate::name::short;

/// The longer side of the picture, px, and around the points as a share of it.
const SIDE_PX: f64 = 1600.0;
const MARGIN_SHARE: f64 = 0.06;
/// Neither side is less than this share of the other: a cloud that is a line is still a picture with a legend.
const LEAST_SIDE_SHARE: f64 = 0.6;
/// From behind to in front of the surface: blue, grey, orange, which also differ in brightness.
const BEHIND: Color = [40, 110, 225];
const ON: Color = [200, 200, 200];
const BEFORE: Color = [255, 160, 30];
const OUTLIER: Color = [84, 84, 84];
/// Number of colours on either side of the surface.
const SHADES: i32 = 12;
/// Size of a dot as a share of the mean distance between neighbours, and its bounds, units.
const DOT_SHARE: f64 = 0.45;
const DOT_UNITS: [f64; 2] = [0.5, 4.0];
/// The colours span this many rms.
const SPAN_RMS: f64 = 2.0;

/// A fitted surface and the deviations of the points.
pub(crate) struct DeviationMap<'a> {
    /// Of the cloud's file.
    pub(crate) name: &'a str,
    /// What was fitted: `plane`.
    pub(crate) what: &'a str,
    /// What distances below and above zero are called: `behind it`, `before it`.
    pub(crate) sides: [&'a str; 2],
    pub(crate) report: &'a FitReport,
    /// Signed distance of every point, mm.
    pub(crate) distances_mm: &'a [f64],
}

/// The points as the camera sees them, coloured by their distance from the surface, those left out in grey.
pub(crate) fn picture(cloud: &PointCloud, map: &DeviationMap<'_>) -> Outcome<DynamicImage> {
    let limit = map.report.inlier_limit_mm;
    let inlier = |i: usize| map.distances_mm.get(i).is_some_and(|d| d.abs() <= limit);
    let positions = project(cloud, inlier);
    let (size, place) =
        fitted(positions.iter().enumerate().filter(|(i, _)| inlier(*i)).filter_map(|(_, p)| *p));
    let rms = map.report.rms_mm;
    let title = format!(
        "{}: {} points lie {} mm (rms) from a {}",
        short(map.name),
        thousands(map.report.inliers),
        two_digits(rms),
        map.what
    );
    let mut drawing = Drawing::new(size, title.clone());
    let span = round_up(SPAN_RMS * rms);
    let shade = |d: f64| ((d / span).clamp(-1.0, 1.0) * f64::from(SHADES)).round() as i32;
    let mut by_shade: Vec<Vec<Point2<f64>>> = vec![Vec::new(); 2 * SHADES as usize + 2];
    for (i, p) in positions.iter().enumerate() {
        let Some(p) = p else { continue };
        // The last are the outliers, drawn first.
        let at = if inlier(i) { (shade(map.distances_mm[i]) + SHADES) as usize } else { by_shade.len() - 1 };
        by_shade[at].push(place(*p));
    }
    let area = f64::from(size[0]) * f64::from(size[1]) / map.report.inliers.max(1) as f64;
    let radius = (DOT_SHARE * area.sqrt() / drawing.unit()).clamp(DOT_UNITS[0], DOT_UNITS[1]);
    let outliers = by_shade.pop().unwrap_or_default();
    let left_out = map.report.points.saturating_sub(map.report.inliers);
    drawing.dots(outliers, 0.7 * radius, Pen::new(OUTLIER).plain());
    // The largest deviations on top, on both sides.
    let mut shades: Vec<_> = (-SHADES..=SHADES).zip(by_shade).collect();
    shades.sort_by_key(|(shade, _)| shade.abs());
    for (shade, points) in shades {
        drawing.dots(points, radius, Pen::new(color(shade)).plain());
    }
    let [below, above] = map.sides;
    let colors = (-SHADES..=SHADES).step_by(3).map(color).collect();
    let mut legend = Legend::new(title)
        .entry(Swatch::Colors(colors), format!("{} mm {below} … {} mm {above}", plain(span), plain(span)));
    if left_out > 0 {
        let text = format!("{} points more than {} mm off, left out", thousands(left_out), two_digits(limit));
        legend = legend.entry(Swatch::Dot(Pen::new(OUTLIER).plain()), text);
    }
    drawing.legend = Some(legend);
    drawing.over(&DynamicImage::new_rgb8(size[0], size[1]))
}

fn color(shade: i32) -> Color {
    let end = if shade < 0 { BEHIND } else { BEFORE };
    mix(ON, end, f64::from(shade.abs()) / f64::from(SHADES))
}

/// Where the points stand before a camera at the cloud's own that looks at the middle of the inliers, in focal lengths;
/// `None` behind it.
fn project(cloud: &PointCloud, inlier: impl Fn(usize) -> bool) -> Vec<Option<Point2<f64>>> {
    let from = cloud.camera_centre;
    let rays: Vec<Vector3<f64>> = cloud.points.iter().map(|p| p.position - from).collect();
    let sum: Vector3<f64> = rays.iter().enumerate().filter(|(i, _)| inlier(*i)).map(|(_, r)| *r).sum();
    let forward = sum.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector3::z);
    // The image's x axis as far as it lies across; any other where there is none.
    let across = |axis: Vector3<f64>| (axis - forward * forward.dot(&axis)).try_normalize(1e-6);
    let right = across(Vector3::x()).or_else(|| across(Vector3::y())).unwrap_or_else(Vector3::x);
    let down = forward.cross(&right);
    let position = |ray: &Vector3<f64>| {
        let depth = forward.dot(ray);
        let p = Point3::new(right.dot(ray), down.dot(ray), depth);
        (depth > 0.0 && p.iter().all(|c| c.is_finite())).then(|| Point2::new(p.x / depth, p.y / depth))
    };
    rays.iter().map(position).collect()
}

/// The size of a picture that holds the points, and where they stand in it.
fn fitted(points: impl Iterator<Item = Point2<f64>>) -> ([u32; 2], impl Fn(Point2<f64>) -> Point2<f64>) {
    let (mut low, mut high) =
        (Point2::new(f64::INFINITY, f64::INFINITY), Point2::new(-f64::INFINITY, -f64::INFINITY));
    for p in points {
        (low, high) = (low.inf(&p), high.sup(&p));
    }
    let extent = high - low;
    let longer = extent.max();
    let ok = longer.is_finite() && longer > 0.0;
    let scale = if ok { SIDE_PX * (1.0 - 2.0 * MARGIN_SHARE) / longer } else { 1.0 };
    let middle = if ok { nalgebra::center(&low, &high) } else { Point2::origin() };
    let margin = 2.0 * MARGIN_SHARE * SIDE_PX;
    let size = [0, 1].map(|k| {
        let side = if ok { extent[k] * scale + margin } else { SIDE_PX };
        side.clamp(LEAST_SIDE_SHARE * SIDE_PX, SIDE_PX).round() as u32
    });
    let centre = Point2::from(size.map(|n| 0.5 * (f64::from(n) - 1.0)));
    (size, move |p| centre + (p - middle) * scale)
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use slcal_core::CloudPoint;
    use slcal_core::evaluate::{FitConfig, fit_plane};

    use super::*;

    /// A board of 60 × 40 points a metre away whose middle lies 0.5 mm nearer, and stray points.
    fn board() -> PointCloud {
        let point = |position: Point3<f64>| CloudPoint {
            position,
            pixel: Point2::origin(),
            color: [0; 3],
            sigma_mm: 0.1,
            noise_mm: 0.1,
            slit: None,
            confidence: 1.0,
        };
        let grid = (0..60).flat_map(|i| (0..40).map(move |j| (f64::from(i), f64::from(j))));
        let mut points: Vec<_> = grid
            .map(|(i, j)| {
                let z = if (15.0..45.0).contains(&i) { 999.75 } else { 1000.25 };
                point(Point3::new(10.0 * (i - 29.5), 10.0 * (j - 19.5), z + 0.01 * (i * j).sin()))
            })
            .collect();
        points.push(point(Point3::new(f64::NAN, 0.0, 1.0)));
        points.push(point(Point3::new(0.0, 0.0, -500.0)));
        points.push(point(Point3::new(100.0, 80.0, 900.0)));
        PointCloud { points, ..PointCloud::default() }
    }

    #[test]
    fn what_lies_before_the_plane_is_orange_and_where_it_is() {
        let cloud = board();
        let finite = PointCloud {
            points: cloud.points.iter().copied().filter(|p| p.position.x.is_finite()).collect(),
            ..cloud.clone()
        };
        let fit = fit_plane(&finite, &FitConfig::default()).unwrap();
        // Towards the camera counts up.
        let distances: Vec<f64> =
            cloud.points.iter().map(|p| fit.plane.signed_distance_mm(&p.position)).collect();
        let map = DeviationMap {
            name: "a/board.ply",
            what: "plane",
            sides: ["behind it", "before it"],
            report: &fit.report,
            distances_mm: &distances,
        };
        let picture = picture(&cloud, &map).unwrap().to_rgb8();
        assert_eq!(picture.width(), 1600);
        assert!((950..1300).contains(&picture.height()), "{}", picture.height());
        let count = |middle: bool, test: fn([u8; 3]) -> bool| {
            let from_middle = |x: u32| (f64::from(x) / 1600.0 - 0.5).abs();
            let there = |x: u32| if middle { from_middle(x) < 0.2 } else { from_middle(x) > 0.25 };
            let pixels = picture.enumerate_pixels().filter(|(x, y, _)| there(*x) && (150..900).contains(y));
            pixels.filter(|(_, _, p)| test(p.0)).count()
        };
        let orange = |[r, _, b]: [u8; 3]| r > 150 && r > b.saturating_add(40);
        let blue = |[r, _, b]: [u8; 3]| b > 150 && b > r.saturating_add(40);
        assert!(count(true, orange) > 1000 && count(false, blue) > 1000);
        assert_eq!([count(true, blue), count(false, orange)], [0, 0]);
    }

    #[test]
    fn no_points_make_an_empty_picture() {
        let report = FitReport {
            rms_mm: f64::NAN,
            ..fit_plane(&board_without_strays(), &FitConfig::default()).unwrap().report
        };
        let map =
            DeviationMap { name: "", what: "plane", sides: ["", ""], report: &report, distances_mm: &[] };
        assert!(picture(&PointCloud::default(), &map).is_ok());
        assert!(picture(&board(), &map).is_ok());
    }

    fn board_without_strays() -> PointCloud {
        let mut cloud = board();
        cloud.points.truncate(2400);
        cloud
    }
}
