//! Clouds and meshes as GLB, the binary form of glTF 2.0.

use std::io::Write;

use nalgebra::{Point3, Vector3};
use serde_json::{Value, json};

use crate::cloud::{CloudPoint, Frame, PointCloud};
use crate::error::{Error, ErrorSubject, Result};
use crate::photo::Encoding;

/// The attributes of a vertex in the order of the buffer, and their number of components. All are floats, each in its own
/// buffer view: interleaved and 16-bit data are allowed, but not every reader supports them.
const ATTRIBUTES: [(&str, usize); 6] =
    [("POSITION", 3), ("COLOR_0", 3), ("_SIGMA_MM", 1), ("_NOISE_MM", 1), ("_CONFIDENCE", 1), ("_SLIT", 1)];
/// Bytes of all attributes of one vertex.
const VERTEX_BYTES: usize = 4 * (3 + 3 + 1 + 1 + 1 + 1);
/// The attribute that follows them when the cloud has normals.
const NORMAL: (&str, usize) = ("NORMAL", 3);
const NORMAL_BYTES: usize = 4 * 3;
/// glTF's names of types and places: `componentType`, `target` and `mode`.
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const POINTS: u32 = 0;
const TRIANGLES: u32 = 4;

/// Writes a cloud as binary glTF 2.0: the triangles when there are any, else the points.
///
/// glTF uses metres with y upwards: a point (x, y, z) of the cloud in mm is written as (x, −y, −z) / 1000. The asset's
/// `extras` state this and the frame. Colours are linear light, as glTF requires. Each vertex also has the attributes
/// `_SIGMA_MM`, `_NOISE_MM`, `_CONFIDENCE` and `_SLIT`, and `NORMAL` when the cloud has normals. glTF wants unit vectors: a
/// point whose normal is zero gets the direction to the camera.
///
/// # Errors
/// [`Error::Invalid`] for coordinates that are not finite and for more than 4 GiB, which the format cannot hold;
/// [`Error::Io`] when the stream fails.
pub fn write_glb(cloud: &PointCloud, mut output: impl Write) -> Result<()> {
    let buffer = buffer(cloud)?;
    let mut text = document(cloud, &buffer).to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let binary = buffer.bytes.len();
    let chunks = if binary > 0 { [8 + text.len(), 8 + binary] } else { [8 + text.len(), 0] };
    let length = u32::try_from(12 + chunks.iter().sum::<usize>()).map_err(|_| too_large(cloud))?;
    let mut write = || {
        output.write_all(b"glTF")?;
        for word in [2, length, text.len() as u32] {
            output.write_all(&word.to_le_bytes())?;
        }
        output.write_all(b"JSON")?;
        output.write_all(&text)?;
        if binary > 0 {
            output.write_all(&(binary as u32).to_le_bytes())?;
            output.write_all(b"BIN\0")?;
            output.write_all(&buffer.bytes)?;
        }
        output.flush()
    };
    write().map_err(|e: std::io::Error| Error::writing(ErrorSubject::Glb, e))
}

fn too_large(cloud: &PointCloud) -> Error {
    let found = format!("{} points and {} triangles", cloud.points.len(), cloud.triangles.len());
    Error::invalid("cloud for a GLB", "one of at most 4 GiB; write a PLY", found)
}

/// The vertices, then the indices; and the box that holds the positions as they were written.
struct Buffer {
    bytes: Vec<u8>,
    min: [f32; 3],
    max: [f32; 3],
}

impl Buffer {
    fn floats(&mut self, values: impl IntoIterator<Item = f32>) {
        self.bytes.extend(values.into_iter().flat_map(f32::to_le_bytes));
    }
}

