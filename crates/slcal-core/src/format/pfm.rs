//! Maps of numbers as PFM (portable float map), which OpenCV, ImageMagick and most viewers of floating point pictures read.

use std::io::Write;

use super::buffered::buffered;
use crate::error::{Error, ErrorSubject, Result};

/// Writes one 32-bit number per pixel, given row by row from the top; NaN where there is none. The format stores the last
/// row first.
///
/// # Errors
/// [`Error::Invalid`] when the values are not whole rows; [`Error::Io`] when the stream fails.
pub fn write_pfm(width: usize, values: &[f32], output: impl Write) -> Result<()> {
    if width == 0 || values.is_empty() || !values.len().is_multiple_of(width) {
        let found = format!("{} values", values.len());
        return Err(Error::invalid("map", format!("whole rows of {width} values"), found));
    }
    buffered(ErrorSubject::Pfm, output, |out| {
        // A negative scale means little-endian numbers.
        writeln!(out, "Pf\n{width} {}\n-1.0", values.len() / width)?;
        for row in values.chunks_exact(width).rev() {
            for v in row {
                out.write_all(&v.to_le_bytes())?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_go_from_the_bottom_up() {
        let mut bytes = Vec::new();
        write_pfm(2, &[1.0, 2.0, 3.0, f32::NAN], &mut bytes).unwrap();
        let (head, numbers) = bytes.split_at(12);
        assert_eq!(head, b"Pf\n2 2\n-1.0\n");
        let numbers: Vec<f32> =
            numbers.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!((numbers[0], numbers[2], numbers[3]), (3.0, 1.0, 2.0));
        assert!(numbers[1].is_nan());
        assert!(write_pfm(3, &[0.0; 4], &mut bytes).is_err());
        assert!(write_pfm(0, &[], &mut bytes).is_err());
    }
}
