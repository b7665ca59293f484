//! `slcal verify`: how square a projection is, and whether the rig has moved.

use std::fmt::Write as _;
use std::path::PathBuf;

use image::DynamicImage;
use slcal_core::detect::Detection;
use slcal_core::format::report_json;
use slcal_core::photo::PhotoView;
use slcal_core::verify::{Change, Measured, Verification};
use slcal_core::{PhotoVerifier, Rig, VerifiedPhoto, VerifyPhotoConfig};

use crate::args::VerifyArgs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{
    Destination, check_panel, check_spares, input_name, load_checker, load_photo, load_rig, png_bytes,
    write_all,
};
use crate::output::{Printer, print_json, print_result};
use crate::picture::expected;

/// A keystone below this is not seen by the eye, degrees: 1 mm over 0.6 m.
const UNSEEN_DEG: f64 = 0.1;

pub(super) fn run(args: &VerifyArgs, printer: Printer) -> Outcome {
    let overlay = Destination::prepare_overlay(args.overlay.as_ref(), args.force)?;
    let inputs = [&args.photo, &args.rig, &args.pattern];
    check_spares(&overlay, inputs.into_iter().map(PathBuf::as_path))?;
    let config = VerifyPhotoConfig {
        size: args.size,
        as_drawn: args.as_drawn,
        encoding: args.gamma.gamma,
        corners: args.corners,
        significance: args.significance,
    };
    config.validate()?;
    let rig = load_rig(&args.rig)?;
    let pattern = load_checker(&args.pattern)?;
    check_panel(&args.pattern, pattern.projector, &args.rig, &rig)?;
    check_size(args, &rig)?;
    let verifier = PhotoVerifier::new(&rig, &pattern, &config).in_file(&args.rig)?;
    let photo = load_photo(&args.photo, printer)?;
    check_camera(args, &photo, &rig)?;
    let view = PhotoView::try_from(&photo).in_file(&args.photo)?;
    let VerifiedPhoto { detection: found, verification: result } =
        verifier.verify(view).in_file(&args.photo)?;
    for note in &found.notes {
        printer.note(format!("{}: {note}", input_name(&args.photo)));
    }
    if let Some(place) = overlay {
        let picture = draw(&photo, &input_name(&args.photo), &found, &rig, &result)?;
        write_all(&[(place, png_bytes(&picture)?)])?;
    }
    if args.json {
        let name = input_name(&args.photo);
        print_json(&report_json::verification(&result, Some(&name), args.as_drawn, found.pattern_corners))?;
    } else {
        print_result(&in_words(args, &result))?;
    }
    let sheet_moved = !args.as_drawn && result.sheet.is_some_and(|s| s.moved);
    if args.fail_if_moved && (result.rig.moved || sheet_moved) {
        let what = if result.rig.moved { "the rig has moved" } else { "the sheet has moved" };
        return Err(Failure::new(Exit::Other, format!("{}: {what}", input_name(&args.photo))));
    }
    Ok(())
}

/// The core asks for the size, too, but does not know the option that states it.
fn check_size(args: &VerifyArgs, rig: &Rig) -> Outcome {
    if args.size.is_some() || !rig.views.is_empty() {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "--size: expected the sheet's size, since {} holds no view of a sheet",
        args.rig.display()
    )))
}

/// As the core does, with the names of both files.
fn check_camera(args: &VerifyArgs, photo: &DynamicImage, rig: &Rig) -> Outcome {
    let (camera, found) = (rig.camera.model, [photo.width(), photo.height()]);
    if [camera.width, camera.height] == found {
        return Ok(());
    }
    Err(Failure::new(
        Exit::Input,
        format!(
            "{}: expected a photograph of {}x{} pixels, by the camera of {}, found {}x{}; a rig holds for one camera at one \
             resolution, uncropped",
            input_name(&args.photo),
            camera.width,
            camera.height,
            args.rig.display(),
            found[0],
            found[1]
        ),
    ))
}

fn draw(
    photo: &DynamicImage,
    name: &str,
    found: &Detection,
    rig: &Rig,
    result: &Verification,
) -> Outcome<DynamicImage> {
    let verdict = format!("the rig {}", rig_in_words(result));
    expected::compared([photo.width(), photo.height()], name, &verdict, found, rig, result).over(photo)
}

/// An angle in degrees with two digits of its σ.
fn degrees(m: Measured) -> String {
    let (value, sigma) = (m.value.to_degrees(), m.sigma.to_degrees());
    format!("{:.d$}° ± {sigma:.d$}°", unsigned(value, digits(sigma)), d = digits(sigma))
}

