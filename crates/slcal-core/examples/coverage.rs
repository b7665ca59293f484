//! Draws rigs from what the estimator takes for ordinary, photographs them with noise, calibrates, and compares the errors with
//! the stated σ, parameter by parameter.
//!
//!     cargo run --release -p slcal-core --example coverage -- [--draws N] [--views 1|2|3] [--seed S] [--bend SHARE]
//!         [--lens SHARE] [--common] [--camera-alone] [--flat] [--ordinary] [--threads N]
//!
//! `--bend` and `--lens` scale the true bends and the true lenses' faults against the priors (1), `--common` gives all
//! photographs the same bend, `--flat` calibrates with `--flatness flat`, and `--ordinary` draws views from 20° to 90° with tilts from 3°. Lenses that fold over within the image are drawn again, as are
//! sheets that are not seen whole.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use slcal_core::nalgebra::{Point2, Point3, Rotation3, Vector2, Vector3};
use slcal_core::{
    CalibrateConfig, Calibration, Camera, CornerPair, Distortion, EdgePoint, Flatness, Intrinsics,
    Observations, Pose, RectangleSize, SheetBend, SheetObservation, Verdict, ViewObservation,
    calibrate_observations,
};

const NOISE_PX: f64 = 0.05;
const PRINCIPAL_POINT: f64 = 0.02;
const CAMERA_LENS: [f64; 5] = [0.2, 0.2, 0.000_7, 0.000_7, 0.1];
const PROJECTOR_LENS: [f64; 5] = [0.02, 0.02, 0.000_3, 0.000_3, 0.01];
const ASPECT: f64 = 0.002;
const FLATNESS: f64 = 0.002;

#[derive(Clone)]
#[expect(clippy::struct_excessive_bools, reason = "a command line is made of switches")]
struct Options {
    draws: u64,
    views: usize,
    seed: u64,
    bend: f64,
    lens: f64,
    common: bool,
    camera_alone: bool,
    flat: bool,
    ordinary: bool,
    threads: usize,
}

