//! The focal length that the tags state, in pixels.

use std::fmt;

use super::frame::FrameChange;
use super::sensors::{Sensor, sensor};
use super::tags::PhotoTags;
use crate::calibrate::FocalPrior;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::FILM_DIAGONAL_MM;

/// Plausible 35 mm equivalents, mm: from fisheyes to telescopes.
const PLAUSIBLE_MM: std::ops::RangeInclusive<f64> = 5.0..=5000.0;
/// Plausible widths of a sensor, mm: from a webcam's to medium format.
const PLAUSIBLE_SENSOR_MM: std::ops::RangeInclusive<f64> = 3.0..=60.0;
/// Widths of a sensor by the tags and by the table that differ by more are not of the same picture: a program that resized
/// it has changed one of the tags.
const SAME_SENSOR: f64 = 0.1;
/// 1σ of a lens's focal length about the one that is engraved: ISO 517 allows 6 %.
const NOMINAL: f64 = 0.03;
/// 1σ of a sensor's width, by its maker's data or by the tags, which some makers round to hundredths of an inch.
const SENSOR_WIDTH: f64 = 0.02;
/// Distance of a sheet that a lens is focused at, mm: about arm's length. A lens that moves as a whole reaches f²/distance
/// further, others less or nothing: this share of f is 1σ.
const FOCUSED_AT_MM: f64 = 1000.0;

/// Where a [`TaggedFocal`] comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum FocalSource {
    /// `FocalLengthIn35mmFilm`.
    Equivalent,
    /// `FocalLength` and the width of the sensor by `FocalPlaneXResolution`, mm.
    FocalPlane {
        /// Width of the sensor, mm.
        sensor_mm: f64,
    },
    /// `FocalLength` and the sensor of this camera, known from its maker's data.
    SensorTable {
        /// Width of the sensor, mm.
        sensor_mm: f64,
    },
}

/// A camera's focal length by the tags of a photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TaggedFocal {
    /// In pixels of the photograph, with what such tags are good for as σ.
    pub prior: FocalPrior,
    /// The focal length of the tag that was used, mm.
    pub mm: f64,
    /// Which tags were used.
    pub source: FocalSource,
}

impl fmt::Display for TaggedFocal {
    /// "6.1 mm on a sensor 7.44 mm wide".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mm = (100.0 * self.mm).round() / 100.0;
        match self.source {
            FocalSource::Equivalent => write!(f, "{mm} mm (35 mm equivalent)"),
            FocalSource::FocalPlane { sensor_mm } => write!(f, "{mm} mm on a sensor {sensor_mm:.2} mm wide"),
            FocalSource::SensorTable { sensor_mm } => {
                write!(f, "{mm} mm on the camera's sensor, {sensor_mm:.2} mm wide")
            }
        }
    }
}

impl PhotoTags {
    /// The focal length of an uncropped photograph of this width and height, px: by its 35 mm equivalent, or else by the
    /// lens's own focal length and the width of the sensor, which the tags state or the table of common cameras.
    ///
    /// σ is 5 % for a 35 mm equivalent ([`FocalPrior::from_35mm_equivalent`]); otherwise about 4 %, and more for long
    /// lenses, which reach further when they are focused near. Rounding to whole millimetres comes on top.
    ///
    /// # Errors
    /// [`Error::Invalid`] where the tags state none that is plausible, or the photograph was cropped or zoomed digitally.
    pub fn focal(&self, size: [u32; 2]) -> Result<TaggedFocal> {
        let refused = |found: String| {
            Err(Error::invalid(
                ErrorSubject::FocalLength,
                "the tags of an uncropped photograph that state it",
                found,
            ))
        };
        if let Some(zoom) = self.zoomed() {
            return refused(format!("a digital zoom of {zoom:.2}, which the tags may or may not include"));
        }
        let reshaped =
            matches!(self.frame_change(size), Some(FrameChange::Reshaped | FrameChange::Unrelated));
        if let Some([w, h]) = self.pixels.filter(|_| reshaped) {
            return refused(format!("{}x{} pixels of a photograph of {w}x{h}", size[0], size[1]));
        }
        let Some(focal) = self.by_equivalent(size).or_else(|| self.by_sensor(size)) else {
            return refused(match positive(self.focal_mm) {
                Some(mm) => format!("only the actual focal length, {mm:.2} mm, for a sensor of unknown size"),
                None => "no focal length".to_owned(),
            });
        };
        let diagonal_px = f64::from(size[0]).hypot(f64::from(size[1]));
        if PLAUSIBLE_MM.contains(&(focal.prior.focal_px / diagonal_px * FILM_DIAGONAL_MM)) {
            Ok(focal)
        } else {
            refused(format!("{focal}, which no lens has"))
        }
    }

