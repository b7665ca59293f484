//! Scans by a sequence, without a browser, files or a clock.

use super::photographs::SHOT_LOST_MS;
use super::tests::{PANEL, calibrated, demo, found, photo, settings, step, with_display};
use super::{Effect, Machine, Options};
use crate::studio::event::{DisplayEvent, OperatorEvent, ScanMode};
use crate::studio::job::{Done, Job};
use crate::studio::live::Look;
use crate::studio::project::{Purpose, StoredPhoto};
use crate::studio::scan_folder::ScanFolder;
use crate::studio::simulated_camera::PHOTO_PX;
use crate::studio::state::{CameraKind, CloudEntry, Measured, Picture, ScanMethod, Step, Unfinished};

/// White, black, ten bits with their inverses.
const GRAY_FRAMES: usize = 22;

fn operate(machine: &mut Machine, event: OperatorEvent) -> Vec<Effect> {
    machine.operate(event).unwrap()
}

/// In the step Scan, with this method.
fn ready(machine: &mut Machine, method: ScanMethod) {
    with_display(machine);
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    machine.done(calibrated(&[1]), 0);
    step(machine, Step::Scan).unwrap();
    operate(machine, OperatorEvent::ScanMethod { method });
}

fn start(machine: &mut Machine) -> Vec<Effect> {
    operate(machine, OperatorEvent::Scan { mode: ScanMode::Once })
}

fn paint(machine: &mut Machine, now_ms: u64) -> Vec<Effect> {
    machine.at(now_ms);
    let sequence = machine.state.display.wanted.sequence;
    machine.display(DisplayEvent::Painted { sequence })
}

fn look(machine: &mut Machine, now_ms: u64, level: u8) -> Vec<Effect> {
    let frame = image::RgbImage::from_pixel(8, 8, image::Rgb([level; 3]));
    machine.done(Done::Look(Look::at(1, &frame)), now_ms)
}

/// Measures a delay of 120 ms with frames every 40 ms; what follows it, and the time.
fn flash(machine: &mut Machine) -> (Vec<Effect>, u64) {
    assert_eq!(machine.state.display.wanted.kind, Picture::Black);
    paint(machine, 1000);
    let mut lit_ms = u64::MAX;
    for now in (1040..9000).step_by(40) {
        let effects = look(machine, now, if now >= lit_ms { 90 } else { 20 });
        if effects.iter().any(|e| matches!(e, Effect::Work(Job::BeginScan(_)))) {
            return (effects, now);
        }
        if machine.state.display.wanted.kind == Picture::White && lit_ms == u64::MAX {
            assert!(effects.iter().any(|e| matches!(e, Effect::Tell)), "pages must hear of it");
            paint(machine, now + 5);
            lit_ms = now + 125;
        }
    }
    panic!("the delay was not measured");
}

fn folder(id: u32) -> ScanFolder {
    ScanFolder { id, name: format!("scan-{id:03}") }
}

fn frame(id: u32, frame: usize) -> (Purpose, StoredPhoto) {
    let name = format!("scan-{id:03}/frame_{frame:03}.png");
    (Purpose::Frame { scan: id, frame }, StoredPhoto { id, name })
}

fn webcam() -> Machine {
    let (mut machine, _) = Machine::new(&settings(Some("A4")), Options::default());
    machine.done(Done::Begun, 0);
    machine.done(Done::Looked, 0);
    let camera = OperatorEvent::Camera { kind: CameraKind::Webcam, size: Some(PHOTO_PX), held: vec![] };
    operate(&mut machine, camera);
    machine
}

/// The display fills the panel.
fn fill(machine: &mut Machine) {
    machine.displays(1);
    let measured = Measured { device_pixel_ratio: 1.0, screen: PANEL, viewport: PANEL, fullscreen: true };
    machine.display(DisplayEvent::Measured { measured, problem: None });
}

