//! The project's folder: everything lies in it as it is made, and the next start continues from it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::state::{CameraKind, ScanMethod, Step};
use crate::exit::{Exit, Failure, Outcome};
use crate::io::input_kind::read_input;
use crate::io::{InputKind, write_whole};
use crate::name::STUDIO_COMMANDS;

/// The settings that photographs and results do not tell.
const SETTINGS: &str = "studio.json";
/// Held while a studio works in the folder.
const LOCK: &str = ".slcal-studio.lock";
/// Largest number of a photograph.
const MOST_PHOTOS: u32 = 999_999;
const SETTINGS_SCHEMA: &str = "slcal-studio-settings/1";

/// What photographs show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Purpose {
    Sheet,
    Scan,
    /// A scan under a picture of a sequence.
    Frame {
        scan: u32,
        frame: usize,
    },
}

impl Purpose {
    /// First part of their names.
    fn stem(self) -> &'static str {
        match self {
            Self::Sheet => "sheet",
            Self::Scan | Self::Frame { .. } => "scan",
        }
    }

    /// The number in a name without its extension: of `scan-003`.
    pub(super) fn number(self, stem: &str) -> Option<u32> {
        let number = stem.strip_prefix(self.stem())?.strip_prefix('-')?;
        let digits = number.len() >= 3 && number.bytes().all(|b| b.is_ascii_digit());
        number.parse().ok().filter(|id| digits && *id <= MOST_PHOTOS)
    }
}

/// Settings as they are kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Settings {
    pub(super) schema: String,
    pub(super) projector: Option<[u32; 2]>,
    pub(super) size: Option<String>,
    #[serde(default = "one")]
    pub(super) pattern_scale: f64,
    pub(super) camera: Option<CameraKind>,
    pub(super) step: Step,
    #[serde(default)]
    pub(super) demo: bool,
    /// Photographs that were left out by hand.
    #[serde(default)]
    pub(super) left_out: Vec<String>,
    #[serde(default)]
    pub(super) picture: Option<String>,
    #[serde(default)]
    pub(super) picture_file: Option<String>,
    #[serde(default)]
    pub(super) scan_method: ScanMethod,
}

fn one() -> f64 {
    1.0
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            schema: SETTINGS_SCHEMA.into(),
            projector: None,
            size: None,
            pattern_scale: 1.0,
            camera: None,
            step: Step::SetUp,
            demo: false,
            left_out: Vec::new(),
            picture: None,
            picture_file: None,
            scan_method: ScanMethod::Stripes,
        }
    }
}

/// A photograph in the folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct StoredPhoto {
    pub(super) id: u32,
    pub(super) name: String,
}

/// A folder that this studio has for itself.
#[derive(Debug)]
pub(super) struct Project {
    folder: PathBuf,
    /// Locked until it is dropped, or the process ends in whatever way.
    _lock: File,
    /// Held from the choice of a photograph's name until it has it.
    pub(super) naming: Mutex<()>,
}

