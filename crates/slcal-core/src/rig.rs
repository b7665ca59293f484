//! A calibrated rig: the hand-over from `calibrate` to everything that uses it.

use nalgebra::{DMatrix, Point2, Vector3};
use serde::{Deserialize, Serialize};

use crate::assumption::{Assumption, AssumptionStatus};
use crate::channel_registration::ChannelRegistration;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{Camera, Pose, RectangleSize, SheetBend};
use crate::named::named;
use crate::parameter::{LensParameter, Parameter, PoseParameter};

/// 1σ of a device's parameters; zero for what was held fixed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DeviceSigma {
    /// Focal length, px.
    pub focal_px: f64,
    /// Principal point, px.
    pub cx_px: f64,
    /// Principal point, px.
    pub cy_px: f64,
    /// k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
    /// Ratio of fy to fx, relative.
    #[serde(default)]
    pub aspect: f64,
}

/// A camera or projector with the uncertainty of its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Device {
    /// The model.
    pub model: Camera,
    /// 1σ of its parameters; `None` where it is not known, as in rigs of other programs.
    pub sigma: Option<DeviceSigma>,
}

impl From<Camera> for Device {
    /// Without uncertainty.
    fn from(model: Camera) -> Self {
        Self { model, sigma: None }
    }
}

/// The rigid transform from the camera's frame to the projector's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StereoPose {
    /// X_projector = R · X_camera + t.
    pub pose: Pose,
    /// 1σ of t, mm.
    pub sigma_t_mm: Option<[f64; 3]>,
    /// 1σ of a small rotation about the projector's axes, rad.
    pub sigma_r_rad: Option<[f64; 3]>,
}

impl From<Pose> for StereoPose {
    /// Without uncertainty.
    fn from(pose: Pose) -> Self {
        Self { pose, sigma_t_mm: None, sigma_r_rad: None }
    }
}

/// A calibrated projector: its optics and its pose relative to the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projector {
    /// The projector as an inverse camera.
    pub device: Device,
    /// Where it is: X_projector = R · X_camera + t.
    pub from_camera: StereoPose,
    /// Whether its pictures appear with left and right exchanged, as in rear projection or by way of a mirror: column c of a picture
    /// counts as column width − 1 − c of the panel.
    pub mirrored: bool,
}

/// Root mean square residuals of one view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ViewRms {
    /// Distance of the sheet's edge points (or corners) from the model, camera px.
    pub edges: f64,
    /// Distance of the projected corners from the model, camera px.
    pub corners: Option<f64>,
    /// The same distance carried to the projector's image, projector px.
    pub projector: Option<f64>,
}

/// How the sheet of a view bends out of its mean plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewBend {
    /// The estimate.
    pub shape: SheetBend,
    /// 1σ of its coefficients, mm.
    pub sigma_mm: [f64; 12],
    /// 1σ that was expected of each coefficient before the photograph, around zero, mm.
    pub expected_mm: [f64; 12],
}

/// How far the sheet of a view bends out of its mean plane, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sag {
    /// Height of the peak over the valley, mm.
    pub sag_mm: f64,
    /// 1σ of it, mm.
    pub sigma_mm: f64,
    /// The point of the sheet that lies furthest from the viewer, mm from its top left corner.
    pub valley: Point2<f64>,
    /// The point that lies nearest to the viewer.
    pub peak: Point2<f64>,
}

impl Sag {
    /// Whether the sheet is known to bend: two σ or more.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.sag_mm >= 2.0 * self.sigma_mm
    }
}

/// One pose of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Name of the photograph, as the caller gave it.
    pub photo: Option<String>,
    /// Size of the sheet.
    pub size: RectangleSize,
    /// X_camera = R · X_sheet + t, of the sheet's mean plane.
    pub camera_from_sheet: Pose,
    /// How the sheet bends; `None` where it was taken for flat.
    pub bend: Option<ViewBend>,
    /// X_projector = R · X_sheet + t.
    pub projector_from_sheet: Option<Pose>,
    /// Vanishing points of the sheet's width and height in the camera, homogeneous px (z is 0 at infinity).
    pub camera_vanishing_points: [Vector3<f64>; 2],
    /// The same in the projector.
    pub projector_vanishing_points: Option<[Vector3<f64>; 2]>,
    /// Corners of the sheet TL, TR, BR, BL in the camera image, px.
    pub corners_px: [Point2<f64>; 4],
    /// Residuals; `None` in rigs of other programs that do not state them.
    pub rms_px: Option<ViewRms>,
    /// How much of the lit sheet is overexposed in the photograph, per cent; `None` where nothing is, or it was not measured.
    pub clipped_percent: Option<f64>,
}

