//! Triangulation and its σ, against closed forms and Monte Carlo.

use nalgebra::{DMatrix, DVector, Point2, Point3, Rotation3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal, StandardNormal};

use super::triangulate::{Triangulator, triangulate};
use super::triangulate_config::TriangulateConfig;
use crate::cloud::PointCloud;
use crate::for_tests::test_rig;
use crate::geometry::{Camera, Distortion, Intrinsics, Plane, Ray};
use crate::matches::{Match, Matches};
use crate::parameter::{LensParameter, Parameter, PoseParameter};
use crate::rig::{Covariance, Rig};

fn distorted() -> Rig {
    let mut rig = test_rig();
    rig.camera.model.distortion = Distortion { k1: -0.12, k2: 0.03, p1: 1e-3, p2: -5e-4, k3: 0.0 };
    rig.camera.model.intrinsics = Intrinsics { fx: 1500.0, fy: 1480.0, skew: 1.5, cx: 700.0, cy: 420.0 };
    let projector = &mut rig.projector.as_mut().unwrap().device.model;
    projector.distortion = Distortion { k1: 0.05, k2: -0.02, p1: 1e-3, p2: 1e-3, k3: 0.0 };
    projector.intrinsics = Intrinsics { fx: 1700.0, fy: 1690.0, skew: -0.7, cx: 511.5, cy: 768.0 };
    rig
}

fn world() -> Vec<Point3<f64>> {
    (0..60)
        .map(|i| {
            let i = f64::from(i);
            Point3::new(
                (i * 1.7).sin() * 150.0,
                (i * 0.9).cos() * 40.0 - 30.0,
                1000.0 + (i * 0.37).sin() * 120.0,
            )
        })
        .collect()
}

fn see(rig: &Rig, x: &Point3<f64>) -> Match {
    let p = rig.projector.unwrap().from_camera.pose.transform(x);
    let on_panel = rig.projector.unwrap().device.model.project(&p).unwrap();
    Match {
        camera: rig.camera.model.project(x).unwrap(),
        projector_column: Some(on_panel.x),
        projector_row: Some(on_panel.y),
        slit: None,
        confidence: 1.0,
        sigma_px: 0.1,
        color: [0; 3],
    }
}

#[test]
fn points_are_recovered_from_column_row_or_both_for_any_lens() {
    let config = TriangulateConfig { panel_margin: 5.0, ..TriangulateConfig::default() };
    for rig in [test_rig(), distorted()] {
        let exact: Vec<Match> = world().iter().map(|x| see(&rig, x)).collect();
        let column = exact.iter().map(|m| Match { projector_row: None, ..*m }).collect();
        let row = exact.iter().map(|m| Match { projector_column: None, ..*m }).collect();
        for items in [exact, column, row] {
            let (cloud, report) = triangulate(&rig, &Matches { items }, &config).unwrap();
            assert_eq!(report.points, 60);
            for (p, x) in cloud.points.iter().zip(world()) {
                assert!((p.position - x).norm() < 1e-6, "{} for {x}", p.position);
            }
        }
    }
}

/// With parallel devices beside each other, the camera sees every row of the projector in the same row at any depth.
/// Such a row adds no information and removes none.
#[test]
fn a_row_without_depth_information_does_no_harm() {
    let mut rig = test_rig();
    let names = ["camera.focal_px", "projector.cy_px", "projector_from_camera.ty_mm"];
    let parameters = names.map(Parameter::from).to_vec();
    rig.covariance = Some(Covariance { parameters, matrix: DMatrix::identity(3, 3) });
    let pose = &mut rig.projector.as_mut().unwrap().from_camera.pose;
    pose.rotation = Rotation3::identity();
    pose.translation = Vector3::new(-100.0, 0.0, 0.0);
    let both: Vec<Match> = world().iter().map(|x| see(&rig, x)).collect();
    let column: Vec<Match> = both.iter().map(|m| Match { projector_row: None, ..*m }).collect();
    let [both, column] = [both, column]
        .map(|items| triangulate(&rig, &Matches { items }, &TriangulateConfig::default()).unwrap());
    assert_eq!((both.1.points, column.1.points), (60, 60));
    for ((a, b), x) in both.0.points.iter().zip(&column.0.points).zip(world()) {
        assert!((a.position - x).norm() < 1e-6);
        assert!((a.sigma_mm / b.sigma_mm - 1.0).abs() < 1e-9, "{} for {}", a.sigma_mm, b.sigma_mm);
        assert!((a.noise_mm / b.noise_mm - 1.0).abs() < 1e-9);
    }
}

