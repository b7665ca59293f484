//! Some rows and columns of the image, of which the levels in every frame are kept: what is asked of the sequence as a whole is
//! asked of them.

/// Rows that are kept, and columns.
const LINES: usize = 24;

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
    pub(super) fn new(width: usize, height: usize, frames: usize) -> Self {
        let spread = |n: usize| {
            let lines = LINES.min(n);
            (0..lines).map(|i| (2 * i + 1) * n / (2 * lines)).collect::<Vec<_>>()
        };
        let (rows, columns) = (spread(height), spread(width));
        let length = rows.len() * width + columns.len() * height;
        Self { rows, columns, width, height, frames: vec![vec![0; length]; frames] }
    }

    /// Keeps the levels of a frame on those of the lines that lie in rows from `first` on.
    pub(super) fn keep(&mut self, frame: usize, first: usize, levels: &[u16]) {
        let kept = &mut self.frames[frame];
        let last = first + levels.len() / self.width;
        for (i, y) in self.rows.iter().enumerate().filter(|(_, y)| (first..last).contains(*y)) {
            let row = &levels[(y - first) * self.width..][..self.width];
            kept[i * self.width..][..self.width].copy_from_slice(row);
        }
        let columns = &mut kept[self.rows.len() * self.width..];
        for (i, x) in self.columns.iter().enumerate() {
            let to = columns[i * self.height..][first..last].iter_mut();
            to.zip(levels[*x..].iter().step_by(self.width)).for_each(|(to, level)| *to = *level);
        }
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
    pub(super) fn lines(&self, along_rows: bool) -> impl Iterator<Item = std::ops::Range<usize>> + use<> {
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
        let [mut whole, mut parts] = [SampleLines::new(width, height, 2), SampleLines::new(width, height, 2)];
        whole.keep(1, 0, &levels);
        for first in (0..height).step_by(7) {
            parts.keep(1, first, &levels[first * width..(first + 7).min(height) * width]);
        }
        assert_eq!(whole.levels(1), parts.levels(1));
        assert_eq!(whole.len(), 24 * (width + height));
        for i in 0..whole.len() {
            let [x, y] = whole.pixel(i);
            assert_eq!(usize::from(whole.levels(1)[i]), y * width + x);
        }
        assert!(whole.lines(true).chain(whole.lines(false)).flatten().eq(0..whole.len()));
    }
}