impl View {
    /// The sheet's sides as the camera sees them, px: TL to TR, to BR, to BL and back to TL, each as `steps` + 1 points that follow
    /// the sheet's bend and the lens's distortion. `None` where the camera cannot see them.
    #[must_use]
    pub fn sides_px(&self, camera: &Camera, steps: usize) -> Option<[Vec<Point2<f64>>; 4]> {
        let corners = self.size.corners();
        let shape = self.bend.map_or(SheetBend::FLAT, |b| b.shape);
        let mut sides: [Vec<Point2<f64>>; 4] = Default::default();
        for (i, side) in sides.iter_mut().enumerate() {
            let (from, to) = (corners[i], corners[(i + 1) % 4]);
            for k in 0..=steps.max(1) {
                let at = from + (to - from) * (k as f64 / steps.max(1) as f64);
                side.push(camera.project(&self.camera_from_sheet.transform(&shape.point(self.size, at)))?);
            }
        }
        Some(sides)
    }
}

/// Quality of a calibration in one word, from the worst of the σ of both focal lengths and of the depth of a point at the sheet's
/// distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// σ below 4 %.
    Good,
    /// Below 10 %.
    Fair,
    /// Below 25 %.
    Weak,
    /// 25 % or more: the photographs do not determine the rig.
    Degenerate,
}

impl Verdict {
    /// Good below this relative σ, the largest of the focal lengths and the depth.
    pub const GOOD_BELOW: f64 = 0.04;
    /// Fair below this one.
    pub const FAIR_BELOW: f64 = 0.10;
    /// Weak below this one, and degenerate from it on.
    pub const WEAK_BELOW: f64 = 0.25;

    /// The verdict on a relative σ of the focal length; NaN is degenerate.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::Verdict;
    ///
    /// assert_eq!(Verdict::of_focal_sigma(0.02), Verdict::Good);
    /// assert_eq!(Verdict::of_focal_sigma(f64::NAN), Verdict::Degenerate);
    /// assert!(Verdict::Good < Verdict::Fair);
    /// ```
    #[must_use]
    pub fn of_focal_sigma(share: f64) -> Self {
        match share {
            s if s < Self::GOOD_BELOW => Self::Good,
            s if s < Self::FAIR_BELOW => Self::Fair,
            s if s < Self::WEAK_BELOW => Self::Weak,
            _ => Self::Degenerate,
        }
    }
}

named!(Verdict, "verdict", { Good => "good", Fair => "fair", Weak => "weak", Degenerate => "degenerate" });

/// A problem that was noticed, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Warning {
    /// Stable identifier.
    pub code: String,
    /// The problem, with numbers.
    pub message: String,
    /// What to do.
    pub advice: String,
}

/// The assessment of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// The assessment in one word.
    pub verdict: Verdict,
    /// 1σ of the camera's focal length, per cent.
    pub focal_sigma_percent_camera: f64,
    /// 1σ of the projector's focal length, per cent.
    pub focal_sigma_percent_projector: Option<f64>,
    /// 1σ of the depth of a point at the sheet's distance that the rig's own uncertainty causes, per cent.
    pub depth_sigma_percent: Option<f64>,
    /// Expected 1σ of a reconstructed point at the sheet's distance, mm.
    pub expected_point_sigma_mm: Option<f64>,
    /// The reason of the verdict in one sentence: the pose of the sheet and the resulting σ of the focal length, or the
    /// misfit that made the verdict worse. Empty in rigs that do not state it.
    pub cause: String,
    /// What would improve the result, with predicted numbers where the geometry limits it. Empty in rigs that do not state
    /// it.
    pub advice: String,
    /// Further problems.
    pub warnings: Vec<Warning>,
    /// What the calibration takes for given, with what it would cost if it were otherwise; empty in rigs that do not state it.
    pub assumptions: Vec<Assumption>,
}

