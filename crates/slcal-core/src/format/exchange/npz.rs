//! NumPy's .npz: named arrays, as `numpy.savez` writes them; nothing in it is pickled.
//!
//! Conventions are this library's: integers are pixel centres, x right, y down, z forward, millimetres, radians. Any K, all terms of
//! distortion and all other values of a rig are represented. The devices have the names of `Rig.to_opencv`:
//!
//! | | shape | |
//! |---|---|---|
//! | `camera_K`, `projector_K` | (3, 3) | px |
//! | `camera_dist`, `projector_dist` | (5,) | k1, k2, p1, p2, k3 |
//! | `camera_size`, `projector_size` | (2,) | width, height, px |
//! | `R`, `t` | (3, 3), (3, 1) | X_projector = R X_camera + t, mm |
//! | `camera_sigma`, `projector_sigma` | (8,) | 1σ of focal length, cx, cy, k1, k2, p1, p2, k3 |
//! | `camera_aspect_sigma`, `projector_aspect_sigma` | () | 1σ of fy/fx |
//! | `sigma_t_mm`, `sigma_r_rad` | (3,) | 1σ |
//! | `view_photo`, `view_size_mm` | (V,), (V, 2) | |
//! | `camera_from_sheet_R`, `_t` | (V, 3, 3), (V, 3) | and `projector_from_sheet` |
//! | `camera_vanishing_points` | (V, 2, 3) | homogeneous; and `projector_vanishing_points` |
//! | `corners_px`, `rms_px` | (V, 4, 2), (V, 3) | rms of edges, corners and projector |
//! | `view_bend` | (V, 3, 12) | mm: the coefficients of the sheet's bend, their 1σ, and that expected beforehand |
//! | `verdict`, `verdict_cause`, `verdict_advice` | () | |
//! | `focal_sigma_percent`, `expected_point_sigma_mm`, `warnings` | (2,), (), (W, 3) | warnings: code, message, advice |
//! | `depth_sigma_percent` | () | |
//! | `covariance`, `covariance_parameters` | (P, P), (P,) | |
//! | `method` | () | |
//!
//! Unknown values are NaN within an array, or have no array.

use std::io::{Cursor, Read as _, Write as _};

use serde_json::{Map, Value, json};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::files::{ExchangeFormat, ExportedFile, ImportConfig};
use super::npy::{Array, FILE};
use super::text::rows;
use super::{extras, opencv};
use crate::error::{Error, ErrorSubject, Result};
use crate::format::budget::Budget;
use crate::format::camera::{FIRST, FISHEYE, SECOND};
use crate::format::rig_json::rig_value;
use crate::format::tree::Node;
use crate::rig::{DeviceSigma, Rig, StereoPose};

/// Entries of the archive.
const MOST_ENTRIES: usize = 1000;
/// Values of an array of a device, and bytes of its file: a description may have 64 KiB.
const MOST_OF_A_DEVICE: usize = 64;
const LARGEST_OF_A_DEVICE: u64 = 66_000;
/// Memory of a view as values of JSON, with all that it may have, bytes.
const VIEW_MEMORY: usize = 8000;
/// Memory of a warning as values of JSON, beside its words, bytes.
const WARNING_MEMORY: usize = 1000;

/// The other arrays that are read, beside those of views.
const OTHERS: [&str; 18] = [
    "camera_sigma",
    "camera_aspect_sigma",
    "projector_sigma",
    "projector_aspect_sigma",
    "sigma_t_mm",
    "sigma_r_rad",
    extras::MIRRORED,
    "method",
    "view_photo",
    "verdict",
    "verdict_cause",
    "verdict_advice",
    "focal_sigma_percent",
    "expected_point_sigma_mm",
    "depth_sigma_percent",
    "warnings",
    "covariance",
    "covariance_parameters",
];

