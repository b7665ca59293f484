//! The sheet's homography and pose in a camera, in closed form and robust against a few wrong points.

use nalgebra::{Matrix3, Point2};

use crate::error::{Error, Result};
use crate::geometry::{Camera, Homography, Intrinsics, Line, Pose, nearest_rotation};
use crate::observations::{EdgePoint, SheetObservation, ViewObservation};
use crate::solve::{homography_from_points, robust_scale};

/// Points further than this many robust σ from a line or homography are left out of the start.
pub(crate) const CUTOFF: f64 = 4.0;
pub(crate) const TRIMMING_ROUNDS: usize = 5;

/// The ideal pixel (as an undistorted camera of the same K would see it).
pub(crate) fn ideal_pixel(known: Option<&Camera>, p: Point2<f64>) -> Option<Point2<f64>> {
    match known {
        Some(c) if !c.distortion.is_none() => c.undistort(p).map(|x| c.intrinsics.pixel(x)),
        _ => Some(p),
    }
}

/// The line through edge points, without those that lie off it.
fn robust_line(points: &[EdgePoint]) -> Option<Line> {
    let mut kept: Vec<&EdgePoint> = points.iter().collect();
    let mut line = Line::fit(kept.iter().map(|p| p.weighted()))?;
    for _ in 0..TRIMMING_ROUNDS {
        let scale = robust_scale(points.iter().map(|p| line.signed_distance_px(p.position).abs()));
        let next: Vec<&EdgePoint> = points
            .iter()
            .filter(|p| {
                line.signed_distance_px(p.position).abs() <= CUTOFF * scale.max(p.sigma_px.unwrap_or(0.0))
            })
            .collect();
        if next.len() == kept.len() {
            break;
        }
        kept = next;
        match Line::fit(kept.iter().map(|p| p.weighted())) {
            Some(l) => line = l,
            None => break,
        }
    }
    Some(line)
}

/// The sheet's corners TL, TR, BR, BL as ideal pixels.
pub(crate) fn sheet_corners(view: &ViewObservation, known: Option<&Camera>) -> Result<[Point2<f64>; 4]> {
    let failed = || {
        Error::invalid(
            "the sheet's corners",
            "four lines that meet inside the range of the lens model",
            "parallel sides, or corners that the distortion cannot have produced",
        )
    };
    let corners = match &view.sheet {
        SheetObservation::Corners { corners, .. } => {
            let mut ideal = *corners;
            for c in &mut ideal {
                *c = ideal_pixel(known, *c).ok_or_else(failed)?;
            }
            ideal
        }
        SheetObservation::Edges(sides) => {
            let mut lines = [Line(nalgebra::Vector3::zeros()); 4];
            for (line, points) in lines.iter_mut().zip(sides) {
                let ideal: Vec<EdgePoint> = points
                    .iter()
                    .filter_map(|p| Some(EdgePoint { position: ideal_pixel(known, p.position)?, ..*p }))
                    .collect();
                *line = robust_line(&ideal).ok_or_else(failed)?;
            }
            let [top, right, bottom, left] = lines;
            let meet = |a: Line, b: Line| a.meet(b).pixel().ok_or_else(failed);
            [meet(left, top)?, meet(top, right)?, meet(right, bottom)?, meet(bottom, left)?]
        }
    };
    Ok(corners)
}

/// The homography sheet (mm) → ideal camera pixels.
pub(crate) fn camera_from_sheet(view: &ViewObservation, known: Option<&Camera>) -> Result<Homography> {
    let corners = sheet_corners(view, known)?;
    let pairs: Vec<_> = view.size.corners().into_iter().zip(corners).collect();
    homography_from_points(&pairs)
}

/// The sheet's pose in a camera that is known.
pub(crate) fn sheet_pose(view: &ViewObservation, camera: &Camera) -> Option<Pose> {
    let h = camera_from_sheet(view, Some(camera)).ok()?;
    pose_from_homography(&h, &camera.intrinsics, view.size.centre())
}

/// Pose of the sheet from its homography into a device of known K: r1 ∝ K⁻¹h1, r2 ∝ K⁻¹h2, the nearest rotation, the
/// sheet in front. `None` when the homography is singular.
pub(crate) fn pose_from_homography(h: &Homography, k: &Intrinsics, inside: Point2<f64>) -> Option<Pose> {
    let m = k.matrix().try_inverse()? * h.0;
    let depth = m[(2, 0)] * inside.x + m[(2, 1)] * inside.y + m[(2, 2)];
    let m = m * depth.signum();
    let (n1, n2) = (m.column(0).norm(), m.column(1).norm());
    let scale = (n1 * n2).sqrt();
    let (r1, r2) = (m.column(0) / n1, m.column(1) / n2);
    let rotation = nearest_rotation(&Matrix3::from_columns(&[r1, r2, r1.cross(&r2)]))?;
    let translation = m.column(2) / scale;
    translation.iter().all(|x| x.is_finite()).then_some(Pose { rotation, translation })
}
