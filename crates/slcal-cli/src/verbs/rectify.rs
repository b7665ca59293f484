//! `slcal rectify`: the picture to project so that it appears without keystone on the sheet.

use std::path::PathBuf;

use image::DynamicImage;
use slcal_core::{rectify_checker_picture, rectify_picture};

use crate::args::RectifyArgs;
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{
    Destination, Samples, check_panel, check_spares, load_checker, load_photo, load_rig, png_bytes, write_all,
};
use crate::output::{Printer, TextLayout};
use crate::summary::unsigned;

pub(super) fn run(args: &RectifyArgs, printer: Printer) -> Outcome {
    let output = Destination::prepare(&args.output, args.force)?;
    let inputs = [Some(&args.rig), args.pattern.as_ref(), args.image.as_ref()];
    check_spares([&output], inputs.into_iter().flatten().map(PathBuf::as_path))?;
    let rig = load_rig(&args.rig)?;
    let busy = printer.busy("drawing the picture");
    let (picture, place) = match (&args.pattern, &args.image) {
        (Some(path), _) => {
            let pattern = load_checker(path)?;
            check_panel(path, pattern.projector, &args.rig, &rig)?;
            rectify_checker_picture(&rig, 0, &pattern).in_file(&args.rig)?
        }
        (None, Some(path)) => {
            let picture = load_photo(path, Samples::AsFileSays, printer)?.to_rgb8();
            rectify_picture(&rig, 0, &picture).in_file(&args.rig)?
        }
        (None, None) => return Err(Failure::usage("expected --pattern or --image")),
    };
    write_all(&[(output.clone(), png_bytes(&DynamicImage::ImageRgb8(picture))?)])?;
    drop(busy);
    let mut layout = TextLayout::new();
    let placed = format!(
        "{:.1} x {:.1} mm on the sheet, {:.1} mm from its left edge and {:.1} mm from its top edge",
        place.size_mm.width_mm,
        place.size_mm.height_mm,
        unsigned(place.origin_mm.x, 1),
        unsigned(place.origin_mm.y, 1)
    );
    layout.line("placed", placed);
    printer.summary(&layout.into_text(), output == Destination::Stdout)
}
