//! `umbrage volume`.

use serde_json::Value;
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

use super::{Folder, assert_shape, keys};

const LIGHT_KEYS: &str =
    "light name variant vertices triangles light_cap sides dark_cap closed covers infinite";

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
        let said = "light 0, written: holds every shadowed point within 50 mesh units of the mesh";
        assert!(run.stdout.contains(said), "{}", run.stdout);
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
    assert!(run("--far 3e38 -o a.glb").contains("not 3e38: farther vertices would leave the range of f32"));
    assert!(!run("--far 50 -o a.glb").contains("note"));
    let covers = |more: &str| {
        let light = folder.json(&format!("volume cube.obj --light point:2,3,5 {more}"))["lights"][0].clone();
        (light["covers"].clone(), light["infinite"].clone())
    };
    assert_eq!(covers("--far 50 -o a.glb"), (50.0.into(), false.into()));
    assert_eq!(covers("--far infinity -o a.glb"), (Value::Null, true.into()));
    assert_eq!(covers("--faces auto"), (Value::Null, Value::Null));
    assert!(run("--far infinity -o a.obj").contains("OBJ has no vertex at infinity"));
    assert_eq!(folder.code("volume cube.obj --far infinity -o a.obj"), 2);
    assert_eq!(folder.code("volume cube.obj --far -1 -o a.ply"), 2);
}

#[test]
fn volume_layers_have_only_the_vertices_they_use() {
    let folder = Folder::with_cubes();
    folder.run("volume cube.obj --light point:2,3,5 -o a.obj");
    let text = std::fs::read_to_string(folder.path("a.obj")).unwrap();
    assert_eq!(text.lines().filter(|line| line.starts_with("v ")).count(), 7 + 12 + 7);
}

/// The vertices x, y, z, w of a PLY file of the volume alone.
fn homogeneous(bytes: &[u8]) -> Vec<[f32; 4]> {
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    let count = header.lines().find_map(|line| line.strip_prefix("element vertex ")).unwrap();
    // Position, color, w.
    let vertex = |at: &[u8]| {
        let number = |from: usize| f32::from_le_bytes(at[from..from + 4].try_into().unwrap());
        [number(0), number(4), number(8), number(16)]
    };
    bytes[end..].chunks(20).take(count.parse().unwrap()).map(vertex).collect()
}

#[test]
fn volume_at_infinity_has_homogeneous_vertices() {
    let folder = Folder::new();
    folder.mesh("far.obj", &shapes::translated(&shapes::cube(), [1000.0, 0.0, 0.0]));
    folder.mesh("slab.obj", &shapes::cuboid([-5.0, -0.25, -5.0], [5.0, 0.25, 5.0]));
    for (file, light, at) in [
        ("far.obj", "point:1002,3,5", Some([1002.0, 3.0, 5.0])),
        ("slab.obj", "point:0.5,0.75,0.25", Some([0.5, 0.75, 0.25])),
        ("slab.obj", "directional:0.5,-1,0.25", None),
    ] {
        folder.run(&format!("volume {file} --light {light} --far infinity -o a.ply"));
        let vertices = homogeneous(&std::fs::read(folder.path("a.ply")).unwrap());
        let (far, near): (Vec<_>, Vec<_>) = vertices.into_iter().partition(|vertex| vertex[3] == 0.0);
        assert!(!far.is_empty() && near.iter().all(|vertex| vertex[3] == 1.0), "{light}");
        for [x, y, z, _] in far {
            let right = match at {
                None => [x, y, z] == [0.5, -1.0, 0.25],
                Some([lx, ly, lz]) => near.contains(&[x + lx, y + ly, z + lz, 1.0]),
            };
            assert!(right, "{file} {light}: {x},{y},{z}");
        }
        // A volume with an end has no such vertex, and no w.
        folder.run(&format!("volume {file} --light {light} -o a.ply"));
        let text = std::fs::read(folder.path("a.ply")).unwrap();
        assert!(!String::from_utf8_lossy(&text).contains("property float w"), "{light}");
    }
}

#[test]
fn volume_glb_carries_w_at_infinity() {
    let folder = Folder::with_cubes();
    let text = |more: &str| {
        folder.run(&format!("volume cube.obj --light point:2,3,5 --light point:-9,1,1 -o a.glb {more}"));
        String::from_utf8_lossy(&std::fs::read(folder.path("a.glb")).unwrap()).into_owned()
    };
    for word in ["\"_W\"", "\"light_cap\"", "\"sides\"", "\"dark_cap\"", "\"light_cap 1\""] {
        assert!(text("--far infinity").contains(word), "{word}");
        assert_eq!(text("--far 9").contains(word), word != "\"_W\"", "{word}");
    }
}

#[test]
fn volume_of_a_spot_light_is_named_one() {
    let folder = Folder::with_cubes();
    let run = folder.run("volume cube.obj --light spot:2,3,5:-2,-3,-5:30");
    assert!(run.stdout.contains("0 spot:2,3,5 ") && !run.stdout.contains("point:"), "{}", run.stdout);
}

#[test]
fn volume_picture_has_translucent_sides_that_a_volume_without_sides_lacks() {
    let folder = Folder::with_cubes();
    let blue = |[r, g, b]: [u8; 3]| b > 150 && r < 170 && u32::from(b) > u32::from(r) + 40 && g < 190;
    let view = "--eye 6,4,9 --target 0,-2,0 --size 200x150";
    let drawn = |options: &str| {
        let run = folder.run(&format!("volume cube.obj {options} --picture a.png {view}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        super::silhouette::pixels_of(&folder, "a.png", blue)
    };
    let sides = drawn("--light directional:0.3,-1,0.2");
    assert!(sides > 1000, "{sides}");
    let spread = drawn("--light point:0.5,3,1");
    assert!(spread > 1000, "{spread}");
    // Fault injected: a light behind which there is nothing to see but the cube itself.
    let behind = drawn("--light directional:-6,-4,-9");
    assert!(behind < sides / 2, "{behind}");
}
