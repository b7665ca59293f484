//! Simulated photographs with bands of flicker → rig: what was measured and calibrated without them is found with them.

use slcal_core::detect::{DetectConfig, Detection, observe};
use slcal_core::pattern::Pattern;
use slcal_core::photo::PhotoView;
use slcal_core::simulate::{
    Flicker, Photographer, ProjectedImage, RenderConfig, RigConfig, SceneSetup, SurfaceKind,
};
use slcal_core::{CalibrateConfig, Observations, Rig, calibrate_observations};

/// Detection in the photograph of a tilted sheet, and the true rig.
fn seen(flicker: Option<Flicker>) -> (Detection, Rig) {
    let rig = RigConfig { camera: [640, 480], camera_focal_px: 750.0, ..RigConfig::default() };
    let setup = SceneSetup {
        rig,
        surface: SurfaceKind::Sheet,
        render: RenderConfig { flicker, ..RenderConfig::default() },
        ..SceneSetup::default()
    };
    let scene = setup.set_up().unwrap();
    let photographer = Photographer::new(&scene.rig, &scene.surfaces, &setup.render).unwrap();
    let photo = photographer.photograph(ProjectedImage::Picture(&scene.picture), 0).unwrap();
    let Pattern::Checker(pattern) = &scene.pattern else { panic!("no checkerboard") };
    let size = setup.rig.size;
    let found =
        observe(PhotoView::try_from(&photo).unwrap(), None, size, Some(pattern), &DetectConfig::default());
    (found.unwrap(), scene.rig)
}

fn calibrated(found: &Detection, truth: &Rig) -> Rig {
    let observations = Observations {
        camera: truth.camera.model.size(),
        projector: truth.projector.map(|p| p.device.model.size()),
        mirrored: false,
        views: vec![found.observation.clone()],
    };
    calibrate_observations(&observations, &CalibrateConfig::default()).unwrap().rig
}

/// Errors of both focal lengths in units of σ.
fn errors(found: &Rig, truth: &Rig) -> [f64; 2] {
    let (p, q) = (found.projector.unwrap().device, truth.projector.unwrap().device);
    [(found.camera, truth.camera), (p, q)].map(|(found, truth)| {
        (found.model.intrinsics.fx - truth.model.intrinsics.fx) / found.sigma.unwrap().focal_px
    })
}

#[test]
fn bands_are_divided_out_of_the_photograph_of_a_sheet() {
    let (clean, truth) = seen(None);
    assert!(clean.notes.is_empty(), "{:?}", clean.notes);
    for (amount, period_px) in [(0.3, 20.0), (0.6, 85.0), (0.9, 20.0), (0.9, 150.0)] {
        let (found, _) = seen(Some(Flicker { amount, period_px }));
        let depth = 100.0 * amount;
        assert_eq!(
            found.notes,
            [format!("bands of flicker, {depth:.0} % deep and {period_px:.0} px apart, were divided out")]
        );
        assert_eq!(found.observation.pairs.len(), clean.observation.pairs.len());
        for (a, b) in found.observation.pairs.iter().zip(&clean.observation.pairs) {
            // The noise is ten times as much in the darkest rows of the deepest bands.
            let moved = (a.camera - b.camera).norm();
            assert!(moved < 0.2, "{amount} {period_px}: {} moved by {moved}", b.camera);
        }
        let z = errors(&calibrated(&found, &truth), &truth);
        assert!(z.iter().all(|z| z.abs() < 2.5), "{amount} {period_px}: {z:?}");
    }
}
