//! The verbs, and the options that all of them have.

use clap::{Parser, Subcommand};

use super::advise::AdviseArgs;
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
use super::triangulate::TriangulateArgs;
use super::verify::VerifyArgs;
use crate::output::ColorArg;

/// Calibrate a projector and a camera from one photograph; reconstruct what they see from one more.
///
/// Lengths are millimetres, pixels have integer centres. Results go to stdout, messages to stderr; `-` stands for stdin
/// or stdout.
#[derive(Debug, Parser)]
#[command(
    name = "slcal",
    version,
    arg_required_else_help = true,
    after_help = examples::ALL
)]
pub(crate) struct Cli {
    /// Say more on stderr.
    #[arg(short, long, global = true, conflicts_with = "quiet", display_order = 1000, help_heading = GENERAL)]
    pub(crate) verbose: bool,
    /// Say nothing but errors on stderr.
    #[arg(short, long, global = true, display_order = 1001, help_heading = GENERAL)]
    pub(crate) quiet: bool,
    /// Colours: on a terminal (auto), always or never; NO_COLOR and CLICOLOR_FORCE are heeded.
    #[arg(
        long,
        global = true,
        value_enum,
        value_name = "WHEN",
        default_value = "auto",
        alias = "colour",
        display_order = 1002,
        help_heading = GENERAL
    )]
    pub(crate) color: ColorArg,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Run the whole chain on built-in photographs.
    #[command(after_help = examples::DEMO)]
    Demo(DemoArgs),
    /// Draw the pattern to project.
    #[command(subcommand)]
    Pattern(PatternVerb),
    /// Calibrate from photographs of a sheet with the checkerboard projected onto it.
    #[command(after_help = examples::CALIBRATE)]
    Calibrate(CalibrateArgs),
    /// Predict how well the focal lengths would be known from given tilts, and say which photograph to take next.
    #[command(after_help = examples::ADVISE)]
    Advise(AdviseArgs),
    /// Draw the picture that appears as an upright rectangle on the sheet.
    #[command(after_help = examples::RECTIFY)]
    Rectify(RectifyArgs),
    /// Measure how square a rectified projection is now, and whether the rig has moved.
    #[command(after_help = examples::VERIFY)]
    Verify(VerifyArgs),
    /// Find the projected stripes in a photograph.
    #[command(after_help = examples::DECODE)]
    Decode(DecodeArgs),
    /// Turn matches of any decoder into points.
    #[command(after_help = examples::TRIANGULATE)]
    Triangulate(TriangulateArgs),
    /// Photographs of an object under the stripes in, point clouds out.
    #[command(after_help = examples::RECONSTRUCT)]
    Reconstruct(ReconstructArgs),
    /// Fit a plane or a sphere to a cloud and say how far the points lie from it.
    #[command(after_help = examples::EVALUATE)]
    Evaluate(EvaluateArgs),
    /// Show a rig, and a cloud that was made with it, as one HTML file.
    #[command(after_help = examples::REPORT)]
    Report(ReportArgs),
    /// Write a rig as other programs read it.
    #[command(after_help = examples::EXPORT)]
    Export(ExportArgs),
    /// Read a rig from files of other programs.
    #[command(after_help = examples::IMPORT)]
    Import(ImportArgs),
    /// Experiments on rigs whose truth is known.
    #[command(subcommand)]
    Simulate(SimulateVerb),
    /// Print a script that completes verbs, options and file names in a shell.
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Print the manual page, or write one for each verb.
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
