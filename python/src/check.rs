//! The crack report, with the keys of the command's JSON.

use std::path::PathBuf;

use pyo3::prelude::*;
use serde::Serialize;
use serde_json::{Map, Value, json};
use umbrage::check::{Counts, CrackReport, Defect, DefectKind, Requirement, ShellReport, Standing, Verdict};
use umbrage::geom::Aabb;
use umbrage::glam::Mat4;
use umbrage::mesh::{FaceId, Mesh, MeshError, Origin, Weld, weld_in_place};
use umbrage::read::ReadError;
use umbrage::scene::{OwnSpace, Scope};
use umbrage::topology::Topology;

use crate::{arrays, error, options};

/// Bounds on lists, as the command has them.
const SHELLS_LISTED: usize = 1000;
const FACES_LISTED: usize = 64;

/// What is asked of each mesh.
struct Asked {
    weld: Weld,
    requirements: Vec<Requirement>,
    limit: usize,
}

impl Asked {
    fn self_intersections(&self) -> bool {
        self.requirements.contains(&Requirement::NoSelfIntersections)
    }
}

/// The crack report of a file: is each mesh closed, and if not, where and with what effect on a shadow.
///
/// Parameters
/// ----------
/// path : str or os.PathLike
///     obj, gltf, glb, stl, ply, off, md2 or 3mf; also in gzip or ZIP; recognized by its content.
/// weld : "exact" (default), "none" or float
///     Which vertices are the same: those of equal positions, those of equal indices, or those within a
///     distance in mesh units.
/// scope : "mesh" (default), "primitive" or "scene"
///     What counts as one mesh.
/// require : sequence of str, by default ["sound"]
///     "sound", "watertight", "balanced", "even", "manifold", "no-self-intersections"; "not-empty" always.
/// self_intersections : bool
///     Also look for faces that intersect, about a microsecond per face, and require that there are none.
/// limit : int
///     How many defects of each kind are listed.
///
/// Returns
/// -------
/// dict
///     The keys of ``umbrage check --json`` for one file: ``file``, ``format``, ``error`` (None), ``meshes``,
///     ``total``, ``requirements``, ``sound``, ``verdict`` ("sound", "cracked", "empty", "not proven sound"),
///     ``rounding``; beside them ``notes``, what the reader has to say. What was not computed is None.
///
/// Raises
/// ------
/// ReadError
///     If the file cannot be read. A defect of a readable mesh is data, not an error.
/// ArgumentError
///     If an option is unknown.
///
/// Examples
/// --------
/// >>> import pathlib, tempfile
/// >>> with tempfile.TemporaryDirectory() as folder:
/// ...     path = pathlib.Path(folder, "triangle.off")
/// ...     _ = path.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
/// ...     report = umbrage.check(path)
/// >>> report["verdict"], report["meshes"][0]["boundary_edges"]
/// ('cracked', 3)
#[pyfunction]
#[pyo3(
    signature = (path, *, weld=None, scope="mesh", require=None, self_intersections=false, limit=None),
    text_signature = "(path, *, weld='exact', scope='mesh', require=None, self_intersections=False, limit=5)"
)]
pub(crate) fn check<'py>(
    py: Python<'py>,
    path: PathBuf,
    weld: Option<&Bound<'_, PyAny>>,
    scope: &str,
    require: Option<Vec<String>>,
    self_intersections: bool,
    limit: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let scope = options::scope(py, scope)?;
    let requirements = options::requirements(py, require, self_intersections)?;
    let asked = Asked { weld: options::weld(weld)?, requirements, limit: options::limit(limit)? };
    let document = py.detach(|| file(&path, scope, &asked)).map_err(|failure| match failure {
        Failure::Read(error) => error::read(py, &error),
        Failure::Mesh(error) => error::mesh(py, "path", &error),
    })?;
    Ok(pythonize::pythonize(py, &document)?)
}

