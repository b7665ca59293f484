//! `slcal simulate scene`: rendered photographs of a surface, with ground truth.

use std::path::Path;

use slcal_core::Rig;
use slcal_core::simulate::{PatternKind, RenderConfig, RigConfig, SceneObject, SceneSetup, WallKind};

use super::outputs::{NAMES, SceneOutputs, contents};
use crate::args::{LightArgs, MeshFrameArg, PlaceArgs, SceneArgs};
use crate::exit::{Failure, Outcome};
use crate::io::{
    Destination, check_panel, check_projector, check_spares, load_mesh, load_pattern, load_rig, make_folder,
    write_all,
};
use crate::output::{Printer, print_json, print_result};

pub(super) fn run(args: &SceneArgs, printer: Printer) -> Outcome {
    let busy = printer.busy("preparing the scene");
    let stage = setup(args)?.set_up()?;
    let places = places(args)?;
    let [w, h] = stage.rig.camera.model.size();
    printer.detail(format!("{w} x {h} pixels ..."));
    busy.say(format!("rendering photographs of {w}x{h} pixels"));
    let scene = stage.photograph()?;
    if scene.matches.items.is_empty() {
        printer.note(
            "the camera sees none of the pattern on the surface; move the surface into the projector light (--distance, --aside, \
             --tilt)",
        );
    }
    busy.say("computing the ground truth of every pixel");
    let outputs = SceneOutputs::of(&scene);
    write_all(&places.into_iter().zip(contents(&scene)?).collect::<Vec<_>>())?;
    drop(busy);
    if args.json {
        return print_json(&outputs);
    }
    print_result(&outputs.in_words(&args.out))
}

/// The destinations of the files, in a folder that is created when it does not exist.
fn places(args: &SceneArgs) -> Outcome<Vec<Destination>> {
    make_folder(&args.out)?;
    let places = NAMES
        .iter()
        .map(|name| Destination::prepare(&args.out.join(name), args.force))
        .collect::<Outcome<Vec<_>>>()?;
    check_spares(
        &places,
        [Some(args.surface.as_path()), args.pattern.as_deref(), args.rig.as_deref()].into_iter().flatten(),
    )?;
    Ok(places)
}

fn render_config(light: &LightArgs) -> RenderConfig {
    let exact = RenderConfig::exact();
    let (noise_levels, blur_px, bits) = if light.exact {
        (exact.noise_levels, exact.blur_px, exact.bits)
    } else {
        (light.noise, light.blur, light.bits)
    };
    RenderConfig {
        exposure: light.exposure,
        ambient: light.ambient,
        projector_black: light.projector_black,
        projector_blur_px: light.projector_blur,
        crosstalk: light.crosstalk,
        blur_px,
        noise_levels,
        seed: light.seed,
        encoding: light.gamma.gamma,
        bits,
        ..RenderConfig::default()
    }
}

fn setup(args: &SceneArgs) -> Outcome<SceneSetup> {
    let render = render_config(&args.light);
    render.validate()?;
    let place = &args.place;
    let surface = surface(args)?;
    if place.wall.is_some() && matches!(surface, SceneObject::Plane | SceneObject::Step) {
        return Err(Failure::usage(
            "--wall: expected a sphere, a sheet or a mesh as surface; a plane hides the wall, and a step has one",
        ));
    }
    let known_rig = args.rig.as_deref().map(known_rig).transpose()?;
    Ok(SceneSetup {
        rig: RigConfig { distortion: args.distortion, ..args.of_rig.config() },
        surface,
        turn_rad: place.tilt.map(|t| t.map(f64::to_radians)),
        aside_mm: [place.aside.x, place.aside.y],
        albedo: place.albedo,
        wall: place.wall.unwrap_or(WallKind::Usual),
        wall_albedo: place.wall_albedo,
        pattern: pattern(args, known_rig.as_ref())?,
        known_rig,
        render,
    })
}

fn surface(args: &SceneArgs) -> Outcome<SceneObject> {
    let PlaceArgs { mesh_scale, mesh_frame, radius, .. } = args.place;
    let is_mesh = args
        .surface
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("ply") || e.eq_ignore_ascii_case("obj"));
    match args.surface.to_str() {
        Some("plane") => Ok(SceneObject::Plane),
        Some("sphere") => Ok(SceneObject::Sphere { radius_mm: radius }),
        Some("step") => Ok(SceneObject::Step),
        Some("sheet") => Ok(SceneObject::Sheet),
        _ if is_mesh => {
            if !(mesh_scale.is_finite() && mesh_scale > 0.0) {
                return Err(Failure::usage(format!(
                    "--mesh-scale: expected a factor above zero, found {mesh_scale}"
                )));
            }
            let mesh = load_mesh(&args.surface, mesh_scale)?;
            Ok(if mesh_frame == MeshFrameArg::Camera {
                SceneObject::MeshInCamera(mesh)
            } else {
                SceneObject::Mesh(mesh)
            })
        }
        _ => Err(Failure::usage(format!(
            "--surface {}: expected plane, sphere, step, sheet, or a mesh whose name ends in .ply or .obj",
            args.surface.display()
        ))),
    }
}

fn known_rig(path: &Path) -> Outcome<Rig> {
    let rig = load_rig(path)?;
    check_projector(path, &rig)?;
    Ok(rig)
}

/// The projected pattern. A pattern file must match the projector of the rig. The core checks this, too, but does not know
/// the files and options for the message.
fn pattern(args: &SceneArgs, known_rig: Option<&Rig>) -> Outcome<PatternKind> {
    let path = match (args.pattern.as_deref(), args.pattern.as_deref().and_then(Path::to_str)) {
        (None, _) => return Ok(PatternKind::Usual),
        (_, Some("checker")) => return Ok(PatternKind::Checker),
        (_, Some("stripes")) => return Ok(PatternKind::Stripes),
        (Some(path), _) => path,
    };
    let pattern = load_pattern(path)?;
    let panel = pattern.projector();
    let projector = args.of_rig.projector;
    match (known_rig, &args.rig) {
        (Some(rig), Some(file)) => check_panel(path, panel, file, rig)?,
        _ if panel != projector => {
            let [w, h] = panel;
            return Err(Failure::usage(format!(
                "{}: the pattern is for a projector of {w}x{h}, but the simulated projector has {}x{}; use --projector {w}x{h}",
                path.display(),
                projector[0],
                projector[1]
            )));
        }
        _ => {}
    }
    Ok(PatternKind::Known(pattern))
}
