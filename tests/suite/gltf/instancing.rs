//! EXT_mesh_gpu_instancing: one node, many instances.

use glam::{Mat4, Quat, Vec3};
use serde_json::json;
use umbrage::scene::Scope;

use super::{Builder, f32s};

/// A square whose node is instanced with these attributes.
pub(super) fn instanced(attributes: serde_json::Value, mut builder: Builder) -> Builder {
    builder.doc["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    builder.doc["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    builder
}

fn vectors<const N: usize>(builder: &mut Builder, list: &[[f32; N]]) -> usize {
    builder.accessor(5126, &format!("VEC{N}"), list.len(), &f32s(list.as_flattened()))
}

#[test]
fn instancing_places_the_mesh_below_its_node() {
    let mut builder = Builder::square();
    let translations = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, -3.0]];
    let turn = Quat::from_rotation_z(1.0);
    let rotations = [Quat::IDENTITY.to_array(), turn.to_array(), (turn * turn).to_array()];
    let scales = [[1.0; 3], [2.0, 1.0, 1.0], [1.0, -1.0, 3.0]];
    let [t, r, s] = [
        vectors(&mut builder, &translations),
        vectors(&mut builder, &rotations),
        vectors(&mut builder, &scales),
    ];
    let mut builder = instanced(json!({"TRANSLATION": t, "ROTATION": r, "SCALE": s, "_ID": 0}), builder);
    builder.doc["nodes"][0]["name"] = "tree".into();
    builder.doc["nodes"][0]["translation"] = json!([10, 0, 0]);
    builder.doc["nodes"][0]["scale"] = json!([2, 2, 2]);
    let scene = builder.read();
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    let names: Vec<&str> = scene.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!((names, scene.meshes.len()), (vec!["tree [0]", "tree [1]", "tree [2]"], 1));
    let node = Mat4::from_scale_rotation_translation(Vec3::splat(2.0), Quat::IDENTITY, Vec3::X * 10.0);
    for (index, instance) in scene.instances.iter().enumerate() {
        let own = Mat4::from_scale_rotation_translation(
            scales[index].into(),
            Quat::from_array(rotations[index]),
            translations[index].into(),
        );
        assert!(instance.world_from_mesh.abs_diff_eq(node * own, 1e-5), "instance {index}");
    }
    assert_eq!(scene.bake(Scope::Mesh).unwrap().len(), 3);
    // Each attribute alone; what is absent is the identity.
    for (attributes, last) in [
        (json!({"TRANSLATION": t}), Mat4::from_translation(translations[2].into())),
        (json!({"ROTATION": r}), Mat4::from_quat(turn * turn)),
        (json!({"SCALE": s}), Mat4::from_scale(scales[2].into())),
    ] {
        let builder = instanced(attributes, Builder { doc: builder.doc.clone(), bin: builder.bin.clone() });
        let scene = builder.read();
        assert_eq!(scene.instances.len(), 3);
        assert!(scene.instances[2].world_from_mesh.abs_diff_eq(node * last, 1e-5));
    }
}

#[test]
fn instancing_reads_rotations_as_small_integers() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let quarter = Mat4::from_quat(Quat::from_xyzw(0.0, half, 0.0, half));
    for (component, size, bytes) in [
        (5120, 1, [0_i16, 90, 0, 90].map(|x| [x as u8, 0])),
        (5122, 2, [0, 23170, 0, 23170].map(i16::to_le_bytes)),
    ] {
        let mut builder = Builder::square();
        let bytes: Vec<u8> = bytes.iter().flat_map(|bytes| bytes[..size].to_vec()).collect();
        let accessor = builder.accessor(component, "VEC4", 1, &bytes);
        builder.doc["accessors"][accessor]["normalized"] = true.into();
        let scene = instanced(json!({ "ROTATION": accessor }), builder).read();
        assert!(scene.notes.is_empty() && scene.instances.len() == 1);
        assert!(scene.instances[0].world_from_mesh.abs_diff_eq(quarter, 1e-6), "{component}");
    }
}

#[test]
fn instancing_that_is_malformed_is_refused_or_noted() {
    let three = [[1.0; 3]; 3];
    let build = |attributes: &dyn Fn(&mut Builder) -> serde_json::Value| {
        let mut builder = Builder::square();
        let attributes = attributes(&mut builder);
        instanced(attributes, builder)
    };
    let place = "node 0, EXT_mesh_gpu_instancing, attributes (gltf): ";
    type Attributes<'a> = &'a dyn Fn(&mut Builder) -> serde_json::Value;
    let cases: [(Attributes, String); 4] = [
        (
            &|b| json!({"TRANSLATION": vectors(b, &three), "SCALE": vectors(b, &three[..2])}),
            format!("{place}has 3 and 2 transforms, but must have as many of each"),
        ),
        (
            &|b| json!({"ROTATION": vectors(b, &[[0.0; 4]])}),
            format!("{place}instance 0 has a rotation of length zero"),
        ),
        (
            &|b| json!({"TRANSLATION": vectors(b, &[[0.0; 4]])}),
            "is of type VEC4, but a translation is a VEC3".to_owned(),
        ),
        (&|_| json!({"TRANSLATION": 99}), format!("{place}names accessor 99, but there are")),
    ];
    for (attributes, wanted) in cases {
        let message = build(attributes).refusal();
        assert!(message.contains(&wanted), "{message} / {wanted}");
    }
    let mut far = build(&|b| json!({"TRANSLATION": vectors(b, &[[0.0; 3], [3e38, 0.0, 0.0]])}));
    far.doc["nodes"][0]["scale"] = json!([2, 2, 2]);
    assert!(far.refusal().contains(&format!("{place}instance 1 stands beyond the range of 32-bit floats")));
    let scene = build(&|_| json!({"_ID": 0})).read();
    assert_eq!(
        (scene.instances.len(), scene.notes[0].as_str()),
        (1, "node 0: instancing without transforms read as a single instance")
    );
}

#[test]
fn instancing_is_bounded_by_the_file() {
    // Four million transforms without data: each would be an instance of a hundred bytes.
    let build = |count: usize| {
        let mut builder = Builder::square();
        let accessor = builder.positions(&[[0.0; 3]]);
        let object = builder.doc["accessors"][accessor].as_object_mut().unwrap();
        object.remove("bufferView");
        object.insert("count".to_owned(), count.into());
        instanced(json!({"TRANSLATION": accessor}), builder)
    };
    let message = build(4_000_000).refusal();
    assert!(message.contains("node 0, EXT_mesh_gpu_instancing, attributes (gltf): asks for "), "{message}");
    assert_eq!(build(100_000).read().instances.len(), 100_000);
}
