//! The synthetic noise experiment as tables.

use std::fmt::Write as _;

use slcal_core::simulate::{
    Coverage, ErrorStatistics, LevelReport, MethodName, MethodReport, NoiseConfig, NoiseReport,
    PrincipalPoints, Statistics,
};

use super::number::unsigned;
use crate::output::{Table, TextLayout, unbroken};

/// Tilts below this about one of the axes leave one vanishing point near infinity, rad.
const SINGLE_AXIS_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// The tables and their explanation.
pub(crate) fn noise_experiment(config: &NoiseConfig, report: &NoiseReport) -> String {
    let mut layout = TextLayout::new();
    head(&mut layout, config, report);
    layout.gap();
    layout.table(&fits(report));
    layout.gap();
    layout.table(&errors(report));
    layout.gap();
    layout.table(&coverage(report));
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
    let mut truth = parts.map(|p| unbroken(&p)).join(" ");
    if let Some(bend) = &config.rig.bend {
        let _ = write!(truth, "; bent: {}", bend.report(config.rig.size));
    }
    layout.line("truth", truth);
    let principal_points = match config.principal_points {
        PrincipalPoints::Exact => "principal points are known exactly",
        PrincipalPoints::Prior => {
            "principal points are drawn from the default priors, which ml knows; two-vp assumes the image centres"
        }
    };
    layout.line(
        "draws",
        format!(
            "{} per level, seed {}; {principal_points}; projected squares of {} px; cube of {} mm on the sheet, {} visible corners",
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

/// The level, in its first row only.
fn level_cell(level: &LevelReport, row: usize) -> String {
    if row == 0 { format!("{:.3}", level.level_px) } else { String::new() }
}

/// Reprojection and reconstruction errors.
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

/// Errors of the parameters, and the Cramér–Rao bound.
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

/// Coverage of the rigs' own σ.
fn coverage(report: &NoiseReport) -> Table {
    let mut table =
        Table::new(["noise, px", "", ">coverage: f camera, %", ">f projector, %", ">baseline, %"]);
    for level in &report.levels {
        for (i, m) in level.methods.iter().enumerate() {
            let row = [level_cell(level, i), name(m).to_owned()];
            table.row(row.into_iter().chain(shares(&m.coverage)));
        }
    }
    table
}

fn mean(s: &Statistics, decimals: usize) -> String {
    // From a thousand on, decimals mean nothing and would widen the column.
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
        // From a thousand on, decimals mean nothing and would widen the column.
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

/// The meaning of the columns, and why the two-vanishing-point method fails where it does.
fn foot(layout: &mut TextLayout, config: &NoiseConfig, report: &NoiseReport) {
    layout.paragraph(
        "camera, projector: reprojection errors, mean ± std. 3D error: corners of the cube in the camera's frame, mean ± std. failed: \
         draws with an imaginary focal length, draws refused for their own σ, other failures. Errors of f and translation: rms \
         (bias). bound: the smallest standard deviation of any unbiased estimator (Cramér–Rao). coverage: how often ±1.96 σ of a \
         rig contain the truth. Refused draws count in all columns, other failures in none.",
    );
    let two_vp = report.levels.iter().map(|l| &l.methods[0]);
    let (draws, imaginary, refused) =
        two_vp.fold((0, 0, 0), |(d, i, r), m| (d + m.draws, i + m.imaginary, r + m.refused));
    if imaginary + refused > 0 {
        layout.line(
            "two-vp",
            format!(
                "{imaginary} of {draws} draws with an imaginary focal length, {refused} refused for their own σ"
            ),
        );
    }
    let pose = config.pose;
    if pose.tilt_x_rad.abs().min(pose.tilt_y_rad.abs()) < SINGLE_AXIS_RAD {
        layout.line(
            "two-vp",
            "a tilt about one axis alone moves a vanishing point to infinity, so that only noise determines it; there the known \
             size of the sheet, which ml uses, determines the focal length",
        );
    }
    if config.principal_points == PrincipalPoints::Prior && config.rig.lens_shift != 0.0 {
        layout.line(
            "two-vp",
            "assumes that the projector's principal point is the panel's centre; the lens shift here makes its focal length wrong \
             or imaginary even without noise",
        );
    }
}
