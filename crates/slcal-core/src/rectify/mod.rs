//! Keystone removal for use: the largest upright picture on the sheet that the projector can light.
//!
//! The rectangle has its sides along the sheet's X and Y, the source's aspect, lies inside both the sheet and the panel's
//! light, and is centred where its position is free. With the aspect given, its size is a linear programme in (x, y,
//! scale): the half-planes are the sheet's sides, the panel's sides seen on the sheet, and the projector's horizon. Where
//! the projector distorts, the panel's sides are curves on the sheet; the straight lines just inside them count.
//! (Eq. 14 of the paper, which depends on the pattern's first corner and may leave the panel, is in `two_vp`.)

mod picture;

pub use picture::{rectify_checker_picture, rectify_picture};

use nalgebra::{Matrix3, Point2, Vector2, Vector3};

use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{Camera, Homography, RectangleSize, Warp};
use crate::pattern::CheckerPattern;
use crate::rig::Rig;
use crate::solve::homography_from_points;

/// A keystone-free placement of a picture on the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Rectification {
    /// Source pixels → panel pixels.
    pub(crate) panel_from_source: Warp,
    /// The source's corners TL, TR, BR, BL on the panel, px.
    pub corners_px: [Point2<f64>; 4],
    /// Top-left corner of the picture on the sheet, mm.
    pub origin_mm: Point2<f64>,
    /// Size of the picture on the sheet, mm.
    pub size_mm: RectangleSize,
}

impl Rectification {
    /// A placement from its parts: the homography from source pixels to panel pixels, the projector if its lens distorts,
    /// and the fields.
    #[must_use]
    pub fn new(
        homography: Matrix3<f64>,
        lens: Option<Camera>,
        corners_px: [Point2<f64>; 4],
        origin_mm: Point2<f64>,
        size_mm: RectangleSize,
    ) -> Self {
        let panel_from_source = Warp { homography: Homography(homography), lens };
        Self { panel_from_source, corners_px, origin_mm, size_mm }
    }

    /// The panel pixel that shows a source pixel; `None` at infinity.
    #[must_use]
    pub fn map(&self, source: Point2<f64>) -> Option<Point2<f64>> {
        self.panel_from_source.map(source)
    }

    /// Source pixels → panel pixels without lens distortion.
    #[must_use]
    pub fn homography(&self) -> Matrix3<f64> {
        self.panel_from_source.homography.0
    }

    /// The projector, where its lens distorts.
    #[must_use]
    pub fn lens(&self) -> Option<&Camera> {
        self.panel_from_source.lens.as_ref()
    }
}

/// Background kept around a rectified checkerboard, in squares: the outermost squares must be seen as squares.
const MARGIN_SQUARES: f64 = 0.5;
/// Points at which a side of the panel is undistorted; between them it bends by less than a hundredth of what it does in all.
const POINTS_PER_BORDER: u32 = 32;

/// Where a checkerboard is drawn so that it appears upright on the sheet of a view, half a square of its background
/// around it: [`rectify`] of its outline. What is drawn and what is looked for in a photograph of it are the same.
///
/// # Errors
/// As [`rectify`].
pub fn rectify_checker(rig: &Rig, view: usize, pattern: &CheckerPattern) -> Result<Rectification> {
    let [top_left, _, bottom_right, _] = pattern.outline();
    let margin = Vector2::repeat(MARGIN_SQUARES * pattern.square_px);
    rectify(rig, view, top_left - margin, bottom_right + margin)
}

/// The half-plane of points p with n·(x, y) + c ≥ 0, (n, c) scaled to unit n; `None` when it is everything.
fn half_plane(l: Vector3<f64>) -> Option<Vector3<f64>> {
    let n = l.xy().norm();
    (n > 1e-12 * l.z.abs()).then(|| l / n)
}

