//! A whole simulated scene as a few numbers: a rig, a surface and a pattern that go together.

use image::RgbImage;

use super::config::RenderConfig;
use super::photographer::{Photographer, ProjectedImage};
use super::scene_object::{Placement, SceneObject, sphere_radius_mm};
use super::simulated::SimulatedScene;
use super::surface::Surface;
use crate::error::{Error, ErrorSubject, Result};
use crate::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};
use crate::rig::Rig;
use crate::simulate::poses::PoseConfig;
use crate::simulate::rig_config::RigConfig;
use crate::simulate::scene::Scene;

/// Distance of the wall behind the middle of a sphere or a mesh, in radii.
const WALL_RADII: f64 = 1.5;
/// Tilts at which the surface is visible and completely lit, degrees.
const PLANE_TILT_DEG: [f64; 3] = [10.0, 20.0, 0.0];
const SHEET_TILT_DEG: [f64; 3] = [25.0, 28.0, 0.0];

/// The wall behind the surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum WallKind {
    /// Close behind a sphere and a mesh in its own frame; none elsewhere.
    #[default]
    Usual,
    /// None.
    None,
    /// At this distance behind the surface's middle, mm; not with a plane, which hides it, or a step, which has its
    /// own.
    Behind(f64),
}

/// The projected pattern.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum PatternKind {
    /// The checkerboard on a sheet, stripes on everything else.
    #[default]
    Usual,
    /// The default checkerboard, with squares reduced to fall on the sheet of a simulated rig.
    Checker,
    /// The default stripes.
    Stripes,
    /// A given pattern.
    Known(Pattern),
}

/// A scene as a few numbers. Open values are chosen so that the surface is clearly visible.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSetup {
    /// The rig; its distance is that of the surface's middle, its size that of a sheet.
    pub rig: RigConfig,
    /// A given rig instead. Of `rig` only distance and size are used.
    pub known_rig: Option<Rig>,
    /// The surface.
    pub surface: SceneObject,
    /// Rotations of the surface about the camera's x, y and z axis, R = Rx·Ry·Rz, rad; default 10° and 20° for a plane,
    /// 25° and 28° for a sheet, else none.
    pub turn_rad: Option<[f64; 3]>,
    /// Offset of the surface's middle to the right of and below the camera's axis, mm.
    pub aside_mm: [f64; 2],
    /// Albedo of the surface, red, green, blue; default 0.9.
    pub albedo: [f64; 3],
    /// The wall behind it.
    pub wall: WallKind,
    /// Grey albedo of the wall; default 0.4.
    pub wall_albedo: f64,
    /// The projected pattern.
    pub pattern: PatternKind,
    /// Light, lens and sensor.
    pub render: RenderConfig,
}

