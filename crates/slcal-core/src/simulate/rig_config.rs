//! A camera, a projector whose pattern falls on the middle of a sheet, and that sheet, as a few numbers.

use nalgebra::{Point2, Rotation3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::bend::BendConfig;
use crate::error::{Error, ErrorSubject, Result, within};
use crate::geometry::{Camera, Distortion, Intrinsics, Pose, RectangleSize};
use crate::pattern::{CheckerConfig, CheckerPattern};

/// Sides of images and panels, px: from a thumbnail to more than any sensor has.
const SIDES_PX: [u32; 2] = [64, 100_000];
/// Focal lengths in units of the longer side, as accepted by the estimators (170° to 0.5° of view).
const FOCAL_SIDES: [f64; 2] = [0.05, 100.0];
/// Lens shift in heights of the panel; the largest real one is about 1.3.
const MOST_SHIFT: f64 = 3.0;
/// Lengths, mm: no rig is smaller than a millimetre or larger than a kilometre.
const LENGTHS_MM: [f64; 2] = [1.0, 1e6];
/// Largest plausible distortion coefficient.
const MOST_DISTORTION: f64 = 2.0;
/// Ratios fy/fx; panels with pixels on their corners (diamonds) have 2.
const ASPECTS: [f64; 2] = [0.2, 5.0];

/// A rig. The camera is at the origin, the projector to its right at [`baseline_mm`](Self::baseline_mm). The projector
/// is rotated about its vertical axis only, so that the middle of its pattern falls on the middle of the sheet. A
/// projector with lens shift stands lower and projects upwards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RigConfig {
    /// Width and height of the camera image, px; default 1280×960.
    pub camera: [u32; 2],
    /// Focal length of the camera, px; default 1500.
    pub camera_focal_px: f64,
    /// fy/fx of the camera; `camera_focal_px` is fx. Default 1: square pixels.
    #[serde(skip_serializing_if = "is_one")]
    pub camera_pixel_aspect: f64,
    /// Offset of the camera's principal point from the image's centre, px; default none.
    pub camera_offset_px: [f64; 2],
    /// The camera's k1, k2, p1, p2, k3; default none.
    pub distortion: [f64; 5],
    /// Width and height of the projector's panel, px; default 1024×768.
    pub projector: [u32; 2],
    /// Focal length of the projector, px; default 1700.
    pub projector_focal_px: f64,
    /// fy/fx of the projector; `projector_focal_px` is fx. Default 1: square pixels.
    #[serde(skip_serializing_if = "is_one")]
    pub projector_pixel_aspect: f64,
    /// The projector's k1, k2, p1, p2, k3; default none.
    #[serde(skip_serializing_if = "are_zero")]
    pub projector_distortion: [f64; 5],
    /// Offset of the projector's principal point from the panel's middle column, px; default 0.
    pub projector_offset_px: f64,
    /// Offset of the projector's principal point below the panel's middle row, in heights of the panel; default 0,
    /// usually 0.5 to 1.
    pub lens_shift: f64,
    /// Horizontal distance of the projector from the camera, mm; default 250.
    pub baseline_mm: f64,
    /// The sheet; default 594×420 mm.
    pub size: RectangleSize,
    /// The bend of the sheet; default `None`: flat.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bend: Option<BendConfig>,
    /// Distance of the sheet's middle along the camera's axis, mm; default 1000.
    pub distance_mm: f64,
    /// The projected checkerboard; default as drawn by `slcal pattern checker` (70 inner corners), with smaller squares
    /// where those would not fall on the sheet.
    pub checker: CheckerConfig,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_one(aspect: &f64) -> bool {
    *aspect == 1.0
}

fn are_zero(coefficients: &[f64; 5]) -> bool {
    coefficients.iter().all(|k| *k == 0.0)
}

impl Default for RigConfig {
    fn default() -> Self {
        Self {
            camera: [1280, 960],
            camera_focal_px: 1500.0,
            camera_pixel_aspect: 1.0,
            camera_offset_px: [0.0; 2],
            distortion: [0.0; 5],
            projector: [1024, 768],
            projector_focal_px: 1700.0,
            projector_pixel_aspect: 1.0,
            projector_distortion: [0.0; 5],
            projector_offset_px: 0.0,
            lens_shift: 0.0,
            baseline_mm: 250.0,
            size: RectangleSize { width_mm: 594.0, height_mm: 420.0 },
            bend: None,
            distance_mm: 1000.0,
            checker: CheckerConfig::default(),
        }
    }
}

impl RigConfig {
    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the value, its range and what was given.
    pub fn validate(&self) -> Result<()> {
        for (name, [w, h], focal) in [
            ("camera", self.camera, self.camera_focal_px),
            ("projector", self.projector, self.projector_focal_px),
        ] {
            let [least, most] = SIDES_PX;
            if ![w, h].iter().all(|s| (least..=most).contains(s)) {
                let expected = format!("{least} to {most} px on each side");
                return Err(Error::invalid(
                    ErrorSubject::Part { part: "size", of: name },
                    expected,
                    format!("{w}x{h}"),
                ));
            }
            let side = f64::from(w.max(h));
            within(
                ErrorSubject::Part { part: "focal length", of: name },
                focal,
                FOCAL_SIDES.map(|s| s * side),
                " px",
            )?;
        }
        let [w, h] = self.camera.map(f64::from);
        within("the camera's principal point off the centre", self.camera_offset_px[0], [-w, w], " px")?;
        within("the camera's principal point off the centre", self.camera_offset_px[1], [-h, h], " px")?;
        let w = f64::from(self.projector[0]);
        within("the projector's principal point off the centre", self.projector_offset_px, [-w, w], " px")?;
        within("lens shift", self.lens_shift, [-MOST_SHIFT, MOST_SHIFT], " heights of the panel")?;
        within("baseline", self.baseline_mm, LENGTHS_MM, " mm")?;
        within("distance", self.distance_mm, LENGTHS_MM, " mm")?;
        within("width of the sheet", self.size.width_mm, LENGTHS_MM, " mm")?;
        within("height of the sheet", self.size.height_mm, LENGTHS_MM, " mm")?;
        for (name, aspect) in
            [("camera", self.camera_pixel_aspect), ("projector", self.projector_pixel_aspect)]
        {
            within(ErrorSubject::Part { part: "pixel aspect", of: name }, aspect, ASPECTS, "")?;
        }
        if let Some(bend) = &self.bend {
            bend.validate(self.size)?;
        }
        for k in self.projector_distortion {
            let subject = ErrorSubject::Part { part: "distortion", of: "projector" };
            within(subject, k, [-MOST_DISTORTION, MOST_DISTORTION], "")?;
        }
        for k in self.distortion {
            within("distortion", k, [-MOST_DISTORTION, MOST_DISTORTION], "")?;
        }
        self.checker.validate()
    }

    /// The camera.
    #[must_use]
    pub fn camera(&self) -> Camera {
        let [width, height] = self.camera;
        let [x, y] = self.camera_offset_px;
        let pp = Camera::image_centre(width, height) + Vector2::new(x, y);
        let intrinsics = intrinsics(self.camera_focal_px, self.camera_pixel_aspect, pp);
        Camera { width, height, intrinsics, distortion: Distortion::from_array(self.distortion) }
    }

    /// The projector.
    #[must_use]
    pub fn projector(&self) -> Camera {
        let [width, height] = self.projector;
        let down = self.lens_shift * f64::from(height);
        let pp = Camera::image_centre(width, height) + Vector2::new(self.projector_offset_px, down);
        let intrinsics = intrinsics(self.projector_focal_px, self.projector_pixel_aspect, pp);
        let distortion = Distortion::from_array(self.projector_distortion);
        Camera { width, height, intrinsics, distortion }
    }

    /// The same rig with the projector's principal point moved by columns and rows of the panel, px: the columns replace
    /// [`projector_offset_px`](Self::projector_offset_px), the rows are added to [`lens_shift`](Self::lens_shift).
    #[must_use]
    pub fn with_projector_offset(self, [columns, rows]: [f64; 2]) -> Self {
        let lens_shift = self.lens_shift + rows / f64::from(self.projector[1].max(1));
        Self { projector_offset_px: columns, lens_shift, ..self }
    }

    /// The checkerboard.
    ///
    /// # Errors
    /// [`Error::Invalid`] when it does not fit on the panel.
    pub fn pattern(&self) -> Result<CheckerPattern> {
        CheckerPattern::new(self.projector, &self.checker)
    }

    /// camera → projector, such that the middle of the pattern falls on the middle of the sheet.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the pattern does not fit on the panel, or its middle lies beyond the fold of the projector's
    /// distortion.
    pub fn projector_from_camera(&self) -> Result<Pose> {
        let outline = self.pattern()?.outline();
        let middle = Point2::from((outline[0].coords + outline[2].coords) / 2.0);
        let middle = self.projector().undistort(middle).ok_or_else(|| {
            Error::invalid(
                ErrorSubject::Part { part: "distortion", of: "projector" },
                "coefficients that keep the order of the panel's pixels",
                format!("{:?}", self.projector_distortion),
            )
        })?;
        // Horizontally the ray of the pattern's middle stands at atan(x) from the axis, the sheet at the angle below.
        let towards = -libm::atan2(self.baseline_mm, self.distance_mm);
        let turn = towards - libm::atan(middle.x);
        let rotation = Rotation3::from_axis_angle(&Vector3::y_axis(), -turn);
        let away = Vector3::new(-self.baseline_mm, 0.0, self.distance_mm);
        let depth = (rotation * away).z;
        let centre = Vector3::new(self.baseline_mm, -middle.y * depth, 0.0);
        Ok(Pose { rotation, translation: -(rotation * centre) })
    }
}

fn intrinsics(fx: f64, aspect: f64, principal_point: Point2<f64>) -> Intrinsics {
    Intrinsics { fy: fx * aspect, ..Intrinsics::square(fx, principal_point) }
}
