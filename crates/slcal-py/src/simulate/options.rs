//! Keyword arguments of `slcal.simulate` as the core's configurations.

use nalgebra::Point3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slcal_cli::files::InputKind;
use slcal_core::PointCloud as CoreCloud;
use slcal_core::format::{read_obj, read_ply};
use slcal_core::pattern::Pattern;
use slcal_core::photo::Encoding;
use slcal_core::simulate::{
    Flicker, PatternKind, PoseConfig, RenderConfig, RigConfig, Sharpen, SurfaceKind, TriangleMesh, WallKind,
};

use crate::cloud::PointCloud;
use crate::convert::array::{Numbers, matrix_of, vector_of};
use crate::convert::columns::column_of;
use crate::convert::option::{self, one_of, parsed, whole_pair};
use crate::errors::{self, Raise as _, Stage, raised_from};
use crate::files;
use crate::geometry::distortion_of;
use crate::pattern::{CheckerPattern, SequencePattern, StripePattern};

/// Keyword arguments by name.
pub(super) struct Options<'a, 'py>(pub(super) &'a Bound<'py, PyDict>);

impl<'py> Options<'_, 'py> {
    /// A value that is given; `None` in Python is none.
    pub(super) fn get(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.0.get_item(name)?.filter(|v| !v.is_none()))
    }

    pub(super) fn set<T>(
        &self,
        name: &str,
        field: &mut T,
        of: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
    ) -> PyResult<()> {
        if let Some(value) = self.get(name)? {
            *field = of(&value)?;
        }
        Ok(())
    }

    pub(super) fn number(&self, name: &str, field: &mut f64) -> PyResult<()> {
        self.set(name, field, |v| number(v, name))
    }

    pub(super) fn whole<T: TryFrom<u64>>(&self, name: &str, field: &mut T) -> PyResult<()> {
        self.set(name, field, |v| whole(v, name))
    }

    /// Width and height, px.
    pub(super) fn pixels(&self, name: &str, field: &mut [u32; 2]) -> PyResult<()> {
        self.set(name, field, |v| whole_pair(v, name))
    }

    pub(super) fn flag(&self, name: &str) -> PyResult<bool> {
        self.get(name)?.map_or(Ok(false), |v| v.is_truthy())
    }
}

pub(super) fn number(value: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    let type_name =
        || value.get_type().name().map_or_else(|_| "another object".to_owned(), |n| n.to_string());
    value.extract().map_err(|_| errors::wrong_type(name, "a number", &type_name()))
}

pub(super) fn whole<T: TryFrom<u64>>(value: &Bound<'_, PyAny>, name: &str) -> PyResult<T> {
    let number: i64 =
        value.extract().map_err(|_| errors::wrong_type(name, "a whole number", &value.to_string()))?;
    let fits = u64::try_from(number).ok().and_then(|n| T::try_from(n).ok());
    fits.ok_or_else(|| {
        errors::invalid(value.py(), name, "a whole number, not too large", &number.to_string())
    })
}

/// Red, green and blue, or one number for grey.
pub(super) fn channels(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 3]> {
    let values = column_of(value, 3, name, true)?;
    Ok([values[0], values[1], values[2]])
}

/// Up to five coefficients.
fn distortion(value: &Bound<'_, PyAny>) -> PyResult<[f64; 5]> {
    Ok(distortion_of(value)?.to_array())
}

/// Tilt about the camera's horizontal and vertical axis and, if wanted, roll, degrees.
pub(super) fn angles(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 3]> {
    let flat: Vec<f64> = Numbers::of(value, name)?.view().iter().copied().collect();
    match flat[..] {
        [x, y] => Ok([x, y, 0.0]),
        [x, y, roll] => Ok([x, y, roll]),
        _ => {
            let found = format!("{} numbers", flat.len());
            Err(errors::invalid(value.py(), name, "two or three angles in degrees, such as (25, 28)", &found))
        }
    }
}

/// The rig by a few numbers.
pub(super) fn rig_config(options: &Options<'_, '_>) -> PyResult<RigConfig> {
    let mut rig = RigConfig::default();
    options.pixels("camera", &mut rig.camera)?;
    options.number("focal", &mut rig.camera_focal_px)?;
    options.pixels("projector", &mut rig.projector)?;
    options.number("projector_focal", &mut rig.projector_focal_px)?;
    options.number("lens_shift", &mut rig.lens_shift)?;
    options.number("baseline", &mut rig.baseline_mm)?;
    options.number("distance", &mut rig.distance_mm)?;
    options.set("size_mm", &mut rig.size, |v| option::definite_size(v))?;
    options.set("camera_offset", &mut rig.camera_offset_px, |v| vector_of(v, "camera_offset"))?;
    options.set("distortion", &mut rig.distortion, distortion)?;
    options.number("pixel_aspect", &mut rig.camera_pixel_aspect)?;
    options.number("projector_pixel_aspect", &mut rig.projector_pixel_aspect)?;
    options.set("projector_distortion", &mut rig.projector_distortion, distortion)?;
    rig.bend = options.get("bend")?.map(|b| parsed(&b, "bend")).transpose()?;
    match options.get("projector_offset")? {
        Some(offset) => Ok(rig.with_projector_offset(projector_offset(&offset)?)),
        None => Ok(rig),
    }
}

