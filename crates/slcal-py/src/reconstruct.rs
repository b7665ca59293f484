//! Matches and photographs of stripes → clouds.

use pyo3::prelude::*;
use slcal_core::decode::DecodeConfig;
use slcal_core::reconstruct::{CullRule, TriangulateConfig};
use slcal_core::{
    Frame, ReconstructConfig, Reconstruction, Reconstructor, Rig as CoreRig, SequenceReconstructor,
    cloud_from_dense_matches, cloud_from_matches,
};

use crate::cloud::PointCloud;
use crate::convert::object::refused;
use crate::convert::option;
use crate::convert::report::LazyReport;
use crate::decode::{self, Frames, Projected};
use crate::dense_matches::DenseMatches;
use crate::errors::{self, Raise as _, Stage};
use crate::files;
use crate::matches::{MatchArrays, Matches, matches_of, sigma_of};
use crate::rig::Rig;
use crate::sequence_frames::fold;

impl From<Reconstruction> for PointCloud {
    fn from(made: Reconstruction) -> Self {
        let report = LazyReport::of("CloudReport", &made.report());
        Self { cloud: made.cloud, report }
    }
}

/// What clouds are to be, as given from Python.
#[derive(Clone, Copy)]
pub(crate) struct CloudOptions<'a, 'py> {
    pub(crate) frame: Option<&'a Bound<'py, PyAny>>,
    pub(crate) mesh: bool,
    pub(crate) cull: Option<&'a Bound<'py, PyAny>>,
    pub(crate) near: Option<f64>,
    pub(crate) far: Option<f64>,
}

impl CloudOptions<'_, '_> {
    pub(crate) fn config(&self, decode: DecodeConfig, cull: CullRule) -> PyResult<ReconstructConfig> {
        Ok(ReconstructConfig {
            decode,
            frame: option::parsed_or(self.frame, "frame", Frame::Camera)?,
            mesh: self.mesh,
            cull: option::parsed_or(self.cull, "cull", cull)?,
            triangulate: TriangulateConfig {
                near_mm: self.near,
                far_mm: self.far,
                ..TriangulateConfig::default()
            },
        })
    }
}

/// The cloud of matches, or of pixels and what lights them.
fn triangulate(
    rig: &CoreRig,
    pixels: &Bound<'_, PyAny>,
    given: MatchArrays<'_, '_>,
    options: CloudOptions<'_, '_>,
) -> PyResult<PointCloud> {
    let py = pixels.py();
    let config = options.config(DecodeConfig::default(), CullRule::Off)?;
    let work = |matches: &slcal_core::Matches| cloud_from_matches(rig, matches, &config);
    if let Ok(matches) = pixels.cast::<DenseMatches>() {
        for (what, value) in [("columns", given.columns), ("rows", given.rows), ("sigma_px", given.sigma_px)]
        {
            if value.is_some() {
                let wanted = "DenseMatches alone";
                return Err(errors::invalid(py, what, wanted, "one beside them, which have it already"));
            }
        }
        let matches = matches.get().core(py)?;
        let made = py.detach(|| cloud_from_dense_matches(rig, &matches, &config));
        return Ok(made.raise(py, Stage::Decode)?.into());
    }
    let made = if let Ok(matches) = pixels.cast::<Matches>() {
        if given.columns.is_some() || given.rows.is_some() {
            let wanted = "pixels, or Matches alone";
            return Err(errors::invalid(
                py,
                "columns",
                wanted,
                "Matches, which hold columns and rows already",
            ));
        }
        let matches = &matches.get().matches;
        match given.sigma_px {
            None => py.detach(|| work(matches)),
            Some(sigma) => {
                let mut matches = matches.clone();
                let sigma = sigma_of(sigma, matches.items.len())?;
                matches.items.iter_mut().zip(sigma).for_each(|(m, s)| m.sigma_px = s);
                py.detach(|| work(&matches))
            }
        }
    } else if files::path_of(pixels)?.is_some() || pixels.is_none() {
        return Err(refused::<Matches>(
            pixels,
            "pixels",
            "Matches, DenseMatches, or an array of shape (N, 2)",
        ));
    } else {
        let matches = matches_of(pixels, given)?;
        py.detach(|| work(&matches))
    };
    Ok(made.raise(py, Stage::Decode)?.into())
}

