//! Clouds of sequences: a scan is a folder of frames.

use std::path::PathBuf;

use slcal_core::evaluate::FitConfig;
use slcal_core::pattern::SequencePattern;
use slcal_core::{DenseMatches, Reconstruction, Rig, SequenceReconstructor};

use super::reconstruct::frames::{Frame, Place};
use super::reconstruct::report::{CloudReport, FrameResult};
use super::reconstruct::reporter::{Done, Reporter};
use super::reconstruct::{check_places, check_usage, cloud_config, depth_place, places};
use super::sequence::{Reading, check_input, map_png};
use crate::args::ReconstructArgs;
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{
    Destination, ScanFrames, bytes_of, check_panel, cloud_format_of, input_name, is_dash, load_rig, scans,
    write_all,
};
use crate::output::{Printer, Remarks};
use crate::picture::depth_file;
use crate::picture::sequence::{UnderLight, decoded_map};
use crate::report::{CloudPage, CommandLine, Pictured, SequenceMaps, cloud_html};
use crate::surface::FittedSurface;

pub(super) fn run(
    mut args: ReconstructArgs,
    pattern: &SequencePattern,
    typed: &CommandLine,
    printer: Printer,
) -> Outcome {
    check_input(&args.input)?;
    if args.raw.is_some() {
        return Err(Failure::usage("--raw is for photographs of stripes; the pattern is a sequence"));
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
    let beside = Beside {
        overlay: Destination::prepare_overlay(args.overlay.as_ref(), args.force)?,
        report: Destination::prepare_report(args.report.as_ref(), args.force)?,
        depth: depth_place(&args)?,
    };
    check_places(&args, &places, &beside.all())?;
    let mut scanner = SequenceReconstructor::new(&rig, pattern, config).in_file(&args.input.pattern)?;
    let reading = Reading {
        pattern,
        order: scanner.reading_order().to_vec(),
        gamma: &args.input.gamma,
        pictured: beside.overlay.is_some() || beside.report.is_some(),
    };
    let mut reporter = Reporter::new(&args, printer, Some(scans.len()));
    for (scan, place) in scans.into_iter().zip(places) {
        let mut remarks = Remarks::default();
        let outcome = cloud(&scan, &place, &mut scanner, &reading, &mut remarks).and_then(|found| {
            let Some((output, found)) = found else { return Ok(FrameResult::Resumed { resumed: true }) };
            let mut files = vec![(output.clone(), bytes_of(|out| format.write(&found.result.cloud, out))?)];
            files.extend(beside.files(&found, &scan, &output, &rig, &args, typed)?);
            write_all(&files)?;
            Ok(FrameResult::Cloud(Box::new(CloudReport::of(&found.result))))
        });
        let frame = Frame { image: scan.name, number: None, raw: None, place: Ok(place) };
        reporter.take(Done { frame, remarks, outcome })?;
    }
    reporter.finish()
}

/// A cloud, and what pictures of it need.
struct Found {
    result: Reconstruction,
    matches: DenseMatches,
    light: UnderLight,
}

/// The cloud of a scan; `None` where an earlier run has written it.
fn cloud(
    scan: &ScanFrames,
    place: &Place,
    scanner: &mut SequenceReconstructor,
    reading: &Reading<'_>,
    remarks: &mut Remarks,
) -> Outcome<Option<(Destination, Found)>> {
    let Some(output) = &place.output else { return Ok(None) };
    // Of a scan that failed, some frames may have come.
    scanner.clear();
    let light = reading.frames(scan, remarks, |frame, photo| scanner.push(frame, photo))?;
    let name: PathBuf = scan.name.clone();
    let (result, matches) = scanner.finish_with_matches().in_file(&name)?;
    Ok(Some((output.clone(), Found { result, matches, light })))
}

/// What is written beside the cloud of a single scan.
struct Beside {
    overlay: Option<Destination>,
    report: Option<Destination>,
    depth: Option<Destination>,
}

impl Beside {
    fn all(&self) -> Vec<&Destination> {
        self.overlay.iter().chain(&self.report).chain(&self.depth).collect()
    }

    fn files(
        &self,
        found: &Found,
        scan: &ScanFrames,
        output: &Destination,
        rig: &Rig,
        args: &ReconstructArgs,
        typed: &CommandLine,
    ) -> Outcome<Vec<(Destination, Vec<u8>)>> {
        let mut files = Vec::new();
        let (name, Found { result, matches, light }) = (input_name(&scan.name), found);
        if let (Some(place), Some(report)) = (&self.overlay, result.sequence()) {
            files.push((place.clone(), map_png(&decoded_map(&name, matches, report, light))?));
        }
        if let Some(place) = &self.report {
            let maps = SequenceMaps::new(&name, result, matches, light)?;
            // As typed: a destination has its links resolved.
            let typed_name = args.output.as_deref().filter(|p| !is_dash(p)).map(input_name);
            let page = CloudPage {
                rig,
                rig_name: input_name(&args.rig),
                image_name: name,
                cloud_name: typed_name.unwrap_or_else(|| output.name()),
                pictured: Pictured::Sequence(Box::new(maps)),
                result,
                surface: args.fit.map(|shape| {
                    FittedSurface::new(shape, &result.cloud, &FitConfig::default()).map_err(|e| e.to_string())
                }),
                made_by: vec![typed.typed()],
            };
            files.push((place.clone(), cloud_html(&page)));
        }
        if let Some(place) = &self.depth {
            files.push((place.clone(), depth_file(&result.cloud, rig, &place.name())?));
        }
        Ok(files)
    }
}
