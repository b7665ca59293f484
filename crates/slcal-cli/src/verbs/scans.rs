//! Clouds of sequences: a scan is a folder of frames.

use std::path::PathBuf;

use slcal_core::SequenceReconstructor;
use slcal_core::pattern::SequencePattern;

use super::reconstruct::frames::{Frame, Place};
use super::reconstruct::report::{CloudReport, FrameResult};
use super::reconstruct::reporter::{Done, Reporter};
use super::reconstruct::{check_places, check_usage, cloud_config, depth_place, places};
use super::sequence::{check_input, read_frames};
use crate::args::ReconstructArgs;
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{ScanFrames, bytes_of, check_panel, cloud_format_of, load_rig, scans, write_all};
use crate::output::{Printer, Remarks};
use crate::picture::depth_file;

pub(super) fn run(mut args: ReconstructArgs, pattern: &SequencePattern, printer: Printer) -> Outcome {
    check_input(&args.input)?;
    let refused = [
        ("--raw", args.raw.is_some()),
        ("--overlay", args.overlay.is_some()),
        ("--report", args.report.is_some()),
    ];
    if let Some((name, _)) = refused.iter().find(|(_, is_given)| *is_given) {
        return Err(Failure::usage(format!(
            "{name} is for photographs of stripes; the pattern is a sequence"
        )));
    }
    let scans = scans(&args.images, pattern)?;
    // From here on a scan goes by its name.
    args.images = scans.iter().map(|scan| scan.name.clone()).collect();
    check_usage(&args)?;
    let format = args.output.as_deref().map_or(Ok(args.format), cloud_format_of)?;
    let rig = load_rig(&args.rig)?;
    check_panel(&args.input.pattern, pattern.projector, &args.rig, &rig)?;
    let mut config = cloud_config(&args.shape, args.cull, &rig, &args.rig)?;
    config.decode.mirrored = args.input.mirror.mirror;
    let places = places(&args)?;
    let depth = depth_place(&args)?;
    check_places(&args, &places, &depth.iter().collect::<Vec<_>>())?;
    let mut scanner = SequenceReconstructor::new(&rig, pattern, config).in_file(&args.input.pattern)?;
    let mut reporter = Reporter::new(&args, printer, Some(scans.len()));
    for (scan, place) in scans.into_iter().zip(places) {
        let mut remarks = Remarks::default();
        let outcome = cloud(&scan, &place, &mut scanner, &mut remarks, &args).and_then(|result| {
            let Some((output, result)) = result else { return Ok(FrameResult::Resumed { resumed: true }) };
            let mut files = vec![(output, bytes_of(|out| format.write(&result.cloud, out))?)];
            if let Some(place) = &depth {
                files.push((place.clone(), depth_file(&result.cloud, &rig, &place.name())?));
            }
            write_all(&files)?;
            Ok(FrameResult::Cloud(Box::new(CloudReport::of(&result))))
        });
        let frame = Frame { image: scan.name, number: None, raw: None, place: Ok(place) };
        reporter.take(Done { frame, remarks, outcome })?;
    }
    reporter.finish()
}

type Written = (crate::io::Destination, slcal_core::Reconstruction);

/// The cloud of a scan; `None` where an earlier run has written it.
fn cloud(
    scan: &ScanFrames,
    place: &Place,
    scanner: &mut SequenceReconstructor,
    remarks: &mut Remarks,
    args: &ReconstructArgs,
) -> Outcome<Option<Written>> {
    let Some(output) = &place.output else { return Ok(None) };
    // Of a scan that failed, some frames may have come.
    scanner.clear();
    let order = scanner.reading_order().to_vec();
    let samples = args.input.gamma.samples();
    read_frames(scan, &order, samples, remarks, |frame, photo| scanner.push(frame, photo))?;
    let name: PathBuf = scan.name.clone();
    Ok(Some((output.clone(), scanner.finish().in_file(&name)?)))
}
