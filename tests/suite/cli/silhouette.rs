//! `umbrage silhouette`.

use serde_json::Value;
use umbrage::testing::shapes;

use super::{Folder, assert_shape, keys, real};

const LIGHT_KEYS: &str = "light name faces front_faces edge_on_faces edges silhouette_edges outline_edges \
    max_multiplicity loops method reason unsure_faces";

#[test]
fn silhouette_json_has_the_agreed_keys_in_order() {
    let folder = Folder::with_cubes();
    let document = folder.json("silhouette cube.obj --light point:2,3,5");
    assert_eq!(keys(&document), "file format lights");
    assert_eq!(keys(&document["lights"][0]), LIGHT_KEYS);
    assert_shape("silhouette", &document);
}

#[test]
fn silhouette_of_a_cube_along_its_diagonal_is_a_hexagon() {
    let folder = Folder::with_cubes();
    let document = folder.json("silhouette cube.obj --light directional:-1,-1,-1 --light directional:0,-1,0");
    let [diagonal, axis] = [&document["lights"][0], &document["lights"][1]];
    for (key, value) in [
        ("faces", 12),
        ("front_faces", 6),
        ("edge_on_faces", 0),
        ("edges", 18),
        ("silhouette_edges", 6),
        ("outline_edges", 6),
        ("max_multiplicity", 2),
        ("loops", 1),
        ("unsure_faces", 0),
    ] {
        assert_eq!(diagonal[key], value, "{key}");
    }
    assert_eq!((&diagonal["light"], &diagonal["method"]), (&"directional:-1,-1,-1".into(), &"scan".into()));
    // Four sides are edge-on: the top and the bottom each keep their outline.
    assert_eq!((&axis["front_faces"], &axis["edge_on_faces"]), (&2.into(), &8.into()));
    assert_eq!(
        (&axis["silhouette_edges"], &axis["outline_edges"], &axis["loops"]),
        (&8.into(), &4.into(), &2.into())
    );
}

#[test]
fn silhouette_without_a_light_says_which_it_takes() {
    let folder = Folder::with_cubes();
    let run = folder.run("silhouette cube.obj --json");
    let document: Value = serde_json::from_str(&run.stdout).unwrap();
    let light = document["lights"][0]["light"].as_str().unwrap();
    assert!(light.starts_with("point:") && run.stderr.contains(light), "{light}: {}", run.stderr);
    assert_eq!(folder.run("silhouette cube.obj --light point:1,2,3").stderr, "");
}

#[test]
fn silhouette_takes_the_lights_of_the_file() {
    let Some(file) = real("sphere_lights.glb") else { return };
    let document = Folder::new().json(&format!("silhouette {}", file.display()));
    let lights = document["lights"].as_array().unwrap();
    let is = |kind| lights.iter().filter(|light| light["light"].as_str().unwrap().starts_with(kind)).count();
    assert_eq!((is("directional:"), is("point:")), (1, 3), "spot lights are point lights");
    assert_eq!((&lights[0]["name"], &lights[1]["name"]), (&"Blue Lightsaber".into(), &"Arc Reactor".into()));
}

#[test]
fn silhouette_output_holds_the_edges_as_lines() {
    let folder = Folder::with_cubes();
    for name in ["a.obj", "a.ply", "a.glb"] {
        assert_eq!(
            folder.code(&format!("silhouette cube.obj --light directional:-1,-1,-1 -o {name}")),
            0,
            "{name}"
        );
    }
    let text = std::fs::read_to_string(folder.path("a.obj")).unwrap();
    let count = |letter: &str| text.lines().filter(|line| line.split(' ').next() == Some(letter)).count();
    assert_eq!((count("v"), count("l"), count("f")), (6, 6, 0), "{text}");
}

#[test]
fn silhouette_of_meshes_that_touch_keeps_them_apart() {
    // Two cubes in one file that share a face: as one mesh they are welded together, as two meshes they are
    // not.
    let folder = Folder::new();
    let right = shapes::cuboid([1.0, -1.0, -1.0], [3.0, 1.0, 1.0]);
    let both = umbrage::mesh::Mesh::concat(&[shapes::cube(), right]).unwrap();
    folder.mesh("both.obj", &both);
    let edges = |scope: &str| {
        folder.json(&format!("silhouette both.obj --light point:9,8,7{scope}"))["lights"][0]["edges"].clone()
    };
    assert_eq!(edges(" --scope primitive"), 36);
    assert!(edges("").as_u64().unwrap() < 36);
}

#[test]
fn silhouette_of_the_tree_is_that_of_the_scan() {
    let folder = Folder::with_cubes();
    folder.mesh("sponge.obj", &shapes::menger_sponge(2));
    for file in ["cube.obj", "sponge.obj"] {
        for light in ["point:2,3,5", "directional:0,-1,0", "directional:-1,-1,-1"] {
            let of = |method: &str| {
                let document = folder.json(&format!("silhouette {file} --light {light} --method {method}"));
                let mut found = document["lights"][0].as_object().unwrap().clone();
                let [said, reason, _] =
                    ["method", "reason", "unsure_faces"].map(|key| found.remove(key).unwrap());
                assert_eq!((said, reason), (method.into(), "asked for".into()));
                found
            };
            assert_eq!(of("tree"), of("scan"), "{file} {light}");
        }
    }
}

