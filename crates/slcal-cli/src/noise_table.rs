//! The synthetic experiment as a table for people.

use std::fmt::Write as _;

use slcal_core::simulate::{
    ErrorStatistics, Held, MethodName, MethodReport, NoiseConfig, NoiseReport, PrincipalPoints, Statistics,
};

/// Tilts below this about one of the axes leave one vanishing point near infinity, rad.
const SINGLE_AXIS_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// The table with what it means.
pub(crate) fn text(config: &NoiseConfig, report: &NoiseReport) -> String {
    let mut text = String::new();
    head(&mut text, config, report);
    for level in &report.levels {
        for m in &level.methods {
            row(&mut text, level.level_px, m, report);
        }
        let b = level.bound;
        let percent = |sigma: f64, truth: f64| 100.0 * sigma / truth;
        let f = percent(b.camera_focal_px, report.truth.camera_focal_px);
        let g = percent(b.projector_focal_px, report.truth.projector_focal_px);
        put(
            &mut text,
            &format!("{:>6} {:<6} {:53} {f:>15.4} {g:>15.4} {:>15.3}", "", "bound", "", b.translation_mm),
        );
    }
    foot(&mut text, config, report);
    text
}

fn put(text: &mut String, line: &str) {
    // Writing into a string cannot fail.
    let _ = writeln!(text, "{}", line.trim_end());
}

fn head(text: &mut String, config: &NoiseConfig, report: &NoiseReport) {
    let t = report.truth;
    let [x, y] = [config.pose.tilt_x_rad, config.pose.tilt_y_rad].map(f64::to_degrees);
    let norm = t.translation_mm.iter().map(|v| v * v).sum::<f64>().sqrt();
    put(
        text,
        &format!(
            "truth   camera f {} px, projector f {} px, translation {norm:.1} mm; sheet {} x {} mm at {} mm, tilted by \
             {x:.1}°, {y:.1}°",
            t.camera_focal_px,
            t.projector_focal_px,
            config.rig.size.width_mm,
            config.rig.size.height_mm,
            config.rig.distance_mm
        ),
    );
    let told = match config.principal_points {
        PrincipalPoints::Exact => "principal points are told exactly",
        PrincipalPoints::Prior => {
            "principal points are drawn from the default priors: ml is told these, two-vp takes the centres for exact"
        }
    };
    put(
        text,
        &format!(
            "draws   {} per level, seed {}; {told}; projected squares of {} px; cube of {} mm on the sheet, {} corners seen",
            config.draws, config.seed, t.square_px, t.cube_mm, t.cube_corners
        ),
    );
    put(text, "");
    put(
        text,
        &format!(
            "{:>6} {:<6} {:>17} {:>17} {:>17} {:>15} {:>15} {:>15} {:>14}  failures",
            "noise",
            "method",
            "camera",
            "projector",
            "3D error",
            "f camera",
            "f projector",
            "translation",
            "held by 95 %"
        ),
    );
    put(
        text,
        &format!(
            "{:>6} {:<6} {:>17} {:>17} {:>17} {:>15} {:>15} {:>15} {:>14}  imaginary, refused, other",
            "px",
            "",
            "mean ± std, px",
            "mean ± std, px",
            "mean ± std, %",
            "rms (bias), %",
            "rms (bias), %",
            "rms (bias), mm",
            "f, f, base, %"
        ),
    );
}

fn mean(s: &Statistics, decimals: usize) -> String {
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
            // Adding zero takes the sign off a negative one.
            let grid = 10_f64.powi(decimals as i32);
            let bias = (bias / unit * grid).round() / grid + 0.0;
            format!("{:.decimals$} ({bias:.decimals$})", rms / unit)
        }
        (Some(rms), Some(bias)) => format!("{:.1e} ({:.1e})", rms / unit, bias / unit),
        _ => "-".to_owned(),
    }
}

fn held(h: &Held) -> String {
    let percent = |share: Option<f64>| share.map_or("-".to_owned(), |s| format!("{:.1}", 100.0 * s));
    [h.camera_focal, h.projector_focal, h.baseline].map(percent).join(", ")
}

fn row(text: &mut String, level: f64, m: &MethodReport, report: &NoiseReport) {
    let (level, name) = match m.method {
        MethodName::TwoVp => (format!("{level:.3}"), "two-vp"),
        MethodName::Ml => (String::new(), "ml"),
    };
    let t = report.truth;
    put(
        text,
        &format!(
            "{level:>6} {name:<6} {:>17} {:>17} {:>17} {:>15} {:>15} {:>15} {:>14}  {}, {}, {}",
            mean(&m.camera_reprojection_px, 3),
            mean(&m.projector_reprojection_px, 3),
            mean(&m.cube_position_percent, 2),
            error(&m.camera_focal_px, t.camera_focal_px / 100.0, 3),
            error(&m.projector_focal_px, t.projector_focal_px / 100.0, 3),
            error(&m.translation_mm, 1.0, 2),
            held(&m.held),
            m.imaginary,
            m.refused,
            m.failed
        ),
    );
}

/// Where the method of two vanishing points fails, and why.
fn foot(text: &mut String, config: &NoiseConfig, report: &NoiseReport) {
    let two_vp = report.levels.iter().map(|l| &l.methods[0]);
    let (draws, imaginary, refused) =
        two_vp.fold((0, 0, 0), |(d, i, r), m| (d + m.draws, i + m.imaginary, r + m.refused));
    put(text, "");
    put(
        text,
        "camera, projector: reprojection of what was observed; 3D error: corners of the cube in the camera's frame; bound: \
         smallest\nstandard deviation that any unbiased estimator can have (Cramér–Rao); held: how often ±1.96 of a rig's own σ held the true focal lengths and\nbaseline. Refused draws count in all columns, \
         others without a rig in none.",
    );
    if imaginary + refused > 0 {
        put(
            text,
            &format!(
                "two-vp  {imaginary} of {draws} draws without a real focal length, {refused} refused by their own σ"
            ),
        );
    }
    let pose = config.pose;
    if pose.tilt_x_rad.abs().min(pose.tilt_y_rad.abs()) < SINGLE_AXIS_RAD {
        put(
            text,
            "two-vp  a tilt about (nearly) one axis alone sends a vanishing point to infinity, where noise alone decides: the \
             second\n        constraint of a sheet of known size, which ml uses, is what determines the focal length there",
        );
    }
    if config.principal_points == PrincipalPoints::Prior && config.rig.lens_shift != 0.0 {
        put(
            text,
            "two-vp  takes the projector's principal point to be the panel's centre; the lens shift of this one makes its focal \
             length\n        wrong or imaginary, without noise as well",
        );
    }
}
