//! `slcal demo`: the whole chain on built-in photographs, explained to somebody who sees it for the first time.

use std::fmt::Write as _;

use image::DynamicImage;
use slcal_core::decode::DecodeInput;
use slcal_core::detect::{DetectConfig, Detection, observe};
use slcal_core::evaluate::{FitConfig, FitReport, fit_plane};
use slcal_core::format::{CloudFormat, read_rig};
use slcal_core::geometry::RectangleSize;
use slcal_core::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};
use slcal_core::photo::PhotoView;
use slcal_core::reconstruct::{ReconstructConfig, Reconstruction, reconstruct};
use slcal_core::{CalibrateConfig, Calibration, Device, Observations, Rig, calibrate_observations};

use super::calibrate::rig_bytes;
use super::pattern::pattern_bytes;
use super::reconstruct::{draw, make_folder};
use crate::args::DemoArgs;
use crate::exit::{Exit, Failure, Outcome};
use crate::io::{Destination, cloud_bytes, decode_photo, png_bytes, write_all};
use crate::output::{Printer, print_result};
use crate::picture::sheet;

/// The photographs; `demo/README.md` says where they come from.
const SHEET: &[u8] = include_bytes!("../../demo/sheet.jpg");
const BOARD: &[u8] = include_bytes!("../../demo/board.jpg");
const HEAD: &[u8] = include_bytes!("../../demo/head.jpg");
/// The rig that took them, known exactly since they are rendered.
const TRUTH: &[u8] = include_bytes!("../../demo/truth_rig.json");

const PANEL: [u32; 2] = [1024, 768];
/// The sheet in the first photograph, mm: A2 on its side.
const SHEET_SIZE_MM: [f64; 2] = [594.0, 420.0];

/// Files of the demonstration, in the order in which the work makes them.
const NAMES: [&str; 12] = [
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
];

pub(super) fn run(args: &DemoArgs, printer: Printer) -> Outcome {
    make_folder(&args.out)?;
    let places = NAMES
        .iter()
        .map(|name| Destination::prepare(&args.out.join(name), args.force))
        .collect::<Outcome<Vec<_>>>()?;

    let checker = CheckerPattern::new(PANEL, &CheckerConfig::default())?;
    let stripes = StripePattern::new(PANEL, &StripeConfig::default())?;
    printer.note("calibrating from the photograph of the sheet ...");
    let sheet_photo = decode_photo(SHEET, "sheet.jpg")?.0;
    let (detection, calibration) = calibrate(&sheet_photo, &checker)?;
    let rig = &calibration.rig;
    printer.note("reconstructing a board and a head from one photograph each ...");
    let (board_photo, head_photo) = (decode_photo(BOARD, "board.jpg")?.0, decode_photo(HEAD, "head.jpg")?.0);
    let board = cloud(rig, &stripes, &board_photo)?;
    let head = cloud(rig, &stripes, &head_photo)?;
    let flatness = fit_plane(&board.cloud, &FitConfig::default())?.report;

    let seen = sheet::found([sheet_photo.width(), sheet_photo.height()], "sheet.jpg", &detection)
        .over(&sheet_photo)?;
    let contents = [
        png_bytes(&DynamicImage::ImageRgb8(checker.image()?))?,
        pattern_bytes(&Pattern::Checker(checker))?,
        png_bytes(&DynamicImage::ImageRgb8(stripes.image()?))?,
        pattern_bytes(&Pattern::Stripes(stripes))?,
        SHEET.to_vec(),
        BOARD.to_vec(),
        HEAD.to_vec(),
        rig_bytes(rig)?,
        png_bytes(&seen)?,
        cloud_bytes(CloudFormat::Ply, &board.cloud)?,
        cloud_bytes(CloudFormat::Ply, &head.cloud)?,
        draw(&head_photo, "head.jpg", &head)?,
    ];
    write_all(&places.into_iter().zip(contents).collect::<Vec<_>>())?;
    print_result(&summary(args, &calibration, &detection, &flatness, &head)?)
}

fn calibrate(sheet: &DynamicImage, checker: &CheckerPattern) -> Outcome<(Detection, Calibration)> {
    let size = RectangleSize::new(SHEET_SIZE_MM[0], SHEET_SIZE_MM[1])?;
    let detection =
        observe(PhotoView::try_from(sheet)?, None, size, Some(checker), &DetectConfig::default())?;
    let observations = Observations {
        camera: [sheet.width(), sheet.height()],
        projector: Some(PANEL),
        views: vec![detection.observation.clone()],
    };
    let mut calibration = calibrate_observations(&observations, &CalibrateConfig::default())?;
    if let Some(view) = calibration.rig.views.first_mut() {
        view.photo = Some("sheet.jpg".to_owned());
    }
    Ok((detection, calibration))
}

