//! The command line as it is typed; what it means is decided by the verbs.

use std::path::{Path, PathBuf};

use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use nalgebra::Point2;
use slcal_core::geometry::RectangleSize;
use slcal_core::photo::Encoding;

use crate::size::{Corners, parse_corners, parse_pair, parse_point, parse_size};

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
        after_help = "Example:\n  slcal calibrate photo.jpg --size A2-landscape --pattern checker.json -o rig.json\n\n\
                            The width is the side that runs most nearly along the image's x axis. Without --pattern the \
                            camera alone\nis calibrated."
    )]
    Calibrate(CalibrateArgs),
    /// Draw the picture that appears as an upright rectangle on the sheet.
    #[command(
        after_help = "Examples:\n  slcal rectify --rig rig.json --pattern checker.json -o straight.png\n  \
                            slcal rectify --rig rig.json --image poster.jpg -o straight.png"
    )]
    Rectify(RectifyArgs),
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
                            slcal reconstruct --rig rig.json --pattern stripes.json *.jpg --out-dir clouds"
    )]
    Reconstruct(ReconstructArgs),
    /// Fit a plane or a sphere to a cloud and say how far the points lie from it.
    #[command(after_help = "Example:\n  slcal evaluate plane cloud.ply")]
    Evaluate(EvaluateArgs),
}

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Where to put the files; made when it does not exist.
    #[arg(long, value_name = "DIR", default_value = "slcal-demo")]
    pub(crate) out: PathBuf,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum PatternVerb {
    /// The checkerboard that calibration needs.
    #[command(
        after_help = "Example:\n  slcal pattern checker --projector 1024x768 -o checker.png\n\nwrites checker.png, to \
                            be shown full screen at the projector's native resolution, and checker.json."
    )]
    Checker(CheckerArgs),
    /// The coloured stripes that reconstruction needs.
    #[command(
        after_help = "Example:\n  slcal pattern stripes --projector 1024x768 -o stripes.png\n\nwrites stripes.png, to \
                            be shown full screen at the projector's native resolution, and stripes.json."
    )]
    Stripes(StripesArgs),
}

#[derive(Debug, Args)]
pub(crate) struct PatternOutput {
    /// The picture, a PNG; the description goes beside it with the ending .json. `-` writes the picture alone to stdout.
    #[arg(short, long, value_name = "FILE.png")]
    pub(crate) output: PathBuf,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckerArgs {
    /// The projector's native resolution.
    #[arg(long, value_name = "WxH", value_parser = parse_pair)]
    pub(crate) projector: [u32; 2],
    /// Columns and rows of squares; their sum must be odd.
    #[arg(long, value_name = "CxR", value_parser = parse_pair, default_value = "11x8")]
    pub(crate) squares: [u32; 2],
    /// Side of a square in projector pixels [default: a sixteenth of the panel's height].
    #[arg(long, value_name = "PX", allow_hyphen_values = true)]
    pub(crate) square: Option<u32>,
    #[command(flatten)]
    pub(crate) to: PatternOutput,
}

#[derive(Debug, Args)]
pub(crate) struct StripesArgs {
    /// The projector's native resolution.
    #[arg(long, value_name = "WxH", value_parser = parse_pair)]
    pub(crate) projector: [u32; 2],
    /// Number of colours.
    #[arg(long, value_name = "N", default_value_t = 4, allow_hyphen_values = true)]
    pub(crate) hues: u32,
    /// How many neighbouring stripes tell which they are.
    #[arg(long, value_name = "M", default_value_t = 3, allow_hyphen_values = true)]
    pub(crate) order: u32,
    /// Number of stripes [default: 64, or as many as the colours and the order allow].
    #[arg(long, value_name = "K", allow_hyphen_values = true)]
    pub(crate) slits: Option<u32>,
    #[command(flatten)]
    pub(crate) to: PatternOutput,
}

/// How code values become light.
#[derive(Debug, Args)]
pub(crate) struct GammaArg {
    /// Encoding of the photographs: srgb, linear (raw conversions, many 16 bit files) or an exponent.
    #[arg(long, value_name = "srgb|linear|N", value_parser = parse_encoding, default_value = "srgb",
          allow_hyphen_values = true)]
    pub(crate) gamma: Encoding,
}

