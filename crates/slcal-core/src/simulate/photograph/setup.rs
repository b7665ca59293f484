//! A whole simulated scene by a few numbers: rig, surface and pattern that go together.

use image::RgbImage;

use super::config::RenderConfig;
use super::mesh::TriangleMesh;
use super::photographer::{Photographer, ProjectedImage};
use super::simulated::SimulatedScene;
use super::subject::{Placing, Subject};
use super::surface::Surface;
use crate::error::{Error, Result};
use crate::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};
use crate::rig::Rig;
use crate::simulate::poses::PoseConfig;
use crate::simulate::rig_config::RigConfig;
use crate::simulate::scene::Scene;

/// Radius of the sphere, in distances, and how far behind its middle, or a mesh's, the wall stands, in radii.
const RADIUS: f64 = 0.18;
const WALL_RADII: f64 = 1.5;
/// Tilts that show something of the surface and leave all of it in the light, degrees.
const PLANE_TILT_DEG: [f64; 3] = [10.0, 20.0, 0.0];
const SHEET_TILT_DEG: [f64; 3] = [25.0, 28.0, 0.0];

/// What the rig looks at.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum SurfaceKind {
    /// An endless plane.
    #[default]
    Plane,
    /// A sphere.
    Sphere {
        /// Its radius, mm; default 0.18 of the distance.
        radius_mm: Option<f64>,
    },
    /// A wall with two blocks before it.
    Step,
    /// A sheet of [`RigConfig::size`].
    Sheet,
    /// A mesh as in [`Subject::Mesh`].
    Mesh(TriangleMesh),
    /// A mesh as in [`Subject::MeshInCamera`].
    MeshInCamera(TriangleMesh),
}

/// The wall behind the surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum WallKind {
    /// Close behind a sphere and a mesh in a frame of its own; none elsewhere.
    #[default]
    Usual,
    /// None.
    None,
    /// So far behind the surface's middle, mm; not with a plane, which hides it, or a step, which has its own.
    Behind(f64),
}

/// What the projector shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum PatternKind {
    /// The checkerboard on a sheet, stripes on everything else.
    #[default]
    Usual,
    /// The default checkerboard, with squares as small as it takes to fall on the sheet of a simulated rig.
    Checker,
    /// The default stripes.
    Stripes,
    /// A pattern of one's own.
    Known(Pattern),
}

/// A scene by a few numbers. What is left open is chosen so that the surface is seen well.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSetup {
    /// The rig; its distance is that of the surface's middle, its size that of a sheet.
    pub rig: RigConfig,
    /// A rig of one's own instead. Of `rig` distance and size still count.
    pub known_rig: Option<Rig>,
    /// What it looks at.
    pub surface: SurfaceKind,
    /// Turns of the surface about the camera's x, y and z axis, R = Rx·Ry·Rz, rad; default 10° and 20° for a plane, 25° and
    /// 28° for a sheet, else none.
    pub turn_rad: Option<[f64; 3]>,
    /// How far right of and below the camera's axis the surface's middle stands, mm.
    pub aside_mm: [f64; 2],
    /// Share of light that the surface returns, red, green, blue; default 0.9.
    pub albedo: [f64; 3],
    /// The wall behind it.
    pub wall: WallKind,
    /// Grey share of light that the wall returns; default 0.4.
    pub wall_albedo: f64,
    /// What is projected.
    pub pattern: PatternKind,
    /// How it is photographed.
    pub render: RenderConfig,
}

impl Default for SceneSetup {
    fn default() -> Self {
        Self {
            rig: RigConfig::default(),
            known_rig: None,
            surface: SurfaceKind::default(),
            turn_rad: None,
            aside_mm: [0.0; 2],
            albedo: [0.9; 3],
            wall: WallKind::default(),
            wall_albedo: 0.4,
            pattern: PatternKind::default(),
            render: RenderConfig::default(),
        }
    }
}

impl SceneSetup {
    /// Checks everything and sets it up; photographs, which take seconds, come after.
    ///
    /// # Errors
    /// [`Error::Invalid`] for values out of range, surfaces that are turned away or stand about the camera, a known rig
    /// without a projector, and a known pattern for another panel than the rig's.
    pub fn set_up(&self) -> Result<SceneStage> {
        self.render.validate()?;
        let subject = self.subject();
        let placing = self.placing(&subject)?;
        let (rig, pattern) = self.rig_and_pattern(&subject, &placing)?;
        let picture = match &pattern {
            Pattern::Checker(p) => p.image(),
            Pattern::Stripes(p) => p.image(),
        }?;
        let surfaces = subject.surfaces(&placing)?;
        Ok(SceneStage { rig, pattern, picture, surfaces, render: self.render.clone() })
    }

    /// Sets it up and photographs it: [`set_up`](Self::set_up) and [`SceneStage::photograph`].
    ///
    /// # Errors
    /// As these two.
    pub fn photograph(&self) -> Result<SimulatedScene> {
        self.set_up()?.photograph()
    }

    fn subject(&self) -> Subject {
        match &self.surface {
            SurfaceKind::Plane => Subject::Plane,
            SurfaceKind::Sphere { radius_mm } => {
                Subject::Sphere { radius_mm: radius_mm.unwrap_or(RADIUS * self.rig.distance_mm) }
            }
            SurfaceKind::Step => Subject::Step,
            SurfaceKind::Sheet => Subject::Sheet(self.rig.size),
            SurfaceKind::Mesh(mesh) => Subject::Mesh(mesh.clone()),
            SurfaceKind::MeshInCamera(mesh) => Subject::MeshInCamera(mesh.clone()),
        }
    }