struct Truth {
    camera: Camera,
    projector: Camera,
    projector_from_camera: Pose,
    size: RectangleSize,
    views: Vec<(Pose, SheetBend)>,
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

fn device(
    rng: &mut ChaCha8Rng,
    o: &Options,
    [w, h]: [u32; 2],
    f: f64,
    cy: Option<f64>,
    lens: [f64; 5],
) -> Camera {
    loop {
        let (pw, ph) = (f64::from(w), f64::from(h));
        let cx = (pw - 1.0) / 2.0 + PRINCIPAL_POINT * pw * normal(rng);
        let cy = cy.unwrap_or_else(|| (ph - 1.0) / 2.0 + PRINCIPAL_POINT * pw * normal(rng));
        let intrinsics =
            Intrinsics { fx: f, fy: f * (1.0 + ASPECT * o.lens * normal(rng)), skew: 0.0, cx, cy };
        let distortion = Distortion::from_array(lens.map(|s| s * o.lens * normal(rng)));
        let camera = Camera { width: w, height: h, intrinsics, distortion };
        // Everything within the image, and a little beyond, has a preimage and is not compressed beyond a quarter.
        let sane = (0..=20).all(|i| {
            (0..=20).all(|k| {
                let p = Point2::new(
                    pw * (1.2 * f64::from(i) / 20.0 - 0.1),
                    ph * (1.2 * f64::from(k) / 20.0 - 0.1),
                );
                camera.bearing(p).is_some_and(|b| {
                    let j = distortion.jacobian(b.xy());
                    j.determinant() > 0.25 && j.determinant() < 4.0
                })
            })
        });
        if sane {
            return camera;
        }
    }
}

fn draw(rng: &mut ChaCha8Rng, o: &Options) -> Option<Truth> {
    let fov: f64 = if o.ordinary { rng.random_range(20.0..90.0) } else { rng.random_range(35.0..70.0) };
    let f = 640.0 / (fov.to_radians() / 2.0).tan();
    let camera = device(rng, o, [1280, 960], f, None, CAMERA_LENS);
    let fp = 1024.0 * rng.random_range(1.2..2.2);
    let cy =
        if rng.random_bool(0.5) { rng.random_range(300.0..450.0) } else { rng.random_range(700.0..850.0) };
    let projector = device(rng, o, [1024, 768], fp, Some(cy), PROJECTOR_LENS);
    let size = [(594.0, 420.0), (420.0, 297.0), (297.0, 210.0)][rng.random_range(0..3)];
    let size = RectangleSize { width_mm: size.0, height_mm: size.1 };
    let fill = rng.random_range(0.5..0.8);
    let distance = f * size.width_mm / (fill * 1280.0);
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let centre = Vector3::new(
        side * rng.random_range(0.15..0.4) * distance,
        rng.random_range(-0.1..0.1) * distance,
        rng.random_range(-0.1..0.1) * distance,
    );
    // The projector looks so that the middle of its light meets the middle of the sheet.
    let middle = Vector3::new(0.0, 0.0, distance);
    let thrown = projector.bearing(Point2::new(511.5, 383.5))?;
    let aim = Rotation3::rotation_between(&(middle - centre), &thrown)?;
    let projector_from_camera = Pose { rotation: aim, translation: -(aim * centre) };
    let tilt = |rng: &mut ChaCha8Rng| {
        let low: f64 = if o.ordinary { 3.0 } else { 12.0 };
        rng.random_range(low..35.0) * if rng.random_bool(0.5) { 1.0 } else { -1.0 }
    };
    let (tx, ty): (f64, f64) = (tilt(rng), tilt(rng));
    let roll: f64 = rng.random_range(-8.0..8.0);
    let bend = |rng: &mut ChaCha8Rng| {
        let sigma = FLATNESS * size.width_mm.hypot(size.height_mm) * o.bend;
        SheetBend(std::array::from_fn(|k| sigma * [1.0, 0.5, 0.25][SheetBend::order(k) - 2] * normal(rng)))
    };
    let first = bend(rng);
    let views = (0..o.views).map(|i| {
        let sign = if i == 1 { -1.0 } else { 1.0 };
        let (tx, ty) = if i < 2 { (tx * sign, ty * sign) } else { (tilt(rng), tilt(rng)) };
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), roll.to_radians())
            * Rotation3::from_axis_angle(&Vector3::x_axis(), tx.to_radians())
            * Rotation3::from_axis_angle(&Vector3::y_axis(), ty.to_radians());
        let shift = Vector2::new(normal(rng), normal(rng)) * 0.02 * distance;
        let to = middle + Vector3::new(shift.x, shift.y, 0.0);
        let arm = Vector3::new(size.width_mm / 2.0, size.height_mm / 2.0, 0.0);
        let bend = if i == 0 || o.common { first } else { bend(rng) };
        (Pose { rotation, translation: to - rotation * arm }, bend)
    });
    let views = views.collect();
    Some(Truth { camera, projector, projector_from_camera, size, views })
}

/// Where the light of a projector pixel falls on a bent sheet: the point over the sheet's plane, and in the camera frame.
fn lit(t: &Truth, (pose, bend): &(Pose, SheetBend), q: Point2<f64>) -> Option<(Point2<f64>, Point3<f64>)> {
    let back = t.projector_from_camera.inverse();
    let sheet_from_camera = pose.inverse();
    let origin = sheet_from_camera.transform(&Point3::from(back.translation));
    let ray = sheet_from_camera.rotation * (back.rotation * t.projector.bearing(q)?);
    let mut s = -origin.z / ray.z;
    for _ in 0..50 {
        let p = origin + ray * s;
        s += (bend.point(t.size, p.xy()).z - p.z) / ray.z;
    }
    let p = origin + ray * s;
    (s > 0.0).then(|| (p.xy(), pose.transform(&p)))
}

