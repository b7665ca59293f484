//! Where the refinement starts: closed forms per view, robust against a few wrong points.

pub(crate) mod lens_shift;
pub(crate) mod metric;

use nalgebra::Point2;

use self::lens_shift::focal_and_shift;
use self::metric::{centred, focal_from_homographies};
use crate::calibrate::config::CalibrateConfig;
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::assumptions::{PrincipalPointRule, shift_axis};
use crate::estimate::model::FOCAL_RANGE;
use crate::estimate::planar_pose::{CUTOFF, TRIMMING_ROUNDS, camera_from_sheet, pose_from_homography};
use crate::estimate::{Model, Sheet};
use crate::geometry::{Camera, Distortion, Homography, Intrinsics, Pose};
use crate::observations::{Observations, ViewObservation};
use crate::parameter::LensParameter;
use crate::solve::{homography_from_points, robust_scale};

/// Focal lengths, in units of the longer side, from which the refinement is tried when no closed form has a real
/// solution: wide, normal and long lenses.
const GUESSES: [f64; 4] = [0.8, 1.4, 2.5, 6.0];
/// Samples of four pairs that are tried: with one pair in five wrong, all would be spoilt once in 10^14.
const SAMPLES: usize = 60;

/// Distance from where a homography puts a pair's first point to its second.
fn off(h: &Homography, pair: &(Point2<f64>, Point2<f64>)) -> f64 {
    h.map(pair.0).map_or(f64::INFINITY, |q| (q - pair.1).norm())
}

/// The homography through all pairs, or through four of them, that puts most pairs nearest (P. J. Rousseeuw, "Least median
/// of squares regression", 1984): one wrong pair among twelve bends the one through all beyond recognition.
fn least_median(pairs: &[(Point2<f64>, Point2<f64>)]) -> Result<Homography> {
    let median = |h: &Homography| robust_scale(pairs.iter().map(|p| off(h, p)));
    let mut best = homography_from_points(pairs)?;
    let mut least = median(&best);
    // A generator of its own, so that the same pairs give the same answer (D. E. Knuth's MMIX multiplier).
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % pairs.len()
    };
    for _ in 0..SAMPLES {
        let four: [_; 4] = std::array::from_fn(|_| pairs[next()]);
        if let Ok(h) = homography_from_points(&four) {
            let m = median(&h);
            if m < least {
                (best, least) = (h, m);
            }
        }
    }
    Ok(best)
}

/// A homography from pairs of which a few may be wrong: refitted without those that lie off, in units of b.
pub(crate) fn robust_homography(pairs: &[(Point2<f64>, Point2<f64>)]) -> Result<Homography> {
    let mut h = least_median(pairs)?;
    let mut kept = 0;
    for _ in 0..TRIMMING_ROUNDS {
        let off = |p: &(Point2<f64>, Point2<f64>)| off(&h, p);
        let scale = robust_scale(pairs.iter().map(off));
        let near: Vec<_> = pairs.iter().copied().filter(|p| off(p) <= CUTOFF * scale).collect();
        if near.len() < 4.max(pairs.len() / 2) || near.len() == kept {
            break;
        }
        kept = near.len();
        match homography_from_points(&near) {
            Ok(better) => h = better,
            Err(_) => break,
        }
    }
    Ok(h)
}

fn pinhole([width, height]: [u32; 2], intrinsics: Intrinsics) -> Camera {
    Camera { width, height, intrinsics, distortion: Distortion::NONE }
}

fn in_range(f: f64, size: [u32; 2]) -> bool {
    let side = f64::from(size[0].max(size[1]));
    (FOCAL_RANGE[0] * side..=FOCAL_RANGE[1] * side).contains(&f)
}

fn guesses(size: [u32; 2], pp: Point2<f64>) -> impl Iterator<Item = Intrinsics> {
    let side = f64::from(size[0].max(size[1]));
    GUESSES.into_iter().map(move |g| Intrinsics::square(g * side, pp))
}

/// Models of camera and poses to refine from, best first; the second value is the closed form's error.
pub(crate) fn camera_starts(
    observations: &Observations,
    config: &CalibrateConfig,
) -> Result<(Vec<Model>, Option<Error>)> {
    let known = config.known_camera.as_ref();
    let homographies: Vec<Homography> =
        observations.views.iter().map(|v| camera_from_sheet(v, known)).collect::<Result<_>>()?;
    let pp = config.camera_pp.start(observations.camera);
    let mut complaint = None;
    let mut candidates: Vec<Camera> = known.copied().into_iter().collect();
    if candidates.is_empty() {
        let moved: Vec<_> = homographies.iter().map(|h| centred(h, pp)).collect();
        match focal_from_homographies(&moved, ErrorSubject::Camera) {
            Ok(f) if in_range(f, observations.camera) => {
                candidates.push(pinhole(observations.camera, Intrinsics::square(f, pp)));
            }
            Ok(_) => {}
            Err(e) => complaint = Some(e),
        }
    }
    if candidates.is_empty() {
        let expected = config.focal_prior.map(|p| Intrinsics::square(p.focal_px, pp));
        candidates.extend(expected.map(|k| pinhole(observations.camera, k)));
        candidates.extend(guesses(observations.camera, pp).map(|k| pinhole(observations.camera, k)));
    }
    let models = candidates
        .into_iter()
        .filter_map(|camera| {
            let sheet = |(h, v): (&Homography, &ViewObservation)| {
                Some(Sheet::flat(pose_from_homography(h, &camera.intrinsics, v.size.centre())?, v.size))
            };
            let views: Option<Vec<Sheet>> = homographies.iter().zip(&observations.views).map(sheet).collect();
            Some(Model { camera, projector: None, projector_from_camera: Pose::identity(), views: views? })
        })
        .collect();
    Ok((models, complaint))
}

