//! `umbrage ambient`, and `umbrage render --ambient`.

use std::fs;

use serde_json::{Value, json};
use umbrage::mesh::Mesh;
use umbrage::read::read;
use umbrage::scene::Scope;
use umbrage::testing::shapes;
use umbrage::write::{Layer, Model, Target, to_bytes};

use super::render::png;
use super::{Folder, keys};

/// A small cube inside a large one, both closed; a ball beside them.
fn nested() -> Mesh {
    let room = shapes::cuboid([-3.0; 3], [3.0; 3]);
    let ball = shapes::translated(&shapes::icosphere(1), [9.0, 0.0, 0.0]);
    Mesh::concat(&[shapes::cube(), room, ball]).unwrap()
}

/// A floor from −4 to 4 with a roof of the same size 1 above it.
fn hall() -> Vec<Layer> {
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(4), 2.0), [-4.0, -4.0, 0.0]);
    let roof = shapes::translated(&floor, [0.0, 0.0, 1.0]);
    [("floor", floor), ("roof", roof)].map(|(name, mesh)| Layer::from(&mesh.with_name(name))).into()
}

/// Position and quality of each vertex of a PLY, and its colors.
fn ply(folder: &Folder, name: &str) -> Vec<([f32; 3], f32, [u8; 3])> {
    use ply_rs_bw::parser::Parser;
    use ply_rs_bw::ply::{DefaultElement, Property};
    let bytes = fs::read(folder.path(name)).unwrap();
    let ply = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
    let float = |vertex: &DefaultElement, key: &str| match vertex[key] {
        Property::Float(value) => value,
        ref other => panic!("{other:?}"),
    };
    let byte = |vertex: &DefaultElement, key: &str| match vertex[key] {
        Property::UChar(value) => value,
        ref other => panic!("{other:?}"),
    };
    let row = |vertex: &DefaultElement| {
        let position = ["x", "y", "z"].map(|key| float(vertex, key));
        (position, float(vertex, "quality"), ["red", "green", "blue"].map(|key| byte(vertex, key)))
    };
    ply.payload["vertex"].iter().map(row).collect()
}

/// The JSON of a GLB, and its binary chunk.
fn glb(folder: &Folder, name: &str) -> (Value, Vec<u8>) {
    let bytes = fs::read(folder.path(name)).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    (serde_json::from_slice(&bytes[20..20 + length]).unwrap(), bytes[28 + length..].to_vec())
}

#[test]
fn ambient_json_has_the_agreed_keys_in_order() {
    let folder = Folder::with_cubes();
    let document = folder.json("ambient cube.obj -o a.glb");
    let wanted =
        "file format receivers method rays mean_openness standard_error inside fit worst_inside seconds";
    assert_eq!(keys(&document), wanted);
    // Nothing hides the sky from the outside of a convex solid.
    let found = ["receivers", "method", "rays", "mean_openness", "inside"].map(|key| document[key].clone());
    assert_eq!(found, [json!(24), json!("rays"), json!(64), json!(1.0), json!(0)]);
    let exact = folder.json("ambient cube.obj -o a.glb --method exact");
    assert_eq!((keys(&exact).as_str(), &exact["rays"]), (wanted, &Value::Null));
    assert!((exact["mean_openness"].as_f64().unwrap() - 1.0).abs() < 1e-6);
}

