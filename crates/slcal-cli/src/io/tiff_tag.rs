//! Tags in the first directory of a TIFF, which the decoder does not hand out.

/// A tag of bytes; `None` where the directory has none, or one that does not lie in the file.
pub(super) fn tiff_tag(bytes: &[u8], wanted: u16) -> Option<&[u8]> {
    let big = match bytes.get(..4)? {
        b"II*\0" => false,
        b"MM\0*" => true,
        _ => return None,
    };
    let u16_of = |b: [u8; 2]| if big { u16::from_be_bytes(b) } else { u16::from_le_bytes(b) };
    let u32_of = |b: [u8; 4]| (if big { u32::from_be_bytes(b) } else { u32::from_le_bytes(b) }) as usize;
    let at = u32_of(*bytes.get(4..)?.first_chunk()?);
    let (count, entries) = bytes.get(at..)?.split_first_chunk()?;
    let mut entries = entries.as_chunks::<12>().0.iter().take(usize::from(u16_of(*count)));
    let [_, _, _, _, n @ ..] = entries.find(|entry| u16_of([entry[0], entry[1]]) == wanted)?;
    let (length, value) = n.split_first_chunk()?;
    match u32_of(*length) {
        // Up to four bytes stand in the entry.
        length @ 0..=4 => value.get(..length),
        length => {
            let at = u32_of(*value.first_chunk()?);
            bytes.get(at..at.checked_add(length)?)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_are_found_in_both_orders_and_never_behind_the_end() {
        let little =
            b"II*\0\x08\0\0\0\x02\0\x01\0\x01\0\x02\0\0\0ab\0\0\x02\0\x01\0\x05\0\0\0\x22\0\0\0hello";
        let big = b"MM\0*\0\0\0\x08\0\x02\0\x01\0\x01\0\0\0\x02ab\0\0\0\x02\0\x01\0\0\0\x05\0\0\0\x22hello";
        for bytes in [little.as_slice(), big] {
            assert_eq!([tiff_tag(bytes, 1), tiff_tag(bytes, 2)], [Some(b"ab".as_slice()), Some(b"hello")]);
            assert_eq!(tiff_tag(bytes, 3), None);
            for length in 0..bytes.len() {
                assert_eq!(tiff_tag(&bytes[..length], 2), None);
            }
        }
    }
}