#[test]
fn silhouette_auto_scans_for_few_lights_and_searches_a_tree_for_many() {
    let folder = Folder::new();
    folder.mesh("sphere.obj", &shapes::icosphere(3));
    let of = |lights: &str| {
        let light = &folder.json(&format!("silhouette sphere.obj{lights}"))["lights"][0];
        (
            light["method"].clone(),
            light["reason"].as_str().unwrap().to_owned(),
            light["silhouette_edges"].clone(),
        )
    };
    let one = of(" --light point:3,4,5");
    let many = of(&" --light point:3,4,5".repeat(300));
    assert_eq!((&one.0, &many.0, &one.2), (&"scan".into(), &"tree".into(), &many.2));
    assert!(one.1.contains("one look a light") && many.1.contains("many lights"), "{} / {}", one.1, many.1);
}

#[test]
fn silhouette_adapter_without_the_method_that_uses_it_is_said_to_be_unused() {
    let run = Folder::with_cubes().run("silhouette cube.obj --light point:1,2,3 --adapter llvmpipe");
    assert_eq!(run.code, 0);
    assert!(run.stderr.contains("--adapter llvmpipe is not used") && run.stderr.contains("--method gpu"));
}

#[cfg(feature = "gpu")]
#[test]
fn silhouette_of_the_device_is_that_of_the_scan_and_says_what_it_left_over() {
    let Some(gpu) = crate::support::gpu() else { return };
    let folder = Folder::with_cubes();
    for light in ["point:2,3,5", "directional:0,-1,0", "directional:-1,-1,-1"] {
        let of = |method: &str| {
            let document = folder.json(&format!("silhouette cube.obj --light {light} --method {method}"));
            let mut found = document["lights"][0].as_object().unwrap().clone();
            let [said, reason, unsure] =
                ["method", "reason", "unsure_faces"].map(|key| found.remove(key).unwrap());
            assert_eq!(said, method);
            (found, reason.as_str().unwrap().to_owned(), unsure.as_u64().unwrap())
        };
        let ((device, reason, unsure), (scan, ..)) = (of("gpu"), of("scan"));
        assert_eq!(device, scan);
        assert!(reason.contains(&gpu.name()), "{reason}");
        // Four sides of the cube are exactly edge-on for a light along an axis: eight faces.
        let edge_on = device["edge_on_faces"].as_u64().unwrap();
        assert!(unsure == edge_on, "{light}: {unsure} unsure, {edge_on} edge-on");
    }
}

#[cfg(feature = "gpu")]
#[test]
fn silhouette_adapter_that_is_not_there_is_refused_with_those_that_are() {
    let Some(gpu) = crate::support::gpu() else { return };
    let run = Folder::with_cubes().run("silhouette cube.obj --method gpu --adapter nosuchcard");
    assert_eq!((run.code, run.stdout.as_str(), run.stderr.lines().count()), (2, "", 1), "{}", run.stderr);
    assert!(run.stderr.contains("nosuchcard") && run.stderr.contains("choose one of: "), "{}", run.stderr);
    let name = gpu.name();
    assert!(run.stderr.contains(name.split(',').next().unwrap()), "{}", run.stderr);
}

#[cfg(not(feature = "gpu"))]
#[test]
fn silhouette_of_the_device_is_refused_where_there_are_no_graphics() {
    let run = Folder::with_cubes().run("silhouette cube.obj --method gpu");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains("--method gpu: this build has no graphics; "), "{}", run.stderr);
}

/// How many pixels of a picture have such a color.
pub(super) fn pixels_of(folder: &Folder, name: &str, is_such: impl Fn([u8; 3]) -> bool) -> usize {
    let (.., bytes) = super::render::png(folder, name);
    bytes.chunks(4).filter(|pixel| is_such([pixel[0], pixel[1], pixel[2]])).count()
}

#[test]
fn silhouette_picture_has_the_edges_and_a_legend_below() {
    let folder = Folder::with_cubes();
    let run = folder
        .run("silhouette cube.obj --light point:2,3,5 --light point:-5,3,2 --picture a.png --size 320x240");
    assert!(run.code == 0 && run.stderr.contains("wrote a.png") && run.stderr.contains("wrote a-2.png"));
    let edge = |[r, g, b]: [u8; 3]| r > 200 && (40..90).contains(&g) && b < 30;
    for name in ["a.png", "a-2.png"] {
        let (width, height, _) = super::render::png(&folder, name);
        assert!(width == 320 && height > 260, "{width} {height}");
        assert!(pixels_of(&folder, name, edge) > 400);
    }
    // The same twice; another light is another picture.
    folder.run("silhouette cube.obj --light point:2,3,5 --picture b.png --size 320x240");
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(bytes("a.png") == bytes("b.png") && bytes("a.png") != bytes("a-2.png"));
    for (arguments, named) in [
        ("silhouette cube.obj --eye 1,2,3 --target 0,0,0", "add --picture"),
        ("silhouette cube.obj --picture a.jpg", "name a file that ends in .png"),
        ("silhouette cube.obj --picture nowhere/a.png", "nowhere"),
        ("silhouette cube.obj --picture a.png --size 0x5", "0x5"),
        ("volume cube.obj --picture a.jpg", "name a file that ends in .png"),
    ] {
        let run = folder.run(arguments);
        assert!(run.code == 2 && run.stderr.contains(named), "{arguments}: {}", run.stderr);
    }
}