impl Default for SceneSetup {
    fn default() -> Self {
        Self {
            rig: RigConfig::default(),
            known_rig: None,
            surface: SceneObject::default(),
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
    /// Checks everything and sets it up. Photographs, which take seconds, are taken separately.
    ///
    /// # Errors
    /// [`Error::Invalid`] for values out of range, surfaces that are turned away or contain the camera, a known rig
    /// without a projector, and a known pattern for another panel than the rig's.
    pub fn set_up(&self) -> Result<PreparedScene> {
        self.render.validate()?;
        let placement = self.placement()?;
        let (rig, pattern) = self.rig_and_pattern(&placement)?;
        let picture = pattern.image()?;
        let surfaces = self.surface.surfaces(&placement, self.rig.size)?;
        Ok(PreparedScene { rig, pattern, picture, surfaces, render: self.render.clone() })
    }

    /// Sets it up and photographs it: [`set_up`](Self::set_up) and [`PreparedScene::photograph`].
    ///
    /// # Errors
    /// As these two.
    pub fn photograph(&self) -> Result<SimulatedScene> {
        self.set_up()?.photograph()
    }

    fn placement(&self) -> Result<Placement> {
        let usual_deg = match self.surface {
            SceneObject::Plane => PLANE_TILT_DEG,
            SceneObject::Sheet => SHEET_TILT_DEG,
            _ => [0.0; 3],
        };
        let wall_mm = match (&self.surface, self.wall) {
            (SceneObject::Plane | SceneObject::Step, WallKind::Behind(mm)) => {
                let expected = "one with a sphere, a sheet or a mesh; a plane hides it, a step has its own";
                return Err(Error::invalid("wall", expected, format!("{mm} mm")));
            }
            (_, WallKind::Behind(mm)) => Some(mm),
            (SceneObject::Sphere { radius_mm }, WallKind::Usual) => {
                Some(WALL_RADII * sphere_radius_mm(*radius_mm, self.rig.distance_mm))
            }
            (SceneObject::Mesh(mesh), WallKind::Usual) => {
                let [least, most] = mesh.bounds();
                Some(WALL_RADII * (most - least).norm() / 2.0)
            }
            (_, WallKind::None | WallKind::Usual) => None,
        };
        Ok(Placement {
            middle_mm: [self.aside_mm[0], self.aside_mm[1], self.rig.distance_mm],
            turn_rad: self.turn_rad.unwrap_or_else(|| usual_deg.map(f64::to_radians)),
            albedo: self.albedo,
            wall_mm,
            wall_albedo: self.wall_albedo,
        })
    }

    fn rig_and_pattern(&self, placement: &Placement) -> Result<(Rig, Pattern)> {
        let checker = match self.pattern {
            PatternKind::Checker => true,
            PatternKind::Usual => self.surface == SceneObject::Sheet,
            PatternKind::Stripes | PatternKind::Known(_) => false,
        };
        let (rig, square_px) = if let Some(rig) = &self.known_rig {
            (rig.clone(), None)
        } else {
            let (rig, square) = self.simulated_rig(placement, checker)?;
            (rig, Some(square))
        };
        if let PatternKind::Known(pattern) = &self.pattern {
            rig.projector_for(ErrorSubject::Pattern, pattern.projector())?;
            return Ok((rig, pattern.clone()));
        }
        let panel = rig.require_projector()?.device.model.size();
        let pattern = if checker {
            let config = CheckerConfig { square_px, ..CheckerConfig::default() };
            Pattern::Checker(CheckerPattern::new(panel, &config)?)
        } else {
            Pattern::Stripes(StripePattern::new(panel, &StripeConfig::default())?)
        };
        Ok((rig, pattern))
    }

    /// The rig, with the sheet as its view where there is one, and the side of the squares; those fall on it when `fits`.
    fn simulated_rig(&self, placement: &Placement, fits: bool) -> Result<(Rig, f64)> {
        let config = &self.rig;
        let empty = Scene::new(config, &[])?;
        if self.surface != SceneObject::Sheet {
            return Ok((empty.rig(), empty.square_px));
        }
        let [x, y, z] = placement.middle_mm;
        let [tilt_x_rad, tilt_y_rad, roll_rad] = placement.turn_rad;
        let (aside_mm, farther_mm) = ([x, y], z - config.distance_mm);
        let pose = PoseConfig { tilt_x_rad, tilt_y_rad, roll_rad, aside_mm, farther_mm };
        let scene = if fits {
            Scene::new(config, &[pose])?
        } else {
            Scene { views: vec![placement.camera_from_sheet(config.size)], ..empty }
        };
        Ok((scene.rig(), scene.square_px))
    }
}

/// A scene that is ready to be photographed.
#[derive(Debug, Clone)]
pub struct PreparedScene {
    /// The true rig; a simulated one that looks at a sheet has it as its view.
    pub rig: Rig,
    /// The projected pattern.
    pub pattern: Pattern,
    /// The same as a picture of the panel's size.
    pub picture: RgbImage,
    /// The surfaces in front of the rig.
    pub surfaces: Vec<Surface>,
    /// Light, lens and sensor.
    pub render: RenderConfig,
}

impl PreparedScene {
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
        let PreparedScene { rig, pattern, picture, .. } = self;
        Ok(SimulatedScene { rig, pattern, picture, photo, white, black, matches, photographer })
    }
}
