//! Clouds as PLY: written little-endian binary, read in any of the three encodings.

use std::io::{BufRead, BufReader, Read, Write};

use nalgebra::{Point3, Vector3};

use super::budget::{Budget, LONGEST_LINE, Metered};
use super::buffered::buffered;
use super::recognise::refuse_others;
use crate::cloud::{CloudPoint, Frame, PointCloud};
use crate::error::{Error, ErrorSubject, Result};

/// Largest number of vertices or faces; more means a broken header.
const MAX_COUNT: usize = 1 << 31;

/// Bytes of the header and of one of its lines.
const LONGEST_HEADER: usize = 1 << 20;
const LONGEST_HEADER_LINE: usize = 4096;

fn malformed(detail: impl Into<String>) -> Error {
    Error::malformed(ErrorSubject::Ply, detail)
}

/// Writes a cloud as `binary_little_endian` 1.0: vertices with position, colour, σ, slit, confidence and the
/// noise part of σ, normals when the cloud has them, and faces when it has triangles. Positions are 32-bit floats.
///
/// # Errors
/// [`Error::Io`] when the stream fails.
pub fn write_ply(cloud: &PointCloud, output: impl Write) -> Result<()> {
    buffered(ErrorSubject::Ply, output, |out| {
        writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment units mm")?;
        match cloud.frame {
            Frame::Camera => writeln!(out, "comment frame camera")?,
            Frame::Plane => {
                let c = cloud.camera_centre;
                writeln!(out, "comment frame plane\ncomment camera {} {} {}", c.x, c.y, c.z)?;
            }
        }
        writeln!(out, "element vertex {}", cloud.points.len())?;
        writeln!(out, "property float x\nproperty float y\nproperty float z")?;
        writeln!(out, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
        writeln!(out, "property float sigma\nproperty ushort slit\nproperty float confidence")?;
        writeln!(out, "property float noise")?;
        let normals = cloud.known_normals();
        if normals.is_some() {
            writeln!(out, "property float nx\nproperty float ny\nproperty float nz")?;
        }
        if !cloud.triangles.is_empty() {
            writeln!(out, "element face {}\nproperty list uchar int vertex_indices", cloud.triangles.len())?;
        }
        writeln!(out, "end_header")?;
        for (i, p) in cloud.points.iter().enumerate() {
            for x in p.position.iter() {
                out.write_all(&(*x as f32).to_le_bytes())?;
            }
            out.write_all(&p.color)?;
            out.write_all(&(p.sigma_mm as f32).to_le_bytes())?;
            out.write_all(&p.slit.unwrap_or(0).to_le_bytes())?;
            out.write_all(&(p.confidence as f32).to_le_bytes())?;
            out.write_all(&(p.noise_mm as f32).to_le_bytes())?;
            for x in normals.iter().flat_map(|n| n[i].iter()) {
                out.write_all(&x.to_le_bytes())?;
            }
        }
        for t in &cloud.triangles {
            out.write_all(&[3])?;
            for i in t {
                out.write_all(&i.to_le_bytes())?;
            }
        }
        Ok(())
    })
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn parse(name: &str) -> Result<Self> {
        Ok(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            other => return Err(malformed(format!("unknown type \"{other}\" in the header"))),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn value(self, mut bytes: [u8; 8], encoding: Encoding) -> f64 {
        if encoding == Encoding::Big {
            bytes[..self.size()].reverse();
        }
        let [a, b, c, d, ..] = bytes;
        match self {
            Self::I8 => f64::from(a as i8),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(bytes),
        }
    }
}

struct Property {
    name: String,
    kind: Type,
    /// Type of the count, for lists.
    count: Option<Type>,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    frame: Frame,
    camera: Point3<f64>,
}

/// Reads a cloud. Positions are required; colour, σ, slit, confidence, normals and triangles are optional. Points with coordinates
/// that are not finite are left out when the file has no faces.
///
/// # Errors
/// [`Error::Malformed`] saying where the file departs from the format; [`Error::Io`] when the stream fails.
pub fn read_ply(input: impl Read) -> Result<PointCloud> {
    let budget = Budget::of_stream(ErrorSubject::Ply);
    let mut input = BufReader::new(Metered::new(input, &budget));
    refuse_others(input.fill_buf().map_err(io)?, ErrorSubject::Ply, &["a PLY"])?;
    let header = read_header(&mut input)?;
    let mut values = Values { input, encoding: header.encoding, line: Vec::new() };
    let mut cloud = PointCloud { frame: header.frame, camera_centre: header.camera, ..PointCloud::default() };
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut values, element, &mut cloud, &budget)?,
            "face" => read_faces(&mut values, element, &mut cloud, &budget)?,
            // A record without properties takes no bytes: the size of the file would not bound their number.
            _ if element.properties.is_empty() => {}
            _ => {
                for _ in 0..element.count {
                    values.record(element, |_, _, _| {})?;
                }
            }
        }
    }
    if cloud.triangles.is_empty() {
        let is_finite = |p: &CloudPoint| p.position.iter().all(|x| x.is_finite());
        if cloud.known_normals().is_some() {
            let mut points = cloud.points.iter();
            cloud.normals.retain(|_| points.next().is_some_and(is_finite));
        }
        cloud.points.retain(is_finite);
    }
    Ok(cloud)
}

