//! `slcal reconstruct`: photographs of an object under the stripes in, clouds out.

pub(super) mod frames;
mod pool;
pub(super) mod report;
pub(super) mod reporter;

use std::path::{Path, PathBuf};
use std::thread;

use image::DynamicImage;
use slcal_core::evaluate::FitConfig;
use slcal_core::format::CloudFormat;
use slcal_core::pattern::StripePattern;
use slcal_core::reconstruct::{CullRule, TriangulateConfig};
use slcal_core::{ReconstructConfig, Reconstruction, Reconstructor, Rig};

use self::frames::{Frame, OutputFolder, Place};
use self::report::{CloudReport, FrameResult};
use self::reporter::{Done, Reporter};
use super::decode::References;
use crate::args::{CloudArgs, ReconstructArgs};
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{
    Destination, RawFormat, bytes_of, check_distinct, check_json, check_one_stdin, check_panel, check_spares,
    cloud_format_of, input_name, is_dash, load_rig, load_stripes, make_folder, png_bytes, read_photo,
    write_all,
};
use crate::output::{Printer, Remarks};
use crate::picture::{depth_file, for_display, stripes};
use crate::report::{CloudPage, CommandLine, Photo, Pictured, cloud_html};
use crate::surface::FittedSurface;

pub(super) fn run(args: &ReconstructArgs, typed: &CommandLine, printer: Printer) -> Outcome {
    check_usage(args)?;
    let single = args.output.as_deref();
    let format = single.map_or(Ok(args.format), cloud_format_of)?;
    let rig = load_rig(&args.rig)?;
    let pattern = load_stripes(&args.input.pattern)?;
    check_panel(&args.input.pattern, pattern.projector, &args.rig, &rig)?;
    let config = cloud_config(&args.shape, args.cull, &rig, &args.rig)?;
    if let Some(raw) = args.raw {
        check_raw_size(raw, &rig, &args.rig)?;
    }
    let places = places(args)?;
    let overlay = Destination::prepare_overlay(args.overlay.as_ref(), args.force)?;
    let report = Destination::prepare_report(args.report.as_ref(), args.force)?;
    let depth = depth_place(args)?;
    check_places(args, &places, &overlay.iter().chain(&report).chain(&depth).collect::<Vec<_>>())?;
    let job = Job {
        scene: References::load(&args.input, printer)?,
        rig: &rig,
        pattern: &pattern,
        format,
        overlay,
        report,
        depth,
        typed,
        args,
    };
    let config = ReconstructConfig { decode: job.scene.config(), ..config };
    if let (Some(folder), Some(raw)) = (OutputFolder::of(args), args.raw) {
        return job.run(&config, folder.frames(raw, args.timeout), None, printer);
    }
    let of_file = |(image, place): (&PathBuf, Place)| Frame {
        image: image.clone(),
        number: None,
        raw: None,
        place: Ok(place),
    };
    let count = places.len();
    job.run(&config, args.images.iter().zip(places).map(of_file), Some(count), printer)
}

/// Checks of the command line beyond those of clap.
pub(super) fn check_usage(args: &ReconstructArgs) -> Outcome {
    let photos = args.images.len();
    if args.raw.is_some() && args.images.iter().any(|p| !is_dash(p)) {
        return Err(Failure::usage(
            "--raw reads frames from stdin; reconstruct photographs in a separate run",
        ));
    }
    check_one_stdin(&args.images)?;
    if args.output.is_some() && photos > 1 {
        return Err(Failure::usage(format!(
            "-o takes the cloud of one photograph, found {photos} photographs; use --out-dir DIR"
        )));
    }
    if args.overlay.is_some() && (photos > 1 || args.raw.is_some()) {
        return Err(Failure::usage("--overlay takes one photograph; process the others without it"));
    }
    if args.report.is_some() && (photos > 1 || args.raw.is_some()) {
        return Err(Failure::usage("--report takes one photograph; process the others without it"));
    }
    Ok(())
}

