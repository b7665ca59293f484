//! Rigs, patterns, matches and clouds from files.

use std::path::Path;

use image::DynamicImage;
use slcal_core::format::{
    KnownCamera, read_camera, read_obj, read_observations, read_pattern, read_ply, read_rig,
};
use slcal_core::pattern::{CheckerPattern, Pattern, StripePattern};
use slcal_core::simulate::TriangleMesh;
use slcal_core::{Observations, PointCloud, Projector, Rig};

use super::input_kind::InputKind;
use super::read::{open_stream, read_bytes};
use crate::exit::{Failure, InFile as _, Outcome};
use crate::name::input_name;

/// Reads a rig JSON.
pub(crate) fn load_rig(path: &Path) -> Outcome<Rig> {
    read_rig(read_bytes(path, InputKind::Rig)?.as_slice()).in_file(path)
}

/// Reads the intrinsics of a camera from a file of any known format.
pub(crate) fn load_camera(path: &Path) -> Outcome<KnownCamera> {
    read_camera(read_bytes(path, InputKind::Camera)?.as_slice()).in_file(path)
}

/// The bytes of a file of another program with a rig or a part of one.
pub(crate) fn read_exchange(path: &Path) -> Outcome<Vec<u8>> {
    read_bytes(path, InputKind::Exchange)
}

/// Reads an observations JSON.
pub(crate) fn load_observations(path: &Path) -> Outcome<Observations> {
    read_observations(read_bytes(path, InputKind::Observations)?.as_slice()).in_file(path)
}

/// Reads a pattern JSON that must be of a checkerboard.
pub(crate) fn load_checker(path: &Path) -> Outcome<CheckerPattern> {
    match load_pattern(path)? {
        Pattern::Checker(pattern) => Ok(pattern),
        other => Err(wrong_kind(path, "checker", other.kind())),
    }
}

/// Reads a pattern JSON that must be of stripes.
pub(crate) fn load_stripes(path: &Path) -> Outcome<StripePattern> {
    match load_pattern(path)? {
        Pattern::Stripes(pattern) => Ok(pattern),
        other => Err(wrong_kind(path, "stripes", other.kind())),
    }
}

/// Reads a pattern JSON of either kind.
pub(crate) fn load_pattern(path: &Path) -> Outcome<Pattern> {
    let pattern = read_pattern(read_bytes(path, InputKind::Pattern)?.as_slice()).in_file(path);
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
    let message = format!(
        "expected a pattern of the kind \"{expected}\", found \"{found}\"; give the JSON that `slcal pattern {expected}` wrote \
         beside the picture"
    );
    Failure::input(path, message)
}

/// Reads a point cloud.
pub(crate) fn load_cloud(path: &Path) -> Outcome<PointCloud> {
    read_ply(open_stream(path, InputKind::Cloud)?).in_file(path)
}

/// Reads a mesh, PLY or OBJ by its name, and multiplies its coordinates by `scale`.
pub(crate) fn load_mesh(path: &Path, scale: f64) -> Outcome<TriangleMesh> {
    let is_obj = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let stream = open_stream(path, InputKind::Mesh)?;
    let cloud = if is_obj { read_obj(stream) } else { read_ply(stream) }.in_file(path)?;
    let vertices = cloud.points.iter().map(|p| p.position * scale).collect();
    TriangleMesh::new(vertices, cloud.triangles).in_file(path)
}

/// The rig's projector; a rig without one is refused.
pub(crate) fn check_projector<'a>(path: &Path, rig: &'a Rig) -> Outcome<&'a Projector> {
    rig.projector.as_ref().ok_or_else(|| {
        let message = "expected a rig with a projector, found the camera alone; calibrate with --pattern";
        Failure::input(path, message)
    })
}

/// Refuses a pattern that was drawn for another projector than the rig's.
pub(crate) fn check_panel(path: &Path, pattern: [u32; 2], rig_path: &Path, rig: &Rig) -> Outcome {
    let [w, h] = check_projector(rig_path, rig)?.device.model.size();
    let [found_w, found_h] = pattern;
    if pattern == [w, h] {
        return Ok(());
    }
    let rig = input_name(rig_path);
    Err(Failure::input(
        path,
        format!(
            "expected a pattern for the {w}x{h} projector of {rig}, found one for {found_w}x{found_h}; draw it with --projector {w}x{h}"
        ),
    ))
}

/// Refuses a photograph of another size than the images of the rig's camera.
pub(crate) fn check_image_size(path: &Path, photo: &DynamicImage, rig_path: &Path, rig: &Rig) -> Outcome {
    let ([w, h], [found_w, found_h]) = (rig.camera.model.size(), [photo.width(), photo.height()]);
    if [w, h] == [found_w, found_h] {
        return Ok(());
    }
    let rig = input_name(rig_path);
    Err(Failure::input(
        path,
        format!(
            "expected a photograph of {w}x{h} pixels, by the camera of {rig}, found {found_w}x{found_h}; a rig is valid for one \
             camera at one resolution, uncropped"
        ),
    ))
}
