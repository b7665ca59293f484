//! `slcal simulate scene`: rendered photographs of a surface, with ground truth.

use std::path::Path;

use slcal_core::Rig;
use slcal_core::pattern::Pattern;
use slcal_core::simulate::{PatternKind, RenderConfig, RigConfig, SceneSetup, SurfaceKind, WallKind};

use super::outputs::{SceneFile, SceneOutputs};
use crate::args::{Crosstalk, LightArgs, MeshFrameArg, PlaceArgs, SceneArgs, WallArg};
use crate::exit::{Failure, Outcome};
use crate::io::{
    Destination, Together, check_panel, check_projector, check_spares, load_mesh, load_pattern, load_rig,
    make_folder,
};
use crate::output::{Printer, print_json, print_result};

pub(super) fn run(args: &SceneArgs, printer: Printer) -> Outcome {
    let busy = printer.busy("preparing the scene");
    let stage = setup(args)?.set_up()?;
    let places = places(args, &stage.pattern)?;
    let [w, h] = [stage.rig.camera.model.width, stage.rig.camera.model.height];
    printer.detail(format!("{w} x {h} pixels ..."));
    busy.say(format!("rendering photographs of {w}x{h} pixels"));
    let scene = stage.photograph()?;
    let sees_pattern = match scene.frame_count() {
        0 => !scene.matches.items.is_empty(),
        _ => scene.report.lit_pixels > 0,
    };
    if !sees_pattern {
        printer.note(
            "the camera sees none of the pattern on the surface; move the surface into the projector light (--distance, --aside, \
             --tilt)",
        );
    }
    let outputs = SceneOutputs::of(&scene);
    let mut written = Together::default();
    for (file, place) in places {
        busy.say(match file {
            SceneFile::Frame(i) => {
                format!("rendering photograph {} of {} of {w}x{h} pixels", i + 1, scene.frame_count())
            }
            _ => "computing the ground truth of every pixel".to_owned(),
        });
        written.add(place, file.content(&scene)?)?;
    }
    written.appear()?;
    drop(busy);
    if args.json {
        return print_json(&outputs);
    }
    print_result(&outputs.in_words(&args.out))
}

/// The destinations of the files, in a folder that is created when it does not exist.
fn places(args: &SceneArgs, pattern: &Pattern) -> Outcome<Vec<(SceneFile, Destination)>> {
    make_folder(&args.out)?;
    let place = |file: SceneFile| {
        let name = file.name(pattern, args.devices.jpeg.is_some());
        Destination::prepare(&args.out.join(name), args.force).map(|place| (file, place))
    };
    let places = SceneFile::all(pattern).into_iter().map(place).collect::<Outcome<Vec<_>>>()?;
    check_spares(
        places.iter().map(|(_, place)| place),
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
        ambient: light.ambient.0,
        projector_black: light.projector_black,
        projector_blur_px: light.projector_blur,
        crosstalk: match light.crosstalk {
            Crosstalk::Neighbours(share) => RenderConfig::neighbour_crosstalk(share),
            Crosstalk::Matrix(m) => m,
        },
        blur_px,
        noise_levels,
        seed: light.seed,
        encoding: light.gamma,
        bits,
        ..RenderConfig::default()
    }
}

fn setup(args: &SceneArgs) -> Outcome<SceneSetup> {
    let mut render = render_config(&args.light);
    args.devices.apply(&mut render);
    render.validate()?;
    let place = &args.place;
    let surface = surface(args)?;
    if place.wall.is_some() && matches!(surface, SurfaceKind::Plane | SurfaceKind::Step) {
        return Err(Failure::usage(
            "--wall: expected a sphere, a sheet or a mesh as surface; a plane hides the wall, and a step has one",
        ));
    }
    if !matches!(surface, SurfaceKind::Sheet) {
        for (option, given) in
            [("--bend", args.of_rig.bend.is_some()), ("--thickness", place.thickness.is_some())]
        {
            if given {
                return Err(Failure::usage(format!(
                    "{option}: expected --surface sheet; other surfaces have none"
                )));
            }
        }
    }
    let known_rig = args.rig.as_deref().map(known_rig).transpose()?;
    Ok(SceneSetup {
        rig: RigConfig { distortion: args.distortion.0, ..args.of_rig.config() },
        surface,
        thickness_mm: place.thickness.unwrap_or(0.0),
        turn_rad: place.tilt.map(|t| t.0.map(f64::to_radians)),
        aside_mm: [place.aside.x, place.aside.y],
        albedo: place.albedo.0,
        wall: match place.wall {
            None => WallKind::Usual,
            Some(WallArg(None)) => WallKind::None,
            Some(WallArg(Some(mm))) => WallKind::Behind(mm),
        },
        wall_albedo: place.wall_albedo,
        pattern: pattern(args, known_rig.as_ref())?,
        known_rig,
        mirrored: args.devices.mirror,
        render,
    })
}

fn surface(args: &SceneArgs) -> Outcome<SurfaceKind> {
    let PlaceArgs { mesh_scale, mesh_frame, radius, .. } = args.place;
    let is_mesh = args
        .surface
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("ply") || e.eq_ignore_ascii_case("obj"));
    match args.surface.to_str() {
        Some("plane") => Ok(SurfaceKind::Plane),
        Some("sphere") => Ok(SurfaceKind::Sphere { radius_mm: radius }),
        Some("step") => Ok(SurfaceKind::Step),
        Some("sheet") => Ok(SurfaceKind::Sheet),
        _ if is_mesh => {
            if !(mesh_scale.is_finite() && mesh_scale > 0.0) {
                return Err(Failure::usage(format!(
                    "--mesh-scale: expected a factor above zero, found {mesh_scale}"
                )));
            }
            let mesh = load_mesh(&args.surface, mesh_scale)?;
            Ok(if mesh_frame == MeshFrameArg::Camera {
                SurfaceKind::MeshInCamera(mesh)
            } else {
                SurfaceKind::Mesh(mesh)
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