/// The crack report of arrays: is the mesh closed, and if not, where and with what effect on a shadow.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3)
///     Positions; ``float32`` as they are, anything else rounded to it.
/// faces : array_like of integers, shape (m, 3)
///     Three vertices a face, counter-clockwise seen from the front, counted from 0.
/// weld, require, self_intersections, limit
///     As for `check`.
///
/// Returns
/// -------
/// dict
///     The keys of a mesh of ``umbrage check --json``: counts, ``shell_list``, ``defects``; beside them
///     ``verdict``, ``requirements``, and ``rounding``, how far rounding to ``float32`` moved a coordinate at
///     most (0.0 where it moved none).
///
/// Raises
/// ------
/// ArgumentError
///     If an array has another shape, a coordinate is not finite, or an index is out of range; it names the
///     argument and the place.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
/// >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
/// >>> umbrage.check_arrays(vertices, faces)["verdict"]
/// 'sound'
/// >>> report = umbrage.check_arrays(vertices, faces[1:])
/// >>> report["verdict"], [(d["kind"], d["count"]) for d in report["defects"]]
/// ('cracked', [('boundary_loop', 1)])
#[pyfunction]
#[pyo3(
    signature = (vertices, faces, *, weld=None, require=None, self_intersections=false, limit=None),
    text_signature = "(vertices, faces, *, weld='exact', require=None, self_intersections=False, limit=5)"
)]
pub(crate) fn check_arrays<'py>(
    py: Python<'py>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    weld: Option<&Bound<'_, PyAny>>,
    require: Option<Vec<String>>,
    self_intersections: bool,
    limit: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let requirements = options::requirements(py, require, self_intersections)?;
    let asked = Asked { weld: options::weld(weld)?, requirements, limit: options::limit(limit)? };
    let (mesh, rounding) = arrays::mesh(vertices, faces)?;
    let document = py.detach(|| {
        let of = OwnSpace { mesh, world_from_mesh: Mat4::IDENTITY };
        let report = MeshReport::of(of, &asked).expect("nothing is placed");
        let mut document = report.document();
        let counts = [report.counts];
        document.insert("requirements".into(), requirements_of(&asked.requirements, &counts));
        document.insert("rounding".into(), rounding.into());
        document
    });
    Ok(pythonize::pythonize(py, &document)?)
}

enum Failure {
    Read(ReadError),
    Mesh(MeshError),
}

/// The report of a file.
fn file(path: &PathBuf, scope: Scope, asked: &Asked) -> Result<Value, Failure> {
    let scene = umbrage::read::read(path).map_err(Failure::Read)?;
    let (format, notes) = (scene.format.map(|format| format.name()), scene.notes.clone());
    let rounding = scene.judged_rounding(scope == Scope::Scene);
    let spaces = scene.in_own_space(scope).map_err(Failure::Mesh)?;
    let meshes: Vec<MeshReport> = spaces
        .into_iter()
        .map(|space| MeshReport::of(space, asked))
        .collect::<Result<_, _>>()
        .map_err(Failure::Mesh)?;
    let counts: Vec<Counts> = meshes.iter().map(|mesh| mesh.counts).collect();
    let worst = counts.iter().map(|counts| verdict(&asked.requirements, counts)).max();
    let total = total(&meshes, asked.limit);
    let sound = if total.is_null() { Value::Bool(false) } else { total["sound"].clone() };
    Ok(json!({
        "file": path.to_string_lossy(),
        "format": format,
        "error": null,
        "meshes": meshes.iter().map(MeshReport::document).collect::<Vec<_>>(),
        "total": total,
        "requirements": requirements_of(&asked.requirements, &counts),
        "rounding": rounding,
        "sound": sound,
        "verdict": worst.unwrap_or(Verdict::Empty).name(),
        "notes": notes,
    }))
}

/// The report of one mesh.
struct MeshReport {
    name: String,
    /// Vertices before the weld, after it, and those that no face uses.
    vertices: [usize; 3],
    counts: Counts,
    shell_list: Vec<ShellReport>,
    shell_origins: Vec<Origin>,
    defects: Vec<Found>,
    nesting_complete: bool,
    t_junctions_complete: bool,
    verdict: Verdict,
}

/// All defects of one kind.
struct Found {
    kind: DefectKind,
    count: usize,
    /// Whether these are all; a search that stopped at a limit found at least this number.
    complete: bool,
    at: Vec<Value>,
}