#[test]
fn each_picture_is_shown_acknowledged_awaited_and_photographed() {
    let mut machine = webcam();
    ready(&mut machine, ScanMethod::Gray);
    fill(&mut machine);
    assert_eq!(machine.state.display.wanted.kind, Picture::White);
    assert!(start(&mut machine).is_empty());
    let shots = machine.state.scan.shots.clone().unwrap();
    assert_eq!((shots.frame, shots.of, shots.by_hand), (0, GRAY_FRAMES, false));
    let (effects, mut now) = flash(&mut machine);
    let Some(Effect::Work(Job::BeginScan(pattern))) = effects.last() else { panic!("{effects:?}") };
    assert_eq!(pattern.frames.len(), GRAY_FRAMES);
    let latency = machine.state.camera.latency_ms.unwrap();
    assert!((120..=200).contains(&latency), "{latency}");
    machine.done(Done::ScanBegun(folder(3)), now);
    for i in 0..GRAY_FRAMES {
        assert_eq!(machine.state.scan.shots.as_ref().unwrap().frame, i + 1);
        assert_eq!(machine.wanted_frame().unwrap().1, i);
        // Before it is acknowledged, nothing is photographed however long that takes.
        assert!(machine.tick(now + 3000, true).is_empty());
        now += 3000;
        assert!(paint(&mut machine, now).is_empty());
        // The camera still shows the picture before.
        assert!(machine.tick(now + u64::from(latency), true).is_empty());
        now += 500;
        let effects = machine.tick(now, true);
        let [Effect::Shoot { shot, purpose }] = effects[..] else { panic!("{effects:?}") };
        assert_eq!(machine.purpose_of(Some(shot)), Ok(purpose));
        assert!(machine.tick(now + 10, true).is_empty(), "one photograph of each");
        let (expected, kept) = frame(3, i);
        assert_eq!(purpose, expected);
        let effects = machine.kept(purpose, kept);
        let is_last = i + 1 == GRAY_FRAMES;
        assert_eq!(
            effects.iter().any(|e| matches!(e, Effect::Work(Job::SequenceCloud(f)) if *f == folder(3))),
            is_last
        );
    }
    assert!(machine.state.scan.shots.is_none() && machine.state.scan.unfinished.is_empty());
    assert_eq!(machine.state.display.wanted.kind, Picture::White);
    let entry = CloudEntry {
        id: 3,
        name: "scan-003.ply".into(),
        points: 9,
        triangles: 0,
        url: String::new(),
        photo: String::new(),
        photo_name: "scan-003".into(),
        frames: Some(GRAY_FRAMES),
        saved: vec![],
        warnings: vec![],
        rig: "[1]".into(),
        outdated: false,
    };
    let effects = machine.done(Done::Cloud(entry), now);
    let command =
        "slcal reconstruct --rig rig.json --pattern scan-003/sequence.json scan-003 --mesh -o scan-003.ply";
    assert!(matches!(&effects[..], [Effect::Log(logged)] if logged == command), "{effects:?}");
    let effects = operate(&mut machine, OperatorEvent::Reconstruct { id: 3 });
    assert!(matches!(&effects[..], [Effect::Work(Job::SequenceCloud(f))] if *f == folder(3)));
    // The delay is known by now, until there is another camera.
    assert!(matches!(start(&mut machine)[..], [Effect::Work(Job::BeginScan(_))]));
    operate(&mut machine, OperatorEvent::Scan { mode: ScanMode::Stop });
    machine.operator_changed();
    assert_eq!(machine.state.camera.latency_ms, None);
}

#[test]
fn phase_shift_has_a_sinusoid_and_the_method_is_kept() {
    let mut machine = demo();
    ready(&mut machine, ScanMethod::Phase);
    start(&mut machine);
    let (effects, _) = flash(&mut machine);
    let Some(Effect::Work(Job::BeginScan(pattern))) = effects.last() else { panic!("{effects:?}") };
    let code = pattern.code(slcal_core::pattern::Axis::Columns).unwrap();
    assert!(code.sinusoid.is_some() && pattern.code(slcal_core::pattern::Axis::Rows).is_none());
    assert_eq!(machine.settings().scan_method, ScanMethod::Phase);
    let (again, _) = Machine::new(&machine.settings(), Options { demo: true, ..Options::default() });
    assert_eq!(again.state.scan.method, ScanMethod::Phase);
}

