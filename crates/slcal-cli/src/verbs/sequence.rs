//! Decoding and reconstruction of sequences: one photograph is in memory at a time.

use std::path::{Path, PathBuf};

use slcal_core::decode::{SequenceDecodeConfig, SequenceDecoder};
use slcal_core::format::{write_dense_matches, write_matches};
use slcal_core::pattern::{Pattern, SequencePattern};
use slcal_core::photo::PhotoView;

use crate::args::{self, DecodeArgs};
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{
    Destination, Samples, ScanFrames, bytes_of, check_json, check_panel, check_spares, input_name, is_dash,
    load_pattern, load_rig, read_photo, scans, write_all,
};
use crate::output::{Printer, Remarks, print_json};
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

/// Hands the photographs of a scan to `take`, one after another.
pub(super) fn read_frames(
    scan: &ScanFrames,
    order: &[usize],
    samples: Samples,
    remarks: &mut Remarks,
    mut take: impl FnMut(usize, PhotoView<'_>) -> slcal_core::Result<()>,
) -> Outcome {
    for &frame in order {
        let file = &scan.files[frame];
        let photo = read_photo(file, samples, remarks)?;
        let view = PhotoView::try_from(&photo).in_file(file)?;
        take(frame, view).in_file(file)?;
    }
    Ok(())
}

/// `slcal decode` of a sequence.
pub(super) fn decode(args: &DecodeArgs, pattern: &SequencePattern, printer: Printer) -> Outcome {
    check_input(&args.input)?;
    if args.overlay.is_some() {
        return Err(Failure::usage("--overlay draws stripes; a sequence has none"));
    }
    let output = Destination::prepare(&args.output, args.force)?;
    let is_npz = args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("npz"));
    let mut found = scans(&args.images, pattern)?;
    let Some(scan) = found.pop().filter(|_| found.is_empty()) else {
        return Err(Failure::usage(format!(
            "expected the frames of one scan, found {} folders",
            args.images.len()
        )));
    };
    let files = scan.files.iter().map(PathBuf::as_path);
    check_spares([&output], files.chain(args.input.files()).chain(args.rig.as_deref()))?;
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
    let order = decoder.reading_order().to_vec();
    let read = read_frames(&scan, &order, args.input.gamma.samples(), &mut remarks, |i, photo| {
        decoder.push(i, photo)
    });
    printer.remarks(&remarks);
    read?;
    let decoding = decoder.finish().in_file(&scan.name)?;
    drop(decoder);
    let bytes = if is_npz {
        bytes_of(|out| write_dense_matches(&decoding.matches, out))?
    } else {
        bytes_of(|out| write_matches(&decoding.matches.to_matches(), out))?
    };
    write_all(&[(output.clone(), bytes)])?;
    drop(busy);
    if args.json {
        return print_json(&decoding.report);
    }
    printer.summary(&summary::sequence(&decoding.report), output == Destination::Stdout)
}
