//! COLMAP's sparse model as text: `cameras.txt`, `images.txt` and `points3D.txt`.
//!
//! The upper left corner of the image is (0, 0) and the centre of its first pixel (0.5, 0.5): principal points and observed pixels are
//! half a pixel larger than here. x right, y down, z forward. COLMAP gives lengths no unit; here they are millimetres, and the
//! world is the camera's frame. Camera 1 and image 1 are the camera, camera 2 and image 2 the projector. The sheet's corners are points,
//! four per view, seen by the camera.
//!
//! No camera model of COLMAP has skew. A lens is PINHOLE, OPENCV, or with k3 FULL_OPENCV, whose first six terms are k1, k2, p1,
//! p2, k3 and zero.

use std::fmt::Write as _;

use nalgebra::{Matrix3, Point2, Point3, Quaternion, UnitQuaternion, Vector3};

use super::devices::plain_rig;
use super::files::{ExchangeFormat, ExportedFile, NamedBytes};
use super::losses::{Holds, Losses};
use super::text::{joined, number};
use crate::error::{ErrorSubject, Result};
use crate::format::tree::Expecting;
use crate::geometry::{Camera, Distortion, Intrinsics, Pose, RectangleSize};
use crate::rig::{Device, Rig, View};

const FILE: Expecting = Expecting(ErrorSubject::ColmapModel);
/// From pixel centres at integers to pixel centres at .5.
const HALF_PIXEL: f64 = 0.5;
/// Stands in points3D.txt when its points are the corners of sheets.
const SHEETS: &str = "# The sheet's corners TL TR BR BL, four points per view.";

pub(super) fn export(rig: &Rig, losses: &mut Losses) -> Result<Vec<ExportedFile>> {
    let mut cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n".to_owned();
    camera_line(&mut cameras, 1, "camera", &rig.camera, losses)?;
    let mut images = "# The world is the camera's frame, mm; the centre of the first pixel is (0.5, 0.5).\n# IMAGE_ID, QW, QX, QY, QZ, \
                      TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n"
        .to_owned();
    image_line(&mut images, 1, "camera.png", &Pose::identity());
    let corners = rig.views.iter().flat_map(|v| v.corners_px);
    let seen = corners
        .enumerate()
        .map(|(i, p)| format!("{} {} {}", number(p.x + HALF_PIXEL), number(p.y + HALF_PIXEL), i + 1));
    let _ = writeln!(images, "{}", seen.collect::<Vec<_>>().join(" "));
    if let Some(projector) = &rig.projector {
        camera_line(&mut cameras, 2, "projector", &projector.device, losses)?;
        image_line(&mut images, 2, "projector.png", &projector.from_camera.pose);
        images.push('\n');
    }
    losses.around(rig, Holds { poses: true });
    let file = |name, text: String| ExportedFile { name, bytes: text.into_bytes() };
    Ok(vec![file("cameras.txt", cameras), file("images.txt", images), file("points3D.txt", points(rig))])
}

fn camera_line(text: &mut String, id: u32, name: &str, device: &Device, losses: &mut Losses) -> Result<()> {
    let model = &device.model;
    let intrinsics = Intrinsics { skew: 0.0, ..model.intrinsics };
    losses.lens(name, device, &Camera { intrinsics, ..*model })?;
    let Intrinsics { fx, fy, cx, cy, .. } = intrinsics;
    let [k1, k2, p1, p2, k3] = model.distortion.to_array();
    let (kind, lens) = match model.distortion {
        d if d.is_none() => ("PINHOLE", vec![]),
        d if d.k3 == 0.0 => ("OPENCV", vec![k1, k2, p1, p2]),
        _ => ("FULL_OPENCV", vec![k1, k2, p1, p2, k3, 0.0, 0.0, 0.0]),
    };
    let parameters = [fx, fy, cx + HALF_PIXEL, cy + HALF_PIXEL].into_iter().chain(lens);
    let _ = writeln!(text, "{id} {kind} {} {} {}", model.width, model.height, joined(parameters, " "));
    Ok(())
}

fn image_line(text: &mut String, id: u32, name: &str, pose: &Pose) {
    let q = UnitQuaternion::from_rotation_matrix(&pose.rotation);
    let t = pose.translation;
    let _ = writeln!(text, "{id} {} {id} {name}", joined([q.w, q.i, q.j, q.k, t.x, t.y, t.z], " "));
}

/// The corners of all sheets in the camera's frame, with how far off the camera saw them.
fn points(rig: &Rig) -> String {
    let mut text =
        format!("# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n{SHEETS}\n");
    let mut id = 0;
    for view in &rig.views {
        for (corner, seen) in view.size.corners().iter().zip(&view.corners_px) {
            let p = view.camera_from_sheet.transform(&Point3::new(corner.x, corner.y, 0.0));
            let off = rig.camera.model.project(&p).map_or(-1.0, |q| (q - seen).norm());
            let _ = writeln!(
                text,
                "{} {} 255 255 255 {} 1 {id}",
                id + 1,
                joined([p.x, p.y, p.z], " "),
                number(off)
            );
            id += 1;
        }
    }
    text
}