type Named = Vec<(&'static str, Array)>;

pub(super) fn export(rig: &Rig) -> Result<Vec<ExportedFile>> {
    let mut arrays: Named = Vec::new();
    let numbers = |shape: &[usize], values: Vec<f64>| Array::Numbers(shape.to_vec(), values);
    let devices = [
        (
            ["camera_K", "camera_dist", "camera_size", "camera_sigma", "camera_aspect_sigma"],
            Some(&rig.camera),
        ),
        (
            ["projector_K", "projector_dist", "projector_size", "projector_sigma", "projector_aspect_sigma"],
            rig.projector.as_ref().map(|p| &p.device),
        ),
    ];
    for (names, device) in devices {
        let Some(device) = device else { continue };
        let model = &device.model;
        arrays.push((names[0], numbers(&[3, 3], rows(&model.intrinsics.matrix()).to_vec())));
        arrays.push((names[1], numbers(&[5], model.distortion.to_array().to_vec())));
        arrays.push((names[2], Array::Wholes(vec![2], vec![model.width.into(), model.height.into()])));
        if let Some(DeviceSigma { focal_px, cx_px, cy_px, distortion, aspect }) = device.sigma {
            let values = [focal_px, cx_px, cy_px].into_iter().chain(distortion).collect();
            arrays.push((names[3], numbers(&[8], values)));
            arrays.push((names[4], numbers(&[], vec![aspect])));
        }
    }
    if let Some(StereoPose { pose, sigma_t_mm, sigma_r_rad }) = rig.projector.map(|p| p.from_camera) {
        arrays.push(("R", numbers(&[3, 3], rows(pose.rotation.matrix()).to_vec())));
        arrays.push(("t", numbers(&[3, 1], pose.translation.as_slice().to_vec())));
        let sigmas = [("sigma_t_mm", sigma_t_mm), ("sigma_r_rad", sigma_r_rad)];
        arrays.extend(sigmas.into_iter().filter_map(|(n, s)| Some((n, numbers(&[3], s?.to_vec())))));
    }
    if rig.is_mirrored() {
        arrays.push((extras::MIRRORED, numbers(&[], vec![1.0])));
    }
    arrays.push(("method", Array::Words(vec![], vec![rig.method.clone()])));
    if !rig.views.is_empty() {
        arrays.extend(views(rig)?);
    }
    if let Some(q) = &rig.quality {
        let optional = |x: Option<f64>| x.unwrap_or(f64::NAN);
        arrays.push(("verdict", Array::Words(vec![], vec![q.verdict.name().to_owned()])));
        arrays.push(("verdict_cause", Array::Words(vec![], vec![q.cause.clone()])));
        arrays.push(("verdict_advice", Array::Words(vec![], vec![q.advice.clone()])));
        let focal = vec![q.focal_sigma_percent_camera, optional(q.focal_sigma_percent_projector)];
        arrays.push(("focal_sigma_percent", numbers(&[2], focal)));
        arrays.push(("expected_point_sigma_mm", numbers(&[], vec![optional(q.expected_point_sigma_mm)])));
        arrays.extend(q.depth_sigma_percent.map(|s| ("depth_sigma_percent", numbers(&[], vec![s]))));
        let words = q.warnings.iter().flat_map(|w| [w.code.clone(), w.message.clone(), w.advice.clone()]);
        arrays.push(("warnings", Array::Words(vec![q.warnings.len(), 3], words.collect())));
    }
    if let Some(c) = rig.covariance.as_ref().filter(|c| !c.parameters.is_empty()) {
        let n = c.parameters.len();
        arrays.push(("covariance", numbers(&[n, n], c.matrix.transpose().as_slice().to_vec())));
        let names = c.parameters.iter().map(ToString::to_string).collect();
        arrays.push(("covariance_parameters", Array::Words(vec![n], names)));
    }
    Ok(vec![ExportedFile { name: "rig.npz", bytes: zipped(&arrays)? }])
}

/// The arrays with an entry for each view, their shapes, and the places of their numbers in a view of rig.json.
const OF_VIEWS: [(&str, &[usize], &[&str]); 10] = [
    ("view_size_mm", &[2], &["/size_mm"]),
    ("camera_from_sheet_R", &[3, 3], &["/camera_from_sheet/R"]),
    ("camera_from_sheet_t", &[3], &["/camera_from_sheet/t"]),
    ("projector_from_sheet_R", &[3, 3], &["/projector_from_sheet/R"]),
    ("projector_from_sheet_t", &[3], &["/projector_from_sheet/t"]),
    ("camera_vanishing_points", &[2, 3], &["/vanishing_points/camera"]),
    ("projector_vanishing_points", &[2, 3], &["/vanishing_points/projector"]),
    ("corners_px", &[4, 2], &["/corners_px"]),
    ("rms_px", &[3], &["/rms_px/edges", "/rms_px/corners", "/rms_px/projector"]),
    (BENDS, &[3, 12], &["/bend/coefficients_mm", "/bend/sigma_mm", "/bend/expected_sigma_mm"]),
];
/// Left out where every sheet was taken for flat.
const BENDS: &str = "view_bend";

fn views(rig: &Rig) -> Result<Named> {
    let value = rig_value(rig)?;
    let of_view = |view: usize, shape: &[usize], places: &[&str]| -> Vec<f64> {
        let each = shape.iter().product::<usize>() / places.len();
        let part = |place: &&str| value["views"][view].pointer(place).filter(|part| !part.is_null());
        places.iter().flat_map(|p| part(p).map_or_else(|| vec![f64::NAN; each], flat)).collect()
    };
    let n = rig.views.len();
    let photos = rig.views.iter().map(|v| v.photo.clone().unwrap_or_default()).collect();
    let bends = rig.views.iter().any(|v| v.bend.is_some());
    let written = OF_VIEWS.iter().filter(|(name, ..)| bends || *name != BENDS);
    let numbers = written.map(|&(name, shape, places)| {
        let values = (0..n).flat_map(|i| of_view(i, shape, places)).collect();
        (name, Array::Numbers([&[n], shape].concat(), values))
    });
    Ok([("view_photo", Array::Words(vec![n], photos))].into_iter().chain(numbers).collect())
}

/// The numbers of lists of lists.
fn flat(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(flat).collect(),
        number => vec![number.as_f64().unwrap_or(f64::NAN)],
    }
}

