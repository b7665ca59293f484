//! Kinds of inputs: how much of each is read, and how it begins.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::photo_kind::{Foreign, format_of};

/// What is looked at before the rest is read, bytes.
const BEGINNING: u64 = 64 << 10;

/// A kind of input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum InputKind {
    /// A photograph.
    Photo,
    /// A rig JSON.
    Rig,
    /// A pattern JSON.
    Pattern,
    /// An observations JSON.
    Observations,
    /// A camera file of any known format.
    Camera,
    /// A file of another program.
    Exchange,
    /// Matches as CSV or NPZ.
    Matches,
    /// A point cloud as PLY.
    Cloud,
    /// A mesh as PLY or OBJ.
    Mesh,
    /// A file that slcal wrote itself.
    Own,
}

impl InputKind {
    /// Its name in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Photo => "a photograph",
            Self::Rig => "a rig JSON",
            Self::Pattern => "a pattern JSON",
            Self::Observations => "an observations JSON",
            Self::Camera => "a camera file (OpenCV, ROS or rig JSON)",
            Self::Exchange => "a file of another program with a camera or a rig",
            Self::Matches => "matches as CSV or NPZ",
            Self::Cloud => "a point cloud as PLY",
            Self::Mesh => "a mesh as PLY or OBJ",
            Self::Own => "a file of slcal",
        }
    }

    /// How much is read of it, MiB.
    pub(crate) fn most_mib(self) -> u64 {
        match self {
            // The largest photographs, even uncompressed; clouds and matches of fifty million points.
            Self::Photo | Self::Matches | Self::Cloud | Self::Mesh | Self::Own => 2048,
            // A covariance of two thousand parameters; a million observed points take half of it.
            Self::Rig | Self::Observations => 128,
            // They have a few kilobytes, rigs of hundreds of views a few megabytes.
            Self::Pattern | Self::Camera | Self::Exchange => 64,
        }
    }

    /// Whether a file that begins like this can be of the kind.
    fn may_begin(self, bytes: &[u8]) -> bool {
        let is_text = || !bytes.contains(&0) && !bytes.trim_ascii_start().is_empty();
        match self {
            Self::Photo => format_of(bytes).is_some() || Foreign::of(bytes, "").is_some(),
            Self::Exchange | Self::Matches => bytes.starts_with(b"PK") || is_text(),
            Self::Rig | Self::Pattern | Self::Observations | Self::Camera => is_text(),
            Self::Cloud | Self::Mesh | Self::Own => true,
        }
    }

    fn too_large(self) -> io::Error {
        let message = format!("expected at most {} MiB, found more", self.most_mib());
        io::Error::new(io::ErrorKind::FileTooLarge, message)
    }

    /// The content of a source. Of one that cannot be of the kind, only the beginning is returned: it is enough for the reader to say
    /// what is wrong, and the source may be endless.
    pub(crate) fn read(self, mut source: impl Read) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        source.by_ref().take(BEGINNING).read_to_end(&mut bytes)?;
        if (bytes.len() as u64) < BEGINNING || !self.may_begin(&bytes) {
            return Ok(bytes);
        }
        self.limited(source, BEGINNING).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// A source that fails beyond the limit of the kind, of which `read` bytes are read already.
    pub(crate) fn limited<R: Read>(self, source: R, read: u64) -> Limited<R> {
        Limited { source, kind: self, left: (self.most_mib() << 20).saturating_sub(read) }
    }

    /// A file that is not longer than the limit of the kind, as far as its folder says.
    pub(crate) fn open(self, path: &Path) -> io::Result<File> {
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        if metadata.is_file() && metadata.len() > self.most_mib() << 20 {
            return Err(self.too_large());
        }
        Ok(file)
    }
}

/// A source that fails beyond a limit.
#[derive(Debug)]
pub(crate) struct Limited<R> {
    source: R,
    kind: InputKind,
    left: u64,
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| self.kind.too_large())?;
        Ok(count)
    }
}

/// The bytes of a file of a kind. Of one that cannot be of the kind, only the beginning.
///
/// # Errors
/// Those of the system, and [`io::ErrorKind::FileTooLarge`].
pub fn read_input(path: &Path, kind: InputKind) -> io::Result<Vec<u8>> {
    kind.read(kind.open(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXTS: [InputKind; 6] = [
        InputKind::Rig,
        InputKind::Pattern,
        InputKind::Observations,
        InputKind::Camera,
        InputKind::Exchange,
        InputKind::Matches,
    ];

    #[test]
    fn of_endless_sources_only_the_beginning_is_read() {
        for kind in TEXTS.into_iter().chain([InputKind::Photo]) {
            assert_eq!(kind.read(io::repeat(0)).unwrap().len(), 65_536, "{kind:?}");
            assert_eq!(kind.read(io::repeat(b' ')).unwrap().len(), 65_536, "{kind:?}");
        }
    }

    #[test]
    fn archives_are_read_where_they_are_of_the_kind() {
        let archive = [b"PK\x03\x04".as_slice(), &vec![0; 200_000]].concat();
        assert_eq!(InputKind::Matches.read(archive.as_slice()).unwrap().len(), archive.len());
        assert_eq!(InputKind::Rig.read(archive.as_slice()).unwrap().len(), 65_536);
    }

    #[test]
    fn whole_files_are_read_up_to_the_limit() {
        let text = "{\"a\": 1}".repeat(20_000);
        for kind in TEXTS {
            assert_eq!(kind.read(text.as_bytes()).unwrap(), text.as_bytes());
        }
        let picture = [b"\x89PNG\r\n\x1a\n".as_slice(), &vec![0; 100_000]].concat();
        assert_eq!(InputKind::Photo.read(picture.as_slice()).unwrap(), picture);
        let mut limited = InputKind::Rig.limited(text.as_bytes(), (128 << 20) - 10);
        let error = limited.read_to_end(&mut Vec::new()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::FileTooLarge);
        assert_eq!(error.to_string(), "expected at most 128 MiB, found more");
    }

    #[test]
    fn a_file_that_is_too_long_is_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("camera.yaml");
        // Without content: it takes no room.
        File::create(&path).unwrap().set_len((64 << 20) + 1).unwrap();
        assert_eq!(read_input(&path, InputKind::Camera).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        assert!(InputKind::Rig.open(&path).is_ok());
    }
}
