//! The registration of the colour channels from displacements of closed form.

use nalgebra::{Point2, Vector2};

use super::scene::{jitter, observe, pose, rig, rng, with_edges};
use crate::calibrate::{CalibrateConfig, calibrate_observations};
use crate::channel_registration::RedBlue;
use crate::observations::{ChannelOffset, Observations};

const SHIFT: RedBlue<[f64; 2]> = RedBlue { red: [0.45, -0.28], blue: [-0.35, 0.42] };
const RADIAL: RedBlue<f64> = RedBlue { red: 6e-4, blue: -5e-4 };

/// Observations with the displacements of these shifts and radials, with the noise of photographs and a wrong corner in each eight.
fn displaced() -> Observations {
    let truth = rig(520.0, vec![pose(25.0, 28.0)]);
    let mut rng = rng(5);
    let mut seen = observe(&truth, 0.05, 0.02, &mut rng);
    seen = with_edges(seen, &truth, 40, 0.05, &mut rng);
    let (sheet, centre) = (&truth.views[0], truth.camera.intrinsics.principal_point());
    let at = |q: Point2<f64>| truth.camera.project(&truth.lit(sheet, q).unwrap()).unwrap();
    let of = |q: Point2<f64>, shift: [f64; 2], radial: f64| {
        let (here, there) = (at(q), at(q + Vector2::from(shift)));
        there + (there - centre) * radial - here
    };
    let view = &mut seen.views[0];
    let mut offset = |(k, pair): (usize, &crate::CornerPair)| {
        let q = pair.projector;
        let wrong = Vector2::repeat(if k % 8 == 3 { 0.8 } else { 0.0 });
        ChannelOffset {
            camera: pair.camera,
            projector: q,
            offset_px: RedBlue {
                red: of(q, SHIFT.red, RADIAL.red) + wrong + jitter(&mut rng, 0.045),
                blue: of(q, SHIFT.blue, RADIAL.blue) - wrong + jitter(&mut rng, 0.045),
            },
            sigma_px: RedBlue { red: 0.05, blue: 0.05 },
        }
    };
    view.channel_offsets = view.pairs.iter().enumerate().map(&mut offset).collect();
    seen
}

#[test]
fn shifts_are_found_and_the_sum_of_the_magnifications() {
    let found = calibrate_observations(&displaced(), &CalibrateConfig::default()).unwrap().rig;
    let r = found.channel_registration.unwrap();
    let (d, sigma) = (r.displacements, r.sigma);
    for (projector, camera, shift, radial) in [
        (d.projector.red, d.camera.red, SHIFT.red, RADIAL.red),
        (d.projector.blue, d.camera.blue, SHIFT.blue, RADIAL.blue),
    ] {
        let off: Vec<f64> =
            projector.shift_px.iter().zip(shift).map(|(found, truth)| found - truth).collect();
        assert!(off.iter().all(|e| e.abs() < 0.06), "{projector:?} for {shift:?}");
        let sum = projector.scale + camera.radial;
        assert!((sum - radial).abs() < 1.5e-4, "{projector:?} {camera:?} for {radial}");
        // The priors divide the sum nearly as 9 : 25.
        assert!((projector.scale / camera.radial - 0.36).abs() < 0.25, "{projector:?} {camera:?}");
    }
    assert!(sigma.projector.red.shift_px.iter().all(|s| (0.02..0.06).contains(s)), "{sigma:?}");
    assert!((2e-4..4e-4).contains(&sigma.camera.blue.radial), "{sigma:?}");
    assert_eq!(r.panel_centre, Point2::new(511.5, 383.5));
}

#[test]
fn few_corners_give_none() {
    let mut few = displaced();
    few.views[0].channel_offsets.truncate(11);
    let rig = calibrate_observations(&few, &CalibrateConfig::default()).unwrap().rig;
    assert_eq!(rig.channel_registration, None);
}
