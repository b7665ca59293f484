//! `slcal pattern`: draws what is to be projected, and its description beside it.

use image::{DynamicImage, RgbImage};
use slcal_core::format::write_pattern;
use slcal_core::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};

use crate::args::{CheckerArgs, PatternOutput, PatternVerb, StripesArgs};
use crate::exit::{Failure, Outcome};
use crate::io::{Destination, is_dash, png_bytes, write_all};
use crate::output::Printer;

pub(super) fn run(verb: PatternVerb, printer: Printer) -> Outcome {
    match verb {
        PatternVerb::Checker(args) => checker(&args, printer),
        PatternVerb::Stripes(args) => stripes(&args, printer),
    }
}

fn checker(args: &CheckerArgs, printer: Printer) -> Outcome {
    let places = Places::prepare(&args.to)?;
    let config = CheckerConfig {
        squares: args.squares,
        square_px: args.square.map(f64::from),
        ..CheckerConfig::default()
    };
    let pattern = CheckerPattern::new(args.projector, &config)?;
    let picture = pattern.image()?;
    places.write(picture, &Pattern::Checker(pattern), printer)
}

fn stripes(args: &StripesArgs, printer: Printer) -> Outcome {
    let places = Places::prepare(&args.to)?;
    let config =
        StripeConfig { hues: args.hues, order: args.order, slits: args.slits, ..StripeConfig::default() };
    let pattern = StripePattern::new(args.projector, &config)?;
    let picture = pattern.image()?;
    places.write(picture, &Pattern::Stripes(pattern), printer)
}

/// Where the picture and its description go.
struct Places {
    picture: Destination,
    description: Option<Destination>,
}

impl Places {
    fn prepare(to: &PatternOutput) -> Outcome<Self> {
        let is_png = to.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        if !is_png && !is_dash(&to.output) {
            return Err(Failure::usage(format!(
                "{}: expected an output whose name ends in .png (the description goes beside it, ending in .json), or -",
                to.output.display()
            )));
        }
        let picture = Destination::prepare(&to.output, to.force)?;
        let description = picture.beside("json")?;
        Ok(Self { picture, description })
    }

    fn write(self, picture: RgbImage, pattern: &Pattern, printer: Printer) -> Outcome {
        let busy = printer.busy("writing the picture");
        let mut files = vec![(self.picture, png_bytes(&DynamicImage::ImageRgb8(picture))?)];
        if let Some(description) = self.description {
            files.push((description, pattern_bytes(pattern)?));
        } else {
            printer
                .note("the picture alone goes to stdout; give -o FILE.png to have its description as well");
        }
        write_all(&files)?;
        drop(busy);
        for (place, _) in &files {
            printer.detail(format!("wrote {}", place.name()));
        }
        Ok(())
    }
}

/// The pattern file.
pub(super) fn pattern_bytes(pattern: &Pattern) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    write_pattern(pattern, &mut bytes)?;
    Ok(bytes)
}