/// Columns and, if wanted, rows of the panel, px.
fn projector_offset(value: &Bound<'_, PyAny>) -> PyResult<[f64; 2]> {
    if let Ok(columns) = value.extract::<f64>() {
        return Ok([columns, 0.0]);
    }
    vector_of(value, "projector_offset")
}

/// Light, lens, sensor.
pub(super) fn render_config(options: &Options<'_, '_>) -> PyResult<RenderConfig> {
    let mut render = if options.flag("exact")? { RenderConfig::exact() } else { RenderConfig::default() };
    options.number("noise", &mut render.noise_levels)?;
    options.number("blur", &mut render.blur_px)?;
    options.whole("bits", &mut render.bits)?;
    options.number("projector_blur", &mut render.projector_blur_px)?;
    options.number("projector_black", &mut render.projector_black)?;
    options.set("crosstalk", &mut render.crosstalk, crosstalk)?;
    options.set("ambient", &mut render.ambient, |v| channels(v, "ambient"))?;
    options.number("exposure", &mut render.exposure)?;
    options.whole("seed", &mut render.seed)?;
    render.encoding = option::parsed_or(options.get("gamma")?.as_ref(), "gamma", Encoding::default())?;
    real_devices(options, &mut render)?;
    Ok(render)
}

/// What real projectors and cameras do to light and values.
fn real_devices(options: &Options<'_, '_>, render: &mut RenderConfig) -> PyResult<()> {
    render.projector_gamma =
        options.get("projector_gamma")?.map(|g| number(&g, "projector_gamma")).transpose()?;
    options.number("projector_falloff", &mut render.projector_falloff)?;
    if let Some(shift) = options.get("channel_shift")? {
        let [rx, ry, bx, by] = vector_of(&shift, "channel_shift")?;
        render.channel_shift_px = [[rx, ry], [bx, by]];
    }
    options.set("lateral_colour", &mut render.lateral_colour, |v| vector_of(v, "lateral_colour"))?;
    options.number("vignetting", &mut render.vignetting)?;
    if let Some(flicker) = options.get("flicker")? {
        let [amount, period_px] = vector_of(&flicker, "flicker")?;
        render.flicker = Some(Flicker { amount, period_px });
    }
    render.demosaic = options.get("demosaic")?.map(|d| parsed(&d, "demosaic")).transpose()?;
    options.number("tone", &mut render.tone)?;
    if let Some(sharpen) = options.get("sharpen")? {
        let [amount, radius_px] = vector_of(&sharpen, "sharpen")?;
        render.sharpen = Some(Sharpen { amount, radius_px });
    }
    render.jpeg_quality = options.get("jpeg")?.map(|q| whole(&q, "jpeg")).transpose()?;
    Ok(())
}

/// A share for neighbouring channels, or all of the matrix.
fn crosstalk(value: &Bound<'_, PyAny>) -> PyResult<[[f64; 3]; 3]> {
    if Numbers::of(value, "crosstalk")?.view().ndim() == 2 {
        return matrix_of(value, "crosstalk");
    }
    let share = number(value, "crosstalk")?;
    if share.is_finite() && share >= 0.0 {
        return Ok(RenderConfig::neighbour_crosstalk(share));
    }
    let wanted = "one share of zero or more, such as 0.2, or a matrix of shape (3, 3)";
    Err(errors::invalid(value.py(), "crosstalk", wanted, &share.to_string()))
}

/// What the rig looks at.
pub(super) fn surface(options: &Options<'_, '_>) -> PyResult<SurfaceKind> {
    let Some(value) = options.get("surface")? else { return Ok(SurfaceKind::default()) };
    match value.extract::<String>().ok().as_deref() {
        Some("plane") => return Ok(SurfaceKind::Plane),
        Some("sphere") => {
            let radius_mm = options.get("radius")?.map(|r| number(&r, "radius")).transpose()?;
            return Ok(SurfaceKind::Sphere { radius_mm });
        }
        Some("step") => return Ok(SurfaceKind::Step),
        Some("sheet") => return Ok(SurfaceKind::Sheet),
        _ => {}
    }
    let mut scale = 1.0;
    options.number("mesh_scale", &mut scale)?;
    let py = value.py();
    if !(scale.is_finite() && scale > 0.0) {
        return Err(errors::invalid(py, "mesh_scale", "a factor above zero", &scale.to_string()));
    }
    let mesh = mesh(&value, scale)?;
    let frames = [("object", false), ("camera", true)];
    let in_camera = options.get("mesh_frame")?.map_or(Ok(false), |f| one_of(&f, "mesh_frame", &frames))?;
    Ok(if in_camera { SurfaceKind::MeshInCamera(mesh) } else { SurfaceKind::Mesh(mesh) })
}

