//! `slcal calibrate`: photographs of the sheet in, rig out.

use std::path::{Path, PathBuf};

use image::DynamicImage;
use slcal_core::detect::{DetectConfig, Detection, observe};
use slcal_core::format::write_rig;
use slcal_core::geometry::Camera;
use slcal_core::pattern::CheckerPattern;
use slcal_core::photo::PhotoView;
use slcal_core::{
    CalibrateConfig, Calibration, DistortionModel, Method, Observations, PrincipalPointRule, Rig,
    ViewObservation, calibrate_observations,
};

use crate::args::{CalibrateArgs, DistortionArg, MethodArg, PrincipalPointArg};
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{
    Destination, check_distinct, check_spares, input_name, is_dash, load_checker, load_photo, load_rig,
    png_bytes, write_all,
};
use crate::output::{Printer, print_json, print_result};
use crate::overlay::Overlay;
use crate::summary;

pub(super) fn run(args: &CalibrateArgs, printer: Printer) -> Outcome {
    let places = Places::prepare(args)?;
    let pattern = args.pattern.as_deref().map(load_checker).transpose()?;
    let config = config(args)?;
    let observations = observe_all(args, pattern.as_ref(), &config, &places, printer)?;
    let photos = args.photos.iter().map(|p| input_name(p)).collect::<Vec<_>>();
    let calibration =
        calibrate_observations(&observations, &config).in_file(Path::new(&photos.join(", ")))?;
    let calibration = with_names(calibration, photos);
    finish(args, &calibration, places, printer)
}

/// Where the rig and the overlay go.
struct Places {
    rig: Option<Destination>,
    overlay: Option<Destination>,
}

impl Places {
    fn prepare(args: &CalibrateArgs) -> Outcome<Self> {
        let prepare = |p: &PathBuf| Destination::prepare(p, args.force);
        let rig = args.output.as_ref().map(prepare).transpose()?;
        let overlay = args.overlay.as_ref().map(prepare).transpose()?;
        check_distinct(rig.iter().chain(&overlay))?;
        let inputs = args.photos.iter().chain(&args.screen).chain(&args.pattern).chain(&args.camera);
        check_spares(rig.iter().chain(&overlay), inputs.map(PathBuf::as_path))?;
        let stdin = args.photos.iter().chain(&args.screen).filter(|p| is_dash(p)).count();
        if stdin > 1 {
            return Err(Failure::usage("stdin (-) can be one photograph only; give the others as files"));
        }
        if args.json && rig == Some(Destination::Stdout) {
            return Err(Failure::usage("--json and -o - both print the rig; give one of them"));
        }
        for (option, count) in [("--screen", args.screen.len()), ("--corners", args.corners.len())] {
            if count != 0 && count != args.photos.len() {
                return Err(Failure::usage(format!(
                    "{option}: expected one for each of the {} photographs, in their order, or none; found {count}",
                    args.photos.len()
                )));
            }
        }
        Ok(Self { rig, overlay })
    }
}

fn config(args: &CalibrateArgs) -> Outcome<CalibrateConfig> {
    let rule = |pp| match pp {
        PrincipalPointArg::Shift => PrincipalPointRule::Shift,
        PrincipalPointArg::Prior => PrincipalPointRule::Prior,
        PrincipalPointArg::Centre => PrincipalPointRule::Centre,
        PrincipalPointArg::Free => PrincipalPointRule::Free,
        PrincipalPointArg::At(p) => PrincipalPointRule::Exact(p.x, p.y),
    };
    let config = CalibrateConfig {
        camera_pp: rule(args.camera_pp),
        projector_pp: rule(args.projector_pp),
        method: match args.method {
            MethodArg::Ml => Method::Ml,
            MethodArg::TwoVp => Method::TwoVp,
        },
        distortion: match args.distortion {
            DistortionArg::Auto => DistortionModel::Auto,
            DistortionArg::None => DistortionModel::None,
            DistortionArg::K1 => DistortionModel::K1,
            DistortionArg::K1k2 => DistortionModel::K1K2,
            DistortionArg::Full => DistortionModel::Full,
        },
        known_camera: args.camera.as_deref().map(|p| load_rig(p).map(|rig| rig.camera.model)).transpose()?,
        allow_degenerate: args.allow_degenerate,
        ..CalibrateConfig::default()
    };
    config.validate()?;
    Ok(config)
}

fn observe_all(
    args: &CalibrateArgs,
    pattern: Option<&CheckerPattern>,
    config: &CalibrateConfig,
    places: &Places,
    printer: Printer,
) -> Outcome<Observations> {
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
    Ok(Observations { camera: size.unwrap_or_default(), projector: pattern.map(|p| p.projector), views })
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
    observe(view, screen, args.size, pattern, config).in_file(path)
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

fn with_names(mut calibration: Calibration, photos: Vec<String>) -> Calibration {
    for (view, photo) in calibration.rig.views.iter_mut().zip(photos) {
        view.photo = Some(photo);
    }
    calibration
}

fn finish(args: &CalibrateArgs, calibration: &Calibration, places: Places, printer: Printer) -> Outcome {
    let bytes = rig_bytes(&calibration.rig)?;
    let to_stdout = places.rig == Some(Destination::Stdout);
    if let Some(place) = places.rig {
        write_all(&[(place, bytes.clone())])?;
    }
    if args.json {
        let rig: serde_json::Value = serde_json::from_slice(&bytes)
            .map_err(|e| Failure::new(Exit::Other, format!("the rig is not valid JSON: {e}")))?;
        return print_json(&rig);
    }
    let text = summary::calibration(&calibration.rig, &calibration.report);
    if to_stdout {
        printer.note(text.trim_end());
        return Ok(());
    }
    print_result(&text)
}

/// The rig file.
pub(super) fn rig_bytes(rig: &Rig) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    write_rig(rig, &mut bytes)?;
    Ok(bytes)
}
