//! `slcal simulate scene`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use nalgebra::Point2;
use slcal_core::photo::Encoding;

use super::devices::DeviceArgs;
use super::rig::RigArgs;
use super::values::{Distortion, PoseArg, numbers, parse_distortion, parse_pose};
use crate::args::headings::{INPUT, OUTPUT, SETTINGS};
use crate::args::value::{parse_encoding, parse_length, parse_point};

#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// Surface in the scene: plane, sphere, step (a wall with two blocks in front of it), sheet (of --size), or a mesh.
    #[arg(long, value_name = "plane|sphere|step|sheet|FILE.ply|FILE.obj", default_value = "plane",
          help_heading = SETTINGS)]
    pub(crate) surface: PathBuf,
    /// Projected pattern: stripes or checker as `slcal pattern` draws them, or a pattern file [default: checker for a
    /// sheet, stripes otherwise].
    #[arg(long, value_name = "stripes|checker|FILE.json", help_heading = INPUT)]
    pub(crate) pattern: Option<PathBuf>,
    /// Folder for all files; created when it does not exist.
    #[arg(long, value_name = "DIR", help_heading = OUTPUT)]
    pub(crate) out: PathBuf,
    /// Rig file, instead of the options under "Rig" (--distance, --size and --bend still place the surface).
    #[arg(long, value_name = "RIG.json",
          conflicts_with_all = ["camera", "focal", "pixel_aspect", "projector", "projector_focal", "projector_pixel_aspect",
                                "projector_offset", "projector_distortion", "lens_shift", "baseline", "distortion"],
          help_heading = INPUT)]
    pub(crate) rig: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) of_rig: RigArgs,
    /// Distortion coefficients of the camera; missing ones are zero.
    #[arg(long, value_name = "k1,k2,p1,p2,k3", value_parser = parse_distortion, default_value = "0",
          help_heading = "Rig", allow_hyphen_values = true)]
    pub(crate) distortion: Distortion,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    #[command(flatten)]
    pub(crate) devices: DeviceArgs,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

/// Where the surface stands.
#[derive(Debug, Args)]
#[command(next_help_heading = "Surface")]
pub(crate) struct PlaceArgs {
    /// Tilt about the horizontal and vertical axis of the camera and, optionally, roll, degrees [default: 10,20 for a
    /// plane, 25,28 for a sheet, otherwise none].
    #[arg(long, value_name = "X,Y[,ROLL]", value_parser = parse_pose, allow_hyphen_values = true)]
    pub(crate) tilt: Option<PoseArg>,
    /// Offset of the middle of the surface to the right of and below the optical axis of the camera, mm.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, default_value = "0,0",
          allow_hyphen_values = true)]
    pub(crate) aside: Point2<f64>,
    /// Radius of the sphere [default: 0.18 of the distance].
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub(crate) radius: Option<f64>,
    /// Thickness of the sheet: a foam board whose side faces have the albedo of its front and stand behind it [default: none].
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, allow_hyphen_values = true)]
    pub(crate) thickness: Option<f64>,
    /// Albedo of the surface: grey, or red,green,blue.
    #[arg(long, value_name = "A|R,G,B", value_parser = parse_channels, default_value = "0.9",
          allow_hyphen_values = true)]
    pub(crate) albedo: Channels,
    /// Distance of a wall behind the middle of the surface, parallel to it [default: close behind a sphere or a mesh].
    #[arg(long, value_name = "MM|none", value_parser = parse_wall, allow_hyphen_values = true)]
    pub(crate) wall: Option<WallArg>,
    /// Albedo of the wall, grey.
    #[arg(long, value_name = "A", default_value_t = 0.4, allow_hyphen_values = true)]
    pub(crate) wall_albedo: f64,
    /// Frame of the mesh: object (y up, z towards the viewer; its middle is moved to the distance) or camera (used as
    /// it is).
    #[arg(long, value_enum, default_value = "object")]
    pub(crate) mesh_frame: MeshFrameArg,
    /// Factor for the coordinates of the mesh, when they are not millimetres.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_hyphen_values = true)]
    pub(crate) mesh_scale: f64,
}

