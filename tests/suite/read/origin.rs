//! Faces and what the file has them as: polygon and line.

use umbrage::mesh::{FaceId, Mesh, Weld, weld, weld_in_place};
use umbrage::scene::Scope;

use super::scene;

fn origins(mesh: &Mesh) -> Vec<(u32, Option<u64>)> {
    let of = |face| mesh.origin(FaceId::new(face));
    (0..mesh.face_count()).map(of).map(|origin| (origin.polygon, origin.line)).collect()
}

/// A quad, a triangle that collapses when welded, a pentagon, and a triangle, in two groups.
const OBJ: &str = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 6 0\nv 4 0 0\n\
                   g low\nf 1 2 3 4\n\nf 2 3 6\n# a comment\ng high\nf 1 2 3 5 \\\n4\nf 3 2 1\n";

const OBJ_ORIGINS: [(u32, Option<u64>); 7] =
    [(0, Some(8)), (0, Some(8)), (1, Some(10)), (2, Some(13)), (2, Some(13)), (2, Some(13)), (3, Some(15))];

#[test]
fn origin_of_an_obj_face_is_its_statement() {
    let mesh = &scene(OBJ, "a.obj").meshes[0];
    assert_eq!(origins(mesh), OBJ_ORIGINS);
    for how in [Weld::Exact, Weld::None, Weld::Within(0.5)] {
        assert_eq!(origins(&weld(mesh, how).mesh), OBJ_ORIGINS);
        assert_eq!(origins(&weld_in_place(mesh.clone(), how).mesh), OBJ_ORIGINS);
    }
    for scope in [Scope::Primitive, Scope::Mesh, Scope::Scene] {
        let baked = scene(OBJ, "a.obj").bake(scope).unwrap();
        assert_eq!(baked.iter().flat_map(origins).collect::<Vec<_>>(), OBJ_ORIGINS, "{scope:?}");
    }
    let mut high = scene(OBJ, "a.obj");
    high.retain(|part| part.names().any(|name| name == "high")).unwrap();
    assert_eq!(origins(&high.meshes[0]), OBJ_ORIGINS[3..]);
    // Fault injected: the numbers of the faces, which these are not.
    assert_ne!(
        origins(&mesh.clone()).iter().map(|origin| origin.0).collect::<Vec<_>>(),
        [0, 1, 2, 3, 4, 5, 6]
    );
}

#[test]
fn origin_of_text_and_binary_files() {
    let facet = |x: f32| {
        format!(
            "facet normal 0 0 1\nouter loop\nvertex {x} 0 0\nvertex 1 {x} 0\nvertex 0 1 {x}\nendloop\nendfacet\n"
        )
    };
    let stl = format!("solid a\n{}\n{}endsolid a\n", facet(2.0), facet(3.0));
    assert_eq!(origins(&scene(stl, "a.stl").meshes[0]), [(0, Some(2)), (1, Some(10))]);
    let head = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                element face 2\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0\n4 0 0\n4 4 0\n0 4 0\n2 6 0\n";
    let ply = format!("{head}3 0 1 2\n\n5 0 1 2 4 3\n");
    let pentagon = [(1, Some(17)); 3];
    assert_eq!(origins(&scene(&ply, "a.ply").meshes[0])[1..], pentagon);
    assert_eq!(origins(&scene(&ply, "a.ply").meshes[0])[0], (0, Some(15)));
    // Binary: the same polygons, on no line.
    let mut binary = head.replace("ascii", "binary_little_endian").into_bytes();
    binary.truncate(head.replace("ascii", "binary_little_endian").find("0 0 0\n").unwrap());
    for number in [0.0_f32, 0., 0., 4., 0., 0., 4., 4., 0., 0., 4., 0., 2., 6., 0.] {
        binary.extend(number.to_le_bytes());
    }
    for face in [&[0_i32, 1, 2][..], &[0, 1, 2, 4, 3]] {
        binary.push(face.len() as u8);
        face.iter().for_each(|vertex| binary.extend(vertex.to_le_bytes()));
    }
    let mesh = scene(&binary, "b.ply").meshes.remove(0);
    assert_eq!(origins(&mesh), [(0, None), (1, None), (1, None), (1, None)]);
    assert_eq!(mesh.triangles(), scene(&ply, "a.ply").meshes[0].triangles());
}