    fn by_equivalent(&self, size: [u32; 2]) -> Option<TaggedFocal> {
        let mm = positive(self.focal_35mm)?;
        let prior = FocalPrior::from_35mm_equivalent(mm, size);
        Some(TaggedFocal { prior, mm, source: FocalSource::Equivalent })
    }

    fn by_sensor(&self, size: [u32; 2]) -> Option<TaggedFocal> {
        let mm = positive(self.focal_mm)?;
        let [long, short] = [size[0].max(size[1]), size[0].min(size[1])].map(f64::from);
        let known = self.model.as_deref().and_then(|model| sensor(self.make.as_deref(), model));
        let by_plane = self.focal_plane_width_mm(long).filter(|width| {
            known.is_none_or(|Sensor { width_mm, .. }| (width / width_mm - 1.0).abs() < SAME_SENSOR)
        });
        let (px_per_mm, source) = match (by_plane, known) {
            (Some(sensor_mm), _) => (long / sensor_mm, FocalSource::FocalPlane { sensor_mm }),
            // A picture of another shape than the sensor's spans one of its sides.
            (None, Some(Sensor { width_mm, height_mm })) => {
                ((long / width_mm).max(short / height_mm), FocalSource::SensorTable { sensor_mm: width_mm })
            }
            (None, None) => return None,
        };
        let prior = FocalPrior { focal_px: mm * px_per_mm, sigma_share: sigma_share(mm) };
        Some(TaggedFocal { prior, mm, source })
    }

    /// Width of the sensor by the resolution of the focal plane, mm. The resolution is that of the picture as the camera
    /// stored it; `long` is the longer side of the photograph, for tags that do not state that size.
    fn focal_plane_width_mm(&self, long: f64) -> Option<f64> {
        let resolution = positive(self.focal_plane_x_resolution)?;
        let unit_mm = match self.focal_plane_unit {
            Some(3) => 10.0,
            Some(4) => 1.0,
            Some(5) => 0.001,
            _ => 25.4,
        };
        let stored = self.pixels.map_or(long, |[w, h]| f64::from(w.max(h)));
        let width = stored / resolution * unit_mm;
        PLAUSIBLE_SENSOR_MM.contains(&width).then_some(width)
    }
}

/// 1σ of a focal length of a lens on a sensor, relative.
fn sigma_share(mm: f64) -> f64 {
    // Written in whole millimetres, or in tenths.
    let step = if mm.fract() == 0.0 { 1.0 } else { 0.1 };
    let rounding = step / (12_f64.sqrt() * mm);
    NOMINAL.hypot(SENSOR_WIDTH).hypot(rounding).hypot(mm / FOCUSED_AT_MM)
}

