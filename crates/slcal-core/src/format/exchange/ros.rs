//! ROS `camera_info` as YAML, as its `camera_calibration_parsers` reads it: a file per device.
//!
//! Integers are pixel centres (ROS takes its camera model from `OpenCV`), the optical frame has x right, y down, z forward. Distortion is
//! `plumb_bob` with all five terms. K has no skew: `sensor_msgs/CameraInfo` defines a zero in its place, and its readers use no
//! other. A `camera_info` says nothing about other devices: the projector's file has its place under `projector_from_camera`, which
//! readers of ROS skip, and the call that publishes it to tf in a comment.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::devices::{plain_rig, pose_of};
use super::files::{ExchangeFormat, ExportedFile, ImportConfig};
use super::guess::Source;
use super::losses::{Holds, Losses};
use super::text::{joined, number, rows};
use crate::error::{Error, ErrorSubject, Result};
use crate::format::budget::Budget;
use crate::format::camera::{FIRST, device, numbers};
use crate::format::tree::{Expecting, Node};
use crate::geometry::{Camera, Intrinsics, Pose};
use crate::rig::{Device, Projector, Rig};

const FILE: Expecting = Expecting(ErrorSubject::RosFile);
const POSE: &str = "projector_from_camera";
const ROTATION: &str = "rotation_matrix";
const TRANSLATION: &str = "translation_mm";
const MM_PER_METRE: f64 = 1000.0;

pub(super) fn export(rig: &Rig, losses: &mut Losses) -> Result<Vec<ExportedFile>> {
    let mut files = vec![ExportedFile {
        name: "camera.yaml",
        bytes: camera_info("camera", &rig.camera, losses)?.into_bytes(),
    }];
    if let Some(Projector { device, from_camera, .. }) = &rig.projector {
        let mut text = camera_info("projector", device, losses)?;
        text.push_str(&placed(&from_camera.pose));
        files.push(ExportedFile { name: "projector.yaml", bytes: text.into_bytes() });
    }
    losses.around(rig, Holds::default());
    Ok(files)
}

fn camera_info(name: &str, device: &Device, losses: &mut Losses) -> Result<String> {
    let model = &device.model;
    let intrinsics = Intrinsics { skew: 0.0, ..model.intrinsics };
    losses.lens(name, device, &Camera { intrinsics, ..*model })?;
    let k = intrinsics.matrix();
    let projection = k.insert_column(3, 0.0);
    let matrix = |title: &str, columns: usize, data: String| {
        format!(
            "{title}:\n  rows: {}\n  cols: {columns}\n  data: [{data}]\n",
            if columns == 5 { 1 } else { 3 }
        )
    };
    Ok([
        "# Pixel centres at integers; optical frame: x right, y down, z forward.\n".to_owned(),
        format!("image_width: {}\nimage_height: {}\ncamera_name: {name}\n", model.width, model.height),
        matrix("camera_matrix", 3, joined(rows(&k), ", ")),
        "distortion_model: plumb_bob\n".to_owned(),
        matrix("distortion_coefficients", 5, joined(model.distortion.to_array(), ", ")),
        matrix("rectification_matrix", 3, joined(rows(&Matrix3::identity()), ", ")),
        matrix("projection_matrix", 4, joined(projection.transpose().iter().copied(), ", ")),
    ]
    .concat())
}

/// Where the projector stands, for a rig; and for tf, which wants metres and the projector's pose in the camera's frame.
fn placed(projector_from_camera: &Pose) -> String {
    let pose = projector_from_camera.inverse();
    let q = UnitQuaternion::from_rotation_matrix(&pose.rotation);
    let t = pose.translation / MM_PER_METRE;
    let named = [("x", t.x), ("y", t.y), ("z", t.z), ("qx", q.i), ("qy", q.j), ("qz", q.k), ("qw", q.w)];
    let call: Vec<String> =
        named.iter().map(|(name, value)| format!("--{name} {} ", number(*value))).collect();
    let call = call.concat();
    format!(
        "# X_projector = R X_camera + t, mm. Readers of ROS skip this; tf is told by\n# ros2 run tf2_ros static_transform_publisher \
         {call}--frame-id camera_optical_frame --child-frame-id projector_optical_frame\n{POSE}:\n  {ROTATION}:\n    rows: 3\n    \
         cols: 3\n    data: [{}]\n  {TRANSLATION}: [{}]\n",
        joined(rows(projector_from_camera.rotation.matrix()), ", "),
        joined(projector_from_camera.translation.iter().copied(), ", ")
    )
}

pub(super) fn import(
    files: Vec<Source<'_>>,
    config: &ImportConfig,
    notes: &mut Vec<String>,
    budget: &Budget,
) -> Result<Rig> {
    if files.len() > 2 {
        let found = format!("{} files", files.len());
        return Err(Error::invalid(ErrorSubject::Import, "the camera's file and the projector's", found));
    }
    let mut roots = files.into_iter().map(|f| f.tree(FILE, budget)).collect::<Result<Vec<_>>>()?;
    if roots.len() == 2 && of_projector(&roots[0]) && !of_projector(&roots[1]) {
        roots.swap(0, 1);
    }
    let known = |root: &Node<'_>| {
        device(root, &FIRST, FILE)?.ok_or_else(|| FILE.malformed("expected camera_matrix, found none"))
    };
    let camera = super::devices::device(known(&roots[0])?, config.camera_size, "camera", notes)?;
    let projector = match roots.get(1) {
        Some(root) => {
            let device = super::devices::device(known(root)?, config.projector_size, "projector", notes)?;
            Some((device, pose(root)?))
        }
        None => None,
    };
    if roots.len() == 1 && of_projector(&roots[0]) {
        notes
            .push("this is a projector's file; it is taken for the camera, as no other one was given".into());
    }
    Ok(plain_rig(camera, projector.as_ref(), ExchangeFormat::Ros))
}

fn of_projector(root: &Node<'_>) -> bool {
    let named = root.get("camera_name").and_then(|n| n.words().first().map(|w| w.contains("projector")));
    root.get(POSE).is_some() || named == Some(true)
}

fn pose(root: &Node<'_>) -> Result<Pose> {
    let missing = || {
        FILE.malformed(format!(
            "expected {POSE} with {ROTATION} and {TRANSLATION} in the projector's file (camera_info itself does not say where the \
             devices stand), found none"
        ))
    };
    let found = root.get(POSE).ok_or_else(missing)?;
    let part = |name: &str, count: usize| {
        let values = numbers(found.get(name).ok_or_else(missing)?, name, FILE)?;
        if values.len() == count {
            return Ok(values);
        }
        Err(FILE.malformed(format!("{POSE}: {name}: expected {count} numbers, found {}", values.len())))
    };
    let (r, t) = (part(ROTATION, 9)?, part(TRANSLATION, 3)?);
    pose_of(&Matrix3::from_row_slice(&r), Vector3::from_row_slice(&t), FILE, POSE)
}