fn read_header(input: &mut impl BufRead) -> Result<Header> {
    let mut header = Header {
        encoding: Encoding::Ascii,
        elements: Vec::new(),
        frame: Frame::Camera,
        camera: Point3::origin(),
    };
    let (mut formatted, mut first) = (false, true);
    let mut left = LONGEST_HEADER;
    loop {
        let line = text_line(input, LONGEST_HEADER_LINE)?
            .ok_or_else(|| malformed("the file ends within the header"))?;
        left = left
            .checked_sub(line.len() + 1)
            .ok_or_else(|| malformed(format!("a header of more than {LONGEST_HEADER} bytes")))?;
        let words: Vec<&str> = line.split_whitespace().collect();
        if std::mem::take(&mut first) {
            if words != ["ply"] {
                return Err(malformed("the first line is not \"ply\""));
            }
            continue;
        }
        match words[..] {
            ["format", name, _] => {
                formatted = true;
                header.encoding = match name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::Little,
                    "binary_big_endian" => Encoding::Big,
                    other => return Err(malformed(format!("unknown format \"{other}\""))),
                };
            }
            ["comment", "frame", "plane"] => header.frame = Frame::Plane,
            ["comment", "camera", x, y, z] => {
                if let (Ok(x), Ok(y), Ok(z)) = (x.parse(), y.parse(), z.parse()) {
                    header.camera = Point3::new(x, y, z);
                }
            }
            ["element", name, count] => {
                let count = count.parse().ok().filter(|&n: &usize| n <= MAX_COUNT);
                let count = count.ok_or_else(|| malformed(format!("bad count in \"{line}\"")))?;
                header.elements.push(Element { name: name.into(), count, properties: Vec::new() });
            }
            ["property", "list", count, kind, name] => {
                let property = Property {
                    name: name.into(),
                    kind: Type::parse(kind)?,
                    count: Some(Type::parse(count)?),
                };
                element_of(&mut header, &line)?.properties.push(property);
            }
            ["property", kind, name] => {
                let property = Property { name: name.into(), kind: Type::parse(kind)?, count: None };
                element_of(&mut header, &line)?.properties.push(property);
            }
            ["end_header"] => break,
            [] | ["comment" | "obj_info", ..] => {}
            _ => return Err(malformed(format!("header line \"{line}\" not understood"))),
        }
    }
    if !formatted {
        return Err(malformed("the header has no format line"));
    }
    Ok(header)
}

fn element_of<'h>(header: &'h mut Header, line: &str) -> Result<&'h mut Element> {
    header.elements.last_mut().ok_or_else(|| malformed(format!("\"{line}\" stands before any element")))
}

/// A line of at most `limit` bytes; `None` at the end of the file.
fn text_line(input: &mut impl BufRead, limit: usize) -> Result<Option<String>> {
    let mut bytes = Vec::new();
    let read = input.take(limit as u64).read_until(b'\n', &mut bytes).map_err(io)?;
    if read == limit {
        return Err(malformed(format!("a line of more than {limit} bytes where text is expected")));
    }
    Ok((read > 0).then(|| String::from_utf8_lossy(&bytes).trim_end().to_owned()))
}

