//! A whole simulated scene as a few numbers: a rig, a surface and a pattern that go together.

use image::RgbImage;

use super::config::RenderConfig;
use super::mesh::TriangleMesh;
use super::photographer::{Photographer, ProjectedImage};
use super::report_json::SceneReport;
use super::scene_object::{Placement, SceneObject};
use super::sheet_object::SheetObject;
use super::simulated::SimulatedScene;
use super::surface::Surface;
use crate::error::{Error, ErrorSubject, Result};
use crate::matches::Matches;
use crate::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};
use crate::rig::Rig;
use crate::simulate::bend::BendReport;
use crate::simulate::poses::PoseConfig;
use crate::simulate::rig_config::RigConfig;
use crate::simulate::scene::Scene;

/// Radius of the sphere, in distances; distance of the wall behind its middle, or a mesh's, in radii.
const RADIUS: f64 = 0.18;
const WALL_RADII: f64 = 1.5;
/// Tilts at which the surface is visible and completely lit, degrees.
const PLANE_TILT_DEG: [f64; 3] = [10.0, 20.0, 0.0];
const SHEET_TILT_DEG: [f64; 3] = [25.0, 28.0, 0.0];

/// The surface in front of the rig.
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
    /// A sheet of [`RigConfig::size`], bent as [`RigConfig::bend`] says.
    Sheet,
    /// A mesh as in [`SceneObject::Mesh`].
    Mesh(TriangleMesh),
    /// A mesh as in [`SceneObject::MeshInCamera`].
    MeshInCamera(TriangleMesh),
}

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
    /// A given rig instead. Of `rig` only distance, size and bend are used.
    pub known_rig: Option<Rig>,
    /// The surface.
    pub surface: SurfaceKind,
    /// Thickness of the sheet, mm: a foam board whose side faces are as white as its front. Default 0.
    pub thickness_mm: f64,
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
    /// Whether the picture appears with left and right exchanged, as in rear projection; the rig then says so.
    pub mirrored: bool,
    /// Light, lens and sensor.
    pub render: RenderConfig,
}

impl Default for SceneSetup {
    fn default() -> Self {
        Self {
            rig: RigConfig::default(),
            known_rig: None,
            surface: SurfaceKind::default(),
            thickness_mm: 0.0,
            turn_rad: None,
            aside_mm: [0.0; 2],
            albedo: [0.9; 3],
            wall: WallKind::default(),
            wall_albedo: 0.4,
            pattern: PatternKind::default(),
            mirrored: false,
            render: RenderConfig::default(),
        }
    }
}

impl SceneSetup {
    /// Checks everything and sets it up. Photographs, which take seconds, are taken separately.
    ///
    /// # Errors
    /// [`Error::Invalid`] for values out of range, surfaces that are turned away or contain the camera, a bend or a thickness
    /// of anything but a sheet, a known rig without a projector, and a known pattern for another panel than the rig's.
    pub fn set_up(&self) -> Result<PreparedScene> {
        self.render.validate()?;
        let object = self.object()?;
        let placement = self.placement(&object)?;
        let (mut rig, pattern) = self.rig_and_pattern(&object, &placement)?;
        if let Some(projector) = &mut rig.projector {
            projector.mirrored |= self.mirrored;
        }
        let picture = pattern.image()?;
        let surfaces = object.surfaces(&placement)?;
        let (bend, thickness_mm) = match object {
            SceneObject::Sheet(sheet) => {
                (self.rig.bend.map(|b| b.report(sheet.size)), Some(sheet.thickness_mm).filter(|t| *t > 0.0))
            }
            _ => (None, None),
        };
        Ok(PreparedScene { rig, pattern, picture, surfaces, bend, thickness_mm, render: self.render.clone() })
    }

    /// Sets it up and photographs it: [`set_up`](Self::set_up) and [`PreparedScene::photograph`].
    ///
    /// # Errors
    /// As these two.
    pub fn photograph(&self) -> Result<SimulatedScene> {
        self.set_up()?.photograph()
    }

    fn object(&self) -> Result<SceneObject> {
        let sheet = matches!(self.surface, SurfaceKind::Sheet);
        if let Some(bend) = self.rig.bend.filter(|_| !sheet) {
            return Err(Error::invalid("bend", "a sheet as surface", bend));
        }
        if !sheet && self.thickness_mm != 0.0 {
            return Err(Error::invalid(
                "thickness",
                "a sheet as surface",
                format!("{} mm", self.thickness_mm),
            ));
        }
        Ok(match &self.surface {
            SurfaceKind::Plane => SceneObject::Plane,
            SurfaceKind::Sphere { radius_mm } => {
                SceneObject::Sphere { radius_mm: radius_mm.unwrap_or(RADIUS * self.rig.distance_mm) }
            }
            SurfaceKind::Step => SceneObject::Step,
            SurfaceKind::Sheet => SceneObject::Sheet(SheetObject::new(
                self.rig.size,
                self.rig.bend.as_ref(),
                self.thickness_mm,
            )?),
            SurfaceKind::Mesh(mesh) => SceneObject::Mesh(mesh.clone()),
            SurfaceKind::MeshInCamera(mesh) => SceneObject::MeshInCamera(mesh.clone()),
        })
    }

