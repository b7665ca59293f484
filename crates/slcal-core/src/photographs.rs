//! Photographs → rig in one call, for programs that embed the library.

use crate::calibrate::{CalibrateConfig, Calibration, calibrate_observations};
use crate::detect::{DetectConfig, observe};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::RectangleSize;
use crate::observations::Observations;
use crate::pattern::CheckerPattern;
use crate::photo::PhotoView;

/// Calibrates a camera and a projector from photographs of one white sheet with a checkerboard projected on it, one
/// photograph per pose; the camera alone when `pattern` is `None`.
///
/// This is [`observe`](crate::detect::observe) for each photograph and then
/// [`calibrate_observations`](crate::calibrate::calibrate_observations), both with sRGB photographs and no corners given by
/// hand; call them yourself for anything else.
///
/// # Errors
/// [`Error::Invalid`] for no photograph or photographs of different sizes; otherwise as the two functions say.
///
/// # Examples
/// ```
/// use slcal_core::calibrate::CalibrateConfig;
/// use slcal_core::geometry::RectangleSize;
/// use slcal_core::pattern::{CheckerConfig, CheckerPattern};
/// use slcal_core::photo::PhotoView;
///
/// # fn run(photo: &image::DynamicImage) -> slcal_core::Result<()> {
/// let checker = CheckerPattern::new([1024, 768], &CheckerConfig::default())?;
/// let sheet = RectangleSize::new(594.0, 420.0)?;
/// let views = [PhotoView::try_from(photo)?];
/// let calibration = slcal_core::calibrate(&views, sheet, &checker, &CalibrateConfig::default())?;
/// println!("{:.1} px", calibration.rig.camera.model.intrinsics.fx);
/// # Ok(())
/// # }
/// ```
pub fn calibrate<'a>(
    photos: &[PhotoView<'_>],
    sheet: RectangleSize,
    pattern: impl Into<Option<&'a CheckerPattern>>,
    config: &CalibrateConfig,
) -> Result<Calibration> {
    let pattern = pattern.into();
    let size = |p: &PhotoView<'_>| [p.width() as u32, p.height() as u32];
    let camera = photos
        .first()
        .map(size)
        .ok_or_else(|| Error::invalid(ErrorSubject::Photographs, "at least one", 0))?;
    if let Some([w, h]) = photos.iter().map(size).find(|s| *s != camera) {
        let expected = format!("all of one camera, {}x{} as the first", camera[0], camera[1]);
        return Err(Error::invalid(ErrorSubject::Photographs, expected, format!("{w}x{h}")));
    }
    let detect = DetectConfig::default();
    let views = photos
        .iter()
        .map(|photo| Ok(observe(*photo, None, sheet, pattern, &detect)?.observation))
        .collect::<Result<Vec<_>>>()?;
    calibrate_observations(&Observations { camera, projector: pattern.map(|p| p.projector), views }, config)
}
