//! A rig as a page to look at.

use image::{DynamicImage, RgbImage};
use pyo3::prelude::*;
use slcal_core::photo::PhotoView;
use slcal_core::{Rig as CoreRig, residuals};

use crate::cloud::PointCloud;
use crate::convert::image::photos_of;
use crate::convert::object::optional;
use crate::errors::{self, Raise as _, Stage};
use crate::files;
use crate::observations::observations_of;
use crate::rig::Rig;

/// See `Rig.save_report`.
fn save(
    rig: &CoreRig,
    file: &Bound<'_, PyAny>,
    photos: Option<&Bound<'_, PyAny>>,
    observations: Option<&Bound<'_, PyAny>>,
    cloud: Option<&slcal_core::PointCloud>,
) -> PyResult<()> {
    let py = file.py();
    let photos = photos.map(|p| pictures(rig, p)).transpose()?.unwrap_or_default();
    let (seen, residuals) = match observations {
        Some(given) => {
            let seen = observations_of(given)?;
            let residuals = residuals(rig, &seen).raise(py, Stage::Detect)?;
            (Some(seen), Some(residuals))
        }
        None => (None, None),
    };
    let page = py
        .detach(|| {
            let measured = seen.as_ref().zip(residuals);
            slcal_cli::files::rig_report(rig, &photos, measured, cloud)
        })
        .map_err(|message| errors::invalid(py, "photos", "pictures that can be written as JPEG", &message))?;
    files::write(file, &page, true)
}

/// One photograph per view, of the camera's size.
fn pictures(rig: &CoreRig, photos: &Bound<'_, PyAny>) -> PyResult<Vec<DynamicImage>> {
    let py = photos.py();
    let photos = photos_of(photos, "photos")?;
    let (views, model) = (rig.views.len(), &rig.camera.model);
    if photos.len() != views {
        let expected = format!("one for each of the {views} views of the rig, in their order");
        return Err(errors::invalid(py, "photos", &expected, &photos.len().to_string()));
    }
    let mut pictures = Vec::with_capacity(views);
    for (i, photo) in photos.iter().enumerate() {
        let pixels = photo.pixels();
        let view = pixels.view(py)?;
        let [expected, found] = [[model.width, model.height], [view.width() as u32, view.height() as u32]];
        if expected != found {
            let [expected, found] = [expected, found].map(|[w, h]| format!("{w}x{h} px"));
            let expected = format!("a photograph of the rig's camera, {expected}");
            return Err(errors::invalid(py, &format!("photos[{i}]"), &expected, &found));
        }
        pictures.push(py.detach(|| picture(view)));
    }
    Ok(pictures)
}

fn picture(view: PhotoView<'_>) -> DynamicImage {
    let (width, height) = (view.width() as u32, view.height() as u32);
    let pixel = |x: u32, y: u32| image::Rgb(view.rgb_bytes(x as usize, y as usize));
    DynamicImage::ImageRgb8(RgbImage::from_fn(width, height, pixel))
}

#[pymethods]
impl Rig {
    /// Writes an HTML page about the calibration: how good it is, why, and what to do next. It needs no network.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    /// photos : sequence of ndarray, or ndarray, optional
    ///     The photographs that the rig was calibrated from, one for each of its views.
    /// observations : Observations or mapping, optional
    ///     The observations in them (`slcal.observe`): sides, corners and residuals are drawn. A σ that is not given is
    ///     estimated from the residuals.
    /// cloud : PointCloud, optional
    ///     Points to show together with the devices.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When photographs or observations do not fit the rig: a different number of views, or other sizes.
    /// OSError
    ///     When the file cannot be written.
    ///
    /// Examples
    /// --------
    /// >>> import tempfile
    /// >>> rig = slcal.Rig(slcal.Camera.from_fov((1280, 960), 45))
    /// >>> with tempfile.TemporaryDirectory() as folder:
    /// ...     rig.save_report(f"{folder}/report.html")
    #[pyo3(signature = (file, *, photos=None, observations=None, cloud=None))]
    fn save_report(
        &self,
        file: &Bound<'_, PyAny>,
        photos: Option<&Bound<'_, PyAny>>,
        observations: Option<&Bound<'_, PyAny>>,
        cloud: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let cloud = optional::<PointCloud>(cloud, "cloud")?.map(|c| &c.get().cloud);
        save(&self.rig, file, photos, observations, cloud)
    }
}