#[test]
fn ambient_fit_lowers_the_error_inside_faces_and_names_the_worst_one() {
    let folder = Folder::new();
    // A floor that is one polygon of four corners, after a box that hovers over its middle.
    let block = shapes::cuboid([-2.0, -2.0, 1.0], [2.0, 2.0, 3.0]);
    let text = |p: &[f32; 3]| format!("v {} {} {}\n", p[0], p[1], p[2]);
    let mut obj: String = block.positions().iter().map(text).collect();
    obj += "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\n";
    block.triangles().iter().for_each(|[a, b, c]| obj += &format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    obj += "f 9 10 11 12\n";
    fs::write(folder.path("a.obj"), obj).unwrap();
    let asked = |flags: &str| folder.json(&format!("ambient a.obj -o a.glb {flags}"));
    assert_eq!(asked("--rays 32")["worst_inside"], Value::Null);
    let (plain, fit) = (asked("--rays 32 --inside 300"), asked("--rays 32 --inside 300 --fit"));
    for found in [&plain, &fit] {
        let worst = &found["worst_inside"];
        assert_eq!((worst["polygon"].as_u64(), worst["line"].as_u64()), (Some(12), Some(25)), "{worst}");
        assert!(worst["face"].as_u64() >= Some(12) && worst["samples"].as_u64() > Some(200), "{worst}");
    }
    let mean = |of: &Value| of["worst_inside"]["mean_error"].as_f64().unwrap();
    assert!(mean(&fit) < 0.7 * mean(&plain), "{plain} {fit}");
    assert_eq!((&plain["fit"], &fit["fit"]), (&json!(false), &json!(true)));
    for method in ["exact", "disks"] {
        assert!(asked(&format!("--fit --inside 50 --method {method}"))["worst_inside"].is_object());
    }
    let run = folder.run("ambient a.obj -o a.glb --fit --rays 16 --inside 99");
    assert!(run.stdout.contains("line 25"), "{}", run.stdout);
    let run = folder.run("ambient a.obj -o a.glb --fit --per face");
    assert!(run.code == 2 && run.stderr.contains("--per face"), "{}", run.stderr);
}

#[test]
fn ambient_faces_names_and_positions_are_those_of_the_model_in_every_form() {
    let folder = Folder::new();
    folder.mesh("a.obj", &nested());
    let faces = |name: &str| {
        let mut all = Vec::new();
        for mesh in read(folder.path(name)).unwrap().bake(Scope::Mesh).unwrap() {
            let corner = |vertex: u32| mesh.positions()[vertex as usize].map(f32::to_bits);
            all.extend(mesh.triangles().iter().map(|face| face.map(corner)));
        }
        all
    };
    for (options, output) in [
        ("", "a.glb"),
        ("--as texture", "a.glb"),
        ("--as color", "a.glb"),
        ("--as attribute --bent", "a.glb"),
        ("--per vertex", "a.ply"),
        ("--per face --method exact", "a.ply"),
        ("--method disks", "a.glb"),
        ("--error 0.05 --distance 2 --ambient-falloff linear", "a.ply"),
    ] {
        let run = folder.run(format!("ambient a.obj -o {output} {options}").trim());
        assert_eq!(run.code, 0, "{options}: {}", run.stderr);
        assert_eq!(faces(output), faces("a.obj"), "{options}");
        assert_eq!(run.stderr.contains("direct light too"), options == "--as color", "{}", run.stderr);
        assert!(run.stdout.contains("mean openness"), "{}", run.stdout);
    }
    let (document, _) = glb(&folder, "a.glb");
    assert_eq!(document["nodes"][0]["name"], document["meshes"][0]["name"]);
    // Without a material surfaces are mirrors, on which nothing of this is seen.
    assert_eq!(document["materials"][0]["pbrMetallicRoughness"]["metallicFactor"], 0);
}

#[test]
fn ambient_values_of_a_nested_solid_are_dark_and_said_to_be() {
    let folder = Folder::new();
    folder.mesh("a.obj", &nested());
    let run = folder.run("ambient a.obj -o a.ply");
    assert!(run.stderr.contains("24 points are inside another solid"), "{}", run.stderr);
    let vertices = ply(&folder, "a.ply");
    let is_small = |[x, y, z]: [f32; 3]| [x, y, z].iter().all(|c| c.abs() == 1.0);
    for (position, quality, color) in &vertices {
        match is_small(*position) {
            true => assert_eq!((*quality, *color), (0.0, [0; 3])),
            false => assert!(*quality > 0.6 && color[0] > 200, "{position:?} {quality} {color:?}"),
        }
    }
    assert_eq!(vertices.iter().filter(|(position, ..)| is_small(*position)).count(), 8, "none is split");
}

#[test]
fn ambient_methods_agree_and_threads_change_nothing() {
    let folder = Folder::new();
    folder.mesh("torus.obj", &shapes::torus(24, 12, 2.0, 0.7));
    let mean = |options: &str| {
        let document = folder.json(&format!("ambient torus.obj -o a.glb {options}"));
        document["mean_openness"].as_f64().unwrap()
    };
    let exact = mean("--method exact");
    assert!((mean("--rays 1024") - exact).abs() < 0.002, "{exact}");
    assert!((mean("--method disks") - exact).abs() < 0.05, "{exact}");
    assert!(exact < 0.97);
    assert!(mean("--rays 256 --distance 0.1") > exact + 0.01);
    for name in ["b.glb", "c.glb"] {
        let threads = if name == "b.glb" { 1 } else { 3 };
        assert_eq!(folder.code(&format!("ambient torus.obj -o {name} --threads {threads} --bent")), 0);
    }
    assert_eq!(fs::read(folder.path("b.glb")).unwrap(), fs::read(folder.path("c.glb")).unwrap());
}

#[test]
fn ambient_of_what_does_not_cast_is_worked_out_and_hides_nothing() {
    let folder = Folder::new();
    let bytes = to_bytes(&Model { layers: hall() }, Target::Glb).unwrap();
    fs::write(folder.path("hall.glb"), &bytes).unwrap();
    let qualities = |options: &str| {
        assert_eq!(folder.code(format!("ambient hall.glb -o a.ply {options}").trim()), 0, "{options}");
        let all = ply(&folder, "a.ply");
        let of = |height: f32| {
            let inner = all.iter().filter(|(p, ..)| p[2] == height && p[0].abs() < 3.0 && p[1].abs() < 3.0);
            inner.map(|(_, quality, _)| *quality).collect::<Vec<_>>()
        };
        [of(0.0), of(1.0)]
    };
    let all_below = |values: &[f32], most: f32| !values.is_empty() && values.iter().all(|&x| x < most);
    let all_open = |values: &[f32]| !values.is_empty() && values.iter().all(|&x| x == 1.0);
    let [floor, roof] = qualities("");
    assert!(all_below(&floor, 0.4) && all_open(&roof), "{floor:?} {roof:?}");
    let [floor, roof] = qualities("--no-cast roof");
    assert!(all_open(&floor) && all_open(&roof), "{floor:?}");
    // The order of the file: the floor comes first, and is worked on last.
    let [floor, roof] = qualities("--no-cast floor");
    assert!(all_below(&floor, 0.4) && all_open(&roof), "{floor:?} {roof:?}");
    // What is left out of a glTF stays as it is.
    assert_eq!(folder.code("ambient hall.glb -o b.glb --only floor --as attribute"), 0);
    let (document, _) = glb(&folder, "b.glb");
    let has = |mesh: usize| !document["meshes"][mesh]["primitives"][0]["attributes"]["_OCCLUSION"].is_null();
    assert_eq!([has(0), has(1)], [true, false]);
}

#[test]
fn ambient_reads_a_gltf_from_standard_input() {
    let folder = Folder::new();
    let bytes = to_bytes(&Model { layers: hall() }, Target::Glb).unwrap();
    fs::write(folder.path("hall.glb"), &bytes).unwrap();
    let output = folder.command("ambient - -o a.glb").write_stdin(bytes).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(folder.code("ambient hall.glb -o b.glb"), 0);
    assert_eq!(fs::read(folder.path("a.glb")).unwrap(), fs::read(folder.path("b.glb")).unwrap());
}

/// A glTF of one square above another, with these normals of the lower one, and a vertex that no face has.
fn squares(normals: &[[f32; 3]; 5]) -> Vec<u8> {
    let corners = |z: f32| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z], [9.0, 9.0, z]];
    let mut bin = Vec::new();
    for vectors in [corners(0.0), *normals, corners(0.5)] {
        vectors.as_flattened().iter().for_each(|x| bin.extend(x.to_le_bytes()));
    }
    [0_u16, 1, 2, 0, 2, 3].iter().for_each(|x| bin.extend(x.to_le_bytes()));
    let base64 = base64::Engine::encode(&base64::prelude::BASE64_STANDARD, &bin);
    let view = |start: usize, length: usize| json!({"buffer": 0, "byteOffset": start, "byteLength": length});
    let vectors =
        |view: usize| json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 5});
    let document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "name": "low"}, {"mesh": 1, "name": "high"}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 3, "material": 0}]},
            {"primitives": [{"attributes": {"POSITION": 2}, "indices": 3}]}
        ],
        "materials": [{"name": "paint", "occlusionTexture": {"index": 0}}],
        "textures": [{"source": 0}], "images": [{"uri": "data:image/png;base64,AAAA"}],
        "accessors": [vectors(0), vectors(1), vectors(2), {"bufferView": 3, "componentType": 5123, "type": "SCALAR", "count": 6}],
        "bufferViews": [view(0, 60), view(60, 60), view(120, 60), view(180, 12)],
        "buffers": [{"byteLength": bin.len(), "uri": format!("data:application/octet-stream;base64,{base64}")}]
    });
    serde_json::to_vec(&document).unwrap()
}

