//! Small files with one property each, as other programs met them.

use std::path::Path;

use umbrage::read::read;
use umbrage::scene::{AlphaMode, Scene};
use umbrage::view::Lens;

use crate::support::reports;

fn scene(folder: &Path, name: &str) -> Scene {
    read(folder.join(name)).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn gltf_reported_slips_are_read_with_a_note() {
    let Some(folder) = reports() else { return };
    for (name, faces, note) in [
        ("g_root_has_parent.gltf", 4, "root with a parent outside the scene"),
        ("g_nulpad0.glb", 4, "padded with zero bytes"),
        ("ge_EXT_mesh_features.gltf", 4, "`EXT_mesh_features`"),
        ("ge_KHR_techniques_webgl.gltf", 4, "`KHR_techniques_webgl`"),
        ("percent_name.gltf", 12, "`50%.bin`"),
        ("camera_yfov_3.2.gltf", 12, "camera left out: its yfov is 3.2"),
        ("hidden_node.gltf", 2, "hidden node (KHR_node_visibility) left out"),
    ] {
        let scene = scene(&folder, name);
        let faces_read: usize =
            scene.instances.iter().map(|instance| scene.meshes[instance.mesh].face_count()).sum();
        assert_eq!(faces_read, faces, "{name}");
        assert!(scene.notes.iter().any(|line| line.contains(note)), "{name}: {:?}", scene.notes);
    }
}

#[test]
fn gltf_reported_features_are_obeyed() {
    let Some(folder) = reports() else { return };
    for (name, instances) in [("g_instancing_used.gltf", 3), ("gpu_instances.gltf", 36)] {
        assert_eq!(scene(&folder, name).instances.len(), instances, "{name}");
    }
    let modes: Vec<AlphaMode> =
        scene(&folder, "alpha_modes.gltf").materials.iter().map(|material| material.alpha_mode).collect();
    assert!(modes.contains(&AlphaMode::Mask) && modes.contains(&AlphaMode::Blend), "{modes:?}");
    assert_eq!(scene(&folder, "light_range.gltf").lamps[0].range, Some(3.0));
    let camera = scene(&folder, "ortho_only.gltf").cameras[0].camera;
    assert_eq!((camera.lens, camera.near), (Lens::Orthographic { height: 6.0 }, Some(0.1)));
    assert_eq!(scene(&folder, "big_terrain_camera.gltf").cameras[0].camera.near, Some(0.05));
}
