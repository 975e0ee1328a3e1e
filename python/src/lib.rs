//! The Python module `umbrage._umbrage`: arrays of numpy in, reports and arrays out.
//!
//! One function a file or a pair of files; `arrays`, `options` and `error` are shared. Arrays are read under
//! the interpreter's lock, and all work after that is done without it. Documentation here is that of Python.

use pyo3::prelude::*;

mod arrays;
mod check;
mod error;
mod options;

#[pymodule]
fn _umbrage(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(check::check, module)?)?;
    module.add_function(wrap_pyfunction!(check::check_arrays, module)?)?;
    Ok(())
}
