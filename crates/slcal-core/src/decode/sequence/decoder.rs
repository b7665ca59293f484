//! Frames of a sequence → the panel coordinates of every pixel.

use super::decoding::decoding;
use super::folded_frames::FoldedFrames;
use super::frame_plan::FramePlan;
use super::levels::LevelScale;
use super::report::{SequenceDecodeConfig, SequenceDecoding};
use crate::error::{Error, ErrorSubject, Result};
use crate::pattern::SequencePattern;
use crate::photo::PhotoView;

/// Decodes sequences of frames. A frame is folded into what is kept of every pixel and can be dropped: memory does not grow with the
/// number of frames (as long as they come in the [order](Self::reading_order) that needs least).
#[derive(Debug, Clone)]
pub struct SequenceDecoder {
    pattern: SequencePattern,
    config: SequenceDecodeConfig,
    plan: FramePlan,
    state: Option<FoldedFrames>,
    seen: Vec<bool>,
}

impl SequenceDecoder {
    /// For the frames of this pattern.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a pattern that is not [valid](SequencePattern::validate).
    pub fn new(pattern: &SequencePattern, config: SequenceDecodeConfig) -> Result<Self> {
        pattern.validate()?;
        let plan = FramePlan::of(pattern);
        let seen = vec![false; plan.lights.len()];
        Ok(Self { pattern: pattern.clone(), config, plan, state: None, seen })
    }

    /// The order of frames in which the least has to be held: white and black, then every bit with its inverse.
    #[must_use]
    pub fn reading_order(&self) -> &[usize] {
        &self.plan.reading_order
    }

    /// Takes the photograph of a frame of the pattern, counted from 0; in any order.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a frame that is not in the pattern or has come before, and for a photograph of another size or depth than the first.
    pub fn push(&mut self, frame: usize, photo: PhotoView<'_>) -> Result<()> {
        self.accept(frame, &photo)?;
        if let Some(state) = &mut self.state {
            state.fold(&self.plan, &self.seen, frame, &photo, self.config.parallel);
        }
        Ok(())
    }

    /// Decodes frames that lie in memory, in the order of the pattern.
    ///
    /// # Errors
    /// As [`push`](Self::push) and [`finish`](Self::finish); [`Error::Invalid`] for another number of frames than the pattern has.
    pub fn decode(&mut self, frames: &[PhotoView<'_>]) -> Result<SequenceDecoding> {
        let expected = self.plan.lights.len();
        if frames.len() != expected {
            return Err(Error::invalid(
                "frames of the sequence",
                format!("{expected}, as the pattern has"),
                frames.len(),
            ));
        }
        self.clear();
        for (i, photo) in frames.iter().enumerate() {
            // Of frames that are refused none has come.
            self.accept(i, photo).inspect_err(|_| self.clear())?;
        }
        if let Some(state) = &mut self.state {
            state.fold_all(&self.plan, frames, self.config.parallel);
        }
        self.finish()
    }

    /// Drops what has come.
    pub fn clear(&mut self) {
        self.seen.fill(false);
    }

    /// Checks a frame, and prepares for its size.
    fn accept(&mut self, frame: usize, photo: &PhotoView<'_>) -> Result<()> {
        let n = self.seen.len();
        if frame >= n {
            return Err(Error::invalid(
                "frame of the sequence",
                format!("below {n}, as the pattern has"),
                frame,
            ));
        }
        let name = self.plan.lights[frame];
        if self.seen[frame] {
            return Err(Error::invalid(
                "frames of the sequence",
                "each once",
                format!("frame {frame} ({name}) twice"),
            ));
        }
        let scale = LevelScale::of(photo);
        let is_first = !self.seen.contains(&true);
        let fits =
            |s: &FoldedFrames| (s.width, s.height) == (photo.width(), photo.height()) && s.scale == scale;
        match &self.state {
            Some(state) if fits(state) => {}
            Some(state) if !is_first => return Err(unlike(frame, photo, scale, state)),
            _ => self.state = Some(FoldedFrames::new(&self.pattern, &self.plan, photo, scale)),
        }
        self.seen[frame] = true;
        Ok(())
    }

    /// The panel coordinates of every pixel, once all frames have come; the next sequence can come then.
    ///
    /// # Errors
    /// [`Error::Invalid`] when frames are missing; [`Error::NotFound`] when no pixel is lit by the projector, or none can be read.
    pub fn finish(&mut self) -> Result<SequenceDecoding> {
        let missing: Vec<usize> = (0..self.seen.len()).filter(|i| !self.seen[*i]).collect();
        if let Some(&first) = missing.first() {
            let more = missing.len() - 1;
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let found = format!("no frame {first} ({}){more}", self.plan.lights[first]);
            return Err(Error::invalid("frames of the sequence", format!("all {}", self.seen.len()), found));
        }
        let Some(state) = &self.state else {
            return Err(Error::invalid("frames of the sequence", "frames", "none"));
        };
        let decoding = decoding(state, &self.plan, &self.pattern, self.config);
        self.clear();
        decoding
    }
}

fn unlike(frame: usize, photo: &PhotoView<'_>, scale: LevelScale, state: &FoldedFrames) -> Error {
    Error::invalid(
        ErrorSubject::Named("frames of the sequence"),
        format!("{}x{} px, {}, as the others", state.width, state.height, state.scale.name()),
        format!("{}x{} px, {} (frame {frame})", photo.width(), photo.height(), scale.name()),
    )
}
