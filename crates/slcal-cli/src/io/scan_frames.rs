//! The photographs of a sequence: which file is which frame.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use slcal_core::pattern::SequencePattern;

use super::folder::photographs;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::name::{input_name, is_dash};

/// The photographs of one scan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ScanFrames {
    /// What the scan is called: its folder, or the first of its files.
    pub(crate) name: PathBuf,
    /// One per frame, in the order of the pattern.
    pub(crate) files: Vec<PathBuf>,
}

/// The scans that are given: each folder is one, or all files together are one.
pub(crate) fn scans(paths: &[PathBuf], pattern: &SequencePattern) -> Outcome<Vec<ScanFrames>> {
    if paths.iter().any(|p| is_dash(p)) {
        return Err(Failure::usage(
            "the frames of a sequence come from files or folders, not from stdin (-)",
        ));
    }
    let folders = paths.iter().filter(|p| p.is_dir()).count();
    if folders == paths.len() {
        return paths.iter().map(|folder| of_folder(folder, pattern)).collect();
    }
    if folders > 0 {
        return Err(Failure::usage(
            "expected folders, each with the frames of a scan, or the frames of one scan, found both",
        ));
    }
    let files = photographs(paths)?;
    let name = files.first().cloned().unwrap_or_default();
    let mut seen = HashMap::new();
    for (i, file) in files.iter().enumerate() {
        if let Some(before) = seen.insert(file, i) {
            let message = format!("expected each frame once, found it as frames {before} and {i}");
            return Err(Failure::input(file, message));
        }
    }
    check_count(&name, files.len(), pattern)?;
    Ok(vec![ScanFrames { name, files }])
}

/// The photographs of one pose in a folder, one per frame.
pub(crate) fn sequence_files(folder: &Path, pattern: &SequencePattern) -> Outcome<Vec<PathBuf>> {
    if !folder.is_dir() {
        let found = if folder.exists() { "a file" } else { "none of this name" };
        let message =
            format!("expected a folder with the photographs of one pose under the sequence, found {found}");
        return Err(Failure::input(folder, message));
    }
    of_folder(folder, pattern).map(|scan| scan.files)
}

/// The photographs of a folder, as the pattern orders them by their names.
fn of_folder(folder: &Path, pattern: &SequencePattern) -> Outcome<ScanFrames> {
    let all = photographs(&[folder.to_owned()])?;
    let name =
        |file: &PathBuf| file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let names: Vec<String> = all.iter().map(name).collect();
    let order = pattern.frame_order(&names).in_file(folder)?;
    Ok(ScanFrames { name: folder.to_owned(), files: order.into_iter().map(|i| all[i].clone()).collect() })
}

fn check_count(name: &Path, found: usize, pattern: &SequencePattern) -> Outcome {
    let expected = pattern.frames.len();
    if found == expected {
        return Ok(());
    }
    let message = format!(
        "{}: expected the {expected} frames of the pattern, found {found} photographs; is one missing, or the pattern file another one?",
        input_name(name)
    );
    Err(Failure::new(Exit::Input, message))
}

#[cfg(test)]
mod tests {
    use super::*;
    use slcal_core::pattern::SequenceConfig;
    use std::fs;

    #[test]
    fn frames_are_found_by_their_names_or_by_their_order() {
        let mut pattern = SequencePattern::new([4, 3], &SequenceConfig::default()).unwrap();
        assert_eq!(pattern.frames.len(), 6);
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        for i in 0..6 {
            fs::write(place(&format!("frame_{i:03}.JPG")), "").unwrap();
        }
        fs::write(place("truth.png"), "").unwrap();
        let given = [folder.path().to_owned()];
        let found = scans(&given, &pattern).unwrap();
        assert_eq!((found.len(), found[0].files.len(), &found[0].files[5]), (1, 6, &place("frame_005.JPG")));
        fs::remove_file(place("frame_004.JPG")).unwrap();
        let failure = scans(&given, &pattern).unwrap_err().to_string();
        assert!(failure.contains("frame_004.png (frame 4, bit 0 of the columns)"), "{failure}");
        // Now all photographs count.
        pattern.frames.iter_mut().for_each(|f| f.file = None);
        assert_eq!(scans(&given, &pattern).unwrap()[0].files[5], place("truth.png"));
        fs::remove_file(place("truth.png")).unwrap();
        let failure = scans(&given, &pattern).unwrap_err().to_string();
        assert!(failure.contains("expected the 6 frames") && failure.contains("found 5"), "{failure}");
        let files: Vec<PathBuf> = [0, 1, 2, 3, 5, 5].map(|i| place(&format!("frame_{i:03}.JPG"))).to_vec();
        assert!(scans(&files, &pattern).unwrap_err().to_string().contains("frames 4 and 5"));
        assert!(scans(&[given[0].clone(), files[0].clone()], &pattern).is_err());
    }
}
