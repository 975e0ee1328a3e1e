//! Arrays into a caster that knows which of the caller's vertices each of its own is.

use numpy::PyArray1;
use pyo3::prelude::*;
use umbrage::caster::Caster;
use umbrage::facing::CasterFaces;
use umbrage::geom::Light;
use umbrage::mesh::{Mesh, VertexId, Weld, weld_in_place};
use umbrage::shadow::volume::Caps;

use crate::{arrays, options, results};

/// A caster, and the first of the caller's vertices that each of its vertices is.
struct Welded {
    caster: Caster,
    original: Vec<u32>,
}

impl Welded {
    fn of(mesh: Mesh, how: Weld) -> Self {
        let vertices = mesh.vertex_count() as u32;
        let welded = weld_in_place(mesh, how);
        let mut original = vec![u32::MAX; welded.mesh.vertex_count()];
        for vertex in (0..vertices).rev() {
            if let Some(kept) = welded.vertex_of(VertexId(vertex)) {
                original[kept.index()] = vertex;
            }
        }
        Self { caster: Caster::new(welded.mesh), original }
    }

    fn original(&self, vertex: VertexId) -> u32 {
        self.original[vertex.index()]
    }
}

/// The silhouette of a mesh for a light: the edges at which the side that faces show to it changes, exactly.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3)
/// faces : array_like of integers, shape (m, 3)
///     As for `check_arrays`.
/// light : str or sequence of 4 floats
///     "point:X,Y,Z"; "directional:X,Y,Z", the direction in which it travels; or homogeneous coordinates:
///     (x, y, z, 1) a point, (x, y, z, 0) the direction towards the light. Rounded to ``float32``.
/// casting : "all" (default) or "front"
///     Which faces cast: with "front" the textbook outline, one face in front and the other not.
/// weld : "exact" (default), "none" or float
///     Which vertices are the same, as for `check`.
///
/// Returns
/// -------
/// Silhouette
///     ``edges`` (k, 2) uint32, vertices of yours (the first of those that are welded); ``multiplicity`` (k,)
///     int32, never 0; ``loop`` (k,) uint32, the connected component; ``rounding`` as in `check_arrays`.
///
/// Examples
/// --------
/// >>> vertices, faces = umbrage.shapes.cube()
/// >>> outline = umbrage.silhouette(vertices, faces, "directional:-1,-1,-1", casting="front")
/// >>> len(outline.edges), set(outline.loop.tolist())
/// (6, {0})
#[pyfunction]
#[pyo3(
    signature = (vertices, faces, light, *, casting="all", weld=None),
    text_signature = "(vertices, faces, light, *, casting='all', weld='exact')"
)]
pub(crate) fn silhouette<'py>(
    py: Python<'py>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    light: &Bound<'_, PyAny>,
    casting: &str,
    weld: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let light = options::hard_light(light)?;
    let all = [("all", CasterFaces::All), ("front", CasterFaces::Front)];
    let casting = options::one_of(py, "casting", casting, &all)?;
    let weld = options::weld(weld)?;
    let (mesh, rounding) = arrays::mesh(vertices, faces)?;
    let (edges, multiplicity, loops) = py.detach(|| {
        let welded = Welded::of(mesh, weld);
        let topology = welded.caster.topology();
        let silhouette = welded.caster.silhouette(&light, casting);
        let mut loop_of = vec![0_u32; silhouette.edges.len()];
        for (number, edges) in (0..).zip(silhouette.loops(topology)) {
            for edge in edges {
                let at = silhouette.edges.binary_search_by_key(&edge, |found| found.edge);
                loop_of[at.expect("a loop consists of silhouette edges")] = number;
            }
        }
        let ends = |edge| topology.vertices(edge).map(|vertex| welded.original(vertex));
        let edges: Vec<[u32; 2]> = silhouette.edges.iter().map(|found| ends(found.edge)).collect();
        let multiplicity: Vec<i32> = silhouette.edges.iter().map(|found| found.multiplicity).collect();
        (edges, multiplicity, loop_of)
    });
    let fields = (
        results::table(py, edges),
        PyArray1::from_vec(py, multiplicity),
        PyArray1::from_vec(py, loops),
        rounding,
    );
    results::named(py, "Silhouette", fields)
}

