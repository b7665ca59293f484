//! Blender: a Python script that builds the scene, for `blender --python FILE` or its text editor.
//!
//! Lengths are metres, z is up; the camera stands at the origin and looks along +y: the point (x, y, z) mm of the camera's frame lies at
//! (x, z, −y) / 1000. Cameras of Blender look along −z with y up. They have a lens in millimetres before a sensor of a given width, and
//! principal points as shifts of the image: shift_x = 0.5 − (cx + 0.5)/W, shift_y = (cy + 0.5 − H/2)/W · fx/fy, in units of the width. Unequal
//! focal lengths are pixels that are not square, which belong to a scene: the projector has one of its own. Its light is a spot whose
//! direction picks the pixel of a picture, as the pinhole does, lens shift included.
//!
//! There is no distortion and no skew. Blender calculates in single precision: projections agree to some 1e-4 px. What
//! stands where is given as matrices, which Blender keeps as they are, not as angles. The script
//! holds the whole rig as JSON, from which it is read back; numbers that are changed elsewhere in it do not come back.

use nalgebra::{Matrix3, Matrix4, Point2, Point3, Vector3};
use std::fmt::Write as _;

use super::extras;
use super::files::ExportedFile;
use super::losses::Losses;
use super::text::{joined, number};
use crate::error::{Error, ErrorSubject, Result};
use crate::format::tree::Expecting;
use crate::format::{read_rig, write_rig};
use crate::geometry::{Camera, Distortion, Intrinsics, Pose};
use crate::rig::{Device, Rig};

const FILE: Expecting = Expecting(ErrorSubject::BlenderScript);
const MM_PER_METRE: f64 = 1000.0;
/// Of a full frame; only its ratio to the focal length counts.
const SENSOR_MM: f64 = 36.0;
/// Blender's shortest lens, mm.
const SHORTEST_LENS_MM: f64 = 1.0;
/// Sides of a picture that Blender renders, px.
const SIDES: std::ops::RangeInclusive<u32> = 4..=65_536;
/// The proportions of a pixel that Blender takes.
const WIDEST_PIXEL: f64 = 200.0;
/// Single precision ends at 3e38; lengths stay well below.
const LARGEST: f64 = 1e18;
/// The light's cone is this much wider than the picture, and below half a turn.
const CONE_MARGIN: f64 = 1.02;
const WIDEST_CONE_RAD: f64 = 3.1;
/// How many widths of the sensor are tried, and how far apart they are: all stay within 1 %.
const RATIO_STEPS: u32 = 1000;
const RATIO_STEP: f64 = 1e-5;
/// Between these stands the rig.
const BEFORE_RIG: &str = "RIG = r'''";
const AFTER_RIG: &str = "'''";

const HEAD: &str = r#""""A rig of projector and camera as a scene of Blender.

Run it with
    blender --python FILE
    blender --python FILE -- --picture stripes.png --cloud cloud.ply