#[test]
fn contradicting_columns_and_rows_are_rejected_and_counted() {
    let config = TriangulateConfig { panel_margin: 0.05, ..TriangulateConfig::default() };
    for rig in [test_rig(), distorted()] {
        let at = see(&rig, &Point3::new(0.0, 0.0, 1000.0));
        let shifted = |by: f64| Match { projector_row: at.projector_row.map(|r| r + by), ..at };
        // A row a few pixels off is noise or the rig's; one that is 200 px off belongs to another point.
        let items = vec![at, shifted(3.0), shifted(-200.0), shifted(200.0)];
        let (_, report) = triangulate(&rig, &Matches { items }, &config).unwrap();
        assert_eq!(report.points + report.contradicting + report.outside_panel + report.invalid, 4);
        assert!(report.points == 2 && report.contradicting > 0, "{report:?}");
    }
}

#[test]
fn sigma_is_the_scatter_of_noisy_matches() {
    let rig = distorted();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let config =
        TriangulateConfig { panel_margin: 5.0, projector_sigma_px: 0.05, ..TriangulateConfig::default() };
    let x = Point3::new(40.0, -20.0, 950.0);
    let truth = Match { projector_row: None, ..see(&rig, &x) };
    let (camera, centre) = (Normal::new(0.0, 0.1).unwrap(), Normal::new(0.0, 0.05).unwrap());
    let items: Vec<Match> = (0..4000)
        .map(|_| {
            let mut m = truth;
            m.camera.x += camera.sample(&mut rng);
            m.projector_column = m.projector_column.map(|c| c + centre.sample(&mut rng));
            m
        })
        .collect();
    let (cloud, _) = triangulate(&rig, &Matches { items }, &config).unwrap();
    let direction = x.coords.normalize();
    let variance =
        cloud.points.iter().map(|p| (p.position - x).dot(&direction).powi(2)).sum::<f64>() / 4000.0;
    let predicted = cloud.points[0].sigma_mm;
    // 4000 draws estimate a σ to 1.1 %.
    assert!((variance.sqrt() / predicted - 1.0).abs() < 0.05, "{} for {predicted}", variance.sqrt());
}

#[test]
fn impossible_matches_are_rejected_and_counted() {
    let rig = test_rig();
    let good = Match { projector_row: None, ..see(&rig, &Point3::new(0.0, 0.0, 1000.0)) };
    let none = Match { projector_column: None, ..good };
    let nan = Match { camera: Point2::new(f64::NAN, 0.0), ..good };
    // A column on the other side: the light plane meets the ray behind the camera.
    let behind = Match { projector_column: good.projector_column.map(|c| c + 600.0), ..good };
    let noisy = Match { sigma_px: f64::NAN, ..good };
    let endless = Match { projector_column: Some(f64::INFINITY), ..good };
    let items = vec![good, none, nan, behind, noisy, endless];
    let (_, report) = triangulate(&rig, &Matches { items }, &TriangulateConfig::default()).unwrap();
    assert_eq!((report.points, report.invalid), (1, 4));
    assert_eq!(report.behind + report.outside_panel, 1);
    let mut alone = rig;
    alone.projector = None;
    assert!(triangulate(&alone, &Matches::default(), &TriangulateConfig::default()).is_err());
}

