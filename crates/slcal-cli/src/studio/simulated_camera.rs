//! The camera of the demonstration: it photographs a simulated sheet or sphere under what the display page really painted.

use image::RgbImage;
use slcal_core::geometry::RectangleSize;
use slcal_core::simulate::{
    Photographer, Placement, ProjectedImage, RenderConfig, RigConfig, Scene, SceneObject, SheetObject,
};
use slcal_core::{Result, Rig};

use super::state::{DemoObject, DemoPose, DemoScene};

/// Size of its photographs, px, and their focal length.
pub(super) const PHOTO_PX: [u32; 2] = [1280, 960];
const FOCAL_PX: f64 = 1450.0;
/// Size of the live frames: a fraction of that.
const LIVE_DIVISOR: u32 = 2;
/// Throw ratio of its projector: focal length over width of the panel.
const THROW: f64 = 1.6;
/// Lens shift of its projector, heights of the panel: it stands on a table and throws upwards.
const LENS_SHIFT: f64 = 0.3;
const BASELINE_MM: f64 = 260.0;
/// Where the sheet is held at first, and the projector is aimed at.
pub(super) const DISTANCE_MM: f64 = 1000.0;
/// Radius of the sphere to scan, mm: large, so that most points lie on it. The wall is this far behind its middle.
const SPHERE_MM: f64 = 180.0;
const WALL_MM: f64 = 320.0;
/// Light of the room, as a share of the projector's: sides of the sheet beyond the projector's light are seen.
const ROOM: f64 = 0.06;
/// Light of what faces the projector at that distance, as a share of full scale: what is nearer is brighter, and not clipped.
const EXPOSURE: f64 = 0.6;

/// Where the sheet is held at first: nearly face-on, so that there is something to improve.
pub(super) const FIRST_POSE: DemoPose =
    DemoPose { tilt_deg: [4.0, -6.0], roll_deg: 1.0, distance_mm: DISTANCE_MM, aside_mm: [0.0; 2] };

/// The simulated rig. The geometry of a scene is traced once, every frame after that is cheap.
pub(super) struct SimulatedCamera {
    panel: [u32; 2],
    size: RectangleSize,
    traced: Option<(bool, DemoScene, Photographer)>,
    frame: u64,
}

impl SimulatedCamera {
    pub(super) fn new(panel: [u32; 2], size: RectangleSize) -> Self {
        Self { panel, size, traced: None, frame: 0 }
    }

    /// The true rig, with images of this size.
    pub(super) fn rig(&self, live: bool) -> Result<Rig> {
        let by = if live { LIVE_DIVISOR } else { 1 };
        let config = RigConfig {
            camera: PHOTO_PX.map(|side| side / by),
            camera_focal_px: FOCAL_PX / f64::from(by),
            projector: self.panel,
            projector_focal_px: THROW * f64::from(self.panel[0]),
            lens_shift: LENS_SHIFT,
            baseline_mm: BASELINE_MM,
            distance_mm: DISTANCE_MM,
            size: self.size,
            ..RigConfig::default()
        };
        Ok(Scene::new(&config, &[])?.rig())
    }

    /// A frame under what was painted; `None`: the projector is dark.
    pub(super) fn frame(
        &mut self,
        scene: DemoScene,
        painted: Option<&RgbImage>,
        live: bool,
    ) -> Result<RgbImage> {
        let traced = self.traced.take().filter(|(l, s, _)| (*l, *s) == (live, scene));
        let traced =
            traced.map_or_else(|| Ok((live, scene, self.trace(scene, live)?)), Ok::<_, slcal_core::Error>)?;
        let (_, _, photographer) = self.traced.insert(traced);
        self.frame += 1;
        let shown = painted
            .filter(|p| [p.width(), p.height()] == self.panel)
            .map_or(ProjectedImage::Black, ProjectedImage::Picture);
        Ok(photographer.photograph(shown, self.frame)?.into_rgb8())
    }

    fn trace(&self, scene: DemoScene, live: bool) -> Result<Photographer> {
        let render = RenderConfig {
            exposure: EXPOSURE,
            ambient: [ROOM; 3],
            reference_mm: Some(DISTANCE_MM),
            ..RenderConfig::default()
        };
        let surfaces = self.object(scene)?.surfaces(&placement(scene))?;
        Photographer::new(&self.rig(live)?, &surfaces, &render)
    }

    fn object(&self, scene: DemoScene) -> Result<SceneObject> {
        Ok(match scene.object {
            DemoObject::Sheet => SceneObject::Sheet(SheetObject::new(self.size, None, 0.0)?),
            DemoObject::Sphere => SceneObject::Sphere { radius_mm: SPHERE_MM },
        })
    }
}

