//! Expected σ of a length between two reconstructed points.

use nalgebra::Point3;

use super::synthetic_match::SyntheticMatches;
use crate::cloud::PointCloud;
use crate::error::Result;
use crate::estimate::propagation::{STEP_SIGMAS, propagate};
use crate::estimate::{Model, Unknowns, covariance};
use crate::matches::Matches;
use crate::parameter::Parameter;
use crate::pattern::Axis;
use crate::rig::Rig;

/// 1σ of a length that is measured between two reconstructed points.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LengthSigma {
    /// By what is not known exactly of the rig, mm: common to all lengths of that place and direction.
    pub rig_mm: f64,
    /// By the noise of the two matches, mm.
    pub noise_mm: f64,
}

impl LengthSigma {
    /// Both together, mm.
    #[must_use]
    pub fn total_mm(&self) -> f64 {
        self.rig_mm.hypot(self.noise_mm)
    }
}

/// 1σ of the length from `a` to `b` (in the camera's frame, mm), seen under slits along `axis` with a noise of
/// `match_sigma_px` camera px, to first order in the rig's covariance. The errors of the two points are largely alike, so
/// that a length is known far better than either end. `None` where an end is not lit or not seen, or where the rig has no
/// covariance of parameters that are known here.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) for a rig without a projector, or a noise that is negative or not finite.
pub fn length_sigma(
    rig: &Rig,
    axis: Axis,
    match_sigma_px: f64,
    [a, b]: [Point3<f64>; 2],
) -> Result<Option<LengthSigma>> {
    let synthetic = SyntheticMatches::new(rig, axis, match_sigma_px)?;
    let (Some(from), Some(to)) = (synthetic.seen(&a), synthetic.seen(&b)) else { return Ok(None) };
    let matches = Matches { items: vec![from, to] };
    let Some(points) = ends(rig, &matches)? else { return Ok(None) };
    let Some(along) = (points[1].0 - points[0].0).try_normalize(0.0) else { return Ok(None) };
    // Noise moves each end along its ray.
    let moved = points.map(|(p, noise)| noise * p.coords.normalize().dot(&along));
    let Some(rig_mm) = rig_share(rig, &matches) else { return Ok(None) };
    Ok(Some(LengthSigma { rig_mm, noise_mm: moved[0].hypot(moved[1]) }))
}

/// A point and its noise along its ray, mm.
type End = (Point3<f64>, f64);

/// Both ends; `None` where one is no point.
fn ends(rig: &Rig, matches: &Matches) -> Result<Option<[End; 2]>> {
    let mut cloud = PointCloud::default();
    SyntheticMatches::triangulator(rig)?.triangulate(matches, &mut cloud);
    Ok(match cloud.points.as_slice() {
        [a, b] => Some([(a.position, a.noise_mm), (b.position, b.noise_mm)]),
        _ => None,
    })
}

/// σ of the length by the rig's covariance; `None` where the rig has none, or one of parameters that are not known here.
fn rig_share(rig: &Rig, matches: &Matches) -> Option<f64> {
    let known = rig.covariance.as_ref()?;
    if known.parameters.iter().any(|p| matches!(p, Parameter::Other(_))) {
        return None;
    }
    let unknowns = Unknowns::all(0, false);
    let model = Model::of_rig(rig).with_views(&[]);
    // Of the bare rig, whose points need no σ of their own.
    let bare = Rig { covariance: None, views: Vec::new(), quality: None, ..rig.clone() };
    let length = |model: &Model| {
        let mut rig = bare.clone();
        rig.camera.model = model.camera;
        rig.projector.as_mut()?.device.model = model.projector?;
        rig.projector.as_mut()?.from_camera.pose = model.projector_from_camera;
        let [(a, _), (b, _)] = ends(&rig, matches).ok()??;
        Some([(b - a).norm()])
    };
    let covariance = covariance::of_rig(rig, &unknowns)?;
    propagate(&covariance, STEP_SIGMAS, |step| length(&model.moved(&unknowns, step)?)).map(|[sigma]| sigma)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, Vector3};

    use super::*;
    use crate::calibrate::tests::scene::{calibrated, size};
    use crate::parameter::PoseParameter;
    use crate::reconstruct::ExpectedUncertainty;
    use crate::rig::Covariance;

    /// The middle of the sheet.
    fn middle(rig: &Rig) -> Point3<f64> {
        let on_sheet = Point3::new(size().width_mm / 2.0, size().height_mm / 2.0, 0.0);
        rig.views[0].camera_from_sheet.transform(&on_sheet)
    }

    #[test]
    fn a_length_along_a_ray_has_a_smaller_sigma_than_its_far_end() {
        // The errors of both ends are alike: the nearer they are to each other, the better known is the length.
        let rig = calibrated();
        let far = middle(&rig);
        let pixel = rig.camera.model.project(&far).unwrap();
        let point = ExpectedUncertainty::new(&rig, Axis::Columns, 0.0).unwrap().at(pixel, far.z).unwrap();
        let lengths = [0.7, 0.5].map(|share| {
            let near = Point3::from(far.coords * share);
            length_sigma(&rig, Axis::Columns, 0.0, [near, far]).unwrap().unwrap()
        });
        assert!(
            lengths[0].rig_mm < lengths[1].rig_mm && lengths[1].rig_mm < point.sigma_mm,
            "{lengths:?} {point:?}"
        );
        assert_eq!(lengths[0].noise_mm, 0.0);
    }

    #[test]
    fn an_uncertain_scale_makes_lengths_uncertain_in_proportion() {
        // The translation uncertain along itself alone is a scale: σ_L / L = σ_t / t for any length.
        let mut rig = calibrated();
        let t = rig.projector.unwrap().from_camera.pose.translation;
        let translation = PoseParameter::ALL[3..].iter().map(|p| Parameter::ProjectorFromCamera(*p));
        let matrix = t * t.transpose() * 0.02_f64.powi(2);
        rig.covariance = Some(Covariance {
            parameters: translation.collect(),
            matrix: DMatrix::from_iterator(3, 3, matrix.iter().copied()),
        });
        let at = middle(&rig);
        for step in
            [Vector3::new(50.0, 0.0, 0.0), Vector3::new(0.0, 20.0, 40.0), at.coords.normalize() * 50.0]
        {
            let found = length_sigma(&rig, Axis::Columns, 0.1, [at - step, at + step]).unwrap().unwrap();
            let expected = 0.02 * 2.0 * step.norm();
            assert!((found.rig_mm / expected - 1.0).abs() < 1e-4, "{} {expected}", found.rig_mm);
            assert!(found.noise_mm > 0.0 && found.total_mm() > found.rig_mm);
        }
    }

    #[test]
    fn what_is_not_known_is_none() {
        let rig = calibrated();
        let at = middle(&rig);
        let behind = Point3::new(0.0, 0.0, -1000.0);
        assert_eq!(length_sigma(&rig, Axis::Columns, 0.1, [at, behind]), Ok(None));
        assert_eq!(length_sigma(&rig, Axis::Columns, 0.1, [at, at]), Ok(None));
        let bare = Rig { covariance: None, ..rig.clone() };
        let beside = at + Vector3::new(50.0, 0.0, 0.0);
        assert_eq!(length_sigma(&bare, Axis::Columns, 0.1, [at, beside]), Ok(None));
        let alone = Rig { projector: None, ..rig };
        assert!(length_sigma(&alone, Axis::Columns, 0.1, [at, beside]).is_err());
        assert!(length_sigma(&calibrated(), Axis::Columns, f64::NAN, [at, beside]).is_err());
    }
}
