//! Readers: ordinary files of every format, and small ones that claim to be large.

use umbrage::read::read_bytes;
use umbrage::scene::Scope;
use umbrage::testing::shapes;
use umbrage::write::{Layer, Model, Target, to_bytes};

use super::{alone, inputs, peak};

/// What does not depend on the file: a buffer or two.
const CONSTANT: usize = 1 << 20;
/// Peak bytes for each byte of the file, as `umbrage::read` states them; of a glTF, whose JSON is a tree in memory.
const BOUND: usize = 40;
const GLTF_BOUND: usize = 250;
/// What a glTF may decode to whatever its size, since accessors may be shared.
const GLTF_CONSTANT: usize = 256 << 20;

/// Binary STL, with the count that its header is to claim.
fn stl(triangles: usize, claim: u32) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(claim.to_le_bytes());
    bytes.resize(84 + 50 * triangles, 0);
    bytes
}

/// MD2 with one triangle, its header's numbers replaced as told.
fn md2(changes: &[(usize, u32)]) -> Vec<u8> {
    let mut header = [0_u32; 17];
    (header[0], header[1]) = (u32::from_le_bytes(*b"IDP2"), 8);
    (header[4], header[6], header[8], header[10]) = (40 + 12, 3, 1, 1);
    (header[13], header[14], header[16]) = (68, 80, 80 + 52);
    changes.iter().for_each(|&(field, value)| header[field] = value);
    let mut bytes: Vec<u8> = header.iter().flat_map(|field| field.to_le_bytes()).collect();
    bytes.resize(80 + 52, 0);
    bytes
}

fn ply(header: &str, data: &[u8]) -> Vec<u8> {
    [format!("ply\nformat {header}\nend_header\n").as_bytes(), data].concat()
}

/// A glTF with these accessors and buffer views; `mesh` stands in for everything else.
fn gltf(views: &str, accessors: &str, rest: &str) -> Vec<u8> {
    let buffer = "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAA=";
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":44,"uri":"{buffer}"}}],
        "bufferViews":[{views}],"accessors":[{accessors}],{rest}}}"#
    )
    .into_bytes()
}

const ONE_MESH: &str = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]"#;

