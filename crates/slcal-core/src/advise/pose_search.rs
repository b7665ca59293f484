//! The search for the pose that lowers σ most.

use nalgebra::{Point3, Rotation3, Unit, Vector3};

use super::advice::{Advice, NextView, TiltPrediction};
use super::predicted_covariance::{Knowledge, Predicted};
use crate::geometry::{Pose, RectangleSize};

/// Tilts of the table about either axis, degrees: beyond 40° squares shrink and sheets leave the frame.
const TILTS_DEG: [f64; 9] = [-40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0, 40.0];
/// The best tilt of the table is refined by steps of this size, degrees; nobody turns a sheet more exactly.
const FINE_DEG: f64 = 5.0;
/// Distances that are tried, relative to the sheet's.
const DISTANCES: [f64; 3] = [1.0, 0.8, 1.25];
/// Places that are tried, in parts of the sheet's width and height by which its middle moves away from the pattern's, or,
/// with the camera alone, by which the sheet moves across the frame.
const OFFSETS: [f64; 3] = [0.0, -0.15, 0.15];
/// A pose that differs in more than its tilt must bring σ below this part of what tilt alone does.
const WORTH_THE_TROUBLE: f64 = 0.85;
/// Another photograph is worth it when it brings the worst σ below this part of itself.
const WORTH_ANOTHER: f64 = 0.8;
/// σ of the focal lengths below which nothing more is worth it: a millimetre in a metre.
const GOOD_ENOUGH: f64 = 0.001;

/// R = Rx(a)·Ry(b)·Rz(roll) with the sheet's middle at a point of the camera's frame.
pub(super) fn posed(middle: Point3<f64>, size: RectangleSize, [a, b, roll]: [f64; 3]) -> Pose {
    let turn = |axis: Unit<Vector3<f64>>, angle| Rotation3::from_axis_angle(&axis, angle);
    let rotation = turn(Vector3::x_axis(), a) * turn(Vector3::y_axis(), b) * turn(Vector3::z_axis(), roll);
    let turned = Pose { rotation, translation: Vector3::zeros() };
    Pose { rotation, translation: middle - turned.lift(size.centre()) }
}

/// The angles of [`posed`].
pub(super) fn angles(pose: &Pose) -> [f64; 3] {
    let n = pose.rotation * Vector3::z();
    let (a, b) = ((-n.y).atan2(n.z), n.x.clamp(-1.0, 1.0).asin());
    let rest = (Rotation3::from_axis_angle(&Vector3::x_axis(), a)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), b))
    .inverse()
        * pose.rotation;
    [a, b, rest[(1, 0)].atan2(rest[(0, 0)])]
}

/// Where the sheet stands but for its tilt.
#[derive(Clone, Copy)]
pub(super) struct Stand {
    pub(super) distance_mm: f64,
    pub(super) roll: f64,
    /// In parts of the sheet's width and height.
    pub(super) offset: [f64; 2],
    /// The direction of its middle, without a projector.
    pub(super) towards: Vector3<f64>,
}

impl Knowledge {
    /// The pose with a tilt. With a projector the pattern stays where it is thrown, and the sheet comes under it.
    fn pose(&self, stand: &Stand, tilt: [f64; 2]) -> Option<Pose> {
        let angles = [tilt[0], tilt[1], stand.roll];
        let place = [stand.offset[0] * self.view.size.width_mm, stand.offset[1] * self.view.size.height_mm];
        let (middle, along) = match &self.model.projector {
            Some(projector) => {
                let stereo = &self.model.projector_from_camera;
                let ray =
                    stereo.rotation.inverse() * projector.bearing(self.view.pattern_centre())?.normalize();
                let eye = stereo.centre().coords;
                // |eye + s·ray| = distance, on the far side.
                let (b, c) = (eye.dot(&ray), eye.norm_squared() - stand.distance_mm.powi(2));
                let root = b * b - c;
                if root.is_nan() || root < 0.0 {
                    return None;
                }
                (Point3::from(eye + ray * (root.sqrt() - b)), posed(Point3::origin(), self.view.size, angles))
            }
            None => (Point3::from(stand.towards * stand.distance_mm), Pose::identity()),
        };
        let shift = along.rotation * Vector3::new(place[0], place[1], 0.0);
        Some(posed(middle + shift, self.view.size, angles))
    }

