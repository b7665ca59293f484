//! What is said about photographs.

use clap::Args;
use slcal_core::photo::Encoding;

use super::headings::INPUT;
use super::value::parse_encoding;

/// How code values become light.
#[derive(Debug, Args)]
pub(crate) struct GammaArg {
    /// Encoding of the photographs: srgb, linear, or an exponent from 0.1 to 10.
    ///
    /// Raw conversions and many 16-bit files are linear.
    #[arg(long, value_name = "srgb|linear|N", value_parser = parse_encoding, default_value_t,
          allow_hyphen_values = true, help_heading = INPUT)]
    pub(crate) gamma: Encoding,
}