or in the text editor. Metres, z up; the camera stands at the origin and looks along +y. The scene
"seen by the projector" has the projector's resolution. Render with Cycles to see its light.
"""

import argparse
import json
import os
import sys

import bpy
from mathutils import Matrix

"#;
const BODY: &str = include_str!("blender_scene.py");

pub(super) fn export(rig: &Rig, losses: &mut Losses) -> Result<Vec<ExportedFile>> {
    let mut script = HEAD.to_owned();
    let camera = device("camera", &rig.camera, &Pose::identity(), losses)?;
    let _ = writeln!(script, "CAMERA = {camera}");
    let projector = match &rig.projector {
        Some(p) => device("projector", &p.device, &p.from_camera.pose.inverse(), losses)?,
        None => "None".to_owned(),
    };
    let _ = writeln!(script, "PROJECTOR = {projector}");
    let to_world = world_from_camera().to_homogeneous() / MM_PER_METRE;
    let _ = writeln!(script, "WORLD_FROM_CAMERA_MM = {}", matrix(&to_world, 1.0));
    script.push_str("# The corners TL, TR, BR, BL of each sheet.\nSHEETS = [\n");
    for view in &rig.views {
        let corners = view.size.corners().map(|c| {
            let p = view.camera_from_sheet.transform(&Point3::new(c.x, c.y, 0.0));
            let p = world_from_camera() * p / MM_PER_METRE;
            format!("({})", joined(p.iter().map(|v| v + 0.0), ", "))
        });
        let _ = writeln!(script, "    [{}],", corners.join(", "));
    }
    script.push_str("]\n# The whole rig, which slcal imports again; changes above do not come back.\n");
    let mut json = Vec::new();
    write_rig(rig, &mut json)?;
    let json = String::from_utf8_lossy(&json);
    let _ = writeln!(script, "{BEFORE_RIG}\n{}{AFTER_RIG}", plain(&json));
    script.push_str(BODY);
    Ok(vec![ExportedFile { name: "rig.py", bytes: script.into_bytes() }])
}

/// JSON that can stand in a raw string of Python and in a file of any encoding.
fn plain(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        // Outside of JSON's own strings there are neither apostrophes nor letters beyond ASCII.
        if c.is_ascii() && c != '\'' && c != '\u{7f}' {
            text.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                let _ = write!(text, "\\u{unit:04x}");
            }
        }
    }
    text
}

fn world_from_camera() -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0)
}

/// Rows of a matrix as Python has them, the last column divided by `unit`.
fn matrix(m: &Matrix4<f64>, unit: f64) -> String {
    let row = |i: usize| {
        let last = if i < 3 { m[(i, 3)] / unit } else { 1.0 };
        format!("[{}]", joined([m[(i, 0)], m[(i, 1)], m[(i, 2)], last].map(|v| v + 0.0), ", "))
    };
    format!("[{}]", [0, 1, 2, 3].map(row).join(", "))
}

/// Two numbers of single precision, the second not much above `least`, whose ratio is `ratio` to more digits than one number has: rounded
/// by itself, a lens would move the edges of a large picture by some 1e-4 px.
fn ratio_in_single(ratio: f64, least: f64) -> (f64, f64) {
    let single = |x: f64| f64::from(x as f32);
    let candidates = (0..RATIO_STEPS).map(|i| {
        let below = single(least * (1.0 + f64::from(i) * RATIO_STEP));
        (single(ratio * below), below)
    });
    let off = |(above, below): &(f64, f64)| (above / below / ratio - 1.0).abs();
    candidates.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or((ratio * least, least))
}

/// A device as a dict of Python.
fn device(name: &str, device: &Device, camera_from_device: &Pose, losses: &mut Losses) -> Result<String> {
    let model = &device.model;
    let intrinsics = Intrinsics { skew: 0.0, ..model.intrinsics };
    losses.lens(name, device, &Camera { intrinsics, distortion: Distortion::NONE, ..*model })?;
    let Intrinsics { fx, fy, cx, cy, .. } = intrinsics;
    let (w, h) = (f64::from(model.width), f64::from(model.height));
    let shortest_mm = SENSOR_MM * (SHORTEST_LENS_MM * w / (fx * SENSOR_MM)).max(1.0);
    let (lens_mm, sensor_mm) = ratio_in_single(fx / w, shortest_mm);
    let ratio = fx / fy;
    let (aspect_x, aspect_y) = if ratio < 1.0 {
        ratio_in_single(1.0 / ratio, 1.0)
    } else {
        let (y, x) = ratio_in_single(ratio, 1.0);
        (x, y)
    };
    let shift = [0.5 - (cx + 0.5) / w, (cy + 0.5 - h / 2.0) * ratio / w];
    let far = camera_from_device.translation.amax();
    let fits =
        [sensor_mm, fx * sensor_mm / w, shift[0].abs(), shift[1].abs(), far].iter().all(|v| *v < LARGEST)
            && aspect_x.max(aspect_y) <= WIDEST_PIXEL
            && SIDES.contains(&model.width)
            && SIDES.contains(&model.height);
    if !fits {
        return Err(Error::invalid(
            if name == "camera" { ErrorSubject::Camera } else { ErrorSubject::Projector },
            "4 to 65536 px per side, fx/fy between 1/200 and 200 and moderate lengths, as Blender needs",
            format!("{}x{} px, fx {fx}, fy {fy}, cx {cx}, cy {cy}, {far} mm away", model.width, model.height),
        ));
    }
    let flip = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
    let turn = world_from_camera() * camera_from_device.rotation.matrix() * flip;
    let mut place = turn.to_homogeneous();
    place.fixed_view_mut::<3, 1>(0, 3).copy_from(&(world_from_camera() * camera_from_device.translation));
    let fields = [
        ("name", format!("\"{name}\"")),
        ("width", model.width.to_string()),
        ("height", model.height.to_string()),
        ("sensor_width", number(sensor_mm)),
        ("lens", number(lens_mm)),
        ("shift_x", number(shift[0] + 0.0)),
        ("shift_y", number(shift[1] + 0.0)),
        ("pixel_aspect_x", number(aspect_x)),
        ("pixel_aspect_y", number(aspect_y)),
        ("matrix_world", matrix(&place, MM_PER_METRE)),
        ("focal_uv", format!("({})", joined([fx / w, fy / h], ", "))),
        ("principal_uv", format!("({})", joined([(cx + 0.5) / w, 1.0 - (cy + 0.5) / h], ", "))),
        ("spot_size", number(cone_rad(model))),
    ];
    let lines: Vec<String> = fields.iter().map(|(key, value)| format!("    \"{key}\": {value},\n")).collect();
    Ok(format!("{{\n{}}}", lines.concat()))
}

/// The full angle of the cone about the optical axis that holds the whole picture.
fn cone_rad(model: &Camera) -> f64 {
    let (w, h) = (f64::from(model.width) - 0.5, f64::from(model.height) - 0.5);
    let corners = [[-0.5, -0.5], [w, -0.5], [w, h], [-0.5, h]];
    let farthest =
        corners.iter().map(|c| model.intrinsics.normalized(Point2::from(*c)).norm()).fold(0.0, f64::max);
    (2.0 * farthest.atan() * CONE_MARGIN).min(WIDEST_CONE_RAD)
}

pub(super) fn import(bytes: &[u8]) -> Result<Rig> {
    let text = FILE.text(bytes)?;
    let rest = text.split_once(BEFORE_RIG).map(|(_, rest)| rest);
    let json = rest.and_then(|rest| rest.split_once(AFTER_RIG)).map(|(json, _)| json.trim());
    let Some(json) = json else {
        return Err(FILE.malformed(
            "expected a script that slcal wrote for Blender, with the rig in it, found none; scenes of one's own cannot be read",
        ));
    };
    read_rig(json.as_bytes()).map_err(|e| extras::renamed(e, FILE))
}