impl Quality {
    /// The assumptions that nothing confirms and that would cost more than the stated 1σ: what the verdict rests on.
    pub fn rests_on(&self) -> impl Iterator<Item = &Assumption> {
        let beyond = |moved: Option<f64>, sigma: Option<f64>| {
            moved.zip(sigma).is_some_and(|(moved, sigma)| moved.abs() > sigma)
        };
        self.assumptions.iter().filter(move |a| {
            let m = &a.moves_percent;
            a.status == AssumptionStatus::Assumed
                && (beyond(m.f_cam, Some(self.focal_sigma_percent_camera))
                    || beyond(m.f_proj, self.focal_sigma_percent_projector)
                    || beyond(m.baseline, self.depth_sigma_percent))
        })
    }
}

impl Warning {
    pub(crate) fn new(code: &str, message: String, advice: impl Into<String>) -> Self {
        Self { code: code.into(), message, advice: advice.into() }
    }
}

/// Covariance of all estimated parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// The parameters of rows and columns.
    pub parameters: Vec<Parameter>,
    /// Symmetric, in the units of the parameters (px, mm, rad).
    pub matrix: DMatrix<f64>,
}

/// A calibrated camera, and projector if a pattern was seen.
///
/// # Examples
/// ```
/// # let rig = slcal_core::format::read_rig(&include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/truth_rig.json"))[..])?;
/// let projector = rig.projector.expect("this rig has one");
/// assert_eq!((projector.device.model.width, rig.camera.model.width), (1024, 1280));
/// // Where the projector's centre stands in the camera's frame, mm.
/// let place = projector.from_camera.pose.centre();
/// assert!((place.coords.norm() - rig.baseline_mm().unwrap()).abs() < 1e-9);
/// # Ok::<(), slcal_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The camera.
    pub camera: Device,
    /// The projector; `None` for a camera that was calibrated without a pattern.
    pub projector: Option<Projector>,
    /// The poses that it was calibrated from.
    pub views: Vec<View>,
    /// How it was made: "ml", "two-vp", or anything else for rigs from elsewhere.
    pub method: String,
    /// The judgement on it.
    pub quality: Option<Quality>,
    /// Covariance of the estimate.
    pub covariance: Option<Covariance>,
    /// How red and blue are displaced against green in projector and camera; `None` where the photographs have no colour, or show too
    /// few corners.
    pub channel_registration: Option<ChannelRegistration>,
}

/// [`Rig::check_photo_size`] by the size alone.
pub(crate) fn check_photo_size([width, height]: [u32; 2], found: [usize; 2]) -> Result<()> {
    if found == [width as usize, height as usize] {
        return Ok(());
    }
    Err(Error::invalid(
        ErrorSubject::Photograph,
        format!("the size of the rig's camera, {width}x{height} px"),
        format!("{}x{} px; take it with the same camera at the same setting", found[0], found[1]),
    ))
}

impl Rig {
    /// The devices by their names in files: "camera", and "projector" if there is one.
    pub fn devices(&self) -> impl Iterator<Item = (&'static str, &Device)> {
        let projector = self.projector.as_ref().map(|p| ("projector", &p.device));
        [("camera", &self.camera)].into_iter().chain(projector)
    }

    /// Checks that a photograph has the size of the camera's images, px.
    ///
    /// # Errors
    /// [`Error::Invalid`] with both sizes.
    pub fn check_photo_size(&self, size: [usize; 2]) -> Result<()> {
        check_photo_size(self.camera.model.size(), size)
    }

    /// Whether pictures appear with left and right exchanged: [`Projector::mirrored`].
    #[must_use]
    pub fn is_mirrored(&self) -> bool {
        self.projector.is_some_and(|p| p.mirrored)
    }

    /// Distance between the optical centres, mm; `None` without a projector.
    #[must_use]
    pub fn baseline_mm(&self) -> Option<f64> {
        self.projector.map(|p| p.from_camera.pose.translation.norm())
    }

    /// 1σ of [`baseline_mm`](Self::baseline_mm), mm, from the covariance of the whole estimate: the components of t are
    /// strongly correlated, so that their own σ would not do. `None` where the rig has no such covariance.
    #[must_use]
    pub fn baseline_sigma_mm(&self) -> Option<f64> {
        let along = self.projector?.from_camera.pose.translation.try_normalize(0.0)?;
        self.stereo_sigma(&along, &Vector3::zeros())
    }

    /// 1σ of the rotation angle between the devices, rad: of a small rotation that follows another, the part along the
    /// axis of the other changes the angle. `None` where the rig has no such covariance, or the devices are not rotated.
    #[must_use]
    pub fn rotation_sigma_rad(&self) -> Option<f64> {
        let axis = self.projector?.from_camera.pose.rotation.axis()?;
        self.stereo_sigma(&Vector3::zeros(), &axis)
    }

