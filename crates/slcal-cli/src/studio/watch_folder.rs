//! New photographs of a folder that a camera writes into.

use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::fs::{self, File, Metadata};
use std::hash::Hasher as _;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// A file is complete when its size has not changed for this long.
const STILL: Duration = Duration::from_secs(1);

/// What is known of the files of a folder.
#[derive(Debug)]
pub(super) struct WatchFolder {
    folder: PathBuf,
    files: HashMap<PathBuf, Seen>,
}

/// What changes when a file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stamp {
    size: u64,
    modified: Option<SystemTime>,
}

impl From<&Metadata> for Stamp {
    fn from(of: &Metadata) -> Self {
        Self { size: of.len(), modified: of.modified().ok() }
    }
}

#[derive(Debug, Clone, Copy)]
struct Seen {
    stamp: Stamp,
    /// Since when it is so.
    since: Instant,
    is: Is,
    /// Of the content that was taken last.
    content: Option<u64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Is {
    Growing,
    Taken,
}

impl WatchFolder {
    /// What is in the folder already is not taken.
    pub(super) fn new(folder: &Path) -> io::Result<Self> {
        let (mut files, since) = (HashMap::new(), Instant::now());
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            // What cannot be looked at counts once it has been written.
            let stamp = fs::symlink_metadata(&path)
                .map_or(Stamp { size: 0, modified: None }, |found| Stamp::from(&found));
            files.insert(path, Seen { stamp, since, is: Is::Taken, content: None });
        }
        Ok(Self { folder: folder.to_owned(), files })
    }

    /// The files that have become complete, also under a name that was used before: cameras begin anew at IMG_0001.
    /// Links, pipes and hidden files are left alone.
    pub(super) fn new_files(&mut self, now: Instant) -> Vec<PathBuf> {
        let mut complete = Vec::new();
        let Ok(entries) = fs::read_dir(&self.folder) else { return complete };
        for path in entries.flatten().map(|e| e.path()) {
            let hidden = path.file_name().is_none_or(|n| n.to_string_lossy().starts_with('.'));
            // Of the entry itself: a link to a file is none.
            let Some(found) = fs::symlink_metadata(&path).ok().filter(|m| m.is_file() && !hidden) else {
                continue;
            };
            let stamp = Stamp::from(&found);
            let growing = |content| Seen { stamp, since: now, is: Is::Growing, content };
            let seen = self.files.entry(path.clone()).or_insert_with(|| growing(None));
            if seen.stamp != stamp {
                *seen = growing(seen.content);
            } else if seen.is == Is::Growing && stamp.size > 0 && now.duration_since(seen.since) >= STILL {
                let content = content_of(&path).ok();
                // Touched, copied onto itself: the same photograph.
                if content.is_none() || content != seen.content {
                    complete.push(path);
                }
                *seen = Seen { is: Is::Taken, content, ..*seen };
            }
        }
        complete.sort();
        complete
    }
}

/// A number that differs where the content does.
fn content_of(path: &Path) -> io::Result<u64> {
    let (mut file, mut hasher, mut part) = (File::open(path)?, DefaultHasher::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut part)? {
            0 => return Ok(hasher.finish()),
            n => hasher.write(&part[..n]),
        }
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

    #[test]
    fn a_name_that_is_used_again_is_another_photograph() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("IMG_0001.jpg");
        fs::write(&path, b"before").unwrap();
        let mut watched = WatchFolder::new(folder.path()).unwrap();
        let start = Instant::now();
        let mut seconds = 0;
        let mut after_writing = |content: &[u8], stamp: u64| {
            fs::write(&path, content).unwrap();
            let file = File::options().write(true).open(&path).unwrap();
            file.set_modified(SystemTime::UNIX_EPOCH + Duration::from_secs(stamp)).unwrap();
            (0..3).fold(Vec::new(), |mut all, _| {
                seconds += 1;
                all.extend(watched.new_files(start + Duration::from_secs(seconds)));
                all
            })
        };
        let once = std::slice::from_ref(&path);
        assert_eq!(after_writing(b"first", 1), once);
        assert!(after_writing(b"first", 2).is_empty(), "touched");
        assert_eq!(after_writing(b"other", 3), once, "of the same size");
        assert_eq!(after_writing(b"and longer", 3), once);
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
