//! The work from a first photograph to the pose that is advised after it, without server and pages.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::checker::checker;
use super::job::{Bench, Calibrated, Done, Job, LiveFrame, LookFor};
use super::project::{Project, Purpose};
use super::simulated_camera::FIRST_POSE;
use super::state::{DemoObject, DemoPose, DemoScene};
use super::worker::{Pictures, Worker};

#[test]
fn after_a_sheet_that_was_seen_face_on_the_pose_that_is_advised_is_seen_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (project, _) = Project::open(&folder.path().join("demo")).unwrap();
    let pictures = Arc::new(Pictures::default());
    let mut worker = Worker::new(Arc::new(project), pictures.clone(), true);
    let mut work = |job| {
        let mut all = Vec::new();
        worker.work(job, &mut |done| all.push(done));
        all
    };
    let bench = Bench { projector: [1024, 768], sheet: "594x420mm".parse().unwrap(), pattern_scale: 1.0 };
    work(Job::Begin(bench, BTreeSet::new()));
    pictures.paint(checker(bench.projector, 1.0).unwrap().image().unwrap());
    let scene = |pose| DemoScene { pose, object: DemoObject::Sheet };
    let kept = work(Job::TakeSimulated(Purpose::Sheet, scene(FIRST_POSE)));
    let [Done::Kept(_, photo)] = &kept[..] else { panic!("{kept:?}") };
    work(Job::Sheet(photo.clone()));
    let done = work(Job::Calibrate(vec![photo.id]));
    let [Done::Calibrated(Ok(Calibrated { guide: Some(guide), .. }))] = &done[..] else { panic!("{done:?}") };
    let frame = LiveFrame {
        seq: 1,
        picture: None,
        look_for: LookFor::Sheet,
        wanted: Some((guide.size, guide.quad)),
        scene: Some(scene(guide.turn.unwrap())),
    };
    let Some(Done::Look(look)) = worker.look(&frame) else { panic!("no look") };
    assert!(look.is_complete() && look.near.unwrap() > 0.6, "{look:?}");
}

#[test]
fn a_sequence_becomes_a_cloud_and_what_was_not_finished_is_told_at_the_next_start() {
    use slcal_core::evaluate::{FitConfig, fit_sphere};
    use slcal_core::pattern::{SequenceConfig, SequencePattern};
    let folder = tempfile::tempdir().unwrap();
    let (project, _) = Project::open(&folder.path().join("demo")).unwrap();
    let (project, pictures) = (Arc::new(project), Arc::new(Pictures::default()));
    let bench = Bench { projector: [1024, 768], sheet: "594x420mm".parse().unwrap(), pattern_scale: 1.0 };
    let mut worker = Worker::new(project.clone(), pictures.clone(), true);
    let mut work = |job| {
        let mut all = Vec::new();
        worker.work(job, &mut |done| all.push(done));
        all
    };
    work(Job::Begin(bench, BTreeSet::new()));
    pictures.paint(checker(bench.projector, 1.0).unwrap().image().unwrap());
    let tilted = |tilt_deg| DemoPose { tilt_deg, ..FIRST_POSE };
    for pose in [tilted([22.0, 20.0]), tilted([-22.0, -20.0])] {
        let kept = work(Job::TakeSimulated(Purpose::Sheet, DemoScene { pose, object: DemoObject::Sheet }));
        let [Done::Kept(_, photo)] = &kept[..] else { panic!("{kept:?}") };
        work(Job::Sheet(photo.clone()));
    }
    let done = work(Job::Calibrate(vec![1, 2]));
    assert!(matches!(&done[..], [Done::Calibrated(Ok(_))]), "{done:?}");

    let pattern = Arc::new(SequencePattern::new(bench.projector, &SequenceConfig::default()).unwrap());
    let scene = DemoScene { pose: FIRST_POSE, object: DemoObject::Sphere };
    let mut scan = |frames: usize| {
        let done = work(Job::BeginScan(pattern.clone()));
        let [Done::ScanBegun(scan)] = &done[..] else { panic!("{done:?}") };
        for frame in 0..frames {
            let picture = image::DynamicImage::ImageLuma8(pattern.image(frame).unwrap());
            pictures.paint(picture.into_rgb8());
            let done = work(Job::TakeSimulated(Purpose::Frame { scan: scan.id, frame }, scene));
            // It is the live picture, too.
            assert!(matches!(&done[..], [Done::Look(_), Done::Kept(..)]), "{done:?}");
        }
        (scan.clone(), work(Job::SequenceCloud(scan.clone())))
    };
    let (whole, done) = scan(pattern.frames.len());
    let [Done::Cloud(entry)] = &done[..] else { panic!("{done:?}") };
    assert_eq!((entry.frames, entry.photo_name.as_str()), (Some(22), "scan-001"));
    assert!(entry.points > 100_000 && entry.triangles > 100_000, "{entry:?}");
    let cloud = slcal_core::format::read_ply(project.read(&entry.name).unwrap().as_slice()).unwrap();
    let radius = fit_sphere(&cloud, &FitConfig::default()).unwrap().radius_mm;
    assert!((radius - 180.0).abs() < 0.005 * 180.0, "{radius}");
    assert!(project.picture_of_scan(whole.id).unwrap().ends_with("frame_000.jpg"));

    // Of another one a photograph is missing: it is not used, and not forgotten.
    let (_, done) = scan(7);
    assert!(matches!(&done[..], [Done::Failed(p)] if p.message.contains("frame_007.png")), "{done:?}");
    let mut next = Worker::new(project, pictures.clone(), true);
    let mut told = Vec::new();
    next.work(Job::Begin(bench, BTreeSet::new()), &mut |done| told.push(done));
    let clouds: Vec<_> = told.iter().filter(|done| matches!(done, Done::Cloud(_))).collect();
    assert!(matches!(clouds[..], [Done::Cloud(c)] if c.frames == Some(22) && c.points == entry.points));
    let left = told.iter().find_map(|done| match done {
        Done::Unfinished(left) => Some((left.name.as_str(), left.have, left.of)),
        _ => None,
    });
    assert_eq!(left, Some(("scan-002", 7, 22)));
}
