//! `slcal simulate`.

mod scene;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use nalgebra::Point2;
use slcal_core::geometry::RectangleSize;
use slcal_core::simulate::PrincipalPoints;

pub(crate) use scene::{Crosstalk, LightArgs, MeshFrameArg, PlaceArgs, SceneArgs, WallArg};

use super::examples;
use crate::args::value::{choice, parse_pair, parse_point, parse_size};

#[derive(Debug, Subcommand)]
pub(crate) enum SimulateVerb {
    /// Calibrate again and again under rising noise, by both methods, and compare with the truth.
    #[command(after_help = examples::NOISE)]
    Noise(Box<NoiseArgs>),
    /// Observations of a sheet in several poses, with noise, and the rig that is the truth behind them.
    #[command(after_help = examples::VIEWS)]
    Views(Box<ViewsArgs>),
    /// Photographs of a plane, a sphere, a step, a sheet or a mesh under the projector's light, with the truth of every pixel.
    #[command(after_help = examples::SCENE)]
    Scene(Box<SceneArgs>),
}

/// The rig that is simulated.
#[derive(Debug, Args)]
#[command(next_help_heading = "Rig")]
pub(crate) struct RigArgs {
    /// Size of the camera's picture.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, default_value = "1280x960")]
    pub(crate) camera: [u32; 2],
    /// Focal length of the camera.
    #[arg(long, value_name = "PX", default_value_t = 1500.0, allow_hyphen_values = true)]
    pub(crate) focal: f64,
    /// Size of the projector's panel.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, default_value = "1024x768")]
    pub(crate) projector: [u32; 2],
    /// Focal length of the projector.
    #[arg(long, value_name = "PX", default_value_t = 1700.0, allow_hyphen_values = true)]
    pub(crate) projector_focal: f64,
    /// How far below the panel's middle the projector's principal point lies, in heights of the panel.
    #[arg(long, value_name = "HEIGHTS", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) lens_shift: f64,
    /// Horizontal distance between camera and projector.
    #[arg(long, value_name = "MM", default_value_t = 250.0, allow_hyphen_values = true)]
    pub(crate) baseline: f64,
    /// Size of the sheet.
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "594x420mm",
          allow_hyphen_values = true)]
    pub(crate) size: RectangleSize,
    /// Distance of the sheet's middle from the camera.
    #[arg(long, value_name = "MM", default_value_t = 1000.0, allow_hyphen_values = true)]
    pub(crate) distance: f64,
}

