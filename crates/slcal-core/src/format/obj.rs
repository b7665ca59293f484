//! Clouds and meshes as Wavefront OBJ.

use std::io::Write;

use super::buffered::buffered;
use crate::cloud::PointCloud;
use crate::error::{ErrorSubject, Result};

/// Writes `v x y z r g b` per point (mm to a tenth of a micrometre; colours 0–1 behind the coordinates, as most viewers
/// read them), `vn x y z` per point when the cloud has normals, and `f a b c` per triangle (`f a//a b//b c//c` with
/// normals), with indices from one.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) when the stream fails.
pub fn write_obj(cloud: &PointCloud, output: impl Write) -> Result<()> {
    buffered(ErrorSubject::Obj, output, |out| {
        writeln!(out, "# units mm\n# frame {}", cloud.frame)?;
        for p in &cloud.points {
            let ([r, g, b], x) = (p.color.map(|c| f64::from(c) / 255.0), p.position);
            writeln!(out, "v {:.4} {:.4} {:.4} {r:.4} {g:.4} {b:.4}", x.x, x.y, x.z)?;
        }
        let normals = cloud.known_normals();
        for n in normals.into_iter().flatten() {
            writeln!(out, "vn {:.4} {:.4} {:.4}", n.x, n.y, n.z)?;
        }
        for t in &cloud.triangles {
            let [a, b, c] = t.map(|i| u64::from(i) + 1);
            match normals {
                Some(_) => writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?,
                None => writeln!(out, "f {a} {b} {c}")?,
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::for_tests::test_cloud;
    use crate::format::read_obj;

    #[test]
    fn vertices_carry_colours_and_faces_count_from_one() {
        let mut bytes = Vec::new();
        write_obj(&test_cloud(), &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[..3],
            ["# units mm", "# frame camera", "v 0.0000 -0.5000 1000.2500 0.0000 0.0078 1.0000"]
        );
        assert_eq!(lines[6..], ["f 1 2 3", "f 1 3 4"]);
    }

    #[test]
    fn normals_have_the_numbers_of_their_points() {
        let mut cloud = test_cloud();
        cloud.normals = vec![Vector3::new(0.6, 0.0, -0.8); 4];
        let mut bytes = Vec::new();
        write_obj(&cloud, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[6..10], ["vn 0.6000 0.0000 -0.8000"; 4]);
        assert_eq!(lines[10..], ["f 1//1 2//2 3//3", "f 1//1 3//3 4//4"]);
        assert_eq!(read_obj(text.as_bytes()).unwrap().triangles, cloud.triangles);
    }
}
