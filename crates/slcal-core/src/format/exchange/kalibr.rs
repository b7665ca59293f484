//! Kalibr's camchain: YAML with `cam0`, the camera, and `cam1`, the projector.
//!
//! Integers are pixel centres, x right, y down, z forward, lengths **metres**. `T_cn_cnm1` takes points of cam0 to cam1. A pinhole has
//! fx, fy, cx, cy and no skew; `radtan` has k1, k2, p1, p2 in the order and meaning of `OpenCV`, and no k3.

use std::fmt::Write as _;

use nalgebra::{Matrix3, Vector3};

use super::devices::{plain_rig, pose_of};
use super::files::{ExchangeFormat, ExportedFile};
use super::guess::Source;
use super::losses::{Holds, Losses};
use super::text::joined;
use crate::error::{ErrorSubject, Result};
use crate::format::budget::Budget;
use crate::format::camera::{distortion, numbers};
use crate::format::tree::{Expecting, Node};
use crate::geometry::{Camera, Distortion, Intrinsics, Pose};
use crate::rig::{Device, Rig};

const FILE: Expecting = Expecting(ErrorSubject::KalibrFile);
const MM_PER_METRE: f64 = 1000.0;

pub(super) fn export(rig: &Rig, losses: &mut Losses) -> Result<Vec<ExportedFile>> {
    let mut text = "# Metres, pixel centres at integers; cam0 is the camera".to_owned();
    text.push_str(if rig.projector.is_some() { ", cam1 the projector.\n" } else { ".\n" });
    chained(&mut text, 0, "camera", &rig.camera, losses)?;
    if let Some(projector) = &rig.projector {
        chained(&mut text, 1, "projector", &projector.device, losses)?;
        text.push_str("  T_cn_cnm1:\n");
        let Pose { rotation: r, translation: t } = &projector.from_camera.pose;
        for i in 0..3 {
            let row = [r[(i, 0)], r[(i, 1)], r[(i, 2)], t[i] / MM_PER_METRE];
            let _ = writeln!(text, "  - [{}]", joined(row, ", "));
        }
        text.push_str("  - [0.0, 0.0, 0.0, 1.0]\n");
    }
    losses.around(rig, Holds::default());
    Ok(vec![ExportedFile { name: "camchain.yaml", bytes: text.into_bytes() }])
}

fn chained(text: &mut String, i: usize, name: &str, device: &Device, losses: &mut Losses) -> Result<()> {
    let model = &device.model;
    let intrinsics = Intrinsics { skew: 0.0, ..model.intrinsics };
    let held = Camera { intrinsics, distortion: Distortion { k3: 0.0, ..model.distortion }, ..*model };
    losses.lens(name, device, &held)?;
    let [k1, k2, p1, p2, _] = model.distortion.to_array();
    let Intrinsics { fx, fy, cx, cy, .. } = intrinsics;
    let _ = write!(
        text,
        "cam{i}:\n  camera_model: pinhole\n  intrinsics: [{}]\n  distortion_model: radtan\n  distortion_coeffs: [{}]\n  \
         resolution: [{}, {}]\n  rostopic: /{name}/image_raw\n",
        joined([fx, fy, cx, cy], ", "),
        joined([k1, k2, p1, p2], ", "),
        model.width,
        model.height
    );
    Ok(())
}

pub(super) fn import(source: Source<'_>, notes: &mut Vec<String>, budget: &Budget) -> Result<Rig> {
    let root = source.tree(FILE, budget)?;
    let Some(first) = root.get("cam0") else {
        return Err(FILE.malformed("expected cam0, found none"));
    };
    if root.get("cam2").is_some() {
        notes.push(
            "of the chain cam0 is taken for the camera and cam1 for the projector; the others are left out"
                .into(),
        );
    }
    let camera = device(first, "cam0")?;
    let projector = root.get("cam1").map(|node| Ok((device(node, "cam1")?, pose(node)?))).transpose()?;
    Ok(plain_rig(camera, projector.as_ref(), ExchangeFormat::Kalibr))
}

/// Numbers of one camera of the chain.
fn values(cam: &Node<'_>, place: &str, name: &str, count: usize) -> Result<Vec<f64>> {
    let Some(node) = cam.get(name) else {
        return Err(FILE.malformed(format!("{place}: expected {name}, found none")));
    };
    let values = numbers(node, name, FILE)?;
    if values.len() != count {
        let found = values.len();
        return Err(FILE.malformed(format!("{place}: {name}: expected {count} numbers, found {found}")));
    }
    Ok(values)
}

fn device(cam: &Node<'_>, place: &str) -> Result<Device> {
    let word = |name: &str| cam.get(name).and_then(|n| n.words().first().copied()).unwrap_or_default();
    if word("camera_model") != "pinhole" {
        let found: String = word("camera_model").chars().take(40).collect();
        return Err(FILE.malformed(format!("{place}: expected camera_model pinhole, found {found:?}")));
    }
    let k = values(cam, place, "intrinsics", 4)?;
    let matrix = Matrix3::new(k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0);
    let intrinsics = Intrinsics::from_matrix(&matrix).map_err(|e| FILE.malformed(format!("{place}: {e}")))?;
    let lens = match (word("distortion_model"), cam.get("distortion_coeffs")) {
        ("none", _) | (_, None) => Distortion::NONE,
        (model, Some(node)) => {
            let coefficients = numbers(node, "distortion_coeffs", FILE)?;
            if model != "radtan" && coefficients.iter().any(|c| *c != 0.0) {
                let model: String = model.chars().take(40).collect();
                return Err(FILE.malformed(format!(
                    "{place}: expected distortion_model radtan, found {model:?}, whose coefficients mean something else; \
                     calibrate that camera again with pinhole-radtan"
                )));
            }
            if model == "radtan" {
                distortion(&coefficients, "distortion_coeffs", FILE)?
            } else {
                Distortion::NONE
            }
        }
    };
    let size = values(cam, place, "resolution", 2)?;
    if !size.iter().all(|s| (1.0..=1e6).contains(s) && s.fract() == 0.0) {
        return Err(
            FILE.malformed(format!("{place}: resolution: expected whole numbers of pixels, found {size:?}"))
        );
    }
    let (width, height) = (size[0] as u32, size[1] as u32);
    Ok(Device { model: Camera { width, height, intrinsics, distortion: lens }, sigma: None })
}

fn pose(cam: &Node<'_>) -> Result<Pose> {
    let m = values(cam, "cam1", "T_cn_cnm1", 16)?;
    let rotation = Matrix3::from_fn(|i, j| m[4 * i + j]);
    let translation = Vector3::from_fn(|i, _| m[4 * i + 3] * MM_PER_METRE);
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(FILE.malformed("cam1: T_cn_cnm1: expected 0, 0, 0, 1 as the last row"));
    }
    pose_of(&rotation, translation, FILE, "cam1: T_cn_cnm1")
}