/// Where on the sheet of a view a picture with corners `top_left` and `bottom_right` (source px, outer edges) appears
/// largest and upright, and the warp that draws it there.
///
/// # Errors
/// [`Error::Invalid`] for a rig without projector, a view that it does not have or an empty source;
/// [`Error::Degenerate`] when the projector does not light the sheet, or its distortion folds over inside the panel.
pub fn rectify(
    rig: &Rig,
    view: usize,
    top_left: Point2<f64>,
    bottom_right: Point2<f64>,
) -> Result<Rectification> {
    let projector = rig.require_projector()?.device.model;
    let chosen = rig.views.get(view).ok_or_else(|| {
        Error::invalid("view", "a view of the sheet in the rig", format!("{view} of {}", rig.views.len()))
    })?;
    let pose =
        chosen.projector_from_sheet.ok_or_else(|| Error::invalid("view", "projector_from_sheet", "none"))?;
    let source = bottom_right - top_left;
    if !(source.x > 0.0 && source.y > 0.0 && source.iter().all(|x| x.is_finite())) {
        return Err(Error::invalid("picture to rectify", "a positive size", format!("{source:?}")));
    }
    let r = pose.rotation.matrix();
    let columns = [r.column(0).into_owned(), r.column(1).into_owned(), pose.translation];
    let h = projector.intrinsics.matrix() * Matrix3::from_columns(&columns);
    let [left, right, top, bottom] = straight_panel(&projector)?;
    let size = chosen.size;
    let row = |i: usize| h.row(i).transpose();
    // In front of the projector by a small part of its distance, so that the horizon itself is outside.
    let depth = row(2);
    let centre = Vector3::new(size.width_mm / 2.0, size.height_mm / 2.0, 1.0);
    let in_front = depth - Vector3::new(0.0, 0.0, 1e-3 * depth.dot(&centre).abs());
    let limits: Vec<Vector3<f64>> = [
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(-1.0, 0.0, size.width_mm),
        Vector3::new(0.0, 1.0, 0.0),
        Vector3::new(0.0, -1.0, size.height_mm),
        in_front,
        row(0) - depth * left,
        depth * right - row(0),
        row(1) - depth * top,
        depth * bottom - row(1),
    ]
    .into_iter()
    .filter_map(half_plane)
    .collect();
    let aspect = source.x / source.y;
    let (origin_mm, height) = largest(&limits, aspect, size).ok_or_else(|| {
        let advice = "the projector does not light the sheet: aim it there";
        Error::undetermined(ErrorSubject::RectifiedPicture, advice)
    })?;
    let size_mm = RectangleSize::new(height * aspect, height)?;
    let on_sheet = size_mm.corners().map(|c| origin_mm + c.coords);
    let source_corners = [
        top_left,
        Point2::new(bottom_right.x, top_left.y),
        bottom_right,
        Point2::new(top_left.x, bottom_right.y),
    ];
    let pairs: Vec<_> = source_corners.into_iter().zip(on_sheet).collect();
    let panel_from_source = Warp::onto(&projector, Homography(h).compose(&homography_from_points(&pairs)?));
    let mut corners_px = [Point2::origin(); 4];
    for (corner, c) in corners_px.iter_mut().zip(source_corners) {
        *corner = panel_from_source
            .map(c)
            .ok_or_else(|| Error::invalid("rectified picture", "finite corners", "a point at infinity"))?;
    }
    Ok(Rectification { panel_from_source, corners_px, origin_mm, size_mm })
}

/// The rectangle of ideal pixels [left, right, top, bottom] that the panel's border leaves free: the border itself without
/// distortion.
fn straight_panel(projector: &Camera) -> Result<[f64; 4]> {
    let [w, h] = projector.size().map(|n| f64::from(n) - 0.5);
    let mut limits = [-0.5, w, -0.5, h];
    if projector.distortion.is_none() {
        return Ok(limits);
    }
    let advice =
        "the projector's distortion has no inverse at the panel's border: calibrate from more photographs";
    let folded = || Error::undetermined(ErrorSubject::RectifiedPicture, advice);
    let unbend = Warp::onto(projector, Homography::identity());
    limits = [f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY];
    for k in 0..=POINTS_PER_BORDER {
        let share = f64::from(k) / f64::from(POINTS_PER_BORDER);
        let (x, y) = (share * (w + 0.5) - 0.5, share * (h + 0.5) - 0.5);
        let ideal = |x: f64, y: f64| unbend.ideal(Point2::new(x, y)).map(|i| i.0).ok_or_else(folded);
        limits[0] = limits[0].max(ideal(-0.5, y)?.x);
        limits[1] = limits[1].min(ideal(w, y)?.x);
        limits[2] = limits[2].max(ideal(x, -0.5)?.y);
        limits[3] = limits[3].min(ideal(x, h)?.y);
    }
    Ok(limits)
}

