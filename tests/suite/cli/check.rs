//! `umbrage check`.

use std::fs;

use serde_json::Value;
use umbrage::check::CrackReport;
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;
use umbrage::topology::Topology;
use umbrage::write::{Layer, Model, write};

use super::{Folder, assert_shape, keys, real};

/// The keys of a mesh that other programs rely on, followed by its two lists.
const MESH_KEYS: &str = "name vertices welded_vertices faces edges shells closed_shells euler_characteristic \
    boundary_edges boundary_loops non_manifold_edges max_faces_per_edge misoriented_edges non_manifold_vertices \
    collapsed_faces zero_area_faces duplicate_faces unreferenced_vertices near_miss_edges t_junctions \
    inside_out_shells self_intersections signed_volume watertight balanced even shell_list shell_origins defects \
    nesting_complete t_junctions_complete sound verdict";

#[test]
fn check_exit_code_is_the_verdict_and_two_outranks_one() {
    let folder = Folder::with_cubes();
    for (arguments, code) in [
        ("check cube.obj", 0),
        ("check open.obj", 1),
        ("check cube.obj open.obj", 1),
        ("check missing.obj", 2),
        ("check garbled.stl", 2),
        ("check folder", 2),
        ("check open.obj missing.obj cube.obj", 2),
        ("check folder cube.obj", 2),
    ] {
        assert_eq!(folder.code(arguments), code, "{arguments}");
        assert_eq!(folder.code(&format!("{arguments} --json")), code, "{arguments} --json");
    }
}

#[test]
fn check_reports_the_other_files_beside_an_unreadable_one() {
    let folder = Folder::with_cubes();
    let run = folder.run("check missing.obj cube.obj garbled.stl --json");
    let document: Value = serde_json::from_str(&run.stdout).unwrap();
    let files = document["files"].as_array().unwrap();
    assert_eq!(files.len(), 3);
    for (entry, name, format) in
        [(&files[0], "missing.obj", Value::Null), (&files[2], "garbled.stl", Value::from("stl"))]
    {
        assert_eq!((&entry["file"], &entry["format"]), (&Value::from(name), &format));
        assert!(entry["error"].as_str().unwrap().starts_with(name), "{entry}");
        assert_eq!((&entry["meshes"], &entry["total"]), (&Value::Array(vec![]), &Value::Null));
    }
    assert_eq!((&files[1]["error"], &files[1]["total"]["faces"]), (&Value::Null, &Value::from(12)));
    assert_eq!(document["verdict"], Value::Null, "what could not be read is not sound");
    assert_eq!(run.stderr.lines().count(), 2);
    let run = folder.run("check missing.obj open.obj --json");
    assert_eq!(serde_json::from_str::<Value>(&run.stdout).unwrap()["verdict"], "cracked");
    let text = folder.run("check missing.obj cube.obj garbled.stl").stdout;
    assert!(text.contains("cube.obj (obj)") && text.contains("sound: the mesh is watertight"), "{text}");
}

#[test]
fn check_json_has_the_agreed_keys_in_order() {
    let folder = Folder::with_cubes();
    let document = folder.json("check open.obj cube.obj");
    assert_eq!(keys(&document), "version files verdict");
    let file = &document["files"][0];
    assert_eq!(keys(file), "file format error meshes total requirements rounding sound verdict");
    assert_eq!(keys(&file["meshes"][0]), MESH_KEYS);
    assert_eq!(keys(&file["total"]), MESH_KEYS);
    let defect = &file["meshes"][0]["defects"][0];
    assert_eq!(keys(defect), "kind count at_least effect at code severity");
    assert_eq!(keys(&defect["at"][0]), "position name faces origins");
    assert_eq!((&document["verdict"], &file["format"]), (&Value::from("cracked"), &Value::from("obj")));
    assert_shape("check", &document);
}