#[test]
fn a_scan_that_is_stopped_is_told_as_unfinished_and_takes_no_late_photograph() {
    let mut machine = demo();
    ready(&mut machine, ScanMethod::Gray);
    start(&mut machine);
    let (_, now) = flash(&mut machine);
    machine.done(Done::ScanBegun(folder(1)), now);
    paint(&mut machine, now);
    let effects = machine.tick(now + 900, true);
    assert!(matches!(
        effects[..],
        [Effect::Work(Job::TakeSimulated(Purpose::Frame { scan: 1, frame: 0 }, _))]
    ));
    let (purpose, kept) = frame(1, 0);
    machine.kept(purpose, kept);
    // What would disturb it is refused.
    for event in [
        OperatorEvent::Take,
        OperatorEvent::Show { kind: Picture::Black },
        OperatorEvent::ScanMethod { method: ScanMethod::Phase },
        OperatorEvent::Scan { mode: ScanMode::Once },
        OperatorEvent::Photograph { id: 1, used: false },
    ] {
        assert_eq!(machine.operate(event).unwrap_err().code, "scan-under-way");
    }
    operate(&mut machine, OperatorEvent::Scan { mode: ScanMode::Stop });
    let left = Unfinished { name: "scan-001".into(), have: 1, of: GRAY_FRAMES };
    assert_eq!(machine.state.scan.unfinished, [left]);
    assert!(machine.state.scan.shots.is_none() && machine.state.busy.is_none());
    let (purpose, kept) = frame(1, 1);
    assert!(machine.kept(purpose, kept).is_empty());
    assert_eq!(machine.state.display.wanted.kind, Picture::White);
}

#[test]
fn what_a_sequence_needs_must_stay() {
    let begun = || {
        let mut machine = webcam();
        ready(&mut machine, ScanMethod::Gray);
        fill(&mut machine);
        start(&mut machine);
        let (_, now) = flash(&mut machine);
        machine.done(Done::ScanBegun(folder(1)), now);
        (machine, now)
    };
    let ended = |machine: &Machine, code: &str| {
        assert_eq!(machine.state.problem.as_ref().map(|p| p.code), Some(code));
        assert!(machine.state.scan.shots.is_none() && machine.state.scan.unfinished.len() == 1);
    };
    let (mut machine, _) = begun();
    machine.displays(0);
    ended(&machine, "scan-interrupted");
    assert_eq!(machine.state.camera.latency_ms, None, "another display has another delay");

    let (mut machine, _) = begun();
    operate(&mut machine, OperatorEvent::CameraLost { message: "gone".into() });
    ended(&machine, "scan-interrupted");

    // Somebody leaves full screen.
    let (mut machine, _) = begun();
    let measured =
        Measured { device_pixel_ratio: 1.0, screen: PANEL, viewport: [900, 600], fullscreen: false };
    machine.display(DisplayEvent::Measured { measured, problem: None });
    ended(&machine, "display-not-full-screen");

    // A photograph does not come.
    let (mut machine, now) = begun();
    paint(&mut machine, now);
    assert!(matches!(machine.tick(now + 900, true)[..], [Effect::Shoot { .. }]));
    assert!(machine.give_up(now + 901 + SHOT_LOST_MS));
    ended(&machine, "photograph-lost");

    let (mut machine, now) = begun();
    let full = crate::studio::state::Problem::new("failed", "the disk is full", "");
    machine.done(Done::Failed(full), now);
    ended(&machine, "failed");

    // Another step is a decision, not a problem.
    let (mut machine, _) = begun();
    step(&mut machine, Step::Use).unwrap();
    assert!(machine.state.problem.is_none() && machine.state.scan.unfinished.len() == 1);
}