fn zipped(arrays: &Named) -> Result<Vec<u8>> {
    let failed = |e: std::io::Error| Error::writing(ErrorSubject::NpzFile, e);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = stored();
    for (name, array) in arrays {
        zip.start_file(format!("{name}.npy"), options).map_err(|e| failed(e.into()))?;
        zip.write_all(&array.encoded()).map_err(failed)?;
    }
    zip.finish().map(Cursor::into_inner).map_err(|e| failed(e.into()))
}

/// How arrays stand in an archive: uncompressed, as numpy.savez; the time is the format's first, so that the same arrays give the same bytes.
pub(in crate::format) fn stored() -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(zip::DateTime::default())
}

/// The names that the values of devices and their pose go by.
fn names_of_devices() -> impl Iterator<Item = &'static str> {
    let of_poses = opencv::ROTATION.into_iter().chain(opencv::TRANSLATION);
    FIRST.all().chain(SECOND.all()).chain(of_poses).chain([FISHEYE])
}

/// The arrays that are asked for, by their names. Others are not unpacked: they are nobody's business, and may be large.
struct Arrays<'b> {
    /// Of the devices.
    devices: Vec<(&'static str, Array)>,
    others: Vec<(&'static str, Array)>,
    budget: &'b Budget,
}

impl<'b> Arrays<'b> {
    fn unzipped(bytes: &[u8], budget: &'b Budget) -> Result<Self> {
        let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|e| broken(&e))?;
        if zip.len() > MOST_ENTRIES {
            let found = zip.len();
            return Err(FILE.malformed(format!("expected at most {MOST_ENTRIES} arrays, found {found}")));
        }
        let mut unpacked = |name: &'static str, largest: u64| -> Result<Option<(&'static str, Array)>> {
            let Some(index) = zip.index_for_name(&format!("{name}.npy")) else { return Ok(None) };
            let entry = zip.by_index(index).map_err(|e| broken(&e))?;
            let size = entry.size();
            if size > largest {
                return Ok(None);
            }
            budget.unpack(size)?;
            budget.keep(usize::try_from(size).unwrap_or(usize::MAX))?;
            let mut data = Vec::new();
            entry.take(size).read_to_end(&mut data).map_err(|e| broken(&e))?;
            Ok(Some((name, Array::decoded(&data, name, budget)?)))
        };
        let mut arrays = Self { devices: Vec::new(), others: Vec::new(), budget };
        for name in names_of_devices() {
            arrays.devices.extend(unpacked(name, LARGEST_OF_A_DEVICE)?);
        }
        for name in OTHERS.into_iter().chain(OF_VIEWS.iter().map(|(name, ..)| *name)) {
            arrays.others.extend(unpacked(name, u64::MAX)?);
        }
        Ok(arrays)
    }

    /// The devices, as a text would have them.
    fn of_devices(&self) -> Node<'static> {
        let numbers = self.devices.iter().filter_map(|(name, array)| match array {
            Array::Numbers(_, values) if values.len() <= MOST_OF_A_DEVICE => {
                let words = values.iter().map(|v| Node::Scalar(v.to_string().into())).collect();
                Some(((*name).into(), Node::List(words)))
            }
            _ => None,
        });
        Node::Map(numbers.collect())
    }

    fn get(&self, name: &str) -> Option<&Array> {
        self.others.iter().find(|(n, _)| *n == name).map(|(_, array)| array)
    }

    /// The numbers of the array of this name, which must have this shape; `None` where there is no such array.
    fn numbers(&self, name: &str, shape: &[usize]) -> Result<Option<&[f64]>> {
        match self.get(name) {
            None => Ok(None),
            Some(Array::Numbers(found, values)) if found.as_slice() == shape => Ok(Some(values)),
            Some(other) => Err(FILE.malformed(format!(
                "{name}: expected numbers of shape {shape:?}, found {}",
                match other {
                    Array::Numbers(found, _) | Array::Wholes(found, _) => format!("{found:?}"),
                    Array::Words(..) => "words".to_owned(),
                }
            ))),
        }
    }

    /// The numbers of that array as lists of lists.
    fn lists(&self, name: &str, shape: &[usize]) -> Result<Option<Value>> {
        let Some(values) = self.numbers(name, shape)? else { return Ok(None) };
        self.budget.keep_list::<Value>(values.len())?;
        Ok(Some(nested(values, shape)))
    }

    /// The words of the array of this name, which belong together in groups of `each`.
    fn words(&self, name: &str, each: usize) -> Result<Option<&[String]>> {
        match self.get(name) {
            None => Ok(None),
            Some(Array::Words(_, words)) if words.len() % each == 0 => Ok(Some(words)),
            Some(_) => Err(FILE.malformed(format!("{name}: expected words, {each} together"))),
        }
    }

    fn word(&self, name: &str) -> Result<Option<String>> {
        Ok(self.words(name, 1)?.and_then(|w| w.first().cloned()))
    }
}

