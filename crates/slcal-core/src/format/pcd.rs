//! Clouds as PCD, the format of the Point Cloud Library.

use std::io::Write;

use super::buffered::buffered;
use crate::cloud::PointCloud;
use crate::error::{ErrorSubject, Result};

/// Writes a cloud as PCD version 0.7 with binary data: `x y z` (mm), `rgb` (packed as the Point Cloud Library does: the
/// bits of 0x00RRGGBB in a float), `sigma` (mm), `slit`, `confidence` and `noise` (mm), and
/// `normal_x normal_y normal_z` when the cloud has normals. `VIEWPOINT` is the camera's centre; the format has no triangles.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) when the stream fails.
pub fn write_pcd(cloud: &PointCloud, output: impl Write) -> Result<()> {
    buffered(ErrorSubject::Pcd, output, |out| {
        let (n, c) = (cloud.points.len(), cloud.camera_centre);
        writeln!(
            out,
            "# .PCD v0.7 - Point Cloud Data file format\n# units mm\n# frame {}\nVERSION 0.7",
            cloud.frame
        )?;
        let normals = cloud.known_normals();
        let [names, sizes, types, counts] = match normals {
            Some(_) => [" normal_x normal_y normal_z", " 4 4 4", " F F F", " 1 1 1"],
            None => [""; 4],
        };
        writeln!(out, "FIELDS x y z rgb sigma slit confidence noise{names}\nSIZE 4 4 4 4 4 2 4 4{sizes}")?;
        writeln!(out, "TYPE F F F F F U F F{types}\nCOUNT 1 1 1 1 1 1 1 1{counts}\nWIDTH {n}\nHEIGHT 1")?;
        writeln!(out, "VIEWPOINT {} {} {} 1 0 0 0\nPOINTS {n}\nDATA binary", c.x, c.y, c.z)?;
        for (i, p) in cloud.points.iter().enumerate() {
            for x in p.position.iter() {
                out.write_all(&(*x as f32).to_le_bytes())?;
            }
            let [r, g, b] = p.color;
            out.write_all(&[b, g, r, 0])?;
            out.write_all(&(p.sigma_mm as f32).to_le_bytes())?;
            out.write_all(&p.slit.unwrap_or(0).to_le_bytes())?;
            out.write_all(&(p.confidence as f32).to_le_bytes())?;
            out.write_all(&(p.noise_mm as f32).to_le_bytes())?;
            for x in normals.iter().flat_map(|n| n[i].iter()) {
                out.write_all(&x.to_le_bytes())?;
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

    /// Reads the file according to the format's specification: fields by name, sizes and types from the header.
    fn parse(bytes: &[u8]) -> (Vec<String>, Vec<Vec<[u8; 4]>>) {
        let end = b"DATA binary\n";
        let at = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let header: Vec<String> =
            std::str::from_utf8(&bytes[..at]).unwrap().lines().map(str::to_owned).collect();
        let words = |key: &str| -> Vec<String> {
            let line = header.iter().find(|l| l.starts_with(key)).unwrap();
            line.split(' ').skip(1).map(str::to_owned).collect()
        };
        let sizes: Vec<usize> = words("SIZE ").iter().map(|s| s.parse().unwrap()).collect();
        assert_eq!(words("FIELDS ").len(), sizes.len());
        assert_eq!(words("TYPE ").len(), sizes.len());
        assert_eq!(words("WIDTH "), words("POINTS "));
        let count: usize = words("POINTS ")[0].parse().unwrap();
        assert_eq!(bytes.len() - at, count * sizes.iter().sum::<usize>());
        let mut rest = &bytes[at..];
        let records = (0..count)
            .map(|_| {
                sizes
                    .iter()
                    .map(|&size| {
                        let mut field = [0; 4];
                        field[..size].copy_from_slice(&rest[..size]);
                        rest = &rest[size..];
                        field
                    })
                    .collect()
            })
            .collect();
        (header, records)
    }

    #[test]
    fn the_header_describes_the_records() {
        let mut bytes = Vec::new();
        let cloud = test_cloud();
        write_pcd(&cloud, &mut bytes).unwrap();
        let (header, records) = parse(&bytes);
        assert!(header.iter().any(|l| l == "VERSION 0.7"));
        assert!(header.iter().any(|l| l == "VIEWPOINT 0 0 0 1 0 0 0"));
        assert_eq!(records.len(), cloud.points.len());
        for (record, p) in records.iter().zip(&cloud.points) {
            let float = |i: usize| f64::from(f32::from_le_bytes(record[i]));
            assert_eq!([float(0), float(1), float(2)], [p.position.x, p.position.y, p.position.z]);
            let [r, g, b] = p.color.map(u32::from);
            assert_eq!(u32::from_le_bytes(record[3]), r << 16 | g << 8 | b);
            assert_eq!((float(4), float(6), float(7)), (p.sigma_mm, p.confidence, p.noise_mm));
            assert_eq!(u32::from_le_bytes(record[5]), u32::from(p.slit.unwrap_or(0)));
        }
    }

    #[test]
    fn normals_follow_when_there_are_any() {
        let mut cloud = test_cloud();
        cloud.normals = (0..4).map(|i| Vector3::new(0.25 * i as f32, 0.5, -0.75)).collect();
        let mut bytes = Vec::new();
        write_pcd(&cloud, &mut bytes).unwrap();
        let (header, records) = parse(&bytes);
        let fields = header.iter().find(|l| l.starts_with("FIELDS")).unwrap();
        assert!(fields.ends_with(" noise normal_x normal_y normal_z"), "{fields}");
        for (record, normal) in records.iter().zip(&cloud.normals) {
            let float = |i: usize| f32::from_le_bytes(record[i]);
            assert_eq!([float(8), float(9), float(10)], [normal.x, normal.y, normal.z]);
        }
    }

    #[test]
    fn a_cloud_in_the_sheets_frame_says_where_the_camera_stood() {
        let mut cloud = test_cloud();
        cloud.frame = crate::cloud::Frame::Plane;
        cloud.camera_centre = nalgebra::Point3::new(1.5, -2.0, -900.25);
        let mut bytes = Vec::new();
        write_pcd(&cloud, &mut bytes).unwrap();
        let (header, _) = parse(&bytes);
        assert!(header.iter().any(|l| l == "# frame plane"));
        assert!(header.iter().any(|l| l == "VIEWPOINT 1.5 -2 -900.25 1 0 0 0"));
        bytes.clear();
        write_pcd(&PointCloud::default(), &mut bytes).unwrap();
        assert!(parse(&bytes).1.is_empty());
    }
}
