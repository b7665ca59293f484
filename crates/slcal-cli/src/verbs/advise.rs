//! `slcal advise`: which photograph to take next.

use std::fmt::Write as _;

use slcal_core::calibrate::{Advice, CameraPlan, Predicted, TiltForecast, advise_first, advise_next};
use slcal_core::format::report_json;
use slcal_core::geometry::Camera;
use slcal_core::{CalibrateConfig, Error, PrincipalPointRule};

use super::calibrate::{distortion, rule};
use crate::args::AdviseArgs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{check_panel, load_camera, load_checker, load_rig};
use crate::output::{print_json, print_result};

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
    if args.json { print_json(&report_json::advice(&advice)) } else { print_result(&in_words(&advice)) }
}

fn plan(args: &AdviseArgs) -> Outcome<CameraPlan> {
    let size = args.size.ok_or_else(|| Failure::usage("expected --size"))?;
    let config = CalibrateConfig {
        camera_pp: rule(args.camera_pp),
        projector_pp: rule(args.projector_pp),
        distortion: distortion(args.distortion),
        ..CalibrateConfig::default()
    };
    config.validate()?;
    let camera = camera(args, config.camera_pp)?;
    let projector = args.projector.map(|panel| projector(args, panel, config.projector_pp)).transpose()?;
    let (distance_mm, noise_px) = (args.distance, [args.noise; 2]);
    Ok(CameraPlan { camera, projector, size, distance_mm, noise_px, config })
}

/// Names the option that states a value.
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
            let wanted = "expected an image size in the file, to know where the frame ends; add image_width and image_height";
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

/// A projector as it usually is: with lens shift its axis leaves through the panel's lower edge.
fn projector(args: &AdviseArgs, panel: [u32; 2], pp: PrincipalPointRule) -> Outcome<Camera> {
    let projector = match (args.throw, args.projector_focal) {
        (Some(ratio), _) => stated_by("--throw", Camera::from_throw(panel, ratio))?,
        (_, Some(focal)) => stated_by("--projector-focal", Camera::pinhole(panel, focal))?,
        _ => return Err(Failure::usage("expected --throw or --projector-focal with --projector")),
    };
    Ok(projector.with_principal_point(pp.expected(panel)))
}

/// Per cent with two significant digits.
fn percent(share: f64) -> String {
    let p = 100.0 * share;
    match p {
        p if p >= 1000.0 => ">1000".into(),
        p if p >= 10.0 => format!("{p:.0}"),
        p if p > 0.0 => format!("{p:.*}", (1.0 - p.log10().floor()).clamp(1.0, 4.0) as usize),
        _ => "0".into(),
    }
}

fn predicted(p: &Predicted) -> String {
    let mut text = format!("camera {} %", percent(p.camera_focal));
    if let Some(f) = p.projector_focal {
        let _ = write!(text, ", projector {} %", percent(f));
    }
    if let Some(cy) = p.projector_cy_px {
        let _ = write!(text, ", its cy {cy:.1} px");
    }
    if let Some(mm) = p.point_mm {
        let _ = write!(text, "; a point at the sheet {mm:.2} mm");
    }
    text
}

fn in_words(advice: &Advice) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "Predicted 1σ of the focal lengths, per cent; the sheet of {:.0} x {:.0} mm {:.0} mm from the camera",
        advice.size.width_mm, advice.size.height_mm, advice.distance_mm
    );
    if let Some(now) = &advice.now {
        let _ = writeln!(text, "now        {}", predicted(now));
    }
    let with_projector = advice.table.iter().filter_map(|t| t.one).any(|p| p.projector_focal.is_some());
    let (camera, projector): (Figure, Figure) = (|p| Some(p.camera_focal), |p| p.projector_focal);
    let tables: &[(&str, Outlook)] = if advice.now.is_some() {
        &[("after one more photograph", |t| t.one)]
    } else {
        &[("after one photograph", |t| t.one), ("after two, the second with the tilt reversed", |t| t.pair)]
    };
    for (title, of) in tables {
        table(&mut text, advice, &format!("camera, {title}"), |t| of(t).and_then(|p| camera(&p)));
        if with_projector {
            table(&mut text, advice, &format!("projector, {title}"), |t| of(t).and_then(|p| projector(&p)));
        }
    }
    let _ = writeln!(
        text,
        "\nAcross: tilt about the vertical axis, + with the right side nearer to the camera than the left. Down: about the\n\
         horizontal axis, + with the top side nearer than the bottom. Sides are as the photograph shows them. - : the sheet\n\
         would leave the frame or the pattern the sheet, or be seen too flat.\n"
    );
    text.push_str(&next(advice));
    text
}

/// Which photographs are forecast.
type Outlook = fn(&TiltForecast) -> Option<Predicted>;
/// Which number of a forecast.
type Figure = fn(&Predicted) -> Option<f64>;

fn table(text: &mut String, advice: &Advice, title: &str, of: impl Fn(&TiltForecast) -> Option<f64>) {
    let _ = write!(text, "\n{title}\n       ");
    let Some(first) = advice.table.first() else { return };
    for t in advice.table.iter().take_while(|t| t.tilt_x_rad == first.tilt_x_rad) {
        let _ = write!(text, "{:>7}", format!("{:+.0}°", t.tilt_y_rad.to_degrees()));
    }
    let mut row = f64::NAN;
    for t in &advice.table {
        if t.tilt_x_rad != row {
            row = t.tilt_x_rad;
            let _ = write!(text, "\n{:>7}", format!("{:+.0}°", row.to_degrees()));
        }
        let _ = write!(text, "{:>7}", of(t).map_or("-".to_owned(), percent));
    }
    text.push('\n');
}

fn next(advice: &Advice) -> String {
    let Some(next) = &advice.next else {
        return "next       no pose is possible: the sheet does not fit into the frame at this distance, or the pattern onto \
                the sheet; move the sheet further away or make the pattern smaller"
            .into();
    };
    let words = next.in_words(advice.size);
    match &advice.now {
        None => format!(
            "next       {words}\n           then photograph it again with both tilts reversed\nafter both {}",
            predicted(&next.after)
        ),
        Some(_) if advice.worth_it => format!("next       {words}\nafter it   {}", predicted(&next.after)),
        Some(_) => format!(
            "next       nothing more is worth it: the best pose would bring {}\n           ({words})",
            predicted(&next.after)
        ),
    }
}