    /// 1σ of the projector's optical centre −Rᵀ t, in the camera's frame, mm. `None` where the rig has no such covariance.
    #[must_use]
    pub fn projector_centre_sigma_mm(&self) -> Option<[f64; 3]> {
        let Pose { rotation, translation } = self.projector?.from_camera.pose;
        // A rotation by r about the projector's axes and a change of t by d move the centre by Rᵀ (r × t − d).
        let sigma = |axis: Vector3<f64>| {
            let along = rotation * axis;
            self.stereo_sigma(&-along, &translation.cross(&along))
        };
        Some([sigma(Vector3::x())?, sigma(Vector3::y())?, sigma(Vector3::z())?])
    }

    /// 1σ of fy, px, for each of the [`devices`](Self::devices): that of fx and of their ratio together. `None` where the rig has no
    /// covariance, or the focal length was held fixed.
    pub fn fy_sigmas_px(&self) -> impl Iterator<Item = Option<f64>> {
        type Of = fn(LensParameter) -> Parameter;
        let models = self.devices().map(|(_, d)| d.model.intrinsics);
        models.zip([Parameter::Camera as Of, Parameter::Projector as Of]).map(|(k, of)| {
            let known =
                |p: &LensParameter| self.covariance.as_ref().is_some_and(|c| c.parameters.contains(&of(*p)));
            let mut weights = vec![(of(LensParameter::Focal), k.fy / k.fx)];
            // Its ratio to fx is relative.
            weights.extend(Some((of(LensParameter::Aspect), k.fy)).filter(|_| known(&LensParameter::Aspect)));
            self.sigma_along(&weights)
        })
    }

    /// How far the sheet of view `i` bends, and where; `None` where it was taken for flat.
    #[must_use]
    pub fn sag(&self, i: usize) -> Option<Sag> {
        let view = self.views.get(i)?;
        let ViewBend { shape, sigma_mm, .. } = view.bend?;
        let [valley, peak] = shape.valley_and_peak(view.size);
        let [low, high] = [valley, peak].map(|p| shape.height(view.size, p).0);
        let weights = SheetBend::by_terms(view.size, valley) - SheetBend::by_terms(view.size, peak);
        let named: Vec<_> = weights.iter().enumerate().map(|(k, w)| (Parameter::Bend(i, k), *w)).collect();
        let alone = || weights.iter().zip(sigma_mm).map(|(w, s)| (w * s).powi(2)).sum::<f64>().sqrt();
        let sigma_mm = self.sigma_along(&named).unwrap_or_else(alone);
        Some(Sag { sag_mm: low - high, sigma_mm, valley, peak })
    }

    /// √(uᵀ C u) with C the covariance of t and of the rotation between the devices, and u the given weights.
    fn stereo_sigma(&self, of_t: &Vector3<f64>, of_rotation: &Vector3<f64>) -> Option<f64> {
        let weights = PoseParameter::ALL.into_iter().zip(of_rotation.iter().chain(of_t));
        let named: Vec<_> = weights.map(|(p, w)| (Parameter::ProjectorFromCamera(p), *w)).collect();
        self.sigma_along(&named)
    }

    /// √(uᵀ C u) with u the given weights of parameters; `None` where one of them has no covariance.
    fn sigma_along(&self, weights: &[(Parameter, f64)]) -> Option<f64> {
        let covariance = self.covariance.as_ref()?;
        let mut u = Vec::new();
        for (wanted, weight) in weights.iter().filter(|(_, w)| *w != 0.0) {
            u.push((covariance.parameters.iter().position(|p| p == wanted)?, *weight));
        }
        let c = |i: usize, j: usize| covariance.matrix.get((i, j)).copied().unwrap_or(f64::NAN);
        let variance: f64 = u.iter().flat_map(|(i, a)| u.iter().map(move |(j, b)| a * b * c(*i, *j))).sum();
        (variance.is_finite() && variance >= 0.0).then(|| variance.sqrt())
    }

    /// The projector, for what cannot be done without one.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig that holds the camera alone.
    pub fn require_projector(&self) -> Result<&Projector> {
        self.projector.as_ref().ok_or_else(|| {
            let expected = "a calibrated projector (calibrate with a pattern)";
            Error::invalid(ErrorSubject::Rig, expected, "a rig that holds the camera alone")
        })
    }