#[test]
fn check_json_says_what_is_sound_whatever_is_required() {
    let folder = Folder::with_cubes();
    fs::write(folder.path("empty.stl"), "solid\nendsolid\n").unwrap();
    folder.mesh("inward.ply", &shapes::inside_out(&shapes::cube()));
    let files = "cube.obj open.obj inward.ply empty.stl garbled.stl";
    let run = folder.run(&format!("check {files} --require even --allow-empty --json"));
    let document: Value = serde_json::from_str(&run.stdout).unwrap();
    let files = document["files"].as_array().unwrap();
    let of = |key: &str| files.iter().map(|file| file[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("sound"), [true.into(), false.into(), false.into(), false.into(), Value::Null]);
    let verdicts: [Value; 5] =
        ["sound".into(), "cracked".into(), "sound".into(), "sound".into(), Value::Null];
    assert_eq!(of("verdict"), verdicts);
    for (file, is_sound) in files.iter().zip([true, false, false]) {
        assert_eq!(
            (&file["meshes"][0]["sound"], &file["total"]["sound"]),
            (&is_sound.into(), &is_sound.into())
        );
        assert_eq!(file["meshes"][0]["verdict"], file["verdict"]);
    }
    let defect = &files[1]["meshes"][0]["defects"][0];
    assert_eq!((&defect["code"], &defect["severity"]), (&"BOUNDARY_LOOP".into(), &"error".into()));
}

#[test]
fn check_counts_of_an_open_cube_are_those_of_a_hole() {
    let folder = Folder::with_cubes();
    let document = folder.json("check open.obj");
    let mesh = &document["files"][0]["meshes"][0];
    for (key, value) in [("faces", 10), ("edges", 17), ("boundary_edges", 4), ("boundary_loops", 1)] {
        assert_eq!(mesh[key], value, "{key}");
    }
    assert_eq!(mesh["self_intersections"], Value::Null, "nobody looked");
    let document = folder.json("check open.obj --self-intersections");
    assert_eq!(document["files"][0]["meshes"][0]["self_intersections"], 0);
}

#[test]
fn check_require_names_a_weaker_property() {
    let folder = Folder::new();
    folder.mesh("touching.obj", &shapes::cubes_sharing_edge());
    folder.mesh("turned.obj", &shapes::misoriented_cube());
    folder.mesh("inward.obj", &shapes::inside_out(&shapes::cube()));
    folder.mesh("open.obj", &shapes::open_cube());
    // Exit codes for each requirement: soundness, watertight, balanced, even.
    for (name, codes) in [
        ("touching", [1, 1, 0, 0]),
        ("turned", [1, 1, 1, 0]),
        ("inward", [1, 0, 0, 0]),
        ("open", [1, 1, 1, 1]),
    ] {
        let options = ["", " --require watertight", " --require balanced", " --require even"];
        let got = options.map(|option| folder.code(&format!("check {name}.obj{option}")));
        assert_eq!(got, codes, "{name}");
    }
}

#[test]
fn check_weld_decides_what_is_one_vertex() {
    let folder = Folder::new();
    folder.mesh("soup.ply", &shapes::soup(&shapes::cube()));
    folder.mesh("seam.obj", &shapes::seam(4));
    assert_eq!(folder.code("check soup.ply"), 0);
    assert_eq!(folder.code("check soup.ply --weld none"), 1);
    assert_eq!(folder.code("check seam.obj"), 1);
    // The report names the distance that closes the mesh, and welding by this distance does close it.
    let text = folder.run("check seam.obj").stdout;
    let remedy = text.lines().find(|line| line.contains("--weld")).unwrap_or_else(|| panic!("{text}"));
    let option: Vec<&str> = remedy.split_whitespace().take(2).collect();
    assert_eq!(folder.code(&format!("check seam.obj {}", option.join(" "))), 0, "{remedy}");
}

#[test]
fn check_limit_bounds_what_is_listed() {
    let folder = Folder::new();
    let pieces: Vec<Mesh> =
        (0..9_u8).map(|i| shapes::translated(&shapes::open_cube(), [f32::from(i) * 3.0, 0.0, 0.0])).collect();
    folder.mesh("nine.obj", &Mesh::concat(&pieces).unwrap());
    for (option, listed) in [("", 5), (" --limit 2", 2), (" --limit 0", 0), (" --limit 50", 9)] {
        let document = folder.json(&format!("check nine.obj{option}"));
        let defect = &document["files"][0]["meshes"][0]["defects"][0];
        assert_eq!((defect["at"].as_array().unwrap().len(), &defect["count"]), (listed, &Value::from(9)));
        let text = folder.run(&format!("check nine.obj{option}")).stdout;
        assert_eq!(text.matches("    at ").count(), listed, "{text}");
        assert_eq!(text.contains(&format!("    {} more\n", 9 - listed)), listed < 9, "{text}");
    }
}

#[test]
fn check_mark_is_geometry_that_can_be_read_and_always_the_same() {
    let folder = Folder::with_cubes();
    let code = folder.code("check open.obj --mark a.glb");
    assert_eq!((code, folder.code("check open.obj --mark b.glb")), (1, 1));
    assert_eq!(fs::read(folder.path("a.glb")).unwrap(), fs::read(folder.path("b.glb")).unwrap());
    let marked = folder.json("check a.glb --scope scene");
    assert_eq!(marked["files"][0]["total"]["faces"], 10, "the gray mesh, and no face beside it");
}

#[test]
fn check_keeps_commands_to_the_terminal_out_of_its_text() {
    let folder = Folder::new();
    fs::write(folder.path("a.obj"), "o \x1b[31mred\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let run = folder.run("check a.obj");
    assert_eq!(run.code, 1);
    assert!(!run.stdout.contains('\x1b') && run.stdout.contains("[31mred"), "{}", run.stdout);
}

#[test]
fn check_of_many_sound_meshes_is_a_few_lines() {
    let Some(file) = real("many-cubes.gltf") else { return };
    let run = Folder::new().run(&format!("check {}", file.display()));
    assert_eq!(run.code, 0);
    assert!(run.stdout.lines().count() < 12 && run.stdout.contains("all 501 meshes"), "{}", run.stdout);
}

#[test]
fn check_scope_of_a_solid_stored_in_pieces() {
    let Some(file) = real("strips_mode5.gltf") else { return };
    let folder = Folder::new();
    let file = file.display();
    for (scope, meshes, boundary) in [("mesh", 54, 2656), ("scene", 1, 0)] {
        let document = folder.json(&format!("check {file} --scope {scope}"));
        let report = &document["files"][0];
        assert_eq!(report["meshes"].as_array().unwrap().len(), meshes);
        assert_eq!(report["total"]["boundary_edges"], boundary);
    }
}

#[test]
fn check_takes_meshes_at_the_ends_of_the_range() {
    let folder = Folder::new();
    let huge = "v 3e38 3e38 3e38\nv -3e38 -3e38 -3e38\nv 0 3e38 0\nv 1e-45 0 0\nf 1 2 3\nf 2 3 4\n";
    fs::write(folder.path("huge.obj"), huge).unwrap();
    fs::write(folder.path("point.obj"), "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n").unwrap();
    fs::write(folder.path("empty.stl"), "solid\nendsolid\n").unwrap();
    for (file, code) in [("huge.obj", 1), ("point.obj --weld none", 1), ("empty.stl", 1)] {
        assert_eq!(folder.code(&format!("check {file} --self-intersections --mark a.glb")), code, "{file}");
        // `json` asserts that the output parses, so it holds no NaN and no infinity.
        let total = &folder.json(&format!("check {file}"))["files"][0]["total"];
        assert_eq!(total["signed_volume"].is_number(), total["balanced"] == true, "{file}: {total}");
        let volume = folder.json(&format!("volume {file} -o b.glb"));
        assert_eq!(volume["lights"][0]["closed"], true, "{file}");
    }
    assert!(folder.run("check empty.stl").stderr.contains("there are no faces"));
}

#[test]
fn check_of_several_files_ends_with_a_table_and_one_verdict() {
    let folder = Folder::with_cubes();
    let text = folder.run("check cube.obj missing.obj open.obj").stdout;
    let end: Vec<Vec<&str>> =
        text.lines().rev().take(5).map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(end[0].join(" "), "verdict: 1 of 3 files cracked, 1 could not be read");
    assert_eq!(end[1], ["10", "1", "4", "0", "0", "0", "cracked", "open.obj"]);
    assert_eq!(end[2], ["-", "-", "-", "-", "-", "-", "error", "missing.obj"]);
    assert_eq!(end[3], ["12", "1", "0", "0", "0", "0", "sound", "cube.obj"]);
    assert_eq!(end[4], ["faces", "shells", "boundary", "manifold", "oriented", "out", "file"]);
    let text = folder.run("check cube.obj cube.obj").stdout;
    assert!(text.ends_with("verdict: all 2 files are sound\n"), "{text}");
    assert!(!folder.run("check cube.obj").stdout.contains("verdict:"));
}

#[test]
fn check_total_lists_the_defects_of_all_meshes() {
    let folder = Folder::new();
    let shifted = |x| shapes::translated(&shapes::open_cube(), [x, 0.0, 0.0]);
    let layers = [("left", 0.0), ("right", 5.0)].map(|(name, x)| Layer::from(&shifted(x).with_name(name)));
    write(&Model { layers: layers.to_vec() }, folder.path("two.glb")).unwrap();
    let total =
        |option: &str| folder.json(&format!("check two.glb{option}"))["files"][0]["total"]["defects"].clone();
    let defects = total("");
    assert_eq!(defects.as_array().unwrap().len(), 1);
    assert_eq!((&defects[0]["kind"], &defects[0]["count"]), (&"boundary_loop".into(), &2.into()));
    let names: Vec<&Value> = defects[0]["at"].as_array().unwrap().iter().map(|at| &at["mesh"]).collect();
    assert_eq!(names, ["left", "right"]);
    assert_eq!(total(" --limit 1")[0]["at"].as_array().unwrap().len(), 1);
    // A part's name is appended to the mesh's name, and printed once.
    fs::write(folder.path("parts.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\ng east\nf 1 2 3\ng west\nf 1 3 2\n")
        .unwrap();
    let text = folder.run("check parts.obj --scope primitive").stdout;
    let place = text.lines().find(|line| line.contains("    at ")).unwrap_or_else(|| panic!("{text}"));
    assert_eq!(place.matches("east").count(), 1, "{text}");
    // The text output mentions the effect of another scope, and prints no name twice.
    let text = folder.run("check two.glb").stdout;
    assert!(text.contains("--scope scene looks at the file as one mesh"), "{text}");
    assert!(!folder.run("check two.glb --scope scene").stdout.contains("--scope scene"));
}

#[test]
fn check_verdict_names_what_the_required_property_lacks() {
    let folder = Folder::with_cubes();
    folder.mesh("inward.obj", &shapes::inside_out(&shapes::cube()));
    for (arguments, line) in [
        ("check open.obj --require watertight", "cracked: the mesh is not watertight: 4 boundary edges"),
        ("check open.obj --require even", "cracked: the mesh is not even: 4 boundary edges"),
        ("check inward.obj", "cracked: the mesh is not sound: 1 shell inside out"),
    ] {
        let text = folder.run(arguments).stdout;
        assert!(text.lines().any(|text| text.trim() == line), "{arguments}: {text}");
    }
}

#[test]
fn check_fast_tells_balanced_from_not_and_says_how_sure_it_is() {
    let folder = Folder::with_cubes();
    folder.mesh("touching.obj", &shapes::cubes_sharing_edge());
    folder.mesh("turned.obj", &shapes::misoriented_cube());
    folder.mesh("soup.ply", &shapes::soup(&shapes::cube()));
    for (arguments, code, said) in [
        ("cube.obj", 0, "cube.obj (obj): balanced, 12 faces"),
        ("touching.obj", 0, "balanced"),
        ("open.obj", 1, "open.obj (obj): not balanced, 10 faces"),
        ("turned.obj", 1, "not balanced"),
        ("soup.ply", 0, "balanced"),
        ("soup.ply --weld none", 1, "not balanced"),
        ("cube.obj --require balanced", 0, "balanced"),
        ("cube.obj open.obj", 1, "verdict: 1 of 2 files not balanced"),
        ("missing.obj open.obj", 2, "verdict: 1 of 2 files not balanced, 1 could not be read"),
    ] {
        let run = folder.run(&format!("check --fast {arguments}"));
        assert_eq!(run.code, code, "{arguments}: {}", run.stdout);
        assert!(run.stdout.contains(said), "{arguments}: {}", run.stdout);
        assert!(run.stdout.contains("probability below 1e-8"), "{}", run.stdout);
        let balanced = folder.run(&format!("check --require balanced {arguments}")).code;
        if !arguments.contains("--require") {
            assert_eq!(run.code, balanced, "{arguments}: as the whole report has it");
        }
    }
}

#[test]
fn check_fast_json_has_the_agreed_keys_and_null_for_what_was_not_computed() {
    let folder = Folder::with_cubes();
    let document = folder.json("check --fast open.obj cube.obj");
    assert_eq!(
        (keys(&document).as_str(), &document["verdict"]),
        ("version files verdict", &"cracked".into())
    );
    for (file, balanced, faces) in [(0, false, 10), (1, true, 12)] {
        let file = &document["files"][file];
        assert_eq!(keys(file), "file format error meshes total requirements rounding sound verdict");
        for mesh in [&file["meshes"][0], &file["total"]] {
            assert_eq!(keys(mesh), MESH_KEYS);
            let Value::Object(object) = mesh else { unreachable!() };
            let known: Vec<&str> =
                object.iter().filter(|(_, value)| !value.is_null()).map(|(key, _)| key.as_str()).collect();
            let known: Vec<&str> = known.into_iter().filter(|&key| key != "name").collect();
            assert_eq!(known, ["vertices", "faces", "balanced"]);
            assert_eq!((&mesh["balanced"], &mesh["faces"]), (&balanced.into(), &faces.into()));
        }
    }
}

#[test]
fn check_fast_takes_scopes_as_they_are() {
    let Some(file) = real("strips_mode5.gltf") else { return };
    let folder = Folder::new();
    let file = file.display();
    assert_eq!(folder.code(&format!("check --fast {file} --scope mesh")), 1);
    assert_eq!(folder.code(&format!("check --fast {file} --scope scene")), 0);
}

#[test]
fn check_json_of_a_mesh_is_that_of_the_library() {
    let folder = Folder::new();
    let solid = Mesh::concat(&[shapes::nested_cubes(3), shapes::t_junction()]).unwrap();
    folder.mesh("a.obj", &solid);
    let document = folder.json("check a.obj");
    let mesh = umbrage::mesh::weld(&solid, umbrage::mesh::Weld::Exact).mesh;
    let topology = Topology::of(&mesh);
    let mut report = CrackReport::of(&mesh, &topology);
    let said = &document["files"][0]["meshes"][0];
    let same = |report: &CrackReport| {
        // Through text as well, since reading decimals may round.
        let text = serde_json::to_string(report).unwrap();
        let Value::Object(report) = serde_json::from_str(&text).unwrap() else { panic!("an object") };
        assert!(report.len() > 24, "all numbers, the shells, and which searches are complete");
        report.iter().all(|(key, value)| said[key] == *value)
    };
    assert!(same(&report), "{said:#}");
    // Negative test: one number of one shell.
    report.shell_list[1].faces += 1;
    assert!(!same(&report));
}

#[test]
fn check_require_takes_a_list_and_names_what_failed() {
    let folder = Folder::with_cubes();
    folder.mesh("eight.ply", &shapes::figure_eight_prism());
    let far = shapes::translated(&shapes::figure_eight_prism(), [50.0, 3.0, 0.0]);
    folder.mesh("crossed.obj", &Mesh::concat(&[shapes::cube(), far]).unwrap());
    folder.mesh("double.obj", &shapes::duplicated_face());
    folder.mesh("line.obj", &shapes::collinear_face());
    folder.mesh("touching.obj", &shapes::cubes_sharing_edge());
    folder.mesh("tee.obj", &shapes::t_junction());
    for (arguments, code) in [
        // What is searched for counts, and only that.
        ("eight.ply --require watertight", 0),
        ("eight.ply --require watertight --self-intersections", 1),
        ("crossed.obj --require watertight,no-self-intersections", 1),
        ("crossed.obj --require watertight --require no-self-intersections", 1),
        ("cube.obj --require watertight,manifold,even,balanced,sound,not-empty", 0),
        ("cube.obj --require no-self-intersections,no-t-junctions,no-duplicates,no-zero-area", 0),
        ("cube.obj --self-intersections", 0),
        ("double.obj --require no-duplicates", 1),
        ("double.obj --require no-zero-area", 0),
        ("line.obj --require no-zero-area", 1),
        ("touching.obj --require manifold", 1),
        ("touching.obj --require balanced,no-t-junctions", 0),
        ("tee.obj --require no-t-junctions", 1),
        ("cube.obj --require round", 2),
    ] {
        assert_eq!(folder.code(&format!("check {arguments}")), code, "{arguments}");
    }
    let arguments = "check crossed.obj --require even --require no-self-intersections,manifold";
    let requirements = &folder.json(arguments)["files"][0]["requirements"];
    let expected = serde_json::json!([
        { "name": "not-empty", "holds": true },
        { "name": "even", "holds": true },
        { "name": "manifold", "holds": true },
        { "name": "no-self-intersections", "holds": false },
    ]);
    assert_eq!(*requirements, expected);
    let text = folder.run(arguments).stdout;
    assert!(text.contains("cracked: the mesh is not free of self-intersections: "), "{text}");
    let text = folder.run("check cube.obj --require even,no-duplicates,manifold").stdout;
    assert!(text.contains("  sound: the mesh is even, manifold and free of duplicate faces\n"), "{text}");
}

#[test]
fn check_of_nothing_passes_no_gate_unless_that_is_allowed() {
    let folder = Folder::new();
    fs::write(folder.path("none.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    folder.mesh("small.ply", &shapes::scaled(&shapes::icosphere(1), 0.01));
    for arguments in ["none.obj", "none.obj --require even", "none.obj --fast", "small.ply --weld 1"] {
        assert_eq!(folder.code(&format!("check {arguments}")), 1, "{arguments}");
        assert_eq!(folder.code(&format!("check {arguments} --allow-empty")), 0, "{arguments}");
        let verdict = folder.json(&format!("check {arguments}"))["verdict"].clone();
        assert_eq!(verdict, "empty", "{arguments}");
    }
    assert_eq!(folder.code("check small.ply --weld 0.0001"), 0);
    let text = folder.run("check small.ply --weld 1").stdout;
    assert!(text.contains("empty: there are no faces to check: all 80 faces collapse when welded"), "{text}");
}

#[test]
fn check_tells_open_from_misoriented_and_gives_no_volume_for_either() {
    let folder = Folder::with_cubes();
    let turned = shapes::translated(&shapes::misoriented_cube(), [9.0, 0.0, 0.0]);
    let open = shapes::translated(&shapes::open_cube(), [18.0, 0.0, 0.0]);
    folder.mesh("three.obj", &Mesh::concat(&[shapes::cube(), turned, open]).unwrap());
    let text = folder.run("check three.obj").stdout;
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    let states = ["0", "1", "2"].map(|shell| {
        // Between the first face and the volume stand its polygon and line.
        let row = rows.iter().rev().find(|row| row.len() >= 8 && row[0] == shell);
        row.map(|row| (row[row.len() - 2], row[row.len() - 1])).unwrap_or_else(|| panic!("{text}"))
    });
    assert_eq!(states, [("8", "watertight"), ("-", "misoriented"), ("-", "open")]);
    let document = folder.json("check three.obj");
    let mesh = &document["files"][0]["meshes"][0];
    assert_eq!(
        (&mesh["signed_volume"], &mesh["shell_list"][0]["signed_volume"]),
        (&Value::Null, &8.0.into())
    );
    assert_eq!(mesh["shell_list"][1]["signed_volume"], Value::Null);
}

/// A glTF that places a mesh by a matrix; column-major.
fn placed(mesh: &Mesh, matrix: [f64; 16]) -> String {
    let numbers: Vec<f32> = mesh.positions().iter().flatten().copied().collect();
    let bytes: Vec<u8> = numbers
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .chain(mesh.triangles().iter().flatten().flat_map(|id| id.to_le_bytes()))
        .collect();
    let base64 = {
        use base64::Engine as _;
        base64::engine::general_purpose::STANDARD.encode(&bytes)
    };
    let (vertices, start, indices) = (mesh.vertex_count(), 4 * numbers.len(), 3 * mesh.face_count());
    let axis = |axis: usize, from: f32, better: fn(f32, f32) -> f32| {
        mesh.positions().iter().map(|p| p[axis]).fold(from, better)
    };
    let [low, high] = [(f32::INFINITY, f32::min as fn(f32, f32) -> f32), (f32::NEG_INFINITY, f32::max)]
        .map(|(from, better)| [0, 1, 2].map(|i| axis(i, from, better)));
    serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "matrix": matrix }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{base64}") }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": start },
            { "buffer": 0, "byteOffset": start, "byteLength": bytes.len() - start },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3", "min": low, "max": high },
            { "bufferView": 1, "componentType": 5125, "count": indices, "type": "SCALAR" },
        ],
    })
    .to_string()
}

