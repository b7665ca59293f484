//! What the photographs show.

use std::path::Path;

use image::DynamicImage;
use slcal_core::detect::{DetectConfig, Detection, observe};
use slcal_core::geometry::Camera;
use slcal_core::pattern::CheckerPattern;
use slcal_core::photo::PhotoView;
use slcal_core::{CalibrateConfig, ExternalObservations, Observations, ViewObservation};

use super::Places;
use crate::args::CalibrateArgs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{Destination, input_name, load_checker, load_photo, png_bytes, write_all};
use crate::output::Printer;
use crate::overlay::Overlay;

/// Finds sheet and pattern in every photograph.
pub(super) fn observe_all(
    args: &CalibrateArgs,
    config: &CalibrateConfig,
    places: &Places,
    printer: Printer,
) -> Outcome<ExternalObservations> {
    let pattern = args.pattern.as_deref().map(load_checker).transpose()?;
    let pattern = pattern.as_ref();
    let mut size = None;
    let mut views: Vec<ViewObservation> = Vec::new();
    for (i, path) in args.photos.iter().enumerate() {
        let photo = load_photo(path, printer)?;
        check_size(
            path,
            &photo,
            *size.get_or_insert([photo.width(), photo.height()]),
            &args.photos[0],
            "photograph",
        )?;
        if let (Some(known), Some(file)) = (&config.known_camera, &args.camera) {
            check_known_camera(path, &photo, known, file)?;
        }
        let screen = args.screen.get(i).map(|s| load_photo(s, printer)).transpose()?;
        if let Some((screen, file)) = screen.as_ref().zip(args.screen.get(i)) {
            check_size(file, screen, [photo.width(), photo.height()], path, "photograph of the same pose")?;
        }
        let detect = DetectConfig {
            encoding: args.gamma.gamma,
            corners: args.corners.get(i).copied(),
            ..DetectConfig::default()
        };
        detect.validate()?;
        printer.detail(format!("{}: looking for the sheet", input_name(path)));
        let found = detect_one(path, &photo, screen.as_ref(), args, pattern, &detect);
        if let (0, Some(place)) = (i, &places.overlay) {
            draw(path, &photo, found.as_ref().ok(), args, place)?;
        }
        let found = found?;
        for note in &found.notes {
            printer.note(format!("{}: {note}", input_name(path)));
        }
        views.push(found.observation);
    }
    let camera = size.unwrap_or_default();
    let observations = Observations { camera, projector: pattern.map(|p| p.projector), views };
    let photos = args.photos.iter().map(|p| Some(input_name(p))).collect();
    Ok(ExternalObservations { photos, ..observations.into() })
}

fn detect_one(
    path: &Path,
    photo: &DynamicImage,
    screen: Option<&DynamicImage>,
    args: &CalibrateArgs,
    pattern: Option<&CheckerPattern>,
    config: &DetectConfig,
) -> Outcome<Detection> {
    let view = PhotoView::try_from(photo).in_file(path)?;
    let screen = screen.map(PhotoView::try_from).transpose().in_file(path)?;
    let size = args.size.ok_or_else(|| Failure::usage("--size: expected the sheet's size, found none"))?;
    observe(view, screen, size, pattern, config).in_file(path)
}

/// Draws what was found. When that is not everything: the corners that were given by hand, or the sheet that would be
/// taken without a pattern.
fn draw(
    path: &Path,
    photo: &DynamicImage,
    found: Option<&Detection>,
    args: &CalibrateArgs,
    place: &Destination,
) -> Outcome {
    let mut overlay = Overlay::new(photo);
    match (found, args.corners.first()) {
        (Some(found), _) => overlay.draw_observation(&found.observation),
        (None, Some(corners)) => overlay.draw_sheet(corners),
        (None, None) => {
            let detect = DetectConfig { encoding: args.gamma.gamma, ..DetectConfig::default() };
            if let Ok(sheet) = detect_one(path, photo, None, args, None, &detect) {
                overlay.draw_observation(&sheet.observation);
            }
        }
    }
    write_all(&[(place.clone(), png_bytes(&overlay.into_picture())?)])
}

fn check_size(path: &Path, photo: &DynamicImage, expected: [u32; 2], like: &Path, what: &str) -> Outcome {
    let found = [photo.width(), photo.height()];
    if found == expected {
        return Ok(());
    }
    Err(Failure::new(
        Exit::Input,
        format!(
            "{}: expected a {what} of {}x{} pixels like {}, found {}x{}; all photographs must come from one camera at one \
             setting, uncropped",
            input_name(path),
            expected[0],
            expected[1],
            input_name(like),
            found[0],
            found[1]
        ),
    ))
}

fn check_known_camera(path: &Path, photo: &DynamicImage, known: &Camera, file: &Path) -> Outcome {
    if [known.width, known.height] == [photo.width(), photo.height()] {
        return Ok(());
    }
    Err(Failure::new(
        Exit::Input,
        format!(
            "{}: expected the intrinsics of a camera of {}x{} pixels like {}, found {}x{}; intrinsics hold for one \
             resolution only",
            file.display(),
            photo.width(),
            photo.height(),
            input_name(path),
            known.width,
            known.height
        ),
    ))
}
