//! The command line as it is typed, one file per verb; what it means is decided by the verbs.

mod advise;
mod calibrate;
mod cloud;
mod decode;
mod demo;
mod evaluate;
mod finish;
mod pattern;
mod photo;
mod reconstruct;
mod rectify;
mod report;
mod simulate;
mod triangulate;
mod verify;

use clap::{Parser, Subcommand};

pub(crate) use advise::AdviseArgs;
pub(crate) use calibrate::{CalibrateArgs, DistortionArg, MethodArg, PrincipalPointArg};
pub(crate) use cloud::{CullArg, FrameArg};
pub(crate) use decode::{DecodeArgs, DecodeInput};
pub(crate) use demo::DemoArgs;
pub(crate) use evaluate::{EvaluateArgs, ShapeArg};
pub(crate) use finish::{command, hinted};
pub(crate) use pattern::{CheckerArgs, PatternOutput, PatternVerb, StripesArgs};
pub(crate) use reconstruct::ReconstructArgs;
pub(crate) use rectify::RectifyArgs;
pub(crate) use report::ReportArgs;
pub(crate) use simulate::{
    Crosstalk, LightArgs, MeshFrameArg, NoiseArgs, PlaceArgs, PrincipalPointsArg, RigArgs, SceneArgs,
    SimulateVerb, ViewsArgs, WallArg,
};
pub(crate) use triangulate::TriangulateArgs;
pub(crate) use verify::VerifyArgs;

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
    after_help = "Exit codes: 0 done; 2 wrong command line; 3 input unreadable or malformed; 4 sheet, pattern or stripes \
                  not found;\n5 geometry degenerate; 1 anything else.\n\nStart with `slcal demo`."
)]
pub(crate) struct Cli {
    /// Say more on stderr.
    #[arg(short, long, global = true, conflicts_with = "quiet", display_order = 1000)]
    pub(crate) verbose: bool,
    /// Say nothing but errors on stderr.
    #[arg(short, long, global = true, display_order = 1001)]
    pub(crate) quiet: bool,
    /// Colours: on a terminal (auto), always or never; NO_COLOR and CLICOLOR_FORCE are heeded.
    #[arg(
        long,
        global = true,
        value_enum,
        value_name = "WHEN",
        default_value = "auto",
        alias = "colour",
        display_order = 1002
    )]
    pub(crate) color: ColorArg,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Run the whole chain on built-in photographs.
    #[command(
        after_help = "Example:\n  slcal demo --out demo\n\nwrites the patterns, the photographs, rig.json, cloud.ply \
                            and pictures of what was found into demo/."
    )]
    Demo(DemoArgs),
    /// Draw the pattern to project.
    #[command(subcommand)]
    Pattern(PatternVerb),
    /// Calibrate from photographs of a sheet with the checkerboard projected onto it.
    #[command(
        after_help = "Examples:\n  slcal calibrate photo.jpg --size A2-landscape --pattern checker.json -o rig.json\n  \
                            slcal calibrate photo.jpg --size A2-landscape --pattern checker.json --camera ost.yaml -o rig.json\n  \
                            slcal calibrate *.jpg --size A4 --pattern checker.json -o rig.json --save-observations seen.json\n  \
                            slcal calibrate --observations seen.json -o rig.json\n\nThe width is the side that runs most nearly \
                            along the image's x axis. Without --pattern the camera alone\nis calibrated. docs/conventions.md \
                            has the format of observations."
    )]
    Calibrate(CalibrateArgs),
    /// Predict how well the focal lengths would be known from given tilts, and say which photograph to take next.
    #[command(
        after_help = "Examples:\n  slcal advise --rig rig.json\n  slcal advise --image 4000x3000 --focal-35mm 28 --size A2-landscape \
                            --projector 1920x1080 --throw 1.5\n\nNothing is photographed: the numbers come from the Jacobian of the \
                            calibration itself."
    )]
    Advise(AdviseArgs),
    /// Draw the picture that appears as an upright rectangle on the sheet.
    #[command(
        after_help = "Examples:\n  slcal rectify --rig rig.json --pattern checker.json -o straight.png\n  \
                            slcal rectify --rig rig.json --image poster.jpg -o straight.png"
    )]
    Rectify(RectifyArgs),
    /// Measure how square a rectified projection is now, and whether the rig has moved.
    #[command(
        after_help = "Examples:\n  slcal rectify --rig rig.json --pattern checker.json -o straight.png    (project it, photograph it)\n  \
                            slcal verify --rig rig.json --pattern checker.json photo.jpg\n  \
                            slcal verify --rig rig.json --pattern checker.json --as-drawn photo.jpg --fail-if-moved"
    )]
    Verify(VerifyArgs),
    /// Find the projected stripes in a photograph.
    #[command(
        after_help = "Example:\n  slcal decode --pattern stripes.json object.jpg -o matches.csv --overlay seen.png\n\n\
                            matches.csv: u,v,projector_column,slit,confidence,sigma_px; one row per stripe and image row."
    )]
    Decode(DecodeArgs),
    /// Turn matches of any decoder into points.
    #[command(after_help = "Example:\n  slcal triangulate --rig rig.json matches.csv -o cloud.ply\n\n\
                            The table needs the columns u, v and projector_column or projector_row (or both).")]
    Triangulate(TriangulateArgs),
    /// Photographs of an object under the stripes in, point clouds out.
    #[command(
        after_help = "Examples:\n  slcal reconstruct --rig rig.json --pattern stripes.json object.jpg -o cloud.ply --mesh\n  \
                            slcal reconstruct --rig rig.json --pattern stripes.json *.jpg --out-dir clouds --resume\n  \
                            ffmpeg -i scan.mkv -f rawvideo -pix_fmt rgb24 - | slcal reconstruct --rig rig.json \\\n    \
                            --pattern stripes.json --raw 1280x960:rgb24 --out-dir clouds"
    )]
    Reconstruct(ReconstructArgs),
    /// Fit a plane or a sphere to a cloud and say how far the points lie from it.
    #[command(after_help = "Example:\n  slcal evaluate plane cloud.ply")]
    Evaluate(EvaluateArgs),
    /// Show a rig, and a cloud that was made with it, as one HTML file.
    #[command(after_help = "Examples:\n  slcal report --rig rig.json -o report.html\n  \
                            slcal report --rig rig.json --pattern checker.json --photo sheet.jpg --cloud cloud.ply -o report.html\n\n\
                            The file needs no network and no other file: open it in a browser, send it, print it. What is not at \
                            hand\nis left out, and the report says so.")]
    Report(ReportArgs),
    /// Experiments on rigs whose truth is known.
    #[command(subcommand)]
    Simulate(SimulateVerb),
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;
    use nalgebra::Point2;

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
        assert_eq!(args.camera_pp, PrincipalPointArg::At(Point2::new(-3.0, 4.0)));
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
