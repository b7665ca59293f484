//! What follows from events, without a browser, files or a clock.

use std::sync::Arc;

use slcal_core::CheckerConfig;

use super::photographs::SHOT_LOST_MS;
use super::{Effect, Machine, Options};
use crate::studio::event::{DisplayEvent, OperatorEvent, ScanMode};
use crate::studio::job::{Calibrated, Done, Job, SheetFound};
use crate::studio::live::Look;
use crate::studio::project::{Purpose, Settings, StoredPhoto};
use crate::studio::simulated_camera::PHOTO_PX;
use crate::studio::state::{CameraKind, CloudEntry, DemoObject, DemoPose, Measured, Picture, Problem, Step};

pub(super) const PANEL: [u32; 2] = [1024, 768];

pub(super) fn settings(size: Option<&str>) -> Settings {
    Settings { projector: Some(PANEL), size: size.map(str::to_owned), ..Settings::default() }
}

pub(super) fn demo() -> Machine {
    let options = Options { demo: true, ..Options::default() };
    let (mut machine, effects) = Machine::new(&settings(Some("594x420mm")), options);
    assert!(matches!(effects[..], [Effect::Work(Job::Begin(..))]));
    machine.done(Done::Begun, 0);
    machine.done(Done::Looked, 0);
    machine
}

pub(super) fn with_display(machine: &mut Machine) {
    machine.displays(1);
    let sequence = machine.state.display.wanted.sequence;
    machine.display(DisplayEvent::Painted { sequence });
}

pub(super) fn photo(id: u32) -> StoredPhoto {
    StoredPhoto { id, name: format!("sheet-{id:03}.jpg") }
}

pub(super) fn found() -> SheetFound {
    SheetFound { corners: 70, of: 70, outline: None, size: PHOTO_PX }
}

/// A calibration of photographs as a machine is told it: from rendered observations.
pub(super) fn calibrated(used: &[u32]) -> Done {
    use slcal_core::simulate::{Draws, NoiseModel, PoseConfig, RigConfig, Scene};
    let poses: Vec<_> =
        (0..used.len()).map(|i| PoseConfig::tilted(25.0, 28.0 - 56.0 * (i % 2) as f64)).collect();
    let scene = Scene::new(&RigConfig::default(), &poses).unwrap();
    let observations = scene.observe(&NoiseModel::default(), &mut Draws::new(1, 0)).unwrap();
    let calibration =
        slcal_core::calibrate_observations(&observations, &slcal_core::CalibrateConfig::default()).unwrap();
    let rig = Arc::new(calibration.rig);
    let checker = slcal_core::CheckerPattern::new(PANEL, &CheckerConfig::default()).unwrap();
    let guide = crate::studio::guide::next(&rig, &checker).unwrap();
    Done::Calibrated(Ok(Calibrated { rig, fingerprint: format!("{used:?}"), used: used.to_vec(), guide }))
}

pub(super) fn step(machine: &mut Machine, step: Step) -> Result<Vec<Effect>, Problem> {
    machine.operate(OperatorEvent::Step { step })
}

#[test]
fn what_is_missing_is_asked_for_one_by_one() {
    let (mut machine, effects) = Machine::new(&Settings::default(), Options::default());
    assert!(effects.is_empty() && machine.state.set_up.missing.unwrap().contains("resolution"));
    assert_eq!(step(&mut machine, Step::Calibrate).unwrap_err().code, "step-locked");
    let set = |m: &mut Machine, projector, size: Option<&str>| {
        m.operate(OperatorEvent::SetUp { projector, size: size.map(str::to_owned), pattern_scale: None })
    };
    assert_eq!(set(&mut machine, Some([10, 10]), None).unwrap_err().code, "set-up-projector");
    set(&mut machine, Some(PANEL), None).unwrap();
    assert!(machine.state.set_up.missing.unwrap().contains("sheet"));
    assert_eq!(set(&mut machine, None, Some("A44")).unwrap_err().code, "set-up-size");
    let effects = set(&mut machine, None, Some("A4")).unwrap();
    assert!(matches!(effects[..], [Effect::Work(Job::Begin(b, _)), Effect::Save] if b.projector == PANEL));
    assert!(machine.state.set_up.missing.unwrap().contains("camera"));
    machine.operate(OperatorEvent::Camera { kind: CameraKind::Files, size: None, held: vec![] }).unwrap();
    assert!(machine.state.set_up.done);
    step(&mut machine, Step::Calibrate).unwrap();
    assert_eq!(step(&mut machine, Step::Scan).unwrap_err().code, "step-locked");
    let kept = machine.settings();
    assert_eq!((kept.projector, kept.size.as_deref(), kept.step), (Some(PANEL), Some("A4"), Step::Calibrate));
}

