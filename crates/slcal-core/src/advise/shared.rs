//! What is known of a rig beforehand, and what one view of the sheet tells about it: the same residuals and derivatives as
//! the calibration itself, for one view at a time and with the rig's covariance in place of its photographs.
//!
//! The shared unknowns stand in one fixed order: the camera's lens, the projector's lens, the transform between them. What a
//! rig holds fixed has no variance there.

use nalgebra::{DMatrix, DVector};

use crate::estimate::model::{Layout, Model};
use crate::estimate::residual::{self, LENS, POSE, PointResidual};
use crate::estimate::{Measurement, Target};
use crate::geometry::{Pose, RectangleSize};
use crate::rig::Rig;

/// Number of shared unknowns.
pub(crate) const SHARED: usize = 2 * LENS + POSE;
/// Where the projector's lens begins.
pub(crate) const PROJECTOR: usize = LENS;
/// Where the transform between the devices begins.
pub(crate) const STEREO: usize = 2 * LENS;

const LENS_NAMES: [&str; LENS] = ["focal_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3"];
const POSE_NAMES: [&str; POSE] = ["rx_rad", "ry_rad", "rz_rad", "tx_mm", "ty_mm", "tz_mm"];

/// The shared unknowns and `views` poses after them, all of them free.
pub(crate) fn layout(views: usize) -> Layout {
    Layout {
        camera: std::array::from_fn(Some),
        projector: std::array::from_fn(|i| Some(PROJECTOR + i)),
        stereo: Some(STEREO),
        views: SHARED,
        len: SHARED + POSE * views,
    }
}

/// A rig as a model with one view.
pub(crate) fn model(rig: &Rig, view: Pose) -> Model {
    Model {
        camera: rig.camera.model,
        projector: rig.projector.map(|p| p.device.model),
        projector_from_camera: rig.projector.map_or(Pose::identity(), |p| p.from_camera.pose),
        views: vec![view],
    }
}

/// The covariance of the shared unknowns and of the poses of the first views (focal lengths as ln f), [`SHARED`] + 6 rows per
/// view; zero for what the rig holds fixed or does not speak of. `None` for a rig without covariance, or with one that is
/// no covariance.
pub(crate) fn covariance_of(rig: &Rig, views: usize) -> Option<DMatrix<f64>> {
    let known = rig.covariance.as_ref()?;
    let devices = [("camera", LENS_NAMES.as_slice()), ("projector", &LENS_NAMES)];
    let devices = devices.map(|(of, names)| (of.to_owned(), names));
    let stereo = [("projector_from_camera".to_owned(), POSE_NAMES.as_slice())];
    let poses = (0..views).map(|i| (format!("views[{i}]"), POSE_NAMES.as_slice()));
    let of = devices.into_iter().chain(stereo).chain(poses);
    let names = of.flat_map(|(of, all)| all.iter().map(move |n| format!("{of}.{n}")));
    let at: Vec<Option<usize>> = names.map(|name| known.parameters.iter().position(|p| *p == name)).collect();
    let focal = |i: usize| match i {
        0 => rig.camera.model.intrinsics.fx,
        PROJECTOR => rig.projector.map_or(1.0, |p| p.device.model.intrinsics.fx),
        _ => 1.0,
    };
    let c = DMatrix::from_fn(at.len(), at.len(), |i, j| match (at[i], at[j]) {
        (Some(a), Some(b)) => known.matrix[(a, b)] / (focal(i) * focal(j)),
        _ => 0.0,
    });
    let some = at.iter().flatten().next().is_some();
    (some && c.iter().all(|x| x.is_finite()) && c.diagonal().iter().all(|v| *v >= 0.0)).then_some(c)
}

/// A matrix F with F·Fᵀ equal to a covariance, by the eigenvectors of its correlations: singular ones have a root, too.
pub(crate) fn root(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let sigma: Vec<f64> = covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
    let used: Vec<usize> = (0..sigma.len()).filter(|&i| sigma[i] > 0.0).collect();
    if used.is_empty() {
        return DMatrix::zeros(sigma.len(), 0);
    }
    let correlation = DMatrix::from_fn(used.len(), used.len(), |i, j| {
        covariance[(used[i], used[j])] / (sigma[used[i]] * sigma[used[j]])
    });
    let eigen = correlation.symmetric_eigen();
    let mut root = DMatrix::zeros(sigma.len(), used.len());
    for (row, &i) in used.iter().enumerate() {
        for k in 0..used.len() {
            root[(i, k)] = sigma[i] * eigen.eigenvectors[(row, k)] * eigen.eigenvalues[k].max(0.0).sqrt();
        }
    }
    root
}

