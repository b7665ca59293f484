//! `slcal reconstruct`: photographs of an object under the stripes in, clouds out.

use std::fs;
use std::path::{Path, PathBuf};

use image::DynamicImage;
use serde::Serialize;
use slcal_core::decode::DecodeReport;
use slcal_core::reconstruct::{
    CullReport, CullRule, ReconstructConfig, Reconstruction, Reconstructor, TriangulateReport,
};
use slcal_core::{Frame, PointCloud, Rig};

use super::decode::Frames;
use crate::args::{CullArg, FrameArg, ReconstructArgs};
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{
    CloudFormat, Destination, check_distinct, check_panel, check_spares, input_name, is_dash, load_photo,
    load_rig, load_stripes, png_bytes, write_all,
};
use crate::output::{Printer, print_json, print_result};
use crate::overlay::Overlay;
use crate::summary;

pub(super) fn run(args: &ReconstructArgs, printer: Printer) -> Outcome {
    let format = args.output.as_deref().map_or(Ok(CloudFormat::Ply), CloudFormat::of)?;
    let outputs = outputs(args)?;
    let overlay = args.overlay.as_ref().map(|p| Destination::prepare(p, args.force)).transpose()?;
    check_distinct(outputs.iter().chain(&overlay))?;
    let photos = args.images.iter().map(PathBuf::as_path);
    check_spares(
        outputs.iter().chain(&overlay),
        photos.chain(args.input.files()).chain([args.rig.as_path()]),
    )?;
    let rig = load_rig(&args.rig)?;
    let pattern = load_stripes(&args.input.pattern)?;
    check_panel(&args.input.pattern, pattern.projector, &args.rig, &rig)?;
    let frames = Frames::load(&args.input, printer)?;
    let config = ReconstructConfig {
        decode: frames.config(),
        cull: cull_rule(args.cull),
        frame: frame(args.shape.frame, &rig, &args.rig)?,
        mesh: args.shape.mesh,
        ..ReconstructConfig::default()
    };
    let mut scanner = Reconstructor::new(&rig, &pattern, config).in_file(&args.rig)?;

    let mut reports = Vec::new();
    for (path, output) in args.images.iter().zip(&outputs) {
        let photo = load_photo(path, printer)?;
        let result = scanner.reconstruct_frames(&frames.input(path, &photo)?).in_file(path)?;
        let mut files = vec![(output.clone(), format.bytes(&result.cloud)?)];
        if let Some(place) = &overlay {
            files.push((place.clone(), draw(&photo, &result.cloud)?));
        }
        write_all(&files)?;
        if !args.json {
            report(path, output, result, args.images.len() > 1, printer)?;
        }
        reports.push(Report::of(path, output, result));
    }
    if args.json {
        return print_json(&Reports { schema: "slcal-reconstruct/1", clouds: reports });
    }
    Ok(())
}

/// One output per photograph.
fn outputs(args: &ReconstructArgs) -> Outcome<Vec<Destination>> {
    if args.images.iter().filter(|p| is_dash(p)).count() > 1 {
        return Err(Failure::usage("stdin (-) can be one photograph only; give the others as files"));
    }
    if let Some(output) = &args.output {
        let place = Destination::prepare(output, args.force)?;
        if args.images.len() > 1 {
            return Err(Failure::usage(format!(
                "-o takes the cloud of one photograph, found {}; give --out-dir DIR",
                args.images.len()
            )));
        }
        if args.json && place == Destination::Stdout {
            return Err(Failure::usage("--json and -o - both print to stdout; give one of them"));
        }
        return Ok(vec![place]);
    }
    let folder = args.out_dir.as_ref().ok_or_else(|| Failure::usage("expected -o FILE or --out-dir DIR"))?;
    if args.overlay.is_some() && args.images.len() > 1 {
        return Err(Failure::usage("--overlay takes one photograph; run the others without it"));
    }
    make_folder(folder)?;
    args.images
        .iter()
        .map(|image| {
            let name = if is_dash(image) {
                "stdin".as_ref()
            } else {
                image.file_stem().unwrap_or(image.as_os_str())
            };
            Destination::prepare(&folder.join(name).with_extension("ply"), args.force)
        })
        .collect()
}

/// Makes an output folder when it does not exist; its parent must.
pub(super) fn make_folder(folder: &Path) -> Outcome {
    if folder.is_dir() {
        return Ok(());
    }
    fs::create_dir(folder).map_err(|e| {
        Failure::new(
            Exit::Other,
            format!("{}: expected a folder for the outputs, but it cannot be made: {e}", folder.display()),
        )
    })
}

/// Refuses a rig without a projector.
pub(super) fn with_projector(rig: &Rig, path: &Path) -> Outcome {
    match rig.projector {
        Some(p) => check_panel(path, [p.model.width, p.model.height], path, rig),
        None => check_panel(path, [0, 0], path, rig),
    }
}

pub(super) fn cull_rule(arg: CullArg) -> CullRule {
    match arg {
        CullArg::Auto => CullRule::Auto,
        CullArg::Off => CullRule::Off,
        CullArg::Area(area) => CullRule::MaxAreaMm2(area),
    }
}

/// The frame of the clouds; that of the sheet needs a rig that has seen one.
pub(super) fn frame(arg: FrameArg, rig: &Rig, path: &Path) -> Outcome<Frame> {
    match arg {
        FrameArg::Camera => Ok(Frame::Camera),
        FrameArg::Plane if rig.views.is_empty() => Err(Failure::new(
            Exit::Input,
            format!(
                "{}: expected a rig with a view of the sheet for --frame plane, found none",
                input_name(path)
            ),
        )),
        FrameArg::Plane => Ok(Frame::Plane),
    }
}

/// The points that were kept, drawn on the photograph, as PNG.
pub(super) fn draw(photo: &DynamicImage, cloud: &PointCloud) -> Outcome<Vec<u8>> {
    let mut overlay = Overlay::new(photo);
    overlay.draw_stripes(cloud.points.iter().map(|p| (p.pixel, Some(p.slit))));
    png_bytes(&overlay.into_picture())
}

fn report(
    path: &Path,
    output: &Destination,
    result: &Reconstruction,
    many: bool,
    printer: Printer,
) -> Outcome {
    let mut text = if many { format!("{} -> {}\n", input_name(path), output.name()) } else { String::new() };
    if let Some(decode) = &result.decode {
        text += &summary::decoding(decode);
    }
    text += &summary::cloud(result);
    if *output == Destination::Stdout {
        printer.note(text.trim_end());
        return Ok(());
    }
    print_result(&text)
}

/// What reconstruction reports as JSON.
#[derive(Serialize)]
struct Reports {
    schema: &'static str,
    clouds: Vec<Report>,
}

#[derive(Serialize)]
struct Report {
    image: PathBuf,
    output: String,
    points: usize,
    triangles: usize,
    decode: Option<DecodeReport>,
    triangulate: TriangulateReport,
    cull: CullReport,
}

impl Report {
    fn of(path: &Path, output: &Destination, result: &Reconstruction) -> Self {
        Self {
            image: path.to_owned(),
            output: output.name(),
            points: result.cloud.points.len(),
            triangles: result.cloud.triangles.len(),
            decode: result.decode.clone(),
            triangulate: result.triangulate,
            cull: result.cull,
        }
    }
}
