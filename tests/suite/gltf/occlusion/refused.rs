//! What cannot be added to is refused by name; what is beside the file becomes part of it; nothing panics.

use std::fs;

use super::super::defect::{pointers, rich as defective};
use super::super::{draco, instancing, meshopt};
use super::*;

fn refusal(builder: &Builder, form: Form) -> String {
    let file = GltfFile::from_bytes(builder.gltf()).unwrap();
    let error = file.check(None, &OcclusionOptions::new(form)).expect_err("must be refused").to_string();
    assert!(error.lines().count() == 1 && error.contains("; "), "{error}");
    error
}

#[test]
fn occlusion_refuses_what_it_cannot_add_to_by_name() {
    let mut builder = Builder::square();
    let translation = builder.positions(&[[0.0; 3], [5.0, 0.0, 0.0]]);
    let builder = instancing::instanced(json!({"TRANSLATION": translation}), builder);
    let error = refusal(&builder, Form::Attribute);
    assert!(error.contains("node 0") && error.contains("EXT_mesh_gpu_instancing"), "{error}");

    #[cfg(feature = "draco")]
    {
        let error = refusal(&draco::document(&draco::SEQUENTIAL, 4, 12), Form::Color);
        assert!(error.contains("KHR_draco_mesh_compression") && error.contains("gltf-transform"), "{error}");
    }

    let mut builder = Builder::square();
    for set in 0..4 {
        let uv = builder.accessor(5126, "VEC2", 4, &f32s(&[0.0; 8]));
        builder.doc["meshes"][0]["primitives"][0]["attributes"][format!("TEXCOORD_{set}")] = uv.into();
    }
    let error = refusal(&builder, Form::Texture);
    assert!(error.contains("4 sets of texture coordinates") && error.contains("--as attribute"), "{error}");
    let file = GltfFile::from_bytes(builder.gltf()).unwrap();
    assert_eq!(file.check(None, &OcclusionOptions::new(Form::Color)), Ok(()));
}

#[test]
fn occlusion_replaces_what_is_there_only_if_told_so() {
    let mut builder = Builder::square();
    builder.doc["materials"] = json!([{"name": "Wall", "occlusionTexture": {"index": 0, "strength": 0.5}}]);
    builder.doc["textures"] = json!([{"source": 0}]);
    builder.doc["images"] = json!([{"uri": "data:image/png;base64,AAAA"}]);
    builder.doc["meshes"][0]["primitives"][0]["material"] = 0.into();
    let error = refusal(&builder, Form::Texture);
    assert!(
        error.contains("material 0 (Wall) has an occlusion texture") && error.contains("--replace"),
        "{error}"
    );
    let file = GltfFile::from_bytes(builder.gltf()).unwrap();
    assert_eq!(file.check(None, &OcclusionOptions::new(Form::Color)), Ok(()));
    let options = OcclusionOptions::new(Form::Texture).replacing(true);
    let written = add(&builder.gltf(), &[[0; 3]; 2], &[0.5], &options);
    let back = Back::of(&written.bytes);
    assert_eq!(
        back.doc["materials"],
        json!([{"name": "Wall", "occlusionTexture": {"index": 1, "texCoord": 0}}])
    );

    // An attribute likewise.
    let once = add(&builder.gltf(), &[[0; 3]; 2], &[0.5], &OcclusionOptions::new(Form::Attribute)).bytes;
    let file = GltfFile::from_bytes(once.clone()).unwrap();
    let error = file.check(None, &OcclusionOptions::new(Form::Attribute)).unwrap_err().to_string();
    assert!(error.contains("_OCCLUSION already"), "{error}");
    let options = OcclusionOptions::new(Form::Attribute).replacing(true);
    let twice = Back::of(&add(&once, &[[0; 3]; 2], &[0.25], &options).bytes);
    assert_eq!(twice.corners(0, 0, "attributes/_OCCLUSION")[1][2], [0.25]);
}

