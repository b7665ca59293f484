//! Meshes from Wavefront OBJ.

use std::io::{BufRead, BufReader, Read};

use nalgebra::Point3;

use super::budget::{Budget, LONGEST_LINE, Metered};
use super::recognise::refuse_others;
use crate::cloud::{CloudPoint, PointCloud};
use crate::error::{Error, ErrorSubject, Result};

fn malformed(line: usize, detail: impl std::fmt::Display) -> Error {
    Error::malformed(ErrorSubject::Obj, format!("line {line}: {detail}"))
}

/// Reads vertices (with colours, where they stand behind the coordinates) and faces; polygons are split into triangle fans.
/// Normals, textures, materials, groups and lines are ignored.
///
/// # Errors
/// [`Error::Malformed`] naming the line; [`Error::Io`] when the stream fails.
pub fn read_obj(input: impl Read) -> Result<PointCloud> {
    let budget = Budget::of_stream(ErrorSubject::Obj);
    let mut input = BufReader::new(Metered::new(input, &budget));
    let start = input.fill_buf().map_err(|e| Error::reading(ErrorSubject::Obj, e))?;
    refuse_others(start, ErrorSubject::Obj, &["an OBJ"])?;
    let mut cloud = PointCloud::default();
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
                face(words, line, &mut cloud)?;
                budget.keep_list::<[u32; 3]>(cloud.triangles.len() - before)?;
            }
            _ => {}
        }
    }
    if cloud.points.is_empty() {
        return Err(Error::malformed(ErrorSubject::Obj, "no vertices (lines that begin with v)"));
    }
    Ok(cloud)
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
fn face<'a>(words: impl Iterator<Item = &'a str>, line: usize, cloud: &mut PointCloud) -> Result<()> {
    let count = cloud.points.len();
    let mut corners = Vec::new();
    for word in words {
        let number = word.split('/').next().unwrap_or_default();
        let corner = match number.parse::<i64>() {
            Ok(n) if n > 0 && n as u64 <= count as u64 => n as usize - 1,
            Ok(n) if n < 0 && n.unsigned_abs() <= count as u64 => count - n.unsigned_abs() as usize,
            _ => return Err(malformed(line, format!("\"{word}\" is none of the {count} vertices so far"))),
        };
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
