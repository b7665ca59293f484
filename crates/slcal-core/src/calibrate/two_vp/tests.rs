use approx::assert_relative_eq;

use super::*;
use crate::calibrate::tests::scene::{observe, pose as tilted, rig, rng, size};
use crate::calibrate::{CalibrateConfig, Method, calibrate_observations};
use crate::error::ErrorSubject;

fn finite(x: f64, y: f64) -> ProjectivePoint {
    ProjectivePoint(Vector3::new(x, y, 1.0))
}

/// Table 2 of the paper, in 10⁵ px: camera V_x, V_y, projector V_x, V_y.
const DOORS: [[[f64; 2]; 4]; 4] = [
    [[0.768, 0.031], [0.013, 0.165], [0.032, 0.007], [-0.025, -0.864]],
    [[2.272, 0.144], [0.013, 0.162], [0.040, 0.006], [-0.091, -2.777]],
    [[-1.896, -0.173], [0.012, 0.161], [0.053, 0.006], [-0.036, -1.371]],
    [[-0.531, -0.069], [0.013, 0.164], [0.082, 0.005], [-0.039, -1.297]],
];

#[test]
fn the_doors_of_table_2_give_the_published_focal_lengths() {
    // With rounded vanishing points: a 35 mm lens on the camera; the projector four times what its zoom lens has,
    // because its principal point is not at the centre.
    let expected = [[7580.0, 5960.0], [7390.0, 9650.0], [6940.0, 7020.0], [8120.0, 7010.0]];
    for (door, [camera, projector]) in DOORS.iter().zip(expected) {
        let v = door.map(|[x, y]| finite(x * 1e5, y * 1e5));
        let c =
            focal(&VanishingPoints { x: v[0], y: v[1] }, Point2::new(2376.0, 1584.0), ErrorSubject::Camera)
                .unwrap();
        let p =
            focal(&VanishingPoints { x: v[2], y: v[3] }, Point2::new(512.0, 384.0), ErrorSubject::Projector)
                .unwrap();
        // The vanishing points are printed to two or three digits.
        assert!((c / camera - 1.0).abs() < 5e-3, "camera {c}");
        assert!((p / projector - 1.0).abs() < 5e-3, "projector {p}");
    }
}

#[test]
fn the_projector_of_table_2_has_lens_shift() {
    // Orthogonality of the sheet's directions, (v1 − p)·(v2 − p) + f² = 0, with cx at the centre and the focal length that
    // the projector's zoom has: the lower of the two cy (the other one lies above the vanishing points' mean).
    let mut cys = Vec::new();
    for door in DOORS {
        let [x, y] = [door[2], door[3]].map(|[x, y]| (x * 1e5, y * 1e5));
        let at_centre = -((x.0 - 512.0) * (y.0 - 512.0) + (x.1 - 384.0) * (y.1 - 384.0));
        assert!(
            at_centre.sqrt() > 3.0 * 1850.0,
            "a zoom lens of 1500 to 1850 px came out as {}",
            at_centre.sqrt()
        );
        for f in [1500.0, 1850.0] {
            let (sum, product) = (x.1 + y.1, x.1 * y.1 + (x.0 - 512.0) * (y.0 - 512.0) + f * f);
            let root = (sum * sum / 4.0 - product).sqrt();
            cys.push(sum / 2.0 + root);
        }
    }
    // Near the lower border of 768 rows on every door.
    assert!(cys.iter().all(|cy| (705.0..=770.0).contains(cy)), "{cys:?}");
}

#[test]
fn a_negative_square_is_imaginary_and_a_point_at_infinity_degenerate() {
    let v = VanishingPoints { x: finite(1000.0, 0.0), y: finite(10.0, 900.0) };
    let error = focal(&v, Point2::origin(), ErrorSubject::Camera).unwrap_err();
    assert!(
        matches!(error, Error::ImaginaryFocal { device: ErrorSubject::Camera, f_squared, .. } if f_squared == -10_000.0)
    );
    let v = VanishingPoints { x: ProjectivePoint(Vector3::x()), y: finite(10.0, 900.0) };
    assert!(matches!(focal(&v, Point2::origin(), ErrorSubject::Camera), Err(Error::Degenerate { .. })));
}

/// Noise so small that only rounding remains.
fn exact(cy: f64) -> (crate::estimate::Model, crate::Observations) {
    let truth = rig(cy, vec![tilted(25.0, 28.0)]);
    let mut o = observe(&truth, 1e-12, 1e-12, &mut rng(1));
    o.views[0].map_sigma(|_| Some(0.1), |_| Some(0.1));
    (truth, o)
}

#[test]
fn exact_corners_give_the_exact_pose_before_any_refinement() {
    let (truth, o) = exact(383.5);
    let corners = o.views[0].sheet.corners().unwrap();
    let v = vanishing_points_of_quad(&corners);
    let pp = Point2::new(639.5, 479.5);
    let f = focal(&v, pp, ErrorSubject::Camera).unwrap();
    assert_relative_eq!(f, 1500.0, epsilon = 1e-6);
    let r = rotation(&v, f, pp, &corners).unwrap();
    assert_relative_eq!(r, *truth.views[0].pose.rotation.matrix(), epsilon = 1e-9);
    let t = translation(&r, f, pp, &corners, size()).unwrap();
    assert_relative_eq!(t, truth.views[0].pose.translation, epsilon = 1e-6);
}