impl MeshReport {
    /// Judged in its own space, told in the world.
    fn of(OwnSpace { mesh, world_from_mesh }: OwnSpace, asked: &Asked) -> Result<Self, MeshError> {
        let vertices = mesh.vertex_count();
        let welded = weld_in_place(mesh, asked.weld);
        let vertices = [vertices, welded.mesh.vertex_count(), welded.unreferenced()];
        let mesh = welded.mesh;
        let topology = Topology::of(&mesh);
        let mut report = CrackReport::of(&mesh, &topology);
        if asked.self_intersections() {
            report.add_self_intersections(&mesh, &topology, asked.limit);
        }
        let placed = (world_from_mesh != Mat4::IDENTITY).then(|| OwnSpace::placed(&mesh, &world_from_mesh));
        let placed = placed.transpose()?;
        if let Some(placed) = &placed {
            tell_in_world(&mut report, placed, &topology, OwnSpace::volume_factor(&world_from_mesh));
        }
        let mesh = placed.as_ref().unwrap_or(&mesh);
        let found = |kind| Found::of(kind, &report, mesh, &topology, asked.limit);
        let defects = DefectKind::ALL.into_iter().filter_map(found).collect();
        let CrackReport { counts, mut shell_list, nesting_complete, t_junctions_complete, .. } = report;
        shell_list.truncate(SHELLS_LISTED);
        Ok(Self {
            name: mesh.name.clone(),
            vertices,
            counts,
            shell_origins: shell_list.iter().map(|shell| mesh.origin(shell.first_face)).collect(),
            shell_list,
            defects,
            nesting_complete,
            t_junctions_complete,
            verdict: verdict(&asked.requirements, &counts),
        })
    }

    fn document(&self) -> Map<String, Value> {
        let mut object = numbers(Some(&self.name), self.vertices, &self.counts);
        object.insert("shell_list".into(), value(&self.shell_list));
        object.insert("shell_origins".into(), self.shell_origins.iter().map(polygon).collect());
        object.insert("defects".into(), self.defects.iter().map(Found::document).collect());
        object.insert("nesting_complete".into(), self.nesting_complete.into());
        object.insert("t_junctions_complete".into(), self.t_junctions_complete.into());
        object.insert("sound".into(), sound(&self.counts));
        object.insert("verdict".into(), self.verdict.name().into());
        object
    }
}

/// Volumes and boxes in the world of a report on a mesh in its own space; `mesh` is the placed one.
fn tell_in_world(report: &mut CrackReport, mesh: &Mesh, topology: &Topology, factor: f64) {
    report.counts.signed_volume *= factor;
    for shell in &mut report.shell_list {
        shell.signed_volume *= factor;
        shell.bounds = Aabb::EMPTY;
    }
    for (face, shell) in topology.faces().zip(topology.shells().of_face) {
        if let Some(shell) = shell {
            let bounds = &mut report.shell_list[shell as usize].bounds;
            *bounds = bounds.join(&Aabb::around(mesh.corners(face)));
        }
    }
}

impl Found {
    fn of(
        kind: DefectKind,
        report: &CrackReport,
        mesh: &Mesh,
        topology: &Topology,
        limit: usize,
    ) -> Option<Self> {
        let count = report.count(kind).filter(|&count| count > 0)?;
        let items = report.items(kind, mesh, topology, limit);
        let at = items.into_iter().map(|item| place(item, mesh)).collect();
        Some(Self { kind, count, complete: report.counts.is_complete(kind), at })
    }

    fn document(&self) -> Value {
        defects(self.kind, self.count, self.complete, &self.at)
    }
}

fn defects(kind: DefectKind, count: usize, complete: bool, at: &[Value]) -> Value {
    json!({
        "kind": kind,
        "count": complete.then_some(count),
        "at_least": (!complete).then_some(count),
        "effect": kind.effect(),
        "at": at,
        "code": kind.code(),
        "severity": kind.severity().name(),
    })
}

