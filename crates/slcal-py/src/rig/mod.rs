//! The rig: what calibration gives and reconstruction takes.

mod exchange;
mod opencv;
mod report;
mod shown;
mod view;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use slcal_core::format::{read_rig, write_rig};
use slcal_core::{CalibrationReport, Projector, StereoPose};

pub(crate) use view::{Covariance, View};

use crate::advise;
use crate::cloud::PointCloud;
use crate::convert::report::record;
use crate::decode::{self, Frames};
use crate::errors::{self, Looking, Raise as _, raised_from};
use crate::files;
use crate::geometry::{Camera, Pose};
use crate::matches::Given;
use crate::pattern::{CheckerPattern, StripePattern};
use crate::reconstruct::{self, Shape};
use crate::rectify::{self, Rectification};
use crate::verify;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Rig>()?;
    module.add_class::<View>()?;
    module.add_class::<Covariance>()
}

/// A calibrated camera, and projector if a pattern was seen; with how sure it is.
///
/// `slcal.calibrate` makes rigs; this makes one of devices that are known from elsewhere.
///
/// Parameters
/// ----------
/// camera : Camera
///     The camera.
/// projector : Camera, optional
///     The projector, as if it were a camera.
/// projector_from_camera : Pose, optional
///     X_projector = R · X_camera + t, mm; given exactly when the projector is.
/// method : str, default "external"
///     How the rig was made, in a word.
///
/// Raises
/// ------
/// Error
///     When only one of projector and projector_from_camera is given.
///
/// Examples
/// --------
/// >>> camera = slcal.Camera.from_fov((1280, 960), 45)
/// >>> projector = slcal.Camera.from_throw((1024, 768), 1.6)
/// >>> rig = slcal.Rig(camera, projector, slcal.Pose(np.eye(3), [-200, 0, 0]))
/// >>> rig.baseline_mm
/// 200.0
/// >>> slcal.Rig.from_json(rig.to_json()) == rig
/// True
#[pyclass(frozen, module = "slcal")]
pub(crate) struct Rig {
    pub(crate) rig: slcal_core::Rig,
    /// How it came about, when it was calibrated here.
    pub(crate) report: Option<CalibrationReport>,
}

impl From<slcal_core::Rig> for Rig {
    fn from(rig: slcal_core::Rig) -> Self {
        Self { rig, report: None }
    }
}

impl Rig {
    fn json(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        let mut bytes = Vec::new();
        write_rig(&self.rig, &mut bytes).raise(py, Looking::ForSheet)?;
        Ok(bytes)
    }

    fn parse(py: Python<'_>, bytes: &[u8], name: Option<&str>) -> PyResult<Self> {
        read_rig(bytes).map(Self::from).map_err(|e| raised_from(py, &e, Looking::ForSheet, name))
    }
}

