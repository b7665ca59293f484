//! Outputs: checked before the work, and visible under their name only when complete.

use std::fs::{self, OpenOptions};
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageFormat, RgbImage};
use tempfile::{NamedTempFile, TempPath};

use super::temporary::{Readable, Waiting, temporary, while_they_exist};
use crate::exit::{Exit, Failure, Outcome};
use crate::name::is_dash;
use crate::output::to_stdout;

/// The destination of a result, known to be writable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Destination {
    /// `-`.
    Stdout,
    /// A device or a pipe, written in place.
    Device(PathBuf),
    /// A file that appears under its name when it is complete.
    File {
        /// The name; symbolic links resolved.
        path: PathBuf,
        /// Whether an existing file may be replaced.
        force: bool,
    },
}

impl Destination {
    /// Checks that an output can be written, before any work is done.
    ///
    /// Fails when it exists and `force` is not given, when it is a folder, or when its folder is missing or not writable.
    pub(crate) fn prepare(path: &Path, force: bool) -> Outcome<Self> {
        if is_dash(path) {
            return Ok(Self::Stdout);
        }
        let shown = path.display();
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => {
                return Err(unwritable(path, "it is a folder; give the name of a file in it"));
            }
            Ok(found) if !found.is_file() => return Ok(Self::Device(path.to_owned())),
            Ok(_) if !force => {
                return Err(Failure::new(
                    Exit::Other,
                    format!("{shown}: expected a new file, but it exists; use --force to replace it"),
                ));
            }
            Err(_) if fs::symlink_metadata(path).is_ok_and(|m| m.is_symlink()) => {
                return Err(unwritable(path, "it is a link to a file that does not exist; remove it first"));
            }
            _ => {}
        }
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if path.file_name().is_none() {
            return Err(unwritable(&path, "it names no file"));
        }
        let folder = folder_of(&path);
        if !folder.is_dir() {
            let why = format!("the folder {} does not exist; create it first", folder.display());
            return Err(unwritable(&path, &why));
        }
        // The only portable test of permission; the file is removed at the end of the statement.
        let _held = while_they_exist();
        temporary(folder, Readable::AsUsual).map_err(|e| {
            unwritable(&path, &format!("nothing can be written into {} ({})", folder.display(), e.kind()))
        })?;
        Ok(Self::File { path, force })
    }

    /// The same for an optional picture, which must be a file, because stdout is for the result.
    pub(crate) fn prepare_overlay(path: Option<&PathBuf>, force: bool) -> Outcome<Option<Self>> {
        Self::prepare_beside("--overlay", path, force)
    }

    /// The same for an optional report.
    pub(crate) fn prepare_report(path: Option<&PathBuf>, force: bool) -> Outcome<Option<Self>> {
        Self::prepare_beside("--report", path, force)
    }

    /// The same for an optional depth image.
    pub(crate) fn prepare_depth(path: Option<&PathBuf>, force: bool) -> Outcome<Option<Self>> {
        Self::prepare_beside("--depth", path, force)
    }

    fn prepare_beside(option: &str, path: Option<&PathBuf>, force: bool) -> Outcome<Option<Self>> {
        let place = path.map(|p| Self::prepare(p, force)).transpose()?;
        if place == Some(Self::Stdout) {
            return Err(Failure::usage(format!(
                "{option}: expected a file, found -; stdout is for the result"
            )));
        }
        Ok(place)
    }

    /// The same place with another extension, under the same rules.
    pub(crate) fn beside(&self, extension: &str) -> Outcome<Option<Self>> {
        match self {
            Self::File { path, force } => Self::prepare(&path.with_extension(extension), *force).map(Some),
            Self::Stdout | Self::Device(_) => Ok(None),
        }
    }

    /// Its name in messages.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Stdout => "stdout".to_owned(),
            Self::Device(path) | Self::File { path, .. } => path.display().to_string(),
        }
    }
}

/// Refuses two outputs with the same file.
pub(crate) fn check_distinct<'a>(destinations: impl IntoIterator<Item = &'a Destination>) -> Outcome {
    let mut seen = Vec::new();
    for destination in destinations {
        if !matches!(destination, Destination::Device(_)) && seen.contains(&destination) {
            return Err(Failure::usage(format!(
                "{} is the output of two results; use separate files",
                destination.name()
            )));
        }
        seen.push(destination);
    }
    Ok(())
}

/// Refuses `--json` together with an output on stdout.
pub(crate) fn check_json(json: bool, output: &Destination) -> Outcome {
    if json && *output == Destination::Stdout {
        return Err(Failure::usage("--json and -o - both print to stdout; use one of them"));
    }
    Ok(())
}

/// Refuses an output that would replace an input, even with `--force`.
pub(crate) fn check_spares<'a>(
    destinations: impl IntoIterator<Item = &'a Destination>,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Outcome {
    let inputs: Vec<PathBuf> = inputs.into_iter().filter_map(|p| fs::canonicalize(p).ok()).collect();
    for destination in destinations {
        if let Destination::File { path, .. } = destination
            && inputs.contains(path)
        {
            return Err(Failure::usage(format!(
                "{} is an input and would be replaced by an output; use another name for the output",
                path.display()
            )));
        }
    }
    Ok(())
}

