//! `slcal calibrate`: from photographs of the sheet, or from observations, to a rig.

mod overlay;
mod photographs;
mod sequences;

use std::path::PathBuf;

use slcal_core::format::{write_observations, write_rig};
use slcal_core::{
    CalibrateConfig, Calibration, Method, NoiseFound, Observations, SequencePattern, ViewResiduals,
    calibrate_observations, residuals,
};

use self::overlay::Gallery;
use self::photographs::observe_all;
use crate::args::CalibrateArgs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{
    Destination, bytes_of, check_distinct, check_one_stdin, check_spares, input_name, is_dash, load_camera,
    load_observations, write_all,
};
use crate::output::{Printer, print_json};
use crate::report::{CommandLine, Photo, RigPage, rig_html};
use crate::summary;

/// `sequence` is what --pattern names, where that is one.
pub(super) fn run(
    args: &CalibrateArgs,
    sequence: Option<&SequencePattern>,
    typed: &CommandLine,
    printer: Printer,
) -> Outcome {
    let places = Places::prepare(args)?;
    let pictured = places.overlay.is_some() || places.report.is_some();
    let mut gallery = pictured.then(|| Gallery::new(args.photos.len()));
    let mut files = Vec::new();
    let done = calibrate(args, sequence, &places, gallery.as_mut(), &mut files, printer);
    let misses = match &done {
        Ok(c) if pictured => residuals(&c.rig, &c.observations).map_err(|e| e.to_string()),
        _ => Ok(Vec::new()),
    };
    let drawn = match (places.overlay.as_ref(), &gallery) {
        (Some(place), Some(gallery)) => {
            let shown = done.as_ref().ok();
            let picture = gallery.picture(shown, misses.as_deref().unwrap_or_default(), done.as_ref().err());
            picture.map(|bytes| bytes.map(|bytes| (place.clone(), bytes)))
        }
        _ => Ok(None),
    };
    let calibration = match done {
        Ok(calibration) => calibration,
        // What was found is most useful now. The failure of the calibration matters more than that of its picture.
        Err(failure) => {
            files.extend(drawn.ok().flatten());
            let _ = write_all(&files);
            return Err(failure);
        }
    };
    files.extend(drawn?);
    if let Some((place, gallery)) = places.report.as_ref().zip(gallery) {
        files.push((place.clone(), report(args, sequence, &calibration, misses, &gallery, typed)?));
    }
    finish(args, &calibration, places, files, printer)
}

/// The report on a calibration.
fn report(
    args: &CalibrateArgs,
    sequence: Option<&SequencePattern>,
    Calibration { rig, observations, .. }: &Calibration,
    residuals: Result<Vec<ViewResiduals>, String>,
    gallery: &Gallery,
    typed: &CommandLine,
) -> Outcome<Vec<u8>> {
    let count = rig.views.len();
    let mut photos = gallery.photos().map(|p| Photo::new(p, count).map(Some)).collect::<Outcome<Vec<_>>>()?;
    // Observations come without photographs.
    photos.resize_with(count, || None);
    let file = args.output.as_deref().filter(|p| !is_dash(p));
    let page = RigPage {
        rig,
        rig_name: file.map(input_name).unwrap_or_default(),
        checker_name: args.pattern.as_deref().filter(|_| sequence.is_none()).map(input_name),
        photos,
        observations: Some(observations),
        residuals,
        cloud: None,
        made_by: vec![typed.typed()],
    };
    Ok(rig_html(&page))
}

/// The calibration; the observations join the files to write.
fn calibrate(
    args: &CalibrateArgs,
    sequence: Option<&SequencePattern>,
    places: &Places,
    mut gallery: Option<&mut Gallery>,
    files: &mut Vec<(Destination, Vec<u8>)>,
    printer: Printer,
) -> Outcome<Calibration> {
    let inputs = args.observations.iter().chain(&args.photos).map(|p| input_name(p)).collect::<Vec<_>>();
    let inputs = PathBuf::from(inputs.join(", "));
    let mut config = config(args)?;
    let known = match args.camera.as_deref() {
        Some(path) => Some((path, load_camera(path)?)),
        None => None,
    };
    let mut from_photographs = None;
    let observations = if let Some(path) = &args.observations {
        let given = load_observations(path)?;
        if let Some((path, known)) = &known {
            config.known_camera = Some(known.for_image(given.camera).in_file(path)?);
        }
        given
    } else {
        let known = known.as_ref().map(|(path, camera)| (*path, camera));
        let mut calibrator =
            observe_all(args, sequence, config.clone(), known, gallery.as_deref_mut(), printer)?;
        calibrator.settle_orientation().in_file(&inputs)?;
        if let Some(gallery) = gallery {
            gallery.turn(&calibrator);
        }
        from_photographs.insert(calibrator).observations()?
    };
    if let Some((path, camera)) = &known {
        let unsized_note = camera.size.is_none().then(|| {
            "the file does not state an image size; the size of the photographs is assumed".to_owned()
        });
        for note in camera.notes.iter().chain(&unsized_note) {
            printer.note(format!("{}: {note}", input_name(path)));
        }
    }
    if let Some(place) = &places.observations {
        files.push((place.clone(), bytes_of(|out| write_observations(&observations, out))?));
    }
    let busy = printer.busy("calibrating");
    let done = match &from_photographs {
        Some(calibrator) => calibrator.calibrate(),
        None => calibrate_observations(&observations, &config),
    };
    let done = done.in_file(&inputs)?;
    drop(busy);
    for noise in done.noise() {
        printer.note(noise_in_words(noise));
    }
    let count = |o: &Observations| o.views.iter().map(|v| v.pairs.len()).sum::<usize>();
    let (used, all) = (count(&done.observations), count(&observations));
    if used < all {
        printer.note(format!(
            "{used} of {all} pairs are used, evenly spread; more would not improve the result"
        ));
    }
    Ok(done)
}

