//! `slcal pattern`: draws the picture to project and writes its description.

use image::{DynamicImage, RgbImage};
use slcal_core::format::write_pattern;
use slcal_core::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};

use crate::args::{CheckerArgs, PatternOutput, PatternVerb, StripesArgs};
use crate::exit::{Failure, Outcome};
use crate::io::{Destination, bytes_of, is_dash, png_bytes, write_all};
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
        marks: args.marks,
        ..CheckerConfig::default()
    };
    let pattern = CheckerPattern::new(args.projector, &config)?;
    let picture = pattern.image()?;
    places.write(picture, &Pattern::Checker(pattern), "slcal calibrate", printer)
}

fn stripes(args: &StripesArgs, printer: Printer) -> Outcome {
    let places = Places::prepare(&args.to)?;
    let config = StripeConfig {
        hues: args.hues,
        order: args.order,
        slits: args.slits,
        axis: args.axis,
        ..StripeConfig::default()
    };
    let pattern = StripePattern::new(args.projector, &config)?;
    let picture = pattern.image()?;
    places.write(picture, &Pattern::Stripes(pattern), "slcal reconstruct", printer)
}

/// Destinations of the picture and its description.
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

    fn write(self, picture: RgbImage, pattern: &Pattern, reader: &str, printer: Printer) -> Outcome {
        let busy = printer.busy("writing the picture");
        let (width, height) = picture.dimensions();
        let png = self.picture.name();
        let mut files = vec![(self.picture, png_bytes(&DynamicImage::ImageRgb8(picture))?)];
        let mut notes = Vec::new();
        if let Some(description) = self.description {
            notes.push(format!("{png}: the picture to project, {width}x{height} pixels. {SHOW}"));
            notes.push(format!(
                "{}: the description of the picture; {reader} reads it (--pattern)",
                description.name()
            ));
            files.push((description, bytes_of(|out| write_pattern(pattern, out))?));
        } else {
            notes.push(
                "stdout takes the picture alone; give -o FILE.png to get its description as well".into(),
            );
        }
        write_all(&files)?;
        drop(busy);
        for note in &notes {
            printer.note(note);
        }
        Ok(())
    }
}

/// How to show a picture without scaling.
const SHOW: &str = if cfg!(target_os = "macos") {
    "Show it full screen and unscaled on the projector: open it in Preview and press Control-Command-F"
} else {
    "Show it full screen and unscaled on the projector: open it in an image viewer or browser and press F11"
};