/// The destination of the depth image, whose name must say its format.
pub(super) fn depth_place(args: &ReconstructArgs) -> Outcome<Option<Destination>> {
    let Some(path) = &args.depth else { return Ok(None) };
    if args.images.len() > 1 || args.raw.is_some() {
        return Err(Failure::usage("--depth takes one cloud; process the others without it"));
    }
    let is_known =
        path.extension().is_some_and(|e| ["pfm", "png"].iter().any(|known| e.eq_ignore_ascii_case(known)));
    if !is_known {
        return Err(Failure::usage(format!(
            "--depth: expected a file whose name ends in .pfm or .png, found {}",
            input_name(path)
        )));
    }
    Destination::prepare_depth(Some(path), args.force)
}

/// A stream of another size would fail frame by frame.
fn check_raw_size(raw: RawFormat, rig: &Rig, path: &Path) -> Outcome {
    let ([found_w, found_h], [w, h]) = (raw.size, rig.camera.model.size());
    if [found_w, found_h] == [w, h] {
        return Ok(());
    }
    let expected = format!("expected frames of the camera of {}, {w}x{h} px", input_name(path));
    let message = format!("--raw {found_w}x{found_h}: {expected}; record at that size");
    Err(Failure::new(Exit::Input, message))
}

/// One destination per photograph; none for a stream, whose length is unknown.
pub(super) fn places(args: &ReconstructArgs) -> Outcome<Vec<Place>> {
    if let Some(output) = &args.output {
        let place = Destination::prepare(output, args.force)?;
        check_json(args.json, &place)?;
        return Ok(vec![Place { name: place.name(), output: Some(place) }]);
    }
    let folder = OutputFolder::of(args).ok_or_else(|| Failure::usage("expected -o FILE or --out-dir DIR"))?;
    if let Some(path) = &args.out_dir {
        make_folder(path)?;
    }
    if args.raw.is_some() {
        folder.check_for_stream()?;
        return Ok(Vec::new());
    }
    folder.places(&args.images)
}

/// No output is written twice or replaces an input.
pub(super) fn check_places(args: &ReconstructArgs, places: &[Place], beside: &[&Destination]) -> Outcome {
    let new = || places.iter().filter_map(|p| p.output.as_ref()).chain(beside.iter().copied());
    check_distinct(new())?;
    let photos = args.images.iter().map(PathBuf::as_path);
    check_spares(new(), photos.chain(args.input.files()).chain([args.rig.as_path()]))
}

/// The inputs and settings common to all frames.
struct Job<'a> {
    scene: References,
    rig: &'a Rig,
    pattern: &'a StripePattern,
    format: CloudFormat,
    overlay: Option<Destination>,
    report: Option<Destination>,
    depth: Option<Destination>,
    typed: &'a CommandLine,
    args: &'a ReconstructArgs,
}

