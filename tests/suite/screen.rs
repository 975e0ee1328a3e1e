//! The screen for balance against the edge table.

use proptest::prelude::*;
use umbrage::check::Screen;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::read;
use umbrage::scene::Scope;
use umbrage::testing::shapes;
use umbrage::testing::strategy::soup;
use umbrage::topology::Topology;

use super::support::real_meshes;

/// The answer of the edge table.
fn balanced(mesh: &Mesh) -> bool {
    Topology::of(mesh).edge_counts().balanced
}

/// Compares the screen with the edge table by indices and by positions. Returns the answer by positions.
fn assert_same(mesh: &Mesh, screen: Screen) -> bool {
    assert_eq!(screen.indices(mesh.triangles()), balanced(mesh), "{}, by indices", mesh.name);
    let welded = weld(mesh, Weld::Exact).mesh;
    let by_positions = screen.positions(mesh);
    assert_eq!(by_positions, balanced(&welded), "{}, by positions", mesh.name);
    assert_eq!(screen.indices(welded.triangles()), by_positions, "{}, welded", mesh.name);
    by_positions
}

fn solids() -> Vec<Mesh> {
    vec![
        shapes::cube(),
        shapes::cuboid([0.0; 3], [1.0, 2.0, 3.0]),
        shapes::tetrahedron(),
        shapes::octahedron(),
        shapes::icosphere(4),
        shapes::torus(40, 30, 2.0, 0.75),
        shapes::torus_knot(2, 3, 60, 8, 0.2),
        shapes::menger_sponge(2),
        shapes::hollow_cube(),
        shapes::nested_cubes(3),
        shapes::figure_eight_prism(),
        shapes::cubes_sharing_edge(),
        shapes::cubes_sharing_vertex(),
        shapes::sliver(),
        shapes::collinear_face(),
        shapes::double_sheet(),
        shapes::sheet(7),
        shapes::mobius(20),
        shapes::book(5),
        shapes::open_cube(),
        shapes::t_junction(),
        shapes::seam(6),
        shapes::uv_capsule(12, 4, 1.0, 2.0),
        shapes::duplicated_face(),
        shapes::misoriented_cube(),
        shapes::inside_out(&shapes::cube()),
    ]
}

#[test]
fn screen_equals_the_edge_table_on_all_generated_solids() {
    let mut found = [0, 0];
    for mesh in solids() {
        for mesh in [shapes::soup(&mesh), shapes::shuffled(&mesh, 3), mesh] {
            found[usize::from(assert_same(&mesh, Screen::default()))] += 1;
        }
    }
    assert!(found[0] > 20 && found[1] > 20, "unbalanced and balanced: {found:?}");
}

#[test]
fn screen_equals_the_edge_table_on_real_meshes() {
    let Some(folder) = real_meshes() else { return };
    let mut found = [0, 0];
    for file in std::fs::read_dir(folder).unwrap() {
        let Ok(scene) = read::read(file.unwrap().path()) else { continue }; // facts.csv and the like
        for mesh in scene.bake(Scope::Mesh).unwrap() {
            found[usize::from(assert_same(&mesh, Screen::default()))] += 1;
        }
    }
    assert!(found[0] > 5 && found[1] > 5, "unbalanced and balanced: {found:?}");
}

proptest! {
    #[test]
    fn screen_equals_the_edge_table_on_random_soups(mesh in soup(60), seed in any::<u64>()) {
        assert_same(&mesh, Screen::new(seed));
        // Every face together with its reverse: balanced, wherever the faces lie.
        let mut triangles = mesh.triangles().to_vec();
        triangles.extend(mesh.triangles().iter().rev().map(|&[a, b, c]| [c, b, a]));
        let closed = Mesh::new(mesh.positions().to_vec(), triangles).unwrap();
        prop_assert!(assert_same(&closed, Screen::new(seed)));
    }
}

#[test]
fn screen_sees_one_face_turned_or_dropped_wherever_it_stands() {
    let sphere = shapes::icosphere(2);
    let faces = sphere.face_count();
    assert!(faces > 300, "several blocks and a part of one");
    for at in 0..faces {
        for turn in [false, true] {
            let mut triangles = sphere.triangles().to_vec();
            if turn {
                triangles[at].swap(0, 1);
            } else {
                triangles.remove(at);
            }
            let broken = Mesh::new(sphere.positions().to_vec(), triangles).unwrap();
            assert!(!Screen::default().indices(broken.triangles()), "face {at}, turned: {turn}");
            assert!(!Screen::default().positions(&broken), "face {at}, turned: {turn}");
            assert!(!Screen::default().positions(&shapes::soup(&broken)), "face {at}, turned: {turn}");
        }
    }
}

#[test]
fn screen_takes_every_frame_for_what_parts_vertices() {
    let soup = shapes::soup(&shapes::cube());
    let frame = soup.positions().to_vec();
    let mut parted = frame.clone();
    parted[5][1] += 0.25;
    let with = |frames: Vec<Vec<[f32; 3]>>| soup.clone().with_frames(frames).unwrap();
    assert!(assert_same(&with(vec![frame.clone(), frame.clone()]), Screen::default()));
    assert!(!assert_same(&with(vec![frame, parted]), Screen::default()));
}

#[test]
fn screen_with_a_hash_that_forgets_directions_would_be_caught() {
    // Negative test: a symmetric hash of each edge, which only separates odd edges from even ones.
    let symmetric = |mesh: &Mesh| {
        let hash = |a: u32, b: u32| {
            (u64::from(a.min(b)) << 32 | u64::from(a.max(b))).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        };
        let edges = mesh.triangles().iter().flat_map(|&[a, b, c]| [hash(a, b), hash(b, c), hash(c, a)]);
        edges.fold(0, |sum, hash| sum ^ hash) == 0
    };
    let differs = solids().iter().any(|mesh| symmetric(mesh) != balanced(mesh));
    assert!(differs, "the solids tell them apart");
}
