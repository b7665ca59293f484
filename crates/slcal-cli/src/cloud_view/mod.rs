//! Clouds as the pages draw them: the WebGL view, and the bytes that it takes.

use slcal_core::PointCloud;

/// First bytes and version of a packed cloud.
const MAGIC: &[u8; 4] = b"SLCV";
const VERSION: u32 = 1;

/// A cloud as `cloud_view.js` takes it, little endian: magic, version, numbers of points and triangles, positions (3 × f32, mm), σ
/// (f32, mm), colours (4 × u8; alpha 0 where it is not known), triangles (3 × u32). Points that are not finite are left out,
/// with their triangles.
pub(crate) fn packed(cloud: &PointCloud) -> Vec<u8> {
    let mut place = vec![None; cloud.points.len()];
    let mut kept = Vec::with_capacity(cloud.points.len());
    for (i, point) in cloud.points.iter().enumerate() {
        if point.position.iter().all(|x| x.is_finite()) {
            place[i] = Some(kept.len() as u32);
            kept.push(point);
        }
    }
    let corner = |i: u32| place.get(i as usize).copied().flatten();
    let triangles: Vec<[u32; 3]> =
        cloud.triangles.iter().filter_map(|t| Some([corner(t[0])?, corner(t[1])?, corner(t[2])?])).collect();
    let colored = kept.iter().any(|p| p.color != kept[0].color);
    let mut bytes = Vec::with_capacity(16 + 20 * kept.len() + 12 * triangles.len());
    bytes.extend_from_slice(MAGIC);
    for word in [VERSION, kept.len() as u32, triangles.len() as u32] {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    for x in kept.iter().flat_map(|p| p.position.iter()) {
        bytes.extend_from_slice(&(*x as f32).to_le_bytes());
    }
    for point in &kept {
        let sigma = if point.sigma_mm > 0.0 { point.sigma_mm as f32 } else { f32::NAN };
        bytes.extend_from_slice(&sigma.to_le_bytes());
    }
    for point in &kept {
        let [r, g, b] = point.color;
        bytes.extend_from_slice(&[r, g, b, if colored { 255 } else { 0 }]);
    }
    for index in triangles.as_flattened() {
        bytes.extend_from_slice(&index.to_le_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use slcal_core::CloudPoint;

    use super::*;

    #[test]
    fn what_is_nowhere_is_left_out_with_its_triangles() {
        let at = |x: f64, color| CloudPoint {
            color,
            sigma_mm: 0.5,
            ..CloudPoint::at(Point3::new(x, 2.0, 1000.0))
        };
        let points = vec![at(f64::NAN, [0; 3]), at(1.0, [9, 8, 7]), at(3.0, [0; 3]), at(5.0, [0; 3])];
        let cloud = PointCloud { points, triangles: vec![[1, 2, 3], [0, 1, 2]], ..PointCloud::default() };
        let bytes = packed(&cloud);
        let word = |i: usize| u32::from_le_bytes(*bytes[4 * i..].first_chunk().unwrap());
        assert_eq!((&bytes[..4], word(1), word(2), word(3)), (MAGIC.as_slice(), VERSION, 3, 1));
        assert_eq!(bytes.len(), 16 + 20 * 3 + 12);
        assert_eq!(f32::from_bits(word(4)), 1.0);
        assert_eq!(f32::from_bits(word(13)), 0.5);
        assert_eq!(bytes[64..68], [9, 8, 7, 255]);
        assert_eq!([word(19), word(20), word(21)], [0, 1, 2]);
    }

    #[test]
    fn one_colour_is_no_colour() {
        let cloud = PointCloud { points: vec![CloudPoint::at(Point3::origin()); 2], ..PointCloud::default() };
        let bytes = packed(&cloud);
        assert_eq!(bytes[16 + 24 + 8..], [0; 8]);
        assert!(f32::from_le_bytes(*bytes[16 + 24..].first_chunk().unwrap()).is_nan());
        assert_eq!(packed(&PointCloud::default()).len(), 16);
    }
}
