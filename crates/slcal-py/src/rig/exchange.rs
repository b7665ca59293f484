//! Rigs as files of other programs, and back.

use std::path::PathBuf;

use pyo3::prelude::*;
use slcal_cli::files::{InputKind, read_input};
use slcal_core::Rig as CoreRig;
use slcal_core::format::{ExchangeFormat, ExportConfig, ImportConfig, NamedBytes, export_rig, import_rig};

use super::Rig;
use crate::convert::option::{parsed, repr_of, whole_pair};
use crate::errors::{self, Raise as _, Stage, raised_from};
use crate::files;

fn path_of(file: &Bound<'_, PyAny>, what: &str) -> PyResult<PathBuf> {
    files::path_of(file)?.ok_or_else(|| errors::wrong_type(what, "a path", &repr_of(file)))
}

/// See `Rig.export`.
fn export_to(
    rig: &CoreRig,
    path: &Bound<'_, PyAny>,
    to: &Bound<'_, PyAny>,
    lossy: bool,
) -> PyResult<Vec<String>> {
    let py = path.py();
    let (path, format) = (path_of(path, "path")?, parsed::<ExchangeFormat>(to, "to")?);
    let storage = match format {
        ExchangeFormat::OpenCv => slcal_cli::files::storage_of(&path).raise(py, Stage::Detect)?,
        _ => ExportConfig::default().storage,
    };
    let export = export_rig(rig, format, &ExportConfig { storage, lossy }).raise(py, Stage::Detect)?;
    let names: Vec<&str> = export.files.iter().map(|f| f.name).collect();
    let places = slcal_cli::files::export_places(&path, format, &names).raise(py, Stage::Detect)?;
    if let Some(folder) = places.folder.filter(|f| !f.is_dir()) {
        std::fs::create_dir(&folder).map_err(|e| files::os_error(&e, &folder))?;
    }
    for (place, file) in places.paths.iter().zip(&export.files) {
        py.detach(|| slcal_cli::files::write_whole(place, &file.bytes))
            .map_err(|e| files::os_error(&e, place))?;
    }
    Ok(export.left_out)
}

/// See `Rig.import_from`.
fn import_from(
    paths: &Bound<'_, PyAny>,
    format: Option<&Bound<'_, PyAny>>,
    camera_size: Option<&Bound<'_, PyAny>>,
    projector_size: Option<&Bound<'_, PyAny>>,
) -> PyResult<CoreRig> {
    let py = paths.py();
    let format = format.map(|f| parsed::<ExchangeFormat>(f, "format")).transpose()?;
    let config = ImportConfig {
        camera_size: camera_size.map(|s| whole_pair(s, "camera_size")).transpose()?,
        projector_size: projector_size.map(|s| whole_pair(s, "projector_size")).transpose()?,
    };
    let given: Vec<PathBuf> = match files::path_of(paths)? {
        Some(path) => vec![path],
        None => paths
            .try_iter()
            .map_err(|_| errors::wrong_type("paths", "a path, or several", &repr_of(paths)))?
            .map(|p| path_of(&p?, "paths"))
            .collect::<PyResult<_>>()?,
    };
    let found = slcal_cli::files::import_paths(&given).raise(py, Stage::Detect)?;
    let read = |path: &PathBuf| read_input(path, InputKind::Exchange).map_err(|e| files::os_error(&e, path));
    let contents = py.detach(|| found.iter().map(read).collect::<PyResult<Vec<_>>>())?;
    let name = |p: &PathBuf| p.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let names: Vec<String> = found.iter().map(name).collect();
    let named: Vec<NamedBytes<'_>> =
        names.iter().zip(&contents).map(|(name, bytes)| NamedBytes { name, bytes }).collect();
    let file = found.first().map(|p| p.display().to_string());
    let imported = import_rig(format, &named, &config);
    imported.map(|i| i.rig).map_err(|e| raised_from(py, &e, Stage::Detect, file.as_deref()))
}

#[pymethods]
impl Rig {
    /// Writes files that another program reads.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     The output; existing files are replaced. For "opencv" it ends in .yml, .yaml, .xml or .json; for "ros" it is the
    ///     camera's .yaml, the projector's goes beside it as NAME_projector.yaml, or a folder; for "colmap" a folder; for
    ///     "kalibr" a .yaml, for "blender" a .py, for "npz" an .npz.
    /// to : {"opencv", "ros", "colmap", "kalibr", "blender", "npz"}
    ///     The format.
    /// lossy : bool, default False
    ///     Whether distortion terms that the format does not have are left out; otherwise they are an error.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     What the format cannot hold, one line each.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When the format cannot hold a lens (the message says how far pixels would move), or the path does not suit it.
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
        export_to(&self.rig, path, to, lossy)
    }

    /// Reads files of another program: those that `export` wrote, or calibrations made elsewhere.
    ///
    /// Parameters
    /// ----------
    /// paths : path or list of paths
    ///     The file; for "ros" the camera's and the projector's, or their folder; for "colmap" the folder.
    /// format : {"opencv", "ros", "colmap", "kalibr", "blender", "npz"}, optional
    ///     The format; by default it is recognised by the content.
    /// camera_size, projector_size : (int, int), optional
    ///     Width and height, px, for files that do not state them.
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
    ///     When the size of an image is not known.
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
        import_from(paths, format, camera_size, projector_size).map(Self::from)
    }
}