/// Origin and height of the largest rectangle of an aspect inside half-planes: the vertices of the linear programme in
/// (x, y, height) are tried one by one (there are at most 84), and those that tie are averaged, which centres the
/// rectangle.
fn largest(limits: &[Vector3<f64>], aspect: f64, size: RectangleSize) -> Option<(Point2<f64>, f64)> {
    // n·(x, y) + c + height·min(0, a·nx, ny, a·nx + ny) ≥ 0 keeps all four corners inside.
    let rows: Vec<(Vector3<f64>, f64)> = limits
        .iter()
        .map(|l| (Vector3::new(l.x, l.y, (aspect * l.x).min(0.0) + l.y.min(0.0)), l.z))
        .collect();
    let slack = 1e-9 * (size.width_mm + size.height_mm);
    let mut best: Vec<Vector3<f64>> = Vec::new();
    let mut height = 0.0;
    for i in 0..rows.len() {
        for j in 0..i {
            for k in 0..j {
                let a = Matrix3::from_rows(&[
                    rows[i].0.transpose(),
                    rows[j].0.transpose(),
                    rows[k].0.transpose(),
                ]);
                let b = -Vector3::new(rows[i].1, rows[j].1, rows[k].1);
                let Some(v) = a.lu().solve(&b) else { continue };
                let inside = rows.iter().all(|(n, c)| n.dot(&v) + c >= -slack);
                if !inside || v.z.is_nan() || v.z <= slack || v.z < height - slack {
                    continue;
                }
                if v.z > height + slack {
                    best.clear();
                }
                height = height.max(v.z);
                if !best.iter().any(|o| (o - v).norm() <= slack) {
                    best.push(v);
                }
            }
        }
    }
    let n = best.len() as f64;
    let mean = best.into_iter().reduce(|a, b| a + b)? / n;
    Some((Point2::new(mean.x, mean.y), mean.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::calibrate_observations;
    use crate::calibrate::tests::scene::{ideal, observe, pose, rig, rng};
    use crate::geometry::{Distortion, ProjectivePoint};

    fn calibrated() -> Rig {
        let truth = rig(768.0, vec![pose(25.0, 28.0)]);
        calibrate_observations(&observe(&truth, 0.01, 0.01, &mut rng(1)), &ideal()).unwrap().rig
    }

    #[test]
    fn the_rectified_picture_is_upright_on_the_sheet_and_on_the_panel() {
        let rig = calibrated();
        let (a, b) = (Point2::new(-0.5, -0.5), Point2::new(799.5, 599.5));
        let found = rectify(&rig, 0, a, b).unwrap();
        assert!((found.size_mm.width_mm / found.size_mm.height_mm - 4.0 / 3.0).abs() < 1e-12);
        let inside = |x: f64, limit: f64| (-1e-6..=limit + 1e-6).contains(&x);
        assert!(
            inside(found.origin_mm.x, 594.0) && inside(found.origin_mm.x + found.size_mm.width_mm, 594.0)
        );
        assert!(
            inside(found.origin_mm.y, 420.0) && inside(found.origin_mm.y + found.size_mm.height_mm, 420.0)
        );
        let mut touching = 0;
        for c in found.corners_px {
            assert!(inside(c.x + 0.5, 1024.0) && inside(c.y + 0.5, 768.0), "{c}");
            touching += usize::from(c.x < -0.499 || c.x > 1023.499 || c.y < -0.499 || c.y > 767.499);
        }
        let full = (found.size_mm.height_mm - 420.0).abs() < 1e-6;
        assert!(full || touching >= 1, "a larger one would fit: {found:?}");
        // Its sides run through the projector's vanishing points (paper, Fig. 14).
        let [x, y] = rig.views[0].projector_vanishing_points.unwrap();
        let line = |i: usize, j: usize| {
            crate::geometry::Line::through_pixels(found.corners_px[i], found.corners_px[j])
                .normalized()
                .unwrap()
        };
        for (l, v) in [(line(0, 1), x), (line(3, 2), x), (line(0, 3), y), (line(1, 2), y)] {
            assert!(l.signed_distance_px(ProjectivePoint(v).pixel().unwrap()).abs() < 1e-5);
        }
    }

    #[test]
    fn a_distorting_projector_still_draws_straight_sides_inside_its_panel() {
        let mut rig = calibrated();
        let (a, b) = (Point2::new(-0.5, -0.5), Point2::new(799.5, 599.5));
        let straight = rectify(&rig, 0, a, b).unwrap();
        for k1 in [-0.1, 0.1] {
            let mut projector = rig.projector.unwrap();
            projector.device.model.distortion = Distortion { k1, ..Distortion::NONE };
            rig.projector = Some(projector);
            let found = rectify(&rig, 0, a, b).unwrap();
            // Not much of the sheet is given away.
            assert!(found.size_mm.height_mm > 0.85 * straight.size_mm.height_mm, "{found:?}");
            let pose = rig.views[0].projector_from_sheet.unwrap();
            let mut bent: f64 = 0.0;
            for k in 0..=20 {
                for p in [(f64::from(k) / 20.0, 0.0), (1.0, f64::from(k) / 20.0), (0.0, f64::from(k) / 20.0)]
                {
                    let q = found
                        .panel_from_source
                        .map(a + (b - a).component_mul(&Vector2::new(p.0, p.1)))
                        .unwrap();
                    assert!(q.x > -0.501 && q.x < 1023.501 && q.y > -0.501 && q.y < 767.501, "{q}");
                    // Where the projector's light of that pixel falls on the sheet.
                    let ray = pose.inverse().rotation * projector.device.model.bearing(q).unwrap();
                    let centre = pose.inverse().translation;
                    let on_sheet = centre - ray * (centre.z / ray.z);
                    let size = Vector2::new(found.size_mm.width_mm, found.size_mm.height_mm);
                    let wanted = found.origin_mm + size.component_mul(&Vector2::new(p.0, p.1));
                    assert!((on_sheet.xy() - wanted.coords).norm() < 1e-6, "{on_sheet} {wanted}");
                    let ideal = found.panel_from_source.homography.map(a + (b - a) * p.0).unwrap();
                    bent = bent.max((found.panel_from_source.map(a + (b - a) * p.0).unwrap() - ideal).norm());
                }
            }
            assert!(bent > 5.0, "the lens counts: {bent} px");
        }
    }

    #[test]
    fn a_free_position_is_centred() {
        // A square on a wide sheet that is lit completely.
        let sheet = RectangleSize { width_mm: 600.0, height_mm: 200.0 };
        let limits = [
            Vector3::new(1.0, 0.0, 0.0),
            Vector3::new(-1.0, 0.0, 600.0),
            Vector3::new(0.0, 1.0, 0.0),
            Vector3::new(0.0, -1.0, 200.0),
        ];
        let (origin, height) = largest(&limits, 1.0, sheet).unwrap();
        assert!((origin - Point2::new(200.0, 0.0)).norm() < 1e-9 && (height - 200.0).abs() < 1e-9);
    }

    #[test]
    fn nothing_lit_and_nothing_to_draw_are_errors() {
        let mut rig = calibrated();
        assert!(rectify(&rig, 3, Point2::origin(), Point2::new(9.0, 9.0)).is_err());
        assert!(rectify(&rig, 0, Point2::origin(), Point2::new(f64::NAN, 9.0)).is_err());
        if let Some(p) = &mut rig.views[0].projector_from_sheet {
            p.translation.x += 1e5;
        }
        let error = rectify(&rig, 0, Point2::origin(), Point2::new(9.0, 9.0)).unwrap_err();
        assert!(error.to_string().contains("light"), "{error}");
        rig.projector = None;
        assert!(rectify(&rig, 0, Point2::origin(), Point2::new(9.0, 9.0)).is_err());
    }
}