/// Files whose counts no content stands behind, each with its name.
fn hostile() -> Vec<(&'static str, Vec<u8>)> {
    let text = |text: String| text.into_bytes();
    let repeated = |item: &str, count: usize| vec![item; count].join(",");
    let float3 = r#""componentType":5126,"type":"VEC3""#;
    let view = r#"{"buffer":0,"byteLength":44}"#;
    vec![
        ("index.obj", text("v 0 0 0\nf 1 2 4000000000\n".into())),
        ("beyond.obj", text("v 0 0 0\nf 1 1 99999999999999999999999999\n".into())),
        ("back.obj", text("v 0 0 0\nf -1 -1 -9223372036854775808\n".into())),
        ("corners.obj", text(format!("v 0 0 0\nf{}\n", " 1".repeat(100_000)))),
        (
            "names.obj",
            text(format!(
                "o {}\nv 0 0 0\n{}",
                "n".repeat(100_000),
                "g a\nf 1 1 1\ng b\nf 1 1 1\n".repeat(5000)
            )),
        ),
        ("count.stl", stl(1, u32::MAX)),
        ("count-and-more.stl", stl(3, 1 << 30)),
        ("none.stl", stl(0, 1)),
        (
            "vertices.ply",
            ply(
                "ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z",
                b"0 0 0\n",
            ),
        ),
        (
            "vertices-binary.ply",
            ply(
                "binary_little_endian 1.0\nelement vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float z",
                &[0; 12],
            ),
        ),
        (
            "list.ply",
            ply(
                "binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uint uint vertex_indices",
                &[[0; 12].as_slice(), &[255; 4], &[0; 64]].concat(),
            ),
        ),
        (
            "skipped-list.ply",
            ply(
                "binary_big_endian 1.0\nelement other 1\nproperty list uint double values\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z",
                &[255; 64],
            ),
        ),
        (
            "nothing.ply",
            ply(
                "ascii 1.0\nelement other 18446744073709551615\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z",
                b"",
            ),
        ),
        (
            "corners.ply",
            ply(
                "binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                 element face 1\nproperty list uint uchar vertex_indices",
                &[[0; 12].as_slice(), &1_000_000_u32.to_le_bytes(), &vec![0; 1_000_000]].concat(),
            ),
        ),
        ("objects.gltf", gltf(view, "", &format!(r#""extras":[{}]"#, repeated(r#"{"a":0}"#, 100_000)))),
        ("lists.gltf", gltf(view, "", &format!(r#""extras":[{}]"#, repeated("[]", 200_000)))),
        ("vertices.off", b"OFF 4000000000 1 0\n0 0 0\n".to_vec()),
        ("corners.off", b"OFF\n1 1 0\n0 0 0\n4000000000 0 0\n".to_vec()),
        ("lost.off", [&b"OFF 50000 0 0\n"[..], &b"nan 0 0\n".repeat(50_000)].concat()),
        ("binary.off", [&b"OFF BINARY\n"[..], &[127; 64]].concat()),
        ("frames.md2", md2(&[(10, u32::MAX)])),
        ("vertices.md2", md2(&[(6, u32::MAX), (4, u32::MAX)])),
        ("triangles.md2", md2(&[(8, u32::MAX)])),
        ("count.gltf", gltf(view, &format!("{{\"bufferView\":0,{float3},\"count\":4000000000}}"), ONE_MESH)),
        ("no-view.gltf", gltf(view, &format!("{{{float3},\"count\":4000000000}}"), ONE_MESH)),
        ("whole.gltf", gltf(view, &format!("{{{float3},\"count\":9007199254740992}}"), ONE_MESH)),
        ("zeros.gltf", gltf(view, &format!("{{{float3},\"count\":4000000}}"), ONE_MESH)),
        (
            "stride.gltf",
            gltf(
                r#"{"buffer":0,"byteLength":44,"byteStride":4294967295}"#,
                &format!("{{\"bufferView\":0,{float3},\"count\":2}}"),
                ONE_MESH,
            ),
        ),
        (
            "view.gltf",
            gltf(
                r#"{"buffer":0,"byteOffset":18446744073709551615,"byteLength":44}"#,
                &format!("{{\"bufferView\":0,{float3},\"count\":3}}"),
                ONE_MESH,
            ),
        ),
        (
            "sparse.gltf",
            gltf(
                view,
                &format!(
                    "{{{float3},\"count\":3,\"sparse\":{{\"count\":4000000000,\"indices\":{{\"bufferView\":0,\"componentType\":5125}},\"values\":{{\"bufferView\":0}}}}}}"
                ),
                ONE_MESH,
            ),
        ),
        (
            "shared.gltf",
            gltf(
                view,
                &format!("{{{float3},\"count\":3000000}}"),
                &format!(
                    r#""meshes":[{{"primitives":[{}]}}],"nodes":[{{"mesh":0}}]"#,
                    repeated(r#"{"attributes":{"POSITION":0}}"#, 1000)
                ),
            ),
        ),
        (
            "targets.gltf",
            gltf(
                view,
                &format!("{{{float3},\"count\":2000000}}"),
                &format!(
                    r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{}]}}]}}],"nodes":[{{"mesh":0}}]"#,
                    repeated("{}", 1000)
                ),
            ),
        ),
        (
            "instances.gltf",
            gltf(
                view,
                &format!("{{\"bufferView\":0,{float3},\"count\":3}},{{{float3},\"count\":3900000}}"),
                r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0,"extensions":
                {"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}}]"#,
            ),
        ),
        (
            "compressed.gltf",
            gltf(
                r#"{"buffer":0,"byteLength":44,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteLength":44,
                "byteStride":4,"count":1000000000,"mode":"ATTRIBUTES"}}}"#,
                &format!("{{\"bufferView\":0,{float3},\"count\":3}}"),
                ONE_MESH,
            ),
        ),
        (
            "material.gltf",
            gltf(
                view,
                &format!("{{\"bufferView\":0,{float3},\"count\":3}}"),
                &format!(
                    r#""materials":[{{"name":"{}"}}],"meshes":[{{"primitives":[{}]}}],"nodes":[{{"mesh":0}}]"#,
                    "n".repeat(1 << 20),
                    repeated(r#"{"attributes":{"POSITION":0},"material":0}"#, 2000)
                ),
            ),
        ),
        (
            "name.gltf",
            gltf(
                view,
                &format!("{{\"bufferView\":0,{float3},\"count\":3}}"),
                &format!(
                    r#""meshes":[{{"name":"{}","primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{}]"#,
                    "n".repeat(1 << 20),
                    repeated(r#"{"mesh":0}"#, 2000)
                ),
            ),
        ),
    ]
}

