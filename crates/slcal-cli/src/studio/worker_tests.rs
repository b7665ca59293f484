//! The work from a first photograph to the pose that is advised after it, without server and pages.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::checker::checker;
use super::job::{Bench, Calibrated, Done, Job, LiveFrame, LookFor};
use super::project::{Project, Purpose};
use super::simulated_camera::FIRST_POSE;
use super::state::{DemoObject, DemoScene};
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
