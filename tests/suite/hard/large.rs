//! Meshes with many vertices.
//!
//! `UMBRAGE_HARD_LARGE=1` adds a sheet of 16.8 million vertices, which takes some seconds and 2 GB.

use umbrage::check::CrackReport;
use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::shadow::volume::{Caps, ShadowVolume, winding_number};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;
use umbrage::topology::Topology;

use super::figures::*;

/// Guards against 16-bit indices: the faces tested come after the first 65,536 vertices.
#[test]
fn hard_16_many_vertices_beyond_sixteen_bits() {
    let n = 257_usize;
    let sheet = shapes::sheet(257);
    assert!(sheet.vertex_count() == (n + 1) * (n + 1) && sheet.vertex_count() > 65_536 + 2 * n);
    let c = counts(&sheet);
    assert_eq!((c.edges, c.boundary_edges, c.boundary_loops), (3 * n * n + 2 * n, 4 * n, 1));
    let light = point(100.3, 200.4, 50.0);
    expect_figures(&[(&sheet, light, ([2 * n * n, 0, 0], 4 * n, 4 * n))]);
    // Points behind the last quad, whose corners are the last vertices.
    expect_crossings(&sheet, &sun(0.0, 0.0, -1.0), &[([256.6, 256.3, -5.0], 1), ([257.1, 256.3, -5.0], 0)]);

    // 300 segments around the axis, 220 around the tube.
    let ring = shapes::torus(300, 220, 2.0, 0.5);
    let welded = weld(&shapes::soup(&ring), Weld::Exact).mesh;
    assert_eq!((welded.vertex_count(), ring.vertex_count()), (66_000, 66_000));
    let c = counts(&welded);
    assert_eq!((c.edges, c.euler_characteristic, c.sound()), (198_000, 0, true));
    // A light far above the torus on its axis: the silhouette is the outer rim and the inner one.
    let light = point(0.01, 0.02, 70.0);
    let (silhouette, volume) = cast(&welded, &light, CasterFaces::All);
    assert_eq!((silhouette.loops(&topology(&welded)).len(), silhouette.max_multiplicity()), (2, 2));
    assert!(volume.boundary_sum().is_closed());
    // Negative test: indices cut to 16 bits.
    let triangles = sheet.triangles().iter().map(|face| face.map(|v| v & 0xffff)).collect();
    let cut = Mesh::new(sheet.positions().to_vec(), triangles).unwrap();
    assert_ne!(counts(&cut).boundary_edges, 4 * n);
}

/// A cube whose vertices have the highest odd indices of a list of `count`.
fn cube_at_the_end(count: u32) -> Mesh {
    let (corners, triangles, ..) = shapes::cube().into_parts();
    let at = |vertex: u32| count - 32 + 2 * vertex + (count + 1) % 2;
    let mut positions = vec![[0.0; 3]; count as usize];
    (0..8).for_each(|vertex| positions[at(vertex) as usize] = corners[vertex as usize]);
    let triangles = triangles.iter().map(|face| face.map(at)).collect();
    Mesh::new(positions, triangles).unwrap().with_name(format!("the last of {count} vertices"))
}

/// Guards against indices that pass through f32, which holds no odd number beyond 2²⁴.
#[test]
fn hard_16_many_vertices_beyond_what_f32_counts_exactly() {
    let mesh = cube_at_the_end((1 << 24) + 64);
    let least = mesh.triangles().iter().flatten().min().copied().unwrap();
    assert!(least > 1 << 24 && mesh.triangles().iter().flatten().all(|v| v % 2 == 1));
    let build = |mesh: &Mesh| Topology::of(mesh);
    let topology = build(&mesh);
    let c = CrackReport::of(&mesh, &topology).counts;
    assert_eq!((c.edges, c.euler_characteristic, c.sound()), (18, 2, true));
    let light = point(3.0, 5.0, 7.0);
    let signs = CasterFaces::All.signs(&classify(&mesh, &light));
    let silhouette = Silhouette::extract(&topology, &signs);
    let volume = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
    assert_eq!((silhouette.edges.len(), volume.triangles().len()), (6, 12 + 24 + 12));
    assert!(volume.boundary_sum().is_closed());
    assert_eq!(volume.casters().iter().map(|v| v.index() as u32).min(), Some(least));
    assert_eq!(winding_number(&volume, [-3.0, -5.0, -7.25]), Some(2));
    assert_eq!(weld(&mesh, Weld::Exact).mesh.vertex_count(), 8);
    // Negative test: through f32 two corners become one.
    let narrow = mesh.triangles().iter().map(|face| face.map(|v| v as f32 as u32)).collect();
    let narrow = Mesh::new(mesh.positions().to_vec(), narrow).unwrap();
    assert_ne!(build(&narrow).edge_count(), 18);
}

/// Guards against offsets of half-edges and faces that wrap: 33.6 million faces and 50.3 million edges.
#[test]
fn hard_16_many_vertices_and_faces_in_one_sheet() {
    let n: usize = if std::env::var_os("UMBRAGE_HARD_LARGE").is_some_and(|value| value == "1") {
        4096
    } else {
        eprintln!("a sheet of 262,144 quads; UMBRAGE_HARD_LARGE=1 for one of 16,777,216");
        512
    };
    let sheet = shapes::sheet(n as u32);
    assert!(n < 4096 || sheet.vertex_count() > 1 << 24);
    let topology = Topology::of(&sheet);
    assert_eq!(topology.edge_count(), 3 * n * n + 2 * n);
    let found = topology.edge_counts();
    assert_eq!((found.boundary, found.non_manifold, found.misoriented, found.max_faces), (4 * n, 0, 0, 2));
    let light = point(0.3 * n as f32, 0.7 * n as f32, 3.0);
    let facing = FacePlanes::new(&sheet).classify(&sheet, &light);
    let mut signs = CasterFaces::All.signs(&facing);
    assert!(signs.iter().all(|&sign| sign == 1));
    let silhouette = Silhouette::extract(&topology, &signs);
    assert_eq!((silhouette.edges.len(), silhouette.max_multiplicity()), (4 * n, 1));
    // Negative test: the very last face turned away. One of its edges is on the boundary; the other two show
    // the fault.
    *signs.last_mut().unwrap() = -1;
    assert_eq!(Silhouette::extract(&topology, &signs).edges.len(), 4 * n + 2);
}
