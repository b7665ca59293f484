//! What real projectors and cameras do to light and values: options of `slcal simulate scene`.

use clap::Args;
use slcal_core::simulate::{Demosaic, Flicker, RenderConfig, Sharpen};

use super::values::numbers;
use crate::args::value::choice;

/// Real projectors and cameras.
#[derive(Debug, Args)]
#[command(next_help_heading = "Real projector and camera")]
pub(crate) struct DeviceArgs {
    /// Light of the projector is value^G [default: the curve of sRGB].
    #[arg(long, value_name = "G", allow_hyphen_values = true)]
    pub(crate) projector_gamma: Option<f64>,
    /// Share of its light that the projector loses in the corners of its panel.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) projector_falloff: f64,
    /// The pictures of the projector appear mirrored, left and right exchanged.
    #[arg(long)]
    pub(crate) mirror: bool,
    /// Columns and rows by which the red and the blue panel of the projector lie beside the green one, panel px: red light of
    /// panel position p falls where green light of p + (RX,RY) falls. The true rig is that of green.
    #[arg(long, value_name = "RX,RY,BX,BY", value_parser = parse_channel_shift, default_value = "0,0,0,0",
          allow_hyphen_values = true)]
    pub(crate) channel_shift: ChannelShift,
    /// Lateral colour of the lens of the camera for red and blue: what green shows at u, red shows at c + (u - c)(1 + R), with
    /// c the principal point.
    #[arg(long, value_name = "R,B", value_parser = parse_lateral_colour, default_value = "0,0",
          allow_hyphen_values = true)]
    pub(crate) lateral_colour: LateralColour,
    /// Share of its light that the camera loses in the corners of the picture; it falls with the square of the distance from
    /// the middle.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) vignetting: f64,
    /// Rows darkened by mains flicker: row y gets 1 - A/2 + A/2 sin(2 pi y / PERIOD) of its light.
    #[arg(long, value_name = "AMOUNT,PERIOD_PX", value_parser = parse_flicker, allow_hyphen_values = true)]
    pub(crate) flicker: Option<Flicker>,
    /// A sensor with a Bayer mosaic (RGGB, red at the top left), and how the camera fills it in. The noise is that of the samples of
    /// the sensor [default: three samples per pixel].
    #[arg(long, value_name = "METHOD", value_parser = choice::<Demosaic>(Demosaic::NAMES))]
    pub(crate) demosaic: Option<Demosaic>,
    /// Strength of an S-shaped tone curve, 0 to 1: an encoded value v becomes v + S(3v^2 - 2v^3 - v).
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) tone: f64,
    /// Sharpening: AMOUNT times what a Gaussian of σ RADIUS px takes away from the luma of the encoded picture is added to all
    /// channels.
    #[arg(long, value_name = "AMOUNT,RADIUS", value_parser = parse_sharpen, allow_hyphen_values = true)]
    pub(crate) sharpen: Option<Sharpen>,
    /// Write the photographs as JPEG of this quality, 1 to 100, with colour at half the resolution (4:2:0) [default: PNG].
    #[arg(long, value_name = "QUALITY", conflicts_with = "exact")]
    pub(crate) jpeg: Option<u8>,
}

impl DeviceArgs {
    /// Switches these effects on.
    pub(crate) fn apply(&self, render: &mut RenderConfig) {
        render.projector_gamma = self.projector_gamma;
        render.projector_falloff = self.projector_falloff;
        render.channel_shift_px = self.channel_shift.0;
        render.lateral_colour = self.lateral_colour.0;
        render.vignetting = self.vignetting;
        render.flicker = self.flicker;
        render.demosaic = self.demosaic;
        render.tone = self.tone;
        render.sharpen = self.sharpen;
        render.jpeg_quality = self.jpeg;
    }
}

/// Columns and rows of red and of blue, panel px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ChannelShift(pub(crate) [[f64; 2]; 2]);

/// Of red and of blue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LateralColour(pub(crate) [f64; 2]);

fn parse_channel_shift(text: &str) -> Result<ChannelShift, String> {
    match numbers(text).as_deref() {
        Some(&[rx, ry, bx, by]) => Ok(ChannelShift([[rx, ry], [bx, by]])),
        _ => Err("expected four finite numbers: columns and rows of red, columns and rows of blue, such as \
                  0.5,-0.3,-0.4,0.5"
            .to_owned()),
    }
}

fn pair(text: &str, example: &str) -> Result<[f64; 2], String> {
    match numbers(text).as_deref() {
        Some(&[a, b]) => Ok([a, b]),
        _ => Err(format!("expected two finite numbers, such as {example}")),
    }
}

fn parse_lateral_colour(text: &str) -> Result<LateralColour, String> {
    pair(text, "0.0006,-0.0005").map(LateralColour)
}

fn parse_flicker(text: &str) -> Result<Flicker, String> {
    pair(text, "0.3,170").map(|[amount, period_px]| Flicker { amount, period_px })
}

fn parse_sharpen(text: &str) -> Result<Sharpen, String> {
    pair(text, "0.6,1").map(|[amount, radius_px]| Sharpen { amount, radius_px })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_effects() {
        let shift = parse_channel_shift("0.5,-0.3,-0.4, 0.5");
        assert_eq!(shift, Ok(ChannelShift([[0.5, -0.3], [-0.4, 0.5]])));
        assert_eq!(parse_lateral_colour("6e-4,-5e-4"), Ok(LateralColour([6e-4, -5e-4])));
        assert_eq!(parse_flicker("0.6,170"), Ok(Flicker { amount: 0.6, period_px: 170.0 }));
        assert_eq!(parse_sharpen("0.6,1"), Ok(Sharpen { amount: 0.6, radius_px: 1.0 }));
        for text in ["", "1", "1,2,3", "1,nan", "a,b"] {
            assert!(parse_channel_shift(text).is_err() && parse_lateral_colour(text).is_err(), "{text}");
            assert!(parse_flicker(text).is_err() && parse_sharpen(text).is_err(), "{text}");
        }
    }
}