    /// The projector, when `what` is for it: a pattern that was drawn for a panel of this size.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig that holds the camera alone, and for another panel.
    pub fn projector_for(&self, what: ErrorSubject, panel: [u32; 2]) -> Result<&Projector> {
        let projector = self.require_projector()?;
        let [w, h] = projector.device.model.size();
        if panel != [w, h] {
            let expected = format!("a pattern for the rig's projector of {w}x{h} px");
            return Err(Error::invalid(what, expected, format!("one for {}x{} px", panel[0], panel[1])));
        }
        Ok(projector)
    }

    /// The camera's viewing direction onto the sheet of view `i`: angle between optical axis and the sheet's normal, rad.
    #[must_use]
    pub fn tilt_rad(&self, i: usize) -> Option<f64> {
        let view = self.views.get(i)?;
        Some((view.camera_from_sheet.rotation * Vector3::z()).angle(&Vector3::z()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Distortion, Intrinsics};

    #[test]
    fn the_baselines_sigma_counts_correlations() {
        let model = Camera {
            width: 640,
            height: 480,
            intrinsics: Intrinsics::square(800.0, Point2::new(319.5, 239.5)),
            distortion: Distortion::default(),
        };
        // t = 5 along (3, 4, 0)/5; an error of it across the baseline only, fully correlated between x and y.
        let across = Vector3::new(-0.8, 0.6, 0.0) * 2.0;
        let pose = Pose { translation: Vector3::new(3.0, 4.0, 0.0), ..Pose::identity() };
        let mut rig = Rig {
            camera: model.into(),
            projector: Some(Projector { device: model.into(), from_camera: pose.into(), mirrored: false }),
            views: Vec::new(),
            method: "ml".into(),
            quality: None,
            covariance: None,
            channel_registration: None,
        };
        assert_eq!(rig.baseline_mm(), Some(5.0));
        assert_eq!(rig.baseline_sigma_mm(), None);
        let along = Vector3::new(0.6, 0.8, 0.0);
        let matrix = across * across.transpose() + along * along.transpose() * 0.25;
        rig.covariance = Some(Covariance {
            parameters: PoseParameter::ALL[3..].iter().map(|p| Parameter::ProjectorFromCamera(*p)).collect(),
            matrix: DMatrix::from_iterator(3, 3, matrix.iter().copied()),
        });
        assert!((rig.baseline_sigma_mm().unwrap() - 0.5).abs() < 1e-12);

        // Small rotations about x and y do not change the angle of a rotation about z.
        assert_eq!(rig.rotation_sigma_rad(), None);
        let turned = Pose { rotation: nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5), ..pose };
        rig.projector.as_mut().unwrap().from_camera.pose = turned;
        rig.covariance = Some(Covariance {
            parameters: PoseParameter::ALL[..3].iter().map(|p| Parameter::ProjectorFromCamera(*p)).collect(),
            matrix: DMatrix::from_diagonal(&nalgebra::dvector![1e-6, 4e-6, 9e-6]),
        });
        assert!((rig.rotation_sigma_rad().unwrap() - 3e-3).abs() < 1e-15);
        rig.projector.as_mut().unwrap().from_camera.pose = pose;
        assert_eq!(rig.rotation_sigma_rad(), None);
    }

    fn bent_view(coefficient: f64) -> View {
        let mut shape = SheetBend::FLAT;
        shape.0[0] = coefficient;
        View {
            photo: None,
            size: RectangleSize { width_mm: 200.0, height_mm: 100.0 },
            camera_from_sheet: Pose { translation: Vector3::new(-100.0, -50.0, 500.0), ..Pose::identity() },
            bend: Some(ViewBend { shape, sigma_mm: [0.1; 12], expected_mm: [1.0; 12] }),
            projector_from_sheet: None,
            camera_vanishing_points: [Vector3::x(), Vector3::y()],
            projector_vanishing_points: None,
            corners_px: [Point2::origin(); 4],
            rms_px: None,
            clipped_percent: None,
        }
    }

    fn rig_with(view: View) -> Rig {
        let model = Camera {
            width: 640,
            height: 480,
            intrinsics: Intrinsics::square(800.0, Point2::new(319.5, 239.5)),
            distortion: Distortion::default(),
        };
        Rig {
            camera: model.into(),
            projector: None,
            views: vec![view],
            method: "ml".into(),
            quality: None,
            covariance: None,
            channel_registration: None,
        }
    }

    #[test]
    fn the_sag_has_its_sigma_and_its_places() {
        let mut rig = rig_with(bent_view(2.0));
        // P2 is 1 at both ends and -1/2 in the middle: the ends lie further away.
        let sag = rig.sag(0).unwrap();
        assert!((sag.sag_mm - 3.0).abs() < 1e-12 && sag.is_known());
        assert!([0.0, 200.0].contains(&sag.valley.x) && sag.peak.x == 100.0);
        assert!(sag.sigma_mm >= 0.15);
        // A covariance knows that the other terms are exact.
        let mut matrix = DMatrix::zeros(12, 12);
        matrix[(0, 0)] = 0.04;
        let parameters = (0..12).map(|k| Parameter::Bend(0, k)).collect();
        rig.covariance = Some(Covariance { parameters, matrix });
        assert!((rig.sag(0).unwrap().sigma_mm - 0.3).abs() < 1e-12);
        rig.views[0].bend = None;
        assert!(rig.sag(0).is_none() && rig.sag(1).is_none());
    }

    #[test]
    fn sides_follow_the_bend() {
        let rig = rig_with(bent_view(20.0));
        let camera = &rig.camera.model;
        let bent = rig.views[0].sides_px(camera, 8).unwrap();
        let flat = bent_view(0.0).sides_px(camera, 8).unwrap();
        // Its middle is nearer to the camera, its ends are further away.
        let off = |k: usize| bent[0][k].y - flat[0][k].y;
        assert!(off(4) < -1.0 && off(0) > 1.0 && off(8) > 1.0, "{} {} {}", off(0), off(4), off(8));
        assert!(bent.iter().zip(bent.iter().cycle().skip(1)).all(|(a, b)| a[8] == b[0]));
    }

    #[test]
    fn fy_has_the_sigma_of_fx_and_of_their_ratio() {
        let mut rig = rig_with(bent_view(0.0));
        assert_eq!(rig.fy_sigmas_px().collect::<Vec<_>>(), [None]);
        let [focal, aspect] = [LensParameter::Focal, LensParameter::Aspect].map(Parameter::Camera);
        // fy = fx · ratio: half of the error cancels.
        let (f, a) = (2.0, -1.0 / 800.0);
        rig.covariance = Some(Covariance {
            parameters: vec![focal.clone(), aspect],
            matrix: DMatrix::from_row_slice(2, 2, &[f * f, f * a, a * f, a * a]),
        });
        assert!((rig.fy_sigmas_px().next().unwrap().unwrap() - 1.0).abs() < 1e-9);
        rig.covariance =
            Some(Covariance { parameters: vec![focal], matrix: DMatrix::from_element(1, 1, 9.0) });
        assert_eq!(rig.fy_sigmas_px().next().unwrap(), Some(3.0));
    }

    #[test]
    fn the_sigma_of_the_projectors_centre_follows_changes_of_its_pose() {
        let model = Camera {
            width: 640,
            height: 480,
            intrinsics: Intrinsics::square(800.0, Point2::new(319.5, 239.5)),
            distortion: Distortion::default(),
        };
        let turn = nalgebra::Rotation3::from_scaled_axis;
        let pose = Pose {
            rotation: turn(Vector3::new(0.3, -0.5, 0.1)),
            translation: Vector3::new(-180.0, 40.0, 25.0),
        };
        // One change of the pose, fully correlated, and so small that its square does not count.
        let (r, d) = (Vector3::new(2e-8, -1e-8, 3e-8), Vector3::new(1e-5, 2e-5, -3e-5));
        let changed = Pose { rotation: turn(r) * pose.rotation, translation: pose.translation + d };
        let change = nalgebra::DVector::from_iterator(6, r.iter().chain(&d).copied());
        let rig = Rig {
            camera: model.into(),
            projector: Some(Projector { device: model.into(), from_camera: pose.into(), mirrored: false }),
            views: Vec::new(),
            method: "ml".into(),
            quality: None,
            covariance: Some(Covariance {
                parameters: PoseParameter::ALL.map(Parameter::ProjectorFromCamera).to_vec(),
                matrix: &change * change.transpose(),
            }),
            channel_registration: None,
        };
        let moved = changed.centre() - pose.centre();
        for (sigma, moved) in rig.projector_centre_sigma_mm().unwrap().into_iter().zip(moved.iter()) {
            assert!((sigma - moved.abs()).abs() < 1e-6 * moved.abs() + 1e-12, "{sigma} {moved}");
        }
    }
}
