//! `slcal report`: a rig, and a cloud reconstructed with it, as one HTML file.

use std::fs;
use std::path::{Path, PathBuf};

use image::DynamicImage;
use slcal_core::detect::{DetectConfig, observe};
use slcal_core::photo::PhotoView;
use slcal_core::{Observations, Rig, ViewResiduals, residuals};

use crate::args::ReportArgs;
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{
    Destination, check_image_size, check_one_stdin, check_panel, check_spares, input_name, is_dash,
    load_checker, load_cloud, load_observations, load_photo, load_rig, write_all,
};
use crate::output::Printer;
use crate::picture::for_display;
use crate::report::{CommandLine, Photo as Shown, RigPage, ShownCloud, rig_html};

pub(super) fn run(args: &ReportArgs, typed: &CommandLine, printer: Printer) -> Outcome {
    let place = Destination::prepare(&args.output, args.force)?;
    let inputs = || {
        args.photo.iter().chain(&args.observations).chain(&args.pattern).chain(&args.cloud).chain([&args.rig])
    };
    check_spares([&place], inputs().map(PathBuf::as_path))?;
    check_one_stdin(inputs())?;
    let rig = load_rig(&args.rig)?;
    let photos = photos(args, &rig, printer)?;
    // Photographs that were found by their names count, too.
    check_spares([&place], photos.iter().flatten().map(|p| p.path.as_path()))?;
    let (observations, residuals) = match seen(args, &rig, &photos, printer)? {
        Ok((seen, residuals)) => (Some(seen), residuals),
        Err(why) => (None, Err(why)),
    };
    let cloud = args.cloud.as_deref().map(load_cloud).transpose()?;
    let count = photos.len();
    let gamma = args.gamma.encoding();
    // Frees the photograph, which may be large.
    let shown =
        |photo: Option<Photo>| photo.map(|p| Shown::new(&for_display(p.picture, gamma), count)).transpose();
    let page = RigPage {
        rig: &rig,
        rig_name: input_name(&args.rig),
        photos: photos.into_iter().map(shown).collect::<Outcome<_>>()?,
        observations: observations.as_ref(),
        residuals,
        checker_name: args.pattern.as_deref().map(input_name),
        cloud: args
            .cloud
            .as_deref()
            .zip(cloud.as_ref())
            .map(|(path, cloud)| ShownCloud { name: input_name(path), cloud }),
        made_by: vec![typed.typed()],
    };
    write_all(&[(place, rig_html(&page))])
}

/// A photograph and where it came from.
struct Photo {
    path: PathBuf,
    picture: DynamicImage,
}

/// The photographs of the views, as far as they are found.
fn photos(args: &ReportArgs, rig: &Rig, printer: Printer) -> Outcome<Vec<Option<Photo>>> {
    let views = rig.views.len();
    if !args.photo.is_empty() && args.photo.len() != views {
        return Err(Failure::usage(format!(
            "--photo: expected one for each of the {views} views of {}, in the same order, or none; found {}",
            input_name(&args.rig),
            args.photo.len()
        )));
    }
    let mut photos = Vec::new();
    for (i, view) in rig.views.iter().enumerate() {
        let given = args.photo.get(i);
        let found = match (given, view.photo.as_deref()) {
            (Some(path), _) => Ok(path.clone()),
            (None, Some(name)) => at_hand(&args.rig, name, args.allow_paths),
            (None, None) => Err(NOT_FOUND),
        };
        let path = match found {
            Ok(path) => path,
            Err(why) => {
                let name = view.photo.as_deref().unwrap_or("without a name");
                printer.note(format!("photograph {name}: {why}"));
                photos.push(None);
                continue;
            }
        };
        let loaded = load_photo(&path, args.gamma.samples(), printer)
            .and_then(|picture| check_image_size(&path, &picture, &args.rig, rig).map(|()| picture));
        match loaded {
            Ok(picture) => {
                if given.is_none() {
                    printer.note(format!("{}: shown", input_name(&path)));
                }
                photos.push(Some(Photo { path, picture }));
            }
            // A file that was found by its name may be another picture.
            Err(failure) if given.is_none() => {
                printer.note(format!("{failure}; it is not shown"));
                photos.push(None);
            }
            Err(failure) => return Err(failure),
        }
    }
    Ok(photos)
}

