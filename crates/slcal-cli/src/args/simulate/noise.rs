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
    /// Standard deviations of the noise on each image coordinate, px: a list (0.1,0.2,0.5), or MAX/STEPS for zero and
    /// that many equal steps up to a largest.
    #[arg(long, value_name = "LIST|MAX/STEPS", value_parser = parse_levels, default_value = "1/10",
          allow_hyphen_values = true,
          help_heading = SETTINGS)]
    pub(crate) levels: Levels,
    /// Draws of the noise per level.
    #[arg(long, value_name = "N", default_value_t = 50, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) draws: usize,
    /// Seed of the noise: the same seed gives the same output.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) seed: u64,
    /// Tilt of the sheet about the camera's horizontal, then its vertical axis, degrees.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, default_value = "25,28",
          allow_hyphen_values = true,
          help_heading = SETTINGS)]
    pub(crate) tilt: Point2<f64>,
    /// What the methods are told about principal points: exact as in the published experiment, or the default priors, from
    /// which the truth is then drawn (two-vp takes the centres for exact).
    #[arg(long, value_parser = choice::<PrincipalPoints>(PrincipalPoints::NAMES), default_value_t, help_heading = MODEL)]
    pub(crate) principal_points: PrincipalPoints,
    /// Edge of the reference cube that stands on the sheet [default: a quarter of the sheet's
    /// shorter side, or less where that is not seen whole].
    #[arg(long, value_name = "MM", allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) cube: Option<f64>,
    #[command(flatten)]
    pub(crate) rig: RigArgs,
    /// Write the table as CSV; `-` for stdout.
    #[arg(long, value_name = "FILE.csv", help_heading = OUTPUT)]
    pub(crate) csv: Option<PathBuf>,
    /// Print the result as JSON instead of a table.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace files that exist.
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
