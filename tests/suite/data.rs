//! The small meshes in `data/`: the committed bytes equal the generators' output, and the counts equal those
//! of the hand-written table.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::sync::Once;

use umbrage::check::CrackReport;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::read::{read, read_bytes};
use umbrage::scene::{Scene, Scope};
use umbrage::testing::shapes::*;
use umbrage::topology::Topology;
use umbrage::write::{Layer, Model, Target, to_bytes, write_atomic};

/// A file, the mesh in it, and closed forms from the generator's documentation: the vertices as read; edges,
/// faces and Euler characteristic after an exact weld.
struct Entry {
    file: &'static str,
    mesh: Mesh,
    closed_form: [i64; 4],
}

fn entries() -> Vec<Entry> {
    let entry = |file, mesh, closed_form| Entry { file, mesh, closed_form };
    let [m, n] = [12, 8]; // segments of the torus
    let [k, r] = [36, 6]; // segments of the knot
    let [s, q] = [8, 2]; // segments and rings of the capsule
    vec![
        entry("closed/cube.obj", cube(), [8, 18, 12, 2]),
        entry("closed/tetrahedron.obj", tetrahedron(), [4, 6, 4, 2]),
        entry("closed/octahedron.obj", octahedron(), [6, 12, 8, 2]),
        entry("closed/icosphere_2.obj", icosphere(2), [10 * 16 + 2, 30 * 16, 20 * 16, 2]),
        entry("closed/torus_12_8.obj", torus(12, 8, 2.0, 0.75), [m * n, 3 * m * n, 2 * m * n, 0]),
        entry("closed/torus_knot_2_3.obj", torus_knot(2, 3, 36, 6, 0.375), [k * r, 3 * k * r, 2 * k * r, 0]),
        entry(
            "closed/menger_sponge_1.obj",
            menger_sponge(1),
            [64, 6 * 20 + 12 * 8, 4 * 20 + 8 * 8, 2 - 2 * 5],
        ),
        entry("closed/figure_eight_prism.obj", figure_eight_prism(), [8, 18, 12, 2]),
        entry("format/cube.glb", cube(), [8, 18, 12, 2]),
        entry("format/cube.ply", cube(), [8, 18, 12, 2]),
        entry("format/cube.stl", cube(), [3 * 12, 18, 12, 2]),
        entry("open/open_cube.obj", open_cube(), [8, 18 - 1, 12 - 2, 1]),
        entry("open/sheet_4.obj", sheet(4), [5 * 5, 3 * 16 + 2 * 4, 2 * 16, 1]),
        entry("open/t_junction.obj", t_junction(), [9, 21, 13, 1]),
        entry("non_manifold/book_3.obj", book(3), [3 + 2, 2 * 3 + 1, 3, 1]),
        entry("non_manifold/book_5.obj", book(5), [5 + 2, 2 * 5 + 1, 5, 1]),
        entry("non_manifold/cubes_sharing_edge.obj", cubes_sharing_edge(), [16 - 2, 36 - 1, 24, 4 - 1]),
        entry("non_manifold/cubes_sharing_vertex.obj", cubes_sharing_vertex(), [16 - 1, 36, 24, 4 - 1]),
        entry("non_manifold/double_sheet.obj", double_sheet(), [4, 5, 4, 3]),
        entry("non_manifold/duplicated_face.obj", duplicated_face(), [8, 18, 12 + 1, 2 + 1]),
        entry("winding/inside_out_cube.obj", inside_out(&cube()), [8, 18, 12, 2]),
        entry("winding/misoriented_cube.obj", misoriented_cube(), [8, 18, 12, 2]),
        entry("winding/mobius_12.obj", mobius(12), [2 * 12, 4 * 12, 2 * 12, 0]),
        entry("seam/seam_0.obj", seam(0), [8 + 4, 18, 12, 2]),
        entry("seam/seam_1.obj", seam(1), [8 + 4, 18 + 4, 12, 2]),
        entry("seam/soup_of_octahedron.obj", soup(&octahedron()), [3 * 8, 12, 8, 2]),
        entry("degenerate/collinear_face.obj", collinear_face(), [9, 21, 14, 2]),
        entry("degenerate/flat_cuboid.obj", cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]), [8, 5, 12, 3]),
        entry("degenerate/sliver.obj", sliver(), [4, 6, 4, 2]),
        entry(
            "degenerate/uv_capsule_8_2.obj",
            uv_capsule(8, 2, 1.0, 1.0),
            // Each of the 4sq faces that have not collapsed has three half-edges, two per edge.
            [(s + 1) * (2 * q + 2), 3 * (4 * s * q) / 2, 2 * s * (2 * q + 1), 2],
        ),
        entry("nested/hollow_cube.obj", hollow_cube(), [16, 36, 24, 4]),
        entry("nested/nested_cubes_3.obj", nested_cubes(3), [8 * 3, 18 * 3, 12 * 3, 2 * 3]),
        entry("nested/nested_cubes_260.obj", nested_cubes(260), [8 * 260, 18 * 260, 12 * 260, 2 * 260]),
    ]
}

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/data"))
}