fn photograph(t: &Truth, o: &Options, rng: &mut ChaCha8Rng) -> Option<Observations> {
    let mut views = Vec::new();
    for view @ (pose, bend) in &t.views {
        let inside = |p: Point2<f64>| (5.0..1275.0).contains(&p.x) && (5.0..955.0).contains(&p.y);
        let mut jitter = || Vector2::new(normal(rng), normal(rng)) * NOISE_PX;
        let corners = t.size.corners();
        let mut sides: [Vec<EdgePoint>; 4] = Default::default();
        for (i, side) in sides.iter_mut().enumerate() {
            for k in 0..48 {
                let at = corners[i]
                    + (corners[(i + 1) % 4] - corners[i]) * (0.02 + 0.96 * (f64::from(k) + 0.5) / 48.0);
                let seen = t.camera.project(&pose.transform(&bend.point(t.size, at)))?;
                if !inside(seen) {
                    return None;
                }
                side.push(EdgePoint { position: seen + jitter(), sigma_px: Some(NOISE_PX) });
            }
        }
        let mut pairs = Vec::new();
        for k in 0..33 * 25 {
            let q = Point2::new(31.5 + 30.0 * f64::from(k % 33), 23.5 + 30.0 * f64::from(k / 33));
            let Some((p, at)) = lit(t, view, q) else { continue };
            let margin = 0.04 * t.size.width_mm;
            if (margin..t.size.width_mm - margin).contains(&p.x)
                && (margin..t.size.height_mm - margin).contains(&p.y)
            {
                let camera = t.camera.project(&at)? + jitter();
                pairs.push(CornerPair { camera, projector: q, sigma_px: Some(NOISE_PX) });
            }
        }
        // A board of some 9 by 6 corners.
        let step = (pairs.len() / 60).max(1);
        let pairs: Vec<_> = pairs.into_iter().step_by(step).collect();
        if pairs.len() < 20 && !o.camera_alone {
            return None;
        }
        views.push(ViewObservation {
            photo: None,
            size: t.size,
            sheet: SheetObservation::Edges(sides),
            pairs,
            panel_points: Vec::new(),
            channel_offsets: Vec::new(),
        });
    }
    let projector = (!o.camera_alone).then_some([1024, 768]);
    Some(Observations { camera: [1280, 960], projector, mirrored: false, views })
}

const NAMES: [&str; 9] =
    ["f_cam", "cx_cam", "cy_cam", "f_proj", "cx_proj", "cy_proj", "baseline", "k1", "aspect"];

fn errors(c: &Calibration, t: &Truth) -> [f64; 9] {
    let lens = |d: &slcal_core::Device, t: &Camera| {
        let (k, s) = (d.model.intrinsics, d.sigma.unwrap());
        let e = |a: f64, b: f64, s: f64| if s > 0.0 { (a - b) / s } else { 0.0 };
        let focal = (k.fx / t.intrinsics.fx).ln() / (s.focal_px / k.fx);
        let aspect = (k.fy / k.fx * t.intrinsics.fx / t.intrinsics.fy).ln();
        [
            focal,
            e(k.cx, t.intrinsics.cx, s.cx_px),
            e(k.cy, t.intrinsics.cy, s.cy_px),
            e(d.model.distortion.k1, t.distortion.k1, s.distortion[0]),
            if s.aspect > 0.0 { aspect / s.aspect } else { 0.0 },
        ]
    };
    let a = lens(&c.rig.camera, &t.camera);
    let mut out = [a[0], a[1], a[2], 0.0, 0.0, 0.0, 0.0, a[3], a[4]];
    if let Some(p) = &c.rig.projector {
        let b = lens(&p.device, &t.projector);
        out[3..6].copy_from_slice(&b[..3]);
        let wanted = t.projector_from_camera.translation.norm();
        out[6] = (c.rig.baseline_mm().unwrap() / wanted).ln() / (c.rig.baseline_sigma_mm().unwrap() / wanted);
    }
    out
}

struct Outcome {
    verdict: Verdict,
    z: [f64; 9],
    sigma_percent: f64,
    error_percent: f64,
    seed: u64,
    warnings: Vec<String>,
}

fn one(o: &Options, seed: u64) -> Option<Outcome> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (truth, seen) = (0..1000)
        .find_map(|_| {
            let truth = draw(&mut rng, o)?;
            let seen = photograph(&truth, o, &mut rng)?;
            Some((truth, seen))
        })
        .or_else(|| {
            eprintln!("seed {seed}: nothing drawn");
            None
        })?;
    let flatness = if o.flat { Flatness::Flat } else { Flatness::Paper };
    let config = CalibrateConfig { flatness, allow_degenerate: true, ..CalibrateConfig::default() };
    let found = calibrate_observations(&seen, &config).inspect_err(|e| eprintln!("seed {seed}: {e}")).ok()?;
    let quality = found.rig.quality.as_ref()?;
    Some(Outcome {
        verdict: quality.verdict,
        z: errors(&found, &truth),
        sigma_percent: quality.focal_sigma_percent_camera,
        error_percent: 100.0 * (found.rig.camera.model.intrinsics.fx / truth.camera.intrinsics.fx - 1.0),
        seed,
        warnings: quality.warnings.iter().map(|w| w.code.clone()).collect(),
    })
}