    fn placement(&self, object: &SceneObject) -> Result<Placement> {
        let usual_deg = match object {
            SceneObject::Plane => PLANE_TILT_DEG,
            SceneObject::Sheet(_) => SHEET_TILT_DEG,
            _ => [0.0; 3],
        };
        let wall_mm = match (object, self.wall) {
            (SceneObject::Plane | SceneObject::Step, WallKind::Behind(mm)) => {
                let expected = "one with a sphere, a sheet or a mesh; a plane hides it, a step has its own";
                return Err(Error::invalid("wall", expected, format!("{mm} mm")));
            }
            (_, WallKind::Behind(mm)) => Some(mm),
            (SceneObject::Sphere { radius_mm }, WallKind::Usual) => Some(WALL_RADII * radius_mm),
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

    fn rig_and_pattern(&self, object: &SceneObject, placement: &Placement) -> Result<(Rig, Pattern)> {
        let checker = match self.pattern {
            PatternKind::Checker => true,
            PatternKind::Usual => matches!(object, SceneObject::Sheet(_)),
            PatternKind::Stripes | PatternKind::Known(_) => false,
        };
        let (rig, square_px) = if let Some(rig) = &self.known_rig {
            (rig.clone(), None)
        } else {
            let (rig, square) = simulated_rig(&self.rig, object, placement, checker)?;
            (rig, Some(square))
        };
        if let PatternKind::Known(pattern) = &self.pattern {
            rig.projector_for(ErrorSubject::Pattern, pattern.projector())?;
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
fn simulated_rig(
    config: &RigConfig,
    object: &SceneObject,
    placement: &Placement,
    fits: bool,
) -> Result<(Rig, f64)> {
    let empty = Scene::new(config, &[])?;
    let SceneObject::Sheet(sheet) = object else { return Ok((empty.rig(), empty.square_px)) };
    let [x, y, z] = placement.middle_mm;
    let [tilt_x_rad, tilt_y_rad, roll_rad] = placement.turn_rad;
    let pose =
        PoseConfig { tilt_x_rad, tilt_y_rad, roll_rad, aside_mm: [x, y], farther_mm: z - config.distance_mm };
    if fits {
        let scene = Scene::new(&RigConfig { size: sheet.size, ..config.clone() }, &[pose])?;
        return Ok((scene.rig(), scene.square_px));
    }
    let scene = Scene { size: sheet.size, views: vec![placement.camera_from_sheet(sheet.size)], ..empty };
    Ok((scene.rig(), scene.square_px))
}

/// A scene that is ready to be photographed.
#[derive(Debug, Clone)]
pub struct PreparedScene {
    /// The true rig; a simulated one that looks at a sheet has it as its view.
    pub rig: Rig,
    /// The projected pattern.
    pub pattern: Pattern,
    /// The same as a picture of the panel's size; of a sequence, the first one.
    pub picture: RgbImage,
    /// The surfaces in front of the rig.
    pub surfaces: Vec<Surface>,
    /// The bend of the sheet, where it has one.
    pub bend: Option<BendReport>,
    /// The thickness of the sheet, mm, where it has one.
    pub thickness_mm: Option<f64>,
    /// Light, lens and sensor.
    pub render: RenderConfig,
}

impl PreparedScene {
    /// Photographs it under the pattern, under a white and under a dark projector. Of a sequence the photograph under white stands for
    /// that under the pattern; [`SimulatedScene::frames`] takes those of its pictures one after another.
    ///
    /// # Errors
    /// As [`Photographer::new`].
    pub fn photograph(self) -> Result<SimulatedScene> {
        let photographer = Photographer::new(&self.rig, &self.surfaces, &self.render)?;
        let shot = |shown, frame| photographer.exposure(shown, frame);
        let (white, black) = (shot(ProjectedImage::White, 1)?, shot(ProjectedImage::Black, 2)?);
        let photo = match &self.pattern {
            Pattern::Sequence(_) => white.clone(),
            _ => shot(ProjectedImage::Picture(&self.picture), 0)?,
        };
        let files = photo.file.zip(white.file).zip(black.file);
        let jpeg_files = files.map(|((photo, white), black)| [photo, white, black]);
        let [photo, white, black] = [photo.picture, white.picture, black.picture];
        let matches = match &self.pattern {
            Pattern::Stripes(stripes) => photographer.stripe_matches(stripes),
            Pattern::Checker(checker) => photographer.corner_matches(checker),
            Pattern::Sequence(_) => Matches::default(),
        };
        let PreparedScene { rig, pattern, picture, bend, thickness_mm, .. } = self;
        let report = SceneReport { bend, thickness_mm, ..photographer.report(&matches) };
        Ok(SimulatedScene {
            rig,
            pattern,
            picture,
            photo,
            white,
            black,
            jpeg_files,
            matches,
            photographer,
            report,
        })
    }
}
