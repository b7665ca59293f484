//! The registration of the colour channels, from the displacements that were seen at corners of the checkerboard.
//!
//! Of a channel, the light of panel pixel q lies beside that of green by
//!
//! ```text
//! d = J (s + m (q − c_p)) + r (u − c_c)
//! ```
//!
//! in the camera image, with u where green is seen, J = ∂u/∂q on the sheet, c_p the middle of the panel and c_c the camera's principal point. The shift s and
//! magnification m are the projector's, r is the camera's lateral colour. All are linear: least squares with priors, reweighted
//! so that a few wrong corners do not matter. A checkerboard on a plane hardly tells m from r, of which it shows the sum; what
//! is usual for lenses divides it.

use nalgebra::{Matrix2, Matrix4, Point2, Vector2, Vector4};

use crate::channel_registration::{
    ChannelDisplacements, ChannelRegistration, LateralColor, PanelDisplacement, RedBlue, RegistrationSource,
};
use crate::geometry::{Camera, Pose};
use crate::observations::{ChannelOffset, Observations};
use crate::rig::{Projector, Rig};
use crate::solve::median;

/// Fewer corners leave the four unknowns of a channel to chance.
const MIN_CORNERS: usize = 12;
/// Lateral colour of camera lenses, 1σ: half a pixel at 1000 px from the centre.
const RADIAL_PRIOR: f64 = 5e-4;
/// The same of projectors.
const SCALE_PRIOR: f64 = 3e-4;
/// Systematic error of a shift, px of the panel, 1σ: what demosaicing, sharpening and compression leave is up to a tenth of
/// the usual shift too small.
const SHIFT_FLOOR_PX: f64 = 0.02;
/// Systematic error of a magnification, 1σ: on rendered photographs of known truth.
const RADIAL_FLOOR: f64 = 1.5e-4;
/// Residuals beyond this many σ count less.
const HUBER: f64 = 2.0;
/// σ of the median of absolute residuals.
const SIGMA_OF_MEDIAN: f64 = 1.4826;
/// Rounds of reweighting; it has converged to far below σ by then.
const ROUNDS: usize = 15;
/// Step of the differences, px of the camera image: far below a square, far above rounding.
const STEP_PX: f64 = 0.5;

/// The registration that the offsets of all photographs show; `None` where there are too few of them.
pub(crate) fn fit(rig: &Rig, observations: &Observations) -> Option<ChannelRegistration> {
    let projector = rig.projector.as_ref()?;
    let camera_centre = rig.camera.model.intrinsics.principal_point();
    let [width, height] = projector.device.model.size();
    let panel_centre = Camera::image_centre(width, height);
    let mut corners: Vec<(&ChannelOffset, [Vector4<f64>; 2])> = Vec::new();
    for (view, seen) in rig.views.iter().zip(&observations.views) {
        for offset in &seen.channel_offsets {
            let Some(j) = camera_by_panel(rig, projector, &view.camera_from_sheet, offset.camera) else {
                continue;
            };
            let scale = j * (offset.projector - panel_centre);
            let radial = offset.camera - camera_centre;
            let row = |k: usize| Vector4::new(j[(k, 0)], j[(k, 1)], scale[k], radial[k]);
            corners.push((offset, [row(0), row(1)]));
        }
    }
    if corners.len() < MIN_CORNERS {
        return None;
    }
    let of = |pick: fn(&ChannelOffset) -> (Vector2<f64>, f64)| {
        let rows = corners.iter().flat_map(|(offset, rows)| {
            let (seen, sigma) = pick(offset);
            [(rows[0] / sigma, seen.x / sigma), (rows[1] / sigma, seen.y / sigma)]
        });
        channel(&rows.collect::<Vec<_>>())
    };
    let (red, red_sigma) = of(|o| (o.offset_px.red, o.sigma_px.red))?;
    let (blue, blue_sigma) = of(|o| (o.offset_px.blue, o.sigma_px.blue))?;
    Some(ChannelRegistration {
        displacements: displacements(red, blue),
        sigma: displacements(red_sigma, blue_sigma),
        from: RegistrationSource::Checker,
        camera_centre,
        panel_centre,
    })
}

fn displacements(red: Vector4<f64>, blue: Vector4<f64>) -> ChannelDisplacements {
    let projector = |v: Vector4<f64>| PanelDisplacement { shift_px: [v[0], v[1]], scale: v[2] };
    let camera = |v: Vector4<f64>| LateralColor { radial: v[3] };
    ChannelDisplacements {
        projector: RedBlue { red: projector(red), blue: projector(blue) },
        camera: RedBlue { red: camera(red), blue: camera(blue) },
    }
}

/// Shift, magnification and radial of one channel with their σ, from equations in units of the corners' σ.
fn channel(rows: &[(Vector4<f64>, f64)]) -> Option<(Vector4<f64>, Vector4<f64>)> {
    let prior = Matrix4::from_diagonal(&Vector4::new(0.0, 0.0, SCALE_PRIOR.powi(-2), RADIAL_PRIOR.powi(-2)));
    let mut residuals = vec![0.0_f64; rows.len()];
    let (mut scatter, mut sizes) = (1.0, Vec::with_capacity(rows.len()));
    let (mut solved, mut information) = (Vector4::zeros(), Matrix4::zeros());
    for _ in 0..ROUNDS {
        let (mut normal, mut side) = (prior, Vector4::zeros());
        for ((row, seen), residual) in rows.iter().zip(&residuals) {
            let weight =
                (HUBER * scatter / residual.abs().max(f64::MIN_POSITIVE)).min(1.0) / (scatter * scatter);
            normal += row * row.transpose() * weight;
            side += row * (seen * weight);
        }
        solved = normal.cholesky()?.solve(&side);
        information = normal;
        for ((row, seen), residual) in rows.iter().zip(&mut residuals) {
            *residual = seen - row.dot(&solved);
        }
        sizes.clear();
        sizes.extend(residuals.iter().map(|r| r.abs()));
        scatter = (SIGMA_OF_MEDIAN * median(&mut sizes)?).max(f64::MIN_POSITIVE.sqrt());
    }
    let variance = information.cholesky()?.inverse().diagonal();
    let floor = Vector4::new(SHIFT_FLOOR_PX, SHIFT_FLOOR_PX, RADIAL_FLOOR, RADIAL_FLOOR);
    let sigma = (variance + floor.component_mul(&floor)).map(f64::sqrt);
    let known = solved.iter().chain(&sigma).all(|x| x.is_finite());
    known.then_some((solved, sigma))
}

/// ∂(camera pixel)/∂(panel pixel) on the sheet's mean plane. A bend tilts it by a degree or two, which changes this by some per cent at most.
fn camera_by_panel(rig: &Rig, projector: &Projector, sheet: &Pose, at: Point2<f64>) -> Option<Matrix2<f64>> {
    let normal = sheet.rotation * nalgebra::Vector3::z();
    let panel = |u: Point2<f64>| {
        let ray = rig.camera.model.bearing(u)?;
        let point = ray * (normal.dot(&sheet.translation) / normal.dot(&ray));
        projector.device.model.project(&projector.from_camera.pose.transform(&point.into()))
    };
    let by = |step: Vector2<f64>| Some((panel(at + step)? - panel(at - step)?) / (2.0 * STEP_PX));
    let columns = [by(Vector2::x() * STEP_PX)?, by(Vector2::y() * STEP_PX)?];
    Matrix2::from_columns(&columns).try_inverse().filter(|j| j.iter().all(|x| x.is_finite()))
}
