//! The matches of every pixel as NumPy's .npz: arrays with an entry for each pixel that has a match.
//!
//! | | type | |
//! |---|---|---|
//! | `u`, `v` | uint16 | the pixel's column and row |
//! | `projector_column`, `projector_row` | float32 | panel px; NaN where unknown, no array where not coded |
//! | `sigma_column_px`, `sigma_row_px` | float32 | 1σ of them, panel px |
//! | `confidence` | float32 | 0 to 1 |
//! | `color` | uint8, (N, 3) | sRGB; no array where no white picture was shown |
//! | `image_size` | int64, (2,) | width and height of the camera's image |

use std::io::{Cursor, Read as _, Write};

use zip::{ZipArchive, ZipWriter};

use super::budget::Budget;
use super::exchange::npy::{Array, header};
use super::exchange::npz::stored;
use crate::dense_matches::DenseMatches;
use crate::error::{Error, ErrorSubject, Result};

/// Entries of an archive that is read.
const MOST_ENTRIES: usize = 100;
/// What reading may take for each byte of the file, and in any case, bytes.
const MEMORY_PER_BYTE: usize = 20;
const LEAST_MEMORY: usize = 64 << 20;
/// Values that are written at a time.
const CHUNK: usize = 1 << 14;
/// Largest side of an image: u and v have 16 bit.
const MOST_PX: usize = 1 << 16;

/// Writes the pixels that have a match.
///
/// # Errors
/// [`Error::Invalid`] for an image of more than 65536 px along a side; [`Error::Io`] when the stream fails.
pub fn write_dense_matches(matches: &DenseMatches, output: impl Write) -> Result<()> {
    let DenseMatches { width, height, .. } = *matches;
    if width.max(height) > MOST_PX {
        return Err(Error::invalid(
            "camera image",
            format!("at most {MOST_PX} px along a side"),
            width.max(height),
        ));
    }
    let failed = |e: std::io::Error| Error::writing(ErrorSubject::MatchesFile, e);
    let mut zip = ZipWriter::new_stream(output);
    let n = matches.known();
    let known = || (0..width * height).filter(|i| matches.is_known(*i));
    let mut plane = |name: &str, kind: &str, shape: &[usize], mut bytes: &mut dyn Iterator<Item = u8>| {
        zip.start_file(format!("{name}.npy"), stored().large_file(true))?;
        zip.write_all(&header(kind, shape))?;
        let mut chunk = Vec::with_capacity(CHUNK);
        loop {
            chunk.clear();
            chunk.extend((&mut bytes).take(CHUNK));
            if chunk.is_empty() {
                return Ok(());
            }
            zip.write_all(&chunk)?;
        }
    };
    let bytes = |x: usize| (x as u16).to_le_bytes();
    plane("u", "<u2", &[n], &mut known().flat_map(|i| bytes(i % width))).map_err(failed)?;
    plane("v", "<u2", &[n], &mut known().flat_map(|i| bytes(i / width))).map_err(failed)?;
    for (name, values) in [
        ("projector_column", &matches.column),
        ("sigma_column_px", &matches.sigma_column),
        ("projector_row", &matches.row),
        ("sigma_row_px", &matches.sigma_row),
        ("confidence", &matches.confidence),
    ] {
        if !values.is_empty() {
            plane(name, "<f4", &[n], &mut known().flat_map(|i| values[i].to_le_bytes())).map_err(failed)?;
        }
    }
    if !matches.color.is_empty() {
        plane("color", "|u1", &[n, 3], &mut known().flat_map(|i| matches.color[i])).map_err(failed)?;
    }
    let size = [width, height].map(|side| (side as i64).to_le_bytes());
    plane("image_size", "<i8", &[2], &mut size.into_iter().flatten()).map_err(failed)?;
    zip.finish().map(|_| ()).map_err(|e| failed(e.into()))
}

fn malformed(detail: impl Into<String>) -> Error {
    Error::malformed(ErrorSubject::MatchesFile, detail)
}

