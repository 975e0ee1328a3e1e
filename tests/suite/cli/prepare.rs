//! `umbrage prepare`.

use std::fs;

use serde_json::Value;
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;
use umbrage::write::{Layer, Model, write};

use super::{Folder, assert_shape, keys, real};

/// The number of changes of a step, and of what it left, over all meshes.
fn step(document: &Value, name: &str) -> (u64, u64) {
    let steps = document["steps"].as_array().unwrap().iter().filter(|step| step["name"] == name);
    steps.fold((0, 0), |(count, left), step| {
        (count + step["count"].as_u64().unwrap(), left + step["left"].as_u64().unwrap())
    })
}

fn without_first(mesh: &Mesh) -> Mesh {
    let (positions, triangles, ..) = mesh.clone().into_parts();
    Mesh::new(positions, triangles[1..].to_vec()).unwrap()
}

/// A folder with one mesh of each kind that some step is for.
fn folder() -> Folder {
    let folder = Folder::with_cubes();
    folder.mesh("missing.obj", &without_first(&shapes::torus(8, 6, 2.0, 0.5)));
    folder.mesh("edge.obj", &shapes::cubes_sharing_edge());
    folder.mesh("flipped.obj", &shapes::inside_out(&shapes::octahedron()));
    folder.mesh("turned.ply", &shapes::misoriented_cube());
    folder.mesh("mobius.obj", &shapes::mobius(9));
    folder.mesh("soup.ply", &shapes::soup(&shapes::icosphere(1)));
    folder.mesh("junction.obj", &shapes::t_junction());
    folder.mesh("seam.ply", &shapes::seam(3));
    folder.mesh("sheet.obj", &shapes::double_sheet());
    folder
}

#[test]
fn prepare_json_has_the_agreed_keys_in_order() {
    let folder = folder();
    let document = folder.json("prepare open.obj -o out.glb --fill");
    assert_eq!(keys(&document), "file before after steps written verified");
    assert_eq!(keys(&document["steps"][0]), "name mesh count left changes largest_move");
    let fill = document["steps"].as_array().unwrap().iter().find(|step| step["name"] == "fill").unwrap();
    assert_eq!(keys(&fill["changes"][0]), "kind old new at patch");
    assert_eq!(keys(&fill["changes"][0]["patch"]), "edges length area off_plane meets left");
    assert_shape("prepare", &document);
    // The counts are those of `check`, before and after.
    for (file, state) in [("open.obj", "before"), ("out.glb", "after")] {
        let mut total = folder.json(&format!("check {file}"))["files"][0]["total"].clone();
        total["defects"] = Value::Array(Vec::new());
        // Of what is required, which `prepare` tells by its exit code.
        assert!(total.as_object_mut().unwrap().remove("verdict").is_some());
        let mut found = document[state].clone();
        found["defects"] = Value::Array(Vec::new());
        assert_eq!(found, total, "{file}");
    }
    assert_eq!((&document["verified"], &document["written"]), (&true.into(), &"out.glb".into()));
}

#[test]
fn prepare_makes_each_generated_mesh_what_its_step_is_for() {
    let folder = folder();
    for (file, options, name, done, check) in [
        ("open.obj", "--fill", "fill", (1, 0), ""),
        ("missing.obj", "--fill=3", "fill", (1, 0), ""),
        ("edge.obj", "--split", "split", (2, 0), " --weld none --require sound,manifold"),
        ("flipped.obj", "--orient", "orient", (8, 0), ""),
        ("turned.ply", "--orient", "orient", (1, 0), ""),
        ("soup.ply", "", "weld", (3 * 80 - 42, 0), ""),
        ("junction.obj", "--stitch", "stitch", (1, 0), ""),
        ("seam.ply", "--weld-within 1e-5", "weld-within", (4, 0), ""),
    ] {
        for out in ["out.glb", "out.obj", "out.ply", "out.stl"] {
            if out == "out.stl" && options == "--split" {
                continue;
            }
            let document = folder
                .json(&format!("prepare {file} -o {out} {options} --require watertight").replace("  ", " "));
            assert_eq!(step(&document, name), done, "{file} {out}");
            assert_eq!(document["verified"], true, "{file} {out}");
            assert_eq!(folder.code(&format!("check {out}{check}")), 0, "{file} {out}");
            fs::remove_file(folder.path(out)).unwrap();
        }
    }
    // Without the step it is not watertight, and nothing is written.
    for file in ["open.obj", "missing.obj", "edge.obj", "turned.ply", "junction.obj", "seam.ply"] {
        let before = folder.names();
        let run = folder.run(&format!("prepare {file} -o out.glb --require watertight"));
        assert_eq!((run.code, folder.names()), (1, before), "{file}");
        assert!(run.stderr.contains("nothing was written: not watertight"), "{}", run.stderr);
        let document = folder.json(&format!("prepare {file} -o out.glb --require watertight"));
        assert_eq!((&document["written"], &document["verified"]), (&Value::Null, &Value::Null));
    }
}

