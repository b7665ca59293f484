//! `slcal simulate noise`.

use std::path::PathBuf;

use clap::Args;
use nalgebra::Point2;
use slcal_core::simulate::PrincipalPoints;

use super::rig::RigArgs;
use super::values::numbers;
use crate::args::headings::{MODEL, OUTPUT, SETTINGS};
use crate::args::value::{choice, parse_point};

#[derive(Debug, Args)]
pub(crate) struct NoiseArgs {
    /// σ of the noise on each image coordinate, px: a list (0.1,0.2,0.5), or MAX/STEPS.
    ///
    /// MAX/STEPS stands for zero and STEPS equal steps up to MAX.
    #[arg(long, value_name = "LIST|MAX/STEPS", value_parser = parse_levels, default_value = "1/10",
          allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) levels: Levels,
    /// Draws of the noise per level.
    #[arg(long, value_name = "N", default_value_t = 50, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) draws: usize,
    /// Seed of the noise: the same seed gives the same output.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) seed: u64,
    /// Tilt of the sheet about the horizontal, then the vertical axis of the camera, degrees.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, default_value = "25,28",
          allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) tilt: Point2<f64>,
    /// Knowledge of the principal points: exact (as in the published experiment) or prior.
    ///
    /// prior: the truth is drawn from the default priors, and the methods get what they get by default (two-vp takes
    /// the centres as exact).
    #[arg(long, value_parser = choice::<PrincipalPoints>(PrincipalPoints::NAMES), default_value_t,
          help_heading = MODEL)]
    pub(crate) principal_points: PrincipalPoints,
    /// Edge of the reference cube on the sheet [default: a quarter of the shorter side of the sheet, or less where not
    /// all of it is visible].
    #[arg(long, value_name = "MM", allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) cube: Option<f64>,
    #[command(flatten)]
    pub(crate) rig: RigArgs,
    /// File for the table as CSV; `-` for stdout.
    #[arg(long, value_name = "FILE.csv", help_heading = OUTPUT)]
    pub(crate) csv: Option<PathBuf>,
    /// Print the result as JSON instead of a table.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

/// Levels of noise, px.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Levels(pub(crate) Vec<f64>);

/// More steps than any figure shows.
const MOST_STEPS: u32 = 999;

fn parse_levels(text: &str) -> Result<Levels, String> {
    let wrong = || {
        format!(
            "expected a list of numbers such as 0.1,0.2,0.5, or MAX/STEPS with 1 to {MOST_STEPS} steps, such as 1/10"
        )
    };
    let Some((most, steps)) = text.split_once('/') else {
        return numbers(text).map(Levels).ok_or_else(wrong);
    };
    let most = most.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong)?;
    let steps: u32 = steps.trim().parse().ok().filter(|n| (1..=MOST_STEPS).contains(n)).ok_or_else(wrong)?;
    Ok(Levels((0..=steps).map(|i| most * f64::from(i) / f64::from(steps)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_a_list_or_steps() {
        assert_eq!(parse_levels("0.1, 0.5"), Ok(Levels(vec![0.1, 0.5])));
        assert_eq!(parse_levels("1/4"), Ok(Levels(vec![0.0, 0.25, 0.5, 0.75, 1.0])));
        for text in ["", "a", "1/0", "1/1000000", "nan/3", "1/2/3", "0.1,,0.2", "inf"] {
            assert!(parse_levels(text).is_err(), "{text}");
        }
    }
}
