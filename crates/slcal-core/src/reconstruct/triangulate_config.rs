//! Configuration and report of triangulation.

use serde::{Deserialize, Serialize};

use super::light_plane::Rejection;
use crate::error::{Error, Result, within};

/// Which intersections are accepted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TriangulateConfig {
    /// Smallest angle between the camera's ray and the light plane, rad. Below it the position along the ray is
    /// undetermined.
    pub min_angle_rad: f64,
    /// 1σ of the projected position of a slit's centre, projector px, in addition to the noise of the match;
    /// independent from slit to slit. Zero unless known: the drawn centre is exact, and the optics belong to the rig.
    pub projector_sigma_px: f64,
    /// Largest distance outside the panel, as a share of its sides, from which the light of a point may come before the
    /// match is rejected. Where column and row are both known, also their largest distance from that light.
    pub panel_margin: f64,
    /// Points at a smaller depth are left out, mm along the camera's optical axis. `None` for no limit.
    pub near_mm: Option<f64>,
    /// Points at a greater depth are left out, mm along the camera's optical axis. `None` for no limit.
    pub far_mm: Option<f64>,
    /// Whether to use several threads (with the feature `rayon`; without it, one thread). The result is the same, bit
    /// for bit.
    pub parallel: bool,
}

impl Default for TriangulateConfig {
    fn default() -> Self {
        Self {
            min_angle_rad: 0.005,
            projector_sigma_px: 0.0,
            panel_margin: 0.05,
            near_mm: None,
            far_mm: None,
            parallel: false,
        }
    }
}

impl TriangulateConfig {
    /// Checks the ranges of the fields.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        within("min_angle_rad", self.min_angle_rad, [0.0, 1.0], "")?;
        within("projector_sigma_px", self.projector_sigma_px, [0.0, 100.0], "")?;
        within("panel_margin", self.panel_margin, [0.0, 100.0], "")?;
        let limits = [("near_mm", self.near_mm), ("far_mm", self.far_mm)];
        for (what, mm) in limits.into_iter().filter_map(|(what, mm)| Some((what, mm?))) {
            if !(mm.is_finite() && mm >= 0.0) {
                return Err(Error::invalid(what, "a finite depth, mm, of zero or more", mm));
            }
        }
        let depth = self.depth_mm();
        if depth.start() >= depth.end() {
            let expected = format!("more than near_mm, {}", depth.start());
            return Err(Error::invalid("far_mm", expected, depth.end()));
        }
        Ok(())
    }

    /// The depths that are kept, mm.
    pub(super) fn depth_mm(&self) -> std::ops::RangeInclusive<f64> {
        self.near_mm.unwrap_or(0.0)..=self.far_mm.unwrap_or(f64::INFINITY)
    }
}

/// Number of points, and rejected matches by reason.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[non_exhaustive]
pub struct TriangulateReport {
    /// Triangulated points.
    pub points: usize,
    /// Neither column nor row is known, a number is not finite, or the lens's model does not reach the pixel.
    pub invalid: usize,
    /// The ray lies (nearly) in the light plane.
    pub grazing: usize,
    /// The ray meets the light plane behind the camera or the projector.
    pub behind: usize,
    /// The light would come from outside the panel.
    pub outside_panel: usize,
    /// Column and row are both known and contradict each other.
    pub contradicting: usize,
    /// The point is nearer than `near_mm` or farther than `far_mm`.
    pub outside_depth: usize,
    /// Whether the rig has a covariance, so that its uncertainty is part of the points' σ. Otherwise σ is the noise of
    /// the matches alone.
    pub rig_sigma_known: bool,
    /// Median 1σ of a point along the camera's ray, mm.
    pub median_sigma_mm: f64,
    /// Median of the part of it that differs from point to point, mm.
    pub median_noise_mm: f64,
}

impl TriangulateReport {
    pub(super) fn count(&mut self, rejection: Rejection) {
        match rejection {
            Rejection::Invalid => self.invalid += 1,
            Rejection::Grazing => self.grazing += 1,
            Rejection::Behind => self.behind += 1,
            Rejection::OutsidePanel => self.outside_panel += 1,
            Rejection::Contradicting => self.contradicting += 1,
            Rejection::OutsideDepth => self.outside_depth += 1,
        }
    }

    #[cfg(feature = "rayon")]
    pub(super) fn add(&mut self, other: &Self) {
        self.invalid += other.invalid;
        self.grazing += other.grazing;
        self.behind += other.behind;
        self.outside_panel += other.outside_panel;
        self.contradicting += other.contradicting;
        self.outside_depth += other.outside_depth;
    }
}