impl Job<'_> {
    /// Reconstructs all frames, several at a time, and reports them in order.
    fn run(
        &self,
        config: &ReconstructConfig,
        frames: impl Iterator<Item = Frame> + Send,
        count: Option<usize>,
        printer: Printer,
    ) -> Outcome {
        let cores = || thread::available_parallelism().map_or(1, usize::from);
        let jobs = self.args.jobs.map_or_else(cores, usize::from).min(count.unwrap_or(usize::MAX));
        let mut workers = Vec::new();
        for _ in 0..jobs {
            let mut scanner =
                Reconstructor::new(self.rig, self.pattern, *config).in_file(&self.args.input.pattern)?;
            workers.push(move |frame: Frame| self.work(frame, &mut scanner));
        }
        let mut reporter = Reporter::new(self.args, printer, count);
        pool::in_order(frames, workers, |done| reporter.take(done))?;
        reporter.finish()
    }

    fn work(&self, frame: Frame, scanner: &mut Reconstructor) -> Done {
        let mut remarks = Remarks::default();
        let outcome = self.reconstruct(&frame, scanner, &mut remarks);
        // The pixels are not needed to report.
        Done { frame: Frame { raw: None, ..frame }, remarks, outcome }
    }

    /// Reconstructs a frame and writes its files.
    fn reconstruct(
        &self,
        frame: &Frame,
        scanner: &mut Reconstructor,
        remarks: &mut Remarks,
    ) -> Outcome<FrameResult> {
        let place = frame.place.as_ref().map_err(Failure::clone)?;
        let Some(output) = &place.output else { return Ok(FrameResult::Resumed { resumed: true }) };
        let name = PathBuf::from(frame.name());
        let samples = self.args.input.gamma.samples();
        let photo =
            if frame.raw.is_none() { Some(read_photo(&frame.image, samples, remarks)?) } else { None };
        let input = match (&frame.raw, &photo) {
            (Some(raw), _) => self.scene.around(raw.view().in_file(&name)?)?,
            (None, Some(photo)) => self.scene.input(&name, photo)?,
            (None, None) => return Err(Failure::new(Exit::Other, "a frame without a picture")),
        };
        let result = scanner.reconstruct(input).in_file(&name)?;
        let mut files = vec![(output.clone(), bytes_of(|out| self.format.write(&result.cloud, out))?)];
        let pictured = self.overlay.is_some() || self.report.is_some();
        let photo = photo.filter(|_| pictured).map(|p| for_display(p, self.scene.config().encoding));
        if let Some((place, photo)) = self.overlay.as_ref().zip(photo.as_ref()) {
            files.push((place.clone(), draw(photo, &frame.name(), result)?));
        }
        if let Some(place) = &self.report {
            files.push((place.clone(), self.page(&name, &output.name(), photo.as_ref(), result)?));
        }
        if let Some(place) = &self.depth {
            files.push((place.clone(), depth_file(&result.cloud, self.rig, &place.name())?));
        }
        let report = CloudReport::of(result);
        write_all(&files)?;
        Ok(FrameResult::Cloud(Box::new(report)))
    }

    /// The report on a cloud.
    fn page(
        &self,
        image: &Path,
        cloud: &str,
        photo: Option<&DynamicImage>,
        result: &Reconstruction,
    ) -> Outcome<Vec<u8>> {
        // As typed: a destination has its links resolved.
        let typed = self.args.output.as_deref().filter(|p| !is_dash(p)).map(input_name);
        let page = CloudPage {
            rig: self.rig,
            rig_name: input_name(&self.args.rig),
            image_name: input_name(image),
            cloud_name: typed.unwrap_or_else(|| cloud.to_owned()),
            pictured: photo.map_or(Ok(Pictured::Nothing), |p| Photo::new(p, 1).map(Pictured::Stripes))?,
            result,
            surface: self.args.fit.map(|shape| {
                FittedSurface::new(shape, &result.cloud, &FitConfig::default()).map_err(|e| e.to_string())
            }),
            made_by: vec![self.typed.typed()],
        };
        Ok(cloud_html(&page))
    }
}

/// The configuration of the reconstruction; the frame of the sheet needs a rig with a view.
pub(super) fn cloud_config(
    args: &CloudArgs,
    cull: CullRule,
    rig: &Rig,
    path: &Path,
) -> Outcome<ReconstructConfig> {
    if args.frame == slcal_core::Frame::Plane && rig.views.is_empty() {
        let message = "expected a rig with a view of the sheet for --frame plane, found none";
        return Err(Failure::input(path, message));
    }
    let triangulate =
        TriangulateConfig { near_mm: args.near, far_mm: args.far, ..TriangulateConfig::default() };
    triangulate.validate().map_err(|_| Failure::usage("--far: expected a distance above that of --near"))?;
    Ok(ReconstructConfig {
        triangulate,
        cull,
        frame: args.frame,
        mesh: args.mesh,
        ..ReconstructConfig::default()
    })
}

/// The remaining points drawn on the photograph, as PNG.
pub(super) fn draw(photo: &DynamicImage, name: &str, result: &Reconstruction) -> Outcome<Vec<u8>> {
    let size = [photo.width(), photo.height()];
    png_bytes(&stripes::reconstructed(size, name, result).over(photo)?)
}