/// Light, lens, sensor.
#[derive(Debug, Args)]
#[command(next_help_heading = "Photograph")]
pub(crate) struct LightArgs {
    /// No noise, no blur, 16 bit.
    #[arg(long, conflicts_with_all = ["noise", "blur", "bits"])]
    pub(crate) exact: bool,
    /// σ of the noise, grey levels of 255.
    #[arg(long, value_name = "LEVELS", default_value_t = 1.0, allow_hyphen_values = true)]
    pub(crate) noise: f64,
    /// σ of the blur of the camera, px.
    #[arg(long, value_name = "PX", default_value_t = 0.6, allow_hyphen_values = true)]
    pub(crate) blur: f64,
    /// σ of the blur of the projector, panel px.
    #[arg(long, value_name = "PX", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) projector_blur: f64,
    /// Light of the projector where it shows black, as a share of full light.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) projector_black: f64,
    /// Share of light that each channel gets from its neighbours (red, green, blue), or nine numbers.
    ///
    /// The nine numbers are a matrix by rows, beginning with the red of the camera.
    #[arg(long, value_name = "SHARE|RR,RG,RB,GR,..,BB", value_parser = parse_crosstalk, default_value = "0",
          allow_hyphen_values = true)]
    pub(crate) crosstalk: Crosstalk,
    /// Ambient light as a share of the projector light: grey, or red,green,blue.
    #[arg(long, value_name = "A|R,G,B", value_parser = parse_channels, default_value = "0.03",
          allow_hyphen_values = true)]
    pub(crate) ambient: Channels,
    /// Brightness of a white surface that faces the projector under full light, as a share of full scale; above 1 it
    /// saturates.
    #[arg(long, value_name = "SHARE", default_value_t = 0.8, allow_hyphen_values = true)]
    pub(crate) exposure: f64,
    /// Bits per sample, 8 or 16.
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub(crate) bits: u8,
    /// Seed of the noise: the same seed gives the same output.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    /// Encoding of the photograph: srgb, linear, or an exponent from 0.1 to 10.
    #[arg(long, value_name = "srgb|linear|N", value_parser = parse_encoding, default_value_t,
          allow_hyphen_values = true)]
    pub(crate) gamma: Encoding,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeshFrameArg {
    /// Its own.
    Object,
    /// The camera's.
    Camera,
}

/// A wall, mm behind the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WallArg(pub(crate) Option<f64>);

/// Red, green, blue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Channels(pub(crate) [f64; 3]);

/// Channels of the camera by channels of the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Crosstalk {
    /// A share for neighbours.
    Neighbours(f64),
    /// All of it.
    Matrix([[f64; 3]; 3]),
}

fn parse_wall(text: &str) -> Result<WallArg, String> {
    if text == "none" {
        return Ok(WallArg(None));
    }
    match numbers(text).as_deref() {
        Some(&[mm]) if mm > 0.0 => Ok(WallArg(Some(mm))),
        _ => Err("expected a distance above zero in mm, or none".to_owned()),
    }
}

fn parse_channels(text: &str) -> Result<Channels, String> {
    match numbers(text).as_deref() {
        Some(&[a]) => Ok(Channels([a; 3])),
        Some(&[r, g, b]) => Ok(Channels([r, g, b])),
        _ => {
            Err("expected one number for grey or three for red, green and blue, such as 0.7,0.35,0.25"
                .to_owned())
        }
    }
}

fn parse_crosstalk(text: &str) -> Result<Crosstalk, String> {
    match numbers(text).as_deref() {
        Some(&[share]) if share >= 0.0 => Ok(Crosstalk::Neighbours(share)),
        Some(&[a, b, c, d, e, f, g, h, i]) => Ok(Crosstalk::Matrix([[a, b, c], [d, e, f], [g, h, i]])),
        _ => Err("expected one share of zero or more, such as 0.2, or nine numbers: what red gets of red, green, blue, what green gets, \
                  what blue gets"
            .to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_scenes() {
        assert_eq!(parse_wall("none"), Ok(WallArg(None)));
        assert_eq!(parse_wall("20"), Ok(WallArg(Some(20.0))));
        assert!(parse_wall("far").is_err() && parse_wall("-3").is_err());
        assert_eq!(parse_channels("0.5"), Ok(Channels([0.5; 3])));
        assert_eq!(parse_channels("0.7,0.35,0.25"), Ok(Channels([0.7, 0.35, 0.25])));
        assert!(parse_channels("1,2").is_err() && parse_channels("a").is_err());
        assert_eq!(parse_crosstalk("0.2"), Ok(Crosstalk::Neighbours(0.2)));
        let Ok(Crosstalk::Matrix(m)) = parse_crosstalk("1,2,3,4,5,6,7,8,9") else { panic!("nine numbers") };
        assert_eq!(m[1], [4.0, 5.0, 6.0]);
        assert!(parse_crosstalk("1,2,3").is_err() && parse_crosstalk("-0.5").is_err());
    }
}