impl Project {
    /// Opens or makes the folder.
    ///
    /// Fails when another studio works in it, when it cannot be written, and when its settings are not those of a studio.
    pub(super) fn open(folder: &Path) -> Outcome<(Self, Settings)> {
        let failed = |what: &str, e: &dyn std::fmt::Display| {
            Failure::new(Exit::Other, format!("{}: {what}: {e}", folder.display()))
        };
        fs::create_dir_all(folder).map_err(|e| failed("expected a folder for the project", &e))?;
        let lock = OpenOptions::new()
            .create(true)
            .truncate(false)
            .write(true)
            .open(folder.join(LOCK))
            .map_err(|e| failed("expected a folder that can be written", &e))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(failed(
                    "expected a folder that nobody works in",
                    &"another slcal studio has it open; use its window, or another --dir",
                ));
            }
            Err(TryLockError::Error(e)) => return Err(failed("cannot lock the folder", &e)),
        }
        let settings = match read_input(&folder.join(SETTINGS), InputKind::Own) {
            Ok(bytes) => serde_json::from_slice::<Settings>(&bytes)
                .ok()
                .filter(|s| s.schema == SETTINGS_SCHEMA)
                .ok_or_else(|| {
                    Failure::new(
                        Exit::Input,
                        format!(
                            "{}: expected the settings of a studio ({SETTINGS_SCHEMA}); remove the file, or use another --dir",
                            folder.join(SETTINGS).display()
                        ),
                    )
                })?,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Settings::default(),
            Err(e) => return Err(failed("cannot read its settings", &e)),
        };
        Ok((Self { folder: folder.to_owned(), _lock: lock, naming: Mutex::new(()) }, settings))
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes a file completely or not at all.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Outcome {
        write_whole(&self.path(name), bytes).map_err(|e| {
            Failure::new(Exit::Other, format!("{}: cannot be written: {e}", self.path(name).display()))
        })
    }

    /// Removes files that no longer hold.
    pub(super) fn remove(&self, names: &[&str]) {
        for name in names {
            // What is not there need not go.
            let _ = fs::remove_file(self.path(name));
        }
    }

    pub(super) fn read(&self, name: &str) -> std::io::Result<Vec<u8>> {
        read_input(&self.path(name), InputKind::Own)
    }

    /// Keeps the settings.
    pub(super) fn save(&self, settings: &Settings) -> Outcome {
        let text = serde_json::to_vec_pretty(settings)
            .map_err(|e| Failure::new(Exit::Other, format!("the settings are not valid JSON: {e}")))?;
        self.write(SETTINGS, &text)
    }

    /// Adds a command to the log.
    pub(super) fn log(&self, command: &str) -> Outcome {
        let path = self.path(STUDIO_COMMANDS);
        OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .and_then(|mut file| writeln!(file, "{command}"))
            .map_err(|e| Failure::new(Exit::Other, format!("{}: cannot be written: {e}", path.display())))
    }

    /// Keeps a photograph as it came, under the next free name of its kind; that of a sequence in the folder of its scan.
    pub(super) fn keep(&self, purpose: Purpose, bytes: &[u8], extension: &str) -> Outcome<StoredPhoto> {
        if let Purpose::Frame { scan, frame } = purpose {
            return self.keep_frame(scan, frame, bytes, extension);
        }
        let _alone = self.naming.lock().unwrap_or_else(PoisonError::into_inner);
        let id = self.next_id(purpose);
        let name = format!("{}-{id:03}.{extension}", purpose.stem());
        self.write(&name, bytes)?;
        Ok(StoredPhoto { id, name })
    }

    /// The number after the last one of a kind: photographs and folders of scans share theirs.
    pub(super) fn next_id(&self, purpose: Purpose) -> u32 {
        let photos = self.photos(purpose).into_iter().map(|p| p.id);
        let folders = (purpose != Purpose::Sheet).then(|| self.scan_folders()).into_iter().flatten();
        photos.chain(folders.map(|folder| folder.id)).max().map_or(1, |id| id + 1)
    }

    /// The photographs of a kind, in the order of their numbers; none of sequences.
    pub(super) fn photos(&self, purpose: Purpose) -> Vec<StoredPhoto> {
        const EXTENSIONS: [&str; 5] = ["jpg", "png", "tif", "webp", "bmp"];
        let names = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut all: Vec<StoredPhoto> = names
            .filter_map(|entry| {
                let name = entry.file_name().into_string().ok()?;
                let (stem, extension) = name.rsplit_once('.')?;
                let id = purpose.number(stem)?;
                if !EXTENSIONS.contains(&extension) {
                    return None;
                }
                Some(StoredPhoto { id, name })
            })
            .collect();
        all.sort_by_key(|p| p.id);
        all
    }
}

/// The file of a scan's cloud.
pub(super) fn cloud_name(id: u32, extension: &str) -> String {
    format!("{}-{id:03}.{extension}", Purpose::Scan.stem())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_studio_is_kept_out_and_the_next_one_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("work");
        let (project, mut settings) = Project::open(&dir).unwrap();
        assert_eq!(settings, Settings::default());
        let refused = Project::open(&dir).unwrap_err();
        assert!(refused.code() == 1 && refused.to_string().contains("another"), "{refused}");
        settings.size = Some("A4".into());
        project.save(&settings).unwrap();
        let first = project.keep(Purpose::Sheet, b"one", "jpg").unwrap();
        assert_eq!((first.id, first.name.as_str()), (1, "sheet-001.jpg"));
        project.keep(Purpose::Scan, b"two", "png").unwrap();
        assert_eq!(project.keep(Purpose::Sheet, b"three", "png").unwrap().name, "sheet-002.png");
        drop(project);
        let (project, again) = Project::open(&dir).unwrap();
        assert_eq!(again, settings);
        let names: Vec<String> = project.photos(Purpose::Sheet).into_iter().map(|p| p.name).collect();
        assert_eq!(names, ["sheet-001.jpg", "sheet-002.png"]);
        assert_eq!(project.photos(Purpose::Scan).len(), 1);
    }

    #[test]
    fn settings_of_something_else_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(SETTINGS), b"{\"schema\":\"other/1\"}").unwrap();
        assert_eq!(Project::open(folder.path()).unwrap_err().code(), 3);
    }
}