#[test]
fn check_judges_a_mesh_in_its_own_space_and_tells_the_world() {
    let folder = Folder::new();
    let far = [4_387_923.5, 717_653.25, -4_555_123.5];
    let matrix = |sx: f64, s: f64, at: [f64; 3]| {
        [sx, 0.0, 0.0, 0.0, 0.0, s, 0.0, 0.0, 0.0, 0.0, s, 0.0, at[0], at[1], at[2], 1.0]
    };
    for (name, mesh) in
        [("box", shapes::scaled(&shapes::cube(), 0.1)), ("ball", shapes::scaled(&shapes::icosphere(2), 0.1))]
    {
        let volume = {
            let report = CrackReport::of(&mesh, &Topology::of(&mesh));
            report.counts.signed_volume
        };
        // Mirrored, scaled and far out: sound, with the volume and the place that it has in the world.
        fs::write(folder.path("far.gltf"), placed(&mesh, matrix(-2.0, 2.0, far))).unwrap();
        let run = folder.run("check far.gltf");
        assert_eq!(run.code, 0, "{name}: {}", run.stdout);
        assert!(run.stderr.contains("placing moves a vertex by 0."), "{}", run.stderr);
        let document = folder.json("check far.gltf");
        let shell = &document["files"][0]["meshes"][0]["shell_list"][0];
        let told = shell["signed_volume"].as_f64().unwrap();
        assert!((told - 8.0 * volume).abs() < 1e-9, "{name}: {told} {volume}");
        assert!(shell["bounds"][0][0].as_f64().unwrap() > 4e6, "{shell}");
        // Judged where it is placed it falls together, and the report says why.
        let run = folder.run("check far.gltf --scope scene");
        assert_eq!(run.code, 1, "{name}: {}", run.stdout);
        assert!(run.stdout.contains("defects of that size come from the rounding"), "{}", run.stdout);
        // Near the origin there is nothing to say.
        fs::write(folder.path("near.gltf"), placed(&mesh, matrix(1.0, 1.0, [0.5, 2.0, -1.0]))).unwrap();
        for scope in ["mesh", "scene", "primitive"] {
            let run = folder.run(&format!("check near.gltf --scope {scope}"));
            assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{name} {scope}: {}", run.stdout);
        }
    }
}

