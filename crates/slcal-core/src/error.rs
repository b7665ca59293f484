//! The one error type of the library: each variant names what was wrong, with the numbers that show it.

/// What can go wrong between a photograph and a point cloud.
///
/// The message of every variant says what was expected, what was found and what to do about it. The variants sort
/// into the classes that callers act upon, see [`Error::class`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value given by the caller is outside what the operation is defined for.
    #[error("{what}: expected {expected}, found {found}")]
    Invalid {
        /// Which value it is.
        what: String,
        /// What values are accepted.
        expected: String,
        /// What was given.
        found: String,
    },
    /// Something that should be seen in the photograph was not found.
    #[error("{what} not found: {seen}; {advice}")]
    NotFound {
        /// The thing that was looked for: "sheet", "checkerboard", "stripes".
        what: &'static str,
        /// What was seen instead, with counts.
        seen: String,
        /// What the user can do.
        advice: String,
    },
    /// The geometry does not determine the answer.
    #[error("{what} is not determined: {advice}")]
    Degenerate {
        /// The quantity that is not determined.
        what: &'static str,
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
        /// "camera" or "projector".
        device: &'static str,
        /// The negative square, px².
        f_squared: f64,
        /// What the user can do.
        advice: String,
    },
    /// A file or a text is not what its schema says.
    #[error("malformed {what}: {detail}")]
    Malformed {
        /// The kind of text: "rig JSON", "pattern JSON", "matches CSV", "PLY".
        what: &'static str,
        /// Where and how it departs from the schema.
        detail: String,
    },
    /// Reading or writing the underlying stream failed.
    #[error("{what}: {detail}")]
    Io {
        /// What was being read or written.
        what: &'static str,
        /// The system's message.
        detail: String,
    },
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

impl Error {
    /// An [`Error::Invalid`] from anything that can be shown.
    pub fn invalid(
        what: impl Into<String>,
        expected: impl Into<String>,
        found: impl std::fmt::Display,
    ) -> Self {
        Self::Invalid { what: what.into(), expected: expected.into(), found: found.to_string() }
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
