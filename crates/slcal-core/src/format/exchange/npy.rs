//! One array of NumPy as the bytes of a .npy file: a line that describes it, then its values.

use crate::error::{Error, ErrorSubject, Result};
use crate::format::budget::Budget;
use crate::format::tree::Expecting;

pub(super) const FILE: Expecting = Expecting(ErrorSubject::NpzFile);
const MAGIC: &[u8] = b"\x93NUMPY";
/// The values begin at a multiple of this.
const ALIGNMENT: usize = 64;
/// NumPy has no arrays of more.
const MOST_AXES: usize = 64;
/// Bytes of a description; those of records may have more, but records are not read.
const LONGEST_HEADER: usize = 1 << 16;
/// Memory that an allocation takes at least, bytes.
const LEAST_ALLOCATION: usize = 32;

/// An array; a scalar has no shape.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::format) enum Array {
    /// Numbers, in the order of C.
    Numbers(Vec<usize>, Vec<f64>),
    /// Whole numbers; read as numbers.
    Wholes(Vec<usize>, Vec<i64>),
    /// Words.
    Words(Vec<usize>, Vec<String>),
}

impl Array {
    /// The bytes of a .npy file.
    pub(super) fn encoded(&self) -> Vec<u8> {
        let (kind, shape, data) = match self {
            Self::Numbers(shape, values) => {
                ("<f8".to_owned(), shape, values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())
            }
            Self::Wholes(shape, values) => {
                ("<i8".to_owned(), shape, values.iter().flat_map(|x| x.to_le_bytes()).collect())
            }
            Self::Words(shape, values) => {
                let longest = values.iter().map(|w| w.chars().count()).max().unwrap_or(0).max(1);
                let padded = |word: &String| {
                    let mut letters: Vec<u32> = word.chars().map(u32::from).collect();
                    letters.resize(longest, 0);
                    letters
                };
                let data = values.iter().flat_map(padded).flat_map(u32::to_le_bytes).collect();
                (format!("<U{longest}"), shape, data)
            }
        };
        [header(&kind, shape), data].concat()
    }

    /// From the bytes of a .npy file: numbers of any width, or words.
    pub(in crate::format) fn decoded(bytes: &[u8], name: &str, budget: &Budget) -> Result<Self> {
        let wrong = |what: &str| FILE.malformed(format!("{name}: expected an array of NumPy, found {what}"));
        let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| wrong("other bytes"))?;
        let (length, rest) = match rest {
            [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
            [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
            _ => return Err(wrong("an unknown version")),
        };
        if length > LONGEST_HEADER {
            return Err(wrong("a description of more than 64 KiB"));
        }
        let (header, data) = rest.split_at_checked(length).ok_or_else(|| wrong("a part of one"))?;
        let header = std::str::from_utf8(header).map_err(|_| wrong("an unreadable description"))?;
        let kind = between(header, "'descr':", &[',', '}']).ok_or_else(|| wrong("a record"))?;
        let kind = kind.trim().trim_matches(['\'', '"']);
        let shape = header.split_once("'shape':").and_then(|(_, s)| between(s, "(", &[')']));
        let shape: Option<Vec<usize>> = shape.and_then(|s| {
            s.split(',').map(str::trim).filter(|s| !s.is_empty()).map(|s| s.parse().ok()).collect()
        });
        let shape = shape.ok_or_else(|| wrong("an unreadable shape"))?;
        if shape.len() > MOST_AXES {
            return Err(wrong(&format!("one of {} axes, where {MOST_AXES} are the most", shape.len())));
        }
        let count =
            shape.iter().try_fold(1usize, |n, s| n.checked_mul(*s)).ok_or_else(|| wrong("a huge shape"))?;
        let by_columns =
            header.split_once("'fortran_order':").is_some_and(|(_, s)| s.trim_start().starts_with("True"));
        for _ in 0..if by_columns { 2 } else { 1 } {
            budget.keep(memory(kind, data, count))?;
        }
        let array = values(kind, data, count).ok_or_else(|| refused(kind, name))??;
        Ok(match array {
            Values::Numbers(values) if by_columns => Self::Numbers(shape.clone(), by_rows(&shape, &values)),
            Values::Numbers(values) => Self::Numbers(shape, values),
            Values::Words(values) if by_columns => Self::Words(shape.clone(), by_rows(&shape, &values)),
            Values::Words(values) => Self::Words(shape, values),
        })
    }
}

/// What stands before the values of an array in the order of C.
pub(in crate::format) fn header(kind: &str, shape: &[usize]) -> Vec<u8> {
    let sides = shape.iter().map(|s| format!("{s}, ")).collect::<Vec<_>>().concat();
    let sides = if shape.len() > 1 { sides.trim_end_matches(", ") } else { sides.trim_end() };
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({sides}), }}");
    let before = MAGIC.len() + 4;
    let length = (before + header.len() + 1).next_multiple_of(ALIGNMENT) - before;
    header.extend(std::iter::repeat_n(' ', length - header.len() - 1));
    header.push('\n');
    let size = u16::try_from(header.len()).unwrap_or(u16::MAX).to_le_bytes();
    [MAGIC, &[1, 0], &size, header.as_bytes()].concat()
}