fn buffer(cloud: &PointCloud) -> Result<Buffer> {
    let normals = cloud.known_normals();
    let vertex = VERTEX_BYTES + if normals.is_some() { NORMAL_BYTES } else { 0 };
    let size = cloud.points.len() * vertex + cloud.triangles.len() * 12;
    if u32::try_from(size).is_err() {
        return Err(too_large(cloud));
    }
    let mut buffer =
        Buffer { bytes: Vec::with_capacity(size), min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };
    for (i, p) in cloud.points.iter().enumerate() {
        let position = [p.position.x, -p.position.y, -p.position.z].map(|mm| (mm / 1000.0) as f32);
        if position.iter().any(|x| !x.is_finite()) {
            let found = format!("{:?} at point {i}", p.position);
            return Err(Error::invalid("cloud for a GLB", "finite coordinates", found));
        }
        for (k, x) in position.into_iter().enumerate() {
            buffer.min[k] = buffer.min[k].min(x);
            buffer.max[k] = buffer.max[k].max(x);
        }
        buffer.floats(position);
    }
    for p in &cloud.points {
        buffer.floats(p.color.map(linear));
    }
    buffer.floats(cloud.points.iter().map(|p| p.sigma_mm as f32));
    buffer.floats(cloud.points.iter().map(|p| p.noise_mm as f32));
    buffer.floats(cloud.points.iter().map(|p| p.confidence as f32));
    buffer.floats(cloud.points.iter().map(|p| f32::from(p.slit.unwrap_or(0))));
    for (p, n) in cloud.points.iter().zip(normals.into_iter().flatten()) {
        buffer.floats(unit_normal(p, n, &cloud.camera_centre));
    }
    for i in cloud.triangles.iter().flatten() {
        buffer.bytes.extend(i.to_le_bytes());
    }
    Ok(buffer)
}

/// A normal with y upwards, of length one.
fn unit_normal(point: &CloudPoint, normal: &Vector3<f32>, camera: &Point3<f64>) -> [f32; 3] {
    let unit = |v: Vector3<f64>| v.try_normalize(1e-6).filter(|v| v.iter().all(|x| x.is_finite()));
    let towards_camera = || unit(camera - point.position).unwrap_or_else(|| -Vector3::z());
    let n = unit(normal.cast()).unwrap_or_else(towards_camera);
    [n.x, -n.y, -n.z].map(|x| x as f32)
}

/// Linear light of an sRGB code value.
fn linear(code: u8) -> f32 {
    Encoding::Srgb.to_linear(f64::from(code) / 255.0) as f32
}

