//! Real meshes against facts that were measured by other programs.
//!
//! Columns that mean the same are compared one to one. Where the definitions differ, the test says how, and
//! asserts what ours gives.

use std::path::{Path, PathBuf};

use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::topology::{Counts, CrackReport, ShellReport, Topology};

fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("UMBRAGE_MESHES").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/meshes")),
        PathBuf::from,
    );
    let there = folder.join("facts.csv").is_file();
    if !there {
        eprintln!("SKIPPED: no real meshes in {} (UMBRAGE_MESHES names another folder)", folder.display());
    }
    there.then_some(folder)
}

/// The rows of the table as (column, value) pairs; quotes may hold commas.
fn facts(folder: &Path) -> Vec<Vec<(String, String)>> {
    let text = std::fs::read_to_string(folder.join("facts.csv")).unwrap();
    let cells = |line: &str| {
        let mut cells = vec![String::new()];
        let mut quoted = false;
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => cells.push(String::new()),
                c => cells.last_mut().unwrap().push(c),
            }
        }
        cells
    };
    let mut lines = text.lines();
    let header = cells(lines.next().unwrap());
    lines.map(|line| header.iter().cloned().zip(cells(line)).collect()).collect()
}

/// Each instance in its own space, mirrored ones turned, as the facts were measured.
fn meshes(file: &Path) -> Vec<Mesh> {
    let scene = umbrage::read::read(file).unwrap();
    let place = |instance: &umbrage::scene::Instance| {
        let mesh = scene.meshes[instance.mesh].clone();
        if instance.world_from_mesh.determinant() >= 0.0 {
            return mesh;
        }
        let (positions, mut triangles, parts, _) = mesh.into_parts();
        triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        Mesh::new(positions, triangles).unwrap().with_parts(parts)
    };
    scene.instances.iter().map(place).collect()
}

struct Measured {
    counts: Counts,
    shells: Vec<ShellReport>,
    intersecting_faces: usize,
}

fn measure(file: &Path) -> Measured {
    let mut shells = Vec::new();
    let mut intersecting_faces = 0;
    let reports = meshes(file).into_iter().map(|mesh| {
        let mesh = weld(&mesh, Weld::Exact).mesh;
        let topology = Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
        let mut report = CrackReport::of(&mesh, &topology);
        report.add_self_intersections(&mesh, &topology, 0);
        shells.append(&mut report.shell_list);
        intersecting_faces += report.self_intersections.unwrap().faces;
        report.counts
    });
    Measured { counts: Counts::total(reports).unwrap(), shells, intersecting_faces }
}

#[test]
fn facts_of_real_meshes_are_found_again() {
    let Some(folder) = folder() else { return };
    let mut differences = Vec::new();
    let facts = facts(&folder);
    for row in &facts {
        let fact = |column: &str| &row.iter().find(|(name, _)| name == column).unwrap().1;
        let name = fact("name").as_str();
        let Measured { counts, shells, intersecting_faces } = measure(&folder.join(name));
        let closed = shells.iter().filter(|shell| shell.watertight);
        let negative = closed.clone().filter(|shell| shell.signed_volume < 0.0).count();
        for (column, found) in [
            ("triangles", counts.faces),
            ("boundary_edges", counts.boundary_edges),
            ("boundary_loops", counts.boundary_loops),
            ("nonmanifold_edges", counts.non_manifold_edges),
            ("max_faces_per_edge", counts.max_faces_per_edge),
            ("inconsistent_edges", counts.misoriented_edges),
            ("nonmanifold_vertices", counts.non_manifold_vertices),
            ("degenerate_after_weld", counts.collapsed_faces),
            ("zero_area_f64", counts.zero_area_faces),
            ("duplicate_faces", counts.duplicate_faces),
            ("components", counts.shells),
            ("components_closed", counts.closed_shells),
            ("components_negative_volume", negative),
            ("self_intersecting_faces", intersecting_faces),
        ] {
            if fact(column).parse() != Ok(found) {
                differences.push(format!("{name}: {column} {} {found}", fact(column)));
            }
        }
        if fact("euler_number").parse() != Ok(counts.euler_characteristic) {
            differences.push(format!(
                "{name}: euler_number {} {}",
                fact("euler_number"),
                counts.euler_characteristic
            ));
        }
        let volume: f64 = fact("signed_volume").parse().unwrap();
        if (counts.signed_volume - volume).abs() > 1e-5 * volume.abs() {
            differences.push(format!("{name}: signed_volume {volume} {}", counts.signed_volume));
        }
        let genus = shells.iter().map(|shell| shell.genus).sum::<Option<u64>>();
        if fact("genus").parse().ok() != genus {
            differences.push(format!("{name}: genus {:?} {genus:?}", fact("genus")));
        }
        for (column, found) in [
            ("closed_every_edge_2", counts.watertight),
            ("closed_even", counts.even),
            ("closed_oriented_sum0", counts.balanced),
        ] {
            if fact(column) != if found { "True" } else { "False" } {
                differences.push(format!("{name}: {column} {} {found}", fact(column)));
            }
        }
    }
    assert_eq!(facts.len(), 29);
    assert_eq!(differences, Vec::<String>::new());
}
