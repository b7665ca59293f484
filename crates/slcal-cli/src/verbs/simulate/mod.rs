//! `slcal simulate`: rigs, measurements and photographs with ground truth.

mod outputs;
mod scene;

use std::fmt::Write as _;
use std::ops::ControlFlow;

use slcal_core::format::{write_observations, write_rig};
use slcal_core::simulate::{
    BendConfig, Draws, NoiseConfig, NoiseExperiment, NoiseModel, PoseConfig, RigConfig, Scene, SpreadConfig,
    spread_poses,
};

use crate::args::{NoiseArgs, SimulateVerb, ViewsArgs};
use crate::exit::{Exit, Failure, Outcome};
use crate::io::{Destination, bytes_of, check_distinct, write_all};
use crate::output::{Printer, Table, TextLayout, print_json, unbroken};
use crate::summary;

/// The random stream of the noise of `views`, separate from those of its poses.
const NOISE_STREAM: u64 = 1 << 32;

pub(super) fn run(verb: &SimulateVerb, printer: Printer) -> Outcome {
    match verb {
        SimulateVerb::Noise(args) => noise(args, printer),
        SimulateVerb::Views(args) => views(args, printer),
        SimulateVerb::Scene(args) => scene::run(args, printer),
    }
}

fn noise(args: &NoiseArgs, printer: Printer) -> Outcome {
    let csv = args.csv.as_deref().map(|p| Destination::prepare(p, args.force)).transpose()?;
    let csv_to_stdout = csv == Some(Destination::Stdout);
    if args.json && csv_to_stdout {
        return Err(Failure::usage("--json and --csv - both print to stdout; write one of them to a file"));
    }
    let config = NoiseConfig {
        rig: args.rig.config(),
        pose: PoseConfig::tilted(args.tilt.x, args.tilt.y),
        levels_px: args.levels.0.clone(),
        draws: args.draws,
        seed: args.seed,
        principal_points: args.principal_points,
        cube_mm: args.cube,
    };
    let experiment = NoiseExperiment::new(config.clone())?;
    tell_outside(experiment.scene(), printer);
    let progress = printer.progress("draws", Some(experiment.total_draws()));
    let report = experiment.run(|done| {
        progress.reached(done);
        ControlFlow::Continue(())
    })?;
    drop(progress);
    let report = report.ok_or_else(|| Failure::new(Exit::Other, "the experiment was stopped"))?;
    if let Some(place) = csv {
        write_all(&[(place, report.csv().into_bytes())])?;
    }
    if args.json {
        return print_json(&report.to_json(&config));
    }
    printer.summary(&summary::noise_experiment(&config, &report), csv_to_stdout)
}

fn views(args: &ViewsArgs, printer: Printer) -> Outcome {
    let output = Destination::prepare(&args.output, args.force)?;
    let truth = args.truth.as_deref().map(|p| Destination::prepare(p, args.force)).transpose()?;
    check_distinct([&output].into_iter().chain(&truth))?;
    let rig = RigConfig {
        camera_offset_px: [args.camera_offset.x, args.camera_offset.y],
        distortion: args.distortion.0,
        ..args.rig.config()
    };
    let poses = if args.pose.is_empty() {
        spread_poses(&rig, args.poses, &SpreadConfig::default(), args.seed)?
    } else {
        let pose =
            |[x, y, roll]: [f64; 3]| PoseConfig { roll_rad: roll.to_radians(), ..PoseConfig::tilted(x, y) };
        args.pose.iter().map(|p| pose(p.0)).collect()
    };
    let scene = Scene::new(&rig, &poses)?;
    tell_outside(&scene, printer);
    let noise = NoiseModel { edge_points: args.edges, ..NoiseModel::uniform(args.noise) };
    let seen = scene.observe(&noise, &mut Draws::new(args.seed, NOISE_STREAM))?;
    let bytes = bytes_of(|out| write_observations(&seen, out))?;
    let to_stdout = [Some(&output), truth.as_ref()].contains(&Some(&Destination::Stdout));
    let mut files = vec![(output, bytes)];
    if let Some(place) = truth {
        files.push((place, bytes_of(|out| write_rig(&scene.rig(), out))?));
    }
    write_all(&files)?;
    printer.summary(&poses_in_words(&poses, &scene, rig.bend.as_ref()), to_stdout)
}

/// Corners outside the image are simulated, too; a message says so.
fn tell_outside(scene: &Scene, printer: Printer) {
    let outside = scene.outside_picture();
    if outside > 0 {
        printer.note(format!(
            "{outside} of the sheet's and the projected corners lie outside the camera's picture and are simulated as if they \
             were seen; a smaller or more distant sheet, or a shorter lens, brings them in"
        ));
    }
}

fn poses_in_words(poses: &[PoseConfig], scene: &Scene, bend: Option<&BendConfig>) -> String {
    let mut layout = TextLayout::new();
    let mut words = format!(
        "{} views of a sheet of {} with {} projected corners, {} px apart",
        poses.len(),
        unbroken(&format!("{} x {} mm", scene.size.width_mm, scene.size.height_mm)),
        scene.pattern.len(),
        scene.square_px
    );
    if let Some(bend) = bend {
        let _ = write!(words, "; bent: {}", bend.report(scene.size));
    }
    layout.paragraph(words);
    let mut table = Table::new(["", ">tilt, x", ">tilt, y", ">roll"]);
    for (i, p) in poses.iter().enumerate() {
        let angles = [p.tilt_x_rad, p.tilt_y_rad, p.roll_rad].map(|a| format!("{:.1}°", a.to_degrees()));
        table.row(std::iter::once(format!("view {}", i + 1)).chain(angles));
    }
    layout.table(&table);
    layout.into_text()
}
