//! The one error type of the library: each variant names what was wrong, with the numbers that show it.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// What can go wrong between a photograph and a point cloud.
///
/// The message of every variant says what was expected, what was found and what to do about it. `what` is the [`ErrorSubject`] of
/// the message, for programs that act upon it. The variants sort into classes, see [`Error::class`].
///
/// ```
/// use slcal_core::{Error, ErrorClass, ErrorSubject, geometry::RectangleSize};
///
/// let error = RectangleSize::new(0.0, 420.0).unwrap_err();
/// assert!(matches!(error, Error::Invalid { what: ErrorSubject::SheetSize, .. }));
/// assert_eq!(error.class(), ErrorClass::Usage);
/// assert!(error.to_string().starts_with("sheet size: expected two positive lengths"));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value given by the caller is outside what the operation is defined for.
    #[error("{what}: expected {expected}, found {found}")]
    Invalid {
        /// Which value it is.
        what: ErrorSubject,
        /// What values are accepted.
        expected: String,
        /// What was given.
        found: String,
    },
    /// Something that should be seen in the photograph was not found.
    #[error("{what} not found: {seen}; {advice}")]
    NotFound {
        /// The thing that was looked for.
        what: ErrorSubject,
        /// What was seen instead, with counts.
        seen: String,
        /// What the user can do.
        advice: String,
    },
    /// The geometry does not determine the answer.
    #[error("{what} is not determined: {advice}")]
    Degenerate {
        /// The quantity that is not determined.
        what: ErrorSubject,
        /// The number that shows it; what it means to the user is said in `advice`.
        measure: f64,
        /// The limit that it missed.
        limit: f64,
        /// What the user can do.
        advice: String,
    },
    /// The closed form gives a negative squared focal length: no camera with this principal point sees the
    /// sheet's sides as perpendicular.
    #[error(
        "the focal length of the {device} is imaginary (its square came out negative, {f_squared:.4e} px²); {advice}"
    )]
    ImaginaryFocal {
        /// [`ErrorSubject::Camera`] or [`ErrorSubject::Projector`].
        device: ErrorSubject,
        /// The negative square, px².
        f_squared: f64,
        /// What the user can do.
        advice: String,
    },
    /// A file or a text is not what its schema says.
    #[error("malformed {what}: {detail}")]
    Malformed {
        /// The kind of text.
        what: ErrorSubject,
        /// Where and how it departs from the schema.
        detail: String,
        /// The error of the parser, where there is one.
        source: Option<Cause>,
    },
    /// Reading or writing the underlying stream failed.
    #[error("{access} {what}: {source}")]
    Io {
        /// "reading" or "writing".
        access: &'static str,
        /// The kind of text.
        what: ErrorSubject,
        /// The stream's error.
        source: Cause,
    },
}

/// An error of the system or of a parser; [`std::error::Error::source`] gives it with its own type. Two are equal when their
/// messages are.
#[derive(Debug, Clone)]
pub struct Cause(Arc<dyn std::error::Error + Send + Sync>);

impl Deref for Cause {
    type Target = dyn std::error::Error + Send + Sync;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl PartialEq for Cause {
    fn eq(&self, other: &Self) -> bool {
        self.0.to_string() == other.0.to_string()
    }
}

/// A subject per line, with its name in messages.
macro_rules! subjects {
    ($($name:ident = $text:literal,)*) => {
        /// What an [`Error`] is about: an input, a thing in a photograph, a quantity, a kind of file, or an option by its name.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum ErrorSubject {
            $(#[doc = $text] $name,)*
            /// An option, a field of a configuration or another quantity, by its name: `min_confidence`.
            Named(&'static str),
            /// An entry of a list in a file: `centres_px[3]`.
            Element {
                /// The list.
                list: &'static str,
                /// The entry, from 0.
                index: usize,
            },
            /// A part of something: the size of the camera image.
            Part {
                /// The part.
                part: &'static str,
                /// What it belongs to.
                of: &'static str,
            },
            /// Part of the observations of one photograph.
            View {
                /// The photograph, from 0.
                index: usize,
                /// The part.
                part: &'static str,
            },
        }

        impl fmt::Display for ErrorSubject {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    $(Self::$name => f.write_str($text),)*
                    Self::Named(name) => f.write_str(name),
                    Self::Element { list, index } => write!(f, "{list}[{index}]"),
                    Self::Part { part, of } => write!(f, "{part} of the {of}"),
                    Self::View { index, part } => write!(f, "view {}, {part}", index + 1),
                }
            }
        }
    };
}

subjects! {
    // What the caller gives.
    Photograph = "photograph",
    Photographs = "photographs",
    PlainPhotograph = "plain photograph",
    StripedPhotograph = "striped photograph",
    BlackFrame = "black frame",
    WhiteFrame = "white frame",
    Camera = "camera",
    Projector = "projector",
    KnownCamera = "known camera",
    CameraLens = "the camera's lens",
    ProjectorLens = "the projector's lens",
    CameraImageSize = "size of the camera's image",
    ProjectorImageSize = "size of the projector's image",
    Panel = "projector panel",
    SheetSize = "sheet size",
    SheetCorners = "corners",
    Pattern = "pattern",
    StripePattern = "stripe pattern",
    Rig = "rig",
    Observations = "observations",
    Cloud = "cloud",
    Import = "files to import",
    // What is looked for in a photograph or a cloud.
    Sheet = "sheet",
    Checkerboard = "checkerboard",
    Stripes = "stripes",
    ColoredStripes = "coloured stripes",
    PatternCode = "the pattern's code",
    PatternHues = "the pattern's hues",
    Plane = "plane",
    Sphere = "sphere",
    Surface = "surface",
    // What is estimated.
    Calibration = "the calibration",
    FocalLength = "the focal length",
    LensShift = "the projector's lens shift",
    Pose = "pose",
    Homography = "homography",
    RectifiedPicture = "the rectified picture",
    RigComparison = "the comparison with the rig",
    // Files.
    RigFile = "rig JSON",
    PatternFile = "pattern JSON",
    ObservationsFile = "observations JSON",
    MatchesFile = "matches",
    CameraFile = "camera file",
    Ply = "PLY",
    Obj = "OBJ",
    Pcd = "PCD",
    Xyz = "XYZ",
    Glb = "GLB",
    Pfm = "PFM",
    OpenCvFile = "OpenCV file",
    RosFile = "ROS camera_info",
    ColmapModel = "COLMAP model",
    KalibrFile = "Kalibr camchain",
    BlenderScript = "script for Blender",
    NpzFile = "npz file",
    ImportFile = "file to import",
    ImportFolder = "folder to import",
}

