//! Written files read back to the same bits.

use proptest::prelude::*;
use umbrage::mesh::Mesh;
use umbrage::read::read_bytes;
use umbrage::testing::shapes;
use umbrage::write::{Elements, Layer, Model, Target, to_bytes};

fn back(model: &Model, target: Target, name: &str) -> Vec<Mesh> {
    let bytes = to_bytes(model, target).unwrap();
    read_bytes(&bytes, name).unwrap_or_else(|error| panic!("{error}")).meshes
}

fn bits(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.positions().iter().map(|p| p.map(f32::to_bits)).collect()
}

fn any_finite() -> impl Strategy<Value = f32> {
    any::<f32>().prop_filter("finite", |x| x.is_finite())
}

proptest! {
    #[test]
    fn write_meshes_read_back_to_the_same_bits(
        positions in prop::collection::vec([any_finite(), any_finite(), any_finite()], 1..40),
        picks in prop::collection::vec([any::<u32>(), any::<u32>(), any::<u32>()], 1..60),
    ) {
        let n = positions.len() as u32;
        let triangles = picks.into_iter().map(|t| t.map(|i| i % n)).collect();
        let mesh = Mesh::new(positions, triangles).unwrap();
        let model = Model { layers: vec![Layer::from(&mesh)] };
        for (target, name) in [(Target::Obj, "a.obj"), (Target::Ply, "a.ply"), (Target::Glb, "a.glb")] {
            let read = back(&model, target, name);
            prop_assert_eq!(read.len(), 1);
            prop_assert_eq!(bits(&read[0]), bits(&mesh), "{}", name);
            prop_assert_eq!(read[0].triangles(), mesh.triangles(), "{}", name);
        }
    }
}

#[test]
fn write_a_moved_vertex_would_be_seen() {
    let mesh = shapes::cube();
    let moved = shapes::translated(&mesh, [0.0, f32::EPSILON * 2.0, 0.0]);
    let read = back(&Model { layers: vec![Layer::from(&moved)] }, Target::Obj, "a.obj");
    assert_ne!(bits(&read[0]), bits(&mesh));
}

#[test]
fn write_lines_keep_their_vertices_in_every_format() {
    let positions = vec![[0.1, 0.2, 0.3], [1e-40, -3e38, 7.0], [2.0, 0.5, -0.25]];
    let lines = Layer {
        name: "edges".into(),
        positions: positions.clone(),
        elements: Elements::Lines(vec![[0, 1], [1, 2]]),
        ..Layer::default()
    };
    let model = Model { layers: vec![lines] };
    let obj = String::from_utf8(to_bytes(&model, Target::Obj).unwrap()).unwrap();
    assert_eq!(obj.lines().filter(|line| line.starts_with("l ")).collect::<Vec<_>>(), ["l 1 2", "l 2 3"]);
    for (target, name) in [(Target::Obj, "a.obj"), (Target::Ply, "a.ply")] {
        let read = back(&model, target, name);
        assert_eq!(
            bits(&read[0]),
            positions.iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>(),
            "{name}"
        );
        assert_eq!(read[0].face_count(), 0);
    }
}
