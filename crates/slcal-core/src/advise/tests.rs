use nalgebra::Point2;

use super::*;
use crate::calibrate::tests::scene::{ideal, observe, pose, rig, rng, with_edges};
use crate::calibrate::{Flatness, PrincipalPointRule, calibrate_observations};
use crate::geometry::{Distortion, Intrinsics};
use crate::observations::Observations;
use crate::pattern::SquareColor;

fn a2() -> RectangleSize {
    RectangleSize { width_mm: 594.0, height_mm: 420.0 }
}

fn plan(projector: bool) -> CameraPlan {
    let model = rig(768.0, vec![]);
    CameraPlan {
        camera: model.camera,
        projector: model.projector.filter(|_| projector),
        size: a2(),
        distance_mm: Some(1000.0),
        noise_px: [0.2, 0.1],
        config: CalibrateConfig::default(),
    }
}

/// σ in per cent of one photograph (or the pair) whatever the frame.
fn at(plan: &CameraPlan, a: f64, b: f64, pair: bool) -> Predicted {
    let middle = Point3::new(0.0, 0.0, plan.distance_mm.unwrap());
    let tilted = |s: f64| posed(middle, plan.size, [s * a.to_radians(), s * b.to_radians(), 0.0]);
    let poses = [tilted(1.0), tilted(-1.0)];
    let model = Model {
        camera: plan.camera,
        projector: plan.projector,
        projector_from_camera: beside(plan.projector.as_ref(), middle.z),
        views: vec![Sheet::flat(poses[0], plan.size)],
    };
    let factor = known_beforehand(&model, &plan.config);
    let sheet = (plan.size, ExpectedSheet::Corners(1.0));
    let flatness = plan.config.flatness;
    let bend = (!flatness.is_flat()).then(|| flatness.sigmas_mm(plan.size));
    let knowledge = Knowledge::new(model, factor, sheet, bend, None, plan.noise_px, |_, _| true).unwrap();
    knowledge.predict(if pair { &poses } else { &poses[..1] }).unwrap()
}

#[test]
fn one_photograph_with_exact_principal_point_has_the_known_bounds() {
    let mut plan = plan(false);
    plan.config = ideal();
    plan.config.camera_pp = PrincipalPointRule::Centre;
    // The Cramér–Rao bounds of the six tilts, per cent, as published to two digits.
    for (a, b, bound, digits) in [
        (25.0, 28.0, 0.20, 0.005),
        (15.0, 15.0, 0.38, 0.005),
        (30.0, 0.0, 0.27, 0.005),
        (0.0, 30.0, 0.29, 0.005),
        (5.0, 5.0, 2.6, 0.05),
        (3.0, 1.0, 12.9, 0.05),
    ] {
        let sigma = 100.0 * at(&plan, a, b, false).camera_focal;
        assert!((sigma - bound).abs() <= 0.03 * bound + digits, "{a} {b}: {sigma} against {bound}");
    }
    // Under the default prior the principal point limits a single photograph, and the reversed tilt takes that away.
    plan.config.camera_pp = PrincipalPointRule::Prior;
    plan.noise_px = [0.02; 2];
    let (one, pair) = (at(&plan, 25.0, 28.0, false).camera_focal, at(&plan, 25.0, 28.0, true).camera_focal);
    assert!(one > 0.015 && one < 0.03 && pair < 0.000_2, "{one} {pair}");
}

/// The 9×6 corners that the scenes of this folder project.
fn projected() -> CheckerPattern {
    CheckerPattern {
        projector: [1024, 768],
        squares: [10, 7],
        square_px: 60.0,
        origin_px: Point2::new(211.5, 173.5),
        first_square: SquareColor::Black,
        background: SquareColor::White,
        marks: None,
    }
}

fn calibrated(views: Vec<Pose>) -> Rig {
    calibrated_on(Flatness::Flat, views)
}

fn calibrated_on(flatness: Flatness, views: Vec<Pose>) -> Rig {
    let truth = rig(768.0, views);
    let mut rng = rng(5);
    let seen: Observations = observe(&truth, 0.05, 0.05, &mut rng);
    let seen = with_edges(seen, &truth, 25, 0.05, &mut rng);
    let straight = CalibrateConfig { flatness, ..ideal() };
    calibrate_observations(&seen, &straight).unwrap().rig
}

