//! What is said about photographs.

use clap::Args;
use slcal_core::photo::Encoding;

use super::headings::INPUT;
use super::value::parse_encoding;
use crate::io::Samples;

/// Which way round the projector's pictures are seen.
#[derive(Debug, Args)]
pub(crate) struct MirrorArg {
    /// The projector's pictures appear mirrored, left and right exchanged: rear projection, or a mirror in the light.
    ///
    /// Column c of the pattern counts as column width - 1 - c. A rig that was calibrated so says it (projector.mirrored); with it
    /// the option is not needed.
    #[arg(long, help_heading = INPUT)]
    pub(crate) mirror: bool,
}

/// How code values become light.
#[derive(Debug, Args)]
pub(crate) struct GammaArg {
    /// Encoding of the photographs: srgb, linear, or an exponent from 0.1 to 10. Default: what the file says, else srgb.
    ///
    /// Raw conversions and many 16-bit files are linear. A PNG says so by its chunks cICP, iCCP and gAMA, other files by
    /// their colour profile. With this option samples are taken as they are stored.
    #[arg(long, value_name = "srgb|linear|N", value_parser = parse_encoding,
          allow_hyphen_values = true, help_heading = INPUT)]
    gamma: Option<Encoding>,
}

impl GammaArg {
    /// The encoding of photographs once they are read.
    pub(crate) fn encoding(&self) -> Encoding {
        self.gamma.unwrap_or_default()
    }

    /// How they are read.
    pub(crate) fn samples(&self) -> Samples {
        if self.gamma.is_some() { Samples::AsStored } else { Samples::AsFileSays }
    }
}