#[test]
fn prepare_that_fails_leaves_the_old_file() {
    let folder = folder();
    fs::write(folder.path("out.glb"), "old").unwrap();
    for (arguments, code) in [
        ("prepare open.obj -o out.glb --require watertight", 1),
        ("prepare garbled.stl -o out.glb", 2),
        ("prepare missing.off -o out.glb", 2),
    ] {
        assert_eq!(folder.code(arguments), code, "{arguments}");
        assert_eq!(fs::read(folder.path("out.glb")).unwrap(), b"old", "{arguments}");
    }
    assert_eq!(folder.code("prepare open.obj -o out.glb"), 0);
    assert_ne!(fs::read(folder.path("out.glb")).unwrap(), b"old");
}

#[test]
fn prepare_names_a_mobius_strip_and_a_sheet_that_it_leaves() {
    let folder = folder();
    let run = folder.run("prepare mobius.obj -o out.ply --orient");
    assert_eq!(run.code, 0);
    assert!(run.stdout.contains("Möbius strip"), "{}", run.stdout);
    assert_eq!(step(&folder.json("prepare mobius.obj -o out.ply --orient"), "orient"), (0, 1));
    let document = folder.json("prepare sheet.obj -o out.ply");
    assert_eq!((step(&document, "duplicates"), &document["after"]["faces"]), ((0, 2), &4.into()));
    // A sheet's patch would lie on it: refused, unless asked for.
    folder.mesh("flat.obj", &shapes::sheet(2));
    let run = folder.run("prepare flat.obj -o out.ply --fill");
    assert!(
        run.code == 0 && run.stdout.contains("every patch between its vertices would meet other faces"),
        "{}",
        run.stdout
    );
    let document = folder.json("prepare flat.obj -o out.ply --fill --fill-anyway");
    assert_eq!((step(&document, "fill"), &document["after"]["watertight"]), ((1, 0), &true.into()));
}

#[test]
fn prepare_refuses_what_it_cannot_write() {
    let folder = folder();
    let layers = ["a", "b"].map(|name| Layer::from(&shapes::cube().with_name(name)));
    write(&Model { layers: layers.into() }, folder.path("two.glb")).unwrap();
    let before = folder.names();
    for (arguments, said) in [
        ("prepare edge.obj -o out.stl --split", "--split: STL cannot keep"),
        ("prepare soup.ply -o out.stl --weld none", "--weld none: STL cannot keep"),
        ("prepare cube.obj -o out.xyz", "use .glb, .obj, .ply or .stl"),
        ("prepare cube.obj -o cube.obj", "would be overwritten"),
        ("prepare cube.obj -o nowhere/out.glb", "there is no folder"),
        ("prepare two.glb -o out.ply", "ply holds one mesh, and there are 2; name a .glb file"),
        ("prepare cube.obj -o out.glb --fill-anyway", "--fill"),
        ("prepare cube.obj -o out.glb --weld-within 0", "write a distance above 0"),
        ("prepare cube.obj -o out.glb --decimate", "--decimate"),
        ("prepare cube.obj", "--output"),
    ] {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments}");
        assert!(run.stderr.lines().count() == 1 && run.stderr.contains(said), "{arguments}: {}", run.stderr);
        assert_eq!(folder.names(), before, "{arguments}");
    }
    assert_eq!(folder.code("prepare two.glb -o out.glb"), 0);
    assert_eq!(folder.code("prepare two.glb -o out.ply --scope scene --weld none"), 0);
}

