//! From named values to a camera: the names that OpenCV's samples, ROS and programs built on them use.

use nalgebra::Matrix3;

use super::known_camera::KnownCamera;
use crate::error::Result;
use crate::format::tree::{Expecting, Node};
use crate::geometry::{Distortion, Intrinsics};

/// Names that the values of one device go by.
pub(in crate::format) struct Names {
    matrix: &'static [&'static str],
    coefficients: &'static [&'static str],
    size: &'static [&'static str],
    width: &'static [&'static str],
    height: &'static [&'static str],
}

impl Names {
    /// All of them.
    #[cfg(feature = "npz")]
    pub(in crate::format) fn all(&self) -> impl Iterator<Item = &'static str> {
        [self.matrix, self.coefficients, self.size, self.width, self.height].into_iter().flatten().copied()
    }
}

/// A camera, or the first one of a pair.
pub(in crate::format) const FIRST: Names =
    Names { matrix: &MATRIX, coefficients: &COEFFICIENTS, size: &SIZE, width: &WIDTH, height: &HEIGHT };

/// The second camera of a pair, or the projector.
pub(in crate::format) const SECOND: Names = Names {
    matrix: &SECOND_MATRIX,
    coefficients: &SECOND_COEFFICIENTS,
    size: &["projector_size", "proj_size", "image_size_2", "imageSize2"],
    width: &["projector_width", "proj_width"],
    height: &["projector_height", "proj_height"],
};

/// Names of K. The last ones are of the first camera of a pair.
const MATRIX: [&str; 14] = [
    "camera_matrix",
    "cameraMatrix",
    "Camera_Matrix",
    "CameraMatrix",
    "K",
    "k",
    "intrinsic_matrix",
    "M1",
    "K1",
    "cameraMatrix1",
    "camera_matrix_1",
    "cam_K",
    "camera_K",
    "mtx",
];
/// The second camera of a pair.
const SECOND_MATRIX: [&str; 7] =
    ["proj_K", "projector_K", "projector_matrix", "M2", "K2", "cameraMatrix2", "camera_matrix_2"];
const SECOND_COEFFICIENTS: [&str; 7] =
    ["proj_kc", "proj_Kc", "projector_dist", "D2", "distCoeffs2", "dist_coeffs_2", "dist_2"];
const COEFFICIENTS: [&str; 18] = [
    "distortion_coefficients",
    "Distortion_Coefficients",
    "distCoeffs",
    "dist_coeffs",
    "dist_coeff",
    "distortion",
    "distortionCoefficients",
    "distCoeff",
    "distorsion_coefficients",
    "D",
    "d",
    "D1",
    "distCoeffs1",
    "dist_coeffs_1",
    "distortion_coeffs",
    "dist",
    "cam_kc",
    "camera_dist",
];
const SIZE: [&str; 6] = ["camera_size", "image_size", "imageSize", "img_size", "imgSize", "resolution"];
const WIDTH: [&str; 5] = ["image_width", "image_Width", "imageWidth", "width", "img_width"];
const HEIGHT: [&str; 5] = ["image_height", "image_Height", "imageHeight", "height", "img_height"];
/// How many coefficients OpenCV's models have, in its order: k1 k2 p1 p2, k3, k4 k5 k6, s1 s2 s3 s4, τx τy.
const COUNTS: [usize; 6] = [0, 4, 5, 8, 12, 14];
/// Names of lens models whose first five coefficients are those of `plumb_bob` while the rest is zero.
const MODELS: [&str; 6] = ["plumb_bob", "rational_polynomial", "radtan", "opencv", "none", ""];

/// Names of the lens model, and of the flag of a fisheye lens.
const MODEL_NAMES: [&str; 2] = ["distortion_model", "distortionModel"];
pub(in crate::format) const FISHEYE: &str = "fisheye_model";

fn first<'n, 'a>(root: &'n Node<'a>, names: &'static [&'static str]) -> Option<(&'static str, &'n Node<'a>)> {
    names.iter().find_map(|name| root.get(name).map(|node| (*name, node)))
}

fn number(text: &str, place: &str, expecting: Expecting) -> Result<f64> {
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
        let text: String = text.chars().take(40).collect();
        expecting.malformed(format!("{place}: expected finite numbers, found {text}"))
    })
}

/// The numbers of a matrix: {rows, cols, data}, rows in a list, or a plain list.
pub(in crate::format) fn numbers(node: &Node<'_>, place: &str, expecting: Expecting) -> Result<Vec<f64>> {
    let data = match node {
        Node::Map(_) => node.get("data").ok_or_else(|| {
            expecting.malformed(format!("{place}: expected rows, cols and data, found no data"))
        })?,
        other => other,
    };
    let values = data.words().into_iter().map(|w| number(w, place, expecting)).collect::<Result<Vec<_>>>()?;
    if let (Some(rows), Some(cols)) =
        (count(node, "rows", place, expecting)?, count(node, "cols", place, expecting)?)
        && rows.checked_mul(cols) != Some(values.len() as u64)
    {
        return Err(expecting.malformed(format!(
            "{place}: expected {rows}x{cols} numbers as its rows and cols say, found {}",
            values.len()
        )));
    }
    Ok(values)
}

fn count(node: &Node<'_>, name: &str, place: &str, expecting: Expecting) -> Result<Option<u64>> {
    let Some(value) = node.get(name) else { return Ok(None) };
    let words = value.words();
    let parsed = words.first().and_then(|w| w.parse().ok());
    parsed.map(Some).ok_or_else(|| expecting.malformed(format!("{place}: expected a whole number as {name}")))
}