#[test]
fn a_photograph_waits_until_the_display_has_painted() {
    let mut machine = demo();
    machine.displays(1);
    step(&mut machine, Step::Calibrate).unwrap();
    assert!(machine.operate(OperatorEvent::Take).unwrap().is_empty());
    let before = machine.state.display.wanted.sequence - 1;
    assert!(machine.display(DisplayEvent::Painted { sequence: before }).is_empty());
    let sequence = machine.state.display.wanted.sequence;
    let effects = machine.display(DisplayEvent::Painted { sequence });
    assert!(matches!(effects[..], [Effect::Work(Job::TakeSimulated(Purpose::Sheet, _))]));
}

#[test]
fn a_display_that_scales_is_refused() {
    let (mut machine, _) = Machine::new(&settings(Some("A4")), Options::default());
    machine.done(Done::Begun, 0);
    let webcam = OperatorEvent::Camera { kind: CameraKind::Webcam, size: Some(PHOTO_PX), held: vec![] };
    machine.operate(webcam).unwrap();
    step(&mut machine, Step::Calibrate).unwrap();
    machine.displays(1);
    let measured =
        Measured { device_pixel_ratio: 1.25, screen: [1280, 960], viewport: [1280, 960], fullscreen: true };
    machine.display(DisplayEvent::Measured { measured, problem: None });
    assert_eq!(machine.operate(OperatorEvent::Take).unwrap_err().code, "display-scaled");
    let measured = Measured { screen: PANEL, viewport: PANEL, ..measured };
    machine.display(DisplayEvent::Measured { measured, problem: None });
    let sequence = machine.state.display.wanted.sequence;
    machine.display(DisplayEvent::Painted { sequence });
    let effects = machine.operate(OperatorEvent::Take).unwrap();
    assert!(matches!(effects[..], [Effect::Shoot { shot: 1, purpose: Purpose::Sheet }]));
    // The page does not deliver it.
    assert!(!machine.give_up(SHOT_LOST_MS) && machine.state.busy.is_some());
    assert!(machine.give_up(SHOT_LOST_MS + 1) && machine.state.busy.is_none());
    assert_eq!(machine.state.problem.as_ref().unwrap().code, "photograph-lost");
    // Somebody zooms the page.
    machine.display(DisplayEvent::Measured {
        measured: Measured { screen: [1126, 845], ..measured },
        problem: None,
    });
    assert!(!machine.state.display.shows_what_is_wanted());
}

#[test]
fn two_photographs_lead_to_a_scan() {
    let mut machine = demo();
    with_display(&mut machine);
    step(&mut machine, Step::Calibrate).unwrap();
    for id in [1, 2] {
        let effects = machine.done(Done::Kept(Purpose::Sheet, photo(id)), 0);
        assert!(matches!(&effects[..], [Effect::Work(Job::Sheet(p))] if p.id == id));
        let effects = machine.done(Done::Sheet { photo: photo(id), found: Ok(found()) }, 0);
        let all: Vec<u32> = (1..=id).collect();
        assert!(matches!(&effects[..], [Effect::Work(Job::Calibrate(used))] if *used == all));
        let effects = machine.done(calibrated(&all), 0);
        assert!(matches!(&effects[..], [Effect::Log(c)] if c.starts_with("slcal calibrate sheet-001.jpg")));
    }
    let calibration = machine.state.calibration.as_ref().unwrap();
    assert!(calibration.figures[0].before.is_some() && calibration.photographs == 2);
    assert!(machine.state.photographs.iter().all(|p| p.rms_px.is_some() && p.tilt_deg.is_some()));
    step(&mut machine, Step::Scan).unwrap();
    assert_eq!(machine.state.display.wanted.kind, Picture::Stripes);
    assert_eq!(machine.state.demo_scene.unwrap().object, DemoObject::Sphere);
    // Without photographs there is no calibration, and no scan.
    let leave = |m: &mut Machine, id| m.operate(OperatorEvent::Photograph { id, used: false }).unwrap();
    assert!(matches!(leave(&mut machine, 1)[..], [Effect::Save, Effect::Work(Job::Calibrate(_))]));
    let effects = leave(&mut machine, 2);
    assert!(matches!(
        effects[..],
        [Effect::Save, Effect::Work(Job::Forget), Effect::Work(Job::FirstGuide(_))]
    ));
    assert!(machine.state.calibration.is_none() && machine.state.locked(Step::Scan).is_some());
    assert_eq!(machine.settings().left_out, ["sheet-001.jpg", "sheet-002.jpg"]);
}