impl From<&'static str> for ErrorSubject {
    fn from(name: &'static str) -> Self {
        Self::Named(name)
    }
}

/// The classes of [`Error`] that callers distinguish (the command line's exit codes follow them).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorClass {
    /// A parameter given by the caller is wrong.
    Usage,
    /// An input cannot be read or does not follow its schema.
    Input,
    /// The sheet, the pattern or the stripes are not in the photograph.
    NotFound,
    /// The geometry is degenerate.
    Degenerate,
    /// Anything else.
    Other,
}

/// Refuses a value outside its range; `unit` follows the numbers of the message.
pub(crate) fn within<T: PartialOrd + Copy + fmt::Display>(
    what: impl Into<ErrorSubject>,
    value: T,
    [least, most]: [T; 2],
    unit: &str,
) -> Result<()> {
    if least <= value && value <= most {
        return Ok(());
    }
    Err(Error::invalid(what, format!("{least} to {most}{unit}"), format!("{value}{unit}")))
}

/// Characters of a message at its beginning and at its end, where it is longer than both: what it quotes from a file may be gigantic.
const BEGINNING: usize = 800;
const END: usize = 200;

/// A text, without its middle where it is long.
fn shortened(text: String) -> String {
    if text.len() <= BEGINNING + END {
        return text;
    }
    let place = |(at, _): (usize, char)| at;
    let beginning = text.char_indices().nth(BEGINNING).map_or(text.len(), place);
    let end = text.char_indices().nth_back(END - 1).map_or(0, place);
    if beginning >= end { text } else { format!("{} … {}", &text[..beginning], &text[end..]) }
}

impl Error {
    /// An [`Error::Invalid`] from anything that can be shown.
    pub fn invalid(
        what: impl Into<ErrorSubject>,
        expected: impl Into<String>,
        found: impl fmt::Display,
    ) -> Self {
        Self::Invalid {
            what: what.into(),
            expected: shortened(expected.into()),
            found: shortened(found.to_string()),
        }
    }

    /// An [`Error::Malformed`] without another error behind it.
    pub fn malformed(what: ErrorSubject, detail: impl Into<String>) -> Self {
        Self::Malformed { what, detail: shortened(detail.into()), source: None }
    }

    /// An [`Error::Degenerate`] without a measure of how far the geometry is from determining `what`.
    pub(crate) fn undetermined(what: ErrorSubject, advice: impl Into<String>) -> Self {
        Self::Degenerate { what, measure: 0.0, limit: 0.0, advice: advice.into() }
    }

    /// An [`Error::Malformed`] of a text that a parser refuses.
    pub(crate) fn unparsable(
        what: ErrorSubject,
        is_not: &str,
        source: impl std::error::Error + Send + Sync + 'static,
    ) -> Self {
        let detail = shortened(format!("this is not {is_not}: {source}"));
        Self::Malformed { what, detail, source: Some(Cause(Arc::new(source))) }
    }

    /// An [`Error::Io`] of a stream that was read.
    pub(crate) fn reading(what: ErrorSubject, source: std::io::Error) -> Self {
        Self::Io { access: "reading", what, source: Cause(Arc::new(source)) }
    }

    /// An [`Error::Io`] of a stream that was written.
    pub(crate) fn writing(what: ErrorSubject, source: impl Into<std::io::Error>) -> Self {
        Self::Io { access: "writing", what, source: Cause(Arc::new(source.into())) }
    }

    /// The class of this error.
    #[must_use]
    pub fn class(&self) -> ErrorClass {
        match self {
            Self::Invalid { .. } => ErrorClass::Usage,
            Self::Malformed { .. } => ErrorClass::Input,
            Self::NotFound { .. } => ErrorClass::NotFound,
            Self::Degenerate { .. } | Self::ImaginaryFocal { .. } => ErrorClass::Degenerate,
            Self::Io { .. } => ErrorClass::Other,
        }
    }
}

/// Shorthand for results of this library.
pub type Result<T> = std::result::Result<T, Error>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_quotes_lose_their_middle() {
        let said = |quoted: &str| {
            Error::malformed(ErrorSubject::Ply, format!("\"{quoted}\" is not a number")).to_string()
        };
        assert_eq!(said("a"), "malformed PLY: \"a\" is not a number");
        for letter in ["a", "é", "点"] {
            let long = said(&letter.repeat(100_000));
            assert!(long.chars().count() < 1100 && long.contains(" … "), "{}", long.len());
            assert!(
                long.starts_with(&format!("malformed PLY: \"{letter}")) && long.ends_with("is not a number")
            );
            assert!(said(&letter.repeat(900)).contains(&letter.repeat(900)));
        }
        let invalid = Error::invalid("size", "a number", "9".repeat(5000)).to_string();
        assert!(invalid.starts_with("size: expected a number, found 999") && invalid.len() < 1100);
    }
}