/// The shadow volume of a mesh for a light: closed for every mesh, with vertices at infinity.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3)
/// faces : array_like of integers, shape (m, 3)
///     As for `check_arrays`.
/// light, weld
///     As for `silhouette`.
/// casting : "auto" (default), "all" or "front"
///     Which faces cast; "auto" takes half of a shell's faces where that is proven to be enough.
/// caps : "both" (default) or "none"
///     "both" closes the volume, as depth-fail counting needs; "none" leaves sides only.
///
/// Returns
/// -------
/// Volume
///     ``vertices`` (k, 4) float32, homogeneous: w is 1, or 0 at infinity; ``triangles`` (t, 3) uint32,
///     counter-clockwise seen from outside: ``light_cap`` of them, then ``sides``, then ``dark_cap``;
///     ``original`` (j,) uint32, the vertex of yours behind each of the j vertices with w = 1, which come
///     first; ``closed``, the certificate: whether the boundary of the triangles cancels; ``choices``, one
///     dictionary a shell: ``what`` casts and ``why``; ``rounding`` as in `check_arrays`.
///
/// Examples
/// --------
/// >>> vertices, faces = umbrage.shapes.cube()
/// >>> volume = umbrage.volume(vertices, faces, "point:2,5,3")
/// >>> volume.closed, volume.vertices.shape[1], volume.triangles.dtype
/// (True, 4, dtype('uint32'))
/// >>> volume.light_cap + volume.sides + volume.dark_cap == len(volume.triangles)
/// True
#[pyfunction]
#[pyo3(
    signature = (vertices, faces, light, *, casting="auto", caps="both", weld=None),
    text_signature = "(vertices, faces, light, *, casting='auto', caps='both', weld='exact')"
)]
pub(crate) fn volume<'py>(
    py: Python<'py>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    light: &Bound<'_, PyAny>,
    casting: &str,
    caps: &str,
    weld: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let light = options::hard_light(light)?;
    let all = [("auto", None), ("all", Some(CasterFaces::All)), ("front", Some(CasterFaces::Front))];
    let casting = options::one_of(py, "casting", casting, &all)?;
    let caps = options::one_of(py, "caps", caps, &[("both", Caps::Both), ("none", Caps::None)])?;
    let weld = options::weld(weld)?;
    let (mesh, rounding) = arrays::mesh(vertices, faces)?;
    let Cast { vertices, triangles, ranges, original, closed, choices } =
        py.detach(|| cast(&Welded::of(mesh, weld), &light, casting, caps));
    let [light_cap, sides, dark_cap] = ranges;
    let fields = (
        results::table(py, vertices),
        results::table(py, triangles),
        light_cap,
        sides,
        dark_cap,
        PyArray1::from_vec(py, original),
        closed,
        pythonize::pythonize(py, &choices)?,
        rounding,
    );
    results::named(py, "Volume", fields)
}

/// A volume, taken apart.
struct Cast {
    vertices: Vec<[f32; 4]>,
    triangles: Vec<[u32; 3]>,
    ranges: [usize; 3],
    original: Vec<u32>,
    closed: bool,
    choices: serde_json::Value,
}

fn cast(welded: &Welded, light: &Light, casting: Option<CasterFaces>, caps: Caps) -> Cast {
    let faces = welded.caster.shell_faces(light, casting);
    let volume = welded.caster.volume_of(light, &faces, caps);
    Cast {
        vertices: volume.to_f32(),
        triangles: volume.triangles().to_vec(),
        ranges: [volume.light_cap(), volume.sides(), volume.dark_cap()].map(|range| range.len()),
        original: volume.casters().iter().map(|&vertex| welded.original(vertex)).collect(),
        closed: volume.boundary_sum().is_closed(),
        choices: serde_json::to_value(&faces.choices).expect("choices are texts"),
    }
}
