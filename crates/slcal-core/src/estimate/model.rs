//! The unknowns of the joint problem: which there are, where they stand in the vector, what is known beforehand.

use nalgebra::{DMatrix, DVector, Point2, Rotation3, Vector3};

use super::residual::{LENS, POSE};
use crate::calibrate::config::{CalibrateConfig, DistortionModel, PrincipalPointRule};
use crate::geometry::{Camera, Distortion, Intrinsics, Pose};

/// 1σ of a principal point that is free, in widths: no information, but never a singular matrix.
const FREE_WIDTHS: f64 = 10.0;
/// 1σ of the vertical principal point of a lens-shifted projector, in heights around the centre; published ones lie 0.5
/// to 1.3 heights off, and a narrower prior would pull them inwards.
const SHIFT_HEIGHTS: f64 = 4.0;
/// 1σ of the tangential coefficients and of k3; real lenses stay below.
const TANGENTIAL_SIGMA: f64 = 0.01;
/// A focal length outside this range (in units of the longer side of the image) is not that of a lens: 170° to 0.5° of view.
pub(crate) const FOCAL_RANGE: [f64; 2] = [0.05, 100.0];

/// Everything that is estimated, and what is held fixed with it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    pub(crate) camera: Camera,
    pub(crate) projector: Option<Camera>,
    pub(crate) projector_from_camera: Pose,
    pub(crate) views: Vec<Pose>,
}

/// Positions in the vector of unknowns; `None` for what is held fixed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    pub(crate) camera: [Option<usize>; LENS],
    pub(crate) projector: [Option<usize>; LENS],
    pub(crate) stereo: Option<usize>,
    pub(crate) views: usize,
    pub(crate) len: usize,
}

/// A lens parameter that is known to be `mean` ± `sigma`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prior {
    pub(crate) of_projector: bool,
    pub(crate) index: usize,
    pub(crate) mean: f64,
    pub(crate) sigma: f64,
}

/// Values of a lens in the order of its parameters.
pub(crate) fn lens_values(c: &Camera) -> [f64; LENS] {
    let d = c.distortion;
    [c.intrinsics.fx.ln(), c.intrinsics.cx, c.intrinsics.cy, d.k1, d.k2, d.p1, d.p2, d.k3]
}

fn moved_lens(c: &Camera, places: &[Option<usize>; LENS], delta: &DVector<f64>) -> Option<Camera> {
    let d = places.map(|p| p.map_or(0.0, |i| delta[i]));
    let (k, grow) = (c.intrinsics, d[0].exp());
    let l = c.distortion;
    let intrinsics = Intrinsics {
        fx: k.fx * grow,
        fy: k.fy * grow,
        skew: k.skew * grow,
        cx: k.cx + d[1],
        cy: k.cy + d[2],
    };
    let side = f64::from(c.width.max(c.height));
    let fine =
        places[0].is_none() || (FOCAL_RANGE[0] * side..=FOCAL_RANGE[1] * side).contains(&intrinsics.fx);
    let distortion =
        Distortion { k1: l.k1 + d[3], k2: l.k2 + d[4], p1: l.p1 + d[5], p2: l.p2 + d[6], k3: l.k3 + d[7] };
    (fine && intrinsics.cx.is_finite() && intrinsics.cy.is_finite()).then_some(Camera {
        intrinsics,
        distortion,
        ..*c
    })
}

fn moved_pose(p: &Pose, at: usize, delta: &DVector<f64>) -> Pose {
    let turn = Rotation3::new(Vector3::new(delta[at], delta[at + 1], delta[at + 2]));
    let shift = Vector3::new(delta[at + 3], delta[at + 4], delta[at + 5]);
    Pose { rotation: turn * p.rotation, translation: p.translation + shift }
}

impl Model {
    /// The model after a step.
    pub(crate) fn moved(&self, layout: &Layout, delta: &DVector<f64>) -> Option<Self> {
        Some(Self {
            camera: moved_lens(&self.camera, &layout.camera, delta)?,
            projector: match &self.projector {
                Some(p) => Some(moved_lens(p, &layout.projector, delta)?),
                None => None,
            },
            projector_from_camera: layout
                .stereo
                .map_or(self.projector_from_camera, |at| moved_pose(&self.projector_from_camera, at, delta)),
            views: self.views.iter().enumerate().map(|(i, v)| moved_pose(v, layout.view(i), delta)).collect(),
        })
    }

    /// Removes the drift from orthonormality that products of rotations collect.
    pub(crate) fn renormalise(&mut self) {
        for pose in self.views.iter_mut().chain([&mut self.projector_from_camera]) {
            pose.rotation.renormalize();
        }
    }
}