/// The camera of a file.
pub(super) fn camera(root: &Node<'_>, expecting: Expecting) -> Result<KnownCamera> {
    let Some(mut camera) = device(root, &FIRST, expecting)? else {
        let Node::Map(fields) = root else {
            return Err(expecting
                .malformed("expected named values (camera_matrix, distortion_coefficients, …), found none"));
        };
        let names: Vec<&str> = fields.iter().take(8).map(|(n, _)| n.as_ref()).collect();
        return Err(expecting.malformed(format!(
            "expected a camera matrix (camera_matrix, cameraMatrix, K or M1), found {}",
            if names.is_empty() {
                "nothing".to_owned()
            } else {
                names.join(", ").chars().take(200).collect()
            }
        )));
    };
    if let Some((second, _)) = first(root, SECOND.matrix) {
        let taken = first(root, FIRST.matrix).map_or("", |(name, _)| name);
        camera.notes.insert(0, format!("the file holds two cameras; {taken} is taken, {second} is not"));
    }
    Ok(camera)
}

/// The device that goes by these names; `None` when the file has no such matrix.
pub(in crate::format) fn device(
    root: &Node<'_>,
    names: &Names,
    expecting: Expecting,
) -> Result<Option<KnownCamera>> {
    let Some((name, matrix)) = first(root, names.matrix) else { return Ok(None) };
    let values = numbers(matrix, name, expecting)?;
    if values.len() != 9 {
        return Err(expecting.malformed(format!("{name}: expected 3x3 numbers, found {}", values.len())));
    }
    let intrinsics = Intrinsics::from_matrix(&Matrix3::from_row_slice(&values))
        .map_err(|e| expecting.malformed(format!("{name}: {e}")))?;
    let mut notes = Vec::new();
    let distortion = if let Some((name, node)) = first(root, names.coefficients) {
        distortion(&numbers(node, name, expecting)?, name, expecting)?
    } else {
        notes.push(format!(
            "{name} has no distortion coefficients beside it; the lens is taken for undistorted"
        ));
        Distortion::NONE
    };
    check_model(root, distortion, expecting)?;
    Ok(Some(KnownCamera { intrinsics, distortion, size: size(root, names, expecting)?, notes }))
}

/// From as many coefficients as OpenCV's models have.
pub(in crate::format) fn distortion(values: &[f64], place: &str, expecting: Expecting) -> Result<Distortion> {
    if !COUNTS.contains(&values.len()) {
        return Err(expecting
            .malformed(format!("{place}: expected 4, 5, 8, 12 or 14 coefficients, found {}", values.len())));
    }
    if let Some((i, value)) = values.iter().enumerate().skip(5).find(|(_, v)| **v != 0.0) {
        return Err(expecting.malformed(format!(
            "{place}: expected k1, k2, p1, p2, k3 and zeros, found {value} as coefficient {} (a rational, thin prism or tilted \
             lens model); calibrate that camera again with five coefficients",
            i + 1
        )));
    }
    let mut five = [0.0; 5];
    five.iter_mut().zip(values).for_each(|(to, from)| *to = *from);
    Ok(Distortion::from_array(five))
}

/// Refuses lens models whose coefficients mean something else.
fn check_model(root: &Node<'_>, distortion: Distortion, expecting: Expecting) -> Result<()> {
    let fisheye = root.get(FISHEYE).is_some_and(|n| n.words().first().is_some_and(|w| *w != "0"));
    let named = first(root, &MODEL_NAMES);
    let name = match named {
        Some((_, Node::Scalar(name))) => name.trim(),
        _ => "",
    };
    let known = MODELS.iter().any(|m| m.eq_ignore_ascii_case(name));
    if (fisheye || !known) && !distortion.is_none() {
        let found = if fisheye { "a fisheye model" } else { name };
        let found: String = found.chars().take(40).collect();
        return Err(expecting.malformed(format!(
            "distortion_model: expected plumb_bob, found {found}, whose coefficients mean something else; calibrate that camera \
             again with plumb_bob, or give undistorted images and zero coefficients"
        )));
    }
    Ok(())
}

fn size(root: &Node<'_>, names: &Names, expecting: Expecting) -> Result<Option<[u32; 2]>> {
    let side = |text: &str, place: &str| {
        let number = number(text, place, expecting)?;
        if (1.0..=1e6).contains(&number) && number.fract() == 0.0 {
            return Ok(number as u32);
        }
        Err(expecting
            .malformed(format!("{place}: expected a whole number of pixels above zero, found {number}")))
    };
    if let (Some((w, width)), Some((h, height))) = (first(root, names.width), first(root, names.height)) {
        return match (width.words().as_slice(), height.words().as_slice()) {
            ([width], [height]) => Ok(Some([side(width, w)?, side(height, h)?])),
            _ => Err(expecting.malformed(format!("{w}, {h}: expected one number each"))),
        };
    }
    let Some((name, node)) = first(root, names.size) else { return Ok(None) };
    let values = match (node.get("width"), node.get("height")) {
        (Some(width), Some(height)) => [width.words(), height.words()].concat(),
        _ => match node.get("data") {
            Some(data) => data.words(),
            None => node.words(),
        },
    };
    match values[..] {
        [width, height] => Ok(Some([side(width, name)?, side(height, name)?])),
        _ => {
            Err(expecting
                .malformed(format!("{name}: expected width and height, found {} values", values.len())))
        }
    }
}