    /// The best feasible tilt in a stand, and its σ.
    fn best(&self, stand: &Stand, pair: bool) -> Option<(Pose, Predicted)> {
        let tilts = TILTS_DEG.iter().flat_map(|&a| TILTS_DEG.iter().map(move |&b| [a, b]));
        let coarse = self.best_of(stand, pair, tilts)?;
        let [a, b, _] = angles(&coarse.0).map(f64::to_degrees);
        let near = [-FINE_DEG, 0.0, FINE_DEG];
        let fine = near.iter().flat_map(|&i| near.iter().map(move |&j| [a + i, b + j]));
        self.best_of(stand, pair, fine)
    }

    fn best_of(
        &self,
        stand: &Stand,
        pair: bool,
        tilts: impl Iterator<Item = [f64; 2]>,
    ) -> Option<(Pose, Predicted)> {
        let tried = tilts.filter_map(|tilt| {
            let (pose, one, both) = self.predict_tilt(stand, tilt.map(f64::to_radians))?;
            Some((pose, if pair { both? } else { one }))
        });
        tried.min_by(|a, b| a.1.worst_focal().total_cmp(&b.1.worst_focal()))
    }

    /// A feasible pose with σ after it, and after it and its reverse (when that is feasible).
    fn predict_tilt(&self, stand: &Stand, tilt: [f64; 2]) -> Option<(Pose, Predicted, Option<Predicted>)> {
        let pose = self.pose(stand, tilt).filter(|p| self.feasible(p))?;
        let one = self.predict(&[pose])?;
        let reversed = self.pose(stand, tilt.map(|t| -t)).filter(|p| self.feasible(p));
        Some((pose, one, reversed.and_then(|r| self.predict(&[pose, r]))))
    }

    fn table(&self, stand: &Stand) -> Vec<TiltPrediction> {
        let tilts =
            TILTS_DEG.iter().flat_map(|&a| TILTS_DEG.iter().map(move |&b| [a, b].map(f64::to_radians)));
        tilts
            .map(|tilt| {
                let found = self.predict_tilt(stand, tilt);
                TiltPrediction {
                    tilt_x_rad: tilt[0],
                    tilt_y_rad: tilt[1],
                    one: found.map(|f| f.1),
                    pair: found.and_then(|f| f.2),
                }
            })
            .collect()
    }

    pub(super) fn advise(&self, stand: &Stand, now: Option<Predicted>) -> Advice {
        let pair = now.is_none();
        let mut best = self.best(stand, pair);
        for distance in DISTANCES {
            for x in OFFSETS {
                for y in OFFSETS {
                    let moved = Stand { distance_mm: stand.distance_mm * distance, offset: [x, y], ..*stand };
                    let found = self.best(&moved, pair);
                    let sigma =
                        |b: &Option<(Pose, Predicted)>| b.map_or(f64::INFINITY, |b| b.1.worst_focal());
                    if sigma(&found) < WORTH_THE_TROUBLE * sigma(&best) {
                        best = found;
                    }
                }
            }
        }
        let next = best.and_then(|(pose, after)| {
            let [tilt_x_rad, tilt_y_rad, _] = angles(&pose);
            let middle = pose.lift(self.view.size.centre());
            let (distance_mm, centre_px) = (middle.coords.norm(), self.model.camera.project(&middle)?);
            let camera_from_sheet = pose;
            Some(NextView { camera_from_sheet, tilt_x_rad, tilt_y_rad, distance_mm, centre_px, after })
        });
        let worth_it = next.is_some_and(|n| {
            now.is_none_or(|now| {
                let worst = now.worst_focal();
                worst > GOOD_ENOUGH && n.after.worst_focal() < WORTH_ANOTHER * worst
            })
        });
        Advice {
            now,
            size: self.view.size,
            distance_mm: stand.distance_mm,
            noise_px: self.noise_px,
            table: self.table(stand),
            next,
            worth_it,
        }
    }
}