/// A principal point as it is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PrincipalPointArg {
    /// Horizontal centre as a prior, vertical free.
    Shift,
    /// The centre, uncertain.
    Prior,
    /// The centre, exactly.
    Centre,
    /// Estimated without a prior.
    Free,
    /// Given, exactly.
    At(Point2<f64>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DistortionArg {
    /// Estimated when the photograph shows it.
    Auto,
    /// A lens without distortion.
    None,
    /// The first radial coefficient.
    K1,
    /// The first two radial coefficients.
    K1k2,
    /// All five coefficients.
    Full,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// Maximum likelihood over everything that was seen.
    Ml,
    /// The two vanishing points alone, as published.
    TwoVp,
}

#[derive(Debug, Args)]
pub(crate) struct CalibrateArgs {
    /// Photographs of the sheet, one per pose; `-` for stdin.
    #[arg(required = true, value_name = "PHOTO")]
    pub(crate) photos: Vec<PathBuf>,
    /// Size of the sheet: 594x420mm, 59.4x42cm, 11x8.5in, A4, A4-landscape, letter, legal …
    #[arg(long, value_name = "SIZE", value_parser = parse_size, allow_hyphen_values = true)]
    pub(crate) size: RectangleSize,
    /// The checkerboard that was projected.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) pattern: Option<PathBuf>,
    /// A photograph of the same pose with the projector dark or plain; repeat it once per PHOTO, in the same order.
    #[arg(long, value_name = "PHOTO", action = ArgAction::Append)]
    pub(crate) screen: Vec<PathBuf>,
    /// The sheet's corners "x,y x,y x,y x,y" (TL TR BR BL) by hand; repeat it once per PHOTO, in the same order.
    #[arg(long, value_name = "CORNERS", value_parser = parse_corners, allow_hyphen_values = true,
          action = ArgAction::Append)]
    pub(crate) corners: Vec<Corners>,
    /// Camera intrinsics that are known already, as a rig JSON: the rest is solved.
    #[arg(long, value_name = "RIG.json")]
    pub(crate) camera: Option<PathBuf>,
    /// The camera's principal point: prior (the centre, uncertain), centre, free, or X,Y exactly.
    #[arg(long, value_name = "prior|centre|free|X,Y", value_parser = parse_camera_pp, default_value = "prior",
          allow_hyphen_values = true, conflicts_with = "camera")]
    pub(crate) camera_pp: PrincipalPointArg,
    /// The projector's principal point: shift (horizontally near the centre, vertically anywhere), or as for the camera.
    #[arg(long, value_name = "shift|prior|centre|free|X,Y", value_parser = parse_projector_pp,
          default_value = "shift", allow_hyphen_values = true)]
    pub(crate) projector_pp: PrincipalPointArg,
    /// Lens distortion of the camera.
    #[arg(long, value_enum, default_value = "auto", conflicts_with = "camera")]
    pub(crate) distortion: DistortionArg,
    /// Which estimator.
    #[arg(long, value_enum, default_value = "ml")]
    pub(crate) method: MethodArg,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
    /// Write the rig even when the view does not determine it.
    #[arg(long)]
    pub(crate) allow_degenerate: bool,
    /// Where to write the rig; `-` for stdout.
    #[arg(short, long, value_name = "RIG.json", required_unless_present = "json")]
    pub(crate) output: Option<PathBuf>,
    /// Draw what was found on the (first) photograph, also when something was not found.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the rig as JSON instead of a summary.
    #[arg(long)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("what").required(true))]
pub(crate) struct RectifyArgs {
    /// The calibrated rig, with the sheet where it is now.
    #[arg(long, value_name = "RIG.json")]
    pub(crate) rig: PathBuf,
    /// A checkerboard to draw anew.
    #[arg(long, value_name = "FILE.json", group = "what")]
    pub(crate) pattern: Option<PathBuf>,
    /// A picture to show.
    #[arg(long, value_name = "FILE", group = "what")]
    pub(crate) image: Option<PathBuf>,
    /// The picture to project; `-` for stdout.
    #[arg(short, long, value_name = "FILE.png")]
    pub(crate) output: PathBuf,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

/// What decoding needs.
#[derive(Debug, Args)]
pub(crate) struct DecodeInput {
    /// The stripes that were projected.
    #[arg(long, value_name = "STRIPES.json")]
    pub(crate) pattern: PathBuf,
    /// The same view with the projector dark.
    #[arg(long, value_name = "IMAGE")]
    pub(crate) black: Option<PathBuf>,
    /// The same view under the projector's full white.
    #[arg(long, value_name = "IMAGE")]
    pub(crate) white: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
}

impl DecodeInput {
    /// All files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        [Some(&self.pattern), self.black.as_ref(), self.white.as_ref()]
            .into_iter()
            .flatten()
            .map(PathBuf::as_path)
    }
}

#[derive(Debug, Args)]
pub(crate) struct DecodeArgs {
    /// The photograph; `-` for stdin.
    pub(crate) image: PathBuf,
    #[command(flatten)]
    pub(crate) input: DecodeInput,
    /// Where to write the matches; `-` for stdout.
    #[arg(short, long, value_name = "MATCHES.csv")]
    pub(crate) output: PathBuf,
    /// Draw the stripes that were decoded on the photograph.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the report as JSON instead of a summary.
    #[arg(long)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FrameArg {
    /// The camera's: x right, y down, z forward.
    Camera,
    /// The sheet of the rig's first view.
    Plane,
}

