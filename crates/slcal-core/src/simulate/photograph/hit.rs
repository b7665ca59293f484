//! The intersection of a ray with a surface.

use nalgebra::Vector3;

/// The intersection of a ray with a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// In lengths of the ray's direction.
    pub(super) distance: f64,
    /// Not normalised, of either sign.
    pub(super) normal: Vector3<f64>,
}
