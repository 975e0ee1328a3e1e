//! Arrays of numpy, and whatever numpy makes an array of, into positions and faces.
//!
//! `float32` in C order is read where it lies. Anything else is copied: other steps between the numbers,
//! another type, another order of bytes. What rounding to `float32` does to a coordinate is measured.

use std::fmt::Display;

use numpy::{Element, PyArray2, PyArrayDescr, PyArrayDescrMethods, PyReadonlyArray2, PyUntypedArray};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use umbrage::mesh::{MAX_TRIANGLES, Mesh};

use crate::error::{self, Problem};

/// Positions, and how far rounding moved a coordinate at most.
pub(crate) struct Coordinates<'py> {
    source: Source<'py>,
    /// In the units of the array; 0 where all of its numbers are `float32` numbers.
    pub(crate) rounding: f64,
}

enum Source<'py> {
    /// `float32` in C order: not copied.
    Array(PyReadonlyArray2<'py, f32>),
    Copy(Vec<[f32; 3]>),
}

impl Coordinates<'_> {
    pub(crate) fn as_slice(&self) -> &[[f32; 3]] {
        match &self.source {
            Source::Array(array) => array.as_slice().unwrap_or_default().as_chunks::<3>().0,
            Source::Copy(positions) => positions,
        }
    }

    fn into_vec(self, argument: &'static str) -> Result<Vec<[f32; 3]>, Problem> {
        let mut copy = match self.source {
            Source::Copy(positions) => return Ok(positions),
            Source::Array(_) => reserved(argument, self.as_slice().len())?,
        };
        copy.extend_from_slice(self.as_slice());
        Ok(copy)
    }
}

/// The mesh of an array of vertices and an array of faces, not welded, and how far rounding moved a
/// coordinate at most.
pub(crate) fn mesh(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<(Mesh, f64)> {
    let py = vertices.py();
    let vertices = coordinates("vertices", vertices)?;
    let rounding = vertices.rounding;
    let positions = vertices.into_vec("vertices").map_err(|problem| problem.raise(py))?;
    let triangles = triangles(faces, positions.len())?;
    let mesh = Mesh::new(positions, triangles).map_err(|error| error::mesh(py, "faces", &error))?;
    warn(py, "vertices", rounding, &mesh)?;
    Ok((mesh, rounding))
}

/// Rounding below this part of the diagonal is not worth a word: the command keeps quiet about it too.
const NEGLIGIBLE: f64 = 1.0 / (1 << 20) as f64;

/// Whether rounding is worth a word beside the extent of a mesh.
fn is_notable(rounding: f64, mesh: &Mesh) -> bool {
    let Some([low, high]) = mesh.bounds() else { return false };
    let diagonal = (0..3).map(|i| (f64::from(high[i]) - f64::from(low[i])).powi(2)).sum::<f64>().sqrt();
    rounding > NEGLIGIBLE * diagonal
}

/// Warns where rounding moved a coordinate by more than is negligible beside the mesh.
pub(crate) fn warn(py: Python<'_>, argument: &str, rounding: f64, mesh: &Mesh) -> PyResult<()> {
    if !is_notable(rounding, mesh) {
        return Ok(());
    }
    let warning = py.import("umbrage._errors")?.getattr("RoundingWarning")?.call1((argument, rounding))?;
    py.import("warnings")?.call_method1("warn", (warning,))?;
    Ok(())
}

/// Reads an array of shape (n, 3) of finite numbers.
pub(crate) fn coordinates<'py>(
    argument: &'static str,
    value: &Bound<'py, PyAny>,
) -> PyResult<Coordinates<'py>> {
    let py = value.py();
    let array = table(argument, value, "numbers", u32::MAX as usize)?;
    let read = if let Ok(array) = array.cast::<PyArray2<f32>>() {
        let array = array.try_readonly()?;
        if array.is_c_contiguous() {
            finite(argument, array.as_slice()?)
                .map(|()| Coordinates { source: Source::Array(array), rounding: 0.0 })
        } else {
            rounded(argument, &array)
        }
    } else if let Ok(array) = array.cast::<PyArray2<f64>>() {
        rounded(argument, &array.try_readonly()?)
    } else if let Ok(array) = array.cast::<PyArray2<i64>>() {
        rounded(argument, &array.try_readonly()?)
    } else if let Ok(array) = array.cast::<PyArray2<u64>>() {
        rounded(argument, &array.try_readonly()?)
    } else {
        Err(Problem::new(argument, "holds no numbers", "pass an array of float32 or float64"))
    };
    read.map_err(|problem| problem.raise(py))
}