#[test]
fn prepare_writes_index_buffers_beside_the_mesh() {
    let folder = folder();
    let words = |name: &str| -> Vec<u32> {
        let bytes = fs::read(folder.path(name)).unwrap();
        bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
    };
    let buffers = "--shadow-indices shadow.bin --adjacency adjacent.bin";
    assert_eq!(folder.code(&format!("prepare soup.ply -o out.ply {buffers}")), 0);
    let soup = shapes::soup(&shapes::icosphere(1));
    let (shadow, adjacent) = (words("shadow.bin"), words("adjacent.bin"));
    assert_eq!((shadow.len(), adjacent.len()), (3 * 80, 6 * 80));
    for (index, corner) in shadow.iter().zip(soup.triangles().as_flattened()) {
        assert_eq!(soup.positions()[*index as usize], soup.positions()[*corner as usize]);
    }
    let mut distinct = shadow.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!(distinct.len(), 42);
    // Every second entry is a corner, and those between are none of the face.
    assert!(
        adjacent
            .chunks(6)
            .all(|row| !row.iter().step_by(2).any(|corner| [row[1], row[3], row[5]].contains(corner)))
    );
    let before = folder.names();
    let run = folder.run("prepare edge.obj -o new.ply --adjacency new.bin");
    assert!(run.code == 2 && run.stderr.contains("has 4 faces; add --split"), "{}", run.stderr);
    let unmet = folder.run("prepare open.obj -o new.ply --adjacency new.bin --require watertight");
    assert_eq!((unmet.code, folder.names()), (1, before));
    assert_eq!(folder.code("prepare edge.obj -o new.ply --adjacency new.bin --split"), 0);
    assert_eq!(words("new.bin").len(), 6 * 24);
}

#[test]
fn prepare_lists_edges_and_where_everything_went() {
    let folder = folder();
    let json =
        |name: &str| -> Value { serde_json::from_slice(&fs::read(folder.path(name)).unwrap()).unwrap() };
    let words = |name: &str| -> Vec<u32> {
        let bytes = fs::read(folder.path(name)).unwrap();
        bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
    };
    let numbers = |value: &Value| -> Vec<u32> {
        value.as_array().unwrap().iter().map(|number| number.as_u64().unwrap() as u32).collect()
    };
    for (file, options) in
        [("soup.ply", ""), ("edge.obj", " --split"), ("open.obj", ""), ("junction.obj", " --stitch")]
    {
        let all = "--edges edges.json --map map.json";
        assert_eq!(folder.code(&format!("prepare {file} -o out.ply{options} {all}")), 0, "{file}");
        assert_eq!(
            folder.code(&format!("prepare {file} -o out.ply{options} --edges edges.bin --map map.bin")),
            0
        );
        // The integers are those of the JSON.
        let (document, edges) = (json("edges.json"), words("edges.bin"));
        let listed = document["edges"].as_array().unwrap();
        assert_eq!(keys(&listed[0]), "a b faces multiplicity");
        let mut expected = vec![listed.len() as u32];
        for edge in listed {
            let faces = numbers(&edge["faces"]);
            let multiplicity = edge["multiplicity"].as_i64().unwrap() as u32;
            expected.extend([&edge["a"], &edge["b"]].map(|vertex| vertex.as_u64().unwrap() as u32));
            expected.extend([multiplicity, faces.len() as u32]);
            expected.extend(faces);
        }
        assert_eq!(edges, expected, "{file}");
        let check = folder.json("check out.ply --weld none");
        assert_eq!(check["files"][0]["total"]["edges"], listed.len(), "{file}");
        let open = listed.iter().filter(|edge| edge["faces"].as_array().unwrap().len() == 1).count();
        assert_eq!(check["files"][0]["total"]["boundary_edges"], open, "{file}");

        let (document, map) = (json("map.json"), words("map.bin"));
        assert_eq!(keys(&document), "vertices faces");
        let mut expected = Vec::new();
        for key in ["vertices", "faces"] {
            let lists: Vec<Vec<u32>> = document[key].as_array().unwrap().iter().map(numbers).collect();
            expected.extend([lists.len() as u32, 0]);
            expected.extend(lists.iter().scan(0, |end, list| {
                *end += list.len() as u32;
                Some(*end)
            }));
            expected.extend(lists.iter().flatten());
            assert!(lists.iter().all(|list| list.is_sorted()));
            let longest = lists.iter().map(Vec::len).max();
            let splits = match key {
                "vertices" => options == " --split",
                _ => options == " --stitch",
            };
            assert_eq!(longest, Some(if splits { 2 } else { 1 }), "{file} {key}");
        }
        assert_eq!(map, expected, "{file}");
    }
    // One mesh, and a file for each list.
    let layers = ["a", "b"].map(|name| Layer::from(&shapes::cube().with_name(name)));
    write(&Model { layers: layers.into() }, folder.path("two.glb")).unwrap();
    let before = folder.names();
    for (arguments, said) in [
        ("two.glb -o new.glb --edges e.json", "--edges is for one mesh, and there are 2"),
        ("two.glb -o new.glb --map m.bin", "--map is for one mesh"),
        ("open.obj -o new.glb --edges e.json --map e.json", "--map names a file that another option writes"),
        ("open.obj -o new.glb --edges open.obj", "would be overwritten"),
        ("open.obj -o new.glb --map nowhere/m.bin", "there is no folder"),
        ("open.obj -o new.glb --fill=0.5", "write a number of edges, or edges=N"),
        ("open.obj -o new.glb --fill=area=2", "length=D"),
    ] {
        let run = folder.run(&format!("prepare {arguments}"));
        assert!(run.code == 2 && run.stderr.contains(said), "{arguments}: {}", run.stderr);
        assert_eq!(folder.names(), before, "{arguments}");
    }
}

