//! `slcal rectify`: the picture to project so that it appears upright on the sheet.

use std::path::{Path, PathBuf};

use image::{DynamicImage, RgbImage};
use nalgebra::Point2;
use slcal_core::pattern::{CheckerPattern, warp_image};
use slcal_core::{Rectification, Rig, rectify, rectify_checker};

use crate::args::RectifyArgs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{
    Destination, check_panel, check_spares, load_checker, load_photo, load_rig, png_bytes, write_all,
};
use crate::output::{Printer, print_result};

pub(super) fn run(args: &RectifyArgs, printer: Printer) -> Outcome {
    let output = Destination::prepare(&args.output, args.force)?;
    let inputs = [Some(&args.rig), args.pattern.as_ref(), args.image.as_ref()];
    check_spares([&output], inputs.into_iter().flatten().map(PathBuf::as_path))?;
    let rig = load_rig(&args.rig)?;
    let (picture, place) = match (&args.pattern, &args.image) {
        (Some(path), _) => {
            let pattern = load_checker(path)?;
            check_panel(path, pattern.projector, &args.rig, &rig)?;
            checkerboard(&pattern, &rig, &args.rig)?
        }
        (None, Some(path)) => {
            let picture = load_photo(path, printer)?.to_rgb8();
            any_picture(&picture, &rig, &args.rig)?
        }
        (None, None) => return Err(Failure::usage("expected --pattern or --image")),
    };
    write_all(&[(output.clone(), png_bytes(&DynamicImage::ImageRgb8(picture))?)])?;
    let text = format!(
        "placed     {:.1} x {:.1} mm on the sheet, {:.1} mm from its left and {:.1} mm from its top",
        place.size_mm.width_mm,
        place.size_mm.height_mm,
        unsigned_zero(place.origin_mm.x),
        unsigned_zero(place.origin_mm.y)
    );
    if output == Destination::Stdout {
        printer.note(text);
        return Ok(());
    }
    print_result(&text)
}

fn checkerboard(pattern: &CheckerPattern, rig: &Rig, rig_path: &Path) -> Outcome<(RgbImage, Rectification)> {
    let place = rectify_checker(rig, 0, pattern).in_file(rig_path)?;
    Ok((pattern.draw_warped(&place.panel_from_source)?, place))
}

fn any_picture(picture: &RgbImage, rig: &Rig, rig_path: &Path) -> Outcome<(RgbImage, Rectification)> {
    let (w, h) = (f64::from(picture.width()), f64::from(picture.height()));
    let (top_left, bottom_right) = (Point2::new(-0.5, -0.5), Point2::new(w - 0.5, h - 0.5));
    let place = rectify(rig, 0, top_left, bottom_right).in_file(rig_path)?;
    let panel = rig
        .projector
        .map(|p| [p.model.width, p.model.height])
        .ok_or_else(|| Failure::new(Exit::Input, format!("{}: expected a projector", rig_path.display())))?;
    Ok((warp_image(picture, panel, &place.panel_from_source, [0; 3])?, place))
}

/// A millimetre value to one decimal without the sign of a zero.
fn unsigned_zero(mm: f64) -> f64 {
    (mm * 10.0).round() / 10.0 + 0.0
}
