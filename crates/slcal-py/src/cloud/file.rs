//! Clouds as files.

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use slcal_cli::files::InputKind;
use slcal_core::format::{CloudFormat, read_ply};

use super::PointCloud;
use crate::convert::option::{parsed, parsed_or};
use crate::errors::{self, Raise as _, Stage, raised_from};
use crate::files;

/// By the extension of a path; PLY for file objects.
fn format_of(file: &Bound<'_, PyAny>) -> PyResult<CloudFormat> {
    let Some(path) = files::path_of(file)? else { return Ok(CloudFormat::Ply) };
    let found = path.extension().and_then(|e| e.to_str()?.parse::<CloudFormat>().ok());
    found.ok_or_else(|| {
        let wanted = "a file name that ends in .ply, .pcd, .xyz, .obj or .glb, or format=";
        errors::invalid(file.py(), "file", wanted, &path.display().to_string())
    })
}

fn bytes_as(format: CloudFormat, cloud: &slcal_core::PointCloud) -> slcal_core::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    format.write(cloud, &mut bytes)?;
    Ok(bytes)
}

#[pymethods]
impl PointCloud {
    /// Writes the cloud.
    ///
    /// PLY holds all but pixels, in single precision; OBJ and GLB hold points, colours, normals and triangles (GLB in metres, y up);
    /// PCD and XYZ have no triangles, XYZ no normals.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    /// format : {"ply", "pcd", "xyz", "obj", "glb"}, optional
    ///     By the extension of the path unless given; "ply" for file objects.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When neither the extension nor `format` is one of these.
    /// OSError
    ///     When the file cannot be written.
    #[pyo3(signature = (file, *, format=None))]
    fn save(&self, file: &Bound<'_, PyAny>, format: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let py = file.py();
        let format = format.map_or_else(|| format_of(file), |f| parsed(f, "format"))?;
        let bytes = py.detach(|| bytes_as(format, &self.cloud)).raise(py, Stage::Decode)?;
        files::write(file, &bytes, format.is_text())
    }

    /// Reads a cloud from a PLY file, text or binary.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     Positions are needed; colours, sigma, noise, slit, confidence, normals and faces are taken when they are there.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///
    /// Raises
    /// ------
    /// OSError
    ///     When the file cannot be read.
    /// FormatError
    ///     When it is not a PLY file, or is incomplete.
    /// Error
    ///     When its name is that of another format; these can only be written.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = file.py();
        if let Some(path) = files::path_of(file)?
            && let Ok(format) = format_of(file)
            && format != CloudFormat::Ply
        {
            let wanted = "a PLY file; the other formats are written only";
            return Err(errors::invalid(py, "file", wanted, &path.display().to_string()));
        }
        let contents = files::read(file, InputKind::Cloud)?;
        let name = contents.name.as_deref();
        let read = py.detach(|| read_ply(contents.bytes.as_slice()));
        read.map(Self::from).map_err(|e| raised_from(py, &e, Stage::Decode, name))
    }

    /// The content of the file that `save` would write.
    #[pyo3(signature = (format=None), text_signature = "($self, format='ply')")]
    fn to_bytes<'py>(
        &self,
        py: Python<'py>,
        format: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let format = parsed_or(format, "format", CloudFormat::Ply)?;
        let bytes = py.detach(|| bytes_as(format, &self.cloud)).raise(py, Stage::Decode)?;
        Ok(PyBytes::new(py, &bytes))
    }
}
