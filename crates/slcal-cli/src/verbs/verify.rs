//! `slcal verify`: how square a projection is, and whether the rig has moved.

use std::path::PathBuf;

use image::DynamicImage;
use slcal_core::detect::Detection;
use slcal_core::photo::PhotoView;
use slcal_core::verify::Verification;
use slcal_core::{PhotoVerifier, Rig, VerifiedPhoto, VerifyPhotoConfig, Warning};

use crate::args::VerifyArgs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{
    Destination, check_image_size, check_panel, check_spares, input_name, load_checker, load_photo, load_rig,
    png_bytes, write_all,
};
use crate::output::{Printer, print_json, print_result, without_style};
use crate::picture::{for_display, verification};
use crate::summary;

pub(super) fn run(args: &VerifyArgs, printer: Printer) -> Outcome {
    let overlay = Destination::prepare_overlay(args.overlay.as_ref(), args.force)?;
    let inputs = [&args.photo, &args.rig, &args.pattern];
    check_spares(&overlay, inputs.into_iter().map(PathBuf::as_path))?;
    let config = VerifyPhotoConfig {
        size: args.size,
        as_drawn: args.as_drawn,
        mirrored: args.mirror.mirror,
        encoding: args.gamma.encoding(),
        corners: args.corners,
        significance: args.significance,
    };
    config.validate()?;
    let rig = load_rig(&args.rig)?;
    let pattern = load_checker(&args.pattern)?;
    check_panel(&args.pattern, pattern.projector, &args.rig, &rig)?;
    check_size(args, &rig)?;
    let verifier = PhotoVerifier::new(&rig, &pattern, &config).in_file(&args.rig)?;
    let busy = printer.busy(format!("finding the sheet in {}", input_name(&args.photo)));
    let photo = load_photo(&args.photo, args.gamma.samples(), printer)?;
    check_image_size(&args.photo, &photo, &args.rig, &rig)?;
    let view = PhotoView::try_from(&photo).in_file(&args.photo)?;
    let VerifiedPhoto { detection: found, verification: result, .. } =
        verifier.verify(view).in_file(&args.photo)?;
    drop(busy);
    for note in &found.notes {
        printer.note(format!("{}: {note}", input_name(&args.photo)));
    }
    for Warning { message, advice, .. } in &found.warnings {
        printer.note(format!("{}: {message}; {advice}", input_name(&args.photo)));
    }
    if let Some(place) = overlay {
        let seen = for_display(photo, config.encoding);
        let picture = draw(&seen, &input_name(&args.photo), &found, &rig, &result)?;
        write_all(&[(place, png_bytes(&picture)?)])?;
    }
    if args.json {
        let name = input_name(&args.photo);
        print_json(&result.to_json(Some(&name), args.as_drawn, found.pattern_corners))?;
    } else {
        print_result(&summary::verification(&result, args.as_drawn))?;
    }
    let sheet_moved = !args.as_drawn && result.sheet_moved().unwrap_or(false);
    if args.fail_if_moved && (result.rig_moved() || sheet_moved) {
        let what = if result.rig_moved() { "the rig has moved" } else { "the sheet has moved" };
        return Err(Failure::new(Exit::Other, format!("{}: {what}", input_name(&args.photo))));
    }
    Ok(())
}

/// The core checks the size, too, but does not know the option for the message.
fn check_size(args: &VerifyArgs, rig: &Rig) -> Outcome {
    if args.size.is_some() || !rig.views.is_empty() {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "--size: expected the size of the sheet, because {} has no view of a sheet",
        args.rig.display()
    )))
}

fn draw(
    photo: &DynamicImage,
    name: &str,
    found: &Detection,
    rig: &Rig,
    result: &Verification,
) -> Outcome<DynamicImage> {
    let verdict = without_style(&format!("the rig {}", summary::rig_in_words(result)));
    verification::drawing([photo.width(), photo.height()], name, &verdict, found, rig, result).over(photo)
}