fn io(e: std::io::Error) -> Error {
    if e.kind() == std::io::ErrorKind::UnexpectedEof {
        return malformed("the file ends before the last of the elements that its header announces");
    }
    Error::reading(ErrorSubject::Ply, e)
}

struct Values<R> {
    input: R,
    encoding: Encoding,
    /// Numbers of the current line of an ASCII file, last first.
    line: Vec<f64>,
}

impl<R: BufRead> Values<R> {
    fn next(&mut self, kind: Type) -> Result<f64> {
        if self.encoding == Encoding::Ascii {
            while self.line.is_empty() {
                let Some(text) = text_line(&mut self.input, LONGEST_LINE)? else {
                    return Err(malformed(
                        "the file ends before the last of the elements that its header announces",
                    ));
                };
                for word in text.split_whitespace().rev() {
                    self.line
                        .push(word.parse().map_err(|_| malformed(format!("\"{word}\" is not a number")))?);
                }
            }
            return Ok(self.line.pop().unwrap_or(f64::NAN));
        }
        let mut bytes = [0; 8];
        self.input.read_exact(&mut bytes[..kind.size()]).map_err(io)?;
        Ok(kind.value(bytes, self.encoding))
    }

    /// Calls `take(property, place in list, value)` for every number of one record.
    fn record(&mut self, element: &Element, mut take: impl FnMut(usize, usize, f64)) -> Result<()> {
        for (i, p) in element.properties.iter().enumerate() {
            let n = match p.count {
                Some(kind) => {
                    let count = self.next(kind)?;
                    if count < 0.0 || count.is_nan() {
                        return Err(malformed(format!("a list \"{}\" of {count} numbers", p.name)));
                    }
                    count as usize
                }
                None => 1,
            };
            for k in 0..n {
                take(i, k, self.next(p.kind)?);
            }
        }
        Ok(())
    }
}

fn read_vertices<R: BufRead>(
    values: &mut Values<R>,
    element: &Element,
    cloud: &mut PointCloud,
    budget: &Budget,
) -> Result<()> {
    let find = |names: &[&str]| element.properties.iter().position(|p| names.contains(&p.name.as_str()));
    let place = |name: &str| {
        find(&[name]).ok_or_else(|| malformed(format!("the vertices have no property \"{name}\"")))
    };
    let xyz = [place("x")?, place("y")?, place("z")?];
    let rgb = [["red", "r"], ["green", "g"], ["blue", "b"]].map(|n| find(&n));
    let float_color = rgb[0].is_some_and(|i| matches!(element.properties[i].kind, Type::F32 | Type::F64));
    let color_scale = if float_color { 255.0 } else { 1.0 };
    let [sigma, slit, confidence, noise] = ["sigma", "slit", "confidence", "noise"].map(|n| find(&[n]));
    let normal = ["nx", "ny", "nz"].map(|n| find(&[n]));
    let has_normals = normal.iter().all(Option::is_some);
    for _ in 0..element.count {
        let mut p = CloudPoint::at(Point3::origin());
        let mut n = Vector3::zeros();
        values.record(element, |i, _, v| {
            if let Some(k) = xyz.iter().position(|&x| x == i) {
                p.position[k] = v;
            } else if let Some(k) = rgb.iter().position(|&x| x == Some(i)) {
                p.color[k] = (v * color_scale).round() as u8;
            } else if sigma == Some(i) {
                p.sigma_mm = v;
            } else if slit == Some(i) {
                p.slit = Some(v as u16);
            } else if confidence == Some(i) {
                p.confidence = v;
            } else if noise == Some(i) {
                p.noise_mm = v;
            } else if let Some(k) = normal.iter().position(|&x| x == Some(i)) {
                n[k] = v as f32;
            }
        })?;
        budget.keep_list::<CloudPoint>(1)?;
        cloud.points.push(p);
        if has_normals {
            budget.keep_list::<Vector3<f32>>(1)?;
            let is_known = n.iter().all(|x| x.is_finite());
            cloud.normals.push(if is_known { n } else { Vector3::zeros() });
        }
    }
    Ok(())
}