#[test]
fn prepare_leaves_holes_beyond_the_limits() {
    let folder = folder();
    // A hole of 4 edges, 8 around.
    for (limit, done) in [
        ("", (1, 0)),
        ("=4", (1, 0)),
        ("=3", (0, 1)),
        ("=length=8", (1, 0)),
        ("=length=7.99", (0, 1)),
        ("=edges=4,length=8", (1, 0)),
        ("=edges=3,length=8", (0, 1)),
        ("=edges=4,length=7", (0, 1)),
    ] {
        let document = folder.json(&format!("prepare open.obj -o out.glb --fill{limit}"));
        assert_eq!(step(&document, "fill"), done, "{limit}");
    }
    let run = folder.run("prepare open.obj -o out.glb --fill=length=7.99");
    assert!(run.stdout.contains("longer around than the limit"), "{}", run.stdout);
}

#[test]
fn prepare_writes_the_same_bytes_for_any_number_of_threads() {
    let folder = folder();
    let bytes = |threads: u32| {
        let run = folder.run(&format!("prepare missing.obj -o out.glb --fill --threads {threads}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        fs::read(folder.path("out.glb")).unwrap()
    };
    assert_eq!(bytes(1), bytes(4));
}

#[test]
fn prepare_closes_real_meshes_without_moving_a_vertex() {
    for (file, options, required) in [
        ("stanford_bunny_original.obj", "--fill", "sound"),
        ("cow_bowtie.obj", "--fill", "sound"),
        ("tray_bottom_1002.stl", "--fill", "sound"),
        // One hole has no patch between its vertices that meets nothing.
        ("many_small_holes.ply", "--fill --fill-anyway", "sound"),
        // The sockets of the eyes would be closed through the eyeballs.
        ("suzanne_ngons.obj", "--split --fill --fill-anyway", "sound"),
        // Double-sided sheets keep its edges non-manifold, but nothing is open.
        ("office_chair.obj", "--fill --fill-anyway", "not-empty"),
    ] {
        let Some(path) = real(file) else { return };
        let folder = Folder::new();
        let command = format!("prepare {} -o out.glb {options} --require {required}", path.display());
        let document = folder.json(&command);
        assert_eq!(document["verified"], true, "{file}");
        assert_eq!(step(&document, "fill").1, 0, "{file}");
        assert_eq!(document["after"]["boundary_edges"], 0, "{file}");
        let moves = document["steps"].as_array().unwrap().iter().map(|step| &step["largest_move"]);
        assert!(moves.into_iter().all(|largest| *largest == 0.0), "{file}");
        let gone: u64 = ["collapsed", "duplicates"].iter().map(|&name| step(&document, name).0).sum();
        let faces = |state: &str| document[state]["faces"].as_u64().unwrap();
        assert!(faces("after") >= faces("before") - gone, "{file}");
        let weld = if options.contains("--split") { " --weld none" } else { "" };
        assert_eq!(folder.code(&format!("check out.glb --require {required}{weld}")), 0, "{file}");
    }
}

#[test]
fn prepare_closes_each_hole_of_real_meshes_that_has_a_patch_and_proves_that_the_rest_have_none() {
    for (file, closed, left) in
        [("many_small_holes.ply", 37, 1), ("suzanne_ngons.obj", 2, 2), ("office_chair.obj", 13, 2)]
    {
        let Some(path) = real(file) else { return };
        let folder = Folder::new();
        let document = folder.json(&format!("prepare {} -o out.glb --fill", path.display()));
        assert_eq!(step(&document, "fill"), (closed, left), "{file}");
        let steps = document["steps"].as_array().unwrap();
        let fill = steps.iter().find(|step| step["name"] == "fill").unwrap();
        let changes = fill["changes"].as_array().unwrap().iter();
        let reasons: Vec<_> = changes.filter_map(|change| change["patch"]["left"].as_str()).collect();
        assert_eq!(
            reasons,
            vec!["every patch between its vertices would meet other faces"; left as usize],
            "{file}"
        );
    }
}
