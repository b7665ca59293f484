//! The verbs, and the options that all of them have.

use clap::{Parser, Subcommand};

use super::advise::AdviseArgs;
use super::bug_report::BugReportArgs;
use super::calibrate::CalibrateArgs;
use super::decode::DecodeArgs;
use super::demo::DemoArgs;
use super::evaluate::EvaluateArgs;
use super::examples;
use super::exchange::{ExportArgs, ImportArgs};
use super::headings::GENERAL;
use super::pattern::PatternVerb;
use super::reconstruct::ReconstructArgs;
use super::rectify::RectifyArgs;
use super::report::ReportArgs;
use super::shell::{CompletionsArgs, ManArgs};
use super::simulate::SimulateVerb;
#[cfg(feature = "studio")]
use super::studio::StudioArgs;
use super::triangulate::TriangulateArgs;
use super::verify::VerifyArgs;
use crate::output::ColorArg;

/// Calibrate a projector and a camera from photographs of a sheet of paper, and reconstruct surfaces from one photograph.
///
/// Lengths are in millimetres, pixel centres are integers. Results go to stdout, messages to stderr. `-` stands for stdin
/// or stdout.
#[derive(Debug, Parser)]
#[command(
    name = "slcal",
    version,
    arg_required_else_help = true,
    after_help = examples::ALL
)]
pub(crate) struct Cli {
    /// Print more messages on stderr.
    #[arg(short, long, global = true, conflicts_with = "quiet", display_order = 1000, help_heading = GENERAL)]
    pub(crate) verbose: bool,
    /// Print only errors on stderr.
    #[arg(short, long, global = true, display_order = 1001, help_heading = GENERAL)]
    pub(crate) quiet: bool,
    /// When to use colours. auto: on a terminal, unless NO_COLOR, CLICOLOR or CLICOLOR_FORCE say otherwise.
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value = "auto", alias = "colour",
          display_order = 1002, help_heading = GENERAL)]
    pub(crate) color: ColorArg,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Run calibration and reconstruction on built-in photographs.
    #[command(after_help = examples::DEMO)]
    Demo(DemoArgs),
    /// Show patterns, take photographs and see the results in a browser window.
    #[cfg(feature = "studio")]
    #[command(after_help = examples::STUDIO)]
    Studio(StudioArgs),
    /// Draw a pattern to project.
    #[command(subcommand)]
    Pattern(PatternVerb),
    /// Calibrate a projector and a camera from photographs of a sheet with the projected checkerboard.
    #[command(after_help = examples::CALIBRATE)]
    Calibrate(CalibrateArgs),
    /// Predict the uncertainty of the focal lengths against tilt, and recommend the next photograph.
    #[command(after_help = examples::ADVISE)]
    Advise(AdviseArgs),
    /// Draw a picture that appears without keystone on the sheet.
    #[command(after_help = examples::RECTIFY)]
    Rectify(RectifyArgs),
    /// Measure the keystone of a rectified projection, and test whether the rig has moved.
    #[command(after_help = examples::VERIFY)]
    Verify(VerifyArgs),
    /// Identify the projected stripes in a photograph.
    #[command(after_help = examples::DECODE)]
    Decode(DecodeArgs),
    /// Triangulate the matches of any decoder.
    #[command(after_help = examples::TRIANGULATE)]
    Triangulate(TriangulateArgs),
    /// Reconstruct point clouds from photographs of objects under the stripes.
    #[command(after_help = examples::RECONSTRUCT)]
    Reconstruct(ReconstructArgs),
    /// Fit a plane or a sphere to a cloud and report the distances of the points from it.
    #[command(after_help = examples::EVALUATE)]
    Evaluate(EvaluateArgs),
    /// Write an HTML report on a rig, and on a cloud reconstructed with it.
    #[command(after_help = examples::REPORT)]
    Report(ReportArgs),
    /// Write a rig as files of other programs.
    #[command(after_help = examples::EXPORT)]
    Export(ExportArgs),
    /// Read a rig from files of other programs.
    #[command(after_help = examples::IMPORT)]
    Import(ImportArgs),
    /// Simulate rigs, measurements and photographs with ground truth.
    #[command(subcommand)]
    Simulate(SimulateVerb),
    /// Pack what helps to find out why a result is wrong, and show what is packed.
    #[command(after_help = examples::BUG_REPORT)]
    BugReport(BugReportArgs),
    /// Print a completion script for a shell.
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Print the manual page, or write a page for each verb.
    #[command(after_help = examples::MAN)]
    Man(ManArgs),
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;
    use nalgebra::Point2;
    use slcal_core::PrincipalPointRule;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn values_may_start_with_a_minus_sign() {
        let cli = Cli::try_parse_from([
            "slcal",
            "calibrate",
            "a.png",
            "--size",
            "A4",
            "--corners",
            "-12,40 1,2 3,4 5,6",
            "--camera-pp",
            "-3,4",
            "-o",
            "r.json",
        ])
        .unwrap();
        let Verb::Calibrate(args) = cli.verb else { panic!("another verb") };
        assert_eq!(args.corners[0][0], Point2::new(-12.0, 40.0));
        assert_eq!(args.camera_pp, PrincipalPointRule::Exact(-3.0, 4.0));
    }

    #[test]
    fn nonsense_is_refused() {
        for line in [
            "slcal calibrate a.png --size A4 --camera-pp shift -o r.json",
            "slcal calibrate a.png --size A4 --gamma nan -o r.json",
            "slcal reconstruct --rig r --pattern p a.png",
            "slcal reconstruct --rig r --pattern p a.png -o c.ply --out-dir d",
            "slcal reconstruct --rig r --pattern p a.png -o c.ply --cull -1",
            "slcal reconstruct --rig r --pattern p --out-dir d",
            "slcal reconstruct --rig r --pattern p --raw 64x48:gray --out-dir d",
            "slcal reconstruct --rig r --pattern p --raw 64x48:rgb24 -o c.ply",
            "slcal reconstruct --rig r --pattern p a.png --out-dir d --resume --force",
            "slcal reconstruct --rig r --pattern p a.png --out-dir d --jobs 0",
            "slcal reconstruct --rig r --pattern p a.png -o c.ply --resume",
            "slcal reconstruct --rig r --pattern p a.png -o c.ply --format obj",
            "slcal rectify --rig r -o a.png",
        ] {
            assert!(Cli::try_parse_from(line.split(' ')).is_err(), "{line}");
        }
    }
}
