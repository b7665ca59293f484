//! The failures of a run and their exit codes.

use std::fmt;
use std::path::Path;

use slcal_core::{Error, ErrorClass};

use crate::name::input_name;

/// The exit codes of the command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// Other errors, such as an output that cannot be written.
    Other = 1,
    /// The command line is wrong.
    Usage = 2,
    /// An input cannot be read or is malformed.
    Input = 3,
    /// The sheet, the pattern or the stripes were not found in a photograph.
    NotFound = 4,
    /// The geometry does not determine the answer.
    Degenerate = 5,
}

impl From<ErrorClass> for Exit {
    fn from(class: ErrorClass) -> Self {
        match class {
            ErrorClass::Usage => Self::Usage,
            ErrorClass::Input => Self::Input,
            ErrorClass::NotFound => Self::NotFound,
            ErrorClass::Degenerate => Self::Degenerate,
            _ => Self::Other,
        }
    }
}

/// Why a run failed.
#[derive(Debug, Clone)]
pub(crate) enum Failure {
    /// An error to be shown.
    Error {
        /// The code of the process.
        exit: Exit,
        /// What was expected, what was found, what to do.
        message: String,
    },
    /// Errors that were printed when they occurred, while the work continued; this is the code of the first.
    Reported(u8),
    /// The reader of stdout has gone, so nothing is printed.
    ClosedPipe,
}

impl Failure {
    pub(crate) fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self::Error { exit, message: message.into() }
    }

    /// A wrong command line that clap cannot detect.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// An input that cannot be used; the message follows the name of its file.
    pub(crate) fn input(path: &Path, message: impl fmt::Display) -> Self {
        Self::new(Exit::Input, format!("{}: {message}", input_name(path)))
    }

    /// An error of the core from a file. The message names the file. A value that the core calls
    /// invalid is then a malformed input, not a wrong command line.
    pub(crate) fn in_file(path: &Path, error: &Error) -> Self {
        let exit = match Exit::from(error.class()) {
            Exit::Usage => Exit::Input,
            other => other,
        };
        Self::new(exit, format!("{}: {error}", input_name(path)))
    }

    /// The same with more to say.
    pub(crate) fn and(self, more: &str) -> Self {
        match self {
            Self::Error { exit, message } => Self::Error { exit, message: message + more },
            silent => silent,
        }
    }

    /// The code of the process.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Error { exit, .. } => *exit as u8,
            Self::Reported(code) => *code,
            Self::ClosedPipe => 0,
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::new(Exit::from(error.class()), error.to_string())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Error { message, .. } => f.write_str(message),
            Self::Reported(_) | Self::ClosedPipe => Ok(()),
        }
    }
}

/// The result of verbs.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

/// Adds the name of the file to an error of the core.
pub(crate) trait InFile<T> {
    /// See [`Failure::in_file`].
    fn in_file(self, path: &Path) -> Outcome<T>;
}

impl<T> InFile<T> for slcal_core::Result<T> {
    fn in_file(self, path: &Path) -> Outcome<T> {
        self.map_err(|e| Failure::in_file(path, &e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_have_the_codes_of_the_interface() {
        let imaginary = Error::ImaginaryFocal {
            device: slcal_core::ErrorSubject::Camera,
            f_squared: -1.0,
            advice: String::new(),
        };
        assert_eq!(Failure::from(imaginary).code(), 5);
        let invalid = Error::invalid(slcal_core::ErrorSubject::SheetSize, "two lengths", "none");
        assert_eq!(Failure::from(invalid.clone()).code(), 2);
        let in_file = Failure::in_file(Path::new("rig.json"), &invalid);
        assert_eq!(in_file.code(), 3);
        assert!(in_file.to_string().starts_with("rig.json: sheet size"));
    }
}
