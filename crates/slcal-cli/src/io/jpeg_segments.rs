//! The segments of a JPEG file before its picture.

/// Marks the head of a scan; behind it no lengths are stated.
pub(super) const START_OF_SCAN: u8 = 0xDA;

/// A part of the file.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Segment<'a> {
    pub(super) marker: u8,
    /// As much of it as the file has.
    pub(super) content: &'a [u8],
    /// The file from the content on.
    pub(super) rest: &'a [u8],
}

/// All up to and including the head of the first scan.
pub(super) fn segments(jpeg: &[u8]) -> impl Iterator<Item = Segment<'_>> {
    let mut next = jpeg.get(2..).unwrap_or_default();
    std::iter::from_fn(move || {
        // Any number of 0xFF may stand before a marker.
        while let [0xFF, 0xFF, ..] = next {
            next = &next[1..];
        }
        let &[0xFF, marker, high, low, ref rest @ ..] = next else { return None };
        let length = usize::from(u16::from_be_bytes([high, low])).saturating_sub(2);
        let content = &rest[..length.min(rest.len())];
        next = rest.get(length..).filter(|_| marker != START_OF_SCAN).unwrap_or_default();
        Some(Segment { marker, content, rest })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_end_with_the_scan_or_the_file() {
        let jpeg = b"\xFF\xD8\xFF\xE0\0\x04ab\xFF\xFF\xDB\0\x03c\xFF\xDA\0\x02\xFF\xE0\0\x02";
        let found = |jpeg| segments(jpeg).map(|s| (s.marker, s.content)).collect::<Vec<_>>();
        assert_eq!(found(jpeg), [(0xE0, b"ab".as_slice()), (0xDB, b"c"), (START_OF_SCAN, b"")]);
        assert_eq!(segments(jpeg).last().unwrap().rest, b"\xFF\xE0\0\x02");
        for length in 0..jpeg.len() {
            assert!(segments(&jpeg[..length]).count() <= 3);
        }
        assert_eq!(found(b"\xFF\xD8\xFF\xE0\xFF\xFFab"), [(0xE0, b"ab".as_slice())]);
        // A length that is no length.
        assert_eq!(found(b"\xFF\xD8\xFF\xE0\0\0\xFF\xDB\0\x02").len(), 2);
    }
}
