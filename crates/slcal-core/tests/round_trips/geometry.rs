//! Pixel ↔ ray, pose and homography ↔ inverse.

use nalgebra::{Matrix3, Point2, Point3, Rotation3, Vector2, Vector3};
use proptest::prelude::*;
use slcal_core::geometry::{Camera, Distortion, Homography, Intrinsics, Pose};

pub(crate) fn vector(most: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-most..most, -most..most, -most..most].prop_map(Vector3::from)
}

pub(crate) fn pose() -> impl Strategy<Value = Pose> {
    (vector(3.0), vector(2000.0))
        .prop_map(|(turn, translation)| Pose { rotation: Rotation3::new(turn), translation })
}

/// Lenses that fold nothing within a field of view of 90°.
fn distortion() -> impl Strategy<Value = Distortion> {
    [-0.15..0.3, -0.02..0.1, -0.005..0.005, -0.005..0.005, -0.01..0.02].prop_map(Distortion::from_array)
}

fn camera() -> impl Strategy<Value = Camera> {
    (500.0..3000.0, 0.9..1.1, -3.0..3.0, 0.0..1000.0, -500.0..1500.0, distortion()).prop_map(
        |(fx, aspect, skew, cx, cy, distortion)| Camera {
            width: 1000,
            height: 800,
            intrinsics: Intrinsics { fx, fy: fx * aspect, skew, cx, cy },
            distortion,
        },
    )
}

fn direction() -> impl Strategy<Value = Vector2<f64>> {
    [-0.7..0.7, -0.7..0.7].prop_map(Vector2::from)
}

proptest! {
    #[test]
    fn undistorting_takes_distortion_back(lens in distortion(), x in direction()) {
        let back = lens.undistort(lens.distort(x)).unwrap();
        prop_assert!((back - x).norm() < 1e-9, "{back} {x}");
    }

    #[test]
    fn the_jacobian_of_distortion_is_its_difference_quotient(lens in distortion(), x in direction()) {
        let jacobian = lens.jacobian(x);
        let (undistorted, there) = lens.undistort_with_jacobian(lens.distort(x)).unwrap();
        prop_assert!((undistorted - x).norm() < 1e-9 && (there - jacobian).norm() < 1e-8);
        let step = 1e-5;
        for axis in 0..2 {
            let mut h = Vector2::zeros();
            h[axis] = step;
            let numeric = (lens.distort(x + h) - lens.distort(x - h)) / (2.0 * step);
            prop_assert!((numeric - jacobian.column(axis)).norm() < 1e-8, "{numeric} {jacobian}");
        }
    }

    #[test]
    fn a_pixel_leads_back_to_the_direction_of_its_point(camera in camera(), x in direction(), depth in 1.0..5000.0) {
        let point = Point3::new(x.x * depth, x.y * depth, depth);
        let pixel = camera.project(&point).unwrap();
        let back = camera.undistort(pixel).unwrap();
        prop_assert!((back - x).norm() < 1e-9, "{back} {x}");
        let bearing = camera.bearing(pixel).unwrap();
        prop_assert!(bearing.cross(&point.coords).norm() < 1e-8 * depth * bearing.norm());
        prop_assert!(bearing.z > 0.0);
    }

    #[test]
    fn intrinsics_survive_their_matrix(camera in camera()) {
        prop_assert_eq!(Intrinsics::from_matrix(&camera.intrinsics.matrix()).unwrap(), camera.intrinsics);
    }

    #[test]
    fn a_pose_and_its_inverse_cancel(a_from_b in pose(), b_from_c in pose(), p in vector(1000.0)) {
        let p = Point3::from(p);
        let there = a_from_b.compose(&b_from_c).transform(&p);
        prop_assert!((there - a_from_b.transform(&b_from_c.transform(&p))).norm() < 1e-8);
        prop_assert!((a_from_b.inverse().transform(&a_from_b.transform(&p)) - p).norm() < 1e-8);
        prop_assert!(a_from_b.transform(&a_from_b.inverse().centre()).coords.norm() < 1e4);
        prop_assert!(a_from_b.transform(&a_from_b.centre()).coords.norm() < 1e-8);
        let same = Pose::from_matrix(a_from_b.rotation.matrix(), a_from_b.translation).unwrap();
        prop_assert!((same.transform(&p) - a_from_b.transform(&p)).norm() < 1e-8);
    }

    #[test]
    fn a_homography_and_its_inverse_cancel(
        place in pose(), turn in [-1.0..1.0, -1.0..1.0], x in [0.0..600.0, 0.0..400.0], f in 500.0..3000.0,
    ) {
        // That of a plane in front of a camera.
        let r = Rotation3::new(Vector3::new(turn[0], turn[1], 0.3));
        let columns = [r.matrix().column(0).into_owned(), r.matrix().column(1).into_owned(), place.translation / 10.0 + Vector3::z() * 1500.0];
        let h = Homography(Matrix3::new(f, 0.0, 640.0, 0.0, f, 480.0, 0.0, 0.0, 1.0) * Matrix3::from_columns(&columns));
        let p = Point2::from(x);
        let inverse = h.inverse().unwrap();
        prop_assert!((inverse.map(h.map(p).unwrap()).unwrap() - p).norm() < 1e-7);
        prop_assert!((inverse.compose(&h).map(p).unwrap() - p).norm() < 1e-7);
        let step = 1e-3;
        for axis in 0..2 {
            let mut d = Vector2::zeros();
            d[axis] = step;
            let numeric = (h.map(p + d).unwrap() - h.map(p - d).unwrap()) / (2.0 * step);
            prop_assert!((numeric - h.jacobian(p).column(axis)).norm() < 1e-5, "{numeric}");
        }
    }
}