    fn placing(&self, subject: &Subject) -> Result<Placing> {
        let usual_deg = match subject {
            Subject::Plane => PLANE_TILT_DEG,
            Subject::Sheet(_) => SHEET_TILT_DEG,
            _ => [0.0; 3],
        };
        let wall_mm = match (subject, self.wall) {
            (Subject::Plane | Subject::Step, WallKind::Behind(mm)) => {
                let expected = "one with a sphere, a sheet or a mesh; a plane hides it, a step has its own";
                return Err(Error::invalid("wall", expected, format!("{mm} mm")));
            }
            (_, WallKind::Behind(mm)) => Some(mm),
            (Subject::Sphere { radius_mm }, WallKind::Usual) => Some(WALL_RADII * radius_mm),
            (Subject::Mesh(mesh), WallKind::Usual) => {
                let [least, most] = mesh.bounds();
                Some(WALL_RADII * (most - least).norm() / 2.0)
            }
            (_, WallKind::None | WallKind::Usual) => None,
        };
        Ok(Placing {
            middle_mm: [self.aside_mm[0], self.aside_mm[1], self.rig.distance_mm],
            turn_rad: self.turn_rad.unwrap_or_else(|| usual_deg.map(f64::to_radians)),
            albedo: self.albedo,
            wall_mm,
            wall_albedo: self.wall_albedo,
        })
    }

    fn rig_and_pattern(&self, subject: &Subject, placing: &Placing) -> Result<(Rig, Pattern)> {
        let checker = match self.pattern {
            PatternKind::Checker => true,
            PatternKind::Usual => matches!(subject, Subject::Sheet(_)),
            PatternKind::Stripes | PatternKind::Known(_) => false,
        };
        let (rig, square_px) = if let Some(rig) = &self.known_rig {
            (rig.clone(), None)
        } else {
            let (rig, square) = simulated_rig(&self.rig, subject, placing, checker)?;
            (rig, Some(square))
        };
        if let PatternKind::Known(pattern) = &self.pattern {
            let panel = match pattern {
                Pattern::Checker(p) => p.projector,
                Pattern::Stripes(p) => p.projector,
            };
            rig.projector_for("pattern", panel)?;
            return Ok((rig, pattern.clone()));
        }
        let projector = rig.require_projector()?.device.model;
        let panel = [projector.width, projector.height];
        let pattern = if checker {
            let config = CheckerConfig { square_px, ..CheckerConfig::default() };
            Pattern::Checker(CheckerPattern::new(panel, &config)?)
        } else {
            Pattern::Stripes(StripePattern::new(panel, &StripeConfig::default())?)
        };
        Ok((rig, pattern))
    }
}

/// The rig, with the sheet as its view where there is one, and the side of the squares; those fall on it when `fits`.
fn simulated_rig(config: &RigConfig, subject: &Subject, placing: &Placing, fits: bool) -> Result<(Rig, f64)> {
    let empty = Scene::new(config, &[])?;
    let Subject::Sheet(size) = subject else { return Ok((empty.rig(), empty.square_px)) };
    let [x, y, z] = placing.middle_mm;
    let [tilt_x_rad, tilt_y_rad, roll_rad] = placing.turn_rad;
    let pose =
        PoseConfig { tilt_x_rad, tilt_y_rad, roll_rad, aside_mm: [x, y], farther_mm: z - config.distance_mm };
    if fits {
        let scene = Scene::new(&RigConfig { size: *size, ..config.clone() }, &[pose])?;
        return Ok((scene.rig(), scene.square_px));
    }
    let scene = Scene { size: *size, views: vec![placing.camera_from_sheet(*size)], ..empty };
    Ok((scene.rig(), scene.square_px))
}

/// A scene that is ready to be photographed.
#[derive(Debug, Clone)]
pub struct SceneStage {
    /// The true rig; a simulated one that looks at a sheet has it as its view.
    pub rig: Rig,
    /// What is projected.
    pub pattern: Pattern,
    /// The same as a picture of the panel's size.
    pub picture: RgbImage,
    /// What stands before the rig.
    pub surfaces: Vec<Surface>,
    /// How it is photographed.
    pub render: RenderConfig,
}

impl SceneStage {
    /// Photographs it under the pattern, under a white and under a dark projector.
    ///
    /// # Errors
    /// As [`Photographer::new`].
    pub fn photograph(self) -> Result<SimulatedScene> {
        let photographer = Photographer::new(&self.rig, &self.surfaces, &self.render)?;
        let shot = |shown, frame| photographer.photograph(shown, frame);
        let photo = shot(ProjectedImage::Picture(&self.picture), 0)?;
        let (white, black) = (shot(ProjectedImage::White, 1)?, shot(ProjectedImage::Black, 2)?);
        let matches = match &self.pattern {
            Pattern::Stripes(stripes) => photographer.stripe_matches(stripes),
            Pattern::Checker(checker) => photographer.corner_matches(checker),
        };
        let SceneStage { rig, pattern, picture, .. } = self;
        Ok(SimulatedScene { rig, pattern, picture, photo, white, black, matches, photographer })
    }
}
