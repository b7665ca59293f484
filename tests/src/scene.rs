//! Photographs of a flat sheet under a projector, drawn by closed form: for the cases that need no light transport.

use image::{Rgb, RgbImage};
use nalgebra::{Matrix3, Point2, Rotation3, Vector3};
use slcal_core::geometry::Homography;
use slcal_core::pattern::{CheckerPattern, SquareColor};
use slcal_core::photo::Encoding;

/// Samples per pixel and axis: edges are then right to a few hundredths of a pixel, less along a slanted line.
const SAMPLES: u32 = 5;

/// A camera at the origin, a sheet in front of it and a projector beside it.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    /// Width and height of the photograph, px; the principal point is its centre.
    pub camera: [u32; 2],
    /// Focal length of the camera, px.
    pub camera_focal_px: f64,
    /// Focal length of the projector, px; its principal point is the centre of the pattern's panel.
    pub projector_focal_px: f64,
    /// Width and height of the sheet, mm.
    pub size_mm: [f64; 2],
    /// Turn of the sheet about the camera's x and y axes, degrees.
    pub tilt_deg: [f64; 2],
    /// Centre of the sheet in the camera's frame, mm.
    pub centre_mm: [f64; 3],
    /// Where the projector's axis meets the sheet, mm from its centre.
    pub aim_mm: [f64; 2],
    /// The projector's centre in the camera's frame, mm.
    pub projector_mm: [f64; 3],
}

impl Default for Scene {
    /// A tilted A2 sheet a metre away that holds the whole of the default pattern.
    fn default() -> Self {
        Self {
            camera: [960, 720],
            camera_focal_px: 1150.0,
            projector_focal_px: 1700.0,
            size_mm: [594.0, 420.0],
            tilt_deg: [24.0, -26.0],
            centre_mm: [0.0, 0.0, 1100.0],
            aim_mm: [0.0, 0.0],
            projector_mm: [-250.0, 40.0, 0.0],
        }
    }
}

impl Scene {
    /// The photograph: a dark background, the white sheet in weak ambient light, and the pattern where it falls on it.
    ///
    /// # Panics
    /// When the scene is so odd that sheet and image are not related by a homography.
    #[must_use]
    pub fn photograph(&self, pattern: Option<&CheckerPattern>) -> RgbImage {
        let projector_from_sheet = pattern.map(|p| self.projector_from_sheet(p.projector));
        self.render(|p| {
            let lit = projector_from_sheet.and_then(|h| h.map(p)).zip(pattern);
            lit.map_or(0.0, |(q, pattern)| shown(pattern, q))
        })
    }

    /// The photograph of this sheet with a picture on the panel, pixel by pixel, of a projector that was aimed at another
    /// scene's sheet and then turned by an angle about its vertical axis.
    ///
    /// # Panics
    /// As [`Scene::photograph`].
    #[must_use]
    pub fn photograph_of(&self, picture: &RgbImage, aimed_at: &Self, turn_deg: f64) -> RgbImage {
        let panel = [picture.width(), picture.height()];
        let projector_from_sheet = self.projector_aimed_at(aimed_at, panel, turn_deg);
        self.render(|p| {
            let Some(q) = projector_from_sheet.map(p) else { return 0.0 };
            let [x, y] = [q.x, q.y].map(f64::round);
            if !(x >= 0.0 && y >= 0.0 && x < f64::from(panel[0]) && y < f64::from(panel[1])) {
                return 0.0;
            }
            Encoding::Srgb.to_linear(f64::from(picture.get_pixel(x as u32, y as u32)[0]) / 255.0)
        })
    }

    /// A photograph of the sheet with what `projected` says of a point on it, 0–1.
    fn render(&self, projected: impl Fn(Point2<f64>) -> f64) -> RgbImage {
        let sheet_from_camera =
            self.camera_from_sheet().inverse().expect("a sheet that is seen as a surface");
        let light = |x: f64, y: f64| {
            let on_sheet = sheet_from_camera
                .map(Point2::new(x, y))
                .filter(|p| (0.0..=self.size_mm[0]).contains(&p.x) && (0.0..=self.size_mm[1]).contains(&p.y));
            on_sheet.map_or(0.012, |p| 0.09 + 0.55 * projected(p))
        };
        let step = f64::from(SAMPLES).recip();
        RgbImage::from_fn(self.camera[0], self.camera[1], |x, y| {
            let mut sum = 0.0;
            for j in 0..SAMPLES {
                for i in 0..SAMPLES {
                    let at = |n: u32, k: u32| f64::from(n) - 0.5 + (f64::from(k) + 0.5) * step;
                    sum += light(at(x, i), at(y, j));
                }
            }
            let code = Encoding::Srgb.from_linear(sum * step * step);
            Rgb([(code * 255.0).round() as u8; 3])
        })
    }

