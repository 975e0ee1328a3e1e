//! The error of reading: file, place in the file, problem, remedy.

use std::fmt;
use std::path::PathBuf;

use super::Format;

/// The reason why a file could not be read. Prints as one line: file, place, problem, remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// The file.
    pub file: PathBuf,
    /// The format, if it was detected.
    pub format: Option<Format>,
    /// The place in the file.
    pub place: Place,
    /// The problem: what was found, and what was expected.
    pub problem: String,
    /// The remedy.
    pub remedy: String,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(u64),
    /// A byte of a binary file, counted from 0.
    Byte(u64),
    /// A named item of the file: "accessor 3", "element face, item 12".
    Item(String),
}

impl ReadError {
    /// An error at `place`; [`ReadError::in_file`] adds the file's name.
    pub fn new(format: impl Into<Option<Format>>, place: Place, problem: impl Into<String>) -> Self {
        Self {
            file: PathBuf::new(),
            format: format.into(),
            place,
            problem: problem.into(),
            remedy: "export the file again".to_owned(),
        }
    }

    /// The same error with advice that fits better than exporting the file again.
    #[must_use]
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = remedy.into();
        self
    }

    /// The same error, naming the file it came from.
    #[must_use]
    pub fn in_file(mut self, file: impl Into<PathBuf>) -> Self {
        self.file = file.into();
        self
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A name or a token from the file may hold line breaks; the message stays on one line.
        let one_line = |text: &str| text.replace(char::is_control, "\u{fffd}");
        write!(f, "{}", one_line(&self.file.to_string_lossy()))?;
        match &self.place {
            Place::File => {}
            Place::Line(line) => write!(f, ", line {line}")?,
            Place::Byte(byte) => write!(f, ", byte {byte}")?,
            Place::Item(item) => write!(f, ", {}", one_line(item))?,
        }
        if let Some(format) = self.format {
            write!(f, " ({format})")?;
        }
        write!(f, ": {}; {}", one_line(&self.problem), one_line(&self.remedy))
    }
}

impl std::error::Error for ReadError {}
