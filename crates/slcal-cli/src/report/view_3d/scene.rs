//! Devices and sheets in space, in the camera's frame, as the view takes them, in colours of the page.

use nalgebra::{Point2, Point3};
use serde::Serialize;
use slcal_core::geometry::{Camera, Pose};
use slcal_core::{Projector, Rig, View};

const SHEET: &str = "var(--sheet)";

/// A place, rounded to hundredths of a millimetre.
type Spot = [f64; 3];

/// Lines, faces and names around a cloud.
#[derive(Debug, Default, Serialize)]
pub(super) struct Scene {
    lines: Vec<Lines>,
    faces: Vec<Face>,
    labels: Vec<Label>,
}

/// Lines of one thing, with gaps between them.
#[derive(Debug, Serialize)]
struct Lines {
    name: &'static str,
    color: &'static str,
    points: Vec<Option<Spot>>,
    dashed: bool,
}

#[derive(Debug, Serialize)]
struct Face {
    name: &'static str,
    color: &'static str,
    opacity: f64,
    corners: Vec<Spot>,
}

#[derive(Debug, Serialize)]
struct Label {
    text: &'static str,
    color: &'static str,
    at: Spot,
}

impl Scene {
    /// Devices with pyramids of a length, mm, and all sheets.
    pub(super) fn new(rig: &Rig, length: f64) -> Self {
        let mut scene = Self::default();
        scene.device("camera", "var(--camera)", &rig.camera.model, &Pose::identity(), length);
        if let Some(Projector { device, from_camera, .. }) = &rig.projector {
            scene.device("projector", "var(--projector)", &device.model, &from_camera.pose.inverse(), length);
            let centre = from_camera.pose.centre();
            scene.line("baseline", "var(--ink)", &[&[Point3::origin(), centre]], true);
        }
        for view in &rig.views {
            scene.sheet(view);
        }
        scene
    }

    fn line(&mut self, name: &'static str, color: &'static str, all: &[&[Point3<f64>]], dashed: bool) {
        let mut points = Vec::new();
        for line in all {
            if !points.is_empty() {
                points.push(None);
            }
            points.extend(line.iter().map(|p| Some(spot(p))));
        }
        self.lines.push(Lines { name, color, points, dashed });
    }

    /// The field of view of a device: a pyramid from its centre to its image.
    fn device(
        &mut self,
        name: &'static str,
        color: &'static str,
        model: &Camera,
        camera_from_device: &Pose,
        length: f64,
    ) {
        let (w, h) = (f64::from(model.width) - 0.5, f64::from(model.height) - 0.5);
        let corners = [(-0.5, -0.5), (w, -0.5), (w, h), (-0.5, h)].map(|(u, v)| {
            // Without distortion: far outside, that of some lenses has no inverse.
            let x = model.intrinsics.normalized(Point2::new(u, v));
            camera_from_device.transform(&Point3::new(x.x * length, x.y * length, length))
        });
        let centre = camera_from_device.transform(&Point3::origin());
        let [a, b, c, d] = corners;
        // A small roof marks the top side.
        let roof = a + (b - a) / 2.0 + (a - d) * 0.25;
        let lines: [&[Point3<f64>]; 3] = [&[a, b, c, d, a, roof, b], &[a, centre, b], &[c, centre, d]];
        self.line(name, color, &lines, false);
        self.labels.push(Label { text: name, color, at: spot(&centre) });
    }

    fn sheet(&mut self, view: &View) {
        let place = |c: &Point2<f64>| view.camera_from_sheet.transform(&Point3::new(c.x, c.y, 0.0));
        let corners: Vec<Point3<f64>> = view.size.corners().iter().map(place).collect();
        let mut outline = corners.clone();
        outline.extend(corners.first().copied());
        // Things of one name are one entry of the legend.
        self.line("sheet", SHEET, &[&outline], false);
        let corners = corners.iter().map(spot).collect();
        self.faces.push(Face { name: "sheet", color: SHEET, opacity: 0.25, corners });
    }
}

fn spot(p: &Point3<f64>) -> Spot {
    [p.x, p.y, p.z].map(|x| (x * 100.0).round() / 100.0)
}