fn positive(value: Option<f64>) -> Option<f64> {
    value.filter(|v| v.is_finite() && *v > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tags() -> PhotoTags {
        PhotoTags { pixels: Some([4416, 3312]), focal_mm: Some(6.1), ..PhotoTags::default() }
    }

    #[test]
    fn the_resolution_of_the_focal_plane_is_that_of_the_stored_picture() {
        // 4416 pixels over 0.293 inches: 7.442 mm.
        let tags =
            PhotoTags { focal_plane_x_resolution: Some(4416.0 / 0.293), focal_plane_unit: Some(2), ..tags() };
        for (size, scale) in [([4416, 3312], 1.0), ([1104, 828], 0.25), ([3312, 4416], 1.0)] {
            let focal = tags.focal(size).unwrap();
            assert!((focal.prior.focal_px / (scale * 4416.0 * 6.1 / 7.4422) - 1.0).abs() < 1e-4, "{focal:?}");
            assert!(
                matches!(focal.source, FocalSource::FocalPlane { sensor_mm } if (sensor_mm - 7.44).abs() < 0.01)
            );
            assert!((0.03..0.045).contains(&focal.prior.sigma_share));
        }
        // The same in the other units.
        for (unit, mm) in [(3, 10.0), (4, 1.0), (5, 0.001)] {
            let resolution = Some(4416.0 / 7.4422 * mm);
            let tags = PhotoTags {
                focal_plane_x_resolution: resolution,
                focal_plane_unit: Some(unit),
                ..tags.clone()
            };
            assert!((tags.focal([4416, 3312]).unwrap().prior.focal_px - 3619.6).abs() < 1.0, "{unit}");
        }
        let whole = PhotoTags { focal_plane_unit: None, ..tags };
        assert!((whole.focal([4416, 3312]).unwrap().prior.focal_px - 3619.6).abs() < 1.0);
    }

    #[test]
    fn the_equivalent_comes_first_and_the_table_last() {
        let g10 = PhotoTags { model: Some("Canon PowerShot G10".into()), ..tags() };
        let by_table = g10.focal([4416, 3312]).unwrap();
        assert!((by_table.prior.focal_px - 4416.0 * 6.1 / 7.44).abs() < 1e-9);
        assert_eq!(by_table.to_string(), "6.1 mm on the camera's sensor, 7.44 mm wide");
        // A resized picture whose size was rewritten, the resolution not: the tags speak of a sensor of 2.6 mm or 3.7 mm.
        for pixels in [[1536, 1152], [2208, 1656]] {
            let resized =
                PhotoTags { focal_plane_x_resolution: Some(15072.0), pixels: Some(pixels), ..g10.clone() };
            let focal = resized.focal(pixels).unwrap();
            assert_eq!(focal.source, FocalSource::SensorTable { sensor_mm: 7.44 });
            assert!((focal.prior.focal_px - f64::from(pixels[0]) * 6.1 / 7.44).abs() < 1e-9);
        }
        let equivalent = PhotoTags { focal_35mm: Some(28.0), ..g10 };
        let focal = equivalent.focal([4416, 3312]).unwrap();
        assert_eq!(
            (focal.source, focal.to_string().as_str()),
            (FocalSource::Equivalent, "28 mm (35 mm equivalent)")
        );
        assert_eq!(focal.prior, FocalPrior::from_35mm_equivalent(28.0, [4416, 3312]));
    }

    #[test]
    fn pictures_of_another_shape_span_one_side_of_the_sensor() {
        // 4:3 of a sensor of 3:2 keeps its height, 16:9 its width.
        let eos =
            PhotoTags { model: Some("Canon EOS 60D".into()), focal_mm: Some(50.0), ..PhotoTags::default() };
        let narrow = eos.focal([4608, 3456]).unwrap().prior.focal_px;
        assert!((narrow / (50.0 * 3456.0 / 14.9) - 1.0).abs() < 1e-9);
        let wide = eos.focal([5184, 2916]).unwrap().prior.focal_px;
        assert!((wide / (50.0 * 5184.0 / 22.3) - 1.0).abs() < 1e-9);
        // A lens of 50 mm that is focused at a metre may reach 5 % further.
        assert!(eos.focal([5184, 2916]).unwrap().prior.sigma_share > 0.06);
    }

    #[test]
    fn tags_that_state_no_plausible_focal_length_are_refused() {
        let refused = |tags: PhotoTags| tags.focal([4416, 3312]).unwrap_err().to_string();
        let none = refused(PhotoTags::default());
        assert!(none.contains("no focal length"), "{none}");
        let zero = refused(PhotoTags { focal_35mm: Some(0.0), ..PhotoTags::default() });
        assert!(zero.contains("no focal length"), "{zero}");
        assert!(refused(tags()).contains("only the actual focal length, 6.10 mm"));
        assert!(refused(PhotoTags { focal_35mm: Some(65535.0), ..tags() }).contains("65535 mm"));
        let zoomed = PhotoTags { focal_35mm: Some(28.0), digital_zoom: Some(2.0), ..tags() };
        assert!(refused(zoomed.clone()).contains("digital zoom of 2.00"));
        assert!(PhotoTags { digital_zoom: Some(1.0), ..zoomed.clone() }.focal([4416, 3312]).is_ok());
        let cropped = PhotoTags { digital_zoom: None, ..zoomed };
        assert!(cropped.focal([4416, 2484]).unwrap_err().to_string().contains("4416x3312"));
        for absurd in [f64::NAN, f64::INFINITY, -3.0, 1e-300] {
            let tags = PhotoTags { focal_plane_x_resolution: Some(absurd), focal_mm: Some(absurd), ..tags() };
            assert!(tags.focal([4416, 3312]).is_err());
        }
    }
}
