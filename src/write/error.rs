//! Errors of writing: file, problem and remedy.

use std::path::PathBuf;
use std::{fmt, io};

use crate::read::{Place, ReadError};

/// Why a file could not be written. Prints as one line: file, problem, remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriteError {
    /// The file; empty for bytes in memory.
    pub file: PathBuf,
    /// What went wrong.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
}

impl WriteError {
    /// An error without a file; [`WriteError::in_file`] adds its name.
    pub fn new(problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { file: PathBuf::new(), problem: problem.into(), remedy: remedy.into() }
    }

    /// The same error, naming the file that was to be written.
    #[must_use]
    pub fn in_file(mut self, file: impl Into<PathBuf>) -> Self {
        self.file = file.into();
        self
    }
}

impl From<io::Error> for WriteError {
    fn from(error: io::Error) -> Self {
        let remedy = match error.kind() {
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "check the permissions",
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "free some space",
            _ => "write to another folder",
        };
        Self::new(format!("cannot be written: {error}"), remedy)
    }
}

/// Of a file that is read to be written again.
impl From<ReadError> for WriteError {
    fn from(error: ReadError) -> Self {
        let problem = match &error.place {
            Place::File => error.problem,
            Place::Line(line) => format!("line {line}: {}", error.problem),
            Place::Byte(byte) => format!("byte {byte}: {}", error.problem),
            Place::Item(item) => format!("{item}: {}", error.problem),
        };
        Self { file: error.file, problem, remedy: error.remedy }
    }
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A name may hold line breaks; the message stays on one line.
        let one_line = |text: &str| text.replace(char::is_control, "\u{fffd}");
        if !self.file.as_os_str().is_empty() {
            write!(f, "{}: ", one_line(&self.file.to_string_lossy()))?;
        }
        write!(f, "{}; {}", one_line(&self.problem), one_line(&self.remedy))
    }
}

impl std::error::Error for WriteError {}
