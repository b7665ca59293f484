//! Temporary files beside their destination: locked while their run works, removed by the next run when it was killed.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use tempfile::NamedTempFile;

const PREFIX: &str = ".slcal-";
const SUFFIX: &str = ".part";

/// How often a file is made anew that was taken for a remainder before it was locked.
const ATTEMPTS: usize = 10;

/// Held for reading while temporary files exist, so that a signal waits until they are gone.
static EXIST: RwLock<()> = RwLock::new(());

/// The folders from which this process has removed remainders.
static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Complete files that wait for others before they get their names, in a run that goes on between them.
static WAITING: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// A complete file that waits for others. A signal does not wait for them: it removes it.
pub(super) struct Waiting(PathBuf);

impl Waiting {
    /// Of a temporary file.
    pub(super) fn new(path: &Path) -> Self {
        // The working directory may change.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        WAITING.lock().unwrap_or_else(PoisonError::into_inner).insert(path.clone());
        Self(path)
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        WAITING.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.0);
    }
}

/// Removes the files that wait. To be called when the run ends without them.
pub(super) fn remove_waiting() {
    for path in &*WAITING.lock().unwrap_or_else(PoisonError::into_inner) {
        let _ = fs::remove_file(path);
    }
}

/// To be held as long as temporary files exist that do not [wait](Waiting).
pub(super) fn while_they_exist() -> RwLockReadGuard<'static, ()> {
    EXIST.read().unwrap_or_else(PoisonError::into_inner)
}

/// Waits until there are none but those that [wait](Waiting), and lets nobody make another one.
pub(super) fn none_exist() -> RwLockWriteGuard<'static, ()> {
    EXIST.write().unwrap_or_else(PoisonError::into_inner)
}

/// Who can read a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Readable {
    /// Everybody who can read a plain new file.
    AsUsual,
    /// This user alone.
    #[cfg(feature = "studio")]
    ByUser,
}

/// A temporary file in the folder, which this process holds locked. Remainders of killed runs are removed first.
pub(super) fn temporary(folder: &Path, readable: Readable) -> std::io::Result<NamedTempFile> {
    sweep_once(folder);
    let mut made = create(folder, readable)?;
    for _ in 0..ATTEMPTS {
        // A file system without locks has no sweepers either.
        if let Err(TryLockError::WouldBlock) = made.as_file().try_lock() {
            made.as_file().lock()?;
        }
        // Another run may have taken it for a remainder in the moment before it was locked.
        if fs::symlink_metadata(made.path()).is_ok() {
            break;
        }
        made = create(folder, readable)?;
    }
    Ok(made)
}

fn create(folder: &Path, readable: Readable) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    if readable == Readable::AsUsual {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    #[cfg(not(unix))]
    let _ = readable;
    builder.tempfile_in(folder)
}

/// Removes what killed runs have left in a folder, once per process.
fn sweep_once(folder: &Path) {
    let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    let mut swept = SWEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if swept.insert(folder.clone()) {
        sweep(&folder);
    }
}

/// Removes the temporary files that nobody holds locked. What cannot be removed stays.
fn sweep(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let name = entry.file_name();
        let ours = name.to_str().is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(SUFFIX));
        if !ours || !entry.file_type().is_ok_and(|t| t.is_file()) {
            continue;
        }
        let path = entry.path();
        let unlocked = |file: &File| file.try_lock().is_ok();
        if File::open(&path).is_ok_and(|file| unlocked(&file)) {
            let _ = fs::remove_file(&path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn remainders_are_removed_and_what_is_in_use_stays() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join(".slcal-dead.part"), "half a cloud").unwrap();
        fs::write(folder.join(".slcal-studio.lock"), "").unwrap();
        fs::write(folder.join("slcal-mine.part"), "").unwrap();
        fs::create_dir(folder.join(".slcal-folder.part")).unwrap();
        let held = create(folder, Readable::AsUsual).unwrap();
        held.as_file().lock().unwrap();
        let made = temporary(folder, Readable::AsUsual).unwrap();
        let found = names(folder);
        assert!(!found.contains(&".slcal-dead.part".to_owned()), "{found:?}");
        assert_eq!(found.len(), 5, "{found:?}");
        // What a run makes is safe from the next one at once.
        sweep(folder);
        assert!(made.path().exists() && held.path().exists());
        drop((made, held));
        assert_eq!(names(folder), [".slcal-folder.part", ".slcal-studio.lock", "slcal-mine.part"]);
    }

    #[test]
    fn files_that_wait_are_known_until_they_have_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let made = ["a", "b"].map(|name| {
            let path = folder.path().join(name);
            fs::write(&path, "").unwrap();
            Waiting::new(&path)
        });
        let is_known = |waiting: &Waiting| WAITING.lock().unwrap().contains(&waiting.0);
        assert!(made.iter().all(is_known));
        let [first, second] = made;
        let path = first.0.clone();
        drop(first);
        assert!(is_known(&second) && !WAITING.lock().unwrap().contains(&path));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("precious"), "1").unwrap();
        std::os::unix::fs::symlink("precious", folder.join(".slcal-link.part")).unwrap();
        sweep(folder);
        assert_eq!(names(folder), [".slcal-link.part", "precious"]);
    }
}