/// The bytes of an entry's file.
fn bytes(entry: &Entry) -> Vec<u8> {
    let target = match entry.file.rsplit_once('.').unwrap().1 {
        "stl" => return stl(&entry.mesh).into_bytes(),
        _ => Target::from_path(entry.file).unwrap(),
    };
    to_bytes(&Model { layers: vec![Layer::from(&entry.mesh)] }, target).unwrap()
}

/// Text STL, which the crate reads but does not write. The normals are left to the reader, as the format
/// allows.
fn stl(mesh: &Mesh) -> String {
    let mut text = format!("solid {}\n", mesh.name);
    for corners in mesh.triangles() {
        text += "facet normal 0 0 0\n outer loop\n";
        for &vertex in corners {
            let [x, y, z] = mesh.positions()[vertex as usize];
            writeln!(text, "  vertex {x} {y} {z}").unwrap();
        }
        text += " endloop\nendfacet\n";
    }
    text + &format!("endsolid {}\n", mesh.name)
}

/// The rows of the table: the file, then (column, value) pairs. No cell holds a comma.
fn table() -> Vec<(String, Vec<(String, String)>)> {
    let text = fs::read_to_string(folder().join("expected.csv")).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), header.len(), "{line}");
            let pairs = header.iter().zip(&cells).skip(2).map(|(&h, &c)| (h.to_owned(), c.to_owned()));
            (cells[0].to_owned(), pairs.collect())
        })
        .collect()
}

/// The counts of a file, by the columns of the table.
fn counted(file: &str, scene: Scene) -> Vec<(&'static str, String)> {
    let meshes = scene.bake(Scope::Scene).unwrap();
    let [mesh] = &meshes[..] else { panic!("{file} holds {} meshes", meshes.len()) };
    let welded = weld(mesh, Weld::Exact).mesh;
    let topology = Topology::of(&welded);
    topology.validate();
    let counts = CrackReport::of(&welded, &topology).counts;
    let numbers = [
        ("vertices", mesh.vertex_count()),
        ("welded_vertices", welded.vertex_count()),
        ("faces", counts.faces),
        ("edges", counts.edges),
        ("shells", counts.shells),
        ("closed_shells", counts.closed_shells),
        ("boundary_edges", counts.boundary_edges),
        ("boundary_loops", counts.boundary_loops),
        ("non_manifold_edges", counts.non_manifold_edges),
        ("max_faces_per_edge", counts.max_faces_per_edge),
        ("misoriented_edges", counts.misoriented_edges),
        ("non_manifold_vertices", counts.non_manifold_vertices),
        ("collapsed_faces", counts.collapsed_faces),
        ("zero_area_faces", counts.zero_area_faces),
        ("duplicate_faces", counts.duplicate_faces),
        ("t_junctions", counts.t_junctions),
        ("inside_out_shells", counts.inside_out_shells),
    ];
    let truths = [("watertight", counts.watertight), ("balanced", counts.balanced), ("even", counts.even)];
    numbers
        .map(|(column, count)| (column, count.to_string()))
        .into_iter()
        .chain(truths.map(|(column, truth)| (column, truth.to_string())))
        .chain([("euler_characteristic", counts.euler_characteristic.to_string())])
        .collect()
}

/// Differences between the counts of a file and its row. A missing column is a difference too.
fn differences(row: &[(String, String)], counted: &[(&str, String)]) -> Vec<String> {
    let expected = |column: &str| row.iter().find(|(name, _)| name == column).map(|(_, value)| value);
    let mut differences: Vec<String> = counted
        .iter()
        .filter(|(column, value)| expected(column) != Some(value))
        .map(|(column, value)| format!("{column} is {value}, not {:?}", expected(column)))
        .collect();
    let uncounted = row.iter().filter(|(column, _)| !counted.iter().any(|(name, _)| name == column));
    differences.extend(uncounted.map(|(column, _)| format!("{column} is not counted")));
    differences
}

