//! Mesh files into arrays.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::{error, options, results};

/// The meshes of a file as arrays, where the scene places them.
///
/// Parameters
/// ----------
/// path : str or os.PathLike
///     As for `check`.
/// scope : "mesh" (default), "primitive" or "scene"
///     What becomes one mesh.
///
/// Returns
/// -------
/// list of Mesh
///     ``name``; ``vertices``, float32 of shape (n, 3), and ``faces``, uint32 of shape (m, 3), not welded.
///
/// Raises
/// ------
/// ReadError
///     If the file cannot be read; it names file, place and remedy.
///
/// Examples
/// --------
/// >>> try:
/// ...     umbrage.read("no.glb")
/// ... except umbrage.ReadError as error:
/// ...     print(error.file, "|", error.remedy)
/// no.glb | check the path
#[pyfunction]
#[pyo3(signature = (path, *, scope="mesh"))]
pub(crate) fn read<'py>(py: Python<'py>, path: PathBuf, scope: &str) -> PyResult<Bound<'py, PyList>> {
    let scope = options::scope(py, scope)?;
    let scene = py.detach(|| umbrage::read::read(&path)).map_err(|error| error::read(py, &error))?;
    let meshes = py.detach(|| scene.bake(scope)).map_err(|error| error::mesh(py, "path", &error))?;
    let list = PyList::empty(py);
    for mesh in meshes {
        let name = mesh.name.clone();
        let (positions, triangles, ..) = mesh.into_parts();
        let fields = (name, results::table(py, positions), results::table(py, triangles));
        list.append(results::named(py, "Mesh", fields)?)?;
    }
    Ok(list)
}
