//! Meshes from Wavefront OBJ.

use std::io::{BufRead, BufReader, Read};

use nalgebra::{Point3, Vector3};

use super::budget::{Budget, LONGEST_LINE, Metered};
use super::recognise::refuse_others;
use crate::cloud::{CloudPoint, PointCloud};
use crate::error::{Error, ErrorSubject, Result};

fn malformed(line: usize, detail: impl std::fmt::Display) -> Error {
    Error::malformed(ErrorSubject::Obj, format!("line {line}: {detail}"))
}

/// Reads vertices (with colours, where they stand behind the coordinates), normals, and faces; polygons are split into triangle fans.
/// Textures, materials, groups and lines are ignored.
///
/// The normal of a vertex is the unit vector along the sum of those that faces give it; where no face names any, and there are as many
/// normals as vertices, they belong together in their order. A vertex without one has zero.
///
/// # Errors
/// [`Error::Malformed`] naming the line; [`Error::Io`] when the stream fails.
pub fn read_obj(input: impl Read) -> Result<PointCloud> {
    let budget = Budget::of_stream(ErrorSubject::Obj);
    let mut input = BufReader::new(Metered::new(input, &budget));
    let start = input.fill_buf().map_err(|e| Error::reading(ErrorSubject::Obj, e))?;
    refuse_others(start, ErrorSubject::Obj, &["an OBJ"])?;
    let mut cloud = PointCloud::default();
    let mut normals = Normals::default();
    let mut bytes = Vec::new();
    for line in 1.. {
        bytes.clear();
        let read = (&mut input).take(LONGEST_LINE as u64).read_until(b'\n', &mut bytes);
        let read = read.map_err(|e| Error::reading(ErrorSubject::Obj, e))?;
        if read == 0 {
            break;
        }
        if read == LONGEST_LINE {
            return Err(malformed(line, format!("more than {LONGEST_LINE} bytes")));
        }
        let text = String::from_utf8_lossy(&bytes);
        let mut words = text.split_whitespace();
        match words.next() {
            Some("v") => {
                budget.keep_list::<CloudPoint>(1)?;
                cloud.points.push(vertex(words, line)?);
            }
            Some("f") => {
                let before = cloud.triangles.len();
                face(words, line, &mut cloud, &mut normals)?;
                budget.keep_list::<[u32; 3]>(cloud.triangles.len() - before)?;
            }
            Some("vn") => {
                budget.keep_list::<Vector3<f32>>(1)?;
                normals.listed.push(normal(words, line)?);
            }
            _ => {}
        }
    }
    if cloud.points.is_empty() {
        return Err(Error::malformed(ErrorSubject::Obj, "no vertices (lines that begin with v)"));
    }
    if !normals.of_faces.is_empty() {
        budget.keep_list::<Vector3<f32>>(cloud.points.len())?;
    }
    cloud.normals = normals.of_vertices(cloud.points.len());
    Ok(cloud)
}

/// The normals of a file.
#[derive(Default)]
struct Normals {
    /// In the order of the file.
    listed: Vec<Vector3<f32>>,
    /// For each vertex the sum of those that faces give it; as long as the last vertex that has one.
    of_faces: Vec<Vector3<f32>>,
}

impl Normals {
    /// A corner of a face: a vertex, and what follows its second slash. A number without a normal is ignored, as are textures.
    fn add(&mut self, vertex: usize, number: Option<&str>) {
        let n = number.and_then(|word| word.parse::<i64>().ok());
        let at = n.and_then(|n| match n {
            1.. => usize::try_from(n - 1).ok(),
            _ => usize::try_from(n.unsigned_abs()).ok().and_then(|back| self.listed.len().checked_sub(back)),
        });
        if let Some(&normal) = at.and_then(|i| self.listed.get(i)) {
            if self.of_faces.len() <= vertex {
                self.of_faces.resize(vertex + 1, Vector3::zeros());
            }
            self.of_faces[vertex] += normal;
        }
    }

    fn of_vertices(mut self, count: usize) -> Vec<Vector3<f32>> {
        let mut normals = if self.of_faces.is_empty() {
            if self.listed.len() != count {
                return Vec::new();
            }
            self.listed
        } else {
            self.of_faces.resize(count, Vector3::zeros());
            self.of_faces
        };
        for normal in &mut normals {
            *normal = normal.try_normalize(f32::MIN_POSITIVE).unwrap_or_default();
        }
        normals
    }
}

fn normal<'a>(mut words: impl Iterator<Item = &'a str>, line: usize) -> Result<Vector3<f32>> {
    let mut next = || {
        let word = words.next().unwrap_or_default();
        let number = word.parse::<f32>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| malformed(line, format!("\"{word}\" is no coordinate of a normal")))
    };
    Ok(Vector3::new(next()?, next()?, next()?))
}

