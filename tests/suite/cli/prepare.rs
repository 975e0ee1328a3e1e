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
    assert!(run.code == 0 && run.stdout.contains("the patch would meet other faces"), "{}", run.stdout);
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
    for (file, options, holes) in [
        ("many_small_holes.ply", "--fill", Some(0)),
        ("stanford_bunny_original.obj", "--fill", Some(0)),
        ("cow_bowtie.obj", "--fill", Some(0)),
        ("tray_bottom_1002.stl", "--fill", Some(0)),
    ] {
        let Some(path) = real(file) else { return };
        let folder = Folder::new();
        let document =
            folder.json(&format!("prepare {} -o out.glb {options} --require watertight", path.display()));
        assert_eq!(document["verified"], true, "{file}");
        let left = step(&document, "fill").1;
        assert_eq!(Some(left), holes, "{file}");
        let moves = document["steps"].as_array().unwrap().iter().map(|step| &step["largest_move"]);
        assert!(moves.into_iter().all(|largest| *largest == 0.0), "{file}");
        assert_eq!(folder.code("check out.glb --require watertight"), 0, "{file}");
    }
}
