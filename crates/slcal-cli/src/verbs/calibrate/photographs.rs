//! Detection of sheet and pattern in the photographs.

use std::path::Path;

use image::DynamicImage;
use slcal_core::detect::{DetectConfig, observe};
use slcal_core::format::KnownCamera;
use slcal_core::geometry::SheetSize;
use slcal_core::photo::PhotoView;
use slcal_core::{
    CalibrateConfig, Calibrator, Error, ErrorSubject, PhotoTags, SequencePattern, SheetPhoto, TaggedFocal,
};

use super::overlay::Gallery;
use super::sequences::{SequencePose, SequencePoses};
use crate::args::CalibrateArgs;
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{input_name, load_checker, load_photo, load_tagged_photo};
use crate::output::Printer;
use crate::picture::for_display;
use crate::picture::sheet::Partly;

/// Detects sheet and pattern in every photograph, and adds the detections to the gallery.
pub(super) fn observe_all(
    args: &CalibrateArgs,
    sequence: Option<&SequencePattern>,
    config: CalibrateConfig,
    known: Option<(&Path, &KnownCamera)>,
    mut gallery: Option<&mut Gallery>,
    printer: Printer,
) -> Outcome<Calibrator> {
    let mut calibrator =
        Calibrator::new(sheet_size(args)?).with_encoding(args.gamma.encoding()).with_config(config);
    if args.mirror.mirror && args.pattern.is_none() {
        return Err(Failure::usage("--mirror: expected --pattern; without a projector nothing is mirrored"));
    }
    let mut poses = None;
    if let Some((path, pattern)) = args.pattern.as_ref().zip(sequence) {
        poses = Some(SequencePoses::new(path, pattern, args.mirror.mirror)?);
        calibrator = if args.mirror.mirror {
            calibrator.with_mirrored_sequence(pattern)
        } else {
            calibrator.with_sequence(pattern)
        };
    } else if let Some(path) = &args.pattern {
        let pattern = load_checker(path)?;
        calibrator = if args.mirror.mirror {
            calibrator.with_mirrored_pattern(&pattern)
        } else {
            calibrator.with_pattern(&pattern)
        };
    }
    let mut stated = None;
    let busy = printer.progress("photographs", Some(args.photos.len()));
    for (i, path) in args.photos.iter().enumerate() {
        let name = input_name(path);
        let mut matches = None;
        let (photo, tags) = if let Some(poses) = &mut poses {
            busy.say(format!("decoding the photographs in {name}"));
            let SequencePose { white, tags, matches: decoded } = poses.read(path, args, printer)?;
            matches = Some(decoded);
            (white, tags)
        } else {
            load_tagged_photo(path, args.gamma.samples(), printer)?
        };
        busy.say(format!("finding the sheet in {name}"));
        let size = [photo.width(), photo.height()];
        if let Some((file, known)) = known.filter(|_| i == 0) {
            // Checked before any detection.
            calibrator.config_mut().known_camera = Some(known.for_image(size).in_file(file)?);
        }
        let mut shot = SheetPhoto::new(PhotoView::try_from(&photo).in_file(path)?).name(&name);
        if let Some(matches) = &matches {
            shot = shot.matches(matches);
        }
        if args.exif {
            stated = Some(tagged_focal(path, &tags, size)?);
            shot = shot.focal_from_tags();
        }
        if let Ok(tags) = tags {
            shot = shot.tags(tags);
        }
        let plain = args.plain.get(i).map(|s| load_photo(s, args.gamma.samples(), printer)).transpose()?;
        if let Some((plain, file)) = plain.as_ref().zip(args.plain.get(i)) {
            shot = shot.plain(PhotoView::try_from(plain).in_file(file)?);
        }
        if let Some(corners) = args.corners.get(i) {
            shot = shot.corners(*corners);
        }
        printer.detail(format!("{name}: looking for the sheet"));
        let found = calibrator.add(shot).map_err(|error| {
            // The file that the error is about.
            let plain = matches!(error, Error::Invalid { what: ErrorSubject::PlainPhotograph, .. });
            Failure::in_file(args.plain.get(i).filter(|_| plain).unwrap_or(path), &error)
        });
        if let Some(gallery) = gallery.as_deref_mut() {
            let partly = if found.is_err() { partly(i, &photo, args) } else { Partly::default() };
            gallery.add(path, for_display(photo, args.gamma.encoding()), found.as_deref(), partly);
        }
        for note in &found?.notes {
            printer.note(format!("{name}: {note}"));
        }
        busy.step();
    }
    drop(busy);
    say_how_it_lies(args, &calibrator, printer);
    if let Some(focal) = stated {
        printer.note(format!(
            "EXIF: focal length {focal}, used as a prior of {:.0} px with σ of {:.1} %",
            focal.prior.focal_px,
            100.0 * focal.prior.sigma_share
        ));
    }
    Ok(calibrator)
}

/// The focal length that `--exif` asks for.
fn tagged_focal(path: &Path, tags: &Result<PhotoTags, String>, size: [u32; 2]) -> Outcome<TaggedFocal> {
    let refused = |found: &str| {
        let message = format!(
            "--exif: expected the EXIF tags of an uncropped photograph that state the focal length (FocalLengthIn35mmFilm, or \
             FocalLength and the size of the sensor), found {found}; give the photograph as the camera wrote it, or leave --exif out"
        );
        Failure::input(path, message)
    };
    let tags = tags.as_ref().map_err(|why| refused(&format!("no readable tags ({why})")))?;
    tags.focal(size).map_err(|error| match error {
        Error::Invalid { found, .. } => refused(&found),
        other => Failure::in_file(path, &other),
    })
}

/// Says how the sheet lies that was given by its name alone.
fn say_how_it_lies(args: &CalibrateArgs, calibrator: &Calibrator, printer: Printer) {
    let Some(sheet) = args.size.filter(SheetSize::is_either_way) else { return };
    for (found, path) in calibrator.detections().iter().zip(&args.photos) {
        let size = found.observation.size;
        let lies = if size == sheet.upright() { "upright" } else { "across" };
        let [width, height] = [size.width_mm, size.height_mm];
        printer.note(format!("{}: {sheet} is taken to lie {lies}, {width} x {height} mm", input_name(path)));
    }
}

fn sheet_size(args: &CalibrateArgs) -> Outcome<SheetSize> {
    args.size.ok_or_else(|| Failure::usage("--size: expected the size of the sheet, found none"))
}

/// What can be drawn when not everything was found: the corners given by hand, or the sheet that is detected
/// without a pattern.
fn partly(i: usize, photo: &DynamicImage, args: &CalibrateArgs) -> Partly {
    if let Some(corners) = args.corners.get(i) {
        return Partly::Given(*corners);
    }
    let alone = || {
        let detect = DetectConfig { encoding: args.gamma.encoding(), ..DetectConfig::default() };
        observe(PhotoView::try_from(photo).ok()?, None, args.size?.upright(), None, &detect).ok()
    };
    alone().map_or(Partly::Nothing, |found| Partly::Sheet(Box::new(found.observation)))
}