enum Values {
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

/// What the values take at most when they are read, bytes.
fn memory(kind: &str, data: &[u8], count: usize) -> usize {
    if kind.chars().nth(1) == Some('U') {
        return count.saturating_mul(size_of::<String>() + LEAST_ALLOCATION).saturating_add(data.len());
    }
    count.saturating_mul(size_of::<f64>())
}

fn refused(kind: &str, name: &str) -> Error {
    let kind: String = kind.chars().take(40).collect();
    FILE.malformed(format!("{name}: expected numbers or words, found the type {kind}, which is not read"))
}

fn between<'a>(text: &'a str, before: &str, after: &[char]) -> Option<&'a str> {
    let (_, rest) = text.split_once(before)?;
    rest.split_once(after).map(|(value, _)| value)
}

/// The values of a type such as `<f8`; `None` for a type that is neither number nor word.
fn values(kind: &str, data: &[u8], count: usize) -> Option<Result<Values>> {
    let order = kind.chars().next()?;
    let little = match order {
        '<' | '|' | '=' => true,
        '>' => false,
        _ => return None,
    };
    let letter = kind.chars().nth(1)?;
    let width: usize = kind.get(2..)?.parse().ok()?;
    let size = if letter == 'U' { width.checked_mul(4)? } else { width };
    if !matches!((letter, width), ('f', 4 | 8) | ('i' | 'u', 1 | 2 | 4 | 8) | ('U', 1..)) {
        return None;
    }
    if count.checked_mul(size) != Some(data.len()) {
        let needed = format!("expected {count} values of {size} bytes, found {} bytes", data.len());
        return Some(Err(FILE.malformed(needed)));
    }
    let ordered = |bytes: &[u8]| -> u64 {
        let place = |i: usize| if little { i } else { bytes.len() - 1 - i };
        (0..bytes.len()).fold(0, |n, i| n | u64::from(bytes[place(i)]) << (8 * i))
    };
    let number = |bytes: &[u8]| -> f64 {
        let bits = ordered(bytes);
        match letter {
            'f' if width == 8 => f64::from_bits(bits),
            'f' => f64::from(f32::from_bits(bits as u32)),
            'u' => bits as f64,
            // The sign stands in the highest bit of the width.
            _ => ((bits << (64 - 8 * width)) as i64 >> (64 - 8 * width)) as f64,
        }
    };
    let word = |bytes: &[u8]| -> String {
        let letters = bytes.chunks_exact(4).map(|c| ordered(c) as u32);
        let text: String =
            letters.map(|c| char::from_u32(c).unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        text.trim_end_matches('\0').to_owned()
    };
    Some(Ok(if letter == 'U' {
        Values::Words(data.chunks_exact(size).map(word).collect())
    } else {
        Values::Numbers(data.chunks_exact(size).map(number).collect())
    }))
}

/// From the order of Fortran to that of C.
fn by_rows<T: Clone>(shape: &[usize], values: &[T]) -> Vec<T> {
    // Axes of one move nothing; without them, the last axis that is left takes a step in half of all cases at least.
    let sides: Vec<usize> = shape.iter().copied().filter(|side| *side != 1).collect();
    let steps: Vec<usize> = sides
        .iter()
        .scan(1, |step, side| {
            let own = *step;
            *step *= side;
            Some(own)
        })
        .collect();
    let mut ordered = Vec::with_capacity(values.len());
    let (mut at, mut index) = (vec![0; sides.len()], 0);
    for _ in 0..values.len() {
        ordered.push(values[index].clone());
        for ((place, side), step) in at.iter_mut().zip(&sides).zip(&steps).rev() {
            *place += 1;
            index += step;
            if *place < *side {
                break;
            }
            index -= step * side;
            *place = 0;
        }
    }
    ordered
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> Result<Array> {
        Array::decoded(bytes, "x", &Budget::new(ErrorSubject::NpzFile, bytes.len()))
    }

    fn npy(kind: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': ({shape}), }}\n");
        let size = (header.len() as u32).to_le_bytes();
        [MAGIC, &[2, 0], &size, header.as_bytes(), data].concat()
    }

    #[test]
    fn the_bytes_are_those_of_numpy() {
        // numpy.save of numpy.array([[1.5], [-2.0]]) and of numpy.array("né").
        let bytes = Array::Numbers(vec![2, 1], vec![1.5, -2.0]).encoded();
        let header = b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (2, 1), }";
        assert!(bytes.starts_with(header), "{}", String::from_utf8_lossy(&bytes));
        assert_eq!(bytes.len(), 128 + 16);
        assert_eq!(&bytes[127..136], b"\n\0\0\0\0\0\0\xf8\x3f");
        let word = Array::Words(vec![], vec!["né".to_owned()]);
        let bytes = word.encoded();
        assert!(
            String::from_utf8_lossy(&bytes)
                .contains("'descr': '<U2', 'fortran_order': False, 'shape': (), }")
        );
        assert_eq!(decoded(&bytes).unwrap(), word);
        let line = Array::Wholes(vec![3], vec![1, -2, 1 << 40]);
        assert!(String::from_utf8_lossy(&line.encoded()).contains("'shape': (3,), }"));
        let read = decoded(&line.encoded()).unwrap();
        assert_eq!(read, Array::Numbers(vec![3], vec![1.0, -2.0, f64::from(1 << 20) * f64::from(1 << 20)]));
    }

    #[test]
    fn other_types_and_orders_are_read() {
        let numbers = |shape: &[usize], values: &[f64]| Array::Numbers(shape.to_vec(), values.to_vec());
        assert_eq!(
            decoded(&npy(">i2", "False", "2,", &[0xFF, 0xFE, 0, 3])).unwrap(),
            numbers(&[2], &[-2.0, 3.0])
        );
        assert_eq!(
            decoded(&npy("|u1", "True", "2, 3", &[1, 2, 3, 4, 5, 6])).unwrap(),
            numbers(&[2, 3], &[1.0, 3.0, 5.0, 2.0, 4.0, 6.0])
        );
        assert_eq!(
            decoded(&npy("|u1", "True", "1, 2, 1, 3, 2", &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11])).unwrap(),
            numbers(&[1, 2, 1, 3, 2], &[0.0, 6.0, 2.0, 8.0, 4.0, 10.0, 1.0, 7.0, 3.0, 9.0, 5.0, 11.0])
        );
        assert_eq!(decoded(&npy("<f4", "False", "", &1.5f32.to_le_bytes())).unwrap(), numbers(&[], &[1.5]));
        for bad in [
            npy("|O", "False", "1,", &[0; 8]),
            npy("<f8", "False", "2,", &[0; 8]),
            npy("<f8", "False", "99999999999, 99999999999", &[0; 8]),
            npy("<f8", "False", "-1", &[0; 8]),
            npy("[('a', '<f8')]", "False", "1,", &[0; 8]),
            npy("<U99999999999999999999", "False", "1,", &[]),
            npy("<U0", "False", "1,", &[]),
            npy("é", "False", "1,", &[]),
            MAGIC.to_vec(),
            b"\x93NUMPY\x01\x00\xff\xff{".to_vec(),
            Vec::new(),
        ] {
            assert!(
                matches!(decoded(&bad), Err(Error::Malformed { .. })),
                "{}",
                String::from_utf8_lossy(&bad)
            );
        }
    }

    #[test]
    fn many_axes_and_many_words_are_refused() {
        let said = |bytes: &[u8]| decoded(bytes).unwrap_err().to_string();
        assert!(decoded(&npy("|u1", "True", &"1, ".repeat(64), &[7])).is_ok());
        let many = said(&npy("|u1", "True", &"1, ".repeat(20_000), &[7]));
        assert!(many.contains("one of 20000 axes, where 64 are the most"), "{many}");
        let long = said(&npy("|u1", "True", &"1, ".repeat(30_000), &[7]));
        assert!(long.contains("more than 64 KiB"), "{long}");
        let words = npy("<U1", "False", "1000000", &vec![0; 4_000_000]);
        let budget = Budget::new(ErrorSubject::NpzFile, 1000);
        let said = Array::decoded(&words, "x", &budget).unwrap_err().to_string();
        assert!(said.contains("MB of memory"), "{said}");
        assert!(decoded(&words).is_ok());
    }
}
