//! The published synthetic experiment: repeated calibrations under increasing noise.

use std::ops::ControlFlow;

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use super::bound::{Bound, bound};
use super::cube::Cube;
use super::draws::Draws;
use super::poses::PoseConfig;
use super::rig_config::RigConfig;
use super::scene::{NoiseModel, Scene};
use super::trial::{MethodName, MethodReport, Tally};
use crate::calibrate::{CalibrateConfig, DistortionModel, Flatness, Method, PrincipalPointRule};
use crate::error::{Error, Result, within};
use crate::named::named;

/// Largest noise, px: beyond it no corner is detectable.
const MOST_LEVEL_PX: f64 = 100.0;
const MOST_LEVELS: usize = 1000;
/// Largest number of draws times levels: beyond it an experiment takes hours.
const MOST_DRAWS: usize = 1_000_000;
/// Edges of the reference cube when none is given, as shares of the sheet's shorter side: the first one whose corners
/// lie in the picture and on the panel.
const CUBE_SHARES: [f64; 4] = [0.25, 0.2, 0.15, 0.1];
/// Smallest level at which the bound is computed; it is proportional to the noise where nothing but the noise limits
/// it.
const BOUND_AT_LEAST_PX: f64 = 1e-6;

/// Prior knowledge of the principal points that the methods get.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PrincipalPoints {
    /// The true values, as in the published experiment.
    #[default]
    Exact,
    /// The default of the methods: `ml` has its priors, `two-vp` takes the centres as exact. The truth is drawn from
    /// the priors for every draw. (The projector's row, which is unknown by default, is the one of its lens shift.)
    Prior,
}

named!(PrincipalPoints, "principal points", { Exact => "exact", Prior => "prior" });

/// Parameters of [`NoiseExperiment`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NoiseConfig {
    /// The rig.
    pub rig: RigConfig,
    /// The pose of the sheet; default tilted by 25° and 28°.
    pub pose: PoseConfig,
    /// 1σ of each coordinate of the sheet's corners and the projected corners, camera px; default 0 to 1 in steps of 0.1.
    pub levels_px: Vec<f64>,
    /// Draws of the noise per level; default 50.
    pub draws: usize,
    /// Seed of the draws; default 1.
    pub seed: u64,
    /// Prior knowledge of the principal points; default the true values.
    pub principal_points: PrincipalPoints,
    /// Edge of the reference cube, mm; default a quarter of the sheet's shorter side, or less where that is not
    /// completely visible.
    pub cube_mm: Option<f64>,
}

impl Default for NoiseConfig {
    fn default() -> Self {
        Self {
            rig: RigConfig::default(),
            pose: PoseConfig::tilted(25.0, 28.0),
            levels_px: (0..=10).map(|i| f64::from(i) / 10.0).collect(),
            draws: 50,
            seed: 1,
            principal_points: PrincipalPoints::Exact,
            cube_mm: None,
        }
    }
}

impl NoiseConfig {
    /// Checks the values that are not the rig's or the pose's.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the value, its range and what was given.
    pub fn validate(&self) -> Result<()> {
        if !(1..=MOST_LEVELS).contains(&self.levels_px.len()) {
            let expected = format!("1 to {MOST_LEVELS} levels");
            return Err(Error::invalid("noise levels", expected, self.levels_px.len()));
        }
        for level in &self.levels_px {
            within("noise level", *level, [0.0, MOST_LEVEL_PX], " px")?;
        }
        let most = MOST_DRAWS / self.levels_px.len();
        if !(1..=most).contains(&self.draws) {
            let expected = format!("1 to {most} with {} levels", self.levels_px.len());
            return Err(Error::invalid("draws per level", expected, self.draws));
        }
        Ok(())
    }
}

/// The true values of an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrueValues {
    /// Focal length of the camera, px.
    pub camera_focal_px: f64,
    /// Focal length of the projector, px.
    pub projector_focal_px: f64,
    /// Translation camera → projector, mm.
    pub translation_mm: [f64; 3],
    /// Side of the projected squares, projector px.
    pub square_px: f64,
    /// Edge of the reference cube, mm.
    pub cube_mm: f64,
    /// Corners of the cube that both devices see.
    pub cube_corners: usize,
}

/// Both methods at one level of the noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelReport {
    /// 1σ of each coordinate, camera px.
    pub level_px: f64,
    /// The Cramér–Rao bound; with priors, the Bayesian one.
    pub bound: Bound,
    /// `two-vp`, then `ml`, from the same draws.
    pub methods: [MethodReport; 2],
}

/// The whole experiment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseReport {
    /// The true values.
    pub truth: TrueValues,
    /// In the order of the configuration.
    pub levels: Vec<LevelReport>,
}

/// An experiment that is ready to run, level by level.
#[derive(Debug, Clone)]
pub struct NoiseExperiment {
    config: NoiseConfig,
    scene: Scene,
    cube: Cube,
}

impl NoiseExperiment {
    /// Builds rig, sheet and cube.
    ///
    /// # Errors
    /// [`Error::Invalid`] for values out of range, and where sheet, pattern or cube are not visible.
    pub fn new(config: NoiseConfig) -> Result<Self> {
        config.validate()?;
        let scene = Scene::new(&config.rig, &[config.pose])?;
        let size = config.rig.size;
        let edges = match config.cube_mm {
            Some(edge) => vec![edge],
            None => CUBE_SHARES.map(|s| s * size.width_mm.min(size.height_mm)).to_vec(),
        };
        let mut cube = Err(Error::invalid("reference cube", "an edge", "none"));
        for edge in edges {
            cube = Cube::new(&scene, edge);
            if cube.is_ok() {
                break;
            }
        }
        Ok(Self { config, cube: cube?, scene })
    }

