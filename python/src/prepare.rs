//! Repair: arrays into arrays that cast better, each change listed.

use pyo3::prelude::*;
use pyo3::types::PyBool;
use umbrage::repair::{Fill, Options};

use crate::error::{self, Problem};
use crate::{arrays, options, results};

/// A mesh that casts better: welded, cleaned, and on demand oriented, stitched, split and closed.
///
/// Equal vertices become one; collapsed faces, duplicates and unused vertices go. No vertex moves, but by
/// ``weld`` or ``weld_within`` with a distance.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3)
/// faces : array_like of integers, shape (m, 3)
///     As for `check_arrays`.
/// weld : "exact" (default), "none" or float
///     Which vertices are the same to begin with, as for `check`.
/// orient : bool
///     Wind faces alike, and outwards.
/// weld_within : float, optional
///     Then make vertices one that are at most this far apart.
/// stitch : bool
///     Cut faces where vertices lie on their edges.
/// split : bool
///     Take apart edges of more than two faces, and vertices of more than one fan.
/// fill : bool or int
///     Close holes; a number: those of at most that many edges.
/// fill_anyway : bool
///     Close holes also where the patch meets other faces.
///
/// Returns
/// -------
/// Prepared
///     ``vertices`` (k, 3) float32; ``faces`` (j, 3) uint32; ``steps``, one dictionary a step with the keys
///     of ``umbrage prepare --json``: ``name``, ``count``, ``left``, ``changes`` (at most 1000),
///     ``largest_move``; ``rounding`` as in `check_arrays`.
///
/// Examples
/// --------
/// >>> vertices, faces = umbrage.shapes.cube()
/// >>> prepared = umbrage.prepare(vertices, faces[2:], fill=True)  # without one side
/// >>> umbrage.check_arrays(prepared.vertices, prepared.faces)["verdict"], len(prepared.faces)
/// ('sound', 12)
/// >>> [(step["name"], step["count"]) for step in prepared.steps if step["count"]]
/// [('fill', 1)]
#[pyfunction]
#[pyo3(
    signature = (vertices, faces, *, weld=None, orient=false, weld_within=None, stitch=false, split=false,
        fill=None, fill_anyway=false),
    text_signature = "(vertices, faces, *, weld='exact', orient=False, weld_within=None, stitch=False, \
        split=False, fill=False, fill_anyway=False)"
)]
#[expect(clippy::too_many_arguments, reason = "they are options with names")]
pub(crate) fn prepare<'py>(
    py: Python<'py>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    weld: Option<&Bound<'_, PyAny>>,
    orient: bool,
    weld_within: Option<f64>,
    stitch: bool,
    split: bool,
    fill: Option<&Bound<'_, PyAny>>,
    fill_anyway: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let mut steps = Options::default();
    steps.weld = options::weld(weld)?;
    (steps.orient, steps.stitch, steps.split) = (orient, stitch, split);
    steps.weld_within =
        weld_within.map(|distance| options::distance_of(py, "weld_within", distance)).transpose()?;
    steps.fill = fill.map(holes).transpose()?.flatten();
    if fill_anyway {
        steps.fill.get_or_insert_default().anyway = true;
    }
    let (mesh, rounding) = arrays::mesh(vertices, faces)?;
    let prepared = py.detach(|| umbrage::repair::prepare(mesh, &steps));
    let prepared = prepared.map_err(|error| error::mesh(py, "faces", &error))?;
    let steps = pythonize::pythonize(py, &prepared.steps)?;
    let (positions, triangles, ..) = prepared.mesh.into_parts();
    let fields = (results::table(py, positions), results::table(py, triangles), steps, rounding);
    results::named(py, "Prepared", fields)
}

/// Which holes are closed: all, none, or those of at most `value` edges.
fn holes(value: &Bound<'_, PyAny>) -> PyResult<Option<Fill>> {
    if let Ok(all) = value.cast::<PyBool>() {
        return Ok(all.is_true().then(Fill::default));
    }
    match value.extract::<usize>() {
        Ok(edges) if edges >= 3 => Ok(Some(Fill::up_to(edges))),
        _ => {
            let problem = format!("{} is no number of edges", value.repr()?);
            let remedy = "pass True, False, or the most edges of a hole, 3 or more";
            Err(Problem::new("fill", problem, remedy).raise(value.py()))
        }
    }
}