#[test]
fn points_outside_the_depth_limits_are_left_out_and_counted() {
    let rig = test_rig();
    let matches = Matches { items: world().iter().map(|x| see(&rig, x)).collect() };
    let all = triangulate(&rig, &matches, &TriangulateConfig::default()).unwrap().0.points;
    for (near_mm, far_mm) in [(Some(950.0), Some(1050.0)), (Some(1000.0), None), (None, Some(1000.0))] {
        let config = TriangulateConfig { near_mm, far_mm, ..TriangulateConfig::default() };
        let (cloud, report) = triangulate(&rig, &matches, &config).unwrap();
        let mut expected = all.clone();
        expected.retain(|p| {
            near_mm.is_none_or(|n| p.position.z >= n) && far_mm.is_none_or(|f| p.position.z <= f)
        });
        assert_eq!(cloud.points, expected);
        assert_eq!((report.points, report.outside_depth), (expected.len(), 60 - expected.len()));
        assert!((10..50).contains(&expected.len()), "{}", expected.len());
    }
}

#[test]
fn depth_limits_must_be_finite_and_in_order() {
    let said = |near_mm, far_mm| {
        let config = TriangulateConfig { near_mm, far_mm, ..TriangulateConfig::default() };
        config.validate().map_err(|e| e.to_string())
    };
    assert!(said(Some(0.0), Some(0.1)).is_ok() && said(None, None).is_ok());
    for near in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(said(Some(near), None).unwrap_err().contains("near_mm"));
    }
    for (near, far) in [(Some(700.0), 700.0), (Some(700.0), 300.0), (None, 0.0), (None, f64::NAN)] {
        assert!(said(near, Some(far)).unwrap_err().contains("far_mm"));
    }
    let read: TriangulateConfig = serde_json::from_str(r#"{"near_mm": 500}"#).unwrap();
    assert_eq!(read, TriangulateConfig { near_mm: Some(500.0), ..TriangulateConfig::default() });
}

/// The intersection of a match's camera ray with the plane.
fn on_plane(rig: &Rig, plane: &Plane, pixel: Point2<f64>) -> Point3<f64> {
    let direction = rig.camera.model.bearing(pixel).unwrap();
    Ray { origin: Point3::origin(), direction }.meet(plane).unwrap()
}

/// The crossings of 64 slits with the scanlines of the camera's image, on a plane.
fn stripes_on(rig: &Rig, plane: &Plane, lines: std::ops::Range<u32>) -> Vec<Match> {
    let column_at = |u: f64, v: f64| {
        let x = on_plane(rig, plane, Point2::new(u, v));
        see(rig, &x).projector_column.unwrap()
    };
    let mut items = Vec::new();
    for v in lines {
        let v = f64::from(v);
        for slit in 0..64_u16 {
            let column = 8.0 + 16.0 * f64::from(slit);
            let (mut low, mut high) = (0.0, 1279.0);
            if (column_at(low, v) - column) * (column_at(high, v) - column) > 0.0 {
                continue;
            }
            let rising = column_at(high, v) > column_at(low, v);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                *(if (column_at(middle, v) < column) == rising { &mut low } else { &mut high }) = middle;
            }
            items.push(Match {
                camera: Point2::new(low, v),
                projector_column: Some(column),
                projector_row: None,
                slit: Some(slit),
                confidence: 1.0,
                sigma_px: 0.08,
                color: [0; 3],
            });
        }
    }
    items
}

/// The error along the ray, over σ, is normal: 68.3 % within one, 95.4 % within two, on planes of any slant.
#[test]
fn errors_on_planes_match_their_sigma() {
    let rig = test_rig();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for normal in [[0.0, 0.0, 1.0], [0.6, 0.1, 1.0], [-0.6, 0.0, 1.0], [0.1, 0.7, 1.0]] {
        let plane = Plane::from_point_normal(&Point3::new(0.0, 0.0, 1000.0), Vector3::from(normal)).unwrap();
        let mut items = stripes_on(&rig, &plane, 200..700);
        for m in &mut items {
            m.camera.x += m.sigma_px * rng.sample::<f64, _>(StandardNormal);
        }
        let n = items.len() as f64;
        assert!(n > 20_000.0, "{n}");
        let (cloud, report) = triangulate(&rig, &Matches { items }, &TriangulateConfig::default()).unwrap();
        assert!(!report.rig_sigma_known);
        let within = |k: f64| {
            let ok = cloud.points.iter().filter(|p| {
                let truth = on_plane(&rig, &plane, p.pixel);
                (p.position - truth).norm() < k * p.sigma_mm
            });
            ok.count() as f64 / n
        };
        let (one, two) = (within(1.0), within(2.0));
        // Three times the standard deviation of the shares, and half a per cent for the slope measured on noisy points.
        assert!((one - 0.6827).abs() < 0.015 && (two - 0.9545).abs() < 0.009, "{normal:?}: {one} {two}");
    }
}

