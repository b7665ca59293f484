//! New photographs of a folder that a camera writes into.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A file is complete when its size has not changed for this long.
const STILL: Duration = Duration::from_secs(1);

/// What is known of the files of a folder.
#[derive(Debug)]
pub(super) struct WatchFolder {
    folder: PathBuf,
    files: HashMap<PathBuf, Seen>,
}

#[derive(Debug, Clone, Copy)]
enum Seen {
    Growing { size: u64, since: Instant },
    Taken,
}

impl WatchFolder {
    /// What is in the folder already is not taken.
    pub(super) fn new(folder: &Path) -> std::io::Result<Self> {
        let mut files = HashMap::new();
        for entry in fs::read_dir(folder)? {
            files.insert(entry?.path(), Seen::Taken);
        }
        Ok(Self { folder: folder.to_owned(), files })
    }

    /// The files that have become complete. Links, pipes and hidden files are left alone.
    pub(super) fn new_files(&mut self, now: Instant) -> Vec<PathBuf> {
        let mut complete = Vec::new();
        let Ok(entries) = fs::read_dir(&self.folder) else { return complete };
        for path in entries.flatten().map(|e| e.path()) {
            let hidden = path.file_name().is_none_or(|n| n.to_string_lossy().starts_with('.'));
            // Of the entry itself: a link to a file is none.
            let Some(found) = fs::symlink_metadata(&path).ok().filter(|m| m.is_file() && !hidden) else {
                continue;
            };
            let size = found.len();
            match self.files.get(&path) {
                Some(Seen::Taken) => {}
                Some(Seen::Growing { size: before, since }) if *before == size && size > 0 => {
                    if now.duration_since(*since) >= STILL {
                        self.files.insert(path.clone(), Seen::Taken);
                        complete.push(path);
                    }
                }
                _ => {
                    self.files.insert(path, Seen::Growing { size, since: now });
                }
            }
        }
        complete.sort();
        complete
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_taken_once_when_it_has_stopped_growing() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("old.jpg"), b"old").unwrap();
        let mut watched = WatchFolder::new(folder.path()).unwrap();
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        let path = folder.path().join("new.jpg");
        fs::write(&path, b"1").unwrap();
        assert!(watched.new_files(after(0)).is_empty());
        fs::write(&path, b"12").unwrap();
        assert!(watched.new_files(after(900)).is_empty());
        assert!(watched.new_files(after(1500)).is_empty());
        assert_eq!(watched.new_files(after(2000)), [path]);
        assert!(watched.new_files(after(4000)).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_hidden_files_are_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let mut watched = WatchFolder::new(folder.path()).unwrap();
        fs::write(folder.path().join(".hidden.jpg"), b"x").unwrap();
        std::os::unix::fs::symlink("/etc/hostname", folder.path().join("link.jpg")).unwrap();
        let start = Instant::now();
        for seconds in 0..4 {
            assert!(watched.new_files(start + Duration::from_secs(seconds)).is_empty());
        }
    }
}