/// Decimals that show two digits of a σ, and no more than anybody needs.
fn digits(sigma: f64) -> usize {
    if sigma > 0.0 { (1.0 - sigma.log10().floor()).clamp(1.0, 4.0) as usize } else { 4 }
}

/// A number that prints without the sign of a zero.
fn unsigned(x: f64, digits: usize) -> f64 {
    let unit = 10f64.powi(digits as i32);
    (x * unit).round() / unit + 0.0
}

fn probability(p: f64) -> String {
    if p < 1e-6 { "p < 0.000001".into() } else { format!("p = {p:.*}", if p < 0.01 { 6 } else { 2 }) }
}

fn in_words(args: &VerifyArgs, v: &Verification) -> String {
    let mut text = String::new();
    let mut line = |label: &str, content: String| {
        // Writing into a string cannot fail.
        let _ = writeln!(text, "{label:<10} {content}");
    };
    let k = &v.keystone;
    let side = |i: usize| k.sides_rad[i].value.to_degrees();
    line(
        "keystone",
        format!(
            "{} at worst (top {:.3}°, right {:.3}°, bottom {:.3}°, left {:.3}° against the sheet's sides; clockwise counts \
             up)",
            degrees(k.worst_rad),
            side(0),
            side(1),
            side(2),
            side(3)
        ),
    );
    line(
        "",
        format!(
            "turned by {}; width to height off by {:.3} % ± {:.3} %",
            degrees(k.rotation_rad),
            100.0 * k.aspect.value,
            100.0 * k.aspect.sigma
        ),
    );
    line("rig", rig_in_words(v));
    match &v.sheet {
        Some(s) if s.moved && args.as_drawn => line(
            "sheet",
            format!(
                "stands {:.1} mm from its place in the rig's first view, which does no harm here",
                s.shift_mm
            ),
        ),
        Some(s) if s.moved => line(
            "sheet",
            format!(
                "has moved by {:.1} mm and turned by {:.2}° ({}): {}",
                s.shift_mm,
                s.turn_rad.to_degrees(),
                probability(s.p_value),
                if k.worst_rad.value.to_degrees().abs() < UNSEEN_DEG {
                    "the picture is still square to the eye"
                } else {
                    "calibrate with the sheet where it is now, and rectify again"
                }
            ),
        ),
        Some(s) => line("sheet", format!("has not moved ({})", probability(s.p_value))),
        None => {}
    }
    line("test", test_in_words(v));
    text
}

fn rig_in_words(v: &Verification) -> String {
    let r = &v.rig;
    if !r.moved {
        return format!(
            "has not moved ({}); the pattern lies within {:.2} mm (rms) of where the rig puts it",
            probability(r.p_value),
            r.pattern_off_mm
        );
    }
    let percent = |m: Measured| format!("{:+.2} % ± {:.2} %", 100.0 * m.value, 100.0 * m.sigma);
    let what = match r.change {
        Some(Change::Moved { turn_rad, shift_mm }) => format!(
            "projector moved against the camera: turned by {}, shifted by {:.1} ± {:.1} mm",
            degrees(turn_rad),
            shift_mm.value,
            shift_mm.sigma
        ),
        Some(Change::ProjectorFocal(m)) => {
            format!(
                "the projector's focal length has changed by {}: its zoom or focus was turned",
                percent(m)
            )
        }
        Some(Change::CameraFocal(m)) => {
            format!("the camera's focal length has changed by {}: its zoom or focus was turned", percent(m))
        }
        Some(Change::Several) | None => {
            "more than one thing has changed, or the photograph is not by this rig, or the pattern is not projected as said (rectified, \
             or with --as-drawn as it was drawn)"
                .into()
        }
    };
    format!(
        "{what} ({}); the pattern lies {:.1} mm (rms) from where the rig puts it; calibrate again",
        probability(r.p_value),
        r.pattern_off_mm
    )
}

fn test_in_words(v: &Verification) -> String {
    let mut text = format!(
        "at a significance of {} %: so often would an unmoved rig be called moved",
        100.0 * v.significance
    );
    if !v.with_covariance {
        text.push_str(
            "; the rig has no covariance, so that only the noise of the photograph counts: an uncertain rig \
                       looks moved",
        );
    }
    let worst = v.widened[0].max(v.widened[1]);
    if worst > 3.0 {
        let _ = write!(
            text,
            "; what was seen scatters {worst:.1} times more than its noise explains, which weakens the test"
        );
    }
    text
}
