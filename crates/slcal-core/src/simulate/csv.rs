//! The experiment as a CSV table.

use std::fmt::Write as _;

use super::experiment::{LevelReport, NoiseReport};
use super::statistics::{ErrorStatistics, Statistics};
use super::trial::{MethodName, MethodReport};

const HEADER: &str = "level_px,method,draws,imaginary,refused,failed,cube_missed,\
    camera_reprojection_px_mean,camera_reprojection_px_std,projector_reprojection_px_mean,projector_reprojection_px_std,\
    cube_position_percent_mean,cube_position_percent_std,cube_length_percent_mean,cube_length_percent_std,\
    camera_focal_px_bias,camera_focal_px_std,camera_focal_px_rms,camera_focal_px_median,camera_focal_px_bound,\
    projector_focal_px_bias,projector_focal_px_std,projector_focal_px_rms,projector_focal_px_median,\
    projector_focal_px_bound,\
    translation_mm_bias,translation_mm_std,translation_mm_rms,translation_mm_median,translation_mm_bound,\
    held_camera_focal,held_projector_focal,held_baseline";

impl NoiseReport {
    /// One row per level and method, with a header; undefined values are empty fields.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = format!("{HEADER}\n");
        for level in &self.levels {
            for m in &level.methods {
                text.push_str(&row(level, m));
                text.push('\n');
            }
        }
        text
    }
}

fn row(level: &LevelReport, m: &MethodReport) -> String {
    let name = match m.method {
        MethodName::TwoVp => "two-vp",
        MethodName::Ml => "ml",
    };
    let mut line = format!(
        "{},{name},{},{},{},{},{}",
        level.level_px, m.draws, m.imaginary, m.refused, m.failed, m.cube_missed
    );
    let mut put = |value: Option<f64>| {
        // Writing into a string cannot fail.
        let _ = match value {
            Some(v) => write!(line, ",{v}"),
            None => write!(line, ","),
        };
    };
    let of = |s: &Statistics| [s.mean, s.std];
    let of_error = |e: &ErrorStatistics, bound: f64| [e.bias, e.std, e.rms, e.median, Some(bound)];
    for s in [
        &m.camera_reprojection_px,
        &m.projector_reprojection_px,
        &m.cube_position_percent,
        &m.cube_length_percent,
    ] {
        of(s).into_iter().for_each(&mut put);
    }
    for (e, bound) in [
        (&m.camera_focal_px, level.bound.camera_focal_px),
        (&m.projector_focal_px, level.bound.projector_focal_px),
        (&m.translation_mm, level.bound.translation_mm),
    ] {
        of_error(e, bound).into_iter().for_each(&mut put);
    }
    [m.coverage.camera_focal, m.coverage.projector_focal, m.coverage.baseline].into_iter().for_each(&mut put);
    line
}