#[test]
fn occlusion_material_that_others_show_is_copied_and_variants_get_theirs() {
    let mut builder = Builder::square();
    let primitive = builder.doc["meshes"][0]["primitives"][0].clone();
    let uv = builder.accessor(5126, "VEC2", 4, &f32s(&[0.0; 8]));
    let with = |key: &str, value: Value| {
        let mut primitive = primitive.clone();
        *primitive.pointer_mut(key).unwrap() = value;
        primitive
    };
    let mut uv_too = with("/mode", 4.into());
    uv_too["attributes"]["TEXCOORD_0"] = uv.into();
    uv_too["material"] = 0.into();
    let mut plain = primitive.clone();
    plain["material"] = 0.into();
    let mut variant = primitive.clone();
    variant["material"] = 1.into();
    variant["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": 2, "variants": [0]}]}});
    // A mesh that the scene does not show has the material 1 too.
    let mut elsewhere = primitive.clone();
    elsewhere["material"] = 1.into();
    builder.doc["meshes"] =
        json!([{"primitives": [plain, uv_too, variant, primitive]}, {"primitives": [elsewhere]}]);
    builder.doc["materials"] =
        json!([{"name": "a"}, {"name": "b", "extensions": {"KHR_materials_unlit": {}}}, {"name": "c"}]);
    let written = add(&builder.gltf(), &[[0; 3]; 8], &[0.5], &OcclusionOptions::new(Form::Texture));
    let back = Back::of(&written.bytes);
    let of = |primitive: &Value| {
        let material = &back.doc["materials"][primitive["material"].as_u64().unwrap() as usize];
        (material["name"].as_str().unwrap_or("").to_owned(), material["occlusionTexture"]["texCoord"].clone())
    };
    let primitives: Vec<_> = back.doc["meshes"][0]["primitives"].as_array().unwrap().iter().map(of).collect();
    let wanted = [("a", 0), ("a", 1), ("b", 0), ("", 0)].map(|(name, set)| (name.to_owned(), json!(set)));
    assert_eq!(primitives, wanted);
    let mapping = &back.primitive(0, 2)["extensions"]["KHR_materials_variants"]["mappings"][0];
    assert_eq!(of(mapping), ("c".to_owned(), json!(0)));
    assert_eq!(back.primitive(1, 0)["material"], 1);
    assert_eq!(back.doc["materials"][1], builder.doc["materials"][1], "what is not shown stays");
    assert_eq!(back.doc["materials"].as_array().unwrap().len(), 6);
    assert!(written.notes.iter().any(|note| note.starts_with("1 unlit")), "{:?}", written.notes);
}

#[test]
fn occlusion_takes_buffers_and_images_beside_the_file_into_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = rich();
    builder.doc["images"] =
        json!([{"uri": "a%20b.png"}, {"uri": "gone.png"}, {"uri": "../out.png"}, {"uri": "x.dat"}]);
    builder.doc["buffers"] = json!([
        {"byteLength": builder.bin.len(), "uri": "all.bin", "name": "kept"},
        {"byteLength": 8, "uri": "more.bin"},
        {"byteLength": builder.bin.len(), "uri": "all.bin"}
    ]);
    let list = builder.doc["bufferViews"].as_array_mut().unwrap();
    list[2]["buffer"] = 2.into();
    list.push(json!({"buffer": 1, "byteOffset": 4, "byteLength": 4}));
    let png = b"\x89PNG\r\n\x1a\n".to_vec();
    let json = serde_json::to_vec(&builder.doc).unwrap();
    for (name, bytes) in [
        ("a.gltf", &json),
        ("all.bin", &builder.bin),
        ("more.bin", &b"12345678".to_vec()),
        ("a b.png", &png),
        ("x.dat", &png),
    ] {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let path = folder.path().join("a.gltf");
    let scene = umbrage::read::read(&path).unwrap().bake(Scope::Mesh).unwrap();
    let (corners, openness) = different(scene.iter().map(|mesh| mesh.face_count()).sum());
    let occlusion = Occlusion { corners: &corners, openness: &openness, bent: None };
    let file = GltfFile::open(&path).unwrap();
    let written = file.with_occlusion(None, &occlusion, &OcclusionOptions::new(Form::Texture)).unwrap();
    assert_eq!(world(&written.bytes), world(&rich().glb()));
    let back = Back::of(&written.bytes);
    assert_eq!(back.doc["buffers"].as_array().unwrap().len(), 1);
    assert_eq!((&back.doc["buffers"][0]["name"], back.doc["buffers"][0].get("uri")), (&json!("kept"), None));
    let last = builder.doc["bufferViews"].as_array().unwrap().len() - 1;
    assert_eq!(back.view(last), b"5678");
    for (image, bytes) in [(0, Some(&png)), (1, None), (2, None), (3, Some(&png))] {
        let found = back.doc["images"][image]["bufferView"].as_u64().map(|view| back.view(view as usize));
        assert_eq!(found, bytes.map(Vec::as_slice), "{image}");
    }
    let left = written.notes.iter().filter(|note| note.contains("still named by its path")).count();
    assert_eq!(left, 2, "{:?}", written.notes);
}