pub(super) fn import(files: &[NamedBytes<'_>], notes: &mut Vec<String>) -> Result<Rig> {
    let text = |name: &str| -> Result<Option<&str>> {
        let found = files.iter().find(|f| f.name.eq_ignore_ascii_case(name));
        found.map(|f| FILE.text(f.bytes)).transpose()
    };
    let missing = |name: &str| {
        FILE.malformed(format!(
            "expected cameras.txt and images.txt, found no {name}; convert a binary model with \
                                `colmap model_converter --output_type TXT`"
        ))
    };
    let cameras = read_cameras(text("cameras.txt")?.ok_or_else(|| missing("cameras.txt"))?)?;
    let images = read_images(text("images.txt")?.ok_or_else(|| missing("images.txt"))?)?;
    let (camera, projector) = match &cameras[..] {
        [one] => (one, None),
        [a, b] => {
            let projects =
                |c: &Numbered| images.iter().any(|i| i.camera == c.id && i.name.contains("projector"));
            if projects(a) && !projects(b) { (b, Some(a)) } else { (a, Some(b)) }
        }
        _ => return Err(FILE.malformed(format!("expected one camera or two, found {}", cameras.len()))),
    };
    let image_of = |c: &Numbered| match &images.iter().filter(|i| i.camera == c.id).collect::<Vec<_>>()[..] {
        [one] => Ok(*one),
        found => Err(FILE.malformed(format!(
            "expected one image of camera {} to say where it stands, found {}",
            c.id,
            found.len()
        ))),
    };
    let device = |c: &Numbered| Device { model: c.model, sigma: None };
    let Some(projector) = projector else {
        let mut rig = plain_rig(device(camera), None, ExchangeFormat::Colmap);
        if let (Ok(image), Some(points)) = (image_of(camera), text("points3D.txt")?) {
            rig.views = views(points, image, &rig)?;
        }
        return Ok(rig);
    };
    let first = image_of(camera)?;
    let pose = image_of(projector)?.pose.compose(&first.pose.inverse());
    if !projector_named(&images) {
        notes.push(
            "the camera with the lower number is taken for the camera, the other one for the projector"
                .into(),
        );
    }
    notes.push("lengths are taken to be in mm: models of COLMAP have no unit".into());
    let mut rig = plain_rig(device(camera), Some(&(device(projector), pose)), ExchangeFormat::Colmap);
    if let Some(points) = text("points3D.txt")? {
        rig.views = views(points, first, &rig)?;
    }
    Ok(rig)
}

fn projector_named(images: &[Image]) -> bool {
    images.iter().any(|i| i.name.contains("projector"))
}

struct Numbered {
    id: u32,
    model: Camera,
}

struct Image {
    camera: u32,
    name: String,
    pose: Pose,
    points: Vec<Point2<f64>>,
}

/// Lines that are no comments.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|l| !l.trim_start().starts_with('#'))
}

fn parsed<T: std::str::FromStr>(word: Option<&str>, place: &str) -> Result<T> {
    word.and_then(|w| w.parse().ok()).ok_or_else(|| {
        let found: String = word.unwrap_or("nothing").chars().take(40).collect();
        FILE.malformed(format!("{place}: expected a number, found {found}"))
    })
}

fn finite<'a>(words: impl Iterator<Item = &'a str>, place: &str) -> Result<Vec<f64>> {
    let values = words.map(|w| parsed::<f64>(Some(w), place)).collect::<Result<Vec<_>>>()?;
    match values.iter().find(|x| !x.is_finite()) {
        Some(x) => Err(FILE.malformed(format!("{place}: expected finite numbers, found {x}"))),
        None => Ok(values),
    }
}

fn read_cameras(text: &str) -> Result<Vec<Numbered>> {
    let mut cameras = Vec::new();
    for line in lines(text).filter(|l| !l.trim().is_empty()) {
        let place = "cameras.txt";
        let mut words = line.split_whitespace();
        let id = parsed(words.next(), place)?;
        let kind = words.next().unwrap_or_default();
        let (width, height): (u32, u32) = (parsed(words.next(), place)?, parsed(words.next(), place)?);
        if width == 0 || height == 0 {
            return Err(FILE.malformed(format!("{place}: expected sizes above zero, found {width}x{height}")));
        }
        let (intrinsics, distortion) = lens(kind, &finite(words, place)?)?;
        cameras.push(Numbered { id, model: Camera { width, height, intrinsics, distortion } });
    }
    cameras.sort_by_key(|c| c.id);
    Ok(cameras)
}

