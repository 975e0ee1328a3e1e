//! Results: the named tuples of `umbrage._results`, and arrays without a copy.

use numpy::ndarray::Array2;
use numpy::{Element, PyArray2};
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;

/// A named tuple of that module, with these fields in order.
pub(crate) fn named<'py>(
    py: Python<'py>,
    class: &str,
    fields: impl PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("umbrage._results")?.getattr(class)?.call1(fields)
}

/// An array of `N` columns in the memory of the list.
pub(crate) fn table<T: Element, const N: usize>(py: Python<'_>, rows: Vec<[T; N]>) -> Bound<'_, PyArray2<T>> {
    let shape = (rows.len(), N);
    let table =
        Array2::from_shape_vec(shape, rows.into_flattened()).expect("this is the number of its items");
    PyArray2::from_owned_array(py, table)
}
