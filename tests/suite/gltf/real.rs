//! Real files against their measured facts.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use umbrage::read::read;
use umbrage::scene::Scope;

fn meshes_folder() -> Option<PathBuf> {
    let beside = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/meshes"));
    let folder = std::env::var_os("UMBRAGE_MESHES").map_or_else(|| beside.to_owned(), PathBuf::from);
    if folder.join("facts.csv").is_file() {
        return Some(folder);
    }
    eprintln!("SKIPPED: no real meshes at {}; set UMBRAGE_MESHES", folder.display());
    None
}

/// The rows of a CSV by column name; a field in quotes may hold commas.
fn rows(csv: &str) -> Vec<HashMap<String, String>> {
    let fields = |line: &str| -> Vec<String> {
        let mut fields = vec![String::new()];
        let mut quoted = false;
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => fields.push(String::new()),
                _ => fields.last_mut().unwrap().push(c),
            }
        }
        fields
    };
    let mut lines = csv.lines();
    let header = fields(lines.next().unwrap());
    lines.map(|line| header.iter().cloned().zip(fields(line)).collect()).collect()
}

#[test]
fn gltf_real_files_match_their_facts() {
    let Some(folder) = meshes_folder() else { return };
    let mut files = 0;
    for row in rows(&fs::read_to_string(folder.join("facts.csv")).unwrap()) {
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
            .lights
            .iter()
            .map(|light| match (light.light.is_directional(), light.spot) {
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