/// All parameters with plausible σ, each correlated with all others, in another order than the library's own.
fn with_covariance(mut rig: Rig) -> (Rig, DMatrix<f64>) {
    let lens = [5.0, 4.0, 4.0, 3e-3, 3e-3, 2e-4, 2e-4, 1e-3, 2e-3];
    let pose = [2e-3, 2e-3, 2e-3, 1.5, 1.0, 2.0];
    let mut parameters = Vec::new();
    let mut sigma = Vec::new();
    for (parameter, s) in PoseParameter::ALL.into_iter().zip(pose) {
        parameters.push(Parameter::ProjectorFromCamera(parameter));
        sigma.push(s);
    }
    parameters.push(Parameter::View(0, PoseParameter::Rx));
    sigma.push(0.5);
    for device in [Parameter::Camera, Parameter::Projector] {
        for (parameter, s) in LensParameter::ALL.into_iter().zip(lens) {
            parameters.push(device(parameter));
            sigma.push(s);
        }
    }
    parameters.push(Parameter::Bend(0, 4));
    sigma.push(0.3);
    let n = sigma.len();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mix = DMatrix::from_fn(n, n, |i, j| {
        let x: f64 = rng.sample(StandardNormal);
        if i == j { 1.0 } else { 0.25 * x }
    });
    let root = DMatrix::from_diagonal(&DVector::from_vec(sigma)) * mix * 0.3;
    rig.covariance = Some(Covariance { parameters, matrix: &root * root.transpose() });
    (rig, root)
}

/// The rig with its parameters moved by `d`, in the order of [`with_covariance`].
fn moved(rig: &Rig, d: &DVector<f64>) -> Rig {
    let lens = |c: &mut Camera, d: &[f64]| {
        let grow = 1.0 + d[0] / c.intrinsics.fx;
        c.intrinsics.fx *= grow;
        c.intrinsics.fy *= grow;
        c.intrinsics.skew *= grow;
        c.intrinsics.cx += d[1];
        c.intrinsics.cy += d[2];
        let mut k = c.distortion.to_array();
        k.iter_mut().zip(&d[3..8]).for_each(|(k, d)| *k += d);
        c.distortion = Distortion::from_array(k);
        c.intrinsics.fy *= 1.0 + d[8];
    };
    let mut out = rig.clone();
    let pose = &mut out.projector.as_mut().unwrap().from_camera.pose;
    pose.rotation = Rotation3::new(Vector3::new(d[0], d[1], d[2])) * pose.rotation;
    pose.translation += Vector3::new(d[3], d[4], d[5]);
    lens(&mut out.camera.model, &d.as_slice()[7..16]);
    lens(&mut out.projector.as_mut().unwrap().device.model, &d.as_slice()[16..25]);
    out
}