#[test]
fn memory_of_an_ordinary_file_is_a_multiple_of_its_size() {
    let _alone = alone();
    let mesh = shapes::icosphere(6);
    let model = Model { layers: vec![Layer::from(&mesh)] };
    let mut binary = vec![0; 80];
    binary.extend((mesh.face_count() as u32).to_le_bytes());
    let mut text = String::from("solid ball\n");
    for face in 0..mesh.face_count() {
        let corners = mesh.corners(umbrage::mesh::FaceId::new(face));
        binary.extend([0; 12]);
        binary.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        binary.extend([0; 2]);
        text += "facet normal 0 0 0\nouter loop\n";
        corners.iter().for_each(|[x, y, z]| text += &format!("vertex {x} {y} {z}\n"));
        text += "endloop\nendfacet\n";
    }
    text += "endsolid\n";
    let mut files = vec![("text.stl", text.into_bytes()), ("binary.stl", binary)];
    for (name, target) in [("a.obj", Target::Obj), ("a.ply", Target::Ply), ("a.glb", Target::Glb)] {
        files.push((name, to_bytes(&model, target).unwrap()));
    }
    for (name, file) in files {
        let (scene, bytes) = peak(|| read_bytes(&file, name).unwrap());
        let (_, baked) = peak(|| scene.bake(Scope::Mesh).unwrap());
        let per_face = bytes as f64 / mesh.face_count() as f64;
        eprintln!(
            "{name}: {:.2} a byte, {per_face:.1} a face; bake {baked}",
            bytes as f64 / file.len() as f64
        );
        assert!(bytes < CONSTANT + BOUND * file.len(), "{name}: {bytes} for {}", file.len());
        assert!(baked < 1 << 16, "{name}: baking took {baked} bytes");
    }
}

#[test]
fn memory_of_a_file_that_claims_much_is_a_multiple_of_its_size() {
    let _alone = alone();
    for (name, file) in hostile() {
        let (result, bytes) = peak(|| read_bytes(&file, name).map_err(|error| error.to_string()));
        let (constant, bound) =
            if name.ends_with(".gltf") { (GLTF_CONSTANT, GLTF_BOUND) } else { (CONSTANT, BOUND) };
        let said = result.as_ref().err().map_or("read", String::as_str);
        eprintln!("{name}, {} bytes: {bytes}; {said}", file.len());
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(bytes < constant + bound * file.len(), "{name}: {bytes} for {}: {said}", file.len());
        let Ok(scene) = result else { continue };
        let (_, baked) = peak(|| scene.bake(Scope::Mesh));
        assert!(baked < constant + bound * file.len(), "{name}: baking took {baked} for {}", file.len());
    }
}

#[test]
fn memory_of_instances_has_an_end() {
    let _alone = alone();
    // Frames and parts count, not only the vertices of the first frame.
    let nodes = vec![r#"{"mesh":0}"#; 30_000].join(",");
    let targets = vec!["{}"; 2000].join(",");
    let primitives = vec![r#"{"attributes":{"POSITION":0}}"#; 1000].join(",");
    for (what, mesh) in [
        (
            "vertices",
            format!(r#"{{"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{targets}]}}]}}"#),
        ),
        ("parts", format!(r#"{{"primitives":[{primitives}]}}"#)),
    ] {
        let view = r#"{"buffer":0,"byteLength":44}"#;
        let accessor = r#"{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}"#;
        let file = gltf(view, accessor, &format!(r#""meshes":[{mesh}],"nodes":[{nodes}]"#));
        let scene = read_bytes(&file, "a.gltf").unwrap();
        let (baked, bytes) = peak(|| scene.bake(Scope::Mesh));
        assert!(baked.unwrap_err().to_string().contains(what));
        assert!(bytes < 1 << 16, "{bytes}");
    }
}

#[test]
fn memory_of_a_polygon_of_a_million_corners_is_that_of_its_triangles() {
    let _alone = alone();
    let file = to_bytes(&Model { layers: vec![Layer::from(&inputs::fan(1_000_000))] }, Target::Ply).unwrap();
    let (scene, bytes) = peak(|| read_bytes(&file, "fan.ply").unwrap());
    assert_eq!(scene.meshes[0].face_count(), 1_000_000);
    assert!(bytes < CONSTANT + BOUND * file.len(), "{bytes} for {}", file.len());
}
