//! Clouds and meshes as Wavefront OBJ.

use std::io::Write;

use super::buffered::buffered;
use crate::cloud::PointCloud;
use crate::error::{ErrorSubject, Result};

/// Writes `v x y z r g b` per point (mm to a tenth of a micrometre; colours 0–1 behind the coordinates, as most viewers
/// read them) and `f a b c` per triangle, with indices from one.
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
        for t in &cloud.triangles {
            let [a, b, c] = t.map(|i| u64::from(i) + 1);
            writeln!(out, "f {a} {b} {c}")?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::test_cloud;

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
}
