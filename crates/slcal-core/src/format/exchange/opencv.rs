//! `OpenCV`'s FileStorage: YAML, XML or JSON.
//!
//! Integers are pixel centres, x right, y down, z forward, lengths millimetres: as in this library. Any K and all five terms of
//! distortion have a place. `camera_matrix`, `distortion_coefficients`, `image_width` and `image_height` are the camera under the names
//! of `OpenCV`'s calibration sample; `cam_K`, `cam_kc`, `proj_K`, `proj_kc`, `R` and `T` are the pair under those of projector-camera
//! tools (D. Moreno, G. Taubin, "Simple, accurate, and robust projector-camera calibration", 3DIMPVT 2012), with
//! X_projector = R X_camera + T as `cv2.stereoCalibrate` has it. All else that a rig knows follows in the map `slcal`, under the names of rig.json.

use nalgebra::{Matrix3, Rotation3, Vector3};
use serde_json::Value;

use super::devices::plain_rig;
use super::extras;
use super::files::{ExchangeFormat, ExportedFile, ImportConfig, StorageText};
use super::guess::Source;
use super::losses::Losses;
use super::storage::{Item, named, written};
use super::text::rows;
use crate::error::{ErrorSubject, Result};
use crate::format::budget::Budget;
use crate::format::camera::{FIRST, SECOND, device, numbers};
use crate::format::rig_json::rig_of_value;
use crate::format::tree::{Expecting, Node, from_json, parse};
use crate::geometry::Pose;
use crate::rig::{Device, Projector, Rig, StereoPose};

const FILE: Expecting = Expecting(ErrorSubject::OpenCvFile);
/// The map of all that has no name in other programs.
const EXTRAS: &str = "slcal";
/// Names of the pose of the second device.
pub(super) const ROTATION: [&str; 3] = ["R", "rotation", "rotation_matrix"];
pub(super) const TRANSLATION: [&str; 3] = ["T", "t", "translation"];
const COMMENT: &str = "Lengths in mm, pixel centres at integers; X_projector = R X_camera + T.";

pub(super) fn export(rig: &Rig, storage: StorageText, losses: &mut Losses) -> Result<Vec<ExportedFile>> {
    let mut items = Vec::new();
    let mut put = |name: &str, item| items.push((name.to_owned(), item));
    let matrix = |d: &Device| Item::Matrix(3, rows(&d.model.intrinsics.matrix()).to_vec());
    let lens = |d: &Device| Item::Matrix(5, d.model.distortion.to_array().to_vec());
    let camera = &rig.camera;
    put("image_width", Item::Whole(camera.model.width));
    put("image_height", Item::Whole(camera.model.height));
    put("camera_matrix", matrix(camera));
    put("distortion_coefficients", lens(camera));
    if let Some(Projector { device: projector, from_camera: StereoPose { pose, .. }, .. }) = &rig.projector {
        put("projector_width", Item::Whole(projector.model.width));
        put("projector_height", Item::Whole(projector.model.height));
        put("cam_K", matrix(camera));
        put("cam_kc", lens(camera));
        put("proj_K", matrix(projector));
        put("proj_kc", lens(projector));
        put("R", Item::Matrix(3, rows(pose.rotation.matrix()).to_vec()));
        put("T", Item::Matrix(1, pose.translation.as_slice().to_vec()));
    }
    put(EXTRAS, Item::Map(named(&extras::of_rig(rig)?)));
    let (text, whole) = written(&items, storage, COMMENT);
    if !whole {
        losses.notes.push(
            "opencv: names with control characters or of more than 4000 bytes are written without them"
                .into(),
        );
    }
    for (name, device) in rig.devices() {
        let s = device.model.intrinsics.skew;
        if s != 0.0 {
            losses.notes.push(format!(
                "opencv: the matrices hold the {name}'s skew of {s} px, but cv2.projectPoints and its kin leave it out"
            ));
        }
    }
    let name = match storage {
        StorageText::Yaml => "rig.yml",
        StorageText::Xml => "rig.xml",
        StorageText::Json => "rig.json",
    };
    Ok(vec![ExportedFile { name, bytes: text.into_bytes() }])
}

pub(super) fn import(
    source: Source<'_>,
    config: &ImportConfig,
    notes: &mut Vec<String>,
    budget: &Budget,
) -> Result<Rig> {
    let root = match source {
        Source::Tree(root) => root,
        Source::Bytes(bytes) => root_of(FILE.text(bytes)?, budget)?,
    };
    let rig = devices(&root, config, ExchangeFormat::OpenCv, FILE, notes)?;
    let Some(node) = root.get(EXTRAS) else {
        if rig.projector.is_some() {
            notes.push("T is taken to be in mm".to_owned());
        }
        return Ok(rig);
    };
    match extras::from_node(node, EXTRAS, FILE, budget)? {
        Value::Object(found) => extras::added_to(&rig, found, FILE),
        _ => Ok(rig),
    }
}

fn root_of<'a>(text: &'a str, budget: &Budget) -> Result<Node<'a>> {
    if !text.starts_with('{') {
        return parse(text, FILE, budget);
    }
    let value = FILE.json(text, budget)?;
    if value.get("schema").is_none() {
        return from_json(value, budget);
    }
    // Says what is wrong with it, if anything: the schema of a newer version, for instance.
    rig_of_value(value)?;
    Err(FILE.malformed("this is a rig file already; use it as it is"))
}

/// The devices of a text or of named arrays.
pub(super) fn devices(
    root: &Node<'_>,
    config: &ImportConfig,
    format: ExchangeFormat,
    expecting: Expecting,
    notes: &mut Vec<String>,
) -> Result<Rig> {
    let Some(camera) = device(root, &FIRST, expecting)? else {
        let expected =
            "expected a camera matrix (camera_matrix, cameraMatrix, cam_K, camera_K, K or M1), found none";
        return Err(expecting.malformed(expected));
    };
    let camera = super::devices::device(camera, config.camera_size, "camera", notes)?;
    let projector = device(root, &SECOND, expecting)?
        .map(|known| {
            let device = super::devices::device(known, config.projector_size, "projector", notes)?;
            Ok((device, pose(root, expecting)?))
        })
        .transpose()?;
    Ok(plain_rig(camera, projector.as_ref(), format))
}

fn pose(root: &Node<'_>, expecting: Expecting) -> Result<Pose> {
    let get = |names: &[&'static str]| {
        names.iter().find_map(|n| root.get(n).map(|node| (*n, node))).ok_or_else(|| {
            expecting.malformed(format!(
                "expected {} (X_projector = R X_camera + T, mm) beside the second matrix, found none",
                names[0]
            ))
        })
    };
    let (name, node) = get(&ROTATION)?;
    let r = numbers(node, name, expecting)?;
    let rotation = match r.len() {
        9 => Matrix3::from_row_slice(&r),
        3 => *Rotation3::new(Vector3::from_row_slice(&r)).matrix(),
        n => {
            return Err(
                expecting.malformed(format!("{name}: expected 3x3 numbers or a rotation vector, found {n}"))
            );
        }
    };
    let (name, node) = get(&TRANSLATION)?;
    let t = numbers(node, name, expecting)?;
    if t.len() != 3 {
        return Err(expecting.malformed(format!("{name}: expected 3 numbers, found {}", t.len())));
    }
    super::devices::pose_of(&rotation, Vector3::from_row_slice(&t), expecting, name)
}
