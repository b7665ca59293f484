//! Bent sheets against closed forms.

use nalgebra::{Point2, Point3, Rotation3, Vector3};

use super::*;

const A2: RectangleSize = RectangleSize { width_mm: 594.0, height_mm: 420.0 };

fn sheet(text: &str) -> BentSheet {
    BentSheet::new(&text.parse().unwrap(), A2).unwrap()
}

/// Length of the image of a straight line on the flat sheet, by chords and Richardson's extrapolation.
fn length(sheet: &BentSheet, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let chords = |n: u32| {
        let at = |i: u32| sheet.point(a + (b - a) * (f64::from(i) / f64::from(n)));
        (0..n).map(|i| (at(i + 1) - at(i)).norm()).sum::<f64>()
    };
    let (coarse, fine) = (chords(1000), chords(2000));
    fine + (fine - coarse) / 3.0
}

#[test]
fn cylinders_keep_the_length_of_every_line() {
    for text in
        ["0.5%", "-3mm,20", "42mm,90", "2mm,8,wave", "-0.4%,90,wave", "42mm,-50,wave", "0mm", "0mm,9,wave"]
    {
        let bent = sheet(text);
        let [tl, tr, br, bl] = A2.corners();
        let lines = [(tl, tr), (tr, br), (br, bl), (bl, tl), (tl, br), (tr, bl)];
        let inside = (Point2::new(100.0, 50.0), Point2::new(333.0, 400.0));
        for (a, b) in lines.into_iter().chain([inside]) {
            let error = length(&bent, a, b) / (b - a).norm() - 1.0;
            assert!(error.abs() < 1e-9, "{text}: {error:e}");
        }
    }
}

