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
    nesting_complete t_junctions_complete";

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
    assert_eq!(keys(&document), "files verdict");
    let file = &document["files"][0];
    assert_eq!(keys(file), "file format error meshes total");
    assert_eq!(keys(&file["meshes"][0]), MESH_KEYS);
    assert_eq!(keys(&file["total"]), MESH_KEYS);
    let defect = &file["meshes"][0]["defects"][0];
    assert_eq!(keys(defect), "kind count effect at");
    assert_eq!(keys(&defect["at"][0]), "position name faces origins");
    assert_eq!((&document["verdict"], &file["format"]), (&Value::from("cracked"), &Value::from("obj")));
    assert_shape("check", &document);
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
    assert!(run.stdout.lines().count() < 8 && run.stdout.contains("all 501 meshes"), "{}", run.stdout);
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
    for (file, code) in [("huge.obj", 1), ("point.obj --weld none", 1), ("empty.stl", 0)] {
        assert_eq!(folder.code(&format!("check {file} --self-intersections --mark a.glb")), code, "{file}");
        // `json` asserts that the output parses, so it holds no NaN and no infinity.
        let total = &folder.json(&format!("check {file}"))["files"][0]["total"];
        assert!(total["signed_volume"].is_number(), "{file}: {total}");
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
    assert_eq!(end[1], ["open.obj", "10", "1", "4", "0", "0", "0", "cracked"]);
    assert_eq!(end[2], ["missing.obj", "-", "-", "-", "-", "-", "-", "error"]);
    assert_eq!(end[3], ["cube.obj", "12", "1", "0", "0", "0", "0", "sound"]);
    assert_eq!((end[4][0], end[4][1]), ("file", "faces"));
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
    assert_eq!((keys(&document).as_str(), &document["verdict"]), ("files verdict", &"cracked".into()));
    for (file, balanced, faces) in [(0, false, 10), (1, true, 12)] {
        let file = &document["files"][file];
        assert_eq!(keys(file), "file format error meshes total");
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
