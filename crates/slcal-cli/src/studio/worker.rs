//! The work on photographs, on a thread of its own: detection, calibration, clouds, the simulated camera.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use image::{DynamicImage, RgbImage};
use slcal_core::detect::Detection;
use slcal_core::format::{
    ExchangeFormat, ExportConfig, ExportedFile, export_rig, read_ply, write_observations, write_pattern,
    write_ply, write_rig,
};
use slcal_core::pattern::Pattern;
use slcal_core::{
    Calibrator, CheckerPattern, PhotoView, PointCloud, ReconstructConfig, Reconstruction, Reconstructor, Rig,
    SheetPhoto, StripeConfig, StripePattern, rectify_picture, residuals,
};

use super::auto_shot::nearness;
use super::checker::checker;
use super::cloud_note::{CloudNote, fingerprint};
use super::guide::{self, RoughDevices};
use super::job::{Bench, Calibrated, Done, Job, LiveFrame, LookFor, SheetFound};
use super::live::Look;
use super::project::{Project, Purpose, StoredPhoto, cloud_name};
use super::scan_folder::ScanFolder;
use super::sequence_cloud::sequence_cloud;
use super::simulated_camera::{DISTANCE_MM, SimulatedCamera};
use super::state::{CloudEntry, DemoObject, DemoPose, DemoScene, Guide, Problem};
use crate::cloud_view::packed;
use crate::exit::{Exit, Failure, Outcome};
use crate::io::{PHOTO_QUALITY, bytes_of, decode_photo, extension_of, jpeg_bytes, png_bytes, read_tags};
use crate::report::{Photo, RigPage, rig_html};

/// Pictures that the worker shares with the server.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    /// The newest live frame.
    live: Mutex<Option<Arc<RgbImage>>>,
    /// What the display painted last; only the demonstration sends it.
    painted: Mutex<Option<Arc<RgbImage>>>,
}

impl Pictures {
    pub(super) fn live(&self) -> Option<Arc<RgbImage>> {
        self.live.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn paint(&self, picture: RgbImage) {
        *self.painted.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(picture));
    }