/// Whitened residuals of the measurements of one view and their derivatives.
pub(crate) struct Rows {
    pub(crate) residuals: DVector<f64>,
    pub(crate) by_shared: DMatrix<f64>,
    pub(crate) by_view: DMatrix<f64>,
    /// Which rows belong to which measurement.
    pub(crate) of: Vec<usize>,
}

/// The rows of `measurements` (all of view 0 of the model); `None` where the model is not defined.
pub(crate) fn rows(model: &Model, size: RectangleSize, measurements: &[Measurement]) -> Option<Rows> {
    let pose = model.views.first()?;
    let len = |m: &Measurement| if matches!(m.of, Target::Edge(_)) { 1 } else { 2 };
    let of: Vec<usize> =
        measurements.iter().enumerate().flat_map(|(i, m)| std::iter::repeat_n(i, len(m))).collect();
    let mut rows = Rows {
        residuals: DVector::zeros(of.len()),
        by_shared: DMatrix::zeros(of.len(), SHARED),
        by_view: DMatrix::zeros(of.len(), POSE),
        of,
    };
    let mut at = 0;
    for m in measurements {
        let weight = 1.0 / m.sigma_px;
        match m.of {
            Target::Edge(side) => {
                let e = residual::edge(&model.camera, pose, size, side, m.seen)?;
                rows.residuals[at] = e.value * weight;
                for i in 0..LENS {
                    rows.by_shared[(at, i)] = e.camera[i] * weight;
                }
                for i in 0..POSE {
                    rows.by_view[(at, i)] = e.view[i] * weight;
                }
            }
            Target::SheetCorner(corner) => {
                let r = residual::sheet_corner(&model.camera, pose, corner, m.seen)?;
                put(&mut rows, at, &r, weight);
            }
            Target::Pair(q) => {
                let projector = model.projector.as_ref()?;
                let stereo = &model.projector_from_camera;
                let r = residual::projected_corner(&model.camera, projector, stereo, pose, q, m.seen)?;
                put(&mut rows, at, &r, weight);
            }
        }
        at += len(m);
    }
    let finite = rows.residuals.iter().chain(rows.by_shared.iter()).chain(rows.by_view.iter());
    finite.into_iter().all(|x| x.is_finite()).then_some(rows)
}

fn put(rows: &mut Rows, at: usize, r: &PointResidual, weight: f64) {
    for k in 0..2 {
        rows.residuals[at + k] = r.value[k] * weight;
        for i in 0..LENS {
            rows.by_shared[(at + k, i)] = r.camera[(k, i)] * weight;
            rows.by_shared[(at + k, PROJECTOR + i)] = r.projector[(k, i)] * weight;
        }
        for i in 0..POSE {
            rows.by_shared[(at + k, STEREO + i)] = r.stereo[(k, i)] * weight;
            rows.by_view[(at + k, i)] = r.view[(k, i)] * weight;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::tests::scene::{observe, pose, rig, rng};
    use crate::calibrate::{CalibrateConfig, calibrate_observations};

    #[test]
    fn the_root_of_a_rigs_covariance_gives_it_back() {
        let truth = rig(768.0, vec![pose(25.0, 28.0)]);
        let seen = observe(&truth, 0.05, 0.05, &mut rng(1));
        let found = calibrate_observations(&seen, &CalibrateConfig::default()).unwrap().rig;
        let c = covariance_of(&found, 1).unwrap();
        assert_eq!(c.nrows(), SHARED + POSE);
        let back = root(&c);
        let back = &back * back.transpose();
        for i in 0..c.nrows() {
            for j in 0..c.ncols() {
                let scale = (c[(i, i)] * c[(j, j)]).sqrt();
                assert!((c[(i, j)] - back[(i, j)]).abs() <= 1e-9 * scale, "{i} {j}");
            }
        }
        // No distortion was estimated: it has no variance.
        assert_eq!(c[(3, 3)], 0.0);
        let sigma = found.projector.unwrap().device.sigma.unwrap();
        let f = found.projector.unwrap().device.model.intrinsics.fx;
        assert!((c[(PROJECTOR, PROJECTOR)].sqrt() * f / sigma.focal_px - 1.0).abs() < 1e-9);
    }
}
