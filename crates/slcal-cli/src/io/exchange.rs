//! The paths of files of other programs: one file, one per device, or a folder.

use std::path::{Path, PathBuf};

use crate::name::{has_extension, is_dash};
use slcal_core::format::{ExchangeFormat, StorageText};
use slcal_core::{Error, ErrorSubject, Result};

/// The files of a COLMAP model, the last one optional.
const COLMAP: [&str; 3] = ["cameras.txt", "images.txt", "points3D.txt"];
/// The files of a rig for ROS, the last one optional.
const ROS: [&str; 2] = ["camera.yaml", "projector.yaml"];

/// The paths of an export.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportPlaces {
    /// The folder of the files, which may have to be created.
    pub folder: Option<PathBuf>,
    /// A path for each file, in their order.
    pub paths: Vec<PathBuf>,
}

fn misnamed(expected: impl Into<String>, path: &Path) -> Error {
    Error::invalid("output", expected, path.display())
}

/// The syntax of FileStorage, by the name of the output.
///
/// # Errors
/// [`Error::Invalid`] that lists the extensions.
pub fn storage_of(path: &Path) -> Result<StorageText> {
    if is_dash(path) || has_extension(path, &["yml", "yaml"]) {
        Ok(StorageText::Yaml)
    } else if has_extension(path, &["xml"]) {
        Ok(StorageText::Xml)
    } else if has_extension(path, &["json"]) {
        Ok(StorageText::Json)
    } else {
        Err(misnamed("a name that ends in .yml, .yaml, .xml or .json, for opencv", path))
    }
}

/// The paths of the files of an export, whose usual names are `names`, for the output `path`.
///
/// # Errors
/// [`Error::Invalid`] that says how to name the output.
pub fn export_places(path: &Path, format: ExchangeFormat, names: &[&str]) -> Result<ExportPlaces> {
    let in_folder = |folder: &Path| ExportPlaces {
        folder: Some(folder.to_owned()),
        paths: names.iter().map(|n| folder.join(n)).collect(),
    };
    let one = || ExportPlaces { folder: None, paths: vec![path.to_owned()] };
    if is_dash(path) {
        let found = names.len();
        return if found == 1 {
            Ok(one())
        } else {
            Err(misnamed(format!("a file or a folder: this export has {found} files"), path))
        };
    }
    let named = |endings: &[&str]| {
        let listed = endings.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(" or ");
        let expected = format!("a name that ends in {listed}, for {}", format.name());
        if has_extension(path, endings) { Ok(one()) } else { Err(misnamed(expected, path)) }
    };
    match format {
        ExchangeFormat::OpenCv => storage_of(path).map(|_| one()),
        ExchangeFormat::Kalibr => named(&["yaml", "yml"]),
        ExchangeFormat::Blender => named(&["py"]),
        ExchangeFormat::Npz => named(&["npz"]),
        ExchangeFormat::Ros if path.is_dir() || path.extension().is_none() => Ok(in_folder(path)),
        ExchangeFormat::Ros => {
            named(&["yaml", "yml"])?;
            let mut beside = path.file_stem().unwrap_or_default().to_owned();
            beside.push("_projector.");
            beside.push(path.extension().unwrap_or_default());
            let both = [path.to_owned(), path.with_file_name(beside)];
            Ok(ExportPlaces { folder: None, paths: both.into_iter().take(names.len()).collect() })
        }
        ExchangeFormat::Colmap if path.file_name().is_some_and(|n| n == COLMAP[0]) => {
            let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            Ok(in_folder(parent))
        }
        ExchangeFormat::Colmap if !path.is_dir() && has_extension(path, &["txt", "bin"]) => {
            Err(misnamed("a folder, or cameras.txt in one, for colmap", path))
        }
        ExchangeFormat::Colmap => Ok(in_folder(path)),
    }
}

/// Expands paths to files: a folder to the files of its model or rig, cameras.txt to the files of its model
/// as well.
///
/// # Errors
/// [`Error::Malformed`] that says what a folder should hold.
pub fn import_paths(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        let folder = if path.is_dir() {
            path.clone()
        } else if paths.len() == 1 && path.file_name().is_some_and(|n| n == COLMAP[0]) {
            path.parent().map(Path::to_owned).unwrap_or_default()
        } else {
            files.push(path.clone());
            continue;
        };
        let found = |names: &[&str]| -> Vec<PathBuf> {
            names.iter().map(|n| folder.join(n)).filter(|p| p.exists()).collect()
        };
        let (model, rig) = (found(&COLMAP), found(&ROS));
        match (model.is_empty(), rig.is_empty()) {
            (false, _) => files.extend(model),
            (true, false) => files.extend(rig),
            _ => {
                return Err(Error::malformed(
                    ErrorSubject::ImportFolder,
                    format!(
                        "expected a file, or a folder with cameras.txt and images.txt (COLMAP) or camera.yaml and projector.yaml (ROS), \
                         found a folder without these in {}",
                        path.display()
                    ),
                ));
            }
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(path: &str, format: ExchangeFormat, names: &[&str]) -> Result<Vec<String>> {
        export_places(Path::new(path), format, names)
            .map(|p| p.paths.iter().map(|p| p.display().to_string()).collect())
    }

    #[test]
    fn each_file_of_an_export_has_its_place() {
        use ExchangeFormat as F;
        assert_eq!(places("a b/é.yaml", F::Ros, &ROS).unwrap(), ["a b/é.yaml", "a b/é_projector.yaml"]);
        assert_eq!(places("a.yml", F::Ros, &ROS[..1]).unwrap(), ["a.yml"]);
        assert_eq!(places("calib", F::Ros, &ROS).unwrap(), ["calib/camera.yaml", "calib/projector.yaml"]);
        assert_eq!(
            places("m", F::Colmap, &COLMAP).unwrap(),
            ["m/cameras.txt", "m/images.txt", "m/points3D.txt"]
        );
        assert_eq!(places("m/cameras.txt", F::Colmap, &COLMAP[..1]).unwrap(), ["m/cameras.txt"]);
        assert_eq!(places("-", F::Kalibr, &["camchain.yaml"]).unwrap(), ["-"]);
        for (path, format, names) in [
            ("-", F::Ros, &ROS[..]),
            ("-", F::Colmap, &COLMAP),
            ("images.txt", F::Colmap, &COLMAP),
            ("rig.txt", F::OpenCv, &["rig.yml"]),
            ("rig", F::OpenCv, &["rig.yml"]),
            ("rig.json", F::Npz, &["rig.npz"]),
            ("rig.json", F::Ros, &ROS),
            ("rig.txt", F::Blender, &["rig.py"]),
        ] {
            assert!(
                places(path, format, names).unwrap_err().to_string().contains("expected"),
                "{path} {format:?}"
            );
        }
        assert_eq!(storage_of(Path::new("a.XML")).unwrap(), StorageText::Xml);
    }
}