#[test]
fn a_twist_keeps_the_lengths_of_its_sides_to_second_order() {
    for (text, most) in [("1mm,0,twist", 1e-9), ("-3mm,90,twist", 1e-7), ("0mm,0,twist", 1e-13)] {
        let bent = sheet(text);
        let corners = A2.corners();
        for i in 0..4 {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            let error = length(&bent, a, b) / (b - a).norm() - 1.0;
            assert!(error.abs() < most, "{text}: {error:e}");
        }
    }
    // Top left and bottom right lie farther, the others nearer, by the sag.
    let z = A2.corners().map(|c| sheet("3mm,0,twist").point(c).z);
    assert!(z.iter().zip([3.0, -3.0, 3.0, -3.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{z:?}");
}

#[test]
fn chords_and_sags_are_those_of_circles() {
    // An arc of length 2 S, radius R and half angle S / R: chord 2 R sin, sag R (1 − cos).
    let bent = sheet("30mm");
    let point = |x, y| bent.point(Point2::new(x, y));
    let (left, middle, right) = (point(0.0, 210.0), point(297.0, 210.0), point(594.0, 210.0));
    let chord = right - left;
    let sag = (middle - nalgebra::center(&left, &right)).norm();
    assert!((sag - 30.0).abs() < 1e-9, "{sag}");
    assert!(middle.z > left.z, "a positive sag has its middle farther away");
    let radius = (chord.norm() / 2.0).powi(2) / (2.0 * sag) + sag / 2.0;
    let arc = 2.0 * radius * (chord.norm() / 2.0 / radius).asin();
    assert!((arc - 594.0).abs() < 1e-9, "{arc}");
    // The distance of the corners along the diagonal: the chord and the height.
    let diagonal = (point(0.0, 0.0) - point(594.0, 420.0)).norm();
    assert!((diagonal - chord.norm().hypot(420.0)).abs() < 1e-9);
    // Oblique: the corners that are farthest across the axis lie on the chord.
    let oblique = sheet("-10mm,30");
    let [a, b] = [A2.corners()[0], A2.corners()[2]].map(|c| oblique.point(c));
    let sag = oblique.point(Point2::new(297.0, 210.0)).z - nalgebra::center(&a, &b).z;
    assert!((sag + 10.0).abs() < 1e-9, "{sag}");
    // A wave: both crests lie beside the chord from end to end by the sag.
    let wave = sheet("20mm,0,wave");
    let point = |x| wave.point(Point2::new(x, 210.0));
    let away = (point(594.0) - point(0.0)).cross(&Vector3::y()).normalize();
    let off = |x| (point(x) - point(0.0)).dot(&away);
    for (x, expected) in [(445.5, 20.0), (148.5, -20.0), (297.0, 0.0)] {
        assert!((off(x) - expected).abs() < 1e-9 && away.z > 0.9, "{x}: {}", off(x));
    }
}

#[test]
fn the_mean_plane_and_the_middle_stay_where_they_are() {
    for text in ["0.5%", "42mm,-50", "42mm,25,wave", "-20mm,90,wave", "30mm,0,twist"] {
        let bent = sheet(text);
        let middle = bent.point(Point2::new(297.0, 210.0));
        assert!((middle.x - 297.0).abs() < 1e-9 && (middle.y - 210.0).abs() < 1e-9, "{text}: {middle}");
        // Another rule than the one that levelled it: midpoints of 200 x 200 parts.
        let (mut height, mut slopes) = (0.0, [0.0; 2]);
        for i in 0..40_000 {
            let [u, v] = [i % 200, i / 200].map(|k| (f64::from(k) + 0.5) / 200.0);
            let p = bent.point(Point2::new(594.0 * u, 420.0 * v));
            height += p.z / 40_000.0;
            slopes[0] += p.z * (u - 0.5) / 40_000.0;
            slopes[1] += p.z * (v - 0.5) / 40_000.0;
        }
        // The rules differ by a share of 1e-4 of the sag.
        assert!(height.abs() < 5e-3 && slopes.iter().all(|s| s.abs() < 5e-3), "{text}: {height} {slopes:?}");
    }
}

#[test]
fn normals_are_perpendicular_to_differences() {
    for text in ["30mm,20", "30mm,20,wave", "20mm,0,twist"] {
        let bent = sheet(text);
        for (x, y) in [(10.0, 10.0), (400.0, 300.0), (594.0, 0.0), (250.0, 111.0)] {
            let normal = bent.normal(Point2::new(x, y));
            let difference = |dx: f64, dy: f64| {
                (bent.point(Point2::new(x + dx, y + dy)) - bent.point(Point2::new(x - dx, y - dy)))
                    .normalize()
            };
            assert!((normal.norm() - 1.0).abs() < 1e-12 && normal.z > 0.5);
            for d in [difference(1e-3, 0.0), difference(0.0, 1e-3)] {
                assert!(normal.dot(&d).abs() < 1e-8, "{text}: {}", normal.dot(&d));
            }
        }
    }
}

#[test]
fn rays_meet_the_sheet_where_they_were_aimed() {
    let eye = Point3::new(700.0, -300.0, -900.0);
    for text in
        ["3mm", "42mm,20", "-42mm,70", "42mm,0,wave", "-30mm,33,wave", "3mm,0,twist", "-42mm,90,twist", "0mm"]
    {
        let bent = sheet(text);
        for i in 0..400 {
            let aim = Point2::new(594.0 * f64::from(i % 20) / 19.0, 420.0 * f64::from(i / 20) / 19.0);
            // Just inside: a point of the border may be missed by rounding.
            let aim = Point2::new(297.0, 210.0) + (aim - Point2::new(297.0, 210.0)) * (1.0 - 1e-9);
            let target = bent.point(aim);
            let ray = Ray { origin: eye, direction: (target - eye) / 3.0 };
            let hit = bent.meet(&ray, [0.0, f64::INFINITY]).unwrap_or_else(|| panic!("{text}: {aim}"));
            let residual = eye + ray.direction * hit.distance - bent.point(hit.place);
            assert!(residual.norm() < 1e-9, "{text}: {}", residual.norm());
            // Only the nearest point is seen; here no part of the sheet hides another.
            assert!((hit.place - aim).norm() < 1e-8 && (hit.distance - 3.0).abs() < 1e-11, "{text}: {hit:?}");
            assert!((hit.normal - bent.normal(hit.place)).norm() < 1e-9);
            assert_eq!(bent.meet(&ray, [0.0, 2.9]), None);
            assert_eq!(bent.meet(&ray, [3.1, f64::INFINITY]), None);
        }
        // Beside the sheet.
        let ray = Ray { origin: eye, direction: Point3::new(-30.0, 200.0, 0.0) - eye };
        assert_eq!(bent.meet(&ray, [0.0, f64::INFINITY]), None);
    }
}

#[test]
fn a_grazing_ray_meets_the_nearest_crest() {
    // Along the width, 10 mm before the chord of a sheet whose middle lies 30 mm before it.
    let bent = sheet("-30mm");
    let crest = bent.point(Point2::new(297.0, 210.0)).z;
    let origin = Point3::new(-500.0, 210.0, crest + 10.0);
    let ray = Ray { origin, direction: Vector3::x() };
    let first = bent.meet(&ray, [0.0, f64::INFINITY]).unwrap();
    let second = bent.meet(&ray, [first.distance + 1e-6, f64::INFINITY]).unwrap();
    // Symmetric to the middle.
    assert!((first.place.x + second.place.x - 594.0).abs() < 1e-9 && first.place.x < 297.0);
    assert!((first.distance + second.distance - 2.0 * 797.0).abs() < 1e-9);
    assert_eq!(bent.meet(&ray, [second.distance + 1e-6, f64::INFINITY]), None);
    // Parallel to the axis, and turned about it.
    let along = Ray { origin: Point3::new(297.0, -500.0, crest), direction: Vector3::y() };
    assert_eq!(bent.meet(&along, [0.0, f64::INFINITY]), None);
    let turned = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.3) * Vector3::z();
    let through = Ray { origin: Point3::new(297.0, 210.0, crest) - turned * 800.0, direction: turned };
    let hit = bent.meet(&through, [0.0, f64::INFINITY]).unwrap();
    assert!((hit.distance - 800.0).abs() < 1e-9 && (hit.place.x - 297.0).abs() < 1e-9);
}