#[test]
fn check_says_how_far_decimals_were_rounded() {
    let folder = Folder::new();
    let corners = |at: [f64; 3], size: f64| -> Vec<[f64; 3]> {
        let corner = |i: usize| [0, 1, 2].map(|axis| at[axis] + size * f64::from(i as u32 >> axis & 1));
        (0..8).map(corner).collect()
    };
    let faces = [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]];
    let obj = |at, size| {
        let vertex = |p: &[f64; 3]| format!("v {:.4} {:.4} {:.4}\n", p[0], p[1], p[2]);
        let face = |f: &[u32; 4]| format!("f {} {} {} {}\n", f[0], f[1], f[2], f[3]);
        corners(at, size).iter().map(vertex).chain(faces.iter().map(face)).collect::<String>()
    };
    let ply = |at, size| {
        let vertex = |p: &[f64; 3]| format!("{:.4} {:.4} {:.4}\n", p[0], p[1], p[2]);
        let face = |f: &[u32; 4]| format!("4 {} {} {} {}\n", f[0] - 1, f[1] - 1, f[2] - 1, f[3] - 1);
        let head = "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n\
                    element face 6\nproperty list uchar int vertex_indices\nend_header\n";
        let body: String = corners(at, size).iter().map(vertex).chain(faces.iter().map(face)).collect();
        format!("{head}{body}")
    };
    let far = [512_345.67, 5_812_345.3, 103.4];
    for (name, text) in [("far.obj", obj(far, 0.2)), ("far.ply", ply(far, 0.2))] {
        fs::write(folder.path(name), text).unwrap();
        let run = folder.run(&format!("check {name}"));
        // In y, 5812345.3 and .5 become one f32.
        assert!(run.stderr.contains("the largest moved by 0.20; move the model"), "{name}: {}", run.stderr);
        assert_eq!(run.code, 1, "{name}");
        assert!(run.stdout.contains("defects of that size come from the rounding"), "{}", run.stdout);
        let moved = folder.json(&format!("check {name}"))["files"][0]["rounding"].as_f64().unwrap();
        assert!((moved - 0.2).abs() < 1e-8, "{name}: {moved}");
    }
    // Coordinates that fit, however large, and those that are rounded by next to nothing.
    for (at, size) in [([512_345.5, 5_812_345.0, 103.5], 2.0), ([0.1, 0.2, 0.3], 0.7)] {
        fs::write(folder.path("fits.obj"), obj(at, size)).unwrap();
        let run = folder.run("check fits.obj");
        assert!(run.code == 0 && !run.stderr.contains("moved"), "{}{}", run.stderr, run.stdout);
    }
}

