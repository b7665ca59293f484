//! Some rows and columns of the image, of which the levels in every frame are kept: what is asked of the sequence as a whole is
//! asked of them.

use std::ops::Range;

/// Rows that are kept, and columns.
const LINES: usize = 24;

/// Evenly spread rows or columns of `n`.
fn spread(n: usize) -> impl Iterator<Item = usize> {
    let lines = LINES.min(n);
    (0..lines).map(move |i| (2 * i + 1) * n / (2 * lines))
}

/// The samples of a band of rows.
#[derive(Debug, Clone)]
pub(super) struct BandSamples {
    /// The rows that are kept, counted from the band's first.
    rows: Vec<usize>,
    columns: Vec<usize>,
    width: usize,
    /// For each frame, the levels of the rows that are kept one after another, then those of the columns, row by row.
    frames: Vec<Vec<u16>>,
}

impl BandSamples {
    /// `size` is that of the image, `rows` those of the band.
    pub(super) fn new(size: [usize; 2], rows: &Range<usize>, frames: usize) -> Self {
        let [width, height] = size;
        let kept = spread(height).filter(|y| rows.contains(y)).map(|y| y - rows.start).collect();
        let frames = vec![Vec::new(); frames];
        Self { rows: kept, columns: spread(width).collect(), width, frames }
    }

    /// Keeps the levels of a frame on the lines, of all levels of the band.
    pub(super) fn keep(&mut self, frame: usize, levels: &[u16]) {
        let kept = &mut self.frames[frame];
        kept.clear();
        for y in &self.rows {
            kept.extend_from_slice(&levels[y * self.width..][..self.width]);
        }
        for row in levels.chunks_exact(self.width) {
            kept.extend(self.columns.iter().map(|x| row[*x]));
        }
    }
}

/// The levels of the frames along some rows and columns.
#[derive(Debug, Clone)]
pub(super) struct SampleLines {
    pub(super) rows: Vec<usize>,
    pub(super) columns: Vec<usize>,
    width: usize,
    height: usize,
    /// For each frame, the levels of the rows one after another, then those of the columns.
    frames: Vec<Vec<u16>>,
}

impl SampleLines {
    /// Of bands that follow one another; every frame was kept.
    pub(super) fn of(size: [usize; 2], bands: &[&BandSamples]) -> Self {
        let [width, height] = size;
        let (rows, columns): (Vec<_>, Vec<_>) = (spread(height).collect(), spread(width).collect());
        let n = bands.first().map_or(0, |band| band.frames.len());
        let frame = |i: usize| {
            let mut levels = Vec::with_capacity(rows.len() * width + columns.len() * height);
            for band in bands {
                levels.extend_from_slice(&band.frames[i][..band.rows.len() * width]);
            }
            for column in 0..columns.len() {
                for band in bands {
                    let of_columns = &band.frames[i][band.rows.len() * width..];
                    levels.extend(of_columns.chunks_exact(columns.len()).map(|row| row[column]));
                }
            }
            levels
        };
        let frames = (0..n).map(frame).collect();
        Self { rows, columns, width, height, frames }
    }

    /// The levels of a frame at all samples.
    pub(super) fn levels(&self, frame: usize) -> &[u16] {
        &self.frames[frame]
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.frames.first().map_or(0, Vec::len)
    }

    /// The pixel of a sample.
    pub(super) fn pixel(&self, sample: usize) -> [usize; 2] {
        let of_rows = self.rows.len() * self.width;
        if sample < of_rows {
            return [sample % self.width, self.rows[sample / self.width]];
        }
        let behind = sample - of_rows;
        [self.columns[behind / self.height], behind % self.height]
    }

    /// The samples that lie along rows, or along columns, a range for each line.
    pub(super) fn lines(&self, along_rows: bool) -> impl Iterator<Item = Range<usize>> + use<> {
        let of_rows = self.rows.len() * self.width;
        let (start, length, n) = if along_rows {
            (0, self.width, self.rows.len())
        } else {
            (of_rows, self.height, self.columns.len())
        };
        (0..n).map(move |i| start + i * length..start + (i + 1) * length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_kept_whatever_the_bands() {
        let (width, height) = (70, 50);
        let levels: Vec<u16> = (0..width * height).map(|i| i as u16).collect();
        let of_bands = |height_of_band: usize| {
            let firsts = (0..height).step_by(height_of_band);
            let bands: Vec<BandSamples> = firsts
                .map(|first| {
                    let rows = first..(first + height_of_band).min(height);
                    let mut band = BandSamples::new([width, height], &rows, 2);
                    let own = &levels[first * width..rows.end * width];
                    (0..2).for_each(|frame| band.keep(frame, own));
                    band
                })
                .collect();
            SampleLines::of([width, height], &bands.iter().collect::<Vec<_>>())
        };
        let (whole, parts) = (of_bands(height), of_bands(7));
        assert_eq!(whole.levels(1), parts.levels(1));
        assert_eq!(whole.len(), 24 * (width + height));
        for i in 0..whole.len() {
            let [x, y] = whole.pixel(i);
            assert_eq!(usize::from(whole.levels(1)[i]), y * width + x);
        }
        assert!(whole.lines(true).chain(whole.lines(false)).flatten().eq(0..whole.len()));
    }
}