#[test]
fn another_pattern_would_contradict_the_photographs() {
    let mut machine = demo();
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    let scale = OperatorEvent::SetUp { projector: None, size: None, pattern_scale: Some(0.6) };
    assert_eq!(machine.operate(scale).unwrap_err().code, "set-up-photographs");
    assert_eq!(machine.state.set_up.pattern_scale, 1.0);
}

#[test]
fn a_continuous_scan_counts_its_clouds() {
    let mut machine = demo();
    with_display(&mut machine);
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    machine.done(calibrated(&[1]), 0);
    step(&mut machine, Step::Scan).unwrap();
    machine.operate(OperatorEvent::Scan { mode: ScanMode::Start }).unwrap();
    assert_eq!(machine.state.camera.live_longest_px, 0);
    let frame = image::RgbImage::new(4, 4);
    for i in 1..=20 {
        let look = Look::at(i, &frame);
        let done = Done::LiveCloud { look, points: 99, bytes: Arc::new([]) };
        let effects = machine.done(done, 50 * u64::from(i));
        assert!(effects.iter().any(|e| matches!(e, Effect::LiveCloud { .. })));
    }
    assert!((machine.state.scan.fps - 20.0).abs() < 0.5);
    let effects = machine.operate(OperatorEvent::Scan { mode: ScanMode::Stop }).unwrap();
    assert!(matches!(effects[..], [Effect::Work(Job::KeepLive)]) && machine.state.scan.live.is_none());
}

#[test]
fn the_simulated_camera_rests_when_nobody_looks() {
    let mut machine = demo();
    assert!(machine.tick(1000, false).is_empty());
    assert!(matches!(machine.tick(1000, true)[..], [Effect::Live(_)]));
    // One frame at a time.
    assert!(machine.tick(2000, true).is_empty());
    machine.done(Done::Look(Look::at(1, &image::RgbImage::new(4, 4))), 2000);
    assert!(matches!(machine.tick(2001, true)[..], [Effect::Live(_)]));
}

#[test]
fn a_photograph_of_another_size_that_is_left_out_hinders_no_more() {
    let mut machine = demo();
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    let other = Problem::new("failed", "another size", "");
    machine.done(Done::Sheet { photo: photo(2), found: Err(other) }, 0);
    let effects = machine.operate(OperatorEvent::Photograph { id: 1, used: false }).unwrap();
    assert!(
        matches!(&effects[..], [Effect::Save, Effect::Work(Job::Begin(_, out))] if out.contains("sheet-001.jpg"))
    );
}

#[test]
fn what_an_interrupted_run_left_gets_its_cloud() {
    let mut machine = demo();
    let scan = StoredPhoto { id: 1, name: "scan-001.jpg".into() };
    machine.done(Done::CloudMissing(Job::Cloud(scan)), 0);
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    let effects = machine.done(calibrated(&[1]), 0);
    assert!(matches!(&effects[..], [Effect::Work(Job::Cloud(p))] if p.name == "scan-001.jpg"));
}

#[test]
fn a_step_that_is_left_takes_its_waiting_photograph_along() {
    let mut machine = demo();
    machine.displays(1);
    step(&mut machine, Step::Calibrate).unwrap();
    machine.operate(OperatorEvent::Take).unwrap();
    step(&mut machine, Step::SetUp).unwrap();
    assert_eq!(machine.operate(OperatorEvent::Take).unwrap_err().code, "photograph-unasked");
    let sequence = machine.state.display.wanted.sequence;
    assert!(machine.display(DisplayEvent::Painted { sequence }).is_empty());
}

#[test]
fn a_photograph_is_what_its_shot_was_asked_for() {
    let (mut machine, _) = Machine::new(&settings(Some("A4")), Options::default());
    machine.done(Done::Begun, 0);
    let webcam = OperatorEvent::Camera { kind: CameraKind::Webcam, size: Some(PHOTO_PX), held: vec![] };
    machine.operate(webcam).unwrap();
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    machine.done(calibrated(&[1]), 0);
    step(&mut machine, Step::Scan).unwrap();
    let effects = machine.operate(OperatorEvent::Take).unwrap();
    let [Effect::Shoot { shot, purpose: Purpose::Scan }] = effects[..] else { panic!("{effects:?}") };
    // It is still on its way.
    step(&mut machine, Step::Calibrate).unwrap();
    assert_eq!(machine.purpose_of(Some(shot)), Ok(Purpose::Scan));
    assert_eq!(machine.purpose_of(None), Ok(Purpose::Sheet));
    step(&mut machine, Step::SetUp).unwrap();
    assert_eq!(machine.purpose_of(Some(shot)), Ok(Purpose::Scan));
    assert_eq!(machine.purpose_of(Some(shot + 1)).unwrap_err().code, "photograph-unasked");
}

