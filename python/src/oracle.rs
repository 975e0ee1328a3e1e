//! The exact ray cast: verdicts and visible fractions of points.

use numpy::PyArray1;
use pyo3::prelude::*;
use umbrage::mesh::Mesh;
use umbrage::oracle::Verdict;
use umbrage::oracle::area::{Receiver, SoftOracle};

use crate::error::Problem;
use crate::{arrays, options, results};

/// The exact ray cast over a mesh: what is in shadow, decided without an epsilon.
///
/// Building it takes some 0.5 µs a face. The arrays are copied. An oracle can be used from several threads.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3)
/// faces : array_like of integers, shape (m, 3)
///     As for `check_arrays`. Vertices need not be welded.
///
/// Attributes
/// ----------
/// face_count : int
/// rounding : float
///     How far rounding to ``float32`` moved a coordinate of the mesh at most; 0.0 where it moved none.
///
/// Examples
/// --------
/// >>> oracle = umbrage.Oracle(*umbrage.shapes.cube())
/// >>> verdicts = oracle.verdicts([[0.25, 0.5, -4], [3, 0, 0]], "point:0.1,0.2,5")
/// >>> [umbrage.Verdict(verdict).name for verdict in verdicts]
/// ['SHADOWED', 'LIT']
#[pyclass(frozen, module = "umbrage")]
pub(crate) struct Oracle {
    mesh: Mesh,
    soft: SoftOracle<'static>,
    #[pyo3(get)]
    rounding: f64,
}

#[pymethods]
impl Oracle {
    #[new]
    fn new(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (mesh, rounding) = arrays::mesh(vertices, faces)?;
        let soft = vertices.py().detach(|| SoftOracle::build(&mesh));
        Ok(Self { mesh, soft, rounding })
    }

    #[getter]
    fn face_count(&self) -> usize {
        self.mesh.face_count()
    }

    fn __repr__(&self) -> String {
        format!("<umbrage.Oracle of {} faces>", self.mesh.face_count())
    }

    /// Whether points see a light, exactly.
    ///
    /// Parameters
    /// ----------
    /// points : array_like, shape (k, 3)
    ///     ``float32`` in C order is read in place and must not be written to meanwhile; anything else is
    ///     copied and rounded.
    /// light : str or sequence of 4 floats
    ///     As for `silhouette`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k,), uint8
    ///     ``Verdict.LIT`` 0, ``Verdict.SHADOWED`` 1, ``Verdict.GRAZING`` 2: the segment touches the surface
    ///     without crossing a face, and both answers are right.
    #[pyo3(text_signature = "($self, points, light)")]
    fn verdicts<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'_, PyAny>,
        light: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<u8>>> {
        let light = options::hard_light(light)?;
        let points = arrays::coordinates("points", points)?;
        arrays::warn(py, "points", points.rounding, &self.mesh)?;
        let list = points.as_slice();
        let verdicts: Vec<u8> = py.detach(|| {
            let mut verdicts = vec![Verdict::Lit; list.len()];
            self.soft.oracle().verdicts_into(list, &light, &mut verdicts);
            let code = |verdict| match verdict {
                Verdict::Lit => 0,
                Verdict::Shadowed => 1,
                Verdict::Grazing => 2,
            };
            verdicts.into_iter().map(code).collect()
        });
        Ok(PyArray1::from_vec(py, verdicts))
    }

    /// How much of a light with an extent points see, analytically, with a bound of the error.
    ///
    /// Parameters
    /// ----------
    /// points : array_like, shape (k, 3)
    ///     As for `verdicts`.
    /// light : str
    ///     "point:X,Y,Z,radius=R", a disk that faces the point; "directional:X,Y,Z,angle=DEGREES", half the
    ///     angle of a sun; "rect:X,Y,Z:X,Y,Z:X,Y,Z", a corner and two edges.
    /// normals : array_like, shape (k, 3), optional
    ///     Of the surface at the points, of any length; they ask for ``form``.
    ///
    /// Returns
    /// -------
    /// Visible
    ///     ``fraction`` (k,) float64, 0 to 1; ``bound`` (k,) float64, which the truth differs by at most;
    ///     ``form`` (k,) float64, the irradiance over π times the radiance of the light, or None without
    ///     normals. NaN where nothing can be told: in the plane of the light.
    #[pyo3(signature = (points, light, *, normals=None))]
    fn visible_fraction<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'_, PyAny>,
        light: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let light = options::area_light(light)?;
        let points = arrays::coordinates("points", points)?;
        arrays::warn(py, "points", points.rounding, &self.mesh)?;
        let normals = normals.map(|normals| arrays::coordinates("normals", normals)).transpose()?;
        let list = points.as_slice();
        let normals = normals.as_ref().map(|normals| normals.as_slice());
        if let Some(normals) = normals.filter(|normals| normals.len() != list.len()) {
            let problem = format!("has {} rows, but there are {} points", normals.len(), list.len());
            return Err(Problem::new("normals", problem, "pass one normal a point").raise(py));
        }
        let (fraction, bound, form) = py.detach(|| {
            let receivers: Vec<Receiver> = match normals {
                Some(normals) => list
                    .iter()
                    .zip(normals)
                    .map(|(&point, &normal)| Receiver::facing(point, normal))
                    .collect(),
                None => list.iter().map(|&point| point.into()).collect(),
            };
            let mut seen = vec![None; receivers.len()];
            self.soft.visible_into(&receivers, &light, &mut seen);
            let of = |value: fn(&umbrage::oracle::area::Visible) -> f64| -> Vec<f64> {
                seen.iter().map(|seen| seen.as_ref().map_or(f64::NAN, value)).collect()
            };
            let form = normals.map(|_| of(|seen| seen.form.unwrap_or(f64::NAN)));
            (of(|seen| seen.fraction), of(|seen| seen.bound), form)
        });
        let form = form.map(|form| PyArray1::from_vec(py, form));
        results::named(py, "Visible", (PyArray1::from_vec(py, fraction), PyArray1::from_vec(py, bound), form))
    }
}

/// How much of a light with an extent points see: `Oracle.visible_fraction` of an oracle made for it.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3)
/// faces : array_like of integers, shape (m, 3)
///     As for `check_arrays`.
/// points, light, normals
///     As for `Oracle.visible_fraction`.
///
/// Returns
/// -------
/// Visible
///
/// Examples
/// --------
/// >>> vertices, faces = umbrage.shapes.cube()
/// >>> seen = umbrage.visible_fraction(vertices, faces, [[1, 0, -5]], "point:1,0,5,radius=0.5")
/// >>> bool(abs(seen.fraction[0] - 0.5) <= seen.bound[0] < 1e-9)  # the side of the cube halves it
/// True
#[pyfunction]
#[pyo3(signature = (vertices, faces, points, light, *, normals=None))]
pub(crate) fn visible_fraction<'py>(
    py: Python<'py>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    points: &Bound<'_, PyAny>,
    light: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    Oracle::new(vertices, faces)?.visible_fraction(py, points, light, normals)
}