/// The rig's share of σ is the scatter of the points over rigs drawn from its covariance, for any lens, from columns,
/// rows and both.
#[test]
fn the_rigs_share_of_sigma_is_the_scatter_over_rigs() {
    let config = TriangulateConfig { panel_margin: 5.0, ..TriangulateConfig::default() };
    let draws = 1500;
    for (bent, rig) in [(false, test_rig()), (true, distorted())] {
        let (rig, root) = with_covariance(rig);
        let exact: Vec<Match> = world().iter().step_by(6).map(|x| see(&rig, x)).collect();
        let column = exact.iter().map(|m| Match { projector_row: None, ..*m });
        let row = exact.iter().map(|m| Match { projector_column: None, ..*m });
        // A row has too little information about depth where the baseline is horizontal; so these points use both.
        let items: Vec<Match> = column.chain(row).chain(exact.iter().copied()).collect();
        let matches = Matches { items };
        let (cloud, report) = triangulate(&rig, &matches, &config).unwrap();
        assert!(report.rig_sigma_known && report.points == matches.items.len());
        let mut squares = vec![0.0; cloud.points.len()];
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for _ in 0..draws {
            let d = &root * DVector::from_fn(root.ncols(), |_, _| rng.sample::<f64, _>(StandardNormal)) * 0.1;
            let (other, _) = triangulate(&moved(&rig, &d), &matches, &config).unwrap();
            for ((sum, p), q) in squares.iter_mut().zip(&cloud.points).zip(&other.points) {
                *sum += (10.0 * (q.position - p.position).dot(&p.position.coords.normalize())).powi(2);
            }
        }
        for (sum, p) in squares.iter().zip(&cloud.points) {
            let found = (sum / f64::from(draws)).sqrt();
            let said = (p.sigma_mm.powi(2) - p.noise_mm.powi(2)).sqrt();
            // The draws estimate a σ to 1.8 %.
            assert!((said / found - 1.0).abs() < 0.07, "bent {bent}: {said} for {found} at {}", p.position);
        }
    }
}

/// Reusing a slit's share where it hardly changes keeps it within two per cent.
#[test]
fn a_share_reused_along_a_slit_stays_accurate() {
    let (rig, _) = with_covariance(distorted());
    let plane =
        Plane::from_point_normal(&Point3::new(0.0, 0.0, 1000.0), Vector3::new(0.4, 0.3, 1.0)).unwrap();
    let config = TriangulateConfig { panel_margin: 5.0, ..TriangulateConfig::default() };
    let carried = Matches { items: stripes_on(&rig, &plane, 100..400) };
    let each = Matches { items: carried.items.iter().map(|m| Match { slit: None, ..*m }).collect() };
    let of_rig = |m: &Matches| -> Vec<f64> {
        let points = triangulate(&rig, m, &config).unwrap().0.points;
        points.iter().map(|p| (p.sigma_mm.powi(2) - p.noise_mm.powi(2)).sqrt()).collect()
    };
    let (a, b) = (of_rig(&carried), of_rig(&each));
    assert!(a.len() == b.len() && a.len() > 5000);
    assert!(a.iter().zip(&b).all(|(a, b)| (a / b - 1.0).abs() < 0.02));
}

#[test]
fn an_unusable_covariance_is_reported() {
    let (rig, _) = with_covariance(test_rig());
    let matches = Matches { items: world().iter().map(|x| see(&rig, x)).collect() };
    let known = |change: &dyn Fn(&mut Covariance)| {
        let mut rig = rig.clone();
        change(rig.covariance.as_mut().unwrap());
        let (cloud, report) = triangulate(&rig, &matches, &TriangulateConfig::default()).unwrap();
        assert!(cloud.points.iter().all(|p| p.sigma_mm.is_finite() && p.sigma_mm >= p.noise_mm));
        report.rig_sigma_known
    };
    assert!(known(&|_| ()));
    assert!(!known(&|c| c.matrix[(1, 2)] = f64::NAN));
    assert!(!known(&|c| c.matrix = DMatrix::zeros(2, 2)));
    assert!(!known(&|c| c.parameters[3] = "projector.zoom".into()));
    assert!(!known(&|c| c.parameters.clear()));
}

/// Buffers are reused and nothing of the previous frame remains.
#[test]
fn one_triangulator_serves_many_frames() {
    let (rig, _) = with_covariance(distorted());
    let config = TriangulateConfig { panel_margin: 5.0, ..TriangulateConfig::default() };
    let all: Vec<Match> = world().iter().map(|x| see(&rig, x)).collect();
    let mut scanner = Triangulator::new(&rig, config).unwrap();
    let mut cloud = PointCloud { triangles: vec![[0, 1, 2]], ..PointCloud::default() };
    for n in [60, 7, 0, 31] {
        let matches = Matches { items: all[..n].to_vec() };
        let report = scanner.triangulate(&matches, &mut cloud);
        assert_eq!((cloud.clone(), report), triangulate(&rig, &matches, &config).unwrap());
    }
}