fn placement(scene: DemoScene) -> Placement {
    let pose = scene.pose;
    let [x, y] = pose.tilt_deg.map(f64::to_radians);
    let sheet = scene.object == DemoObject::Sheet;
    Placement {
        middle_mm: if sheet {
            [pose.aside_mm[0], pose.aside_mm[1], pose.distance_mm]
        } else {
            [0.0, 0.0, DISTANCE_MM]
        },
        turn_rad: if sheet { [x, y, pose.roll_deg.to_radians()] } else { [0.0; 3] },
        albedo: [0.85; 3],
        wall_mm: (!sheet).then_some(WALL_MM),
        wall_albedo: 0.5,
    }
}

#[cfg(test)]
mod tests {
    use slcal_core::detect::{DetectConfig, observe};
    use slcal_core::{CheckerConfig, CheckerPattern, PhotoView};

    use super::*;
    use crate::io::{PHOTO_QUALITY, jpeg_bytes};

    #[test]
    fn the_first_pose_that_is_advised_shows_the_whole_pattern() {
        use super::super::auto_shot::{is_tilted, nearness};
        use super::super::guide::{RoughDevices, first};
        for (panel, size) in
            [([1024, 768], "594x420mm"), ([1920, 1080], "594x420mm"), ([1280, 800], "A2-landscape")]
        {
            let sheet: slcal_core::SheetSize = size.parse().unwrap();
            let checker = CheckerPattern::new(panel, &CheckerConfig::default()).unwrap();
            let mut camera = SimulatedCamera::new(panel, sheet.upright());
            let devices = RoughDevices::simulated(&camera.rig(false).unwrap(), DISTANCE_MM).unwrap();
            let guide = first(&devices, sheet).unwrap().unwrap();
            let scene = DemoScene { pose: guide.turn.unwrap(), object: DemoObject::Sheet };
            let frame = camera.frame(scene, Some(&checker.image().unwrap()), false).unwrap();
            let view = PhotoView::try_from(&frame).unwrap();
            let found =
                observe(view, None, sheet.upright(), Some(&checker), &DetectConfig::default()).unwrap();
            assert_eq!(found.observation.pairs.len(), found.pattern_corners, "{panel:?}");
            let quad = found.observation.sheet.corners().unwrap().map(|p| [p.x, p.y]);
            assert!(nearness(&quad, &guide.quad) > 0.9 && is_tilted(&quad), "{quad:?} {:?}", guide.quad);
        }
    }

    #[test]
    fn a_scan_of_the_sphere_is_a_sphere() {
        use slcal_core::evaluate::{FitConfig, fit_sphere};
        use slcal_core::{ReconstructConfig, Reconstructor, StripeConfig, StripePattern};
        for panel in [[1024, 768], [1920, 1080]] {
            let mut camera = SimulatedCamera::new(panel, RectangleSize::new(594.0, 420.0).unwrap());
            let stripes = StripePattern::new(panel, &StripeConfig::default()).unwrap();
            let scene = DemoScene { pose: FIRST_POSE, object: DemoObject::Sphere };
            let frame = camera.frame(scene, Some(&stripes.image().unwrap()), false).unwrap();
            let file = jpeg_bytes(&frame, PHOTO_QUALITY).unwrap();
            let photo = image::load_from_memory(&file).unwrap();
            let rig = camera.rig(false).unwrap();
            let mut scanner = Reconstructor::new(&rig, &stripes, ReconstructConfig::default()).unwrap();
            let cloud = &scanner.reconstruct(PhotoView::try_from(&photo).unwrap()).unwrap().cloud;
            let sphere = fit_sphere(cloud, &FitConfig::default()).unwrap();
            assert!(
                (sphere.radius_mm - SPHERE_MM).abs() < 0.005 * SPHERE_MM,
                "{panel:?}: {}",
                sphere.radius_mm
            );
        }
    }

    #[test]
    fn the_checkerboard_that_was_painted_is_found_on_the_sheet() {
        let (panel, size) = ([1024, 768], RectangleSize::new(594.0, 420.0).unwrap());
        let checker = CheckerPattern::new(panel, &CheckerConfig::default()).unwrap();
        let mut camera = SimulatedCamera::new(panel, size);
        let scene = DemoScene { pose: FIRST_POSE, object: DemoObject::Sheet };
        let painted = checker.image().unwrap();
        for live in [true, false] {
            let frame = camera.frame(scene, Some(&painted), live).unwrap();
            let view = PhotoView::try_from(&frame).unwrap();
            let found = observe(view, None, size, Some(&checker), &DetectConfig::default()).unwrap();
            assert_eq!(found.observation.pairs.len(), found.pattern_corners);
        }
        // Under a dark projector there is no pattern.
        let dark = camera.frame(scene, None, true).unwrap();
        let view = PhotoView::try_from(&dark).unwrap();
        assert!(observe(view, None, size, Some(&checker), &DetectConfig::default()).is_err());
    }
}