/// Reads matches of pixels, as [`write_dense_matches`] writes them or another program: `u`, `v` and `projector_column`, `projector_row` or both.
/// Without `sigma_column_px` and `sigma_row_px` the σ of a position is that of a rounded one, 1/√12 px; without `image_size` the image
/// ends with the last pixel.
///
/// # Errors
/// [`Error::Malformed`] that says what is missing or wrong.
pub fn read_dense_matches(file: &[u8]) -> Result<DenseMatches> {
    let budget = Budget::new(
        ErrorSubject::MatchesFile,
        file.len().saturating_mul(MEMORY_PER_BYTE).saturating_add(LEAST_MEMORY),
    );
    let mut archive = ZipArchive::new(Cursor::new(file)).map_err(|e| {
        malformed(format!("expected an archive of arrays (.npz), found none that can be read ({e})"))
    })?;
    if archive.len() > MOST_ENTRIES {
        return Err(malformed(format!("expected at most {MOST_ENTRIES} arrays, found {}", archive.len())));
    }
    let mut numbers = |name: &str| -> Result<Option<Vec<f64>>> {
        let entry = match archive.by_name(&format!("{name}.npy")) {
            Ok(entry) => entry,
            Err(zip::result::ZipError::FileNotFound) => return Ok(None),
            Err(e) => return Err(malformed(format!("{name}: {e}"))),
        };
        budget.unpack(entry.size())?;
        let mut bytes = Vec::new();
        let most = entry.size();
        entry.take(most).read_to_end(&mut bytes).map_err(|e| malformed(format!("{name}: {e}")))?;
        match Array::decoded(&bytes, name, &budget)? {
            Array::Numbers(_, values) => Ok(Some(values)),
            _ => Err(malformed(format!("{name}: expected numbers, found words"))),
        }
    };
    let needed = |name: &str, values: Option<Vec<f64>>| {
        values.ok_or_else(|| malformed(format!("expected an array \"{name}\", found none")))
    };
    let (u, v) = (needed("u", numbers("u")?)?, needed("v", numbers("v")?)?);
    let size = numbers("image_size")?;
    let whole = |x: f64| (x.fract() == 0.0 && (0.0..MOST_PX as f64).contains(&x)).then_some(x as usize);
    let pixels: Option<Vec<[usize; 2]>> =
        u.iter().zip(&v).map(|(u, v)| Some([whole(*u)?, whole(*v)?])).collect();
    let pixels = pixels.filter(|_| u.len() == v.len()).ok_or_else(|| {
        malformed("expected u and v of the same length, whole numbers from 0 to 65535, found others")
    })?;
    drop((u, v));
    let end = |k: usize| pixels.iter().map(|p| p[k] + 1).max().unwrap_or(0);
    let [width, height] = match size.as_deref() {
        None => [end(0), end(1)],
        Some([w, h]) => match (whole(w - 1.0), whole(h - 1.0)) {
            (Some(w), Some(h)) if w + 1 >= end(0) && h + 1 >= end(1) => [w + 1, h + 1],
            _ => {
                return Err(malformed(format!(
                    "image_size: expected one that holds all pixels, found {w}x{h}"
                )));
            }
        },
        Some(_) => return Err(malformed("image_size: expected two numbers")),
    };
    // A few pixels may lie far out: what they span must be in proportion, too.
    budget.keep(width.saturating_mul(height).saturating_mul(24))?;
    let spread = |values: Option<Vec<f64>>, name: &str, usual: Option<f32>| -> Result<Vec<f32>> {
        let Some(values) = values else {
            return Ok(usual.map_or(Vec::new(), |usual| vec![usual; width * height]));
        };
        if values.len() != pixels.len() {
            let found = values.len();
            return Err(malformed(format!(
                "{name}: expected {} numbers, as u has, found {found}",
                pixels.len()
            )));
        }
        let mut out = vec![f32::NAN; width * height];
        for ([u, v], value) in pixels.iter().zip(values) {
            out[v * width + u] = value as f32;
        }
        Ok(out)
    };
    let mut matches = DenseMatches { width, height, ..DenseMatches::default() };
    let rounded = 1.0 / 12.0_f32.sqrt();
    let column = numbers("projector_column")?;
    let row = numbers("projector_row")?;
    if column.is_none() && row.is_none() {
        return Err(malformed("expected an array \"projector_column\" or \"projector_row\", found neither"));
    }
    let sigma = |is_coded: bool| is_coded.then_some(rounded);
    let (has_column, has_row) = (column.is_some(), row.is_some());
    matches.column = spread(column, "projector_column", None)?;
    matches.row = spread(row, "projector_row", None)?;
    matches.sigma_column =
        spread(numbers("sigma_column_px")?.filter(|_| has_column), "sigma_column_px", sigma(has_column))?;
    matches.sigma_row = spread(numbers("sigma_row_px")?.filter(|_| has_row), "sigma_row_px", sigma(has_row))?;
    matches.confidence = spread(numbers("confidence")?, "confidence", Some(1.0))?;
    if let Some(colors) = numbers("color")? {
        let colors = colors.as_chunks::<3>().0;
        if colors.len() != pixels.len() {
            return Err(malformed(format!(
                "color: expected {} colours, as u has, found {}",
                pixels.len(),
                colors.len()
            )));
        }
        matches.color = vec![[0; 3]; width * height];
        for ([u, v], color) in pixels.iter().zip(colors) {
            matches.color[v * width + u] = color.map(|c| c.clamp(0.0, 255.0) as u8);
        }
    }
    Ok(matches)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> DenseMatches {
        let nan = f32::NAN;
        DenseMatches {
            width: 3,
            height: 2,
            column: vec![1.5, nan, 3.25, 4.0, nan, 700.125],
            sigma_column: vec![0.1, nan, 0.2, 0.3, nan, 0.4],
            row: vec![nan, nan, 9.0, 8.0, 7.0, 6.0],
            sigma_row: vec![nan, nan, 0.5, 0.5, 0.5, 0.5],
            confidence: vec![1.0, 1.0, 0.5, 0.25, 0.75, 1.0],
            color: vec![[1, 2, 3]; 6],
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let mut file = Vec::new();
        write_dense_matches(&some(), &mut file).unwrap();
        let read = read_dense_matches(&file).unwrap();
        assert_eq!((read.width, read.height, read.known()), (3, 2, 5));
        for i in [0, 2, 3, 4, 5] {
            for (a, b) in [
                (&read.column, &some().column),
                (&read.sigma_row, &some().sigma_row),
                (&read.confidence, &some().confidence),
            ] {
                assert_eq!(a[i].to_bits(), b[i].to_bits());
            }
            assert_eq!(read.color[i], [1, 2, 3]);
        }
        assert!(!read.is_known(1));
    }

    #[test]
    fn broken_archives_are_refused() {
        let mut file = Vec::new();
        write_dense_matches(&some(), &mut file).unwrap();
        for cut in (0..file.len()).step_by(37) {
            assert!(read_dense_matches(&file[..cut]).is_err());
        }
        for at in 0..file.len() {
            let mut changed = file.clone();
            changed[at] ^= 0x55;
            let _ = read_dense_matches(&changed);
        }
        assert!(read_dense_matches(b"u,v\n").unwrap_err().to_string().contains(".npz"));
    }
}
