//! Errors of commands, one line each.

use std::fmt;
use std::path::Path;

use umbrage::read::{Format, ReadError};
use umbrage::shadow::PrepareError;
use umbrage::write::WriteError;

/// Why a command could not run: file, location, problem and remedy on one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Failure {
    line: String,
    /// The format of the file, if it was recognized.
    pub(crate) format: Option<Format>,
}

impl Failure {
    pub(crate) fn new(problem: impl fmt::Display, remedy: impl fmt::Display) -> Self {
        Self::of(format!("{problem}; {remedy}"), None)
    }

    pub(super) fn of(line: String, format: Option<Format>) -> Self {
        Self { line: line.replace(char::is_control, "\u{fffd}"), format }
    }

    /// The same failure, naming the file it is about.
    pub(crate) fn in_file(self, file: &Path) -> Self {
        Self::of(format!("{}: {}", file.display(), self.line), self.format)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.line)
    }
}

/// Both already print as one line with the name of the file.
impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Self::of(error.to_string(), error.format)
    }
}

impl From<PrepareError> for Failure {
    fn from(error: PrepareError) -> Self {
        Self::new(error, "write it behind the technique, as in pcf:size=512")
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Self::of(error.to_string(), None)
    }
}

/// Most of them name a remedy already.
#[cfg(feature = "gpu")]
impl From<umbrage::gpu::GpuError> for Failure {
    fn from(error: umbrage::gpu::GpuError) -> Self {
        let line = error.to_string();
        if line.contains("; ") {
            Self::of(line, None)
        } else {
            Self::new(line, "use another --adapter, or leave the graphics out")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failure_stays_on_one_line() {
        let failure = Failure::new("bad\nname", "use\r\nanother").in_file(Path::new("a\nb"));
        assert_eq!(failure.to_string().lines().count(), 1);
    }
}