fn document(cloud: &PointCloud, buffer: &Buffer) -> Value {
    let frame = if cloud.frame == Frame::Plane { "plane" } else { "camera" };
    let camera = cloud.camera_centre;
    let mut document = json!({
        "asset": {
            "version": "2.0",
            "generator": "slcal",
            "extras": {
                "frame": frame,
                "cloud_units": "mm",
                "camera_centre_mm": [camera.x, camera.y, camera.z],
                "note": "in metres, y upwards, as glTF wants it: (x, y, z) mm of the frame became (x, -y, -z) / 1000",
            },
        },
        "scene": 0,
        "scenes": [{}],
    });
    // glTF has no empty lists: a cloud without points is a scene without nodes.
    if cloud.points.is_empty() {
        return document;
    }
    let count = cloud.points.len();
    let mut primitive = json!({"attributes": {}, "material": 0, "mode": POINTS});
    let (mut accessors, mut views, mut end) = (Vec::new(), Vec::new(), 0);
    let normal = cloud.known_normals().map(|_| NORMAL);
    for (i, (name, numbers)) in ATTRIBUTES.into_iter().chain(normal).enumerate() {
        let (length, kind) = (4 * numbers * count, if numbers == 3 { "VEC3" } else { "SCALAR" });
        primitive["attributes"][name] = json!(i);
        accessors.push(json!({"bufferView": i, "componentType": FLOAT, "count": count, "type": kind}));
        views.push(json!({"buffer": 0, "byteOffset": end, "byteLength": length, "target": ARRAY_BUFFER}));
        end += length;
    }
    accessors[0]["min"] = json!(buffer.min.map(f64::from));
    accessors[0]["max"] = json!(buffer.max.map(f64::from));
    // Surfaces are visible from both sides. Points have their own colours: few readers shade them, whatever their normals.
    let mut material =
        json!({"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1}, "doubleSided": true});
    if cloud.triangles.is_empty() {
        material["extensions"] = json!({"KHR_materials_unlit": {}});
        document["extensionsUsed"] = json!(["KHR_materials_unlit"]);
    } else {
        let indices = cloud.triangles.len() * 3;
        primitive["mode"] = json!(TRIANGLES);
        primitive["indices"] = json!(accessors.len());
        accessors.push(
            json!({"bufferView": views.len(), "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR"}),
        );
        views.push(json!({
            "buffer": 0, "byteOffset": end, "byteLength": 4 * indices, "target": ELEMENT_ARRAY_BUFFER,
        }));
    }
    document["scenes"] = json!([{"nodes": [0]}]);
    document["nodes"] = json!([{"mesh": 0, "name": "cloud"}]);
    document["meshes"] = json!([{"primitives": [primitive]}]);
    document["materials"] = json!([material]);
    document["accessors"] = json!(accessors);
    document["bufferViews"] = json!(views);
    document["buffers"] = json!([{"byteLength": buffer.bytes.len()}]);
    document
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::test_cloud;

    /// Takes the container apart by the format's description: 12 bytes of header, then chunks on multiples of four.
    fn parse(bytes: &[u8]) -> (Value, Vec<u8>) {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (b"glTF".as_slice(), 2, bytes.len()));
        let (mut at, mut chunks) = (12, Vec::new());
        while at < bytes.len() {
            let length = word(at);
            assert_eq!(length % 4, 0);
            chunks.push((bytes[at + 4..at + 8].to_vec(), bytes[at + 8..at + 8 + length].to_vec()));
            at += 8 + length;
        }
        assert_eq!(chunks[0].0, b"JSON");
        assert!(chunks.get(1).is_none_or(|c| c.0 == b"BIN\0"));
        let binary = chunks.get(1).map_or_else(Vec::new, |c| c.1.clone());
        (serde_json::from_slice(&chunks[0].1).unwrap(), binary)
    }

    fn whole(v: &Value) -> usize {
        usize::try_from(v.as_u64().unwrap()).unwrap()
    }

    /// The elements of an accessor as numbers, wherever its view, offset and stride say they are.
    fn elements(document: &Value, binary: &[u8], accessor: &Value) -> Vec<Vec<f64>> {
        let accessor = &document["accessors"][whole(accessor)];
        let view = &document["bufferViews"][whole(&accessor["bufferView"])];
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            other => panic!("{other}"),
        };
        let (start, count) = (whole(&view["byteOffset"]), whole(&accessor["count"]));
        // Alignment as the format demands it, and views that hold what their accessors announce.
        assert_eq!(start % 4, 0);
        assert_eq!(whole(&view["byteLength"]), 4 * width * count);
        assert!(start + whole(&view["byteLength"]) <= binary.len());
        (0..count)
            .map(|i| {
                (0..width)
                    .map(|k| {
                        let b = binary[start + 4 * (i * width + k)..][..4].try_into().unwrap();
                        match accessor["componentType"].as_u64().unwrap() as u32 {
                            FLOAT => f64::from(f32::from_le_bytes(b)),
                            UNSIGNED_INT => f64::from(u32::from_le_bytes(b)),
                            other => panic!("{other}"),
                        }
                    })
                    .collect()
            })
            .collect()
    }

    #[test]
    fn a_reader_by_the_formats_rules_finds_the_cloud() {
        let cloud = test_cloud();
        let mut bytes = Vec::new();
        write_glb(&cloud, &mut bytes).unwrap();
        let (document, binary) = parse(&bytes);
        assert_eq!(document["asset"]["version"], "2.0");
        assert_eq!(document["buffers"], json!([{"byteLength": binary.len()}]));
        let primitive = &document["meshes"][0]["primitives"][0];
        assert_eq!(primitive["mode"], TRIANGLES);
        let of = |name: &str| elements(&document, &binary, &primitive["attributes"][name]);
        let positions = of("POSITION");
        for (x, p) in positions.iter().zip(&cloud.points) {
            for (a, b) in x.iter().zip([p.position.x, -p.position.y, -p.position.z]) {
                assert!((a * 1000.0 - b).abs() < 1e-4, "{a} {b}");
            }
        }
        // The bounds are those of the numbers in the buffer, exactly.
        let accessor = &document["accessors"][whole(&primitive["attributes"]["POSITION"])];
        for k in 0..3 {
            let of_axis = || positions.iter().map(|x| x[k]);
            assert_eq!(accessor["min"][k].as_f64().unwrap(), of_axis().fold(f64::INFINITY, f64::min));
            assert_eq!(accessor["max"][k].as_f64().unwrap(), of_axis().fold(f64::NEG_INFINITY, f64::max));
        }
        // IEC 61966-2-1: code 255 is all of the light, 2 the part 2/255/12.92.
        let dark = f64::from((2.0 / 255.0 / 12.92) as f32);
        assert_eq!(of("COLOR_0")[0], [0.0, dark, 1.0]);
        assert_eq!(of("_SIGMA_MM")[3], [0.125]);
        assert_eq!(of("_NOISE_MM")[3], [cloud.points[3].noise_mm]);
        assert_eq!(of("_CONFIDENCE")[3], [0.75]);
        assert_eq!(of("_SLIT")[3], [60_003.0]);
        let indices: Vec<f64> =
            elements(&document, &binary, &primitive["indices"]).into_iter().flatten().collect();
        assert_eq!(indices, [0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
    }

    #[test]
    fn normals_are_unit_vectors_with_y_upwards() {
        let mut cloud = test_cloud();
        cloud.camera_centre = Point3::new(0.0, -0.5, 0.0);
        cloud.normals = vec![Vector3::zeros(), Vector3::new(0.0, 1.2, -1.6), -Vector3::z(), Vector3::x()];
        let mut bytes = Vec::new();
        write_glb(&cloud, &mut bytes).unwrap();
        let (document, binary) = parse(&bytes);
        let primitive = &document["meshes"][0]["primitives"][0];
        let of = |name: &Value| elements(&document, &binary, name);
        let normals = of(&primitive["attributes"]["NORMAL"]);
        // The first has none of its own and looks at the camera, which lies in front of it.
        for (n, expected) in
            normals.iter().zip([[0.0, 0.0, 1.0], [0.0, -0.6, 0.8], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
        {
            assert!(n.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{n:?}");
        }
        let indices: Vec<f64> = of(&primitive["indices"]).into_iter().flatten().collect();
        assert_eq!(indices, [0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
        assert_eq!(of(&primitive["attributes"]["_SLIT"])[3], [60_003.0]);
        assert_eq!(document["buffers"], json!([{"byteLength": binary.len()}]));
    }

    #[test]
    fn without_triangles_there_are_points_and_without_points_nothing() {
        let mut cloud = test_cloud();
        cloud.triangles.clear();
        let mut bytes = Vec::new();
        write_glb(&cloud, &mut bytes).unwrap();
        let (document, binary) = parse(&bytes);
        assert_eq!(document["meshes"][0]["primitives"][0]["mode"], POINTS);
        assert_eq!(binary.len(), 4 * VERTEX_BYTES);
        bytes.clear();
        write_glb(&PointCloud::default(), &mut bytes).unwrap();
        let (document, binary) = parse(&bytes);
        assert!(document.get("meshes").is_none() && document.get("buffers").is_none() && binary.is_empty());
    }

    #[test]
    fn coordinates_that_are_none_are_refused() {
        let mut cloud = test_cloud();
        cloud.points[1].position.y = f64::NAN;
        assert!(write_glb(&cloud, Vec::new()).unwrap_err().to_string().contains("point 1"));
    }
}
