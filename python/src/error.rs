//! Exceptions: the classes of `umbrage._errors`, with their fields.

use pyo3::prelude::*;
use umbrage::mesh::MeshError;
use umbrage::read::{Place, ReadError};

/// A bad argument: which one, where in it, what is wrong, what to do.
pub(crate) struct Problem {
    pub(crate) argument: &'static str,
    /// Row and column of an array.
    pub(crate) index: Option<(usize, usize)>,
    pub(crate) problem: String,
    pub(crate) remedy: String,
}

impl Problem {
    pub(crate) fn new(argument: &'static str, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { argument, index: None, problem: problem.into(), remedy: remedy.into() }
    }

    /// The same problem, at a row and column of the array.
    pub(crate) fn at(mut self, row: usize, column: usize) -> Self {
        self.index = Some((row, column));
        self
    }

    pub(crate) fn raise(self, py: Python<'_>) -> PyErr {
        let place = self.index.map(|(row, column)| format!("row {row}, column {column}"));
        raise(py, "ArgumentError", (self.argument, place, self.index, self.problem, self.remedy))
    }
}

/// The exception of a mesh that is refused although its arrays were read: it is too large.
pub(crate) fn mesh(py: Python<'_>, argument: &'static str, error: &MeshError) -> PyErr {
    Problem::new(argument, error.to_string(), "split the mesh").raise(py)
}

/// The exception of a file that cannot be read.
pub(crate) fn read(py: Python<'_>, error: &ReadError) -> PyErr {
    let (place, line, byte) = match &error.place {
        Place::Line(line) => (Some(format!("line {line}")), Some(*line), None),
        Place::Byte(byte) => (Some(format!("byte {byte}")), None, Some(*byte)),
        Place::Item(item) => (Some(item.clone()), None, None),
        _ => (None, None, None),
    };
    let file = error.file.to_string_lossy().into_owned();
    let format = error.format.map(|format| format.name());
    raise(py, "ReadError", (file, format, place, line, byte, error.problem.as_str(), error.remedy.as_str()))
}

fn raise<'py>(py: Python<'py>, class: &str, fields: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py
        .import("umbrage._errors")
        .and_then(|module| module.getattr(class))
        .and_then(|class| class.call1(fields));
    made.map_or_else(|error| error, PyErr::from_value)
}
