//! The synthetic experiment as tables.

use slcal_core::simulate::{
    Coverage, ErrorStatistics, LevelReport, MethodName, MethodReport, NoiseConfig, NoiseReport,
    PrincipalPoints, Statistics,
};

use super::number::unsigned;
use crate::output::{Table, TextLayout, unbroken};

/// Tilts below this about one of the axes leave one vanishing point near infinity, rad.
const SINGLE_AXIS_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// The tables with what they mean.
pub(crate) fn noise_experiment(config: &NoiseConfig, report: &NoiseReport) -> String {
    let mut layout = TextLayout::new();
    head(&mut layout, config, report);
    layout.gap();
    layout.table(&fits(report));
    layout.gap();
    layout.table(&errors(report));
    layout.gap();
    layout.table(&held(report));
    layout.gap();
    foot(&mut layout, config, report);
    layout.into_text()
}

fn head(layout: &mut TextLayout, config: &NoiseConfig, report: &NoiseReport) {
    let t = report.truth;
    let [x, y] = [config.pose.tilt_x_rad, config.pose.tilt_y_rad].map(f64::to_degrees);
    let norm = t.translation_mm.iter().map(|v| v * v).sum::<f64>().sqrt();
    let parts = [
        format!("camera f {} px,", t.camera_focal_px),
        format!("projector f {} px,", t.projector_focal_px),
        format!("translation {norm:.1} mm;"),
        format!(
            "sheet {} x {} mm at {} mm,",
            config.rig.size.width_mm, config.rig.size.height_mm, config.rig.distance_mm
        ),
        format!("tilted by {x:.1}°, {y:.1}°"),
    ];
    layout.line("truth", parts.map(|p| unbroken(&p)).join(" "));
    let told = match config.principal_points {
        PrincipalPoints::Exact => "principal points are told exactly",
        PrincipalPoints::Prior => {
            "principal points are drawn from the default priors: ml is told these, two-vp takes the centres for exact"
        }
    };
    layout.line(
        "draws",
        format!(
            "{} per level, seed {}; {told}; projected squares of {} px; cube of {} mm on the sheet, {} corners seen",
            config.draws, config.seed, t.square_px, t.cube_mm, t.cube_corners
        ),
    );
}

fn name(m: &MethodReport) -> &'static str {
    match m.method {
        MethodName::TwoVp => "two-vp",
        MethodName::Ml => "ml",
    }
}

/// The first row of a level says which it is.
fn level_cell(level: &LevelReport, row: usize) -> String {
    if row == 0 { format!("{:.3}", level.level_px) } else { String::new() }
}

/// How well the rigs explain what was observed, and how well they reconstruct.
fn fits(report: &NoiseReport) -> Table {
    let mut table = Table::new(["noise, px", "", ">camera, px", ">projector, px", ">3D error, %", ">failed"]);
    for level in &report.levels {
        for (i, m) in level.methods.iter().enumerate() {
            table.row([
                level_cell(level, i),
                name(m).to_owned(),
                mean(&m.camera_reprojection_px, 3),
                mean(&m.projector_reprojection_px, 3),
                mean(&m.cube_position_percent, 2),
                format!("{}, {}, {}", m.imaginary, m.refused, m.failed),
            ]);
        }
    }
    table
}

/// How far the rigs are from the truth, and how near anything could come.
fn errors(report: &NoiseReport) -> Table {
    let t = report.truth;
    let mut table = Table::new(["noise, px", "", ">f camera, %", ">f projector, %", ">translation, mm"]);
    for level in &report.levels {
        for (i, m) in level.methods.iter().enumerate() {
            table.row([
                level_cell(level, i),
                name(m).to_owned(),
                error(&m.camera_focal_px, t.camera_focal_px / 100.0, 3),
                error(&m.projector_focal_px, t.projector_focal_px / 100.0, 3),
                error(&m.translation_mm, 1.0, 2),
            ]);
        }
        let b = level.bound;
        table.row([
            String::new(),
            "bound".to_owned(),
            format!("{:.4}", 100.0 * b.camera_focal_px / t.camera_focal_px),
            format!("{:.4}", 100.0 * b.projector_focal_px / t.projector_focal_px),
            format!("{:.3}", b.translation_mm),
        ]);
    }
    table
}

