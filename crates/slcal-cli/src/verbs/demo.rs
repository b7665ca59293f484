//! `slcal demo`: the whole chain on built-in photographs, explained for first-time users.

use image::DynamicImage;
use slcal_core::detect::Detection;
use slcal_core::evaluate::{FitConfig, FitReport, fit_plane};
use slcal_core::format::{read_rig, write_pattern, write_ply, write_rig};
use slcal_core::geometry::RectangleSize;
use slcal_core::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};
use slcal_core::photo::PhotoView;
use slcal_core::{
    Calibration, Calibrator, Device, ReconstructConfig, Reconstruction, Reconstructor, Rig, SheetPhoto,
    ViewResiduals, residuals,
};

use super::reconstruct::draw;
use crate::args::DemoArgs;
use crate::exit::{Exit, Failure, Outcome};
use crate::io::{Destination, bytes_of, decode_photo, make_folder, png_bytes, write_all};
use crate::output::{BOLD, Printer, Table, TextLayout, print_result, sanitized, styled, unbroken};
use crate::picture::residual_drawing::{self, MeasuredView};
use crate::picture::sheet;
use crate::report::{Photo, RigPage, ShownCloud, rig_html};
use crate::summary;

/// The photographs; `demo/README.md` says where they come from.
const SHEET: &[u8] = include_bytes!("../../demo/sheet.jpg");
const BOARD: &[u8] = include_bytes!("../../demo/board.jpg");
const HEAD: &[u8] = include_bytes!("../../demo/head.jpg");
/// The rig that took them, known exactly since they are rendered.
const TRUTH: &[u8] = include_bytes!("../../demo/truth_rig.json");

/// Commands to run in the folder; each fits on a line.
const BY_HAND: [&str; 2] = [
    "slcal calibrate sheet.jpg --size 594x420mm --pattern checker.json -o my.json",
    "slcal reconstruct --rig my.json --pattern stripes.json head.jpg -o my.ply",
];

/// The same with many photographs, which are rendered, too.
const MANY_SHOTS: [&str; 3] = [
    "slcal pattern phase --projector 1024x768 --out-dir phase",
    "slcal simulate scene --surface sphere --pattern phase/sequence.json --out scan",
    "slcal reconstruct --rig scan/rig.json --pattern phase/sequence.json scan \\\n      -o scan.ply",
];

const PANEL: [u32; 2] = [1024, 768];
/// The sheet in the first photograph, mm: A2 on its side.
const SHEET_SIZE_MM: [f64; 2] = [594.0, 420.0];

/// Files of the demonstration, in the order in which the work makes them.
const NAMES: [&str; 13] = [
    "checker.png",
    "checker.json",
    "stripes.png",
    "stripes.json",
    "sheet.jpg",
    "board.jpg",
    "head.jpg",
    "rig.json",
    "sheet_found.png",
    "board.ply",
    "cloud.ply",
    "head_found.png",
    "report.html",
];

pub(super) fn run(args: &DemoArgs, printer: Printer) -> Outcome {
    make_folder(&args.out)?;
    let places = NAMES
        .iter()
        .map(|name| Destination::prepare(&args.out.join(name), args.force))
        .collect::<Outcome<Vec<_>>>()?;

    let checker = CheckerPattern::new(PANEL, &CheckerConfig::default())?;
    let stripes = StripePattern::new(PANEL, &StripeConfig::default())?;
    let busy = printer.busy("calibrating from the photograph of the sheet");
    let sheet_photo = decode_photo(SHEET, "sheet.jpg")?.photo;
    let (detection, calibration) = calibrate(&sheet_photo, &checker)?;
    let rig = &calibration.rig;
    busy.say("reconstructing a board and a head from one photograph each");
    let (board_photo, head_photo) =
        (decode_photo(BOARD, "board.jpg")?.photo, decode_photo(HEAD, "head.jpg")?.photo);
    let board = cloud(rig, &stripes, &board_photo)?;
    let head = cloud(rig, &stripes, &head_photo)?;
    let flatness = fit_plane(&board.cloud, &FitConfig::default())?.report;

    let misses = residuals(rig, &calibration.observations)?;
    let seen = draw_sheet(&sheet_photo, &detection, rig, &misses)?;
    let contents = [
        png_bytes(&DynamicImage::ImageRgb8(checker.image()?))?,
        bytes_of(|out| write_pattern(&Pattern::Checker(checker), out))?,
        png_bytes(&DynamicImage::ImageRgb8(stripes.image()?))?,
        bytes_of(|out| write_pattern(&Pattern::Stripes(stripes), out))?,
        SHEET.to_vec(),
        BOARD.to_vec(),
        HEAD.to_vec(),
        bytes_of(|out| write_rig(rig, out))?,
        png_bytes(&seen)?,
        bytes_of(|out| write_ply(&board.cloud, out))?,
        bytes_of(|out| write_ply(&head.cloud, out))?,
        draw(&head_photo, "head.jpg", &head)?,
        report(&sheet_photo, &calibration, misses, &head)?,
    ];
    write_all(&places.into_iter().zip(contents).collect::<Vec<_>>())?;
    drop(busy);
    print_result(&story(args, &calibration, &detection, &flatness, &head)?)
}

