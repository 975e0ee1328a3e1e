//! `umbrage volume`.

use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

use super::{Folder, assert_shape, keys};

const LIGHT_KEYS: &str = "light name variant vertices triangles light_cap sides dark_cap closed";

#[test]
fn volume_json_has_the_agreed_keys_in_order() {
    let folder = Folder::with_cubes();
    let document = folder.json("volume cube.obj --light point:2,3,5");
    assert_eq!(keys(&document), "file format lights");
    assert_eq!(keys(&document["lights"][0]), LIGHT_KEYS);
    assert_eq!(keys(&document["lights"][0]["variant"][0]), "shell variant reason");
    assert_shape("volume", &document);
}

#[test]
fn volume_of_a_cube_has_the_counts_of_its_silhouette() {
    let folder = Folder::with_cubes();
    // Variant, light cap, sides, dark cap.
    for (options, variant, counts) in [
        ("", "front", [6, 12, 6]),
        (" --faces all", "general", [12, 24, 12]),
        (" --faces front --caps both", "front", [6, 12, 6]),
        (" --caps none", "front", [0, 12, 0]),
    ] {
        let document = folder.json(&format!("volume cube.obj --light point:2,3,5{options}"));
        let light = &document["lights"][0];
        assert_eq!(light["variant"][0]["variant"], variant, "{options}");
        for (key, count) in ["light_cap", "sides", "dark_cap"].into_iter().zip(counts) {
            assert_eq!(light[key], count, "{options} {key}");
        }
        assert_eq!(light["closed"], counts[0] > 0, "{options}");
        assert_eq!(folder.code(&format!("volume cube.obj --light point:2,3,5{options}")), 0, "{options}");
    }
}

#[test]
fn volume_is_closed_for_every_mesh() {
    let folder = Folder::new();
    let meshes: [(&str, Mesh); 6] = [
        ("open", shapes::open_cube()),
        ("turned", shapes::misoriented_cube()),
        ("touching", shapes::cubes_sharing_edge()),
        ("strip", shapes::mobius(12)),
        ("book", shapes::book(5)),
        ("doubled", shapes::duplicated_face()),
    ];
    for (name, mesh) in meshes {
        let file = format!("{name}.obj");
        folder.mesh(&file, &mesh);
        for light in ["point:2,3,5", "directional:1,-3,2"] {
            let document = folder.json(&format!("volume {file} --light {light}"));
            assert_eq!(document["lights"][0]["closed"], true, "{name} {light}");
            assert_eq!(document["lights"][0]["variant"][0]["variant"], "general", "{name} {light}");
        }
    }
}

#[test]
fn volume_written_is_a_sound_mesh_and_says_how_far_it_reaches() {
    let folder = Folder::with_cubes();
    for name in ["a.glb", "a.obj", "a.ply"] {
        let run = folder.run(&format!("volume cube.obj --light point:2,3,5 --far 50 -o {name}"));
        assert_eq!(run.code, 0);
        assert!(run.stderr.contains("50 mesh units away"), "{}", run.stderr);
        let written = folder.json(&format!("check {name} --scope scene"));
        assert_eq!(
            (&written["verdict"], &written["files"][0]["total"]["faces"]),
            (&"sound".into(), &24.into()),
            "{name}"
        );
    }
    let near =
        folder.json("check a.glb --scope scene")["files"][0]["total"]["signed_volume"].as_f64().unwrap();
    assert_eq!(folder.code("volume cube.obj --light point:2,3,5 --far 90 -o a.glb"), 0);
    let far =
        folder.json("check a.glb --scope scene")["files"][0]["total"]["signed_volume"].as_f64().unwrap();
    assert!(near > 0.0 && far > 2.0 * near, "{near} {far}");
}

#[test]
fn volume_far_is_spoken_of_where_it_does_not_help() {
    let folder = Folder::with_cubes();
    let run = |more: &str| folder.run(&format!("volume cube.obj --light point:2,3,5 {more}")).stderr;
    assert_eq!(run("--far 50"), "umbrage: note: --far has no effect without --output\n");
    assert!(run("--far 0.5 -o a.glb").contains("less than the diagonal of the mesh"));
    assert!(!run("--far 50 -o a.glb").contains("diagonal"));
}

#[test]
fn volume_layers_have_only_the_vertices_they_use() {
    let folder = Folder::with_cubes();
    folder.run("volume cube.obj --light point:2,3,5 -o a.obj");
    let text = std::fs::read_to_string(folder.path("a.obj")).unwrap();
    assert_eq!(text.lines().filter(|line| line.starts_with("v ")).count(), 7 + 12 + 7);
}

#[test]
fn volume_glb_carries_w() {
    let folder = Folder::with_cubes();
    folder.run("volume cube.obj --light point:2,3,5 --light point:-9,1,1 -o a.glb");
    let bytes = std::fs::read(folder.path("a.glb")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for word in ["\"_W\"", "\"light_cap\"", "\"sides\"", "\"dark_cap\"", "\"light_cap 1\""] {
        assert!(text.contains(word), "{word}");
    }
}
