//! The Python module `umbrage._umbrage`: arrays of numpy in, reports and arrays out.
//!
//! One function a file or a pair of files; `arrays`, `options` and `error` are shared. Arrays are read under
//! the interpreter's lock, and all work after that is done without it. Documentation here is that of Python.

use pyo3::prelude::*;

mod ambient;
mod arrays;
mod caster;
mod check;
mod error;
mod options;
mod oracle;
mod prepare;
mod read;
mod results;

#[pymodule]
fn _umbrage(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<oracle::Oracle>()?;
    module.add_function(wrap_pyfunction!(ambient::ambient, module)?)?;
    module.add_function(wrap_pyfunction!(caster::silhouette, module)?)?;
    module.add_function(wrap_pyfunction!(caster::volume, module)?)?;
    module.add_function(wrap_pyfunction!(check::check, module)?)?;
    module.add_function(wrap_pyfunction!(check::check_arrays, module)?)?;
    module.add_function(wrap_pyfunction!(oracle::visible_fraction, module)?)?;
    module.add_function(wrap_pyfunction!(prepare::prepare, module)?)?;
    module.add_function(wrap_pyfunction!(read::read, module)?)?;
    Ok(())
}
