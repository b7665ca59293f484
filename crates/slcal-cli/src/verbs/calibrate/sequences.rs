//! Poses under a sequence: the photographs of a folder are decoded together.

use std::path::Path;

use image::DynamicImage;
use slcal_core::decode::{SequenceDecodeConfig, SequenceDecoder, SequenceDecoding};
use slcal_core::pattern::{Axis, FrameLight};
use slcal_core::photo::PhotoView;
use slcal_core::{DenseMatches, PhotoTags, SequencePattern};

use crate::args::CalibrateArgs;
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{input_name, load_tagged_photo, sequence_files};
use crate::output::Printer;

/// Reads poses one after another.
pub(super) struct SequencePoses {
    pattern: SequencePattern,
    /// Which picture is white.
    white: usize,
    decoder: SequenceDecoder,
}

/// What is left of the photographs of a pose.
pub(super) struct SequencePose {
    pub(super) white: DynamicImage,
    pub(super) tags: Result<PhotoTags, String>,
    pub(super) matches: DenseMatches,
}

impl SequencePoses {
    /// `path` is the file of the pattern.
    pub(super) fn new(path: &Path, pattern: &SequencePattern, mirrored: bool) -> Outcome<Self> {
        let coded = [Axis::Columns, Axis::Rows].map(|axis| pattern.code(axis).is_some());
        if coded != [true, true] {
            let found = if coded[0] { "columns" } else { "rows" };
            let message = format!(
                "expected a sequence of columns and rows, as calibration needs both, found {found} alone; draw one with \
                 `slcal pattern gray --axis both`"
            );
            return Err(Failure::input(path, message));
        }
        let white = pattern.frames.iter().position(|f| f.light == FrameLight::White);
        let white = white.ok_or_else(|| {
            let message = "expected a sequence with a white picture, in whose photograph the sheet is found, found none";
            Failure::input(path, message)
        })?;
        let mut config = SequenceDecodeConfig::default();
        config.mirrored = mirrored;
        let decoder = SequenceDecoder::new(pattern, config).in_file(path)?;
        Ok(Self { pattern: pattern.clone(), white, decoder })
    }

    /// Reads and decodes the photographs in a folder, one at a time.
    pub(super) fn read(
        &mut self,
        folder: &Path,
        args: &CalibrateArgs,
        printer: Printer,
    ) -> Outcome<SequencePose> {
        let files = sequence_files(folder, &self.pattern)?;
        self.decoder.clear();
        let mut kept = None;
        for frame in self.decoder.reading_order().to_vec() {
            let Some(file) = files.get(frame) else { continue };
            let (photo, tags) = load_tagged_photo(file, args.gamma.samples(), printer)?;
            self.decoder.push(frame, PhotoView::try_from(&photo).in_file(file)?).in_file(file)?;
            if frame == self.white {
                kept = Some((photo, tags));
            }
        }
        let SequenceDecoding { matches, report, .. } = self.decoder.finish().in_file(folder)?;
        printer.detail(format!(
            "{}: {} of {} lit pixels have a place on the panel",
            input_name(folder),
            report.decoded,
            report.lit
        ));
        let (white, tags) =
            kept.ok_or_else(|| Failure::input(folder, "no photograph of the white picture"))?;
        Ok(SequencePose { white, tags, matches })
    }
}