fn noise_in_words(noise: &NoiseFound) -> String {
    let name = noise.name();
    match noise.redundancy {
        Some(_) => format!("noise of {name}: not stated, {:.3} px (1σ) by the residuals", noise.sigma_px),
        None => format!("noise of {name}: not stated, {:.2} px (1σ) assumed", noise.sigma_px),
    }
}

/// Where the results go.
struct Places {
    rig: Option<Destination>,
    overlay: Option<Destination>,
    report: Option<Destination>,
    observations: Option<Destination>,
}

impl Places {
    fn prepare(args: &CalibrateArgs) -> Outcome<Self> {
        let prepare = |p: &PathBuf| Destination::prepare(p, args.force);
        let rig = args.output.as_ref().map(prepare).transpose()?;
        let overlay = Destination::prepare_overlay(args.overlay.as_ref(), args.force)?;
        let report = Destination::prepare_report(args.report.as_ref(), args.force)?;
        let observations = args.save_observations.as_ref().map(prepare).transpose()?;
        let all = || rig.iter().chain(&overlay).chain(&report).chain(&observations);
        check_distinct(all())?;
        let inputs = args.photos.iter().chain(&args.plain).chain(&args.pattern).chain(&args.camera);
        check_spares(all(), inputs.chain(&args.observations).map(PathBuf::as_path))?;
        check_one_stdin(args.photos.iter().chain(&args.plain).chain(&args.observations).chain(&args.camera))?;
        let printed = all().filter(|d| **d == Destination::Stdout).count() + usize::from(args.json);
        if printed > 1 && rig != Some(Destination::Stdout) {
            return Err(Failure::usage("only one result can go to stdout; write the others to files"));
        }
        if args.json && rig == Some(Destination::Stdout) {
            return Err(Failure::usage("--json and -o - both print the rig; use one of them"));
        }
        for (option, count) in [("--plain", args.plain.len()), ("--corners", args.corners.len())] {
            if count != 0 && count != args.photos.len() {
                return Err(Failure::usage(format!(
                    "{option}: expected one for each of the {} photographs, in the same order, or none; found {count}",
                    args.photos.len()
                )));
            }
        }
        Ok(Self { rig, overlay, report, observations })
    }
}

fn config(args: &CalibrateArgs) -> Outcome<CalibrateConfig> {
    if args.exif && args.method == Method::TwoVp {
        return Err(Failure::usage(
            "--exif: expected --method ml, because two-vp computes the focal length from the vanishing points alone",
        ));
    }
    let config = CalibrateConfig {
        camera_pp: args.camera_pp,
        projector_pp: args.projector_pp,
        method: args.method,
        distortion: args.distortion,
        projector_distortion: args.projector_distortion,
        projector_pixel_aspect: args.projector_pixel_aspect,
        flatness: args.flatness,
        allow_degenerate: args.allow_degenerate,
        ..CalibrateConfig::default()
    };
    if args.observations.is_none() {
        config.validate_for(args.photos.len(), args.pattern.is_some())?;
    }
    config.validate()?;
    Ok(config)
}

/// Writes the rig and what belongs to it, all or nothing, and prints the summary.
fn finish(
    args: &CalibrateArgs,
    calibration: &Calibration,
    places: Places,
    mut files: Vec<(Destination, Vec<u8>)>,
    printer: Printer,
) -> Outcome {
    let bytes = bytes_of(|out| write_rig(&calibration.rig, out))?;
    let to_stdout = places.rig == Some(Destination::Stdout);
    files.extend(places.rig.map(|place| (place, bytes.clone())));
    write_all(&files)?;
    if args.json {
        let rig: serde_json::Value = serde_json::from_slice(&bytes)
            .map_err(|e| Failure::new(Exit::Other, format!("the rig is not valid JSON: {e}")))?;
        return print_json(&rig);
    }
    printer.summary(&summary::calibration(&calibration.rig, calibration.report()), to_stdout)
}
