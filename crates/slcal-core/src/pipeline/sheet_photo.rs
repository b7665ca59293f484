//! A photograph of the sheet with what is known about it.

use nalgebra::Point2;

use super::photo_tags::PhotoTags;
use crate::dense_matches::DenseMatches;
use crate::photo::PhotoView;

/// A photograph of the sheet and what is known about it.
#[derive(Debug, Clone)]
pub struct SheetPhoto<'a> {
    pub(super) view: PhotoView<'a>,
    pub(super) name: Option<String>,
    pub(super) plain: Option<PhotoView<'a>>,
    pub(super) matches: Option<&'a DenseMatches>,
    pub(super) corners: Option<[Point2<f64>; 4]>,
    pub(super) tags: Option<PhotoTags>,
    /// Whether the focal length in the tags is a prior.
    pub(super) focal_from_tags: bool,
    pub(super) focal_35mm: Option<f64>,
}

impl<'a> SheetPhoto<'a> {
    /// A photograph of which nothing else is known.
    #[must_use]
    pub fn new(view: PhotoView<'a>) -> Self {
        Self {
            view,
            name: None,
            plain: None,
            matches: None,
            corners: None,
            tags: None,
            focal_from_tags: false,
            focal_35mm: None,
        }
    }

    /// Its name, for messages and for the rig's view.
    #[must_use]
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// The same pose with a dark or plain projection, in the same size: the sheet's sides are measured there.
    #[must_use]
    pub fn plain(mut self, plain: PhotoView<'a>) -> Self {
        self.plain = Some(plain);
        self
    }

    /// What a sequence says of every pixel of this pose ([`SequenceDecoder`](crate::decode::SequenceDecoder)), for
    /// [`Calibrator::with_sequence`](super::Calibrator::with_sequence). The photograph is then that under white light.
    #[must_use]
    pub fn matches(mut self, matches: &'a DenseMatches) -> Self {
        self.matches = Some(matches);
        self
    }

    /// The sheet's corners TL, TR, BR, BL by hand, px, where it is not found; they may lie outside the frame.
    #[must_use]
    pub fn corners(mut self, corners: [Point2<f64>; 4]) -> Self {
        self.corners = Some(corners);
        self
    }

    /// What the camera wrote into the photograph. The pixels are expected upright: turned as
    /// [`PhotoTags::orientation`] asks.
    ///
    /// Photographs whose orientation differs are turned alike where they fit together only so. What contradicts the
    /// calibration, or shows that the photograph was cropped, is told as a warning. The focal length is not used unless
    /// [`focal_from_tags`](Self::focal_from_tags) asks for it.
    #[must_use]
    pub fn tags(mut self, tags: PhotoTags) -> Self {
        self.tags = Some(tags);
        self
    }

    /// The focal length that the tags state becomes a prior for the camera's ([`PhotoTags::focal`]).
    #[must_use]
    pub fn focal_from_tags(mut self) -> Self {
        self.focal_from_tags = true;
        self
    }

    /// The 35 mm equivalent of the focal length, mm, as the EXIF tag `FocalLengthIn35mmFilm` states it: a prior for the
    /// camera's focal length. It comes before that of the tags.
    #[must_use]
    pub fn focal_35mm(mut self, mm: f64) -> Self {
        self.focal_35mm = Some(mm);
        self
    }
}

impl<'a> From<PhotoView<'a>> for SheetPhoto<'a> {
    fn from(view: PhotoView<'a>) -> Self {
        Self::new(view)
    }
}