/// The models of COLMAP that this library's lens includes.
fn lens(kind: &str, p: &[f64]) -> Result<(Intrinsics, Distortion)> {
    let with = |fx: f64, fy: f64, cx: f64, cy: f64, d: [f64; 5]| {
        let k = Matrix3::new(fx, 0.0, cx - HALF_PIXEL, 0.0, fy, cy - HALF_PIXEL, 0.0, 0.0, 1.0);
        let intrinsics =
            Intrinsics::from_matrix(&k).map_err(|e| FILE.malformed(format!("cameras.txt: {e}")))?;
        Ok((intrinsics, Distortion::from_array(d)))
    };
    match (kind, p) {
        ("SIMPLE_PINHOLE", &[f, cx, cy]) => with(f, f, cx, cy, [0.0; 5]),
        ("PINHOLE", &[fx, fy, cx, cy]) => with(fx, fy, cx, cy, [0.0; 5]),
        ("SIMPLE_RADIAL", &[f, cx, cy, k1]) => with(f, f, cx, cy, [k1, 0.0, 0.0, 0.0, 0.0]),
        ("RADIAL", &[f, cx, cy, k1, k2]) => with(f, f, cx, cy, [k1, k2, 0.0, 0.0, 0.0]),
        ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => with(fx, fy, cx, cy, [k1, k2, p1, p2, 0.0]),
        ("FULL_OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, 0.0, 0.0, 0.0]) => {
            with(fx, fy, cx, cy, [k1, k2, p1, p2, k3])
        }
        ("FULL_OPENCV", p) if p.len() == 12 => Err(FILE.malformed(
            "cameras.txt: expected FULL_OPENCV with zeros for k4, k5 and k6, found a rational lens model; calibrate that camera again",
        )),
        _ => {
            let kind: String = kind.chars().take(40).collect();
            Err(FILE.malformed(format!(
                "cameras.txt: expected SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV or FULL_OPENCV with all its \
                 parameters, found {kind} with {}",
                p.len()
            )))
        }
    }
}

fn read_images(text: &str) -> Result<Vec<Image>> {
    let mut images = Vec::new();
    let mut lines = lines(text);
    while let Some(line) = lines.next() {
        if line.trim().is_empty() {
            continue;
        }
        let place = "images.txt";
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.len() < 10 {
            return Err(
                FILE.malformed(format!("{place}: expected ten values per image, found {}", words.len()))
            );
        }
        let v = finite(words[1..8].iter().copied(), place)?;
        let q = UnitQuaternion::try_new(Quaternion::new(v[0], v[1], v[2], v[3]), 1e-6)
            .ok_or_else(|| FILE.malformed(format!("{place}: expected a quaternion, found zeros")))?;
        let seen = lines.next().unwrap_or_default();
        let seen = finite(seen.split_whitespace(), place)?;
        images.push(Image {
            camera: parsed(Some(words[8]), place)?,
            name: words[9..].join(" "),
            pose: Pose { rotation: q.to_rotation_matrix(), translation: Vector3::new(v[4], v[5], v[6]) },
            points: seen.chunks_exact(3).map(|c| Point2::new(c[0] - HALF_PIXEL, c[1] - HALF_PIXEL)).collect(),
        });
    }
    Ok(images)
}

/// The sheets whose corners the points are, when a comment says that they are.
fn views(text: &str, image: &Image, rig: &Rig) -> Result<Vec<View>> {
    if !text.lines().any(|l| l.trim_end() == SHEETS) {
        return Ok(Vec::new());
    }
    let points = lines(text)
        .filter(|l| !l.trim().is_empty())
        .map(|l| finite(l.split_whitespace().skip(1).take(3), "points3D.txt"))
        .map(|p| p.map(|p| image.pose.transform(&Point3::from_slice(&padded(&p)))))
        .collect::<Result<Vec<_>>>()?;
    if points.len() % 4 != 0 || points.len() != image.points.len() {
        return Err(FILE.malformed(format!(
            "points3D.txt: expected four corners per view, each seen by the camera, found {} points of which {} are seen",
            points.len(),
            image.points.len()
        )));
    }
    points.chunks_exact(4).zip(image.points.chunks_exact(4)).map(|(c, seen)| view(c, seen, rig)).collect()
}

/// Three numbers, NaN where a line has fewer.
fn padded(p: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| p.get(i).copied().unwrap_or(f64::NAN))
}

fn view(corners: &[Point3<f64>], seen: &[Point2<f64>], rig: &Rig) -> Result<View> {
    let wrong = |e: &dyn std::fmt::Display| FILE.malformed(format!("points3D.txt: a sheet: {e}"));
    let (width, height) = (corners[1] - corners[0], corners[3] - corners[0]);
    let size = RectangleSize::new(width.norm(), height.norm()).map_err(|e| wrong(&e))?;
    let (x, y) = (width / size.width_mm, height / size.height_mm);
    let rotation = Matrix3::from_columns(&[x, y, x.cross(&y)]);
    let pose = Pose::from_matrix(&rotation, corners[0].coords).map_err(|e| wrong(&e))?;
    let projector_from_sheet = rig.projector.map(|p| p.from_camera.pose.compose(&pose));
    Ok(View {
        photo: None,
        size,
        camera_from_sheet: pose,
        bend: None,
        projector_from_sheet,
        camera_vanishing_points: rig.camera.model.vanishing_points(&pose),
        projector_vanishing_points: rig
            .projector
            .zip(projector_from_sheet)
            .map(|(p, pose)| p.device.model.vanishing_points(&pose)),
        corners_px: [seen[0], seen[1], seen[2], seen[3]],
        rms_px: None,
        clipped_percent: None,
    })
}
