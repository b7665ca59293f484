//! The photographs of one pose or scan under a sequence: a folder.

use std::path::{Path, PathBuf};

use slcal_core::SequencePattern;

use super::folder::photographs;
use crate::exit::{Failure, Outcome};

/// The photographs in a folder, in the order of the sequence's pictures. Those of the names in the sequence are taken where the folder has
/// all of them, and the others are ignored. A folder without any of these names has its photographs in natural order.
pub(crate) fn sequence_files(folder: &Path, sequence: &SequencePattern) -> Outcome<Vec<PathBuf>> {
    if !folder.is_dir() {
        let found = if folder.exists() { "a file" } else { "none of this name" };
        let message =
            format!("expected a folder with the photographs of one pose under the sequence, found {found}");
        return Err(Failure::input(folder, message));
    }
    let named: Option<Vec<PathBuf>> =
        sequence.frames.iter().map(|f| f.file.as_ref().map(|name| folder.join(name))).collect();
    if let Some(files) = named {
        let missing: Vec<&PathBuf> = files.iter().filter(|f| !f.is_file()).collect();
        match missing.as_slice() {
            [] => return Ok(files),
            some if some.len() < files.len() => {
                let name = some[0].file_name().unwrap_or_default().to_string_lossy();
                let found = match some.len() - 1 {
                    0 => format!("all but {name}"),
                    more => format!("all but {name} and {more} more"),
                };
                let n = files.len();
                return Err(Failure::input(
                    folder,
                    format!("expected the {n} photographs that the sequence names, found {found}"),
                ));
            }
            _ => {}
        }
    }
    let files = photographs(&[folder.to_owned()])?;
    let expected = sequence.frames.len();
    if files.len() != expected {
        let message = format!(
            "expected {expected} photographs, one under each picture of the sequence, found {}; a folder holds those of one pose and no others",
            files.len()
        );
        return Err(Failure::input(folder, message));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use slcal_core::SequenceConfig;

    use super::*;

    #[test]
    fn names_of_the_sequence_come_before_the_natural_order() {
        let sequence = SequencePattern::new([4, 4], &SequenceConfig::default()).unwrap();
        assert_eq!(sequence.frames.len(), 6);
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str| std::fs::write(folder.path().join(name), "").unwrap();
        let names = || -> Result<Vec<String>, String> {
            let files = sequence_files(folder.path(), &sequence).map_err(|e| e.to_string())?;
            Ok(files.iter().map(|f| f.file_name().unwrap().to_string_lossy().into_owned()).collect())
        };
        (5..10).for_each(|i| put(&format!("img{i}.png")));
        let error = names().unwrap_err();
        assert!(error.contains("expected 6 photographs") && error.contains("found 5"), "{error}");
        put("img10.png");
        assert_eq!(
            names().unwrap(),
            ["img5.png", "img6.png", "img7.png", "img8.png", "img9.png", "img10.png"]
        );
        (0..5).for_each(|i| put(&format!("frame_00{i}.png")));
        let error = names().unwrap_err();
        assert!(error.contains("all but frame_005.png"), "{error}");
        put("frame_005.png");
        assert_eq!(names().unwrap()[5], "frame_005.png");
        let error = sequence_files(&folder.path().join("img5.png"), &sequence).unwrap_err();
        assert!(error.code() == 3 && error.to_string().contains("found a file"), "{error}");
    }
}