#[test]
fn what_is_predicted_is_what_the_photograph_brings() {
    for views in [vec![pose(25.0, 28.0)], vec![pose(-10.0, 30.0)], vec![pose(20.0, 20.0), pose(15.0, -25.0)]]
    {
        let before = calibrated(views.clone());
        let advice = advise_next(&before, Some(&projected())).unwrap();
        let now = advice.now.unwrap();
        let sigma = |r: &Rig| {
            let (c, p) = (r.camera, r.projector.unwrap().device);
            let (cs, ps) = (c.sigma.unwrap(), p.sigma.unwrap());
            [
                cs.focal_px / c.model.intrinsics.fx,
                ps.focal_px / p.model.intrinsics.fx,
                ps.cy_px,
                r.quality.as_ref().unwrap().expected_point_sigma_mm.unwrap(),
            ]
        };
        let expected = |p: &Predicted| {
            [p.camera_focal, p.projector_focal.unwrap(), p.projector_cy_px.unwrap(), p.point_mm.unwrap()]
        };
        for (a, b) in expected(&now).into_iter().zip(sigma(&before)) {
            assert!((a / b - 1.0).abs() < 1e-3, "now: {a} {b}");
        }
        let next = advice.next.unwrap();
        assert!(advice.worth_it || now.worst_focal() < 0.002, "{advice:?}");
        // Taken, with the same noise: the sheet in the pose, under the same projector.
        let mut all = views;
        all.push(next.camera_from_sheet);
        let after = sigma(&calibrated(all));
        for (i, (a, b)) in expected(&next.after).into_iter().zip(after).enumerate().take(3) {
            assert!((a / b - 1.0).abs() < 0.1, "{i}: predicted {a}, came out as {b}");
        }
        // The table's best is no better by much than what was chosen.
        let best =
            advice.table.iter().filter_map(|t| t.one).map(|p| p.worst_focal()).fold(f64::MAX, f64::min);
        assert!(next.after.worst_focal() <= best * 1.000_001);
    }
}

#[test]
fn words_say_which_side_is_nearer() {
    for (a, b) in [(20.0, 30.0), (-20.0, 30.0), (20.0, -30.0), (-15.0, -5.0)] {
        let pose =
            posed(Point3::new(30.0, -20.0, 1000.0), a2(), [f64::to_radians(a), f64::to_radians(b), 0.0]);
        assert!(
            (angles(&pose)[0].to_degrees() - a).abs() < 1e-9
                && (angles(&pose)[1].to_degrees() - b).abs() < 1e-9
        );
        let next = NextView {
            camera_from_sheet: pose,
            tilt_x_rad: f64::to_radians(a),
            tilt_y_rad: f64::to_radians(b),
            distance_mm: 1000.0,
            centre_px: Point2::new(640.0, 480.0),
            after: Predicted {
                camera_focal: 0.0,
                projector_focal: None,
                projector_cy_px: None,
                point_mm: None,
            },
        };
        let words = next.in_words(a2());
        let depth = |x: f64, y: f64| pose.transform(&Point3::new(x, y, 0.0)).z;
        let (left, right) = (depth(0.0, 210.0), depth(594.0, 210.0));
        let (top, bottom) = (depth(297.0, 0.0), depth(297.0, 420.0));
        let side =
            |near: &str, far: &str| format!("its {near} side nearer to the camera than its {far} side by");
        let sideways = if right < left { side("right", "left") } else { side("left", "right") };
        let upright = if top < bottom { side("top", "bottom") } else { side("bottom", "top") };
        assert!(words.contains(&sideways) && words.contains(&upright), "{words}");
        // The distance between the nearer and the farther side is that of the depths.
        let found: Vec<f64> =
            words.split("side by ").skip(1).map(|t| t.split(' ').next().unwrap().parse().unwrap()).collect();
        assert!(
            (found[0] - (left - right).abs()).abs() < 0.6 && (found[1] - (top - bottom).abs()).abs() < 0.6
        );
    }
    let flat = NextView {
        camera_from_sheet: Pose::identity(),
        tilt_x_rad: 0.0,
        tilt_y_rad: 0.0,
        distance_mm: 1.0,
        centre_px: Point2::origin(),
        after: Predicted { camera_focal: 0.0, projector_focal: None, projector_cy_px: None, point_mm: None },
    };
    assert!(flat.in_words(a2()).contains("face-on"));
}