#[pymethods]
impl Rig {
    /// Reconstructs the cloud of one photograph of a scene under the stripes, or of the photographs of a sequence. For many photographs
    /// of stripes use `Reconstructor`.
    ///
    /// Parameters
    /// ----------
    /// image : ndarray, or iterable of ndarrays and paths
    ///     (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected. Of a sequence
    ///     its photographs in the order of the pattern, as `slcal.decode` takes them.
    /// pattern : StripePattern or SequencePattern
    ///     What was projected, drawn for the rig's projector. With a sequence, `black`, `white`, `gamma` and `min_confidence` are
    ///     not allowed.
    /// black, white : ndarray, optional
    ///     The same scene with the projector dark (ambient light is subtracted) and plain white (surface colours are
    ///     divided out).
    /// gamma : {"srgb", "linear"} or float, default "srgb"
    ///     The transfer curve of the image.
    /// frame : {"camera", "plane"}, default "camera"
    ///     The coordinate frame of the cloud: the camera's, or that of the sheet in the rig's first view.
    /// mesh : bool, default False
    ///     Whether the cloud keeps the triangles between its points.
    /// cull : {"auto", "off"} or float, default "auto"
    ///     Largest area of a triangle on a surface, mm², or how this limit is chosen. Points without such a triangle are
    ///     removed.
    /// min_confidence : float, default 0.4
    ///     Matches with a lower confidence are rejected, 0 to 1.
    /// near, far : float, optional
    ///     Limits of the depth along the camera's axis, mm. Points outside are removed and counted in the report.
    /// mirror : bool, default False
    ///     Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
    ///     counts as width - 1 - c.
    ///     A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     Its `report` counts what was found, rejected and removed. A cloud of a sequence has a point per pixel, and `normals`.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     When the image is not an array of uint8 or uint16.
    /// Error
    ///     When its shape or size is wrong, a sequence has another number of frames than its pattern, the rig has no projector (or, for "plane", no view), the pattern is for another
    ///     panel, or an option is out of range.
    /// DecodeError
    ///     When the stripes are not found, or cannot be those of this rig. The message says so when they are found with red
    ///     and blue swapped.
    ///
    /// Examples
    /// --------
    /// >>> from slcal import simulate
    /// >>> scene = simulate.scene("sphere")
    /// >>> cloud = scene.rig.reconstruct(scene.photo, scene.pattern)
    /// >>> cloud.points.shape == (len(cloud), 3)
    /// True
    #[pyo3(
        signature = (
            image, pattern, *, black=None, white=None, gamma=None, frame=None, mesh=false, cull=None, min_confidence=None,
            near=None, far=None, mirror=false
        ),
        text_signature = "($self, image, pattern, *, black=None, white=None, gamma='srgb', frame='camera', mesh=False, \
                          cull='auto', min_confidence=0.4, near=None, far=None, mirror=False)"
    )]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments")]
    fn reconstruct(
        &self,
        image: &Bound<'_, PyAny>,
        pattern: &Bound<'_, PyAny>,
        black: Option<&Bound<'_, PyAny>>,
        white: Option<&Bound<'_, PyAny>>,
        gamma: Option<&Bound<'_, PyAny>>,
        frame: Option<&Bound<'_, PyAny>>,
        mesh: bool,
        cull: Option<&Bound<'_, PyAny>>,
        min_confidence: Option<f64>,
        near: Option<f64>,
        far: Option<f64>,
        mirror: bool,
    ) -> PyResult<PointCloud> {
        let py = image.py();
        let pattern = Projected::of(pattern)?;
        let options = CloudOptions { frame, mesh, cull, near, far };
        let config = options.config(decode::config(gamma, min_confidence, mirror)?, CullRule::Auto)?;
        let pattern = match pattern {
            Projected::Stripes(pattern) => pattern,
            Projected::Sequence(pattern) => {
                decode::of_stripes_alone(
                    py,
                    &[
                        ("black", black.is_some()),
                        ("white", white.is_some()),
                        ("gamma", gamma.is_some()),
                        ("min_confidence", min_confidence.is_some()),
                    ],
                )?;
                let scanner = SequenceReconstructor::new(&self.rig, pattern, config);
                return Ok(fold(image, scanner.raise(py, Stage::Decode)?)?.into());
            }
        };
        let frames = Frames::of(image, black, white)?;
        let made = frames.read(py, |input| {
            let mut scanner = Reconstructor::new(&self.rig, pattern, config)?;
            scanner.reconstruct(*input)?;
            Ok(scanner.take_last())
        })?;
        Ok(made.into())
    }

    /// Triangulates points from camera pixels and their projector columns or rows, of any decoder.
    ///
    /// Parameters
    /// ----------
    /// pixels : Matches, DenseMatches or array_like
    ///     Matches, those of every pixel, or (N, 2) camera px.
    /// columns, rows : array_like, optional
    ///     (N,), projector px, NaN where it is not known. With an array of pixels, at least one of the two is needed.
    /// sigma_px : array_like, optional
    ///     (N,) or one for all: 1σ of the camera position across the stripe, px. By default that of the matches, or 0.1. Dense
    ///     matches have their own.
    /// frame : {"camera", "plane"}, default "camera"
    ///     The coordinate frame of the cloud: the camera's, or that of the sheet in the rig's first view.
    /// mesh : bool, default False
    ///     Whether the cloud keeps the triangles between its points.
    /// cull : {"auto", "off"} or float, default "off"
    ///     Largest area of a triangle on a surface, mm², or how this limit is chosen. Points without such a triangle are
    ///     removed. With "off" every valid match becomes a point, in the given order.
    /// near, far : float, optional
    ///     Limits of the depth along the camera's axis, mm. Points outside are removed and counted in the report.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     Its `report` counts the matches that gave no point: without coordinates ("invalid"), behind the devices, with a
    ///     projector coordinate outside the panel, and so on.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     When something is not an array of numbers.
    /// Error
    ///     When shapes do not match, pixels are not finite, or the rig has no projector (or, for "plane", no view).
    /// DecodeError
    ///     When no match gives a point.
    ///
    /// Examples
    /// --------
    /// >>> camera = slcal.Camera.from_fov((1280, 960), 45)
    /// >>> projector = slcal.Camera([[1600, 0, 511.5], [0, 1600, 383.5], [0, 0, 1]], size=(1024, 768))
    /// >>> rig = slcal.Rig(camera, projector, slcal.Pose(np.eye(3), [-200, 0, 0]))
    /// >>> pixel = camera.project([[20, 30, 1000]])
    /// >>> column = projector.project([[20 - 200, 30, 1000]])[:, 0]
    /// >>> rig.triangulate(pixel, column).points.round(6)
    /// array([[  20.,   30., 1000.]])
    #[pyo3(
        signature = (
            pixels, columns=None, rows=None, *, sigma_px=None, frame=None, mesh=false, cull=None, near=None, far=None
        ),
        text_signature = "($self, pixels, columns=None, rows=None, *, sigma_px=None, frame='camera', mesh=False, \
                          cull='off', near=None, far=None)"
    )]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments")]
    fn triangulate(
        &self,
        pixels: &Bound<'_, PyAny>,
        columns: Option<&Bound<'_, PyAny>>,
        rows: Option<&Bound<'_, PyAny>>,
        sigma_px: Option<&Bound<'_, PyAny>>,
        frame: Option<&Bound<'_, PyAny>>,
        mesh: bool,
        cull: Option<&Bound<'_, PyAny>>,
        near: Option<f64>,
        far: Option<f64>,
    ) -> PyResult<PointCloud> {
        let given = MatchArrays { columns, rows, sigma_px, ..MatchArrays::default() };
        triangulate(&self.rig, pixels, given, CloudOptions { frame, mesh, cull, near, far })
    }
}