#[test]
fn a_camera_that_sees_no_flash_is_told() {
    let mut machine = demo();
    ready(&mut machine, ScanMethod::Gray);
    start(&mut machine);
    paint(&mut machine, 1000);
    for now in (1040..3000).step_by(40) {
        look(&mut machine, now, 20);
        if machine.state.display.wanted.kind == Picture::White {
            paint(&mut machine, now);
        }
    }
    // Frames do not even come any more.
    assert!(!machine.give_up(3000) && machine.give_up(40_000));
    assert_eq!(machine.state.problem.as_ref().unwrap().code, "flash-not-seen");
    assert!(machine.state.scan.unfinished.is_empty() && machine.state.busy.is_none());
}

#[test]
fn a_camera_with_its_own_button_leads_the_sequence() {
    let options = Options { watch: Some("/shots".into()), ..Options::default() };
    let (mut machine, _) = Machine::new(&settings(Some("A4")), options);
    machine.done(Done::Begun, 0);
    machine.done(Done::Looked, 0);
    operate(&mut machine, OperatorEvent::Camera { kind: CameraKind::Folder, size: None, held: vec![] });
    ready(&mut machine, ScanMethod::Gray);
    fill(&mut machine);
    // There is nothing to measure: whoever takes the photograph sees the picture.
    assert!(matches!(start(&mut machine)[..], [Effect::Work(Job::BeginScan(_))]));
    machine.done(Done::ScanBegun(folder(2)), 0);
    for i in 0..2 {
        assert_eq!(machine.purpose_of(None).unwrap_err().code, super::FRAME_NOT_SHOWN);
        assert!(crate::studio::words::words(&machine.state).next.starts_with("Wait"));
        paint(&mut machine, 100);
        let said = crate::studio::words::words(&machine.state);
        assert!(said.sentence.starts_with(&format!("Picture {} of 22", i + 1)), "{said:?}");
        assert!(said.next.starts_with("Take the photograph with the camera."), "{said:?}");
        // It takes its time.
        assert!(!machine.give_up(100 + 9 * SHOT_LOST_MS) && machine.tick(200_000, true).is_empty());
        let purpose = machine.purpose_of(None).unwrap();
        assert_eq!(purpose, frame(2, i).0);
        machine.kept(purpose, frame(2, i).1);
    }
}

#[test]
fn a_sequence_needs_the_display_and_scans_once() {
    let mut machine = demo();
    ready(&mut machine, ScanMethod::Gray);
    let refused = machine.operate(OperatorEvent::Scan { mode: ScanMode::Start }).unwrap_err();
    assert_eq!(refused.code, "continuous-sequence");
    machine.displays(0);
    let refused = machine.operate(OperatorEvent::Scan { mode: ScanMode::Once }).unwrap_err();
    assert_eq!(refused.code, "display-missing");
    let mut machine = demo();
    let refused = machine.operate(OperatorEvent::ScanMethod { method: ScanMethod::Gray });
    assert!(refused.is_ok() && machine.operate(OperatorEvent::Scan { mode: ScanMode::Once }).is_err());
}

#[test]
fn what_an_earlier_run_left_is_told_or_gets_its_cloud() {
    let mut machine = demo();
    let left = Unfinished { name: "scan-001".into(), have: 5, of: GRAY_FRAMES };
    machine.done(Done::Unfinished(left.clone()), 0);
    machine.done(Done::CloudMissing(Job::SequenceCloud(folder(2))), 0);
    machine.done(Done::Sheet { photo: photo(1), found: Ok(found()) }, 0);
    let effects = machine.done(calibrated(&[1]), 0);
    assert!(matches!(&effects[..], [Effect::Work(Job::SequenceCloud(f))] if *f == folder(2)));
    assert_eq!(machine.state.scan.unfinished, [left]);
}