#[test]
fn poses_are_possible_ones() {
    let before = calibrated(vec![pose(25.0, 28.0)]);
    let advice = advise_next(&before, None).unwrap();
    let next = advice.next.unwrap();
    let camera = before.camera.model;
    for c in before.views[0].size.corners() {
        let p = camera.project(&next.camera_from_sheet.transform(&Point3::new(c.x, c.y, 0.0))).unwrap();
        assert!((0.0..1279.0).contains(&p.x) && (0.0..959.0).contains(&p.y), "{p}");
    }
    // The pattern stays where the projector throws it, and the sheet is under it.
    for q in [Point2::new(295.5, 239.5), Point2::new(727.5, 527.5)] {
        let p = Model::of_rig(&before).lit(&Sheet::flat(next.camera_from_sheet, a2()), q).unwrap();
        let p = next.camera_from_sheet.inverse().transform(&p);
        assert!((0.0..=594.0).contains(&p.x) && (0.0..=420.0).contains(&p.y), "{p}");
    }
    // A tilt away from the one that there is, not more of the same.
    assert!(next.tilt_x_rad < 0.0 || next.tilt_y_rad < 0.0, "{next:?}");
    assert!(advice.worth_it && next.after.worst_focal() < 0.2 * advice.now.unwrap().worst_focal());
}

#[test]
fn a_well_known_rig_needs_no_more() {
    let tilts = [(25.0, 28.0), (-25.0, -28.0), (25.0, -28.0), (-25.0, 28.0), (0.0, 30.0), (30.0, 5.0)];
    let advice = advise_next(&calibrated(tilts.map(|(a, b)| pose(a, b)).to_vec()), None).unwrap();
    assert!(!advice.worth_it, "{:?} {:?}", advice.now, advice.next);
}

#[test]
fn first_photographs_are_planned_with_and_without_projector() {
    for with in [false, true] {
        let advice = advise_first(&plan(with)).unwrap();
        let next = advice.next.unwrap();
        assert!(advice.now.is_none() && advice.worth_it && next.after.worst_focal() < 0.02, "{next:?}");
        assert_eq!(next.after.projector_focal.is_some(), with);
        assert_eq!(advice.table.len(), 81);
        assert!(advice.table.iter().filter(|t| t.one.is_some()).count() > 30);
    }
    let odd = Camera {
        width: 640,
        height: 480,
        intrinsics: Intrinsics::square(f64::NAN, Point2::origin()),
        distortion: Distortion::NONE,
    };
    assert!(advise_first(&CameraPlan { camera: odd, ..plan(false) }).is_err());
    assert!(advise_first(&CameraPlan { distance_mm: Some(-1.0), ..plan(false) }).is_err());
    // A sheet that fits no frame at this distance.
    let near = advise_first(&CameraPlan { distance_mm: Some(100.0), ..plan(false) }).unwrap();
    assert!(near.next.is_none() && !near.worth_it);
}

#[test]
fn rigs_without_views_or_covariance_are_refused() {
    let rig = calibrated(vec![pose(25.0, 28.0)]);
    let without = Rig { covariance: None, ..rig.clone() };
    assert!(advise_next(&without, None).unwrap_err().to_string().contains("covariance"));
    let without = Rig { views: Vec::new(), ..rig.clone() };
    assert!(advise_next(&without, None).unwrap_err().to_string().contains("views"));
    let other = CheckerPattern { projector: [800, 600], ..projected() };
    assert!(advise_next(&rig, Some(&other)).unwrap_err().to_string().contains("800x600"));
}

#[test]
fn sheets_that_may_bend_tell_less() {
    // From rigs of their own, and from what the rig of flat sheets knows.
    let rigs = [Flatness::Flat, Flatness::Board, Flatness::Paper]
        .map(|flatness| calibrated_on(flatness, vec![pose(25.0, 28.0), pose(-25.0, -28.0)]));
    let sigmas = rigs.each_ref().map(|rig| advise_next(rig, Some(&projected())).unwrap().now.unwrap());
    assert!(
        sigmas[0].camera_focal < sigmas[1].camera_focal && sigmas[1].camera_focal < sigmas[2].camera_focal
    );
    let known = rigs.each_ref().map(|rig| Knowledge::of_rig(rig, Some(&projected())).unwrap());
    let more = [pose(20.0, -25.0)];
    let after = known.each_ref().map(|k| {
        let mut same = k.clone();
        same.factor.clone_from(&known[0].factor);
        same.predict(&more).unwrap()
    });
    for [flatter, other] in [[after[0], after[1]], [after[1], after[2]]] {
        assert!(flatter.camera_focal < other.camera_focal, "{after:?}");
        assert!(flatter.projector_focal < other.projector_focal && flatter.point_mm < other.point_mm);
    }
    // The plan of a first photograph says it as well: in a pair the bend is what limits, or else the noise.
    let first = |flatness| {
        let plan =
            CameraPlan { noise_px: [0.02; 2], config: CalibrateConfig { flatness, ..ideal() }, ..plan(true) };
        at(&plan, 25.0, 28.0, true).camera_focal
    };
    let [flat, board, paper] = [Flatness::Flat, Flatness::Board, Flatness::Paper].map(first);
    assert!(flat < board && 1.5 * board < paper, "{flat} {board} {paper}");
}