/// Writes all results or none: all temporary files are complete before the first gets its final name, and if one cannot get it,
/// those that have it lose it again.
pub(crate) fn write_all(files: &[(Destination, Vec<u8>)]) -> Outcome {
    // Declared first, so that it is dropped after the temporary files.
    let _held = while_they_exist();
    let mut ready = Vec::new();
    for (destination, bytes) in files {
        if let Destination::File { path, force } = destination {
            let file = complete(path, bytes).map_err(|e| unwritable(path, &e.to_string()))?;
            ready.push((file, path.clone(), *force));
        }
    }
    appear(ready, files)
}

/// Many results that appear together, or not at all: each is written when it is made, so that memory holds one of them. A signal
/// between two of them ends the run, and removes them.
#[derive(Default)]
pub(crate) struct Together {
    ready: Vec<(NamedTempFile, PathBuf, bool)>,
    waiting: Vec<Waiting>,
    in_place: Vec<(Destination, Vec<u8>)>,
}

impl Together {
    /// Writes a result under a temporary name. What is written in place, into devices and pipes, is kept until
    /// [`appear`](Self::appear).
    pub(crate) fn add(&mut self, destination: Destination, bytes: Vec<u8>) -> Outcome {
        let Destination::File { path, force } = destination else {
            self.in_place.push((destination, bytes));
            return Ok(());
        };
        let _held = while_they_exist();
        let file = complete(&path, &bytes).map_err(|e| unwritable(&path, &e.to_string()))?;
        self.waiting.push(Waiting::new(file.path()));
        self.ready.push((file, path, force));
        Ok(())
    }

    /// Gives all of them their names.
    pub(crate) fn appear(self) -> Outcome {
        let _held = while_they_exist();
        drop(self.waiting);
        appear(self.ready, &self.in_place)
    }
}

/// Gives complete files their names, after writing what is written in place among `files`.
fn appear(ready: Vec<(NamedTempFile, PathBuf, bool)>, files: &[(Destination, Vec<u8>)]) -> Outcome {
    // What is written in place cannot be taken back; a reader that has gone is no reason to withhold the rest.
    let printed = match files.iter().try_for_each(|(place, bytes)| write_in_place(place, bytes)) {
        Err(failure) if !matches!(failure, Failure::ClosedPipe) => return Err(failure),
        printed => printed,
    };
    let mut replaced = Vec::new();
    for (file, path, force) in ready {
        match Replaced::by(file, &path, force) {
            Ok(done) => replaced.push(done),
            Err(e) => {
                replaced.into_iter().rev().for_each(Replaced::undo);
                return Err(unwritable(&path, &e.to_string()));
            }
        }
    }
    printed
}

/// A temporary file with all of its bytes on the disk.
fn complete(path: &Path, bytes: &[u8]) -> std::io::Result<NamedTempFile> {
    let mut file = temporary(folder_of(path), Readable::AsUsual)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    Ok(file)
}

fn write_in_place(destination: &Destination, bytes: &[u8]) -> Outcome {
    match destination {
        Destination::Stdout => to_stdout(|out| out.write_all(bytes)),
        Destination::Device(path) => OpenOptions::new()
            .write(true)
            .open(path)
            .and_then(|mut f| f.write_all(bytes))
            .map_err(|e| unwritable(path, &e.to_string())),
        Destination::File { .. } => Ok(()),
    }
}

/// A file that has its final name, and what had it before.
struct Replaced {
    path: PathBuf,
    /// A second name of the earlier file, where there was one and the file system can do this.
    earlier: Option<TempPath>,
    is_new: bool,
}

impl Replaced {
    fn by(file: NamedTempFile, path: &Path, force: bool) -> std::io::Result<Self> {
        let is_new = fs::symlink_metadata(path).is_err();
        let earlier = if force && !is_new { second_name(path) } else { None };
        let done = if force { file.persist(path) } else { file.persist_noclobber(path) };
        done.map_err(|e| e.error)?;
        Ok(Self { path: path.to_owned(), earlier, is_new })
    }

