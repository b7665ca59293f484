//! Points seen on the sides of a sheet: how far they lie from the image of the side.

use nalgebra::{Matrix2x3, Point2, Point3, SMatrix, Vector2, Vector3};

use super::residual::{Lens2, OnSheet, Pose2, Residual, image, on_sheet, project};
use super::sheet::Sheet;
use crate::geometry::{BentSide, Camera, Shortening, Side};

/// The nearest point of a side is found to this accuracy along the side, px; its distance is of second order in that.
const NEAREST_PX: f64 = 1e-6;
/// Most steps towards it; perspective alone takes two.
const MAX_STEPS: usize = 12;
/// The side is continued by this part of its length beyond its corners.
const BEYOND: f64 = 0.3;

/// A side of a sheet as a camera sees it: what all of its points have in common.
pub(crate) struct SideInImage<'a> {
    camera: &'a Camera,
    sheet: &'a Sheet,
    /// From corner to corner on the flat sheet, mm.
    from: Point2<f64>,
    along: Vector2<f64>,
    curve: BentSide,
    /// The same in the image, px, and the depths of the corners, mm.
    start: Point2<f64>,
    chord: Vector2<f64>,
    depths: [f64; 2],
}

impl<'a> SideInImage<'a> {
    /// `None` where the camera does not see a corner of it.
    pub(crate) fn new(camera: &'a Camera, sheet: &'a Sheet, side: Side) -> Option<Self> {
        let corners = sheet.size.corners();
        let (from, to) = (corners[side as usize], corners[(side as usize + 1) % 4]);
        let ends = [from, to].map(|c| sheet.lift(c));
        let [(a, _), (b, _)] = [image(camera, &ends[0])?, image(camera, &ends[1])?];
        let curve = BentSide::new(&sheet.bend, sheet.size, side);
        let depths = ends.map(|e| e.z);
        Some(Self { camera, sheet, from, along: to - from, curve, start: a, chord: b - a, depths })
    }

    /// Part of the side's length at which its image is nearest to a pixel, and the direction of the side's image there.
    ///
    /// The chord of the image gives the start: along a straight line the image of a part s lies at s·z1/((1 − s)·z0 + s·z1) of it,
    /// with z0 and z1 the depths of its ends. Gauss–Newton steps follow. Of a point far from the side, or beyond its corners, the
    /// last step stands: its distance from that place of the side is still one that falls as the side comes nearer.
    fn nearest(&self, p: Point2<f64>) -> Option<(f64, Vector2<f64>)> {
        let part =
            ((p - self.start).dot(&self.chord) / self.chord.norm_squared()).clamp(-BEYOND, 1.0 + BEYOND);
        let [z0, z1] = self.depths;
        let mut s = (part * z0 / (z1 - part * (z1 - z0))).clamp(-BEYOND, 1.0 + BEYOND);
        let mut last = None;
        // How the sheet shortens changes slowly along the side: it is taken where the side is nearest without it.
        let mut shortened = self.sheet.bend.is_flat();
        let (mut shift, mut shift_by_part) = (Vector2::zeros(), Vector2::zeros());
        for _ in 0..MAX_STEPS {
            let (z, slope) = self.curve.height(s);
            let place = self.from + self.along * s + shift;
            let place = self.sheet.pose.transform(&Point3::new(place.x, place.y, z));
            let (q, by_point) = image(self.camera, &place)?;
            let direction = self.along + shift_by_part;
            let tangent =
                by_point * (self.sheet.pose.rotation * Vector3::new(direction.x, direction.y, slope));
            let step = (p - q).dot(&tangent) / tangent.norm_squared();
            if !step.is_finite() {
                return None;
            }
            last = Some((s, tangent.normalize()));
            if step.abs() * tangent.norm() < NEAREST_PX {
                if shortened {
                    return last;
                }
                (shift, shift_by_part) = (self.curve.shortening(s).shift, self.curve.shift_by_part(s));
                shortened = true;
            }
            s = (s + step).clamp(-BEYOND, 1.0 + BEYOND);
        }
        last
    }

    /// Signed distance of an edge point from the side's image, expected minus seen, px. At the nearest point of the image the
    /// distance changes as that point's own place does across it.
    pub(crate) fn residual(&self, p: Point2<f64>) -> Option<Residual> {
        let (s, tangent) = self.nearest(p)?;
        let at = self.from + self.along * s;
        let Shortening { shift, by_terms } = self.curve.shortening(s);
        let place = Point3::new(at.x + shift.x, at.y + shift.y, self.curve.height(s).0);
        let OnSheet { point, view, bend } = on_sheet(self.sheet, at, place, by_terms);
        let (q, by_point, lens) = project(self.camera, &point)?;
        let across = Vector2::new(-tangent.y, tangent.x);
        let value = across.dot(&(q - p));
        // Only the first row counts.
        let by_point = Matrix2x3::from_rows(&[across.transpose() * by_point, SMatrix::zeros()]);
        let mut camera = Lens2::zeros();
        camera.set_row(0, &(across.transpose() * lens));
        Some(Residual {
            value: Vector2::new(value, 0.0),
            miss: across * value,
            lenses: [camera, Lens2::zeros()],
            projector_from_camera: Pose2::zeros(),
            view: by_point * view,
            bend: by_point * bend,
        })
    }
}
