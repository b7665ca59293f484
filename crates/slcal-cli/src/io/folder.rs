//! Photographs of a folder, or of a name with wildcards that the shell did not expand, in natural order.

use std::fs;
use std::path::{Path, PathBuf};

use slcal_core::pattern::natural_order;

use super::photo_kind::{EXTENSIONS, Foreign};
use crate::exit::{Exit, Failure, Outcome};
use crate::name::{has_extension, is_dash};

/// Expands paths: a folder to its photographs, a name with `*` or `?` to the matching files.
pub(crate) fn photographs(paths: &[PathBuf]) -> Outcome<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if is_dash(path) {
            files.push(path.clone());
        } else if path.is_dir() {
            let expected = "a folder with photographs (PNG, JPEG, TIFF, WebP or BMP)";
            files.extend(of_folder(path, is_named_photo, expected, path)?);
        } else if name.contains(['*', '?']) && !path.exists() {
            let folder = path.parent().unwrap_or(Path::new(""));
            let matching = |file: &Path| matches(&name, &file.to_string_lossy());
            files.extend(of_folder(folder, matching, "files whose names match", path)?);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

/// Whether a file is named as a photograph that is read.
pub(crate) fn is_named_photo(path: &Path) -> bool {
    has_extension(path, &EXTENSIONS)
}

/// All files of a folder, at least one, in natural order.
pub(crate) fn files_of(folder: &Path) -> Outcome<Vec<PathBuf>> {
    of_folder(folder, |_| true, "a folder with files", folder)
}

/// The wanted files of a folder, at least one, in natural order.
fn of_folder(
    folder: &Path,
    wanted: impl Fn(&Path) -> bool,
    expected: &str,
    given: &Path,
) -> Outcome<Vec<PathBuf>> {
    let refused = |found: &str| {
        Failure::new(Exit::Input, format!("{}: expected {expected}, found {found}", given.display()))
    };
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = fs::read_dir(here).map_err(|e| refused(&format!("a folder that cannot be read ({e})")))?;
    let names: Vec<_> = entries.filter_map(|e| Some(PathBuf::from(e.ok()?.file_name()))).collect();
    let mut files: Vec<PathBuf> = names
        .iter()
        .filter(|name| wanted(name))
        .map(|name| folder.join(name))
        .filter(|file| file.is_file())
        .collect();
    if files.is_empty() {
        return Err(match names.iter().find(|name| Foreign::is_named_so(name)) {
            Some(name) => {
                refused(&format!("none, but {}; convert such files to JPEG or PNG first", name.display()))
            }
            None => refused("none"),
        });
    }
    files.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(files)
}

/// Whether a name matches a pattern in which `*` stands for any letters and `?` for one.
fn matches(pattern: &str, name: &str) -> bool {
    let mut rest = pattern.chars();
    match rest.next() {
        None => name.is_empty(),
        Some('*') => {
            let ends = name.char_indices().map(|(i, _)| i).chain([name.len()]);
            ends.into_iter().any(|i| matches(rest.as_str(), &name[i..]))
        }
        Some(letter) => {
            let mut letters = name.chars();
            letters.next().is_some_and(|c| c == letter || letter == '?')
                && matches(rest.as_str(), letters.as_str())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wildcards_stand_for_letters() {
        for (pattern, name, expected) in [
            ("*.jpg", "a.jpg", true),
            ("*.jpg", "a.jpeg", false),
            ("img?.*", "img7.png", true),
            ("img?.*", "img17.png", false),
            ("*a*b*", "xaybz", true),
            ("é*", "épreuve", true),
            ("*", "", true),
        ] {
            assert_eq!(matches(pattern, name), expected, "{pattern} {name}");
        }
    }

    #[test]
    fn a_folder_and_a_pattern_mean_their_photographs() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["p10.JPG", "p9.jpg", "notes.txt", "q.png"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let names = |path: PathBuf| -> Vec<String> {
            let files = photographs(&[path]).unwrap();
            files.iter().map(|f| f.file_name().unwrap().to_string_lossy().into_owned()).collect()
        };
        assert_eq!(names(folder.path().to_owned()), ["p9.jpg", "p10.JPG", "q.png"]);
        assert_eq!(names(folder.path().join("p*")), ["p9.jpg", "p10.JPG"]);
        assert_eq!(photographs(&["-".into(), "absent.png".into()]).unwrap().len(), 2);
        let failure = photographs(&[folder.path().join("*.tif")]).unwrap_err();
        assert!(failure.code() == 3 && failure.to_string().contains("*.tif"), "{failure}");
    }
}