fn broken(e: &dyn std::fmt::Display) -> Error {
    FILE.malformed(format!("this is not a whole zip archive: {e}"))
}

pub(super) fn import(
    bytes: &[u8],
    config: &ImportConfig,
    notes: &mut Vec<String>,
    budget: &Budget,
) -> Result<Rig> {
    let arrays = Arrays::unzipped(bytes, budget)?;
    let rig = opencv::devices(&arrays.of_devices(), config, ExchangeFormat::Npz, FILE, notes)?;
    let extras = read_extras(&arrays)?;
    drop(arrays);
    extras::added_to(&rig, extras, FILE)
}

/// Numbers as lists of lists; null when all of them are NaN.
fn nested(values: &[f64], shape: &[usize]) -> Value {
    if values.iter().all(|v| v.is_nan()) {
        return Value::Null;
    }
    match shape {
        [] => Value::from(values[0]),
        [_] => values.iter().map(|v| Value::from(*v)).collect(),
        [_, inner @ ..] => {
            let each: usize = inner.iter().product();
            values.chunks_exact(each).map(|c| nested(c, inner)).collect()
        }
    }
}

/// The values beside the devices, as in rig.json.
fn read_extras(arrays: &Arrays<'_>) -> Result<Map<String, Value>> {
    let mut found = Map::new();
    let one = |name: &str, shape: &[usize]| arrays.lists(name, shape);
    for name in ["camera_sigma", "projector_sigma"] {
        if let Some(Value::Array(s)) = one(name, &[8])? {
            let aspect = one(&name.replace("_sigma", "_aspect_sigma"), &[])?;
            let sigma = json!({
                "focal_px": s[0], "cx_px": s[1], "cy_px": s[2], "distortion": s[3..], "aspect": aspect,
            });
            found.insert(name.to_owned(), sigma);
        }
    }
    found.extend(one(extras::MIRRORED, &[])?.map(|s| (extras::MIRRORED.to_owned(), s)));
    for name in ["sigma_t_mm", "sigma_r_rad"] {
        found.extend(one(name, &[3])?.map(|s| (name.to_owned(), s)));
    }
    found.extend(arrays.word("method")?.map(|m| ("method".to_owned(), Value::from(m))));
    if let Some(photos) = arrays.words("view_photo", 1)? {
        found.insert("views".to_owned(), read_views(arrays, photos)?);
    }
    if let (Some(verdict), Some(focal)) = (arrays.word("verdict")?, one("focal_sigma_percent", &[2])?) {
        let warnings = arrays.words("warnings", 3)?.unwrap_or_default();
        arrays.budget.keep(warnings.len().saturating_mul(WARNING_MEMORY))?;
        let warnings = warnings.chunks_exact(3);
        let warnings: Value =
            warnings.map(|w| json!({"code": w[0], "message": w[1], "advice": w[2]})).collect();
        let quality = json!({
            "verdict": verdict,
            "cause": arrays.word("verdict_cause")?.unwrap_or_default(),
            "advice": arrays.word("verdict_advice")?.unwrap_or_default(),
            "focal_sigma_percent": {"camera": focal[0], "projector": focal[1]},
            "depth_sigma_percent": one("depth_sigma_percent", &[])?,
            "expected_point_sigma_mm": one("expected_point_sigma_mm", &[])?,
            "warnings": warnings,
        });
        found.insert("quality".to_owned(), quality);
    }
    if let Some(names) = arrays.words("covariance_parameters", 1)? {
        let matrix = one("covariance", &[names.len(), names.len()])?;
        found.insert("covariance".to_owned(), json!({"parameters": names, "matrix": matrix}));
    }
    Ok(found)
}

