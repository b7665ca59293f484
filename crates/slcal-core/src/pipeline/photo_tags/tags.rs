//! The tags themselves.

use super::orientation::Orientation;

/// What a camera wrote into a photograph, as the EXIF tags of these names state it. Nothing is checked: programs that edit
/// photographs leave tags that are no longer true.
///
/// # Examples
/// ```
/// use slcal_core::{FocalSource, PhotoTags};
///
/// // The tags of a compact camera that states neither its sensor's size nor a 35 mm equivalent.
/// let mut tags = PhotoTags::default();
/// tags.model = Some("Canon PowerShot G10".into());
/// tags.focal_mm = Some(6.1);
/// let focal = tags.focal([4416, 3312])?;
/// assert!(matches!(focal.source, FocalSource::SensorTable { .. }));
/// assert!((focal.prior.focal_px - 4416.0 * 6.1 / 7.44).abs() < 1.0);
/// # Ok::<(), slcal_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct PhotoTags {
    /// `Make`.
    pub make: Option<String>,
    /// `Model`.
    pub model: Option<String>,
    /// `FocalLength`: the lens's own focal length, mm.
    pub focal_mm: Option<f64>,
    /// `FocalLengthIn35mmFilm`, mm.
    pub focal_35mm: Option<f64>,
    /// `FocalPlaneXResolution`: pixels of the whole picture per [`focal_plane_unit`](Self::focal_plane_unit).
    pub focal_plane_x_resolution: Option<f64>,
    /// `FocalPlaneResolutionUnit`: 2 inches, 3 centimetres, 4 millimetres, 5 micrometres. Inches where it is missing.
    pub focal_plane_unit: Option<u16>,
    /// `PixelXDimension` and `PixelYDimension`: the size of the picture as the camera stored it, before any rotation.
    pub pixels: Option<[u32; 2]>,
    /// `DigitalZoomRatio`; 0 and 1 stand for none.
    pub digital_zoom: Option<f64>,
    /// `Orientation`, by which the pixels were turned upright.
    pub orientation: Orientation,
}

impl PhotoTags {
    /// The digital zoom, if any: a tag of 1 or 0 states that there is none.
    pub(super) fn zoomed(&self) -> Option<f64> {
        /// Ratios nearer to one are the rounding of what states them.
        const ROUNDING: f64 = 0.01;
        self.digital_zoom.filter(|z| z.is_finite() && *z > 0.0 && (z - 1.0).abs() > ROUNDING)
    }
}