fn main() {
    let mut o = Options {
        draws: 500,
        views: 1,
        seed: 1,
        bend: 1.0,
        lens: 1.0,
        common: false,
        camera_alone: false,
        flat: false,
        ordinary: false,
        threads: 1,
    };
    let mut arguments = std::env::args().skip(1);
    while let Some(name) = arguments.next() {
        let mut number =
            || arguments.next().and_then(|v| v.parse::<f64>().ok()).expect("a number after the option");
        match name.as_str() {
            "--draws" => o.draws = number() as u64,
            "--views" => o.views = number() as usize,
            "--seed" => o.seed = number() as u64,
            "--bend" => o.bend = number(),
            "--lens" => o.lens = number(),
            "--threads" => o.threads = number() as usize,
            "--common" => o.common = true,
            "--camera-alone" => o.camera_alone = true,
            "--flat" => o.flat = true,
            "--ordinary" => o.ordinary = true,
            other => panic!("unknown option {other}"),
        }
    }
    let run = |part: usize| {
        let seeds = (0..o.draws).filter(|i| *i as usize % o.threads == part).map(|i| o.seed * 1_000_000 + i);
        seeds.map(|seed| one(&o, seed)).collect::<Vec<_>>()
    };
    let all: Vec<Option<Outcome>> = std::thread::scope(|scope| {
        let handles: Vec<_> = (0..o.threads).map(|part| scope.spawn(move || run(part))).collect();
        handles.into_iter().flat_map(|h| h.join().unwrap()).collect()
    });
    let failed = all.iter().filter(|x| x.is_none()).count();
    let found: Vec<Outcome> = all.into_iter().flatten().collect();
    let count = |v| found.iter().filter(|x| x.verdict == v).count();
    println!(
        "{} draws, {failed} failed; good {}, fair {}, weak {}, degenerate {}",
        o.draws,
        count(Verdict::Good),
        count(Verdict::Fair),
        count(Verdict::Weak),
        count(Verdict::Degenerate)
    );
    for (kind, wanted) in [("good or fair", Verdict::Fair), ("all", Verdict::Degenerate)] {
        let those: Vec<&Outcome> = found.iter().filter(|x| x.verdict <= wanted).collect();
        let n = those.len().max(1) as f64;
        let median = |mut list: Vec<f64>| {
            list.sort_by(f64::total_cmp);
            list.get(list.len() / 2).copied().unwrap_or(f64::NAN)
        };
        println!(
            "{kind}: {} rigs; camera's focal length: median |error| {:.3} %, median sigma {:.3} %",
            those.len(),
            median(those.iter().map(|x| x.error_percent.abs()).collect()),
            median(those.iter().map(|x| x.sigma_percent).collect())
        );
        println!(
            "  {:10} {:>8} {:>9} {:>8} {:>8} {:>8} {:>8}",
            "", "mean", "rms", "in 95 %", ">3", ">4", ">5"
        );
        for (k, name) in NAMES.iter().enumerate() {
            let z = || those.iter().map(|x| x.z[k]);
            let share = |limit: f64| 100.0 * z().filter(|z| z.abs() > limit).count() as f64 / n;
            println!(
                "  {name:10} {:8.3} {:9.3} {:7.1}% {:7.2}% {:7.2}% {:7.2}%",
                z().sum::<f64>() / n,
                (z().map(|z| z * z).sum::<f64>() / n).sqrt(),
                100.0 - share(1.96),
                share(3.0),
                share(4.0),
                share(5.0)
            );
        }
    }
    let mut warned = std::collections::BTreeMap::<&str, Vec<u64>>::new();
    for x in &found {
        x.warnings.iter().for_each(|code| warned.entry(code).or_default().push(x.seed));
    }
    for (code, seeds) in &warned {
        println!("warned {code}: {}, first by seeds {:?}", seeds.len(), &seeds[..seeds.len().min(5)]);
    }
    let mut worst: Vec<&Outcome> = found.iter().filter(|x| x.verdict <= Verdict::Fair).collect();
    worst.sort_by(|a, b| b.z[0].abs().total_cmp(&a.z[0].abs()));
    for x in worst.iter().take(5) {
        println!("seed {}: {:?} z {:.1?}", x.seed, x.verdict, x.z);
    }
}