#[test]
fn check_says_what_the_effect_is_on_and_that_frames_are_welded_together() {
    let folder = Folder::new();
    folder.mesh("point.obj", &shapes::scaled(&shapes::cube(), 1e-3));
    let text = folder.run("check point.obj --weld 1").stdout;
    assert!(text.contains("    effect on the shadow: none, since the face has no area"), "{text}");
    assert!(!text.lines().any(|line| line.trim_start().starts_with("none")), "{text}");
}

#[test]
fn check_of_coordinates_beyond_the_digits_of_f32() {
    let Some(reports) = crate::support::reports() else { return };
    let folder = Folder::new();
    let at = |name: &str| reports.canonicalize().unwrap().join(name).display().to_string();
    let run = folder.run(&format!("check {}", at("far_instance.gltf")));
    assert!(
        run.code == 0 && run.stderr.contains("placing moves a vertex by "),
        "{}{}",
        run.stdout,
        run.stderr
    );
    let boxes = folder.json(&format!("check {}", at("ecef_box.gltf")));
    let watertight = |mesh: usize| boxes["files"][0]["meshes"][mesh]["watertight"].clone();
    assert_eq!([watertight(0), watertight(1)], [false, true], "a plate, and a box on it");
    let run = folder.run(&format!("check {}", at("utm_cube.obj")));
    assert!(run.stderr.contains("the largest moved by 0.2"), "{}", run.stderr);
}