#[test]
fn the_rectified_pattern_has_the_vanishing_points_of_the_sheet() {
    // Fig. 14: what is projected keystone-free has sides parallel to the sheet's.
    let (truth, o) = exact(383.5);
    let v = vanishing_points_of_quad(&o.views[0].sheet.corners().unwrap());
    let at = |k: usize| o.views[0].pairs[k].camera;
    let outline = [at(0), at(8), at(53), at(45)];
    let rectified = keystone_removed(&outline, &v);
    let again = vanishing_points(&rectified);
    for (a, b) in [(again.x, v.x), (again.y, v.y)] {
        let (a, b) = (a.pixel().unwrap(), b.pixel().unwrap());
        assert!((a - b).norm() < 1e-6 * b.coords.norm(), "{a} {b}");
    }
    // On the sheet itself it is a rectangle.
    let k = truth.camera.intrinsics.matrix();
    let pose = &truth.views[0].pose;
    let r = pose.rotation.matrix();
    let h = Homography(
        k * Matrix3::from_columns(&[r.column(0).into_owned(), r.column(1).into_owned(), pose.translation]),
    );
    let on_sheet = rectified.map(|p| h.inverse().unwrap().apply(p).pixel().unwrap());
    for (a, b, axis) in [(0, 1, 1), (3, 2, 1), (0, 3, 0), (1, 2, 0)] {
        assert!((on_sheet[a][axis] - on_sheet[b][axis]).abs() < 1e-6, "{on_sheet:?}");
    }
}

#[test]
fn keystone_removal_holds_with_a_vanishing_point_at_infinity() {
    let outline =
        [Point2::new(10.0, 12.0), Point2::new(90.0, 10.0), Point2::new(95.0, 70.0), Point2::new(5.0, 80.0)];
    let v = VanishingPoints { x: ProjectivePoint(Vector3::x()), y: finite(50.0, 1000.0) };
    let q = keystone_removed(&outline, &v).map(|p| p.pixel().unwrap());
    assert_relative_eq!(q[0], outline[0], epsilon = 1e-9);
    assert_relative_eq!(q[1].y, q[0].y, epsilon = 1e-9);
    assert_relative_eq!(q[2].y, q[3].y, epsilon = 1e-9);
}

#[test]
fn a_centred_projector_is_found_and_a_shifted_one_is_wrong_and_says_so() {
    let config = CalibrateConfig { method: Method::TwoVp, ..CalibrateConfig::default() };
    let (truth, o) = exact(383.5);
    let c = calibrate_observations(&o, &config).unwrap().rig;
    assert_relative_eq!(c.camera.model.intrinsics.fx, 1500.0, epsilon = 1e-5);
    assert_relative_eq!(c.projector.unwrap().device.model.intrinsics.fx, 1700.0, epsilon = 1e-4);
    let stereo = c.projector.unwrap().from_camera.pose;
    assert_relative_eq!(stereo.translation, truth.projector_from_camera.translation, epsilon = 1e-4);
    assert_eq!(c.method, "two-vp");
    let quality = c.quality.unwrap();
    assert!(!quality.warnings.iter().any(|w| w.code == "two-vp-misfit"), "{:?}", quality.warnings);

    let (_, o) = exact(768.0);
    match calibrate_observations(&o, &config) {
        Err(e) => assert!(matches!(e, Error::ImaginaryFocal { device: ErrorSubject::Projector, .. }), "{e}"),
        Ok(c) => {
            let f = c.rig.projector.unwrap().device.model.intrinsics.fx;
            assert!((f / 1700.0 - 1.0).abs() > 0.2, "{f}");
            let quality = c.rig.quality.unwrap();
            assert!(quality.warnings.iter().any(|w| w.code == "two-vp-misfit"), "{:?}", quality.warnings);
            assert!(quality.verdict >= crate::Verdict::Weak);
        }
    }
}

#[test]
fn sigma_is_the_scatter_over_noise() {
    let config = CalibrateConfig { method: Method::TwoVp, ..CalibrateConfig::default() };
    let truth = rig(383.5, vec![tilted(25.0, 28.0)]);
    let mut rng = rng(5);
    let (mut sums, n) = ([0.0; 2], 200);
    let mut claimed = [0.0; 2];
    for _ in 0..n {
        let o = observe(&truth, 0.2, 0.1, &mut rng);
        let c = calibrate_observations(&o, &config).unwrap().rig;
        let (camera, projector) = (c.camera, c.projector.unwrap().device);
        sums[0] += (camera.model.intrinsics.fx - 1500.0).powi(2);
        sums[1] += (projector.model.intrinsics.fx - 1700.0).powi(2);
        claimed = [camera.sigma.unwrap().focal_px, projector.sigma.unwrap().focal_px];
    }
    for (sum, sigma) in sums.iter().zip(claimed) {
        let ratio = (sum / f64::from(n)).sqrt() / sigma;
        // The scatter of 200 draws is itself known to 5 %; three of those.
        assert!((0.85..1.15).contains(&ratio), "{ratio}");
    }
    // Table of the closed form's errors: 0.20 % at this tilt and noise.
    assert!((claimed[0] / 1500.0 - 0.0020).abs() < 0.0003, "{claimed:?}");
}
