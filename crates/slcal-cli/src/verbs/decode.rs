//! `slcal decode`: from a photograph of stripes to matches.

use std::path::{Path, PathBuf};

use image::DynamicImage;
use slcal_core::decode::{DecodeConfig, DecodeInput, Decoding, decode};
use slcal_core::format::write_matches;
use slcal_core::photo::PhotoView;

use crate::args::{self, DecodeArgs};
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{
    Destination, bytes_of, check_distinct, check_json, check_panel, check_spares, input_name, is_dash,
    load_photo, load_rig, load_stripes, png_bytes, write_all,
};
use crate::output::{Printer, print_json};
use crate::picture::{for_display, stripes};
use crate::summary;

pub(super) fn run(args: &DecodeArgs, printer: Printer) -> Outcome {
    let [image] = args.images.as_slice() else {
        return Err(Failure::usage(format!(
            "expected one photograph of stripes, found {}; the frames of a sequence need its pattern",
            args.images.len()
        )));
    };
    let output = Destination::prepare(&args.output, args.force)?;
    let overlay = Destination::prepare_overlay(args.overlay.as_ref(), args.force)?;
    check_distinct([&output].into_iter().chain(&overlay))?;
    let read = args.input.files().chain([image.as_path()]).chain(args.rig.as_deref());
    check_spares([&output].into_iter().chain(&overlay), read)?;
    check_json(args.json, &output)?;
    let pattern = load_stripes(&args.input.pattern)?;
    let rig = args.rig.as_ref().map(|path| Ok::<_, Failure>((path, load_rig(path)?))).transpose()?;
    if let Some((path, rig)) = &rig {
        check_panel(&args.input.pattern, pattern.projector, path, rig)?;
    }
    let busy = printer.busy(format!("decoding {}", input_name(image)));
    let frames = References::load(&args.input, printer)?;
    let photo = load_photo(image, args.input.gamma.samples(), printer)?;
    if let Some((_, rig)) = &rig {
        rig.check_photo_size([photo.width() as usize, photo.height() as usize]).in_file(image)?;
    }
    let mirrored = args.input.mirror.mirror || rig.as_ref().is_some_and(|(_, rig)| rig.is_mirrored());
    let registration = rig.and_then(|(_, rig)| rig.channel_registration);
    let config = DecodeConfig { mirrored, registration, ..frames.config };
    let decoding = decode(frames.input(image, &photo)?, &pattern, &config).in_file(image)?;

    let bytes = bytes_of(|out| write_matches(&decoding.matches, out))?;
    let mut files = vec![(output.clone(), bytes)];
    if let Some(place) = overlay {
        files
            .push((place, draw(&for_display(photo, frames.config.encoding), &input_name(image), &decoding)?));
    }
    write_all(&files)?;
    drop(busy);

    if args.json {
        return print_json(&decoding.report.to_json());
    }
    printer.summary(&summary::decoding(&decoding.report), output == Destination::Stdout)
}

/// The photographs with the projector dark and white, and the configuration of the decoder.
pub(super) struct References {
    black: Option<(PathBuf, DynamicImage)>,
    white: Option<(PathBuf, DynamicImage)>,
    config: DecodeConfig,
}

impl References {
    pub(super) fn load(input: &args::DecodeInput, printer: Printer) -> Outcome<Self> {
        let load = |path: &PathBuf| {
            if is_dash(path) {
                return Err(Failure::usage("only the striped photograph can come from stdin (-)"));
            }
            Ok((path.clone(), load_photo(path, input.gamma.samples(), printer)?))
        };
        let (encoding, mirrored) = (input.gamma.encoding(), input.mirror.mirror);
        let config = DecodeConfig { encoding, mirrored, ..DecodeConfig::default() };
        config.validate()?;
        Ok(Self {
            black: input.black.as_ref().map(load).transpose()?,
            white: input.white.as_ref().map(load).transpose()?,
            config,
        })
    }

    pub(super) fn config(&self) -> DecodeConfig {
        self.config
    }

    /// All photographs of one scene; `photo` shows the stripes.
    pub(super) fn input<'a>(&'a self, path: &Path, photo: &'a DynamicImage) -> Outcome<DecodeInput<'a>> {
        self.around(PhotoView::try_from(photo).in_file(path)?)
    }

    /// The same for the pixels of the striped photograph.
    pub(super) fn around<'a>(&'a self, photo: PhotoView<'a>) -> Outcome<DecodeInput<'a>> {
        let [black, white] = [&self.black, &self.white].map(|frame| view(frame.as_ref(), &photo));
        Ok(DecodeInput { photo, black: black?, white: white? })
    }
}

/// A frame that must be as large as the striped photograph.
fn view<'a>(
    frame: Option<&'a (PathBuf, DynamicImage)>,
    photo: &PhotoView<'_>,
) -> Outcome<Option<PhotoView<'a>>> {
    let Some((file, picture)) = frame else { return Ok(None) };
    let view = PhotoView::try_from(picture).in_file(file)?;
    let [[w, h], expected] = [&view, photo].map(|v| [v.width(), v.height()]);
    if [w, h] == expected {
        return Ok(Some(view));
    }
    let expected = format!("expected the size of the striped photograph, {}x{} px", expected[0], expected[1]);
    Err(Failure::input(file, format!("{expected}, found {w}x{h} px; take it with the same camera")))
}

/// The matches drawn on the photograph, as PNG.
fn draw(photo: &DynamicImage, name: &str, decoding: &Decoding) -> Outcome<Vec<u8>> {
    let size = [photo.width(), photo.height()];
    png_bytes(&stripes::decoded(size, name, decoding).over(photo)?)
}