#[test]
fn check_names_the_polygon_the_line_and_the_part_of_a_face() {
    let folder = Folder::new();
    // Two boxes without lids, of quads; the second one hangs on a part of its own.
    let quads = |from: usize| {
        let sides = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [3, 2, 1, 0]];
        let line = |side: [usize; 4]| {
            format!("f {} {} {} {}\n", side[0] + from, side[1] + from, side[2] + from, side[3] + from)
        };
        sides.map(line).concat()
    };
    let corners = |x: i32| {
        let flat = [[0, 0], [2, 0], [2, 2], [0, 2]];
        [0, 2].map(|z| flat.map(|[u, v]| format!("v {} {v} {z}\n", u + x)).concat()).concat()
    };
    let text = format!("{}{}g near\n{}g far\n{}", corners(0), corners(9), quads(1), quads(9));
    fs::write(folder.path("boxes.obj"), &text).unwrap();
    let line_of = |polygon: usize| 18 + polygon + usize::from(polygon > 4);
    for (only, first) in [("", 0), (" --only far", 5)] {
        let document = folder.json(&format!("check boxes.obj --self-intersections{only}"));
        let mesh = &document["files"][0]["meshes"][0];
        let hole = &mesh["defects"][0]["at"][0];
        let faces = hole["faces"].as_array().unwrap();
        let origins = hole["origins"].as_array().unwrap();
        assert_eq!(faces.len(), origins.len());
        for (index, origin) in origins.iter().enumerate() {
            let part = if first == 0 { "near" } else { "far" };
            let polygon = first + index;
            let wanted = serde_json::json!({
                "face": faces[index], "polygon": polygon, "line": line_of(polygon), "part": part
            });
            assert_eq!(*origin, wanted);
        }
        let shell = serde_json::json!({ "polygon": first, "line": line_of(first) });
        assert_eq!(mesh["shell_origins"][0], shell);
        let text = folder.run(&format!("check boxes.obj{only}")).stdout;
        let polygons: Vec<String> = (first..first + 4).map(|polygon| polygon.to_string()).collect();
        let lines: Vec<String> = (first..first + 4).map(|polygon| line_of(polygon).to_string()).collect();
        let place = format!("(polygons {}, lines {})", polygons.join(" "), lines.join(" "));
        assert!(text.contains(&place), "{place}: {text}");
        // Fault injected: the lines one further.
        assert!(!text.contains(&place.replace("lines ", "lines 1")), "{text}");
    }
}
