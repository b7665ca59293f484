//! `slcal simulate scene`: photographs of a rig before a surface, and the truth behind them.

use std::path::Path;

use image::RgbImage;
use slcal_core::Rig;
use slcal_core::format::report_json;
use slcal_core::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};
use slcal_core::simulate::{
    Photographer, Placing, PoseConfig, RenderConfig, RigConfig, Scene, Shown, Subject,
};

use super::super::reconstruct::{make_folder, with_projector};
use super::made::{Made, NAMES, contents};
use super::rig as rig_config;
use crate::args::{Crosstalk, LightArgs, MeshFrameArg, PlaceArgs, SceneArgs};
use crate::exit::{Exit, Failure, Outcome};
use crate::io::{Destination, check_panel, check_spares, load_mesh, load_pattern, load_rig, write_all};
use crate::output::{Printer, print_json, print_result};

/// Radius of the sphere, and how far behind its middle the wall stands, in distances and in radii.
const RADIUS: f64 = 0.18;
const WALL_RADII: f64 = 1.5;

pub(super) fn run(args: &SceneArgs, printer: Printer) -> Outcome {
    let config = render_config(&args.light);
    config.validate()?;
    let subject = subject(args)?;
    let placing = placing(args, &subject)?;
    let (rig, pattern) = rig_and_pattern(args, &subject, &placing)?;
    let picture = picture(&pattern)?;
    let surfaces = subject.surfaces(&placing)?;
    let places = places(args)?;
    printer.detail(format!("{} x {} pixels ...", rig.camera.model.width, rig.camera.model.height));
    let photographer = Photographer::new(&rig, &surfaces, &config)?;
    let photos = [Shown::Picture(&picture), Shown::White, Shown::Black];
    let photos = [0, 1, 2].map(|i| photographer.photograph(photos[i], i as u64));
    let [photo, white, black] = photos;
    let photos = [photo?, white?, black?];
    let matches = match &pattern {
        Pattern::Stripes(stripes) => photographer.stripe_matches(stripes),
        Pattern::Checker(checker) => photographer.corner_matches(checker),
    };
    if matches.items.is_empty() {
        printer.note(
            "the camera sees none of the pattern on the surface: place it in the light of the projector (--distance, --aside, \
             --tilt)",
        );
    }
    let made = Made::of(report_json::simulated_scene(&photographer, &matches));
    let contents = contents(&photos, picture, &pattern, &rig, &matches, &photographer)?;
    write_all(&places.into_iter().zip(contents).collect::<Vec<_>>())?;
    if args.json {
        return print_json(&made);
    }
    print_result(&made.in_words(&args.out))
}

/// Where the files go, in a folder that is made when it does not exist.
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
        encoding: light.gamma.gamma,
        bits,
        ..RenderConfig::default()
    }
}

fn subject(args: &SceneArgs) -> Outcome<Subject> {
    let PlaceArgs { mesh_scale, mesh_frame, radius, .. } = args.place;
    let is_mesh = args
        .surface
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("ply") || e.eq_ignore_ascii_case("obj"));
    match args.surface.to_str() {
        Some("plane") => Ok(Subject::Plane),
        Some("sphere") => Ok(Subject::Sphere { radius_mm: radius.unwrap_or(RADIUS * args.of_rig.distance) }),
        Some("step") => Ok(Subject::Step),
        Some("sheet") => Ok(Subject::Sheet(args.of_rig.size)),
        _ if is_mesh => {
            if !(mesh_scale.is_finite() && mesh_scale > 0.0) {
                return Err(Failure::usage(format!(
                    "--mesh-scale: expected a factor above zero, found {mesh_scale}"
                )));
            }
            let mesh = load_mesh(&args.surface, mesh_scale)?;
            Ok(if mesh_frame == MeshFrameArg::Camera {
                Subject::MeshInCamera(mesh)
            } else {
                Subject::Mesh(mesh)
            })
        }
        _ => Err(Failure::usage(format!(
            "--surface {}: expected plane, sphere, step, sheet, or a mesh whose name ends in .ply or .obj",
            args.surface.display()
        ))),
    }
}

