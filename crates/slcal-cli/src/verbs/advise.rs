//! `slcal advise`: the next best view.

use slcal_core::advise::{CameraPlan, advise_first, advise_next};
use slcal_core::geometry::Camera;
use slcal_core::{CalibrateConfig, Error, PrincipalPointRule};

use crate::args::AdviseArgs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{check_panel, load_camera, load_checker, load_rig};
use crate::output::{print_json, print_result};
use crate::summary;

pub(super) fn run(args: &AdviseArgs) -> Outcome {
    let advice = match &args.rig {
        Some(path) => {
            let rig = load_rig(path)?;
            let pattern = args.pattern.as_deref().map(load_checker).transpose()?;
            if let (Some(pattern), Some(file)) = (&pattern, &args.pattern) {
                check_panel(file, pattern.projector, path, &rig)?;
            }
            advise_next(&rig, pattern.as_ref()).in_file(path)?
        }
        None => advise_first(&plan(args)?)?,
    };
    if args.json { print_json(&advice.to_json()) } else { print_result(&summary::advice(&advice)) }
}

fn plan(args: &AdviseArgs) -> Outcome<CameraPlan> {
    let size = args.size.ok_or_else(|| Failure::usage("expected --size"))?;
    let config = CalibrateConfig {
        camera_pp: args.camera_pp,
        projector_pp: args.projector_pp,
        distortion: args.distortion,
        flatness: args.flatness,
        ..CalibrateConfig::default()
    };
    config.validate()?;
    let camera = camera(args, config.camera_pp)?;
    let projector = args.projector.map(|panel| projector(args, panel, config.projector_pp)).transpose()?;
    let (distance_mm, noise_px) = (args.distance, [args.noise; 2]);
    Ok(CameraPlan { camera, projector, size, distance_mm, noise_px, config })
}

/// Names the option of a value in the message.
fn stated_by(option: &str, device: slcal_core::Result<Camera>) -> Outcome<Camera> {
    device.map_err(|error| match error {
        Error::Invalid { expected, found, .. } => {
            Failure::usage(format!("{option}: expected {expected}, found {found}"))
        }
        other => other.into(),
    })
}

fn camera(args: &AdviseArgs, pp: PrincipalPointRule) -> Outcome<Camera> {
    if let Some(path) = &args.camera {
        let known = load_camera(path)?;
        let [width, height] = known.size.ok_or_else(|| {
            let wanted = "expected an image size in the file (image_width and image_height)";
            Failure::new(Exit::Input, format!("{}: {wanted}", path.display()))
        })?;
        return Ok(Camera { width, height, intrinsics: known.intrinsics, distortion: known.distortion });
    }
    let image = args.image.ok_or_else(|| Failure::usage("expected --rig, --camera or --image"))?;
    let camera = match (args.focal, args.fov, args.focal_35mm) {
        (Some(focal), ..) => stated_by("--focal", Camera::pinhole(image, focal))?,
        (_, Some(fov), _) => stated_by("--fov", Camera::from_fov(image, fov))?,
        (_, _, Some(mm)) => stated_by("--focal-35mm", Camera::from_35mm(image, mm))?,
        _ => return Err(Failure::usage("expected --focal, --fov or --focal-35mm with --image")),
    };
    Ok(camera.with_principal_point(pp.expected(image)))
}

/// A usual projector: with lens shift its axis passes through the lower edge of the panel.
fn projector(args: &AdviseArgs, panel: [u32; 2], pp: PrincipalPointRule) -> Outcome<Camera> {
    let projector = match (args.throw, args.projector_focal) {
        (Some(ratio), _) => stated_by("--throw", Camera::from_throw(panel, ratio))?,
        (_, Some(focal)) => stated_by("--projector-focal", Camera::pinhole(panel, focal))?,
        _ => return Err(Failure::usage("expected --throw or --projector-focal with --projector")),
    };
    Ok(projector.with_principal_point(pp.expected(panel)))
}