/// The sum over all meshes; each defect names its mesh. Null if there is no mesh.
fn total(meshes: &[MeshReport], limit: usize) -> Value {
    let Some(sum) = Counts::total(meshes.iter().map(|mesh| mesh.counts)) else { return Value::Null };
    let vertices = [0, 1, 2].map(|i| meshes.iter().map(|mesh| mesh.vertices[i]).sum());
    let mut object = numbers(None, vertices, &sum);
    object.insert("shell_list".into(), Value::Null);
    object.insert("shell_origins".into(), Value::Null);
    let of_kind = |kind| {
        let with = meshes.iter().flat_map(|mesh| mesh.defects.iter().map(move |found| (mesh, found)));
        let with: Vec<(&MeshReport, &Found)> = with.filter(|(_, found)| found.kind == kind).collect();
        let at = with.iter().flat_map(|(mesh, found)| found.at.iter().map(|at| (&mesh.name, at)));
        let at: Vec<Value> = at
            .take(limit)
            .map(|(mesh, at)| {
                let mut at = at.clone();
                at["mesh"] = mesh.as_str().into();
                at
            })
            .collect();
        let count = with.iter().map(|(_, found)| found.count).sum();
        let complete = with.iter().all(|(_, found)| found.complete);
        (!with.is_empty()).then(|| defects(kind, count, complete, &at))
    };
    object.insert("defects".into(), DefectKind::ALL.into_iter().filter_map(of_kind).collect());
    let t_junctions_complete = meshes.iter().all(|mesh| mesh.t_junctions_complete);
    if !t_junctions_complete {
        object["t_junctions"] = Value::Null;
    }
    object.insert("nesting_complete".into(), meshes.iter().all(|mesh| mesh.nesting_complete).into());
    object.insert("t_junctions_complete".into(), t_junctions_complete.into());
    object.insert("sound".into(), sound(&sum));
    let worst = meshes.iter().map(|mesh| mesh.verdict).max();
    object.insert("verdict".into(), worst.map(Verdict::name).into());
    object.into()
}

/// Whether a mesh that is not empty is sound, whatever is required; null if that was not decided.
fn sound(counts: &Counts) -> Value {
    let decided = counts.sound() || !counts.may_be_sound();
    decided.then_some(counts.sound() && !counts.is_empty()).into()
}

/// What comes before the numbers, and the numbers; vertices that no face uses are among them.
fn numbers(
    name: Option<&str>,
    [vertices, welded, unreferenced]: [usize; 3],
    counts: &Counts,
) -> Map<String, Value> {
    let mut object = Map::from_iter([
        ("name".to_owned(), name.into()),
        ("vertices".to_owned(), vertices.into()),
        ("welded_vertices".to_owned(), welded.into()),
    ]);
    if let Value::Object(counts) = value(counts) {
        for (key, value) in counts {
            let is_last_of_faces = key == "duplicate_faces";
            object.insert(key, value);
            if is_last_of_faces {
                object.insert("unreferenced_vertices".into(), unreferenced.into());
            }
        }
    }
    object
}

/// One defect.
fn place(defect: Defect, mesh: &Mesh) -> Value {
    let faces: Vec<FaceId> = defect.faces.into_iter().take(FACES_LISTED).collect();
    let part = |face: FaceId| mesh.part_name(face).unwrap_or_default();
    let mut names: Vec<&str> = Vec::new();
    for name in faces.iter().map(|&face| part(face)).filter(|name| !name.is_empty()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let origin = |&face: &FaceId| {
        let origin = mesh.origin(face);
        json!({ "face": face, "polygon": origin.polygon, "line": origin.line, "part": part(face) })
    };
    json!({
        "position": defect.position.map(short),
        "name": if names.is_empty() { mesh.name.clone() } else { names.join(", ") },
        "faces": faces,
        "origins": faces.iter().map(origin).collect::<Vec<_>>(),
    })
}

/// The polygon of the first face of a shell.
fn polygon(origin: &Origin) -> Value {
    json!({ "polygon": origin.polygon, "line": origin.line })
}

/// The verdict on a mesh of which properties are required.
fn verdict(requirements: &[Requirement], counts: &Counts) -> Verdict {
    let worst = requirements.iter().map(|requirement| requirement.standing(counts)).max();
    match worst.unwrap_or(Standing::Holds) {
        Standing::Holds => Verdict::Sound,
        Standing::Undecided => Verdict::NotProven,
        Standing::Fails if counts.is_empty() => Verdict::Empty,
        Standing::Fails => Verdict::Cracked,
    }
}

/// What was required, and whether every mesh has it; null if that was not decided.
fn requirements_of(requirements: &[Requirement], meshes: &[Counts]) -> Value {
    let of = |&asked: &Requirement| {
        let none = if asked == Requirement::NotEmpty { Standing::Fails } else { Standing::Holds };
        let holds = match meshes.iter().map(|counts| asked.standing(counts)).max().unwrap_or(none) {
            Standing::Holds => Some(true),
            Standing::Undecided => None,
            Standing::Fails => Some(false),
        };
        json!({ "name": asked.name(), "holds": holds })
    };
    requirements.iter().map(of).collect()
}

fn value(report: &impl Serialize) -> Value {
    serde_json::to_value(report).expect("reports are numbers, texts, lists, and objects with texts as keys")
}

/// The shortest decimal that reads back as the `f32`.
fn short(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::NAN)
}