fn read_views(arrays: &Arrays<'_>, photos: &[String]) -> Result<Value> {
    arrays.budget.keep(photos.len().saturating_mul(VIEW_MEMORY))?;
    let mut views: Vec<Value> =
        photos.iter().map(|p| json!({"photo": Some(p).filter(|p| !p.is_empty())})).collect();
    for (name, shape, places) in OF_VIEWS {
        let Some(values) = arrays.numbers(name, &[&[photos.len()], shape].concat())? else { continue };
        let count = shape.iter().product::<usize>();
        let shape = if places.len() > 1 { &shape[1..] } else { shape };
        for (view, values) in views.iter_mut().zip(values.chunks_exact(count)) {
            for (place, part) in places.iter().zip(values.chunks_exact(count / places.len())) {
                let field = place.split('/').skip(1).fold(&mut *view, |at, name| &mut at[name]);
                *field = nested(part, shape);
            }
        }
    }
    for view in &mut views {
        for pose in ["camera_from_sheet", "projector_from_sheet"] {
            if view[pose]["R"].is_null() {
                view[pose] = Value::Null;
            }
        }
        if view["bend"]["coefficients_mm"][0].is_null() {
            view["bend"] = Value::Null;
        }
    }
    Ok(Value::Array(views))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn budget(bytes: usize) -> Budget {
        Budget::new(ErrorSubject::NpzFile, bytes)
    }

    /// An archive of files, compressed.
    fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in files {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.finish().unwrap().into_inner()
    }

    fn refusal(bytes: &[u8]) -> String {
        Arrays::unzipped(bytes, &budget(bytes.len())).err().map_or(String::new(), |e| e.to_string())
    }

    #[test]
    fn arrays_of_another_shape_are_refused() {
        let others = vec![("corners_px", Array::Numbers(vec![1, 2, 4], vec![0.0; 8]))];
        let budget = budget(0);
        let arrays = Arrays { devices: Vec::new(), others, budget: &budget };
        assert!(arrays.numbers("corners_px", &[1, 2, 4]).unwrap().is_some());
        let said = arrays.numbers("corners_px", &[1, 4, 2]).unwrap_err().to_string();
        assert!(said.contains("[1, 4, 2]") && said.contains("[1, 2, 4]"), "{said}");
    }

    #[test]
    fn only_arrays_that_are_asked_for_are_unpacked() {
        let large = vec![0; 70_000];
        let bytes = archive(&[("images.npy", b"no array"), ("camera_K.npy", &large), ("notes.txt", b"?")]);
        assert_eq!(refusal(&bytes), "");
        assert!(refusal(&archive(&[("covariance.npy", &large)])).contains("covariance: expected an array"));
    }

    #[test]
    fn what_is_unpacked_is_limited_in_all() {
        let bytes = archive(&[("view_photo.npy", &vec![0; 3_000_000])]);
        let nearly_spent = budget(bytes.len());
        nearly_spent.unpack(254_000_000).unwrap();
        let said = Arrays::unzipped(&bytes, &nearly_spent).err().unwrap().to_string();
        assert!(said.contains("at most 256 MB when it is unpacked, found 257 MB"), "{said}");
        let words = Array::Words(vec![100_000], vec![String::new(); 100_000]).encoded();
        let bytes = archive(&[("view_photo.npy", &words)]);
        let own = budget(bytes.len());
        let said = read_extras(&Arrays::unzipped(&bytes, &own).unwrap()).unwrap_err().to_string();
        assert!(said.contains("MB of memory"), "{said}");
    }
}
