//! Which photograph of a folder is which frame of a sequence, by the names of the files.

use std::cmp::Ordering;
use std::collections::HashMap;

use super::sequence::SequencePattern;
use crate::error::{Error, Result};

/// How the frames are called in messages.
const WHAT: &str = "frames";

impl SequencePattern {
    /// Which photographs are the frames, by the names of the files (without their folder): for each frame the index of its name in `names`.
    ///
    /// Where the pattern names the file of every frame, and at least one of these is there, these photographs are taken, whatever their
    /// extension and the case of their letters, and others are left out. Else all photographs are taken in [natural order](natural_order).
    ///
    /// # Errors
    /// [`Error::Invalid`] for a photograph that the pattern names and that is not there or there more than once, and for another number of
    /// photographs than the pattern has frames.
    ///
    /// ```
    /// use slcal_core::{SequenceConfig, SequencePattern};
    ///
    /// let mut pattern = SequencePattern::new([2, 2], &SequenceConfig::default())?; // White, black, a bit and its inverse.
    /// let names = ["frame_001.JPG", "frame_000.JPG", "frame_003.JPG", "frame_002.JPG", "notes.png"];
    /// assert_eq!(pattern.frame_order(&names)?, [1, 0, 3, 2]);
    /// pattern.frames.iter_mut().for_each(|frame| frame.file = None);
    /// assert_eq!(pattern.frame_order(&["p10.png", "p9.png", "p11.png", "p8.png"])?, [3, 1, 0, 2]);
    /// # Ok::<(), slcal_core::Error>(())
    /// ```
    pub fn frame_order<N: AsRef<str>>(&self, names: &[N]) -> Result<Vec<usize>> {
        let mut by_stem: HashMap<String, Vec<usize>> = HashMap::new();
        for (i, name) in names.iter().enumerate() {
            by_stem.entry(stem(name.as_ref())).or_default().push(i);
        }
        let files: Option<Vec<&str>> = self.frames.iter().map(|frame| frame.file.as_deref()).collect();
        if let Some(files) = files
            && files.iter().any(|file| by_stem.contains_key(&stem(file)))
        {
            let one = |(frame, file): (usize, &&str)| match by_stem.get(&stem(file)).map(Vec::as_slice) {
                Some(&[i]) => Ok(i),
                Some(several) => {
                    let found: Vec<&str> = several.iter().map(|&i| names[i].as_ref()).collect();
                    Err(self.several(frame, &found))
                }
                None => Err(self.missing(frame, file)),
            };
            return files.iter().enumerate().map(one).collect();
        }
        let expected = self.frames.len();
        if names.len() != expected {
            return Err(Error::invalid(
                WHAT,
                format!("the {expected} frames of the pattern"),
                format!("{} photographs; is one missing, or the pattern file another one?", names.len()),
            ));
        }
        let mut order: Vec<usize> = (0..expected).collect();
        order.sort_by(|&a, &b| natural_order(names[a].as_ref(), names[b].as_ref()));
        Ok(order)
    }

    fn missing(&self, frame: usize, file: &str) -> Error {
        let light = self.frames[frame].light;
        let expected = format!("{file} (frame {frame}, {light}) among the photographs");
        Error::invalid(WHAT, expected, "none; take it again, with all others")
    }

    fn several(&self, frame: usize, found: &[&str]) -> Error {
        let light = self.frames[frame].light;
        let expected = format!("one photograph of frame {frame} ({light})");
        Error::invalid(WHAT, expected, format!("{}; leave one in the folder", found.join(" and ")))
    }
}

/// Compares names in natural order: numbers by value, other text by letters, so that img2 is before img10.
#[must_use]
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let split = |text: &str| {
        let digits = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        if digits > 0 { digits } else { text.chars().next().map_or(0, char::len_utf8) }
    };
    let (mut left, mut right) = (a, b);
    while !left.is_empty() && !right.is_empty() {
        let ((x, after_x), (y, after_y)) = (left.split_at(split(left)), right.split_at(split(right)));
        let order = match (x.parse::<u128>(), y.parse::<u128>()) {
            (Ok(x), Ok(y)) => x.cmp(&y),
            _ => x.cmp(y),
        };
        if order != Ordering::Equal {
            return order;
        }
        (left, right) = (after_x, after_y);
    }
    left.len().cmp(&right.len()).then_with(|| a.cmp(b))
}

/// The name without its extension, in small letters.
fn stem(name: &str) -> String {
    let stem = match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => name,
    };
    stem.to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::SequenceConfig;

    #[test]
    fn numbers_are_ordered_by_their_values() {
        let mut names = ["b1.png", "a10.png", "a9.png", "a09.png", "a.png", "10.png", "9.png"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["9.png", "10.png", "a.png", "a09.png", "a9.png", "a10.png", "b1.png"]);
    }

    #[test]
    fn a_frame_that_is_missing_or_there_twice_is_named() {
        let pattern = SequencePattern::new([4, 3], &SequenceConfig::default()).unwrap();
        let mut names: Vec<String> = (0..6).map(|i| format!("FRAME_{i:03}.jpg")).collect();
        names.push("truth.png".into());
        assert_eq!(pattern.frame_order(&names).unwrap(), [0, 1, 2, 3, 4, 5]);
        names.push("frame_002.png".into());
        let message = pattern.frame_order(&names).unwrap_err().to_string();
        assert!(message.contains("frame 2 (bit 1 of the columns)"), "{message}");
        assert!(message.contains("FRAME_002.jpg and frame_002.png"), "{message}");
        names.truncate(5);
        let message = pattern.frame_order(&names).unwrap_err().to_string();
        assert!(message.contains("frame_005.png (frame 5, bit 0 of the columns, inverted)"), "{message}");
    }

    #[test]
    fn other_names_count_one_and_all() {
        let pattern = SequencePattern::new([4, 3], &SequenceConfig::default()).unwrap();
        let names = ["img12", "img9", ".png", "img10", "img11", "é.png"];
        assert_eq!(pattern.frame_order(&names).unwrap(), [2, 1, 3, 4, 0, 5]);
        let message = pattern.frame_order(&names[1..]).unwrap_err().to_string();
        assert!(message.contains("expected the 6 frames") && message.contains("found 5"), "{message}");
    }
}
