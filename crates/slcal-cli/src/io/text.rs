//! Rigs, patterns, matches and clouds from files.

use std::path::Path;

use image::DynamicImage;
use slcal_core::format::{
    KnownCamera, read_camera, read_obj, read_observations, read_pattern, read_ply, read_rig,
};
use slcal_core::pattern::{CheckerPattern, Pattern, StripePattern};
use slcal_core::simulate::TriangleMesh;
use slcal_core::{Observations, Projector, Rig};

use super::read::{read_at_most, read_bytes};
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::name::input_name;

/// Reads a rig JSON.
pub(crate) fn load_rig(path: &Path) -> Outcome<Rig> {
    read_rig(read_bytes(path, "a rig JSON")?.as_slice()).in_file(path)
}

/// Limit of camera files: they have a few kilobytes, rigs of hundreds of views a few megabytes.
const MAX_CAMERA_MIB: u64 = 64;

/// Reads the intrinsics of a camera from a file of any known format.
pub(crate) fn load_camera(path: &Path) -> Outcome<KnownCamera> {
    read_camera(read_at_most(path, "a camera file (OpenCV, ROS or rig JSON)", MAX_CAMERA_MIB)?.as_slice())
        .in_file(path)
}

/// The bytes of a file of another program with a rig or a part of one.
pub(crate) fn read_exchange(path: &Path) -> Outcome<Vec<u8>> {
    read_at_most(path, "a file of another program with a camera or a rig", MAX_CAMERA_MIB)
}

/// Limit of observations: a million points take half of it.
const MAX_OBSERVATIONS_MIB: u64 = 128;

/// Reads an observations JSON.
pub(crate) fn load_observations(path: &Path) -> Outcome<Observations> {
    read_observations(read_at_most(path, "an observations JSON", MAX_OBSERVATIONS_MIB)?.as_slice())
        .in_file(path)
}

/// Reads a pattern JSON that must be of a checkerboard.
pub(crate) fn load_checker(path: &Path) -> Outcome<CheckerPattern> {
    match load_pattern(path)? {
        Pattern::Checker(pattern) => Ok(pattern),
        Pattern::Stripes(_) => Err(wrong_kind(path, "checker", "stripes")),
    }
}

/// Reads a pattern JSON that must be of stripes.
pub(crate) fn load_stripes(path: &Path) -> Outcome<StripePattern> {
    match load_pattern(path)? {
        Pattern::Stripes(pattern) => Ok(pattern),
        Pattern::Checker(_) => Err(wrong_kind(path, "stripes", "checker")),
    }
}

/// Reads a pattern JSON of either kind.
pub(crate) fn load_pattern(path: &Path) -> Outcome<Pattern> {
    let pattern = read_pattern(read_bytes(path, "a pattern JSON")?.as_slice()).in_file(path);
    // The picture was given instead of its description.
    let description = path.with_extension("json");
    let meant = if description != path && description.is_file() {
        format!("; did you mean {}?", description.display())
    } else {
        String::new()
    };
    pattern.map_err(|failure| failure.and(&meant))
}

fn wrong_kind(path: &Path, expected: &str, found: &str) -> Failure {
    Failure::new(
        Exit::Input,
        format!(
            "{}: expected a pattern of the kind \"{expected}\", found \"{found}\"; give the JSON that \
             `slcal pattern {expected}` wrote beside the picture",
            input_name(path)
        ),
    )
}

/// Reads a mesh, PLY or OBJ by its name, and multiplies its coordinates by `scale`.
pub(crate) fn load_mesh(path: &Path, scale: f64) -> Outcome<TriangleMesh> {
    let is_obj = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let bytes = read_bytes(path, "a mesh as PLY or OBJ")?;
    let cloud = if is_obj { read_obj(bytes.as_slice()) } else { read_ply(bytes.as_slice()) }.in_file(path)?;
    let vertices = cloud.points.iter().map(|p| p.position * scale).collect();
    TriangleMesh::new(vertices, cloud.triangles).in_file(path)
}

/// The rig's projector; a rig without one is refused.
pub(crate) fn check_projector<'a>(path: &Path, rig: &'a Rig) -> Outcome<&'a Projector> {
    rig.projector.as_ref().ok_or_else(|| {
        Failure::new(
            Exit::Input,
            format!(
                "{}: expected a rig with a projector, found the camera alone; calibrate with --pattern",
                input_name(path)
            ),
        )
    })
}

/// Refuses a pattern that was drawn for another projector than the rig's.
pub(crate) fn check_panel(path: &Path, pattern: [u32; 2], rig_path: &Path, rig: &Rig) -> Outcome {
    let model = &check_projector(rig_path, rig)?.device.model;
    let [w, h] = [model.width, model.height];
    if pattern == [w, h] {
        return Ok(());
    }
    Err(Failure::new(
        Exit::Input,
        format!(
            "{}: expected a pattern for the {w}x{h} projector of {}, found one for {}x{}; draw it with --projector {w}x{h}",
            input_name(path),
            input_name(rig_path),
            pattern[0],
            pattern[1]
        ),
    ))
}

/// Refuses a photograph of another size than the images of the rig's camera.
pub(crate) fn check_image_size(path: &Path, photo: &DynamicImage, rig_path: &Path, rig: &Rig) -> Outcome {
    let (camera, found) = (rig.camera.model, [photo.width(), photo.height()]);
    if [camera.width, camera.height] == found {
        return Ok(());
    }
    Err(Failure::new(
        Exit::Input,
        format!(
            "{}: expected a photograph of {}x{} pixels, by the camera of {}, found {}x{}; a rig is valid for one camera at one \
             resolution, uncropped",
            input_name(path),
            camera.width,
            camera.height,
            input_name(rig_path),
            found[0],
            found[1]
        ),
    ))
}