fn placing(args: &SceneArgs, subject: &Subject) -> Outcome<Placing> {
    let place = &args.place;
    let tilt = place.tilt.map_or_else(
        || match subject {
            Subject::Plane => [10.0, 20.0, 0.0],
            Subject::Sheet(_) => [25.0, 28.0, 0.0],
            _ => [0.0; 3],
        },
        |t| t.0,
    );
    let wall_mm = match (subject, place.wall) {
        (Subject::Plane | Subject::Step, Some(_)) => {
            return Err(Failure::usage(
                "--wall: expected with a sphere, a sheet or a mesh; a plane hides it, a step has its own",
            ));
        }
        (_, Some(wall)) => wall.0,
        (Subject::Sphere { radius_mm }, None) => Some(WALL_RADII * radius_mm),
        (Subject::Mesh(mesh), None) => {
            let [least, most] = mesh.bounds();
            Some(WALL_RADII * (most - least).norm() / 2.0)
        }
        _ => None,
    };
    Ok(Placing {
        middle_mm: [place.aside.x, place.aside.y, args.of_rig.distance],
        turn_rad: tilt.map(f64::to_radians),
        albedo: place.albedo.0,
        wall_mm,
        wall_albedo: place.wall_albedo,
    })
}

/// The rig from its file or from the options, and the pattern likewise. Where both come from the options, the checkerboard is
/// as small as it takes to fall on the sheet.
fn rig_and_pattern(args: &SceneArgs, subject: &Subject, placing: &Placing) -> Outcome<(Rig, Pattern)> {
    let named = args.pattern.as_deref().and_then(Path::to_str);
    let wants_checker = match named {
        Some("checker") => true,
        Some("stripes") => false,
        _ => matches!(subject, Subject::Sheet(_)),
    };
    let from_file = match &args.pattern {
        Some(path) if !matches!(named, Some("checker" | "stripes")) => Some((path, load_pattern(path)?)),
        _ => None,
    };
    let (rig, square_px) = if let Some(path) = &args.rig {
        let rig = load_rig(path)?;
        with_projector(&rig, path)?;
        (rig, None)
    } else {
        let config = RigConfig { distortion: args.distortion.0, ..rig_config(&args.of_rig) };
        let checker = wants_checker && from_file.is_none();
        let (rig, square) = simulated_rig(&config, subject, placing, checker)?;
        (rig, Some(square))
    };
    let Some(projector) = rig.projector.map(|p| [p.model.width, p.model.height]) else {
        return Err(Failure::new(Exit::Input, "expected a rig with a projector"));
    };
    if let Some((path, pattern)) = from_file {
        let panel = match &pattern {
            Pattern::Checker(p) => p.projector,
            Pattern::Stripes(p) => p.projector,
        };
        if args.rig.is_none() && panel != projector {
            let [w, h] = panel;
            return Err(Failure::usage(format!(
                "{}: it is a pattern for a projector of {w}x{h}, the simulated one has {}x{}; give --projector {w}x{h}",
                path.display(),
                projector[0],
                projector[1]
            )));
        }
        check_panel(path, panel, args.rig.as_deref().unwrap_or(Path::new("the simulated rig")), &rig)?;
        return Ok((rig, pattern));
    }
    let pattern = if wants_checker {
        Pattern::Checker(CheckerPattern::new(
            projector,
            &CheckerConfig { square_px, ..CheckerConfig::default() },
        )?)
    } else {
        Pattern::Stripes(StripePattern::new(projector, &StripeConfig::default())?)
    };
    Ok((rig, pattern))
}

/// The rig, with the sheet as its view where there is one, and the side of the squares that fall on it.
fn simulated_rig(
    config: &RigConfig,
    subject: &Subject,
    placing: &Placing,
    fits: bool,
) -> Outcome<(Rig, f64)> {
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

fn picture(pattern: &Pattern) -> Outcome<RgbImage> {
    Ok(match pattern {
        Pattern::Checker(p) => p.image(),
        Pattern::Stripes(p) => p.image(),
    }?)
}
