//! Photographs and observations with known truth. The functions take the options of `slcal.simulate` as one dictionary,
//! for that module says what they are.

mod options;
mod scene;

use std::ops::ControlFlow;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slcal_core::simulate::{
    Draws, NoiseConfig, NoiseExperiment, NoiseModel, PoseConfig, SceneSetup, SpreadConfig, spread_poses,
};

use self::options::{
    Options, angles, channels, number, only_place, pattern, poses, render_config, rig_config, surface, wall,
    whole,
};
use self::scene::{Scene, SceneFrames};
use crate::convert::array::{Numbers, vector_of};
use crate::convert::object::object;
use crate::convert::option::parsed;
use crate::convert::report::{LazyReport, record};
use crate::errors::{Raise as _, Stage};
use crate::observations::Observations;
use crate::rig::Rig;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Scene>()?;
    module.add_class::<SceneFrames>()?;
    module.add_function(wrap_pyfunction!(simulate_scene, module)?)?;
    module.add_function(wrap_pyfunction!(simulate_views, module)?)?;
    module.add_function(wrap_pyfunction!(simulate_noise, module)?)
}

/// The stream of the noise of views, as the command has it: beyond those of their poses.
const NOISE_STREAM: u64 = 1 << 32;

/// Photographs of a simulated scene, with the ground truth of every pixel; see `slcal.simulate.scene`.
#[pyfunction]
#[pyo3(signature = (options, /))]
fn simulate_scene(options: &Bound<'_, PyDict>) -> PyResult<Scene> {
    let py = options.py();
    let options = Options(options);
    let rig = rig_config(&options)?;
    let known_rig = match options.get("rig")? {
        Some(known) => {
            only_place(py, &rig)?;
            Some(object::<Rig>(&known, "rig")?.get().rig.clone())
        }
        None => None,
    };
    let mut setup = SceneSetup {
        rig,
        known_rig,
        surface: surface(&options)?,
        wall: wall(&options)?,
        pattern: pattern(&options)?,
        mirrored: options.flag("mirror")?,
        render: render_config(&options)?,
        ..SceneSetup::default()
    };
    setup.turn_rad =
        options.get("tilt")?.map(|t| angles(&t, "tilt")).transpose()?.map(|t| t.map(f64::to_radians));
    options.set("aside", &mut setup.aside_mm, |v| vector_of(v, "aside"))?;
    options.set("albedo", &mut setup.albedo, |v| channels(v, "albedo"))?;
    options.number("wall_albedo", &mut setup.wall_albedo)?;
    options.number("thickness", &mut setup.thickness_mm)?;
    let scene = py.detach(|| setup.photograph()).raise(py, Stage::Detect)?;
    let report = LazyReport::of("SceneReport", &scene.report);
    Ok(Scene { scene, report })
}

/// Observations of a sheet in several poses and the rig behind them; see `slcal.simulate.views`.
#[pyfunction]
#[pyo3(signature = (options, /))]
fn simulate_views(options: &Bound<'_, PyDict>) -> PyResult<(Observations, Rig)> {
    let py = options.py();
    let options = Options(options);
    let rig = rig_config(&options)?;
    let (mut count, mut seed, mut noise) = (10_usize, 1_u64, 0.1);
    options.whole("poses", &mut count)?;
    options.whole("seed", &mut seed)?;
    options.number("noise", &mut noise)?;
    let edge_points = options.get("edges")?.map(|e| whole(&e, "edges")).transpose()?;
    let given = options.get("pose")?.map(|p| poses(&p)).transpose()?;
    let work = || {
        let poses = given.map_or_else(|| spread_poses(&rig, count, &SpreadConfig::default(), seed), Ok)?;
        let scene = slcal_core::simulate::Scene::new(&rig, &poses)?;
        let noise = NoiseModel { edge_points, ..NoiseModel::uniform(noise) };
        let seen = scene.observe(&noise, &mut Draws::new(seed, NOISE_STREAM))?;
        Ok((seen, scene.rig()))
    };
    let (seen, rig) = py.detach(work).raise(py, Stage::Detect)?;
    Ok((Observations(seen), rig.into()))
}

/// Both calibration methods at increasing noise; see `slcal.simulate.noise`.
#[pyfunction]
#[pyo3(signature = (options, /))]
fn simulate_noise<'py>(options: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
    let py = options.py();
    let options = Options(options);
    let mut config = NoiseConfig { rig: rig_config(&options)?, ..NoiseConfig::default() };
    if let Some(tilt) = options.get("tilt")? {
        let [x, y] = vector_of(&tilt, "tilt")?;
        config.pose = PoseConfig::tilted(x, y);
    }
    options.set("levels", &mut config.levels_px, |v| {
        Ok(Numbers::of(v, "levels")?.view().iter().copied().collect())
    })?;
    options.whole("draws", &mut config.draws)?;
    options.whole("seed", &mut config.seed)?;
    options.set("principal_points", &mut config.principal_points, |v| parsed(v, "principal_points"))?;
    config.cube_mm = options.get("cube")?.map(|c| number(&c, "cube")).transpose()?;
    let mut interrupted = None;
    #[allow(clippy::redundant_closure_for_method_calls, reason = "the method is not general enough")]
    let run = || {
        // Ctrl-C ends the experiment between two draws, not after minutes.
        NoiseExperiment::new(config.clone())?.run(|_| match Python::attach(|py| py.check_signals()) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                interrupted = Some(error);
                ControlFlow::Break(())
            }
        })
    };
    match py.detach(run).raise(py, Stage::Detect)? {
        Some(report) => record(py, "NoiseReport", &report.to_json(&config)),
        None => Err(interrupted.unwrap_or_else(|| PyRuntimeError::new_err("the experiment was stopped"))),
    }
}