#[test]
fn ambient_says_what_is_wrong_with_a_file_and_works() {
    let folder = Folder::new();
    let up = [0.0, 0.0, 1.0];
    let bad = [up, [f32::NAN, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 7.0], up];
    fs::write(folder.path("bad.gltf"), squares(&bad)).unwrap();
    fs::write(folder.path("good.gltf"), squares(&[up; 5])).unwrap();
    let run = folder.run("ambient bad.gltf -o bad.ply");
    assert!(run.code == 0 && run.stderr.contains("3 normals are no direction"), "{}", run.stderr);
    let run = folder.run("ambient good.gltf -o good.ply");
    assert!(!run.stderr.contains("normals"), "{}", run.stderr);
    // What was worked out anew is what was there.
    assert_eq!(ply(&folder, "bad.ply"), ply(&folder, "good.ply"));
    let run = folder.run("ambient good.gltf -o good.glb --as attribute");
    assert!(run.stderr.contains("2 vertices without a face"), "{}", run.stderr);
    // Normals of the file decide: a square that looks down at nothing is open.
    fs::write(folder.path("down.gltf"), squares(&[[0.0, 0.0, -1.0]; 5])).unwrap();
    let mean =
        |file: &str| folder.json(&format!("ambient {file} -o a.ply"))["mean_openness"].as_f64().unwrap();
    assert!(mean("good.gltf") < 0.9 && mean("down.gltf") == 1.0);

    // All faces without area: no normal, no light, and no failure.
    fs::write(folder.path("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    for output in ["flat.glb", "flat.ply"] {
        for method in ["rays", "exact", "disks"] {
            let run = folder.run(&format!("ambient flat.obj -o {output} --method {method}"));
            assert_eq!(run.code, 0, "{output} {method}: {}", run.stderr);
        }
    }
}

#[test]
fn ambient_refuses_what_it_cannot_do_and_leaves_no_file() {
    let folder = Folder::with_cubes();
    let up = [0.0, 0.0, 1.0];
    fs::write(folder.path("squares.gltf"), squares(&[up; 5])).unwrap();
    fs::write(folder.path("none.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    let before = folder.names();
    for (arguments, named) in [
        ("ambient cube.obj", "--output"),
        ("ambient cube.obj -o a.obj", "name a .glb or .ply"),
        ("ambient cube.obj -o a.gltf", ".gltf"),
        ("ambient cube.obj -o nowhere/a.glb", "no folder nowhere"),
        ("ambient cube.obj -o a.glb --rays 0", "from 1 to 1048576"),
        ("ambient cube.obj -o a.glb --rays 5 --error 0.1", "--error"),
        ("ambient cube.obj -o a.glb --error 0", "between 0 and 1"),
        ("ambient cube.obj -o a.glb --distance 0", "above 0"),
        ("ambient cube.obj -o a.glb --ambient-falloff linear", "add --distance"),
        ("ambient cube.obj -o a.glb --method exact --rays 5", "use --method rays"),
        ("ambient cube.obj -o a.glb --method exact --distance 5", "use --method rays"),
        ("ambient cube.obj -o a.glb --method disks --distance 5", "use --method rays"),
        ("ambient cube.obj -o a.ply --as color", "quality"),
        ("ambient cube.obj -o a.ply --bent", "quality"),
        ("ambient cube.obj -o a.glb --only ball", "nothing has such a name"),
        ("ambient cube.obj -o a.glb --no-cast ball", "nothing has such a name"),
        ("ambient none.obj -o a.glb", "there are no faces"),
        ("ambient garbled.stl -o a.glb", "garbled.stl"),
        (
            "ambient squares.gltf -o a.glb",
            "squares.gltf: material 0 (paint) has an occlusion texture already",
        ),
    ] {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments}");
        let last = run.stderr.lines().last().unwrap_or_default();
        assert!(last.contains(named) && last.contains("; "), "{arguments}: {}", run.stderr);
        assert_eq!(folder.names(), before, "{arguments}");
    }
    assert_eq!(folder.code("ambient squares.gltf -o a.glb --replace"), 0);
    let run = folder.run("ambient a.glb -o a.glb --replace");
    assert!(run.code == 2 && run.stderr.contains("names the input file"), "{}", run.stderr);
}

#[test]
fn render_ambient_darkens_what_hides_the_sky_and_nothing_else() {
    let folder = Folder::with_cubes();
    let render = |options: &str, name: &str| {
        let run =
            folder.run(&format!("render cube.obj --light point:3,5,4 --size 48x36 -o {name} {options}"));
        assert_eq!(run.code, 0, "{options}: {}", run.stderr);
        png(&folder, name).2
    };
    // Nothing hides the sky from a convex solid.
    for technique in ["rays", "auto"] {
        let shadow = format!("--shadow {technique}");
        assert!(render(&format!("{shadow} --ambient"), "a.png") == render(&shadow, "b.png"), "{technique}");
    }
    let ground = "--ground --shadow rays";
    let [with, without] = [render(&format!("{ground} --ambient"), "a.png"), render(ground, "b.png")];
    assert!(with.iter().zip(&without).all(|(with, without)| with <= without));
    assert!(
        with.iter().zip(&without).filter(|(with, without)| **with < without.saturating_sub(5)).count() > 100
    );
    assert!(render(&format!("{ground} --ambient --threads 1"), "c.png") == with);
    // Counted shadows, and samples instead of rays.
    let samples = "--ground --samples 1 --shadow pcf";
    let [with, without] = [render(&format!("{samples} --ambient"), "d.png"), render(samples, "e.png")];
    assert!(with.iter().zip(&without).all(|(with, without)| with <= without) && with != without);
}