    /// The scene that is observed in every draw.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The true values.
    #[must_use]
    pub fn truth(&self) -> TrueValues {
        TrueValues {
            camera_focal_px: self.scene.camera.intrinsics.fx,
            projector_focal_px: self.scene.projector.intrinsics.fx,
            translation_mm: self.scene.projector_from_camera.translation.into(),
            square_px: self.scene.square_px,
            cube_mm: self.cube.edge_mm(),
            cube_corners: self.cube.visible(),
        }
    }

    /// Number of draws over all levels.
    #[must_use]
    pub fn total_draws(&self) -> usize {
        self.config.draws * self.config.levels_px.len()
    }

    /// Runs all levels. `progress` is called before every draw, which takes milliseconds, with the number of completed
    /// draws, and may stop the run; then there is no report.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a draw of the principal points puts something behind a device.
    pub fn run(&self, mut progress: impl FnMut(usize) -> ControlFlow<()>) -> Result<Option<NoiseReport>> {
        let mut levels = Vec::with_capacity(self.config.levels_px.len());
        for (i, &level_px) in self.config.levels_px.iter().enumerate() {
            let before = i * self.config.draws;
            let Some(level) = self.level(i, level_px, &mut |done| progress(before + done))? else {
                return Ok(None);
            };
            levels.push(level);
        }
        Ok(Some(NoiseReport { truth: self.truth(), levels }))
    }

    fn level(
        &self,
        index: usize,
        level_px: f64,
        progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
    ) -> Result<Option<LevelReport>> {
        let noise = NoiseModel::uniform(level_px);
        let mut tallies = [Tally::default(), Tally::default()];
        for draw in 0..self.config.draws {
            if progress(draw).is_break() {
                return Ok(None);
            }
            // Every draw has its own stream, so that it does not depend on the draws before.
            let mut draws = Draws::new(self.config.seed, ((index as u64) << 32) | draw as u64);
            let scene = self.drawn_scene(&mut draws);
            let observations = scene.observe(&noise, &mut draws)?;
            for (tally, method) in tallies.iter_mut().zip([Method::TwoVp, Method::Ml]) {
                // Both methods get the same noise on the cube, too.
                let mut of_cube = draws.clone();
                let config = self.calibrate_config(method, &scene);
                tally.add((&scene, &self.cube, level_px), &observations, &config, &mut of_cube);
            }
        }
        let [two_vp, ml] = tallies;
        Ok(Some(LevelReport {
            level_px,
            bound: self.bound(level_px)?,
            methods: [two_vp.report(MethodName::TwoVp), ml.report(MethodName::Ml)],
        }))
    }

    fn prior_px(&self) -> [f64; 4] {
        let share = CalibrateConfig::default().principal_point_sigma;
        let of = |width: u32| share * f64::from(width);
        let (camera, projector) = (of(self.scene.camera.width), of(self.scene.projector.width));
        [camera, camera, projector, 0.0]
    }

    /// The scene with principal points drawn from the priors, when the methods use those.
    fn drawn_scene(&self, draws: &mut Draws) -> Scene {
        let mut scene = self.scene.clone();
        if self.config.principal_points == PrincipalPoints::Prior {
            let [x, y, column, _] = self.prior_px();
            scene.camera.intrinsics.cx += x * draws.normal();
            scene.camera.intrinsics.cy += y * draws.normal();
            scene.projector.intrinsics.cx += column * draws.normal();
        }
        scene
    }

    fn calibrate_config(&self, method: Method, scene: &Scene) -> CalibrateConfig {
        let exact = |p: Point2<f64>| PrincipalPointRule::Exact(p.x, p.y);
        let (camera_pp, projector_pp) = match self.config.principal_points {
            PrincipalPoints::Exact => (
                exact(scene.camera.intrinsics.principal_point()),
                exact(scene.projector.intrinsics.principal_point()),
            ),
            PrincipalPoints::Prior => (PrincipalPointRule::Prior, PrincipalPointRule::Shift),
        };
        // What is ideal is taken for ideal, as the published method does and as the bound assumes.
        let (distortion, flatness) = if scene.is_ideal() {
            (DistortionModel::None, Flatness::Flat)
        } else {
            (DistortionModel::Auto, Flatness::Paper)
        };
        CalibrateConfig {
            camera_pp,
            projector_pp,
            method,
            distortion,
            projector_distortion: distortion,
            flatness,
            // Refused rigs are counted and stay in the statistics: without them, the errors would be biased low.
            allow_degenerate: true,
            ..CalibrateConfig::default()
        }
    }

    fn bound(&self, level_px: f64) -> Result<Bound> {
        let noise = NoiseModel::uniform(level_px.max(BOUND_AT_LEAST_PX));
        let prior = match self.config.principal_points {
            PrincipalPoints::Exact => [0.0; 4],
            PrincipalPoints::Prior => {
                let [x, y, column, _] = self.prior_px();
                // The row is unknown; a prior of several heights is as good as none.
                [x, y, column, 4.0 * f64::from(self.scene.projector.height)]
            }
        };
        bound(&self.scene, &noise, prior)
    }
}

#[cfg(test)]
#[path = "experiment_tests.rs"]
mod tests;