#[derive(Debug, Args)]
pub(crate) struct NoiseArgs {
    /// Standard deviations of the noise on each image coordinate, px: a list (0.1,0.2,0.5), or MAX/STEPS for zero and
    /// that many equal steps up to a largest.
    #[arg(long, value_name = "LIST|MAX/STEPS", value_parser = parse_levels, default_value = "1/10",
          allow_hyphen_values = true)]
    pub(crate) levels: Levels,
    /// Draws of the noise per level.
    #[arg(long, value_name = "N", default_value_t = 50, allow_hyphen_values = true)]
    pub(crate) draws: usize,
    /// Seed of the noise: the same seed gives the same output.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    /// Tilt of the sheet about the camera's horizontal, then its vertical axis, degrees.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, default_value = "25,28",
          allow_hyphen_values = true)]
    pub(crate) tilt: Point2<f64>,
    /// What the methods are told about principal points: exact as in the published experiment, or the default priors, from
    /// which the truth is then drawn (two-vp takes the centres for exact).
    #[arg(long, value_parser = choice::<PrincipalPoints>(PrincipalPoints::NAMES), default_value_t)]
    pub(crate) principal_points: PrincipalPoints,
    /// Edge of the reference cube that stands on the sheet [default: a quarter of the sheet's
    /// shorter side, or less where that is not seen whole].
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub(crate) cube: Option<f64>,
    #[command(flatten)]
    pub(crate) rig: RigArgs,
    /// Write the table as CSV; `-` for stdout.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Print the result as JSON instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ViewsArgs {
    /// Number of poses, tilted by 15° to 35° in directions all round.
    #[arg(long, value_name = "N", default_value_t = 10, allow_hyphen_values = true, conflicts_with = "pose")]
    pub(crate) poses: usize,
    /// A pose of one's own: tilt about the camera's horizontal and vertical axis and, if wanted, roll, degrees; repeatable.
    #[arg(long, value_name = "X,Y[,ROLL]", value_parser = parse_pose, allow_hyphen_values = true)]
    pub(crate) pose: Vec<PoseArg>,
    /// Standard deviation of the noise on each image coordinate, px.
    #[arg(long, value_name = "PX", default_value_t = 0.1, allow_hyphen_values = true)]
    pub(crate) noise: f64,
    /// So many points on each of the sheet's edges instead of its corners.
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) edges: Option<usize>,
    /// Seed of poses and noise: the same seed gives the same output.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) rig: RigArgs,
    /// The camera's principal point off the picture's centre, px.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, default_value = "0,0", help_heading = "Rig",
          allow_hyphen_values = true)]
    pub(crate) camera_offset: Point2<f64>,
    /// The projector's principal point off the panel's middle column, px.
    #[arg(long, value_name = "PX", default_value_t = 0.0, help_heading = "Rig", allow_hyphen_values = true)]
    pub(crate) projector_offset: f64,
    /// The camera's distortion, as many coefficients as are not zero.
    #[arg(long, value_name = "k1,k2,p1,p2,k3", value_parser = parse_distortion, default_value = "0",
          help_heading = "Rig", allow_hyphen_values = true)]
    pub(crate) distortion: Distortion,
    /// Where to write the observations; `-` for stdout.
    #[arg(short, long, value_name = "FILE.json")]
    pub(crate) output: PathBuf,
    /// Where to write the true rig.
    #[arg(long, value_name = "RIG.json")]
    pub(crate) truth: Option<PathBuf>,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

/// Levels of noise, px.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Levels(pub(crate) Vec<f64>);

/// Tilts and roll, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PoseArg(pub(crate) [f64; 3]);

/// k1, k2, p1, p2, k3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Distortion(pub(crate) [f64; 5]);

/// More steps than any figure shows.
const MOST_STEPS: u32 = 999;

fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|t| t.trim().parse::<f64>().ok().filter(|x| x.is_finite())).collect()
}

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

fn parse_pose(text: &str) -> Result<PoseArg, String> {
    match numbers(text).as_deref() {
        Some(&[x, y]) => Ok(PoseArg([x, y, 0.0])),
        Some(&[x, y, roll]) => Ok(PoseArg([x, y, roll])),
        _ => Err("expected two or three finite angles in degrees, such as 25,28 or 25,-28,5".to_owned()),
    }
}

fn parse_distortion(text: &str) -> Result<Distortion, String> {
    let wrong = || "expected one to five finite coefficients k1,k2,p1,p2,k3, such as -0.12,0.02".to_owned();
    let given = numbers(text).filter(|k| k.len() <= 5).ok_or_else(wrong)?;
    let mut all = [0.0; 5];
    all.iter_mut().zip(given).for_each(|(k, g)| *k = g);
    Ok(Distortion(all))
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

    #[test]
    fn poses_and_coefficients() {
        assert_eq!(parse_pose("25,-28"), Ok(PoseArg([25.0, -28.0, 0.0])));
        assert!(parse_pose("25").is_err() && parse_pose("1,2,3,4").is_err() && parse_pose("1,nan").is_err());
        assert_eq!(parse_distortion("-0.1,0.02"), Ok(Distortion([-0.1, 0.02, 0.0, 0.0, 0.0])));
        assert!(parse_distortion("1,2,3,4,5,6").is_err());
    }
}