fn vertex<'a>(words: impl Iterator<Item = &'a str>, line: usize) -> Result<CloudPoint> {
    let mut numbers = Vec::with_capacity(6);
    for word in words {
        let number: f64 = word.parse().map_err(|_| malformed(line, format!("\"{word}\" is not a number")))?;
        numbers.push(number);
    }
    let [x, y, z, rest @ ..] = numbers.as_slice() else {
        return Err(malformed(line, format!("a vertex of {} coordinates", numbers.len())));
    };
    let color = if let [r, g, b] = rest { [r, g, b].map(|c| (c * 255.0).round() as u8) } else { [255; 3] };
    Ok(CloudPoint { color, ..CloudPoint::at(Point3::new(*x, *y, *z)) })
}

/// A polygon of vertex indices from one, or relative to the last vertex when negative; texture and normal follow a slash.
fn face<'a>(
    words: impl Iterator<Item = &'a str>,
    line: usize,
    cloud: &mut PointCloud,
    normals: &mut Normals,
) -> Result<()> {
    let count = cloud.points.len();
    let mut corners = Vec::new();
    for word in words {
        let mut numbers = word.split('/');
        let number = numbers.next().unwrap_or_default();
        let corner = match number.parse::<i64>() {
            Ok(n) if n > 0 && n as u64 <= count as u64 => n as usize - 1,
            Ok(n) if n < 0 && n.unsigned_abs() <= count as u64 => count - n.unsigned_abs() as usize,
            _ => return Err(malformed(line, format!("\"{word}\" is none of the {count} vertices so far"))),
        };
        normals.add(corner, numbers.nth(1));
        corners.push(u32::try_from(corner).map_err(|_| malformed(line, "more than 2^32 vertices"))?);
    }
    for k in 2..corners.len() {
        cloud.triangles.push([corners[0], corners[k - 1], corners[k]]);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::test_cloud;
    use crate::format::write_obj;

    #[test]
    fn what_was_written_is_read() {
        let mut bytes = Vec::new();
        write_obj(&test_cloud(), &mut bytes).unwrap();
        let read = read_obj(bytes.as_slice()).unwrap();
        assert_eq!(read.triangles, test_cloud().triangles);
        for (a, b) in read.points.iter().zip(&test_cloud().points) {
            assert_eq!((a.position, a.color), (b.position, b.color));
        }
    }

    #[test]
    fn polygons_slashes_and_numbers_from_the_end() {
        let text = "# a square\no thing\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1/1 2/1/1 3/1/1 4//1\nf -4 -3 -2\n";
        assert_eq!(read_obj(text.as_bytes()).unwrap().triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    }

    #[test]
    fn normals_are_those_of_faces_or_in_the_order_of_the_vertices() {
        let mut cloud = test_cloud();
        cloud.normals =
            [[0.6, 0.0, -0.8], [0.0, 0.0, -1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from).into();
        let written = |cloud: &PointCloud| {
            let mut bytes = Vec::new();
            write_obj(cloud, &mut bytes).unwrap();
            read_obj(bytes.as_slice()).unwrap().normals
        };
        assert_eq!(written(&cloud), cloud.normals);
        cloud.triangles.clear();
        assert_eq!(written(&cloud), cloud.normals);
        // A corner with two normals, one counted from the end, a vertex without any, and a number that none has.
        let text =
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 2 0\nvn 0 0 2\nvn 2 0 0\nf 1//1 2/9/-1 3//7\nf 1//2 2//2 3\n";
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let expected = [[half, 0.0, half], [1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]].map(Vector3::from);
        assert_eq!(read_obj(text.as_bytes()).unwrap().normals, expected);
        // Normals that nothing refers to belong to no vertex in particular.
        assert!(read_obj("v 0 0 0\nv 1 0 0\nvn 0 0 1\n".as_bytes()).unwrap().normals.is_empty());
        let error = read_obj("v 0 0 0\nvn 0 1\n".as_bytes()).unwrap_err().to_string();
        assert!(error.contains("line 2") && error.contains("normal"), "{error}");
    }

    #[test]
    fn long_lines_are_refused() {
        let error =
            read_obj(format!("v 0 0 0\n#{}", "x".repeat(1 << 20)).as_bytes()).unwrap_err().to_string();
        assert!(error.contains("line 2: more than 1048576 bytes"), "{error}");
    }

    #[test]
    fn what_is_wrong_is_named_by_its_line() {
        for text in ["v 0 0\n", "v 0 0 a\n", "v 0 0 0\nf 1 2 3\n", "v 0 0 0\nf 0 1 1\n", "", "hello\n"] {
            let error = read_obj(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains("malformed OBJ"), "{error}");
        }
        let error = read_obj("v 0 0 0\nf 1 1 -2\n".as_bytes()).unwrap_err().to_string();
        assert!(error.contains("line 2"), "{error}");
    }
}