impl Layout {
    /// The unknowns for `views` views under a configuration, with or without a projector.
    pub(crate) fn new(config: &CalibrateConfig, with_projector: bool, views: usize) -> Self {
        let mut len = 0;
        let mut place = |active: bool| {
            active.then(|| {
                len += 1;
                len - 1
            })
        };
        let pp = |rule| !matches!(rule, PrincipalPointRule::Centre | PrincipalPointRule::Exact(..));
        let coefficients = |model| match model {
            DistortionModel::Auto | DistortionModel::None => 0,
            DistortionModel::K1 => 1,
            DistortionModel::K1K2 => 2,
            DistortionModel::Full => LENS - 3,
        };
        let active = |i: usize, rule, distortion| {
            i == 0 || i < 3 && pp(rule) || i >= 3 && i - 3 < coefficients(distortion)
        };
        let unknown = config.known_camera.is_none();
        let camera =
            std::array::from_fn(|i| place(unknown && active(i, config.camera_pp, config.distortion)));
        let projector = std::array::from_fn(|i| {
            place(with_projector && active(i, config.projector_pp, config.projector_distortion))
        });
        let stereo = with_projector.then_some(len);
        let first_view = len + if with_projector { POSE } else { 0 };
        Self { camera, projector, stereo, views: first_view, len: first_view + POSE * views }
    }

    /// Where view `i` begins.
    pub(crate) fn view(&self, i: usize) -> usize {
        self.views + POSE * i
    }

    /// The same unknowns for another number of views.
    pub(crate) fn with_views(&self, views: usize) -> Self {
        Self { len: self.views + POSE * views, ..self.clone() }
    }

    /// Names of the unknowns, in order.
    pub(crate) fn names(&self) -> Vec<String> {
        const LENS_NAMES: [&str; LENS] = ["focal_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3"];
        const POSE_NAMES: [&str; POSE] = ["rx_rad", "ry_rad", "rz_rad", "tx_mm", "ty_mm", "tz_mm"];
        let mut names = Vec::with_capacity(self.len);
        for (device, places) in [("camera", &self.camera), ("projector", &self.projector)] {
            let active = LENS_NAMES.iter().zip(places).filter(|(_, p)| p.is_some());
            names.extend(active.map(|(n, _)| format!("{device}.{n}")));
        }
        if self.stereo.is_some() {
            names.extend(POSE_NAMES.iter().map(|n| format!("projector_from_camera.{n}")));
        }
        for i in 0..(self.len - self.views) / POSE {
            names.extend(POSE_NAMES.iter().map(|n| format!("views[{i}].{n}")));
        }
        names
    }

    /// A covariance in ln f as one in f.
    pub(crate) fn in_pixels(&self, covariance: &DMatrix<f64>, model: &Model) -> DMatrix<f64> {
        let mut c = covariance.clone();
        let lenses = [Some((self.camera[0], model.camera)), model.projector.map(|p| (self.projector[0], p))];
        for (place, lens) in lenses.into_iter().flatten() {
            if let Some(i) = place {
                c.row_mut(i).scale_mut(lens.intrinsics.fx);
                c.column_mut(i).scale_mut(lens.intrinsics.fx);
            }
        }
        c
    }
}

/// Where a rule puts the principal point of a W×H device.
pub(crate) fn principal_point(rule: PrincipalPointRule, width: u32, height: u32) -> Point2<f64> {
    match rule {
        PrincipalPointRule::Exact(x, y) => Point2::new(x, y),
        _ => Camera::image_centre(width, height),
    }
}

/// What is known beforehand about the unknowns of `layout`.
pub(crate) fn priors(config: &CalibrateConfig, layout: &Layout, model: &Model) -> Vec<Prior> {
    let mut priors = Vec::new();
    let devices = [
        Some((false, &model.camera, config.camera_pp, &layout.camera)),
        model.projector.as_ref().map(|p| (true, p, config.projector_pp, &layout.projector)),
    ];
    for (of_projector, device, rule, places) in devices.into_iter().flatten() {
        let centre = principal_point(rule, device.width, device.height);
        let (w, h) = (f64::from(device.width), f64::from(device.height));
        let near = config.principal_point_sigma * w;
        let sigma = match rule {
            PrincipalPointRule::Prior => [near, near],
            PrincipalPointRule::Shift => [near, SHIFT_HEIGHTS * h],
            _ => [FREE_WIDTHS * w; 2],
        };
        let coefficients = [
            config.distortion_sigma,
            config.distortion_sigma,
            TANGENTIAL_SIGMA,
            TANGENTIAL_SIGMA,
            TANGENTIAL_SIGMA,
        ];
        let focal = config.focal_prior.filter(|_| !of_projector);
        let all = focal
            .map(|f| (0, f.focal_px.ln(), f.sigma_share))
            .into_iter()
            .chain([(1, centre.x, sigma[0]), (2, centre.y, sigma[1])])
            .chain((3..LENS).map(|i| (i, 0.0, coefficients[i - 3])));
        let active = all.filter(|(i, ..)| places[*i].is_some());
        priors.extend(active.map(|(index, mean, sigma)| Prior { of_projector, index, mean, sigma }));
    }
    priors
}

/// How far each prior's parameter lies from its mean, in squares of σ.
pub(crate) fn prior_squares<'a>(priors: &'a [Prior], model: &'a Model) -> impl Iterator<Item = f64> + 'a {
    priors.iter().filter_map(|p| {
        let lens = if p.of_projector { model.projector? } else { model.camera };
        Some(((lens_values(&lens)[p.index] - p.mean) / p.sigma).powi(2))
    })
}