    /// As it was before, as far as possible.
    fn undo(self) {
        if let Some(earlier) = self.earlier {
            let _ = earlier.persist(&self.path);
        } else if self.is_new {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// A second name for a file, beside it.
fn second_name(path: &Path) -> Option<TempPath> {
    let name = temporary(folder_of(path), Readable::AsUsual).ok()?.into_temp_path();
    fs::remove_file(&name).ok()?;
    fs::hard_link(path, &name).ok()?;
    Some(name)
}

/// Writes or replaces one file completely or not at all; a device or a pipe is written in place.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // A link stays one.
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if fs::metadata(&path).is_ok_and(|m| !m.is_file()) {
        return OpenOptions::new().write(true).open(&path).and_then(|mut f| f.write_all(bytes));
    }
    // The error then names the folder, not the temporary file.
    fs::metadata(folder_of(&path))?;
    let _held = while_they_exist();
    complete(&path, bytes)?.persist(&path).map(|_| ()).map_err(|e| e.error)
}

/// The same for a file that only this user can read.
#[cfg(feature = "studio")]
pub(crate) fn write_private(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let _held = while_they_exist();
    let mut file = temporary(folder_of(path), Readable::ByUser)?;
    file.write_all(bytes)?;
    file.persist(path).map(|_| ()).map_err(|e| e.error)
}

/// The bytes that a writer of the core writes.
pub(crate) fn bytes_of(write: impl FnOnce(&mut Vec<u8>) -> slcal_core::Result<()>) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    write(&mut bytes)?;
    Ok(bytes)
}

/// Makes a folder for outputs when it does not exist; its parent must exist.
pub(crate) fn make_folder(folder: &Path) -> Outcome {
    if folder.is_dir() {
        return Ok(());
    }
    fs::create_dir(folder).map_err(|e| {
        Failure::new(
            Exit::Other,
            format!("{}: expected a folder for the outputs, but it cannot be created: {e}", folder.display()),
        )
    })
}

/// A picture as the bytes of a PNG file.
pub(crate) fn png_bytes(picture: &DynamicImage) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .map_err(|e| Failure::new(Exit::Other, format!("cannot encode the picture as PNG: {e}")))?;
    Ok(bytes)
}

/// Quality of a JPEG file that is measured in later.
#[cfg(feature = "studio")]
pub(crate) const PHOTO_QUALITY: u8 = 95;

/// A picture as the bytes of a JPEG file.
pub(crate) fn jpeg_bytes(picture: &RgbImage, quality: u8) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode_image(picture)
        .map_err(|e| Failure::new(Exit::Other, format!("cannot encode the picture as JPEG: {e}")))?;
    Ok(bytes)
}

fn unwritable(path: &Path, why: &str) -> Failure {
    Failure::new(Exit::Other, format!("{}: expected a place for the output, but {why}", path.display()))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_existing_file_is_replaced_only_when_forced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_all(&[(Destination::prepare(&path, false).unwrap(), b"one".to_vec())]).unwrap();
        assert!(Destination::prepare(&path, false).unwrap_err().to_string().contains("--force"));
        write_all(&[(Destination::prepare(&path, true).unwrap(), b"two".to_vec())]).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_found_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let failure = Destination::prepare(&folder.path().join("none/a.txt"), true).unwrap_err();
        assert!(failure.to_string().contains("does not exist"), "{failure}");
        assert_eq!(failure.code(), 1);
        assert!(Destination::prepare(folder.path(), true).is_err());
    }

    #[test]
    fn a_result_that_cannot_appear_takes_the_others_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("old.txt"), "old").unwrap();
        let places =
            ["new.txt", "old.txt", "late.txt"].map(|n| Destination::prepare(&path(n), true).unwrap());
        // The last one is taken by a folder while the work is done.
        fs::create_dir_all(path("late.txt/inside")).unwrap();
        let files: Vec<_> = places.into_iter().map(|place| (place, b"text".to_vec())).collect();
        let failure = write_all(&files).unwrap_err();
        assert!(failure.code() == 1 && failure.to_string().contains("late.txt"), "{failure}");
        assert!(!path("new.txt").exists());
        assert_eq!(fs::read(path("old.txt")).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn many_results_appear_together_or_leave_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| Destination::prepare(&folder.path().join(name), false).unwrap();
        let names = || {
            let entries = fs::read_dir(folder.path()).unwrap();
            let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
            names.sort();
            names
        };
        let mut made = Together::default();
        made.add(place("a"), b"one".to_vec()).unwrap();
        made.add(place("b"), b"two".to_vec()).unwrap();
        assert!(names().iter().all(|n| n.starts_with(".slcal-")) && names().len() == 2, "{:?}", names());
        made.appear().unwrap();
        assert_eq!(names(), ["a", "b"]);
        // The work fails after the first.
        let mut broken = Together::default();
        broken.add(place("c"), b"three".to_vec()).unwrap();
        drop(broken);
        assert_eq!(names(), ["a", "b"]);
        // A name is taken while the work is done.
        let mut late = Together::default();
        late.add(place("c"), b"three".to_vec()).unwrap();
        late.add(place("d"), b"four".to_vec()).unwrap();
        fs::write(folder.path().join("d"), "mine").unwrap();
        assert!(late.appear().unwrap_err().to_string().contains('d'));
        assert_eq!(names(), ["a", "b", "d"]);
        assert_eq!(fs::read(folder.path().join("d")).unwrap(), b"mine");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nowhere_is_found_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::os::unix::fs::symlink("none/b", &path).unwrap();
        for force in [false, true] {
            let failure = Destination::prepare(&path, force).unwrap_err();
            assert!(failure.code() == 1 && failure.to_string().contains("link"), "{failure}");
        }
    }

    #[test]
    fn one_output_for_two_results_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let a = Destination::prepare(&folder.path().join("a"), false).unwrap();
        assert!(check_distinct([&a, &a.clone()]).is_err());
        assert!(check_distinct([&a, &Destination::Stdout]).is_ok());
    }
}
