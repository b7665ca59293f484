//! Clouds as plain text, one point per line.

use std::io::Write;

use super::buffered::buffered;
use crate::cloud::PointCloud;
use crate::error::{ErrorSubject, Result};

/// Writes `x y z red green blue` per point (mm to a tenth of a micrometre, colours 0–255), separated by spaces, without
/// a header. The format has no triangles.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) when the stream fails.
pub fn write_xyz(cloud: &PointCloud, output: impl Write) -> Result<()> {
    buffered(ErrorSubject::Xyz, output, |out| {
        for p in &cloud.points {
            let ([r, g, b], x) = (p.color, p.position);
            writeln!(out, "{:.4} {:.4} {:.4} {r} {g} {b}", x.x, x.y, x.z)?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::test_cloud;

    #[test]
    fn a_line_holds_position_and_colour() {
        let mut bytes = Vec::new();
        write_xyz(&test_cloud(), &mut bytes).unwrap();
        assert_eq!(
            String::from_utf8(bytes).unwrap(),
            "0.0000 -0.5000 1000.2500 0 2 255\n1.0000 -0.5000 1000.2500 1 2 255\n\
             2.0000 -0.5000 1000.2500 2 2 255\n3.0000 -0.5000 1000.2500 3 2 255\n"
        );
        let mut none = Vec::new();
        write_xyz(&PointCloud::default(), &mut none).unwrap();
        assert!(none.is_empty());
    }
}
