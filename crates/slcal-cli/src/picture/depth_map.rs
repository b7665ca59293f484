//! Depth images: the depth of each pixel along the camera's optical axis.

use std::path::Path;

use image::{ImageBuffer, Luma};
use slcal_core::format::write_pfm;
use slcal_core::{Frame, PointCloud, Rig};

use crate::exit::{Exit, Failure, Outcome};
use crate::io::bytes_of;

/// A depth image as the bytes of a file, by its name: `.pfm`, 32-bit numbers in mm, NaN for gaps; or `.png`, 16 bit in 0.1 mm, 0 for gaps and
/// for depths of more than 6553.5 mm.
pub(crate) fn depth_file(cloud: &PointCloud, rig: &Rig, name: &str) -> Outcome<Vec<u8>> {
    let [width, height] = rig.camera.model.size();
    let depths = depths(cloud, rig, [width as usize, height as usize]);
    if Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        let tenths =
            depths.iter().map(|mm| (10.0 * mm).round()).map(|t| if t <= 65535.0 { t as u16 } else { 0 });
        let picture = ImageBuffer::<Luma<u16>, Vec<u16>>::from_raw(width, height, tenths.collect());
        let mut bytes = std::io::Cursor::new(Vec::new());
        let written = picture.map(|p| p.write_to(&mut bytes, image::ImageFormat::Png));
        return match written {
            Some(Ok(())) => Ok(bytes.into_inner()),
            _ => Err(Failure::new(Exit::Other, format!("{name}: the depth image cannot be encoded"))),
        };
    }
    bytes_of(|out| write_pfm(width as usize, &depths, out))
}

/// Depths in mm, NaN for pixels without a point. Of several points in a pixel, the nearest one is seen.
fn depths(cloud: &PointCloud, rig: &Rig, [width, height]: [usize; 2]) -> Vec<f32> {
    let to_camera = match cloud.frame {
        Frame::Camera => None,
        Frame::Plane => rig.views.first().map(|view| view.camera_from_sheet),
    };
    let mut depths = vec![f32::NAN; width * height];
    for point in &cloud.points {
        let depth = to_camera.map_or(point.position, |pose| pose.transform(&point.position)).z as f32;
        let [x, y] = [point.pixel.x, point.pixel.y].map(f64::round);
        if x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64 {
            let at = &mut depths[y as usize * width + x as usize];
            *at = at.min(depth);
        }
    }
    depths
}

#[cfg(test)]
mod tests {
    use super::*;
    use slcal_core::nalgebra::{Point2, Point3};
    use slcal_core::{CloudPoint, format::read_rig};

    #[test]
    fn gaps_are_marked_and_the_nearest_point_is_seen() {
        let rig = read_rig(include_bytes!("../../demo/truth_rig.json").as_slice()).unwrap();
        let point = |u: f64, z: f64| CloudPoint {
            pixel: Point2::new(u, 0.0),
            ..CloudPoint::at(Point3::new(9.0, 9.0, z))
        };
        let cloud = PointCloud {
            points: vec![point(1.2, 700.04), point(0.9, 650.0), point(3.0, 9000.0)],
            ..PointCloud::default()
        };
        let png = image::load_from_memory(&depth_file(&cloud, &rig, "a.png").unwrap()).unwrap().into_luma16();
        assert_eq!([0, 1, 2, 3].map(|x| png.get_pixel(x, 0).0[0]), [0, 6500, 0, 0]);
        let pfm = depth_file(&cloud, &rig, "a.pfm").unwrap();
        let row = &pfm[pfm.len() - 4 * rig.camera.model.width as usize..];
        let value = |x: usize| f32::from_le_bytes(row[4 * x..][..4].try_into().unwrap());
        assert!(value(0).is_nan() && value(1) == 650.0 && value(3) == 9000.0);
    }
}
