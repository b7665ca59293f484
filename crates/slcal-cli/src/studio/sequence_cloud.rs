//! The cloud of a scan by a sequence: one photograph is in memory at a time.

use slcal_core::pattern::SequencePattern;
use slcal_core::{PhotoView, ReconstructConfig, Reconstruction, Rig, SequenceReconstructor};

use super::project::Project;
use super::scan_folder::ScanFolder;
use crate::exit::{InFile as _, Outcome};
use crate::io::{InputKind, decode_photo, input_name, read_bytes};

/// A point per pixel, with triangles, and how many photographs it is made of.
pub(super) fn sequence_cloud(
    project: &Project,
    folder: &ScanFolder,
    rig: &Rig,
) -> Outcome<(Reconstruction, SequencePattern)> {
    let pattern = project.sequence_of(folder)?;
    let scan = project.frames_of(folder, &pattern)?;
    let config = ReconstructConfig { mesh: true, ..ReconstructConfig::default() };
    let mut scanner = SequenceReconstructor::new(rig, &pattern, config)?;
    for frame in scanner.reading_order().to_vec() {
        let file = &scan.files[frame];
        let photo = decode_photo(&read_bytes(file, InputKind::Photo)?, &input_name(file))?.photo;
        scanner.push(frame, PhotoView::try_from(&photo)?).in_file(file)?;
    }
    let result = scanner.finish().in_file(&scan.name)?;
    Ok((result, pattern))
}