/// Which triangles are removed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum CullArg {
    /// Those far larger than their neighbourhood's.
    Auto,
    /// None.
    Off,
    /// Those above an area, mm².
    Area(f64),
}

/// What the clouds are to be.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct CloudArgs {
    /// Whose coordinates the cloud has.
    #[arg(long, value_enum, default_value = "camera")]
    pub(crate) frame: FrameArg,
    /// Write the triangles between the points too.
    #[arg(long)]
    pub(crate) mesh: bool,
}

#[derive(Debug, Args)]
pub(crate) struct TriangulateArgs {
    /// The matches, a CSV table; `-` for stdin.
    pub(crate) matches: PathBuf,
    /// The calibrated rig.
    #[arg(long, value_name = "RIG.json")]
    pub(crate) rig: PathBuf,
    #[command(flatten)]
    pub(crate) shape: CloudArgs,
    /// Which triangles, and with them lone points, are removed: auto, off, or those above an area in mm².
    #[arg(long, value_name = "auto|off|MM2", value_parser = parse_cull, default_value = "off",
          allow_hyphen_values = true)]
    pub(crate) cull: CullArg,
    /// Where to write the cloud: .ply, .xyz or .obj by the name; `-` for a PLY on stdout.
    #[arg(short, long, value_name = "CLOUD.ply")]
    pub(crate) output: PathBuf,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("place").required(true))]
pub(crate) struct ReconstructArgs {
    /// Photographs of the object under the stripes; `-` for stdin.
    #[arg(required = true, value_name = "IMAGE")]
    pub(crate) images: Vec<PathBuf>,
    /// The calibrated rig.
    #[arg(long, value_name = "RIG.json")]
    pub(crate) rig: PathBuf,
    #[command(flatten)]
    pub(crate) input: DecodeInput,
    #[command(flatten)]
    pub(crate) shape: CloudArgs,
    /// Which triangles, and with them lone points, are removed: auto, off, or those above an area in mm².
    #[arg(long, value_name = "auto|off|MM2", value_parser = parse_cull, default_value = "auto",
          allow_hyphen_values = true)]
    pub(crate) cull: CullArg,
    /// Where to write the cloud of one IMAGE: .ply, .xyz or .obj by the name; `-` for a PLY on stdout.
    #[arg(short, long, value_name = "CLOUD.ply", group = "place")]
    pub(crate) output: Option<PathBuf>,
    /// Where to write the clouds, each named after its IMAGE; made when it does not exist.
    #[arg(long, value_name = "DIR", group = "place")]
    pub(crate) out_dir: Option<PathBuf>,
    /// Draw the stripes that were decoded on the photograph (one IMAGE only).
    #[arg(long, value_name = "FILE.png")]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the report as JSON instead of a summary.
    #[arg(long)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShapeArg {
    /// A plane.
    Plane,
    /// A sphere.
    Sphere,
}

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// What to fit.
    #[arg(value_enum)]
    pub(crate) shape: ShapeArg,
    /// A PLY with the points; `-` for stdin.
    pub(crate) cloud: PathBuf,
    /// Print the result as JSON instead of a summary.
    #[arg(long)]
    pub(crate) json: bool,
}

fn parse_encoding(text: &str) -> Result<Encoding, String> {
    let encoding = match text {
        "srgb" => Encoding::Srgb,
        "linear" => Encoding::Linear,
        number => Encoding::Gamma(
            number.parse().map_err(|_| "expected srgb, linear or a number from 0.1 to 10".to_owned())?,
        ),
    };
    encoding.validate().map_err(|e| e.to_string())?;
    Ok(encoding)
}

fn parse_camera_pp(text: &str) -> Result<PrincipalPointArg, String> {
    match text {
        "shift" => Err("expected prior, centre, free or X,Y (shift is for projectors)".to_owned()),
        other => parse_projector_pp(other),
    }
}

fn parse_projector_pp(text: &str) -> Result<PrincipalPointArg, String> {
    Ok(match text {
        "shift" => PrincipalPointArg::Shift,
        "prior" => PrincipalPointArg::Prior,
        "centre" | "center" => PrincipalPointArg::Centre,
        "free" => PrincipalPointArg::Free,
        point => PrincipalPointArg::At(
            parse_point(point).map_err(|e| format!("expected prior, centre, free or X,Y: {e}"))?,
        ),
    })
}

fn parse_cull(text: &str) -> Result<CullArg, String> {
    match text {
        "auto" => Ok(CullArg::Auto),
        "off" => Ok(CullArg::Off),
        number => match number.parse::<f64>() {
            Ok(area) if area.is_finite() && area > 0.0 => Ok(CullArg::Area(area)),
            _ => Err("expected auto, off or an area in mm² above zero".to_owned()),
        },
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

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
            "slcal rectify --rig r -o a.png",
        ] {
            assert!(Cli::try_parse_from(line.split(' ')).is_err(), "{line}");
        }
    }
}