fn calibrate(sheet: &DynamicImage, checker: &CheckerPattern) -> Outcome<(Detection, Calibration)> {
    let size = RectangleSize::new(SHEET_SIZE_MM[0], SHEET_SIZE_MM[1])?;
    let mut calibrator = Calibrator::new(size.into()).with_pattern(checker);
    let photo = SheetPhoto::new(PhotoView::try_from(sheet)?).name("sheet.jpg");
    let detection = calibrator.add(photo)?.clone();
    Ok((detection, calibrator.calibrate()?))
}

/// What was found on the sheet and how well it fits.
fn draw_sheet(
    photo: &DynamicImage,
    found: &Detection,
    rig: &Rig,
    misses: &[ViewResiduals],
) -> Outcome<DynamicImage> {
    let size = [photo.width(), photo.height()];
    let drawing = match (rig.views.first(), misses.first()) {
        (Some(view), Some(residuals)) => {
            let fit =
                MeasuredView { observed: &found.observation, residuals, view, camera: &rig.camera.model };
            residual_drawing::drawing(size, "sheet.jpg", &format!("sheet.jpg: {}", fit.in_words()), fit)
        }
        _ => sheet::found(size, "sheet.jpg", found),
    };
    drawing.over(photo)
}

/// The report on the calibration, with the head.
fn report(
    photo: &DynamicImage,
    Calibration { rig, observations, .. }: &Calibration,
    residuals: Vec<ViewResiduals>,
    head: &Reconstruction,
) -> Outcome<Vec<u8>> {
    let page = RigPage {
        rig,
        rig_name: "rig.json".to_owned(),
        checker_name: Some("checker.json".to_owned()),
        photos: vec![Some(Photo::new(photo, 1)?)],
        observations: Some(observations),
        residuals: Ok(residuals),
        cloud: Some(ShownCloud { name: "cloud.ply".to_owned(), cloud: &head.cloud }),
        made_by: BY_HAND.map(str::to_owned).to_vec(),
    };
    Ok(rig_html(&page))
}

fn cloud(rig: &Rig, stripes: &StripePattern, photo: &DynamicImage) -> Outcome<Reconstruction> {
    let config = ReconstructConfig { mesh: true, ..ReconstructConfig::default() };
    let mut reconstructor = Reconstructor::new(rig, stripes, config)?;
    reconstructor.reconstruct(PhotoView::try_from(photo)?)?;
    Ok(reconstructor.take_last())
}