#[test]
fn occlusion_splits_vertices_of_compressed_views() {
    let mesh = umbrage::testing::shapes::icosphere(1);
    let builder = meshopt::document(&mesh, 2, "TRIANGLES");
    let (corners, openness) = different(mesh.face_count());
    let written = add(&builder.gltf(), &corners, &openness, &OcclusionOptions::new(Form::Attribute));
    assert_eq!(world(&written.bytes), world(&builder.gltf()));
    let back = Back::of(&written.bytes);
    let values = back.corners(0, 0, "attributes/_OCCLUSION");
    for (face, wanted) in values.iter().zip(&corners) {
        assert_eq!(
            face.clone().map(|corner| corner[0] as f32),
            wanted.map(|corner| openness[corner as usize])
        );
    }
    // The buffer that stands in for compressed data is still one without bytes.
    assert_eq!(back.doc["buffers"].as_array().unwrap().len(), 2);
    assert!(back.doc["buffers"][1].get("uri").is_none());
}

#[test]
fn occlusion_of_a_document_with_any_value_replaced_or_removed_never_panics() {
    let builder = defective();
    let mut all = Vec::new();
    pointers(&builder.doc, String::new(), &mut all);
    let mut added = 0;
    for pointer in all.iter().filter(|pointer| !pointer.is_empty()) {
        for junk in [json!(null), json!(-1), json!(7), json!("x"), json!([0]), json!({})] {
            let mut doc = builder.doc.clone();
            *doc.pointer_mut(pointer).unwrap() = junk;
            let bytes = serde_json::to_vec(&doc).unwrap();
            let Ok(scene) = umbrage::read::read_bytes(&bytes, "a.gltf") else { continue };
            let Ok(meshes) = scene.bake(Scope::Mesh) else { continue };
            let faces = meshes.iter().map(|mesh| mesh.face_count()).sum();
            let (corners, openness) = different(faces);
            let occlusion = Occlusion { corners: &corners, openness: &openness, bent: None };
            let file = GltfFile::from_bytes(bytes).unwrap();
            for form in FORMS {
                match file.with_occlusion(None, &occlusion, &OcclusionOptions::new(form)) {
                    Ok(written) => {
                        let back = umbrage::read::read_bytes(&written.bytes, "a.glb");
                        let back = back.unwrap_or_else(|error| panic!("{pointer}: {error}"));
                        let back = back.bake(Scope::Mesh).unwrap();
                        let count = back.iter().map(|mesh| mesh.face_count()).sum::<usize>();
                        assert_eq!(count, faces, "{pointer}");
                        added += 1;
                    }
                    Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
                }
            }
        }
    }
    assert!(added > 300, "{added}");
}