/// A number that a coordinate is given as.
trait Coordinate: Element + Copy + Display {
    /// To the nearest `f32`.
    fn round(self) -> f32;
    /// How far that is, for a finite result.
    fn moved(self) -> f64;
}

impl Coordinate for f32 {
    fn round(self) -> f32 {
        self
    }
    fn moved(self) -> f64 {
        0.0
    }
}

impl Coordinate for f64 {
    fn round(self) -> f32 {
        self as f32
    }
    fn moved(self) -> f64 {
        (self - f64::from(self as f32)).abs()
    }
}

impl Coordinate for i64 {
    fn round(self) -> f32 {
        self as f32
    }
    fn moved(self) -> f64 {
        // In 128 bits, since rounding up may leave 64.
        (i128::from(self) - (self as f32) as i128).unsigned_abs() as f64
    }
}

impl Coordinate for u64 {
    fn round(self) -> f32 {
        self as f32
    }
    fn moved(self) -> f64 {
        (i128::from(self) - (self as f32) as i128).unsigned_abs() as f64
    }
}

/// A copy of an array of three columns, rounded.
fn rounded<'py, T: Coordinate>(
    argument: &'static str,
    array: &PyReadonlyArray2<'_, T>,
) -> Result<Coordinates<'py>, Problem> {
    let view = array.as_array();
    let mut positions = reserved(argument, view.nrows())?;
    let mut rounding = 0.0_f64;
    for (row, numbers) in view.rows().into_iter().enumerate() {
        let numbers = [numbers[0], numbers[1], numbers[2]];
        let position = numbers.map(T::round);
        if let Some(column) = position.iter().position(|x| !x.is_finite()) {
            return Err(not_finite(argument, numbers[column]).at(row, column));
        }
        rounding = numbers.into_iter().map(T::moved).fold(rounding, f64::max);
        positions.push(position);
    }
    Ok(Coordinates { source: Source::Copy(positions), rounding })
}

fn finite(argument: &'static str, numbers: &[f32]) -> Result<(), Problem> {
    match numbers.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(index) => Err(not_finite(argument, numbers[index]).at(index / 3, index % 3)),
    }
}

fn not_finite(argument: &'static str, number: impl Display) -> Problem {
    match number.to_string().as_str() {
        "NaN" => Problem::new(argument, "nan is not a number", "leave out that row, or repair it"),
        text if text.ends_with("inf") => {
            Problem::new(argument, format!("{text} is not finite"), "leave out that row, or repair it")
        }
        text => {
            Problem::new(argument, format!("{text} is beyond the range of float32"), "scale the coordinates")
        }
    }
}

/// Reads an array of shape (m, 3) of indices of vertices.
fn triangles(faces: &Bound<'_, PyAny>, vertex_count: usize) -> PyResult<Vec<[u32; 3]>> {
    let array = table("faces", faces, "integers", MAX_TRIANGLES)?;
    let read = if let Ok(array) = array.cast::<PyArray2<u32>>() {
        indices(&array.try_readonly()?, vertex_count)
    } else if let Ok(array) = array.cast::<PyArray2<i32>>() {
        indices(&array.try_readonly()?, vertex_count)
    } else if let Ok(array) = array.cast::<PyArray2<i64>>() {
        indices(&array.try_readonly()?, vertex_count)
    } else if let Ok(array) = array.cast::<PyArray2<u64>>() {
        indices(&array.try_readonly()?, vertex_count)
    } else {
        let dtype = array.dtype();
        let problem = format!("holds {dtype}, and indices are integers");
        Err(Problem::new("faces", problem, "pass faces.astype(\"uint32\")"))
    };
    read.map_err(|problem| problem.raise(faces.py()))
}