/// A cloud with triangles, or a file of one.
fn mesh(value: &Bound<'_, PyAny>, scale: f64) -> PyResult<TriangleMesh> {
    let py = value.py();
    let of_cloud = |cloud: &CoreCloud| {
        let vertices: Vec<Point3<f64>> = cloud.points.iter().map(|p| p.position * scale).collect();
        TriangleMesh::new(vertices, cloud.triangles.clone())
    };
    if let Ok(cloud) = value.cast::<PointCloud>() {
        let cloud = &cloud.get().cloud;
        return py.detach(|| of_cloud(cloud)).raise(py, Stage::Detect);
    }
    let path = files::path_of(value)?;
    let extension = path.and_then(|p| Some(p.extension()?.to_ascii_lowercase()));
    let is_obj = match extension.as_ref().and_then(|e| e.to_str()) {
        Some("obj") => true,
        Some("ply") => false,
        _ => {
            let wanted = "\"plane\", \"sphere\", \"step\", \"sheet\", a PointCloud with triangles, or a file whose name \
                          ends in .ply or .obj";
            return Err(errors::invalid(py, "surface", wanted, &option::repr_of(value)));
        }
    };
    let contents = files::read(value, InputKind::Mesh)?;
    let read = || {
        let bytes = contents.bytes.as_slice();
        of_cloud(&if is_obj { read_obj(bytes) } else { read_ply(bytes) }?)
    };
    py.detach(read).map_err(|e| raised_from(py, &e, Stage::Detect, contents.name.as_deref()))
}

/// What the projector shows.
pub(super) fn pattern(options: &Options<'_, '_>) -> PyResult<PatternKind> {
    let Some(value) = options.get("pattern")? else { return Ok(PatternKind::Usual) };
    if let Ok(stripes) = value.cast::<StripePattern>() {
        return Ok(PatternKind::Known(Pattern::Stripes(stripes.get().0.clone())));
    }
    if let Ok(checker) = value.cast::<CheckerPattern>() {
        return Ok(PatternKind::Known(Pattern::Checker(checker.get().0.clone())));
    }
    if let Ok(sequence) = value.cast::<SequencePattern>() {
        return Ok(PatternKind::Known(Pattern::Sequence(sequence.get().0.clone())));
    }
    match value.extract::<String>().ok().as_deref() {
        Some("stripes") => Ok(PatternKind::Stripes),
        Some("checker") => Ok(PatternKind::Checker),
        _ => {
            let wanted = "\"stripes\", \"checker\", a StripePattern, a CheckerPattern or a SequencePattern";
            Err(errors::invalid(value.py(), "pattern", wanted, &option::repr_of(&value)))
        }
    }
}

pub(super) fn wall(options: &Options<'_, '_>) -> PyResult<WallKind> {
    const NAMES: [(&str, WallKind); 2] = [("auto", WallKind::Usual), ("none", WallKind::None)];
    let Some(value) = options.get("wall")? else { return Ok(WallKind::Usual) };
    if let Ok(distance) = value.extract::<f64>() {
        if distance > 0.0 {
            return Ok(WallKind::Behind(distance));
        }
        return Err(errors::invalid(
            value.py(),
            "wall",
            "a distance above zero in mm",
            &distance.to_string(),
        ));
    }
    one_of(&value, "wall", &NAMES)
}

/// Refuses numbers of a rig beside a rig: only the surface's place and size still count.
pub(super) fn only_place(py: Python<'_>, rig: &RigConfig) -> PyResult<()> {
    let default = RigConfig::default();
    let placed = RigConfig { distance_mm: rig.distance_mm, size: rig.size, bend: rig.bend, ..default };
    if placed == *rig {
        return Ok(());
    }
    let wanted = "either a rig, or its camera, focal, pixel_aspect, projector, projector_focal, projector_pixel_aspect, \
         projector_offset, projector_distortion, lens_shift, baseline and distortion";
    Err(errors::invalid(py, "rig", wanted, "both"))
}

pub(super) fn poses(value: &Bound<'_, PyAny>) -> PyResult<Vec<PoseConfig>> {
    let pose =
        |[x, y, roll]: [f64; 3]| PoseConfig { roll_rad: roll.to_radians(), ..PoseConfig::tilted(x, y) };
    value.try_iter()?.map(|p| angles(&p?, "pose").map(pose)).collect()
}
