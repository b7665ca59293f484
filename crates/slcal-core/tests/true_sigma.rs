//! Whether σ is true: random photographs with exact principal points, where σ is all the detector's, and the errors of
//! the result in units of their own σ.
//!
//! `SLCAL_SCENES` asks for more scenes than the few of an ordinary run, `SLCAL_SEED` for others, `SLCAL_VERBOSE` prints each.

mod drawn;

use drawn::Drawn;
use nalgebra::Point2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use slcal_core::detect::{DetectConfig, observe};
use slcal_core::geometry::{Line, RectangleSize};

use slcal_core::calibrate::{DistortionModel, PrincipalPointRule};
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_core::photo::{Layout, PhotoView, Samples};
use slcal_core::{CalibrateConfig, Observations, SheetObservation, ViewObservation, calibrate_observations};

fn from_environment(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

/// Errors in units of σ: root mean square and how many exceed 3.
#[derive(Debug, Default)]
struct Scores(Vec<f64>);

impl Scores {
    fn rms(&self) -> f64 {
        (self.0.iter().map(|z| z * z).sum::<f64>() / self.0.len().max(1) as f64).sqrt()
    }

    fn beyond(&self, limit: f64) -> usize {
        self.0.iter().filter(|z| z.abs() > limit).count()
    }
}

fn seen(scene: &Drawn, codes: &[u16], pattern: &CheckerPattern) -> Option<ViewObservation> {
    let [w, h] = scene.camera;
    let bytes: Vec<u8>;
    let samples = if scene.sixteen_bit {
        Samples::U16(codes)
    } else {
        bytes = codes.iter().map(|c| (c / 257) as u8).collect();
        Samples::U8(&bytes)
    };
    let view = PhotoView::new(samples, w, h, w, Layout::Grey).unwrap();
    let size = RectangleSize::new(scene.size_mm[0], scene.size_mm[1]).unwrap();
    match observe(view, None, size, Some(pattern), &DetectConfig::default()) {
        Ok(found) => Some(found.observation),
        Err(e) => {
            println!("not found: {e}");
            None
        }
    }
}

/// Errors of corners (per coordinate) and of edge points, and of whole sides, in units of σ; and the rms in px.
fn positions(scene: &Drawn, view: &ViewObservation, scores: &mut [Scores; 3]) -> [f64; 2] {
    let (mut corners, mut edges, mut count) = (0.0_f64, 0.0_f64, 0.0_f64);
    for p in &view.pairs {
        let d = p.camera - scene.camera_from_projector.map(p.projector).unwrap();
        scores[0].0.extend([d.x / p.sigma_px.unwrap(), d.y / p.sigma_px.unwrap()]);
        corners += d.norm_squared() / 2.0;
        if std::env::var("SLCAL_VERBOSE").is_ok() && d.norm() > 5.0 * p.sigma_px.unwrap() {
            println!(
                "corner {:?} at {:.3} {:.3} off by {:+.4} {:+.4} ({:.4})",
                p.projector,
                p.camera.x,
                p.camera.y,
                d.x,
                d.y,
                p.sigma_px.unwrap()
            );
        }
    }
    let truth = scene.sheet_corners();
    let SheetObservation::Edges(sides) = &view.sheet else { panic!("no edges") };
    for (i, side) in sides.iter().enumerate() {
        let line = Line::through_pixels(truth[i], truth[(i + 1) % 4]).normalized().unwrap();
        let (mut sum, mut weight) = (0.0_f64, 0.0_f64);
        for p in side {
            let d = line.signed_distance_px(p.position);
            scores[1].0.push(d / p.sigma_px.unwrap());
            edges += d * d;
            count += 1.0;
            sum += d / p.sigma_px.unwrap().powi(2);
            weight += p.sigma_px.unwrap().powi(-2);
        }
        scores[2].0.push(sum / weight.sqrt());
        if std::env::var("SLCAL_VERBOSE").is_ok() {
            print!("side {i}: {:+.4} ({:.4}, {} points) ", sum / weight, weight.sqrt().recip(), side.len());
        }
    }
    [(corners / view.pairs.len() as f64).sqrt(), (edges / count).sqrt()]
}

#[test]
fn errors_are_as_large_as_their_sigma() {
    let scenes = from_environment("SLCAL_SCENES", 8);
    let verbose = std::env::var("SLCAL_VERBOSE").is_ok();
    let pattern = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
    let widths: &[usize] = if scenes > 8 { &[640, 800, 1280, 1600] } else { &[640, 800] };
    let mut results: [Scores; 3] = Default::default();
    let mut measured: [Scores; 3] = Default::default();
    let mut missed = 0;
    for seed in from_environment("SLCAL_FIRST", 0)..scenes {
        let mut rng = ChaCha8Rng::seed_from_u64(1000 * from_environment("SLCAL_SEED", 0) + seed);
        let scene = Drawn::random(&mut rng, widths, &pattern);
        let codes = scene.photograph(&pattern, &mut rng);
        let Some(view) = seen(&scene, &codes, &pattern) else {
            missed += 1;
            continue;
        };
        let rms = positions(&scene, &view, &mut measured);
        let exact = |p: Point2<f64>| PrincipalPointRule::Exact(p.x, p.y);
        let config = CalibrateConfig {
            camera_pp: exact(scene.camera_pp),
            projector_pp: exact(scene.projector_pp),
            distortion: DistortionModel::None,
            allow_degenerate: true,
            ..CalibrateConfig::default()
        };
        let [w, h] = scene.camera.map(|n| n as u32);
        let observations = Observations {
            camera: [w, h],
            projector: Some(pattern.projector),
            mirrored: false,
            views: vec![view],
        };
        let c = calibrate_observations(&observations, &config).unwrap();
        let projector = c.rig.projector.as_ref().unwrap();
        let t = projector.from_camera.pose.translation;
        let covariance = c.rig.covariance.as_ref().unwrap();
        let first =
            covariance.parameters.iter().position(|p| *p == "projector_from_camera.tx_mm".into()).unwrap();
        let block = covariance.matrix.fixed_view::<3, 3>(first, first);
        let along = (t.normalize().transpose() * block * t.normalize())[0].sqrt();
        let z = [
            (c.rig.camera.model.intrinsics.fx - scene.camera_focal_px) / c.rig.camera.sigma.unwrap().focal_px,
            (projector.device.model.intrinsics.fx - scene.projector_focal_px)
                / projector.device.sigma.unwrap().focal_px,
            (t.norm() - scene.baseline_mm) / along,
        ];
        for (scores, z) in results.iter_mut().zip(z) {
            scores.0.push(z);
        }
        if verbose {
            let v = &c.rig.views[0].rms_px.unwrap();
            println!(
                "{seed:3} {w:4} tilt {:2.0} blur {:.2} noise {:.4}/{:.4} bits {} light {:.3}+{:.2} wall {:.2}: f_cam {:+.4} % {:+5.2}s  f_proj {:+.4} % {:+5.2}s  base {:+5.2}s  rms corners {:.4} edges {:.4} fit {:.4} {:.4}",
                scene.tilt_deg,
                scene.blur_px,
                scene.noise[0],
                scene.noise[1],
                if scene.sixteen_bit { 16 } else { 8 },
                scene.light[0],
                scene.light[1],
                scene.wall,
                100.0 * (c.rig.camera.model.intrinsics.fx / scene.camera_focal_px - 1.0),
                z[0],
                100.0 * (projector.device.model.intrinsics.fx / scene.projector_focal_px - 1.0),
                z[1],
                z[2],
                rms[0],
                rms[1],
                v.corners.unwrap(),
                v.edges
            );
        }
    }
    let named = ["f_cam", "f_proj", "baseline", "corners", "edge points", "sides"];
    for (name, s) in named.iter().zip(results.iter().chain(&measured)) {
        let (rms, count) = (s.rms(), s.0.len() as f64);
        println!(
            "{name:12} rms of error/sigma {rms:.2}, {} of {count} beyond 2, {} beyond 3",
            s.beyond(2.0),
            s.beyond(3.0)
        );
        // The rms of n normal numbers scatters by 1/√(2n); a quarter more or less is a σ that need not be better.
        let scatter = 3.0 / (2.0 * count).sqrt();
        assert!(rms < 1.25 + scatter && rms > 0.65 - scatter, "{name}: {rms}");
        assert!(s.beyond(3.0) as f64 <= 1.0 + 0.02 * count, "{name}: {} of {count} beyond 3", s.beyond(3.0));
    }
    println!("not found: {missed} of {scenes}");
    assert!(10 * missed <= scenes, "{missed} of {scenes} photographs came to nothing");
}