/// Rewrites every file, once for all tests, if UMBRAGE_REGENERATE=1 is set.
fn regenerate_if_asked() {
    static ONCE: Once = Once::new();
    if std::env::var_os("UMBRAGE_REGENERATE").is_none_or(|value| value != "1") {
        return;
    }
    ONCE.call_once(|| {
        for entry in entries() {
            let path = folder().join(entry.file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            write_atomic(&path, |out| out.write_all(&bytes(&entry))).unwrap();
            eprintln!("REGENERATED: data/{}", entry.file);
        }
    });
}

#[test]
fn data_files_are_what_the_generators_make() {
    regenerate_if_asked();
    for entry in entries() {
        let committed = fs::read(folder().join(entry.file)).unwrap_or_else(|error| {
            panic!("data/{}: {error}; UMBRAGE_REGENERATE=1 writes it anew", entry.file)
        });
        assert!(
            committed == bytes(&entry),
            "data/{} is not what its generator makes; UMBRAGE_REGENERATE=1 writes it anew",
            entry.file
        );
    }
}

#[test]
fn data_counts_are_those_of_the_table() {
    regenerate_if_asked();
    let mut wrong = Vec::new();
    for (file, row) in table() {
        let counted = counted(&file, read(folder().join(&file)).unwrap());
        wrong.extend(differences(&row, &counted).iter().map(|what| format!("{file}: {what}")));
    }
    assert_eq!(wrong, Vec::<String>::new());
}

#[test]
fn data_table_agrees_with_closed_forms() {
    let rows = table();
    let entries = entries();
    let files = |list: Vec<&str>| list.into_iter().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(
        files(rows.iter().map(|row| row.0.as_str()).collect()),
        files(entries.iter().map(|entry| entry.file).collect()),
        "the table and the generators name the same files in the same order"
    );
    for ((file, row), entry) in rows.iter().zip(&entries) {
        let number =
            |column: &str| -> i64 { row.iter().find(|(name, _)| name == column).unwrap().1.parse().unwrap() };
        let truth = |column: &str| row.iter().find(|(name, _)| name == column).unwrap().1 == "true";
        let [vertices, edges, faces] = ["vertices", "edges", "faces"].map(number);
        assert_eq!([vertices, edges, faces, number("euler_characteristic")], entry.closed_form, "{file}");
        // χ = V − E + F over the faces that have not collapsed, if every welded vertex still has such a face.
        let kept = faces - number("collapsed_faces");
        assert_eq!(number("euler_characteristic"), number("welded_vertices") - edges + kept, "{file}");
        // Half-edges counted by edges: if no edge has more than two faces, 3F = 2E − B.
        if number("max_faces_per_edge") == 2 {
            assert_eq!(3 * kept, 2 * edges - number("boundary_edges"), "{file}");
        }
        let clean = ["boundary_edges", "non_manifold_edges", "misoriented_edges"];
        assert_eq!(truth("watertight"), clean.iter().all(|column| number(column) == 0), "{file}");
        assert_eq!(truth("watertight"), number("closed_shells") == number("shells"), "{file}");
        assert!(truth("balanced") || !truth("watertight"), "{file}");
        assert!(truth("even") || !truth("balanced"), "{file}");
        assert!(truth("even") == (number("boundary_edges") == 0 && number("max_faces_per_edge") % 2 == 0));
    }
}

#[test]
fn data_with_one_face_turned_or_lost_is_caught() {
    let rows = table();
    for (sabotage, file) in [("turned", "closed/cube.obj"), ("lost", "closed/torus_12_8.obj")] {
        let row = &rows.iter().find(|row| row.0 == file).unwrap().1;
        let entry = entries().into_iter().find(|entry| entry.file == file).unwrap();
        let name = entry.mesh.name.clone();
        let (positions, mut triangles, ..) = entry.mesh.into_parts();
        match sabotage {
            "turned" => triangles[3].swap(0, 1),
            _ => drop(triangles.remove(3)),
        }
        let mesh = Mesh::new(positions, triangles).unwrap().with_name(name);
        let broken = bytes(&Entry { mesh, ..entry });
        assert_ne!(broken, fs::read(folder().join(file)).unwrap());
        let counted = counted(file, read_bytes(&broken, file).unwrap());
        assert_ne!(differences(row, &counted), Vec::<String>::new(), "{sabotage}");
    }
    // Negative test: a wrong number in the table.
    let mut row = rows[0].1.clone();
    row[3].1 = "19".to_owned();
    let cube = read_bytes(&bytes(&entries()[0]), "cube.obj").unwrap();
    assert_eq!(differences(&row, &counted("cube.obj", cube)).len(), 1);
}