const NOT_FOUND: &str = "not found, so it is not shown; name its file with --photo";
const ELSEWHERE: &str = "the rig names a place outside of its own folder, which is not read, so it is not shown; name its file with --photo, or \
                         trust the rig with --allow-paths";

/// The path of a photograph by its name, or why there is none: beside the rig; anywhere that the name leads to if that is allowed.
/// A rig may come from a stranger, and a report is made to be passed on: it must not carry what only its reader could see.
fn at_hand(rig: &Path, name: &str, anywhere: bool) -> Result<PathBuf, &'static str> {
    let name = Path::new(name);
    let folder = rig.parent().filter(|_| !is_dash(rig));
    let file = name.file_name().map(Path::new);
    let beside: Vec<PathBuf> = folder
        .into_iter()
        .flat_map(|f| [Some(name), file].into_iter().flatten().map(move |n| f.join(n)))
        .collect();
    let elsewhere = [Some(name), file].into_iter().flatten().map(Path::to_owned);
    if anywhere {
        return beside.into_iter().chain(elsewhere).find(|p| p.is_file()).ok_or(NOT_FOUND);
    }
    let here = beside.iter().find(|p| p.is_file() && folder.is_some_and(|f| is_within(p, f)));
    let leads_out = || beside.iter().cloned().chain(elsewhere).any(|p| p.is_file());
    here.cloned().ok_or_else(|| if leads_out() { ELSEWHERE } else { NOT_FOUND })
}

/// Whether a file lies in a folder or below it, links resolved.
fn is_within(file: &Path, folder: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let resolved = fs::canonicalize(file).and_then(|file| Ok((file, fs::canonicalize(folder)?)));
    resolved.is_ok_and(|(file, folder)| file.starts_with(folder))
}

/// The residuals, or why they are unknown.
type Residuals = Result<Vec<ViewResiduals>, String>;

/// The observations, from a file or detected again in the photographs, with their residuals; or why there are none.
fn seen(
    args: &ReportArgs,
    rig: &Rig,
    photos: &[Option<Photo>],
    printer: Printer,
) -> Outcome<Result<(Observations, Residuals), String>> {
    if let Some(path) = &args.observations {
        let seen = load_observations(path)?;
        let residuals = residuals(rig, &seen).in_file(path)?;
        return Ok(Ok((seen, Ok(residuals))));
    }
    let pattern = args.pattern.as_deref().map(load_checker).transpose()?;
    if let Some((pattern, path)) = pattern.as_ref().zip(args.pattern.as_ref()) {
        check_panel(path, pattern.projector, &args.rig, rig)?;
    }
    if rig.projector.is_some() && pattern.is_none() {
        return Ok(Err("give the measurements (--observations) or the checkerboard (--pattern)".to_owned()));
    }
    if photos.is_empty() || photos.iter().any(Option::is_none) {
        return Ok(Err(
            "some photographs (--photo) and the measurements (--observations) are missing".to_owned()
        ));
    }
    let pattern = if rig.is_mirrored() { pattern.map(|p| p.mirrored()) } else { pattern };
    let detect = DetectConfig { encoding: args.gamma.encoding(), ..DetectConfig::default() };
    let mut views = Vec::new();
    for (photo, view) in photos.iter().flatten().zip(&rig.views) {
        let seen = PhotoView::try_from(&photo.picture).in_file(&photo.path)?;
        match observe(seen, None, view.size, pattern.as_ref(), &detect).in_file(&photo.path) {
            Ok(found) => views.push(found.observation),
            Err(failure) => {
                printer.note(format!("{failure}; residuals are not shown"));
                return Ok(Err(failure.to_string()));
            }
        }
    }
    let seen = Observations {
        camera: rig.camera.model.size(),
        projector: pattern.map(|p| p.projector),
        mirrored: rig.is_mirrored(),
        views,
    };
    // New detections may not match the views of the rig.
    let residuals = residuals(rig, &seen).map_err(|e| e.to_string());
    Ok(Ok((seen, residuals)))
}