#[pymethods]
impl Rig {
    #[new]
    #[pyo3(
        signature = (camera, projector=None, projector_from_camera=None, *, method=None),
        text_signature = "(camera, projector=None, projector_from_camera=None, *, method='external')"
    )]
    fn new(
        py: Python<'_>,
        camera: &Camera,
        projector: Option<&Camera>,
        projector_from_camera: Option<&Pose>,
        method: Option<String>,
    ) -> PyResult<Self> {
        let projector = match (projector, projector_from_camera) {
            (Some(device), Some(p)) => Some(Projector {
                device: device.0,
                from_camera: StereoPose {
                    pose: p.pose,
                    sigma_t_mm: p.sigma_t_mm,
                    sigma_r_rad: p.sigma_r_rad,
                },
            }),
            (None, None) => None,
            (given, _) => {
                let given = if given.is_some() { "projector" } else { "projector_from_camera" };
                let wanted = "both a projector and its projector_from_camera, or neither";
                return Err(errors::invalid(py, "rig", wanted, &format!("{given} alone")));
            }
        };
        let rig = slcal_core::Rig {
            camera: camera.0,
            projector,
            views: Vec::new(),
            method: method.unwrap_or_else(|| "external".to_owned()),
            quality: None,
            covariance: None,
        };
        Ok(rig.into())
    }

    /// The camera.
    #[getter]
    fn camera(&self) -> Camera {
        Camera(self.rig.camera)
    }

    /// The projector; None when the camera alone was calibrated.
    #[getter]
    fn projector(&self) -> Option<Camera> {
        self.rig.projector.map(|p| Camera(p.device))
    }

    /// X_projector = R · X_camera + t, mm; None without a projector.
    #[getter]
    fn projector_from_camera(&self) -> Option<Pose> {
        let StereoPose { pose, sigma_t_mm, sigma_r_rad } = self.rig.projector?.from_camera;
        Some(Pose { pose, sigma_t_mm, sigma_r_rad })
    }

    /// The poses of the sheet that it was calibrated from.
    #[getter]
    fn views(&self) -> Vec<View> {
        self.rig.views.iter().cloned().map(View).collect()
    }

    /// How it was made: "ml", "two-vp", or anything else for rigs from elsewhere.
    #[getter]
    fn method(&self) -> &str {
        &self.rig.method
    }

    /// How far it can be trusted; None for rigs from elsewhere that do not say.
    #[getter]
    fn quality<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.rig.quality.as_ref().map(|q| record(py, "Quality", &shown::quality(q))).transpose()
    }

    /// Covariance of all estimated parameters; None for rigs from elsewhere.
    #[getter]
    fn covariance(&self) -> Option<Covariance> {
        self.rig.covariance.clone().map(Covariance)
    }

    /// How the calibration went; None for a rig that was not calibrated in this program.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.report.as_ref().map(|r| record(py, "CalibrationReport", &r.to_json())).transpose()
    }

    /// Distance between the optical centres, mm; None without a projector.
    #[getter]
    fn baseline_mm(&self) -> Option<f64> {
        self.rig.baseline_mm()
    }

    /// 1σ of it, mm; None without a covariance.
    #[getter]
    fn baseline_sigma_mm(&self) -> Option<f64> {
        self.rig.baseline_sigma_mm()
    }

    /// Writes the rig file (schema slcal-rig/1), which the command line and other programs read.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    fn save(&self, file: &Bound<'_, PyAny>) -> PyResult<()> {
        files::write(file, &self.json(file.py())?, true)
    }

    /// Reads a rig file, however it was made.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     The JSON file (schema slcal-rig/1).
    ///
    /// Returns
    /// -------
    /// Rig
    ///
    /// Raises
    /// ------
    /// OSError
    ///     When the file cannot be read.
    /// FormatError
    ///     When it does not follow its schema; the message names the field.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        let contents = files::read(file)?;
        Self::parse(file.py(), &contents.bytes, contents.name.as_deref())
    }

    /// The content of the rig file.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        files::text_of(self.json(py)?)
    }

    /// The rig that `to_json` wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        Self::parse(py, text.as_bytes(), None)
    }

    /// The rig as OpenCV's functions take it.
    ///
    /// Returns
    /// -------
    /// dict
    ///     `camera_K` (3, 3), `camera_dist` (5,), `camera_size` (2,), the same of the projector, and `R` (3, 3) and `t` (3, 1) with
    ///     X_projector = R · X_camera + t, mm: what ``cv2.stereoRectify`` calls R and T. Without a projector its entries are
    ///     left out.
    ///
    /// Examples
    /// --------
    /// >>> camera = slcal.Camera.from_fov((1280, 960), 45)
    /// >>> sorted(slcal.Rig(camera).to_opencv())
    /// ['camera_K', 'camera_dist', 'camera_size']
    fn to_opencv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
        opencv::to_opencv(py, &self.rig)
    }

    /// A rig from what OpenCV's functions give.
    ///
    /// Parameters
    /// ----------
    /// parameters : mapping, optional
    ///     What `to_opencv` gives; or the same as keyword arguments.
    /// camera_K, projector_K : array_like
    ///     (3, 3), px.
    /// camera_dist, projector_dist : array_like, optional
    ///     Up to five of k1, k2, p1, p2, k3; none unless given.
    /// camera_size, projector_size : (int, int)
    ///     Width and height, px.
    /// R : array_like
    ///     (3, 3), or (3,) as of ``cv2.Rodrigues``.
    /// t : array_like
    ///     (3,) or (3, 1), mm: X_projector = R · X_camera + t.
    ///
    /// Returns
    /// -------
    /// Rig
    ///
    /// Raises
    /// ------
    /// Error
    ///     When something is missing or is not what its name says.
    #[staticmethod]
    #[pyo3(signature = (parameters=None, /, **named), text_signature = "(parameters=None, /, *, camera_K=None, camera_dist=None, camera_size=None, projector_K=None, projector_dist=None, projector_size=None, R=None, t=None)")]
    fn from_opencv(
        py: Python<'_>,
        parameters: Option<&Bound<'_, PyAny>>,
        named: Option<&Bound<'_, pyo3::types::PyDict>>,
    ) -> PyResult<Self> {
        opencv::from_opencv(py, parameters, named).map(Self::from)
    }

    /// Writes a page that shows the calibration: how good, why, what next. Any browser opens it, without a network.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    /// photos : sequence of ndarray, or ndarray, optional
    ///     The photographs that the rig was calibrated from, one for each of its views.
    /// observations : Observations or mapping, optional
    ///     What was measured in them (`slcal.observe`): sides, corners and residuals are drawn. A σ that is not stated is taken
    ///     from the residuals themselves.
    /// cloud : PointCloud, optional
    ///     Points to show beside the devices.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When photographs or observations are not those of the rig: another number of views, other sizes.
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
        cloud: Option<&PointCloud>,
    ) -> PyResult<()> {
        report::save(&self.rig, file, photos, observations, cloud)
    }

    /// Writes files that another program reads.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     Where to; files there are replaced. For "opencv" it ends in .yml, .yaml, .xml or .json; for "ros" it is the camera's .yaml, the
    ///     projector's goes beside it as NAME_projector.yaml, or a folder; for "colmap" a folder; for "kalibr" a .yaml, for
    ///     "blender" a .py, for "npz" an .npz.
    /// to : {"opencv", "ros", "colmap", "kalibr", "blender", "npz"}
    ///     The format.
    /// lossy : bool, default False
    ///     Whether terms of a lens that the format does not have are left out; otherwise they are an error.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     What the format has no place for, a line each.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When the format cannot hold a lens (the message says how far pixels would move), or the path is not for it.
    /// OSError
    ///     When a file cannot be written.
    ///
    /// Examples
    /// --------
    /// >>> import tempfile
    /// >>> rig = slcal.Rig(slcal.Camera.from_fov((1280, 960), 45))
    /// >>> with tempfile.TemporaryDirectory() as folder:
    /// ...     left_out = rig.export(f"{folder}/rig.yml", "opencv")
    /// ...     slcal.Rig.import_from(f"{folder}/rig.yml") == rig
    /// True
    #[pyo3(signature = (path, to, *, lossy=false))]
    fn export(&self, path: &Bound<'_, PyAny>, to: &Bound<'_, PyAny>, lossy: bool) -> PyResult<Vec<String>> {
        exchange::export(&self.rig, path, to, lossy)
    }

    /// Reads files of another program: those that `export` wrote, or calibrations made elsewhere.
    ///
    /// Parameters
    /// ----------
    /// paths : path or list of paths
    ///     The file; for "ros" the camera's and the projector's, or their folder; for "colmap" the folder.
    /// format : {"opencv", "ros", "colmap", "kalibr", "blender", "npz"}, optional
    ///     Whose files they are; told by their content unless given.
    /// camera_size, projector_size : (int, int), optional
    ///     Width and height, px, for files that do not say them.
    ///
    /// Returns
    /// -------
    /// Rig
    ///
    /// Raises
    /// ------
    /// FormatError
    ///     When the files are of another format, or something is missing in them.
    /// Error
    ///     When the size of an image is nowhere to be found.
    /// OSError
    ///     When a file cannot be read.
    #[staticmethod]
    #[pyo3(signature = (paths, format=None, *, camera_size=None, projector_size=None))]
    fn import_from(
        paths: &Bound<'_, PyAny>,
        format: Option<&Bound<'_, PyAny>>,
        camera_size: Option<&Bound<'_, PyAny>>,
        projector_size: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        exchange::import(paths, format, camera_size, projector_size).map(Self::from)
    }

    /// The cloud of one photograph of the stripes on whatever stands before the rig. `Reconstructor` is for many.
    ///
    /// Parameters
    /// ----------
    /// image : ndarray
    ///     (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected.
    /// pattern : StripePattern
    ///     The stripes, drawn for the rig's projector.
    /// black, white : ndarray, optional
    ///     The same scene with a dark projector (the room's light is taken off) and with plain white (the surface's own
    ///     colours are divided out).
    /// gamma : {"srgb", "linear"} or float, default "srgb"
    ///     How the image's values follow the light.
    /// frame : {"camera", "plane"}, default "camera"
    ///     Whose coordinates the cloud has: the camera's, or those of the sheet of the rig's first view.
    /// mesh : bool, default False
    ///     Whether the cloud keeps the triangles between its points.
    /// cull : {"auto", "off"} or float, default "auto"
    ///     Largest area of a triangle that is surface, mm², or how it is chosen; points without such triangles are left
    ///     out.
    /// min_confidence : float, default 0.4
    ///     Matches below it are left out, 0 to 1.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     Its `report` says what was seen and what became of it.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     When the image is no array of uint8 or uint16.
    /// Error
    ///     When its shape or size is another one, the rig has no projector (or, for "plane", no view), the pattern is for
    ///     another panel, or an option is out of range.
    /// DecodeError
    ///     When the stripes are not in it, or cannot be those of this rig. The message says so when they are found as soon
    ///     as red and blue change places.
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
            image, pattern, *, black=None, white=None, gamma=None, frame=None, mesh=false, cull=None, min_confidence=0.4
        ),
        text_signature = "($self, image, pattern, *, black=None, white=None, gamma='srgb', frame='camera', mesh=False, \
                          cull='auto', min_confidence=0.4)"
    )]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments")]
    fn reconstruct(
        &self,
        image: &Bound<'_, PyAny>,
        pattern: &Bound<'_, StripePattern>,
        black: Option<&Bound<'_, PyAny>>,
        white: Option<&Bound<'_, PyAny>>,
        gamma: Option<&Bound<'_, PyAny>>,
        frame: Option<&Bound<'_, PyAny>>,
        mesh: bool,
        cull: Option<&Bound<'_, PyAny>>,
        min_confidence: f64,
    ) -> PyResult<PointCloud> {
        let frames = Frames::of(image, black, white)?;
        let decode = decode::config(gamma, min_confidence)?;
        let shape = Shape { frame, mesh, cull };
        reconstruct::reconstruct(image.py(), &self.rig, &frames, pattern.get(), decode, shape)
    }

    /// Points from camera pixels and the projector columns (or rows) that light them, of whatever decoder.
    ///
    /// Parameters
    /// ----------
    /// pixels : Matches or array_like
    ///     Matches, or (N, 2) camera px.
    /// columns, rows : array_like, optional
    ///     (N,), projector px, NaN where one is not known; at least one of the two beside an array of pixels.
    /// sigma_px : array_like, optional
    ///     (N,) or one for all: 1σ of the camera position across the stripe, px. Unless given, that of the matches, or 0.1.
    /// frame : {"camera", "plane"}, default "camera"
    ///     Whose coordinates the cloud has: the camera's, or those of the sheet of the rig's first view.
    /// mesh : bool, default False
    ///     Whether the cloud keeps the triangles between its points.
    /// cull : {"auto", "off"} or float, default "off"
    ///     Largest area of a triangle that is surface, mm², or how it is chosen; points without such triangles are left
    ///     out. With "off" every match that can be a point becomes one, in the order given.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     Its `report` counts the matches that are no points: without coordinates ("invalid"), behind the devices, lit from
    ///     outside the panel, and so on.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     When something is no array of numbers.
    /// Error
    ///     When the shapes do not fit each other, pixels are not finite, or the rig has no projector (or, for "plane", no
    ///     view).
    /// DecodeError
    ///     When no match is a point.
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
            pixels, columns=None, rows=None, *, sigma_px=None, frame=None, mesh=false, cull=None
        ),
        text_signature = "($self, pixels, columns=None, rows=None, *, sigma_px=None, frame='camera', mesh=False, \
                          cull='off')"
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
    ) -> PyResult<PointCloud> {
        let given = Given { columns, rows, sigma_px, ..Given::default() };
        reconstruct::triangulate(&self.rig, pixels, given, Shape { frame, mesh, cull })
    }

    /// The picture to project so that a picture appears upright and as large as possible on the sheet.
    ///
    /// Parameters
    /// ----------
    /// source : CheckerPattern or ndarray
    ///     A checkerboard, drawn with sharp edges and half a square of its background around it, or any picture: (H, W, 3)
    ///     RGB or (H, W), uint8 (uint16 is brought to 8 bits).
    /// view : int, default 0
    ///     Which of the rig's views tells where the sheet is.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     (H, W, 3) uint8, as large as the projector's panel.
    ///
    /// Raises
    /// ------
    /// Error
    ///     For a rig without a projector or such a view, and for a pattern for another panel.
    /// CalibrationError
    ///     When the projector does not light the sheet.
    /// TypeError
    ///     When the source is neither of these.
    #[pyo3(signature = (source, *, view=0))]
    fn rectify<'py>(&self, source: &Bound<'py, PyAny>, view: i64) -> PyResult<Bound<'py, PyAny>> {
        rectify::drawn(&self.rig, source, view)
    }

    /// Where `rectify` draws a picture: on the panel, and on the sheet in millimetres.
    ///
    /// Parameters
    /// ----------
    /// source : CheckerPattern or ndarray
    ///     As for `rectify`.
    /// view : int, default 0
    ///     As for `rectify`.
    ///
    /// Returns
    /// -------
    /// Rectification
    #[pyo3(signature = (source, *, view=0))]
    fn rectification(&self, source: &Bound<'_, PyAny>, view: i64) -> PyResult<Rectification> {
        rectify::place(&self.rig, source, view)
    }

    /// How square a projected checkerboard is on the sheet now, and whether projector, camera or sheet have moved.
    ///
    /// Parameters
    /// ----------
    /// photo : ndarray
    ///     (H, W, 3) RGB or (H, W), uint8 or uint16, by the rig's camera: the sheet with the pattern projected on it.
    /// pattern : CheckerPattern
    ///     What is projected, by default as `rectify` draws it for the rig's first view.
    /// size_mm : (float, float), optional
    ///     Width and height of the sheet, mm, when it is not that of the rig's first view.
    /// as_drawn : bool, default False
    ///     The pattern is projected as it was drawn, not rectified; the sheet may then stand anywhere.
    /// corners : array_like, optional
    ///     (4, 2), px: the sheet's corners TL, TR, BR, BL by hand, when it is not found.
    /// gamma : {"srgb", "linear"} or float, default "srgb"
    ///     The transfer curve of the photograph.
    /// significance : float, default 0.001
    ///     How often a rig that has not moved may be said to have.
    ///
    /// Returns
    /// -------
    /// Verification
    ///     `keystone` with its σ, `rig.moved` and what has changed, `sheet.moved`.
    ///
    /// Raises
    /// ------
    /// DetectionError
    ///     When sheet or pattern is not found.
    /// CalibrationError
    ///     When photograph and rig do not go together at all.
    /// Error
    ///     For a photograph of another size, a pattern for another panel, a rig without a projector, a rig without views unless
    ///     `as_drawn` and `size_mm` are given.
    /// TypeError
    ///     When the photograph is no such array.
    #[pyo3(
        signature = (photo, pattern, *, size_mm=None, as_drawn=false, corners=None, gamma=None, significance=0.001),
        text_signature = "($self, photo, pattern, *, size_mm=None, as_drawn=False, corners=None, gamma='srgb', significance=0.001)"
    )]
    #[allow(clippy::too_many_arguments, reason = "they are named in Python")]
    fn verify<'py>(
        &self,
        photo: &Bound<'py, PyAny>,
        pattern: &CheckerPattern,
        size_mm: Option<&Bound<'py, PyAny>>,
        as_drawn: bool,
        corners: Option<&Bound<'py, PyAny>>,
        gamma: Option<&Bound<'py, PyAny>>,
        significance: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let known = verify::Known { size_mm, as_drawn, corners, gamma, significance };
        verify::verify(&self.rig, photo, pattern, &known)
    }

    /// What one more photograph would bring, and which to take.
    ///
    /// Parameters
    /// ----------
    /// pattern : CheckerPattern, optional
    ///     What will be projected; the default checkerboard for the rig's panel unless given.
    ///
    /// Returns
    /// -------
    /// Advice
    ///     σ now and after a photograph with each of several tilts, and the `next` photograph in numbers and in words.
    ///
    /// Raises
    /// ------
    /// Error
    ///     For a rig without views or covariance (see `slcal.advise` for these), or a pattern for another panel.
    #[pyo3(signature = (pattern=None))]
    fn advise<'py>(&self, py: Python<'py>, pattern: Option<&CheckerPattern>) -> PyResult<Bound<'py, PyAny>> {
        advise::next(py, &self.rig, pattern)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String, Option<String>))> {
        let report = self.report.as_ref().map(serde_json::to_string).transpose().map_err(pickled)?;
        Ok((py.get_type::<Self>().getattr("_restored")?, (self.to_json(py)?, report)))
    }

    #[staticmethod]
    fn _restored(py: Python<'_>, rig: &str, report: Option<&str>) -> PyResult<Self> {
        let report = report.map(serde_json::from_str).transpose().map_err(pickled)?;
        Ok(Self { report, ..Self::from_json(py, rig)? })
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        // How a rig came about is no part of what it is.
        other.cast::<Self>().is_ok_and(|o| o.get().rig == self.rig)
    }

    fn __repr__(&self) -> String {
        shown::in_a_line(&self.rig)
    }

    fn _repr_html_(&self) -> String {
        shown::as_html(&self.rig)
    }
}

/// A pickle whose report cannot be written or read.
fn pickled(error: serde_json::Error) -> PyErr {
    PyValueError::new_err(format!("pickled rig: {error}"))
}