/// How often a rig's own σ was right.
fn held(report: &NoiseReport) -> Table {
    let mut table =
        Table::new(["noise, px", "", ">f camera held, %", ">f projector held, %", ">baseline held, %"]);
    for level in &report.levels {
        for (i, m) in level.methods.iter().enumerate() {
            let row = [level_cell(level, i), name(m).to_owned()];
            table.row(row.into_iter().chain(shares(&m.coverage)));
        }
    }
    table
}

fn mean(s: &Statistics, decimals: usize) -> String {
    // Beyond a thousand the digits behind the point mean nothing, and the column would burst.
    let large = s.mean.into_iter().chain(s.std).any(|x| x.abs() >= 1000.0);
    let decimals = if large { 0 } else { decimals };
    match (s.mean, s.std) {
        (Some(m), Some(std)) => format!("{m:.decimals$} ± {std:.decimals$}"),
        (Some(m), None) => format!("{m:.decimals$}"),
        _ => "-".to_owned(),
    }
}

fn error(e: &ErrorStatistics, unit: f64, decimals: usize) -> String {
    match (e.rms, e.bias) {
        // Beyond a thousand the digits behind the point mean nothing, and the column would burst.
        (Some(rms), Some(bias)) if rms / unit < 1000.0 => {
            let bias = unsigned(bias / unit, decimals);
            format!("{:.decimals$} ({bias:.decimals$})", rms / unit)
        }
        (Some(rms), Some(bias)) => format!("{:.1e} ({:.1e})", rms / unit, bias / unit),
        _ => "-".to_owned(),
    }
}

fn shares(h: &Coverage) -> [String; 3] {
    let percent = |share: Option<f64>| share.map_or("-".to_owned(), |s| format!("{:.1}", 100.0 * s));
    [h.camera_focal, h.projector_focal, h.baseline].map(percent)
}

/// What the columns are; where the method of two vanishing points fails, and why.
fn foot(layout: &mut TextLayout, config: &NoiseConfig, report: &NoiseReport) {
    layout.paragraph(
        "camera, projector: reprojection of what was observed, mean ± std; 3D error: corners of the cube in the camera's frame, mean \
         ± std; failed: draws without a real focal length, refused by their own σ, failed otherwise. Errors of f and \
         translation: rms (bias); bound: smallest standard deviation that any unbiased estimator can have (Cramér–Rao). held: how often \
         ±1.96 of a rig's own σ held the truth. Refused draws count in all columns, others without a rig in none.",
    );
    let two_vp = report.levels.iter().map(|l| &l.methods[0]);
    let (draws, imaginary, refused) =
        two_vp.fold((0, 0, 0), |(d, i, r), m| (d + m.draws, i + m.imaginary, r + m.refused));
    if imaginary + refused > 0 {
        layout.line(
            "two-vp",
            format!(
                "{imaginary} of {draws} draws without a real focal length, {refused} refused by their own σ"
            ),
        );
    }
    let pose = config.pose;
    if pose.tilt_x_rad.abs().min(pose.tilt_y_rad.abs()) < SINGLE_AXIS_RAD {
        layout.line(
            "two-vp",
            "a tilt about (nearly) one axis alone sends a vanishing point to infinity, where noise alone decides: the second \
             constraint of a sheet of known size, which ml uses, is what determines the focal length there",
        );
    }
    if config.principal_points == PrincipalPoints::Prior && config.rig.lens_shift != 0.0 {
        layout.line(
            "two-vp",
            "takes the projector's principal point to be the panel's centre; the lens shift of this one makes its focal length wrong or \
             imaginary, without noise as well",
        );
    }
}