/// The steps, their errors against the truth, and the files.
fn story(
    args: &DemoArgs,
    calibration: &Calibration,
    detection: &Detection,
    flatness: &FitReport,
    head: &Reconstruction,
) -> Outcome<String> {
    let rig = &calibration.rig;
    let mut layout = TextLayout::new();
    layout.paragraph(format!(
        "A projector and a camera see a sheet of paper of {} x {} mm, then a board and a head. The photographs are rendered, so \
         their true parameters are known.",
        SHEET_SIZE_MM[0], SHEET_SIZE_MM[1]
    ));
    layout.gap();
    layout.paragraph(styled(BOLD, &unbroken("1. Calibration from one photograph, sheet.jpg")));
    layout.paragraph(format!(
        "The sheet's four edges and {} of {} corners of the projected checkerboard were measured (see sheet_found.png).",
        detection.observation.pairs.len(),
        detection.pattern_corners
    ));
    layout.gap();
    layout.table(&against_truth(rig)?);
    layout.gap();
    layout.paragraph(format!(
        "Verdict: {}. ± is one standard deviation. It is far larger than the error here, because one photograph does not determine \
         where the lens's axis meets the sensor (the principal point). In these photographs it is exactly the centre, which slcal \
         takes as its starting value; with a real camera it is not.",
        rig.quality.as_ref().map_or("none".to_owned(), |q| summary::verdict(q.verdict))
    ));
    layout.gap();
    layout.paragraph(styled(
        BOLD,
        &unbroken("2. Reconstruction from one photograph each, with the rig just found"),
    ));
    layout.line(
        "board.jpg",
        format!(
            "{} points; mean distance from a fitted plane {:.3} mm, {:.4} % of the distance from the camera",
            flatness.points, flatness.mean_mm, flatness.mean_percent
        ),
    );
    layout.line(
        "head.jpg",
        format!(
            "{} points, {} triangles (head_found.png shows where the stripes were found)",
            head.cloud.points.len(),
            head.cloud.triangles.len()
        ),
    );
    layout.gap();
    layout.paragraph(format!(
        "{} {}:",
        styled(BOLD, "In"),
        unbroken(&sanitized(&args.out.display().to_string()))
    ));
    layout.table(&files());
    layout.paragraph("MeshLab, CloudCompare and Blender show the .ply files.");
    layout.gap();
    layout.paragraph(styled(BOLD, &unbroken("To run the same steps yourself, in that folder")));
    for command in BY_HAND {
        layout.paragraph(unbroken(&format!("  {command}")));
    }
    layout.gap();
    layout.paragraph(styled(BOLD, &unbroken("With many photographs: a point per pixel")));
    layout.paragraph(
        "One photograph under stripes measures what moves. What stands still can be photographed under a sequence of pictures, Gray \
         code and a sinusoid that is shifted: every pixel becomes a point, whatever the object's colour. In that folder, with a \
         simulated sphere:",
    );
    for command in MANY_SHOTS {
        layout.paragraph(unbroken(&format!("  {command}")));
    }
    Ok(layout.into_text())
}

/// Found and true parameters.
fn against_truth(rig: &Rig) -> Outcome<Table> {
    let truth = read_rig(TRUTH)?;
    let mut table = Table::new(["", ">found", ">true", ">error"]);
    let mut row = |label: &str, (found, sigma): (f64, Option<f64>), truth: f64| {
        let with_sigma = sigma.map_or(format!("{found:.1}"), |s| format!("{found:.1} ± {s:.1}"));
        table.row([label.to_owned(), with_sigma, format!("{truth:.1}"), format!("{:.2}", found - truth)]);
    };
    let both = |rig: &Rig| rig.projector.map(|p| (rig.camera, p.device));
    let ((camera, projector), (true_camera, true_projector)) = both(rig)
        .zip(both(&truth))
        .ok_or_else(|| Failure::new(Exit::Other, "the built-in photographs gave no projector"))?;
    row("camera: focal length, px", focal(&camera), focal(&true_camera).0);
    row("projector: focal length, px", focal(&projector), focal(&true_projector).0);
    let shift = |d: &Device| (d.model.intrinsics.cy, d.sigma.map(|s| s.cy_px));
    row("projector: principal point, y, px", shift(&projector), shift(&true_projector).0);
    if let Some((found, true_value)) = rig.baseline_mm().zip(truth.baseline_mm()) {
        row("baseline, mm", (found, rig.baseline_sigma_mm()), true_value);
    }
    Ok(table)
}

fn files() -> Table {
    let mut table = Table::new(["", ""]);
    for row in [
        ["  report.html", "open it in a browser: verdict and next step"],
        ["  checker.png, checker.json", "the pattern for calibration"],
        ["  stripes.png, stripes.json", "the pattern for reconstruction"],
        ["  sheet.jpg, board.jpg, head.jpg", "the photographs"],
        ["  rig.json", "the calibrated camera and projector"],
        ["  board.ply, cloud.ply", "point clouds of the board and the head"],
        ["  sheet_found.png, head_found.png", "the measured points in the photographs"],
    ] {
        table.row(row);
    }
    table
}

fn focal(device: &Device) -> (f64, Option<f64>) {
    (device.model.intrinsics.fx, device.sigma.map(|s| s.focal_px))
}