#[test]
fn clouds_of_an_earlier_calibration_are_marked_and_made_again() {
    let mut machine = demo();
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    machine.done(calibrated(&[1]), 0);
    let cloud = |id: u32, rig: &str| {
        Done::Cloud(CloudEntry {
            id,
            name: format!("scan-{id:03}.ply"),
            points: 9,
            triangles: 0,
            url: String::new(),
            photo: String::new(),
            photo_name: format!("scan-{id:03}.jpg"),
            frames: None,
            saved: vec![],
            warnings: vec![],
            rig: rig.into(),
            outdated: false,
        })
    };
    let outdated = |m: &Machine| m.state.scan.clouds.iter().map(|c| c.outdated).collect::<Vec<_>>();
    machine.done(cloud(1, "[1]"), 0);
    machine.done(cloud(2, "[1]"), 0);
    assert_eq!(outdated(&machine), [false, false]);
    machine.done(Done::Sheet { photo: photo(2), found: Ok(found()) }, 0);
    machine.done(calibrated(&[1, 2]), 0);
    assert_eq!(outdated(&machine), [true, true]);
    let effects = machine.operate(OperatorEvent::Reconstruct { id: 1 }).unwrap();
    assert!(matches!(&effects[..], [Effect::Work(Job::Cloud(p))] if p.name == "scan-001.jpg"));
    machine.done(cloud(1, "[1, 2]"), 0);
    assert_eq!(outdated(&machine), [false, true]);
    assert_eq!(machine.operate(OperatorEvent::Reconstruct { id: 7 }).unwrap_err().code, "no-cloud");
}

#[test]
fn a_display_that_is_closed_ends_the_scan_and_leaving_the_step_keeps_its_cloud() {
    for leave in [true, false] {
        let mut machine = demo();
        with_display(&mut machine);
        machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
        machine.done(calibrated(&[1]), 0);
        step(&mut machine, Step::Scan).unwrap();
        machine.operate(OperatorEvent::Scan { mode: ScanMode::Start }).unwrap();
        let look = Look::at(1, &image::RgbImage::new(4, 4));
        machine.done(Done::LiveCloud { look, points: 9, bytes: Arc::new([]) }, 50);
        let effects = if leave { step(&mut machine, Step::Use).unwrap() } else { machine.displays(0) };
        assert!(matches!(effects[0], Effect::Work(Job::KeepLive)), "{effects:?}");
        assert!(!machine.state.scan.continuous);
    }
}

#[test]
fn a_picture_is_said_to_be_projected_where_it_is() {
    let mut machine = demo();
    with_display(&mut machine);
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    machine.done(calibrated(&[1]), 0);
    step(&mut machine, Step::Use).unwrap();
    machine.done(Done::Picture { name: "my cat".into(), file: "picture-source.png".into() }, 0);
    let said = |m: &Machine| crate::studio::words::words(&m.state);
    assert!(said(&machine).sentence.starts_with("my cat is projected"), "{:?}", said(&machine));
    assert!(said(&machine).command.unwrap().contains("--image picture-source.png"));
    let pose = machine.state.demo_scene.unwrap().pose;
    machine
        .operate(OperatorEvent::Turn { pose: DemoPose { roll_deg: pose.roll_deg + 5.0, ..pose } })
        .unwrap();
    assert_eq!(machine.state.in_use.straight, Some(false));
    assert!(said(&machine).sentence.contains("has moved"));
    machine.operate(OperatorEvent::Show { kind: Picture::Black }).unwrap();
    assert!(said(&machine).sentence.starts_with("my cat is drawn"));
    machine.displays(0);
    assert!(said(&machine).sentence.contains("not open"));
    // Back in the step, the simulated sheet is where it was.
    step(&mut machine, Step::Scan).unwrap();
    step(&mut machine, Step::Use).unwrap();
    assert_eq!(machine.state.in_use.straight, Some(true));
}

#[test]
fn a_photograph_without_a_sheet_is_told_at_once() {
    let mut machine = demo();
    let none = Problem::new("failed", "no sheet", "");
    machine.done(Done::Sheet { photo: photo(1), found: Err(none) }, 0);
    let problem = machine.state.problem.as_ref().unwrap();
    assert!(problem.code == "photograph-refused" && problem.message == "sheet-001.jpg: no sheet");
}
