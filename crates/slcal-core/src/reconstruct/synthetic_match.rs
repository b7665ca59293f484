//! Matches of points that have not been seen, for the prediction of σ.

use nalgebra::Point3;

use super::triangulate::Triangulator;
use super::triangulate_config::TriangulateConfig;
use crate::error::{Error, Result};
use crate::geometry::{Camera, Pose};
use crate::matches::Match;
use crate::pattern::Axis;
use crate::rig::{Projector, Rig};

/// A rig's devices, and how a point in space would be matched by them.
#[derive(Debug, Clone)]
pub(super) struct SyntheticMatches {
    camera: Camera,
    projector: Camera,
    projector_from_camera: Pose,
    axis: Axis,
    sigma_px: f64,
}

impl SyntheticMatches {
    /// For slits along `axis`, whose matches have a noise of `sigma_px` camera px (1σ).
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig without a projector, or a noise that is negative or not finite.
    pub(super) fn new(rig: &Rig, axis: Axis, sigma_px: f64) -> Result<Self> {
        if !(sigma_px.is_finite() && sigma_px >= 0.0) {
            return Err(Error::invalid("the noise of matches", "zero or more pixels", sigma_px));
        }
        let Projector { device, from_camera, .. } = rig.require_projector()?;
        Ok(Self {
            camera: rig.camera.model,
            projector: device.model,
            projector_from_camera: from_camera.pose,
            axis,
            sigma_px,
        })
    }

    /// The triangulator of such matches, which do not lie on scanlines.
    ///
    /// # Errors
    /// As [`Triangulator::new`].
    pub(super) fn triangulator(rig: &Rig) -> Result<Triangulator> {
        Triangulator::off_lines(rig, TriangulateConfig::default())
    }

    /// The camera, whose frame points are in.
    pub(super) fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The match of a point in the camera's frame, mm; `None` where the camera does not see it or the panel does not light it.
    pub(super) fn seen(&self, point: &Point3<f64>) -> Option<Match> {
        let lit = self.projector.project(&self.projector_from_camera.transform(point))?;
        if !self.projector.holds(lit) {
            return None;
        }
        let (projector_column, projector_row) = match self.axis {
            Axis::Columns => (Some(lit.x), None),
            Axis::Rows => (None, Some(lit.y)),
        };
        let found = Match::at(self.camera.project(point)?, projector_column, projector_row);
        Some(Match { sigma_px: self.sigma_px, ..found })
    }
}