fn cloud(rig: &Rig, stripes: &StripePattern, photo: &DynamicImage) -> Outcome<Reconstruction> {
    let input = DecodeInput { photo: PhotoView::try_from(photo)?, black: None, white: None };
    let config = ReconstructConfig { mesh: true, ..ReconstructConfig::default() };
    Ok(reconstruct(rig, stripes, &input, &config)?)
}

/// What was done, how close it came to the truth, and what each file is.
fn summary(
    args: &DemoArgs,
    calibration: &Calibration,
    detection: &Detection,
    flatness: &FitReport,
    head: &Reconstruction,
) -> Outcome<String> {
    let rig = &calibration.rig;
    let truth = read_rig(TRUTH)?;
    let mut text = format!(
        "A projector and a camera look at a sheet of paper of {} x {} mm, then at a board and at a head.\n\
         The photographs are rendered, so that everything about them is known.\n\n\
         1. Calibration from one photograph, sheet.jpg: the sheet's four sides and {} of {} corners of the projected\n   \
         checkerboard were measured (drawn in sheet_found.png).\n\n",
        SHEET_SIZE_MM[0],
        SHEET_SIZE_MM[1],
        detection.observation.pairs.len(),
        detection.pattern_corners
    );
    // Writing into a string cannot fail.
    let _ = writeln!(text, "   {:<38}{:>20}{:>11}{:>11}", "", "found", "true", "off by");
    let both = |rig: &Rig| rig.projector.map(|p| (rig.camera, p));
    let ((camera, projector), (true_camera, true_projector)) = both(rig)
        .zip(both(&truth))
        .ok_or_else(|| Failure::new(Exit::Other, "the built-in photographs gave no projector"))?;
    row(&mut text, "camera: focal length, px", focal(&camera), focal(&true_camera).0);
    row(&mut text, "projector: focal length, px", focal(&projector), focal(&true_projector).0);
    let shift = |d: &Device| (d.model.intrinsics.cy, d.sigma.map(|s| s.cy_px));
    row(&mut text, "projector: principal point, row, px", shift(&projector), shift(&true_projector).0);
    if let Some((found, true_value)) = rig.baseline_mm().zip(truth.baseline_mm()) {
        row(&mut text, "camera to projector, mm", (found, rig.baseline_sigma_mm()), true_value);
    }
    let verdict = rig.quality.as_ref().map_or("none", |q| match q.verdict {
        slcal_core::Verdict::Good => "good",
        slcal_core::Verdict::Fair => "fair",
        slcal_core::Verdict::Weak => "weak",
        slcal_core::Verdict::Degenerate => "degenerate",
    });
    let _ = write!(
        text,
        "\n   Verdict: {verdict}. The ± is far larger than the error because one photograph cannot tell where the\n   \
         lens's axis meets the sensor; here it does so exactly in the middle, as slcal assumes until told otherwise.\n\n\
         2. Reconstruction from one photograph each, with the rig just found:\n   \
         board.jpg: {} points; a flat board comes out flat to {:.3} mm, {:.4} % of its distance.\n   \
         head.jpg:  {} points, {} triangles (head_found.png shows where the stripes were found).\n\n\
         In {}:\n",
        flatness.points,
        flatness.mean_mm,
        flatness.mean_percent,
        head.cloud.points.len(),
        head.cloud.triangles.len(),
        args.out.display()
    );
    for (files, meaning) in [
        ("checker.png, checker.json", "the pattern for calibration, and its description"),
        ("stripes.png, stripes.json", "the pattern for reconstruction, and its description"),
        ("sheet.jpg, board.jpg, head.jpg", "the photographs"),
        ("rig.json", "the calibrated camera and projector"),
        (
            "board.ply, cloud.ply",
            "the board and the head, each with the wall behind it; MeshLab, CloudCompare or Blender show them",
        ),
        ("sheet_found.png, head_found.png", "what was found in the photographs"),
    ] {
        let _ = writeln!(text, "   {files:<34}{meaning}");
    }
    let _ = write!(
        text,
        "\nThe same by hand, in that folder:\n   \
         slcal calibrate sheet.jpg --size 594x420mm --pattern checker.json -o my_rig.json\n   \
         slcal reconstruct --rig my_rig.json --pattern stripes.json head.jpg -o my_cloud.ply --mesh"
    );
    Ok(text)
}

fn focal(device: &Device) -> (f64, Option<f64>) {
    (device.model.intrinsics.fx, device.sigma.map(|s| s.focal_px))
}

fn row(text: &mut String, label: &str, (found, sigma): (f64, Option<f64>), truth: f64) {
    let found_text = sigma.map_or(format!("{found:.1}"), |s| format!("{found:.1} ± {s:.1}"));
    let _ = writeln!(text, "   {label:<38}{found_text:>20}{truth:>11.1}{:>11.2}", found - truth);
}
