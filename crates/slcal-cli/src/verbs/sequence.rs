//! Decoding and reconstruction of sequences: one photograph is in memory at a time.

use std::path::{Path, PathBuf};

use slcal_core::decode::{SequenceDecodeConfig, SequenceDecoder};
use slcal_core::format::{write_dense_matches, write_matches};
use slcal_core::pattern::{FrameLight, Pattern, SequencePattern};
use slcal_core::photo::PhotoView;

use crate::args::{self, DecodeArgs, GammaArg};
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{
    Destination, ScanFrames, bytes_of, check_distinct, check_json, check_panel, check_spares, input_name,
    is_dash, load_pattern, load_rig, png_bytes, read_photo, scans, write_all,
};
use crate::output::{Printer, Remarks, print_json};
use crate::picture::for_display;
use crate::picture::sequence::{PixelMap, UnderLight, decoded_map};
use crate::summary;

/// The sequence in a pattern file; `None` where it has another kind, cannot be read, or comes from stdin.
pub(super) fn sequence_in(pattern: &Path) -> Option<SequencePattern> {
    // What comes from stdin can be read once.
    if is_dash(pattern) {
        return None;
    }
    match load_pattern(pattern) {
        Ok(Pattern::Sequence(sequence)) => Some(sequence),
        _ => None,
    }
}

/// Refuses what only a photograph of stripes has.
pub(super) fn check_input(input: &args::DecodeInput) -> Outcome {
    let given = [("--black", input.black.is_some()), ("--white", input.white.is_some())];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => Err(Failure::usage(format!(
            "{name} belongs to a photograph of stripes; a sequence has its white and black among its frames"
        ))),
        None => Ok(()),
    }
}

/// What is read of a scan, and what is kept of it.
pub(super) struct Reading<'a> {
    pub(super) pattern: &'a SequencePattern,
    /// The order in which frames are read.
    pub(super) order: Vec<usize>,
    pub(super) gamma: &'a GammaArg,
    /// Whether the photographs under white and black are needed for pictures.
    pub(super) pictured: bool,
}

impl Reading<'_> {
    /// Hands the photographs of a scan to `take`, one after another; those under white and black as a screen shows them.
    pub(super) fn frames(
        &self,
        scan: &ScanFrames,
        remarks: &mut Remarks,
        mut take: impl FnMut(usize, PhotoView<'_>) -> slcal_core::Result<()>,
    ) -> Outcome<UnderLight> {
        let mut kept = UnderLight::default();
        for &frame in &self.order {
            let file = &scan.files[frame];
            let photo = read_photo(file, self.gamma.samples(), remarks)?;
            let view = PhotoView::try_from(&photo).in_file(file)?;
            take(frame, view).in_file(file)?;
            let place = match self.pattern.frames[frame].light {
                FrameLight::White => &mut kept.white,
                FrameLight::Black => &mut kept.black,
                FrameLight::Bit { .. } | FrameLight::Sinusoid { .. } => continue,
            };
            *place = self.pictured.then(|| for_display(photo, self.gamma.encoding()));
        }
        Ok(kept)
    }
}

/// A map with its legend, as PNG.
pub(super) fn map_png(map: &PixelMap) -> Outcome<Vec<u8>> {
    png_bytes(&map.drawing.over(&map.picture)?)
}

/// `slcal decode` of a sequence.
pub(super) fn decode(args: &DecodeArgs, pattern: &SequencePattern, printer: Printer) -> Outcome {
    check_input(&args.input)?;
    let output = Destination::prepare(&args.output, args.force)?;
    let overlay = Destination::prepare_overlay(args.overlay.as_ref(), args.force)?;
    check_distinct([&output].into_iter().chain(&overlay))?;
    let is_npz = args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("npz"));
    let mut found = scans(&args.images, pattern)?;
    let Some(scan) = found.pop().filter(|_| found.is_empty()) else {
        return Err(Failure::usage(format!(
            "expected the frames of one scan, found {} folders",
            args.images.len()
        )));
    };
    let files = scan.files.iter().map(PathBuf::as_path);
    check_spares(
        [&output].into_iter().chain(&overlay),
        files.chain(args.input.files()).chain(args.rig.as_deref()),
    )?;
    check_json(args.json, &output)?;
    let mut config = SequenceDecodeConfig::default();
    config.mirrored = args.input.mirror.mirror;
    if let Some(path) = &args.rig {
        let rig = load_rig(path)?;
        check_panel(&args.input.pattern, pattern.projector, path, &rig)?;
        config.mirrored |= rig.is_mirrored();
    }
    let mut decoder = SequenceDecoder::new(pattern, config).in_file(&args.input.pattern)?;
    let busy = printer.busy(format!("decoding {}", input_name(&scan.name)));
    let mut remarks = Remarks::default();
    let reading = Reading {
        pattern,
        order: decoder.reading_order().to_vec(),
        gamma: &args.input.gamma,
        pictured: overlay.is_some(),
    };
    let read = reading.frames(&scan, &mut remarks, |i, photo| decoder.push(i, photo));
    printer.remarks(&remarks);
    let light = read?;
    let decoding = decoder.finish().in_file(&scan.name)?;
    drop(decoder);
    let bytes = if is_npz {
        bytes_of(|out| write_dense_matches(&decoding.matches, out))?
    } else {
        bytes_of(|out| write_matches(&decoding.matches.to_matches(), out))?
    };
    let mut files = vec![(output.clone(), bytes)];
    if let Some(place) = overlay {
        let map = decoded_map(&input_name(&scan.name), &decoding.matches, &decoding.report, &light);
        files.push((place, map_png(&map)?));
    }
    write_all(&files)?;
    drop(busy);
    if args.json {
        return print_json(&decoding.report);
    }
    printer.summary(&summary::sequence(&decoding.report), output == Destination::Stdout)
}