fn indices<T: Element + Copy + Display + TryInto<u32>>(
    array: &PyReadonlyArray2<'_, T>,
    vertex_count: usize,
) -> Result<Vec<[u32; 3]>, Problem> {
    let view = array.as_array();
    let mut triangles = reserved("faces", view.nrows())?;
    for (row, corners) in view.rows().into_iter().enumerate() {
        let mut triangle = [0; 3];
        for column in 0..3 {
            let index = corners[column];
            match index.try_into() {
                Ok(vertex) if (vertex as usize) < vertex_count => triangle[column] = vertex,
                _ => {
                    let problem = format!("names vertex {index}, but there are {vertex_count} vertices");
                    let remedy = "count vertices from 0, and pass all of them";
                    return Err(Problem::new("faces", problem, remedy).at(row, column));
                }
            }
        }
        triangles.push(triangle);
    }
    Ok(triangles)
}

/// An empty list with room for `count` items.
fn reserved<T>(argument: &'static str, count: usize) -> Result<Vec<T>, Problem> {
    let mut list = Vec::new();
    match list.try_reserve_exact(count) {
        Ok(()) => Ok(list),
        Err(_) => {
            let problem = format!("{count} rows do not fit the memory");
            Err(Problem::new(argument, problem, "pass fewer at a time"))
        }
    }
}

/// An array of three columns and at most `most` rows, whose numbers lie at multiples of their size, in the
/// processor's own order of bytes. Small integers become `int64`, `float16` becomes `float32`.
fn table<'py>(
    argument: &'static str,
    value: &Bound<'py, PyAny>,
    what: &str,
    most: usize,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = value.py();
    let numpy = py.import("numpy")?;
    let array = numpy.call_method1("asarray", (value,)).map_err(|cause| {
        let problem = format!("is no array: {}", cause.value(py));
        Problem::new(argument, problem, format!("pass an array of {what} of shape (n, 3)")).raise(py)
    })?;
    let array = array.cast_into::<PyUntypedArray>()?;
    if array.ndim() != 2 || array.shape()[1] != 3 {
        let shape = array.getattr("shape")?;
        let problem = format!("has the shape {shape}, not (n, 3)");
        let remedy = match argument {
            "faces" => "pass triangles, one a row",
            _ => "pass one point a row: x, y, z",
        };
        return Err(Problem::new(argument, problem, remedy).raise(py));
    }
    let rows = array.shape()[0];
    if rows > most {
        let problem = format!("has {rows} rows, and {most} are the most");
        return Err(Problem::new(argument, problem, "pass fewer at a time").raise(py));
    }
    let dtype = array.dtype();
    let to = match (dtype.kind(), dtype.itemsize()) {
        (b'f', 2 | 4) => "float32",
        (b'f', 8) => "float64",
        (b'i', 4) if argument == "faces" => "int32",
        (b'u', 4) if argument == "faces" => "uint32",
        (b'u', 8) => "uint64",
        (b'i' | b'u', _) => "int64",
        _ => {
            let remedy = format!("pass an array of {what}");
            return Err(Problem::new(argument, format!("holds {dtype}"), remedy).raise(py));
        }
    };
    let aligned: bool = array.getattr("flags")?.getattr("aligned")?.extract()?;
    let size = dtype.itemsize() as isize;
    let even = aligned && array.strides().iter().all(|stride| stride % size == 0);
    // As the array is where nothing has to change.
    if even && dtype.is_equiv_to(&PyArrayDescr::new(py, to)?) {
        return Ok(array);
    }
    let options = [("order", "C")].into_py_dict(py)?;
    Ok(array.call_method("astype", (to,), Some(&options))?.cast_into::<PyUntypedArray>()?)
}