    /// Nothing is painted any more.
    pub(super) fn darken(&self) {
        *self.painted.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    fn painted(&self) -> Option<Arc<RgbImage>> {
        self.painted.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn show(&self, frame: Arc<RgbImage>) {
        *self.live.lock().unwrap_or_else(PoisonError::into_inner) = Some(frame);
    }
}

/// What follows from panel, sheet and pattern.
struct Prepared {
    bench: Bench,
    checker: CheckerPattern,
    stripes: StripePattern,
    calibrator: Calibrator,
    /// The photographs of the calibrator and their sizes, in its order.
    ids: Vec<u32>,
    sizes: Vec<[u32; 2]>,
    simulated: SimulatedCamera,
}

/// The worker's memory between jobs.
pub(super) struct Worker {
    project: Arc<Project>,
    pictures: Arc<Pictures>,
    demo: bool,
    prepared: Option<Prepared>,
    rig: Option<Arc<Rig>>,
    fingerprint: String,
    scanner: Option<Reconstructor>,
    /// The newest frame of the continuous scan that gave a cloud.
    last: Option<Arc<RgbImage>>,
}

impl Worker {
    pub(super) fn new(project: Arc<Project>, pictures: Arc<Pictures>, demo: bool) -> Self {
        Self {
            project,
            pictures,
            demo,
            prepared: None,
            rig: None,
            fingerprint: String::new(),
            scanner: None,
            last: None,
        }
    }

    /// Does a job, and tells what came of it, in one or more parts.
    pub(super) fn work(&mut self, job: Job, tell: &mut dyn FnMut(Done)) {
        let outcome = match job {
            Job::Begin(bench, left_out) => {
                let begun = self.begin(bench, &left_out, tell);
                Ok(begun.unwrap_or_else(|failure| Done::NotBegun(problem(&failure))))
            }
            Job::FirstGuide(image) => self.first_guide(image).map(Done::FirstGuide),
            Job::Sheet(photo) => Ok(self.sheet(photo)),
            Job::Calibrate(used) => Ok(self.calibrate(&used)),
            Job::Forget => {
                self.forget();
                Ok(Done::Nothing)
            }
            Job::TakeSimulated(purpose, scene) => self.take(purpose, scene, tell),
            Job::Cloud(photo) => self.cloud(&photo),
            Job::BeginScan(pattern) => self.project.begin_scan(&pattern).map(Done::ScanBegun),
            Job::SequenceCloud(folder) => self.sequence_cloud(&folder),
            Job::KeepLive => self.keep_live(),
            Job::Rectify { name, bytes } => self.rectify(name, &bytes),
            Job::Export(format) => self.export(&format),
        };
        tell(outcome.unwrap_or_else(|failure| Done::Failed(problem(&failure))));
    }

    /// Looks at a live frame.
    pub(super) fn look(&mut self, frame: &LiveFrame) -> Option<Done> {
        let picture = match (&frame.picture, frame.scene) {
            (Some(picture), _) => picture.clone(),
            (None, Some(scene)) => {
                let painted = self.pictures.painted();
                // A cloud needs the size that was calibrated.
                let small = frame.look_for != LookFor::Cloud;
                Arc::new(self.prepared.as_mut()?.simulated.frame(scene, painted.as_deref(), small).ok()?)
            }
            (None, None) => return None,
        };
        self.pictures.show(picture.clone());
        match (frame.look_for, &self.prepared) {
            (LookFor::Sheet, Some(prepared)) => {
                let mut look = Look::for_sheet(frame.seq, &picture, prepared.bench.sheet, &prepared.checker);
                look.near = look.sheet.zip(frame.wanted).map(|(seen, (size, quad))| {
                    let scale = f64::from(look.size[0]) / f64::from(size[0].max(1));
                    nearness(&seen, &quad.map(|p| p.map(|x| x * scale)))
                });
                Some(Done::Look(look))
            }
            (LookFor::Cloud, Some(_)) => Some(self.live_cloud(frame.seq, &picture)),
            _ => Some(Done::Look(Look::at(frame.seq, &picture))),
        }
    }

    /// Draws the patterns, and looks through the photographs that are there.
    fn begin(
        &mut self,
        bench: Bench,
        left_out: &BTreeSet<String>,
        tell: &mut dyn FnMut(Done),
    ) -> Outcome<Done> {
        (self.prepared, self.rig, self.scanner, self.last) = (None, None, None, None);
        let checker = checker(bench.projector, bench.pattern_scale)?;
        let stripes = StripePattern::new(bench.projector, &StripeConfig::default())?;
        self.project.write("checker.png", &png_bytes(&DynamicImage::ImageRgb8(checker.image()?))?)?;
        self.project.write("stripes.png", &png_bytes(&DynamicImage::ImageRgb8(stripes.image()?))?)?;
        let description = |pattern: Pattern| bytes_of(|out| write_pattern(&pattern, out));
        self.project.write("checker.json", &description(Pattern::Checker(checker.clone()))?)?;
        self.project.write("stripes.json", &description(Pattern::Stripes(stripes.clone()))?)?;
        let simulated = SimulatedCamera::new(bench.projector, bench.sheet.upright());
        if self.demo {
            let truth = simulated.rig(false)?;
            self.project.write("truth_rig.json", &bytes_of(|out| write_rig(&truth, out))?)?;
        }
        let calibrator = Calibrator::new(bench.sheet).with_pattern(&checker);
        self.prepared = Some(Prepared {
            bench,
            checker,
            stripes,
            calibrator,
            ids: Vec::new(),
            sizes: Vec::new(),
            simulated,
        });
        tell(Done::Begun);
        // Those that count first: one of another size that was left out must not hinder them.
        let (out, counting): (Vec<_>, Vec<_>) =
            self.project.photos(Purpose::Sheet).into_iter().partition(|p| left_out.contains(&p.name));
        for photo in counting.into_iter().chain(out) {
            let found = self.sheet(photo);
            tell(found);
        }
        for photo in self.project.photos(Purpose::Scan) {
            tell(match self.stored_cloud(&photo) {
                Some(entry) => Done::Cloud(entry),
                None => Done::CloudMissing(Job::Cloud(photo)),
            });
        }
        for folder in self.project.scan_folders() {
            self.look_through(folder, tell);
        }
        Ok(Done::Looked)
    }

    /// What became of a scan by a sequence of an earlier run.
    fn look_through(&self, folder: ScanFolder, tell: &mut dyn FnMut(Done)) {
        // What somebody else has put there is none of them.
        let Ok(pattern) = self.project.sequence_of(&folder) else { return };
        if let Some(unfinished) = self.project.unfinished(&folder, &pattern) {
            return tell(Done::Unfinished(unfinished));
        }
        let scan = StoredPhoto { id: folder.id, name: folder.name.clone() };
        tell(match self.stored_cloud(&scan) {
            Some(entry) => Done::Cloud(CloudEntry { frames: Some(pattern.frames.len()), ..entry }),
            None => Done::CloudMissing(Job::SequenceCloud(folder)),
        });
    }

    fn first_guide(&self, image: [u32; 2]) -> Outcome<Option<super::state::Guide>> {
        let Some(prepared) = &self.prepared else { return Ok(None) };
        // A simulated sheet goes where the outline is: that must be possible.
        let devices = if self.demo {
            RoughDevices::simulated(&prepared.simulated.rig(false)?, DISTANCE_MM)?
        } else {
            RoughDevices::usual(image, prepared.bench.projector)?
        };
        Ok(guide::first(&devices, prepared.bench.sheet)?)
    }

    fn sheet(&mut self, photo: StoredPhoto) -> Done {
        // One photograph that slcal fails at must not hinder the others, now and at every start.
        let found = catch_unwind(AssertUnwindSafe(|| self.find_sheet(&photo)))
            .unwrap_or_else(|_| Err(Failure::new(Exit::Other, "slcal failed at this photograph")));
        let found = found.map_err(|failure| problem(&failure));
        Done::Sheet { photo, found }
    }

    fn find_sheet(&mut self, photo: &StoredPhoto) -> Outcome<SheetFound> {
        // One that arrived while all were looked through comes twice.
        let prepared = self.prepared.as_ref().ok_or_else(not_set_up)?;
        if let Some(at) = prepared.ids.iter().position(|id| *id == photo.id) {
            return Ok(sheet_found(&prepared.calibrator.detections()[at], prepared.sizes[at]));
        }
        let (picture, bytes) = self.load(&photo.name)?;
        let prepared = self.prepared.as_mut().ok_or_else(not_set_up)?;
        let mut shot = SheetPhoto::new(PhotoView::try_from(&picture)?).name(&photo.name);
        if let Ok(tags) = read_tags(&bytes) {
            shot = shot.tags(tags);
        }
        let found = prepared.calibrator.add(shot)?;
        let size = [picture.width(), picture.height()];
        let result = sheet_found(found, size);
        prepared.ids.push(photo.id);
        prepared.sizes.push(size);
        Ok(result)
    }

    fn load(&self, name: &str) -> Outcome<(DynamicImage, Vec<u8>)> {
        let bytes = self
            .project
            .read(name)
            .map_err(|e| Failure::input(&self.project.path(name), format!("cannot be read: {e}")))?;
        Ok((decode_photo(&bytes, name)?.photo, bytes))
    }

    /// There is no calibration any more.
    fn forget(&mut self) {
        (self.rig, self.scanner, self.last) = (None, None, None);
        self.project.remove(&["rig.json", "observations.json"]);
    }

    fn calibrate(&mut self, used: &[u32]) -> Done {
        let calibrated = self.new_rig(used);
        if calibrated.is_err() {
            self.forget();
        }
        Done::Calibrated(calibrated.map_err(|failure| problem(&failure)))
    }

    fn new_rig(&mut self, used: &[u32]) -> Outcome<Calibrated> {
        (self.rig, self.scanner) = (None, None);
        let prepared = self.prepared.as_ref().ok_or_else(not_set_up)?;
        let mut calibrator = prepared.calibrator.clone();
        for i in (0..prepared.ids.len()).rev().filter(|i| !used.contains(&prepared.ids[*i])) {
            calibrator.remove(i);
        }
        let used: Vec<u32> = prepared.ids.iter().copied().filter(|id| used.contains(id)).collect();
        let calibration = calibrator.calibrate()?;
        let rig = Arc::new(calibration.rig);
        self.project.write(
            "observations.json",
            &bytes_of(|out| write_observations(&calibration.observations, out))?,
        )?;
        let rig_file = bytes_of(|out| write_rig(&rig, out))?;
        self.project.write("rig.json", &rig_file)?;
        self.fingerprint = fingerprint(&rig_file);
        let guide = guide::next(&rig, &prepared.checker).ok().flatten();
        let config = ReconstructConfig { mesh: true, ..ReconstructConfig::default() };
        self.scanner = Some(Reconstructor::new(&rig, &prepared.stripes, config)?);
        self.rig = Some(rig.clone());
        let guide = if self.demo { guide.map(|g| self.where_it_is_seen(g)) } else { guide };
        Ok(Calibrated { rig, fingerprint: self.fingerprint.clone(), used, guide })
    }

    /// A simulated sheet goes where the guide says, and is photographed by itself when the live picture shows all of it. A
    /// rig that is known badly misplaces it: then it stays where the projector is aimed at, tilted less until it is seen.
    fn where_it_is_seen(&mut self, guide: Guide) -> Guide {
        const SHARES: [f64; 4] = [1.0, 0.8, 0.6, 0.4];
        let aimed = |pose: DemoPose| DemoPose { distance_mm: DISTANCE_MM, aside_mm: [0.0; 2], ..pose };
        let (Some(wanted), Some(Prepared { bench, checker, simulated, .. })) =
            (guide.turn, self.prepared.as_mut())
        else {
            return guide;
        };
        let Ok(picture) = checker.image() else { return guide };
        let less = |share: f64| DemoPose { tilt_deg: wanted.tilt_deg.map(|t| share * t), ..wanted };
        for (share, turn) in [(1.0, wanted)].into_iter().chain(SHARES.map(|s| (s, aimed(less(s))))) {
            let scene = DemoScene { pose: turn, object: DemoObject::Sheet };
            let Ok(frame) = simulated.frame(scene, Some(&picture), true) else { continue };
            let look = Look::for_sheet(0, &frame, bench.sheet, checker);
            let by = f64::from(guide.size[0]) / f64::from(frame.width());
            match look.sheet.filter(|_| look.is_complete()) {
                Some(_) if turn == wanted => return guide,
                Some(quad) => return guide.tilted_less(share, turn, quad.map(|p| p.map(|x| by * x))),
                None => {}
            }
        }
        guide
    }

    fn take(&mut self, purpose: Purpose, scene: DemoScene, tell: &mut dyn FnMut(Done)) -> Outcome<Done> {
        let painted = self.pictures.painted();
        let prepared = self.prepared.as_mut().ok_or_else(not_set_up)?;
        let photo = Arc::new(prepared.simulated.frame(scene, painted.as_deref(), false)?);
        if let Purpose::Frame { frame, .. } = purpose {
            // No other live picture comes meanwhile.
            self.pictures.show(photo.clone());
            tell(Done::Look(Look::at(frame as u32, &photo)));
        }
        let kept = self.project.keep(purpose, &jpeg_bytes(&photo, PHOTO_QUALITY)?, "jpg")?;
        Ok(Done::Kept(purpose, kept))
    }

    fn cloud(&mut self, photo: &StoredPhoto) -> Outcome<Done> {
        // As it came: 16 bits stay 16.
        let picture = self.load(&photo.name)?.0;
        self.reconstruct(photo, PhotoView::try_from(&picture)?)
    }

    fn sequence_cloud(&self, folder: &ScanFolder) -> Outcome<Done> {
        let rig = self.rig.as_ref().ok_or_else(not_calibrated)?;
        let (result, pattern) = sequence_cloud(&self.project, folder, rig)?;
        let scan = StoredPhoto { id: folder.id, name: folder.name.clone() };
        let entry = keep_cloud(&self.project, &self.fingerprint, &scan, &result)?;
        Ok(Done::Cloud(CloudEntry { frames: Some(pattern.frames.len()), ..entry }))
    }

    fn reconstruct(&mut self, photo: &StoredPhoto, picture: PhotoView<'_>) -> Outcome<Done> {
        let scanner = self.scanner.as_mut().ok_or_else(not_calibrated)?;
        let result = scanner.reconstruct(picture)?;
        Ok(Done::Cloud(keep_cloud(&self.project, &self.fingerprint, photo, result)?))
    }

    /// A cloud that an earlier run left; `None` where it has none.
    fn stored_cloud(&self, photo: &StoredPhoto) -> Option<CloudEntry> {
        let bytes = self.project.read(&cloud_name(photo.id, "ply")).ok()?;
        let cloud = read_ply(bytes.as_slice()).ok()?;
        let note = self.project.read(&cloud_name(photo.id, "json")).ok();
        let note = note.and_then(|bytes| CloudNote::read(&bytes));
        Some(entry(photo, &cloud, note.unwrap_or_else(|| CloudNote::new("", Vec::new()))))
    }

    fn live_cloud(&mut self, seq: u32, picture: &Arc<RgbImage>) -> Done {
        let mut look = Look::at(seq, picture);
        let Some(scanner) = self.scanner.as_mut() else { return Done::Look(look) };
        let view = PhotoView::try_from(picture.as_ref());
        match view.and_then(|view| scanner.reconstruct(view)) {
            Ok(result) => {
                let points = result.cloud.points.len();
                look.stripes = Some(points);
                self.last = Some(picture.clone());
                Done::LiveCloud { look, points, bytes: packed(&result.cloud).into() }
            }
            Err(error) => {
                look.problem = Some(problem(&error.into()));
                Done::Look(look)
            }
        }
    }

    fn keep_live(&mut self) -> Outcome<Done> {
        let Some(picture) = self.last.take() else { return Ok(Done::Nothing) };
        let photo = self.project.keep(Purpose::Scan, &jpeg_bytes(&picture, PHOTO_QUALITY)?, "jpg")?;
        self.reconstruct(&photo, PhotoView::try_from(picture.as_ref())?)
    }

    fn rectify(&mut self, name: String, bytes: &[u8]) -> Outcome<Done> {
        let rig = self.rig.clone().ok_or_else(not_calibrated)?;
        let picture = decode_photo(bytes, &name)?.photo.into_rgb8();
        // Onto the sheet where it was photographed last.
        let (drawn, _) = rectify_picture(&rig, rig.views.len().saturating_sub(1), &picture)?;
        let file = format!("picture-source.{}", extension_of(bytes).unwrap_or("png"));
        self.project.write(&file, bytes)?;
        self.project.write("picture.png", &png_bytes(&DynamicImage::ImageRgb8(drawn))?)?;
        Ok(Done::Picture { name, file })
    }

    fn export(&mut self, format: &str) -> Outcome<Done> {
        let rig = self.rig.clone().ok_or_else(not_calibrated)?;
        let format: ExchangeFormat = format.parse()?;
        let export = export_rig(&rig, format, &lossy())?;
        let folder = format!("export-{}", format.name());
        crate::io::make_folder(&self.project.path(&folder))?;
        let mut files = Vec::new();
        for file in export.files {
            let name = format!("{folder}/{}", file.name);
            self.project.write(&name, &file.bytes)?;
            files.push(name);
        }
        Ok(Done::Exported { files, left_out: export.left_out })
    }
}

/// Writes a cloud, and beside it with which calibration it was made.
fn keep_cloud(
    project: &Project,
    fingerprint: &str,
    scan: &StoredPhoto,
    result: &Reconstruction,
) -> Outcome<CloudEntry> {
    let bytes = bytes_of(|out| write_ply(&result.cloud, out))?;
    let note = CloudNote::new(fingerprint, result.warnings());
    let kept = serde_json::to_vec(&note).map_err(|e| Failure::new(Exit::Other, e.to_string()))?;
    // The note first: a cloud never stands beside the note of another calibration.
    project.remove(&[&cloud_name(scan.id, "ply")]);
    project.write(&cloud_name(scan.id, "json"), &kept)?;
    let entry = entry(scan, &result.cloud, note);
    project.write(&entry.name, &bytes)?;
    Ok(entry)
}

/// What a format cannot hold is left out, and told.
fn lossy() -> ExportConfig {
    ExportConfig { lossy: true, ..ExportConfig::default() }
}

/// The files of a rig for another program.
pub(super) fn exported(rig: &Rig, format: &str) -> slcal_core::Result<Vec<ExportedFile>> {
    Ok(export_rig(rig, format.parse()?, &lossy())?.files)
}

/// The report on the rig of a project.
pub(super) fn report(project: &Project, rig: &Rig, command: Option<String>) -> Vec<u8> {
    let observations = project
        .read("observations.json")
        .ok()
        .and_then(|bytes| slcal_core::format::read_observations(bytes.as_slice()).ok());
    let photos = rig.views.iter().map(|view| {
        let name = view.photo.as_deref()?;
        let picture = decode_photo(&project.read(name).ok()?, name).ok()?.photo;
        Photo::new(&picture, rig.views.len()).ok()
    });
    let page = RigPage {
        rig,
        rig_name: "rig.json".into(),
        checker_name: Some("checker.json".into()),
        photos: photos.collect(),
        observations: observations.as_ref(),
        residuals: observations
            .as_ref()
            .ok_or_else(|| "there are no observations".to_owned())
            .and_then(|o| residuals(rig, o).map_err(|e| e.to_string())),
        cloud: None,
        made_by: command.into_iter().collect(),
    };
    rig_html(&page)
}

fn sheet_found(found: &Detection, size: [u32; 2]) -> SheetFound {
    SheetFound {
        corners: found.observation.pairs.len(),
        of: found.pattern_corners,
        outline: found.observation.sheet.corners().map(|quad| quad.map(|p| [p.x, p.y])),
        size,
    }
}

fn entry(photo: &StoredPhoto, cloud: &PointCloud, note: CloudNote) -> CloudEntry {
    CloudEntry {
        id: photo.id,
        name: cloud_name(photo.id, "ply"),
        points: cloud.points.len(),
        triangles: cloud.triangles.len(),
        url: format!("/api/clouds/{}", photo.id),
        photo: format!("/api/scans/{}.jpg", photo.id),
        photo_name: photo.name.clone(),
        frames: None,
        saved: vec!["ply".into()],
        warnings: note.warnings,
        rig: note.rig,
        outdated: false,
    }
}

fn problem(failure: &Failure) -> Problem {
    Problem::new("failed", failure.to_string(), "")
}

fn not_set_up() -> Failure {
    Failure::new(crate::exit::Exit::Other, "expected the projector and the sheet to be set up first")
}

fn not_calibrated() -> Failure {
    Failure::new(crate::exit::Exit::Other, "expected a calibration first")
}
