//! What the photographs show.

use std::path::Path;

use image::DynamicImage;
use slcal_core::detect::{DetectConfig, Detection, observe};
use slcal_core::format::KnownCamera;
use slcal_core::pattern::CheckerPattern;
use slcal_core::photo::PhotoView;
use slcal_core::{ExternalObservations, FocalPrior, Observations, ViewObservation};

use super::for_image;
use super::overlay::Gallery;
use crate::args::CalibrateArgs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{focal_35mm, input_name, load_checker, load_photo, load_photo_and_file};
use crate::output::Printer;
use crate::picture::for_display;
use crate::picture::sheet::Partly;

/// What the photographs show and say.
pub(super) struct Seen {
    pub(super) observations: ExternalObservations,
    /// From their EXIF tags, when asked for.
    pub(super) focal_prior: Option<FocalPrior>,
}

/// Finds sheet and pattern in every photograph, and puts what was found into the gallery.
pub(super) fn observe_all(
    args: &CalibrateArgs,
    known: Option<&KnownCamera>,
    mut gallery: Option<&mut Gallery>,
    printer: Printer,
) -> Outcome<Seen> {
    let pattern = args.pattern.as_deref().map(load_checker).transpose()?;
    let pattern = pattern.as_ref();
    let (mut size, mut lens) = (None, Lens::default());
    let mut views: Vec<ViewObservation> = Vec::new();
    let busy = printer.progress("photographs", Some(args.photos.len()));
    for (i, path) in args.photos.iter().enumerate() {
        busy.say(format!("finding the sheet in {}", input_name(path)));
        let (photo, file) = load_photo_and_file(path, printer)?;
        check_size(
            path,
            &photo,
            *size.get_or_insert([photo.width(), photo.height()]),
            &args.photos[0],
            "photograph",
        )?;
        // Before the work on the pictures begins.
        if let (Some(known), Some(file)) = (known, &args.camera) {
            for_image(file, known, [photo.width(), photo.height()])?;
        }
        if args.exif {
            lens.agree(path, focal_35mm(path, &file, [photo.width(), photo.height()])?)?;
        }
        drop(file);
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
        if let Some(gallery) = gallery.as_deref_mut() {
            let partly = if found.is_err() { partly(i, path, &photo, args) } else { Partly::default() };
            gallery.add(path, for_display(photo, args.gamma.gamma), found.as_ref(), partly);
        }
        let found = found?;
        for note in &found.notes {
            printer.note(format!("{}: {note}", input_name(path)));
        }
        views.push(found.observation);
        busy.step();
    }
    drop(busy);
    let camera = size.unwrap_or_default();
    let observations = Observations { camera, projector: pattern.map(|p| p.projector), views };
    let photos = args.photos.iter().map(|p| Some(input_name(p))).collect();
    let focal_prior = lens.0.as_ref().map(|(mm, _)| FocalPrior::from_35mm_equivalent(*mm, camera));
    if let (Some((mm, _)), Some(prior)) = (&lens.0, focal_prior) {
        printer.note(format!(
            "EXIF: a focal length of {mm} mm on 35 mm film, {:.0} px with σ of {:.1} % here, is expected",
            prior.focal_px,
            100.0 * prior.sigma_share
        ));
    }
    Ok(Seen { observations: ExternalObservations { photos, ..observations.into() }, focal_prior })
}

/// The 35 mm equivalent of the first photograph, mm, and which one that was.
#[derive(Default)]
struct Lens(Option<(f64, String)>);

impl Lens {
    /// One camera at one setting has one focal length.
    fn agree(&mut self, path: &Path, mm: f64) -> Outcome {
        let (first, name) = self.0.get_or_insert_with(|| (mm, input_name(path)));
        if (*first - mm).abs() < 1e-9 {
            return Ok(());
        }
        Err(Failure::new(
            Exit::Input,
            format!(
                "{}: --exif: expected the focal length of {name}, {first} mm (35 mm equivalent), found {mm} mm; all \
                 photographs must come from one camera at one setting of its zoom",
                input_name(path)
            ),
        ))
    }
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

/// What can be drawn when not everything was found: the corners that were given by hand, or the sheet that would be taken
/// without a pattern.
fn partly(i: usize, path: &Path, photo: &DynamicImage, args: &CalibrateArgs) -> Partly {
    if let Some(corners) = args.corners.get(i) {
        return Partly::Given(*corners);
    }
    let detect = DetectConfig { encoding: args.gamma.gamma, ..DetectConfig::default() };
    detect_one(path, photo, None, args, None, &detect)
        .map_or(Partly::Nothing, |alone| Partly::Sheet(alone.observation))
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
