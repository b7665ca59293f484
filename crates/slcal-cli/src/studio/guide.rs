//! The pose to photograph next, as the page draws it.

use nalgebra::Point3;
use slcal_core::advise::{Advice, CameraPlan, NextView, Predicted, advise_first, advise_next};
use slcal_core::geometry::Camera;
use slcal_core::{CalibrateConfig, CheckerPattern, Rig, SheetSize, Verdict};

use super::auto_shot::Quad;
use super::pose_angles::demo_pose;
use super::state::{DemoPose, Guide};

/// Focal length of a camera of which nothing is known, mm on 35 mm film: between webcams and phones.
const USUAL_CAMERA_MM: f64 = 28.0;
/// Throw ratio of a projector of which nothing is known.
const USUAL_THROW: f64 = 1.5;
/// Noise of corners before any was measured, px.
const USUAL_NOISE_PX: f64 = 0.2;
/// Photographs that a calibration should have: a single one leaves most assumptions untested.
const USUAL_PHOTOGRAPHS: usize = 2;
/// A photograph that lowers σ to less than this share is asked for in any case.
const MUCH: f64 = 0.5;
/// Relative σ of the focal lengths below which nothing more is asked for.
const ENOUGH: f64 = 1e-3;

/// Devices as they are roughly known before anything was photographed.
#[derive(Debug, Clone, Copy)]
pub(super) struct RoughDevices {
    camera: Camera,
    projector: Camera,
    distance_mm: Option<f64>,
}

impl RoughDevices {
    /// Usual ones with images and a panel of these sizes.
    pub(super) fn usual(image: [u32; 2], panel: [u32; 2]) -> slcal_core::Result<Self> {
        let camera = Camera::from_35mm(image, USUAL_CAMERA_MM)?;
        Ok(Self { camera, projector: Camera::from_throw(panel, USUAL_THROW)?, distance_mm: None })
    }

    /// Those of a simulated rig, at which the sheet is held at this distance.
    pub(super) fn simulated(rig: &Rig, distance_mm: f64) -> slcal_core::Result<Self> {
        let projector = rig.require_projector()?.device.model;
        Ok(Self { camera: rig.camera.model, projector, distance_mm: Some(distance_mm) })
    }
}

/// The first pose.
pub(super) fn first(devices: &RoughDevices, sheet: SheetSize) -> slcal_core::Result<Option<Guide>> {
    let RoughDevices { camera, projector, distance_mm } = *devices;
    let image = camera.size();
    let size = sheet.upright();
    // A paper by its name is held across, as most images lie.
    let size = if sheet.is_either_way() && image[0] > image[1] { size.transposed() } else { size };
    let plan = CameraPlan {
        camera,
        projector: Some(projector),
        size,
        distance_mm,
        noise_px: [USUAL_NOISE_PX; 2],
        config: CalibrateConfig::default(),
    };
    let advice = advise_first(&plan)?;
    Ok(advice.next.and_then(|next| of(&next, &advice, &camera, true)))
}

/// The next pose for a rig.
pub(super) fn next(rig: &Rig, checker: &CheckerPattern) -> slcal_core::Result<Option<Guide>> {
    let advice = advise_next(rig, Some(checker))?;
    let good = rig.quality.as_ref().is_some_and(|q| q.verdict == Verdict::Good);
    // Two photographs of one pose are like one.
    let worst = |p: Predicted| p.worst_focal();
    let gains = advice.now.zip(advice.next.map(|n| n.after));
    let much = gains.is_some_and(|(now, after)| worst(now) > ENOUGH && worst(after) < MUCH * worst(now));
    let needed = !good || rig.views.len() < USUAL_PHOTOGRAPHS || much;
    Ok(advice.next.and_then(|next| of(&next, &advice, &rig.camera.model, needed)))
}

fn of(next: &NextView, advice: &Advice, camera: &Camera, needed: bool) -> Option<Guide> {
    let pose = &next.camera_from_sheet;
    let mut quad = [[0.0; 2]; 4];
    for (corner, place) in advice.size.corners().iter().zip(&mut quad) {
        let p = camera.project(&pose.transform(&Point3::new(corner.x, corner.y, 0.0)))?;
        *place = [p.x, p.y];
    }
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    let after = percent(next.after.worst_focal());
    let gain = match &advice.now {
        Some(now) => format!("σ of the focal lengths {} → {after}", percent(now.worst_focal())),
        None => format!("σ of the focal lengths about {after} with a second photograph, tilt reversed"),
    };
    Some(Guide {
        size: camera.size(),
        quad,
        words: words([next.tilt_x_rad, next.tilt_y_rad]),
        tilt_rad: [next.tilt_x_rad, next.tilt_y_rad],
        gain,
        needed,
        turn: Some(demo_pose(pose, advice.size)),
    })
}

impl Guide {
    /// The same with the sheet tilted by this share of it, where its corners are then seen.
    pub(super) fn tilted_less(&self, share: f64, turn: DemoPose, quad: Quad) -> Self {
        let tilt_rad = self.tilt_rad.map(|t| share * t);
        Self { words: words(tilt_rad), tilt_rad, quad, turn: Some(turn), ..self.clone() }
    }
}

/// How to hold the sheet, briefly: the outline shows the rest. Tilts about the horizontal and the vertical axis.
fn words([tilt_x_rad, tilt_y_rad]: [f64; 2]) -> String {
    let part = |angle: f64, [positive, negative]: [&str; 2]| {
        let degrees = angle.to_degrees().round();
        let side = if degrees > 0.0 { positive } else { negative };
        (degrees != 0.0).then(|| format!("its {side} side {:.0}° towards the camera", degrees.abs()))
    };
    let turns = [part(tilt_y_rad, ["right", "left"]), part(tilt_x_rad, ["top", "bottom"])];
    let turns: Vec<String> = turns.into_iter().flatten().collect();
    if turns.is_empty() {
        return "Hold the sheet face-on, within the dashed outline.".to_owned();
    }
    format!("Hold it with {}, to fill the dashed outline.", turns.join(" and "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_pose_lies_within_the_picture() {
        let devices = RoughDevices::usual([1280, 960], [1024, 768]).unwrap();
        let guide = first(&devices, "A4".parse().unwrap()).unwrap().unwrap();
        let inside = guide.quad.iter().all(|[x, y]| (0.0..1280.0).contains(x) && (0.0..960.0).contains(y));
        assert!(inside && guide.needed && guide.words.starts_with("Hold it with its "), "{guide:?}");
        // Across, as the picture lies.
        assert!(guide.quad[1][0] - guide.quad[0][0] > guide.quad[3][1] - guide.quad[0][1]);
    }
}
