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

/// To be held as long as temporary files exist.
pub(super) fn while_they_exist() -> RwLockReadGuard<'static, ()> {
    EXIST.read().unwrap_or_else(PoisonError::into_inner)
}

/// Waits until there are none, and lets nobody make another one.
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