    fn rotation(&self) -> Rotation3<f64> {
        let [x, y] = self.tilt_deg.map(f64::to_radians);
        Rotation3::from_axis_angle(&Vector3::y_axis(), y) * Rotation3::from_axis_angle(&Vector3::x_axis(), x)
    }

    /// A point of the sheet, mm from its top-left corner, in the camera's frame.
    fn on_sheet(&self, x: f64, y: f64) -> Vector3<f64> {
        let [w, h] = self.size_mm;
        self.rotation() * Vector3::new(x - w / 2.0, y - h / 2.0, 0.0) + Vector3::from(self.centre_mm)
    }

    /// From millimetres on the sheet to pixels of the photograph.
    #[must_use]
    pub fn camera_from_sheet(&self) -> Homography {
        let r = self.rotation();
        let columns = [r * Vector3::x(), r * Vector3::y(), self.on_sheet(0.0, 0.0)];
        Homography(intrinsics(self.camera_focal_px, self.camera) * Matrix3::from_columns(&columns))
    }

    /// From millimetres on the sheet to pixels of a projector's panel.
    ///
    /// # Panics
    /// When the sheet is seen edge-on by the projector.
    #[must_use]
    pub fn projector_from_sheet(&self, panel: [u32; 2]) -> Homography {
        self.projector_aimed_at(self, panel, 0.0)
    }

    /// The same for a projector that was aimed at another scene's sheet and then turned about its vertical axis.
    fn projector_aimed_at(&self, aimed_at: &Self, panel: [u32; 2], turn_deg: f64) -> Homography {
        let centre = Vector3::from(aimed_at.projector_mm);
        let [w, h] = aimed_at.size_mm;
        let target = aimed_at.on_sheet(w / 2.0 + aimed_at.aim_mm[0], h / 2.0 + aimed_at.aim_mm[1]);
        let z = (target - centre).normalize();
        let x = Vector3::y().cross(&z).normalize();
        let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), turn_deg.to_radians());
        let projector_from_camera = turn.matrix() * Matrix3::from_columns(&[x, z.cross(&x), z]).transpose();
        let r = self.rotation();
        let columns = [
            projector_from_camera * (r * Vector3::x()),
            projector_from_camera * (r * Vector3::y()),
            projector_from_camera * (self.on_sheet(0.0, 0.0) - centre),
        ];
        Homography(intrinsics(aimed_at.projector_focal_px, panel) * Matrix3::from_columns(&columns))
    }
}

fn intrinsics(focal_px: f64, [w, h]: [u32; 2]) -> Matrix3<f64> {
    let centre = |n: u32| (f64::from(n) - 1.0) / 2.0;
    Matrix3::new(focal_px, 0.0, centre(w), 0.0, focal_px, centre(h), 0.0, 0.0, 1.0)
}

/// The light of a pattern at a pixel of its panel, 0–1.
fn shown(pattern: &CheckerPattern, q: Point2<f64>) -> f64 {
    let on_panel = |v: f64, n: u32| v >= -0.5 && v <= f64::from(n) - 0.5;
    if !(on_panel(q.x, pattern.projector[0]) && on_panel(q.y, pattern.projector[1])) {
        return 0.0;
    }
    let square = ((q - pattern.origin_px) / pattern.square_px).map(f64::floor);
    let on_board = (0.0..f64::from(pattern.squares[0])).contains(&square.x)
        && (0.0..f64::from(pattern.squares[1])).contains(&square.y);
    let white = if on_board {
        ((square.x + square.y) % 2.0 == 0.0) == (pattern.first_square == SquareColor::White)
    } else {
        pattern.background == SquareColor::White
    };
    f64::from(u8::from(white))
}
