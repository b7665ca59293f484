//! Scans by a sequence in the project's folder: each is a folder of its own, with the description of the sequence and a photograph per
//! picture, as `slcal reconstruct` reads them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::PoisonError;

use slcal_core::format::{read_pattern, write_pattern};
use slcal_core::pattern::{FrameLight, Pattern, SequencePattern};

use super::project::{Project, Purpose, StoredPhoto};
use super::state::Unfinished;
use crate::exit::{Exit, Failure, InFile as _, Outcome};
use crate::io::{ScanFrames, bytes_of, make_folder, photographs, scans};

/// The description of the sequence, beside its photographs.
pub(super) const DESCRIPTION: &str = "sequence.json";

/// The folder of a scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ScanFolder {
    pub(super) id: u32,
    /// Its name in the project's folder.
    pub(super) name: String,
}

impl ScanFolder {
    fn numbered(id: u32) -> Self {
        Self { id, name: format!("scan-{id:03}") }
    }
}

/// The name of a photograph without its extension: that of the picture in the description.
fn frame_stem(frame: usize) -> String {
    format!("frame_{frame:03}")
}

impl Project {
    /// Makes the folder of the next scan and writes what its photographs will show.
    pub(super) fn begin_scan(&self, pattern: &SequencePattern) -> Outcome<ScanFolder> {
        let _alone = self.naming.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = ScanFolder::numbered(self.next_id(Purpose::Scan));
        make_folder(&self.path(&folder.name))?;
        let description = bytes_of(|out| write_pattern(&Pattern::Sequence(pattern.clone()), out))?;
        self.write(&format!("{}/{DESCRIPTION}", folder.name), &description)?;
        Ok(folder)
    }

    /// Keeps the photograph of a picture of a sequence as it came.
    pub(super) fn keep_frame(
        &self,
        scan: u32,
        frame: usize,
        bytes: &[u8],
        extension: &str,
    ) -> Outcome<StoredPhoto> {
        let folder = ScanFolder::numbered(scan).name;
        let name = format!("{folder}/{}.{extension}", frame_stem(frame));
        self.write(&name, bytes)?;
        Ok(StoredPhoto { id: scan, name })
    }

    /// The scans by a sequence, in the order of their numbers.
    pub(super) fn scan_folders(&self) -> Vec<ScanFolder> {
        let entries = fs::read_dir(self.folder()).into_iter().flatten().flatten();
        let mut all: Vec<ScanFolder> = entries
            .filter(|entry| entry.path().join(DESCRIPTION).is_file())
            .filter_map(|entry| {
                let name = entry.file_name().into_string().ok()?;
                Some(ScanFolder { id: Purpose::Scan.number(&name)?, name })
            })
            .collect();
        all.sort_by_key(|folder| folder.id);
        all
    }

    /// The sequence of a scan.
    pub(super) fn sequence_of(&self, folder: &ScanFolder) -> Outcome<SequencePattern> {
        let name = format!("{}/{DESCRIPTION}", folder.name);
        let path = self.path(&name);
        let bytes = self.read(&name).map_err(|e| Failure::input(&path, format!("cannot be read: {e}")))?;
        match read_pattern(bytes.as_slice()).in_file(&path)? {
            Pattern::Sequence(sequence) => Ok(sequence),
            other => Err(Failure::new(
                Exit::Input,
                format!("{}: expected the description of a sequence, found {}", path.display(), other.kind()),
            )),
        }
    }

    /// The photographs of a scan, one per picture of the sequence.
    pub(super) fn frames_of(&self, folder: &ScanFolder, pattern: &SequencePattern) -> Outcome<ScanFrames> {
        let mut found = scans(&[self.path(&folder.name)], pattern)?;
        found.pop().ok_or_else(|| Failure::new(Exit::Input, "expected the photographs of a scan, found none"))
    }

    /// How far a scan has come of which photographs are missing; `None` where it is complete.
    pub(super) fn unfinished(&self, folder: &ScanFolder, pattern: &SequencePattern) -> Option<Unfinished> {
        let there = photographs(&[self.path(&folder.name)]).unwrap_or_default();
        let is_there = |frame: usize| there.iter().any(|file| has_stem(file, &frame_stem(frame)));
        let of = pattern.frames.len();
        let have = (0..of).filter(|frame| is_there(*frame)).count();
        (have < of).then(|| Unfinished { name: folder.name.clone(), have, of })
    }

    /// The photograph that shows what a scan is of: that under white, or the first.
    pub(super) fn picture_of_scan(&self, id: u32) -> Option<PathBuf> {
        let folder = self.scan_folders().into_iter().find(|folder| folder.id == id)?;
        let pattern = self.sequence_of(&folder).ok()?;
        let white = pattern.frames.iter().position(|f| f.light == FrameLight::White).unwrap_or(0);
        self.frames_of(&folder, &pattern).ok()?.files.into_iter().nth(white)
    }
}

fn has_stem(file: &Path, stem: &str) -> bool {
    file.file_stem().is_some_and(|found| found.eq_ignore_ascii_case(stem))
}

#[cfg(test)]
mod tests {
    use slcal_core::pattern::SequenceConfig;

    use super::*;

    #[test]
    fn a_scan_is_complete_when_every_picture_has_its_photograph() {
        let folder = tempfile::tempdir().unwrap();
        let (project, _) = Project::open(&folder.path().join("work")).unwrap();
        let pattern = SequencePattern::new([4, 3], &SequenceConfig::default()).unwrap();
        project.keep(Purpose::Scan, b"stripes", "jpg").unwrap();
        let scan = project.begin_scan(&pattern).unwrap();
        // Photographs under stripes and folders share their numbers, and so do their clouds.
        assert_eq!((scan.id, scan.name.as_str()), (2, "scan-002"));
        assert_eq!(project.keep(Purpose::Scan, b"more", "jpg").unwrap().name, "scan-003.jpg");
        assert_eq!(project.begin_scan(&pattern).unwrap().id, 4);
        assert_eq!(project.sequence_of(&scan).unwrap(), pattern);
        for frame in 0..6 {
            let told = project.unfinished(&scan, &pattern).unwrap();
            assert_eq!((told.name.as_str(), told.have, told.of), ("scan-002", frame, 6));
            let kept = project.keep(Purpose::Frame { scan: 2, frame }, b"x", "png").unwrap();
            assert_eq!(kept.name, format!("scan-002/frame_{frame:03}.png"));
        }
        assert_eq!(project.unfinished(&scan, &pattern), None);
        let files = project.frames_of(&scan, &pattern).unwrap().files;
        assert!(files.len() == 6 && files[5].ends_with("frame_005.png"), "{files:?}");
        assert_eq!(project.picture_of_scan(2).unwrap(), files[0]);
        let named: Vec<u32> = project.scan_folders().into_iter().map(|f| f.id).collect();
        assert_eq!(named, [2, 4]);
    }
}
