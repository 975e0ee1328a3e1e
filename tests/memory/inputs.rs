//! Meshes of some 10⁵ faces, ordinary and hostile.

use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

/// Name and mesh; those that a reader would weld come welded, the others as they are.
pub(crate) fn all() -> Vec<(&'static str, Mesh)> {
    vec![
        ("sphere", shapes::icosphere(6)),
        ("shuffled sphere", shapes::shuffled(&shapes::icosphere(6), 1)),
        ("soup", shapes::soup(&shapes::icosphere(6))),
        ("sheet", shapes::sheet(200)),
        ("fan", fan(100_000)),
        ("cone", cone(50_000)),
        ("book", shapes::book(50_000)),
        ("equal faces", Mesh::new(shapes::sheet(1).positions().to_vec(), vec![[0, 1, 2]; 100_000]).unwrap()),
        ("collapsed strip", collapsed(100_000)),
        ("tiny parts", copies(&shapes::tetrahedron(), 20_000, 3.0)),
        ("equal parts", copies(&shapes::tetrahedron(), 500, 0.0)),
        ("nested parts", shapes::nested_cubes(500)),
        ("line of points", line(3_000)),
    ]
}

/// A million faces would do as well: faces around one vertex, open.
pub(crate) fn fan(faces: u32) -> Mesh {
    let rim = |i: u32| {
        let turn = f64::from(i) / f64::from(faces) * 6.0;
        [turn.cos() as f32, turn.sin() as f32, (f64::from(i) / f64::from(faces)) as f32]
    };
    let positions = std::iter::once([0.0, 0.0, 2.0]).chain((0..=faces).map(rim)).collect();
    Mesh::new(positions, (1..=faces).map(|i| [0, i, i + 1]).collect()).unwrap()
}

/// A closed cone: two vertices with `sides` faces each.
pub(crate) fn cone(sides: u32) -> Mesh {
    let rim = |i: u32| {
        let turn = f64::from(i) / f64::from(sides) * std::f64::consts::TAU;
        [turn.cos() as f32, turn.sin() as f32, 0.0]
    };
    let positions = [[0.0, 0.0, 2.0], [0.0; 3]].into_iter().chain((0..sides).map(rim)).collect();
    let next = |i: u32| 2 + (i + 1) % sides;
    Mesh::new(positions, (0..sides).flat_map(|i| [[0, 2 + i, next(i)], [1, next(i), 2 + i]]).collect())
        .unwrap()
}

/// A strip whose faces have all collapsed.
pub(crate) fn collapsed(faces: u32) -> Mesh {
    let positions = (0..=faces).map(|i| [i as f32, 0.0, 0.0]).collect();
    Mesh::new(positions, (0..faces).map(|i| [i, i, i + 1]).collect()).unwrap()
}

/// `count` copies, each `step` further along x than the one before, no vertex shared.
pub(crate) fn copies(mesh: &Mesh, count: u32, step: f32) -> Mesh {
    let copies: Vec<Mesh> =
        (0..count).map(|i| shapes::translated(mesh, [step * i as f32, 0.0, 0.0])).collect();
    Mesh::concat(&copies).unwrap()
}

/// Faces without area, all on one line, each reaching farther than the one before.
pub(crate) fn line(faces: u32) -> Mesh {
    let corner = |i: u32| [[-(i as f32) - 1.0, 0.0, 0.0], [0.0; 3], [i as f32 + 1.0, 0.0, 0.0]];
    Mesh::new(
        (0..faces).flat_map(corner).collect(),
        (0..faces).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    )
    .unwrap()
}