/// The homography sheet (mm) → projector of each view: camera pixels of the pairs are cast onto the sheet.
fn projector_homographies(observations: &Observations, model: &Model) -> Result<Vec<Homography>> {
    let of_view = |(view, sheet): (&ViewObservation, &Sheet)| {
        let sheet_from_camera = sheet.pose.inverse();
        let on_sheet = |p| Some(sheet_from_camera.transform(&model.on_sheet(sheet, p)?).xy());
        let pairs: Vec<_> =
            view.pairs.iter().filter_map(|p| Some((on_sheet(p.camera)?, p.projector))).collect();
        robust_homography(&pairs)
    };
    observations.views.iter().zip(&model.views).map(of_view).collect()
}

/// The panel as the closed forms want it: with square pixels, and lying so that a lens shift is along y.
#[derive(Debug, Clone, Copy)]
struct UprightPanel {
    panel: [u32; 2],
    aspect: f64,
    exchanged: bool,
}

impl UprightPanel {
    fn new(panel: [u32; 2], aspect: f64) -> Self {
        Self { panel, aspect, exchanged: shift_axis(panel, aspect) == LensParameter::Cx }
    }

    fn size(self) -> [f64; 2] {
        let [w, h] = self.panel.map(f64::from);
        if self.exchanged { [h / self.aspect, w] } else { [w, h / self.aspect] }
    }

    fn pixel(self, p: Point2<f64>) -> Point2<f64> {
        let y = (p.y + 0.5) / self.aspect - 0.5;
        if self.exchanged { Point2::new(y, p.x) } else { Point2::new(p.x, y) }
    }

    fn homography(self, h: &Homography) -> Homography {
        let mut m = h.0;
        let moved = m.row(1) / self.aspect + m.row(2) * (0.5 / self.aspect - 0.5);
        m.set_row(1, &moved);
        if self.exchanged {
            m.swap_rows(0, 1);
        }
        Homography(m)
    }

    /// Intrinsics of the panel as it is.
    fn on_panel(self, k: &Intrinsics) -> Intrinsics {
        let (cx, y) = if self.exchanged { (k.cy, k.cx) } else { (k.cx, k.cy) };
        Intrinsics { fy: k.fx * self.aspect, cx, cy: (y + 0.5) * self.aspect - 0.5, ..*k }
    }
}

/// Models with a projector to refine from; the second value is the closed form's error.
///
/// # Errors
/// When the projected corners do not determine a homography.
pub(crate) fn projector_starts(
    observations: &Observations,
    config: &CalibrateConfig,
    panel: [u32; 2],
    model: &Model,
) -> Result<(Vec<Model>, Option<Error>)> {
    let seen = projector_homographies(observations, model)?;
    let upright = UprightPanel::new(panel, config.projector_pixel_aspect.of_projector(panel));
    let homographies: Vec<_> = seen.iter().map(|h| upright.homography(h)).collect();
    let pp = upright.pixel(config.projector_pp.start(panel));
    let at_pp = |pp: Point2<f64>| {
        let moved: Vec<_> = homographies.iter().map(|h| centred(h, pp)).collect();
        focal_from_homographies(&moved, ErrorSubject::Projector).map(|f| Intrinsics::square(f, pp))
    };
    let shifted = matches!(config.projector_pp, PrincipalPointRule::Shift | PrincipalPointRule::Free);
    let first = if shifted { focal_and_shift(&homographies, pp.x, upright.size()) } else { at_pp(pp) };
    let mut complaint = None;
    let mut candidates = Vec::new();
    let in_range = |k: &Intrinsics| in_range(k.fx, panel);
    match first.map(|k| upright.on_panel(&k)) {
        Ok(k) if in_range(&k) => candidates.push(k),
        Ok(_) => {}
        Err(e) => complaint = Some(e),
    }
    if candidates.is_empty() {
        // Shift and focal length cannot be separated: from the usual shifts (none, half the panel up, half down).
        let rows = if shifted { vec![pp.y, 2.0 * pp.y, 0.0] } else { vec![pp.y] };
        let real = rows.into_iter().filter_map(|y| at_pp(Point2::new(pp.x, y)).ok());
        candidates.extend(real.map(|k| upright.on_panel(&k)).filter(in_range));
        candidates.extend(guesses(panel, pp).map(|k| upright.on_panel(&k)));
    }
    let models = candidates
        .into_iter()
        .filter_map(|k| {
            let stereos: Vec<Pose> = seen
                .iter()
                .zip(&observations.views)
                .zip(&model.views)
                .filter_map(|((h, v), sheet)| {
                    Some(pose_from_homography(h, &k, v.size.centre())?.compose(&sheet.pose.inverse()))
                })
                .collect();
            Some(Model {
                projector: Some(pinhole(panel, k)),
                projector_from_camera: medoid(&stereos)?,
                ..model.clone()
            })
        })
        .collect();
    Ok((models, complaint))
}

/// The transform that is nearest to all others, in rotation and in translation relative to its length.
fn medoid(poses: &[Pose]) -> Option<Pose> {
    let apart = |a: &Pose, b: &Pose| {
        a.rotation_vector_from(b).norm()
            + (a.translation - b.translation).norm() / a.translation.norm().max(f64::MIN_POSITIVE)
    };
    let total = |a: &Pose| poses.iter().map(|b| apart(a, b)).sum::<f64>();
    poses.iter().min_by(|a, b| total(a).total_cmp(&total(b))).copied()
}