/// Splits polygons into triangle fans.
fn read_faces<R: BufRead>(
    values: &mut Values<R>,
    element: &Element,
    cloud: &mut PointCloud,
    budget: &Budget,
) -> Result<()> {
    let is_index = |p: &Property| matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
    let Some(indices) = element.properties.iter().position(is_index) else {
        return Err(malformed("the faces have no list \"vertex_indices\""));
    };
    let count = cloud.points.len();
    for _ in 0..element.count {
        let (mut first, mut last, mut missing) = (0, 0, None);
        let before = cloud.triangles.len();
        values.record(element, |i, k, v| {
            if i != indices {
                return;
            }
            if !(v >= 0.0 && v < count as f64) {
                missing.get_or_insert(v);
                return;
            }
            let corner = v as u32;
            match k {
                0 => first = corner,
                1 => {}
                _ => cloud.triangles.push([first, last, corner]),
            }
            last = corner;
        })?;
        if let Some(v) = missing {
            return Err(malformed(format!("a face refers to vertex {v} of {count}")));
        }
        budget.keep_list::<[u32; 3]>(cloud.triangles.len() - before)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(frame: Frame) -> PointCloud {
        let camera_centre =
            if frame == Frame::Plane { Point3::new(1.0, 2.0, -3.5) } else { Point3::origin() };
        PointCloud { frame, camera_centre, ..crate::for_tests::test_cloud() }
    }

    fn same(a: &PointCloud, b: &PointCloud) -> bool {
        a.triangles == b.triangles
            && a.frame == b.frame
            && a.camera_centre == b.camera_centre
            && a.points.len() == b.points.len()
            && a.points.iter().zip(&b.points).all(|(p, q)| {
                p.position == q.position
                    && p.color == q.color
                    && (p.sigma_mm, p.noise_mm, p.slit, p.confidence)
                        == (q.sigma_mm, q.noise_mm, q.slit, q.confidence)
            })
    }

    #[test]
    fn what_is_written_is_read() {
        for frame in [Frame::Camera, Frame::Plane] {
            let mut bytes = Vec::new();
            write_ply(&cloud(frame), &mut bytes).unwrap();
            assert!(same(&read_ply(&bytes[..]).unwrap(), &cloud(frame)));
        }
    }

    #[test]
    fn normals_are_written_and_read() {
        let normals = vec![
            Vector3::new(0.0, 0.0, -1.0),
            Vector3::new(0.6, 0.0, -0.8),
            Vector3::zeros(),
            Vector3::new(0.0, 0.28, -0.96),
        ];
        for triangles in [cloud(Frame::Camera).triangles, Vec::new()] {
            let given = PointCloud { normals: normals.clone(), triangles, ..cloud(Frame::Camera) };
            let mut bytes = Vec::new();
            write_ply(&given, &mut bytes).unwrap();
            let read = read_ply(&bytes[..]).unwrap();
            assert!(same(&read, &given));
            assert_eq!(read.normals, normals);
        }
        // Too few to be those of the points: left out.
        let short = PointCloud { normals: normals[..3].to_vec(), ..cloud(Frame::Camera) };
        let (mut with, mut without) = (Vec::new(), Vec::new());
        write_ply(&short, &mut with).unwrap();
        write_ply(&cloud(Frame::Camera), &mut without).unwrap();
        assert_eq!(with, without);
    }

    #[test]
    fn normals_from_elsewhere_stay_with_their_points() {
        let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                      property float nx\nproperty double ny\nproperty float nz\nend_header\n";
        let text = format!("{header}0 0 1 1 0 0\n0 nan 1 0 1 0\n2 0 1 nan 0 1\n");
        let c = read_ply(text.as_bytes()).unwrap();
        assert_eq!(c.points.len(), 2);
        assert_eq!(c.normals, [Vector3::new(1.0, 0.0, 0.0), Vector3::zeros()]);
        // Two of three coordinates are no normal.
        let flat = text.replace("property float nz\n", "property float quality\n");
        assert!(read_ply(flat.as_bytes()).unwrap().normals.is_empty());
    }

    #[test]
    fn the_bytes_are_those_of_the_format() {
        let mut bytes = Vec::new();
        write_ply(&cloud(Frame::Camera), &mut bytes).unwrap();
        let header = "ply\nformat binary_little_endian 1.0\ncomment units mm\ncomment frame camera\nelement vertex 4\n";
        assert!(bytes.starts_with(header.as_bytes()));
        // x y z, rgb, sigma, slit, confidence, noise: 12 + 3 + 4 + 2 + 4 + 4 bytes; a face: 1 + 12.
        let end = b"end_header\n";
        let at = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        assert_eq!(bytes.len() - at, 4 * 29 + 2 * 13);
        assert_eq!(bytes[at + 8..at + 12], 1000.25_f32.to_le_bytes());
    }

    #[test]
    fn clouds_from_elsewhere_are_read() {
        let ascii = "ply\r\nformat ascii 1.0\r\nelement camera 1\nproperty float f\nelement vertex 4\nproperty double x\nproperty double y\n\
                     property double z\nproperty float red\nproperty float green\nproperty float blue\nelement face 1\n\
                     property list uchar int vertex_index\nend_header\n7\n0 0 1 1 0 0.5\n1 0 1 0 0 0\n1 1 1 0 0 0\n0 1 1 0 0 0\n4 0 1 2 3\n";
        let c = read_ply(ascii.as_bytes()).unwrap();
        assert_eq!((c.points.len(), c.points[0].color), (4, [255, 0, 128]));
        assert_eq!(c.triangles, [[0, 1, 2], [0, 2, 3]]);
        let mut big = b"ply\nformat binary_big_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n".to_vec();
        for x in [1.0_f32, 2.0, 3.0, f32::NAN, 0.0, 0.0] {
            big.extend(x.to_be_bytes());
        }
        let c = read_ply(&big[..]).unwrap();
        assert_eq!((c.points.len(), c.points[0].position), (1, Point3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn broken_files_say_where() {
        let mut bytes = Vec::new();
        write_ply(&cloud(Frame::Camera), &mut bytes).unwrap();
        let says = |bytes: &[u8], what: &str| {
            let message = read_ply(bytes).unwrap_err().to_string();
            assert!(message.contains(what), "{message}");
        };
        says(&bytes[..bytes.len() - 5], "ends before");
        says(&bytes[..60], "within the header");
        says(b"", "within the header");
        says(b"obj\n", "first line");
        says(b"ply\nend_header\n", "format");
        says(b"ply\nformat ascii 1.0\nelement vertex -3\nend_header\n", "count");
        says(b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "\"y\"");
        let face = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n3 0 1 2\n";
        says(face.as_bytes(), "vertex 1 of 1");
        let list = face.replace("uchar int", "int int").replace("3 0 1 2", "-1");
        says(list.as_bytes(), "a list \"vertex_indices\" of -1 numbers");
    }

    #[test]
    fn headers_and_tiny_vertices_are_limited() {
        let of = |bytes: &[u8]| read_ply(bytes).map(|c| c.points.len()).map_err(|e| e.to_string());
        let comments = format!("ply\n{}", "comment\n".repeat(140_000));
        assert!(of(comments.as_bytes()).unwrap_err().contains("header of more than 1048576 bytes"));
        let xyz = "property uchar x\nproperty uchar y\nproperty uchar z\nend_header\n";
        let tiny = |n: usize| {
            let header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {n}\n{xyz}");
            [header.as_bytes(), &vec![0; 3 * n]].concat()
        };
        assert_eq!(of(&tiny(400_000)), Ok(400_000));
        assert!(of(&tiny(3_000_000)).unwrap_err().contains("MB of memory"));
    }

    #[test]
    fn a_wrong_count_in_the_header_takes_neither_memory_nor_time() {
        let of = |text: &str| read_ply(text.as_bytes()).map_err(|e| e.to_string());
        let xyz = "property float x\nproperty float y\nproperty float z\nend_header\n";
        let binary = "ply\nformat binary_little_endian 1.0\n";
        assert!(
            of(&format!("{binary}element vertex 99999999999\n{xyz}")).unwrap_err().contains("99999999999")
        );
        assert!(
            of(&format!("{binary}element vertex 2147483648\n{xyz}abc")).unwrap_err().contains("file ends")
        );
        let idle = "element idle 2147483648\n".repeat(20);
        let read = of(&format!("ply\nformat ascii 1.0\n{idle}element vertex 1\n{xyz}1 2 3\n")).unwrap();
        assert_eq!(read.points[0].position, Point3::new(1.0, 2.0, 3.0));
    }
}
