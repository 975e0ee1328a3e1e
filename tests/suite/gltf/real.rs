//! Real files against their measured facts.

use umbrage::read::read;
use umbrage::scene::Scope;

use crate::support::{facts, real_meshes};

#[test]
fn gltf_real_files_match_their_facts() {
    let Some(folder) = real_meshes() else { return };
    let mut files = 0;
    for row in facts(&folder) {
        if !matches!(row["format"].as_str(), "gltf" | "glb") {
            continue;
        }
        files += 1;
        let name = &row["name"];
        let scene = read(folder.join(name)).unwrap_or_else(|error| panic!("{error}"));
        let number = |column: &str| row[column].parse::<usize>().unwrap();
        assert_eq!(scene.format.unwrap().name(), row["format"]);
        assert_eq!(scene.meshes.len(), number("gltf_meshes"), "{name}: meshes");
        assert_eq!(scene.instances.len(), number("gltf_instances"), "{name}: instances");
        let mirrored = scene.instances.iter().filter(|i| i.world_from_mesh.determinant() < 0.0).count();
        assert_eq!(mirrored, number("gltf_mirrored_instances"), "{name}: mirrored");
        let parts: usize = scene.meshes.iter().map(|mesh| mesh.parts().len()).sum();
        assert_eq!(parts, number("gltf_primitives"), "{name}: primitives");
        let frames = scene.meshes.iter().map(|mesh| mesh.frames().len()).max().unwrap_or(0);
        assert_eq!(frames, row["gltf_morph_targets"].parse().unwrap_or(0), "{name}: morph targets");
        let mut lights: Vec<&str> = scene
            .lamps
            .iter()
            .map(|lamp| match (lamp.light().is_directional(), lamp.cone) {
                (true, _) => "directional",
                (false, None) => "point",
                (false, Some(_)) => "spot",
            })
            .collect();
        lights.sort_unstable();
        assert_eq!(lights.join(","), row["gltf_lights"], "{name}: lights");

        let baked = scene.bake(Scope::Mesh).unwrap();
        let sum = |count: fn(&umbrage::mesh::Mesh) -> usize| baked.iter().map(count).sum::<usize>();
        assert_eq!(sum(|mesh| mesh.vertex_count()), number("vertices"), "{name}: vertices");
        assert_eq!(sum(|mesh| mesh.face_count()), number("triangles"), "{name}: triangles");
        let unreferenced = sum(|mesh| {
            let mut used = vec![false; mesh.vertex_count()];
            mesh.triangles().iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
            used.iter().filter(|&&used| !used).count()
        });
        assert_eq!(unreferenced, number("unreferenced_vertices"), "{name}: unreferenced vertices");
    }
    assert!(files >= 10, "only {files} files");
}
