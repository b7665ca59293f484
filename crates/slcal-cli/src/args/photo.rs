//! What is said about photographs.

use clap::Args;
use slcal_core::photo::Encoding;

use crate::similar::did_you_mean;

/// How code values become light.
#[derive(Debug, Args)]
pub(crate) struct GammaArg {
    /// Encoding of the photographs: srgb, linear (raw conversions, many 16 bit files) or an exponent.
    #[arg(long, value_name = "srgb|linear|N", value_parser = parse_encoding, default_value = "srgb",
          allow_hyphen_values = true)]
    pub(crate) gamma: Encoding,
}

fn parse_encoding(text: &str) -> Result<Encoding, String> {
    let encoding = match text {
        "srgb" => Encoding::Srgb,
        "linear" => Encoding::Linear,
        number => Encoding::Gamma(number.parse().map_err(|_| {
            let meant = did_you_mean(number, ["srgb", "linear"]);
            format!("{meant}expected srgb, linear or a number from 0.1 to 10")
        })?),
    };
    encoding.validate().map_err(|e| e.to_string())?;
    Ok(encoding)
}
