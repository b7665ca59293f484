//! `slcal pattern`: draws the pictures to project and writes their description.

use std::path::Path;

use image::{DynamicImage, RgbImage};
use slcal_core::format::write_pattern;
use slcal_core::pattern::{
    CheckerConfig, CheckerPattern, Pattern, SequenceConfig, SequencePattern, SinusoidConfig, StripeConfig,
    StripePattern,
};

use crate::args::{
    CheckerArgs, GrayArgs, PatternOutput, PatternVerb, PhaseArgs, SequenceArgs, SequenceOutput, StripesArgs,
};
use crate::exit::{Failure, Outcome};
use crate::io::{Destination, Together, bytes_of, is_dash, make_folder, png_bytes, write_all};
use crate::output::Printer;

pub(super) fn run(verb: PatternVerb, printer: Printer) -> Outcome {
    match verb {
        PatternVerb::Checker(args) => checker(&args, printer),
        PatternVerb::Stripes(args) => stripes(&args, printer),
        PatternVerb::Gray(args) => gray(&args, printer),
        PatternVerb::Phase(args) => phase(&args, printer),
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

fn gray(args: &GrayArgs, printer: Printer) -> Outcome {
    let SequenceArgs { projector, bits, .. } = args.of;
    let sequence = match args.preset {
        Some(preset) => SequencePattern::preset(projector, preset, bits)?,
        None => SequencePattern::new(projector, &sequence_config(&args.of))?,
    };
    write_sequence(sequence, &args.to, printer)
}

fn phase(args: &PhaseArgs, printer: Printer) -> Outcome {
    let sinusoid = Some(SinusoidConfig { period_px: args.period, steps: args.steps });
    let config = SequenceConfig { sinusoid, ..sequence_config(&args.of) };
    write_sequence(SequencePattern::new(args.of.projector, &config)?, &args.to, printer)
}

fn sequence_config(args: &SequenceArgs) -> SequenceConfig {
    SequenceConfig { axes: args.axis, bits: args.bits, sinusoid: None }
}

/// Writes the pictures of a sequence and their description into a folder.
fn write_sequence(mut sequence: SequencePattern, to: &SequenceOutput, printer: Printer) -> Outcome {
    if to.no_frames {
        sequence.frames.iter_mut().for_each(|frame| frame.file = None);
    }
    make_folder(&to.out_dir)?;
    let place = |name: &str| Destination::prepare(&to.out_dir.join(name), to.force);
    let names: Vec<String> = sequence.frames.iter().filter_map(|frame| frame.file.clone()).collect();
    let pictures = names.iter().map(|name| place(name)).collect::<Outcome<Vec<_>>>()?;
    let description = place("sequence.json")?;
    let described = description.name();

    let busy = printer.busy("drawing the pictures");
    let mut written = Together::default();
    for (i, picture) in pictures.into_iter().enumerate() {
        busy.say(format!("drawing picture {} of {}", i + 1, names.len()));
        written.add(picture, png_bytes(&DynamicImage::ImageLuma8(sequence.image(i)?))?)?;
    }
    let (count, [width, height]) = (sequence.frames.len(), sequence.projector);
    written.add(description, bytes_of(|out| write_pattern(&Pattern::Sequence(sequence), out))?)?;
    written.appear()?;
    drop(busy);

    let folder = to.out_dir.display();
    if let [first, .., last] = names.as_slice() {
        printer.note(format!(
            "{folder}: {count} pictures to project, {first} to {last}, {width}x{height} pixels. Show one after another full screen \
             and unscaled on the projector, in this order, and photograph each with the same exposure while nothing moves"
        ));
        if let Some(later) = later_frame(&to.out_dir, count) {
            printer.note(format!(
                "{folder}: {later} and what may follow it belong to a longer sequence that was here; remove them"
            ));
        }
    }
    printer.note(format!(
        "{described}: the description of the {count} pictures; slcal reconstruct and slcal simulate scene read it (--pattern)"
    ));
    Ok(())
}

/// The first picture of an earlier sequence that has more than `count`.
fn later_frame(folder: &Path, count: usize) -> Option<String> {
    let name = format!("frame_{count:03}.png");
    folder.join(&name).exists().then_some(name)
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
            notes.push(format!(
                "{png}: the picture to project, {width}x{height} pixels. Show it full screen and unscaled on the projector: {VIEWER}"
            ));
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
const VIEWER: &str = if cfg!(target_os = "macos") {
    "open it in Preview and press Control-Command-F"
} else {
    "open it in an image viewer or browser and press F11"
};
