//! What of a scene is drawn and verified: lamps, cameras, materials, names.

use std::fs;

use umbrage::testing::shapes;

use super::Folder;
use super::render::png;
use crate::support::gpu;

/// A red cube beside one of glass, with a library; then a floor of no material.
fn materials(folder: &Folder) {
    let mut text = "mtllib colors.mtl\n".to_owned();
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 9.0), [-4.5, -4.5, -1.0]);
    let meshes = [
        ("Red", shapes::cube()),
        ("Glass", shapes::translated(&shapes::cube(), [2.0, 0.0, 0.0])),
        ("", floor),
    ];
    let mut first = 1;
    for (name, mesh) in meshes {
        text += &format!("o {}\nusemtl {name}\n", if name.is_empty() { "Floor" } else { "Box" });
        mesh.positions().iter().for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
        for corners in mesh.triangles() {
            text += &corners.iter().fold("f".to_owned(), |line, corner| format!("{line} {}", corner + first));
            text += "\n";
        }
        first += mesh.vertex_count() as u32;
    }
    fs::write(folder.path("boxes.obj"), text).unwrap();
    let library =
        "# Kd\nnewmtl Red\nKd 0.8 0.05 0.05\nnewmtl Glass\nKd 0.1 0.1 0.9\nTr 1\nnewmtl bad\nKd x\n";
    fs::write(folder.path("colors.mtl"), library).unwrap();
}

const VIEW: &str = "--eye 1,1,9 --target 1,0,0 --size 64x48 --method rays --light point:1,5,8 -o";

fn reddish(pixels: &[u8]) -> usize {
    pixels.chunks(4).filter(|pixel| pixel[0] > 80 && pixel[1].max(pixel[2]) < pixel[0] / 2).count()
}

#[test]
fn material_library_colors_what_is_drawn_and_hides_what_is_invisible() {
    let folder = Folder::new();
    materials(&folder);
    let run = folder.run(&format!("render boxes.obj {VIEW} colored.png"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("note: boxes.obj: left out, for these materials are invisible: Glass\n"));
    assert!(run.stderr.contains("material `bad` of `colors.mtl` not read"), "{}", run.stderr);
    let (.., colored) = png(&folder, "colored.png");
    assert!(reddish(&colored) > 50, "{}", reddish(&colored));

    // The invisible box neither is seen nor casts: the picture is that of the file without it.
    let text = fs::read_to_string(folder.path("boxes.obj")).unwrap();
    let (before, rest) = text.split_once("usemtl Glass\n").unwrap();
    let (glass, after) = rest.split_once("o Floor\n").unwrap();
    let vertices: String =
        glass.lines().filter(|line| line.starts_with('v')).map(|v| format!("{v}\n")).collect();
    fs::write(folder.path("without.obj"), format!("{before}{vertices}o Floor\n{after}")).unwrap();
    assert_eq!(folder.code(&format!("render without.obj {VIEW} without.png")), 0);
    assert!(png(&folder, "without.png").2 == colored);
    let edges = |file: &str| folder.json(&format!("silhouette {file} --light point:1,5,8"));
    assert_eq!(edges("boxes.obj")["lights"], edges("without.obj")["lights"]);
    // The crack report is about the file as it is stored.
    assert_eq!(folder.json("check boxes.obj")["files"][0]["meshes"][0]["faces"], 12 + 12 + 2);

    // Without the library everything is there, of clay, and a note says what to do.
    fs::remove_file(folder.path("colors.mtl")).unwrap();
    let run = folder.run(&format!("render boxes.obj {VIEW} clay.png"));
    let remedy = "put it into the folder of the file for colors";
    assert!(run.code == 0 && run.stderr.contains("material library `colors.mtl` not read"), "{}", run.stderr);
    assert!(run.stderr.contains(remedy), "{}", run.stderr);
    let (.., clay) = png(&folder, "clay.png");
    assert!(clay != colored && reddish(&clay) == 0, "{}", reddish(&clay));
    fs::write(folder.path("boxes.obj"), text.replace("colors.mtl", "../colors.mtl")).unwrap();
    assert!(folder.run("check boxes.obj").stderr.contains("its path leaves the folder of the file"));
}

#[test]
fn only_loads_what_has_such_a_name() {
    let folder = Folder::new();
    materials(&folder);
    let faces =
        |only: &str| folder.json(&format!("check boxes.obj{only}"))["files"][0]["meshes"][0]["faces"].clone();
    for (only, wanted) in
        [("", 26), (" --only Box", 24), (" --only Red", 12), (" --only Fl*r --only ?ed", 14)]
    {
        assert_eq!(faces(only), wanted, "{only}");
    }
    for command in ["check", "silhouette", "volume", "verify", "render -o a.png", "accuracy facing"] {
        let run = folder.run(&format!("{command} boxes.obj --only Box --only red"));
        assert_eq!(run.code, 2, "{command}");
        let wanted = "boxes.obj: --only red: nothing has such a name; use a name of the file, such as: ";
        assert!(run.stderr.contains(wanted) && run.stderr.contains("Red"), "{}", run.stderr);
    }
}

#[test]
fn no_cast_leaves_receivers_in_the_picture_and_out_of_the_shadows() {
    let folder = Folder::new();
    materials(&folder);
    // The light comes from below the floor: the red box is lit only if the floor does not cast.
    let view = "--eye 1,-9,0.5 --target 0,0,0 --size 64x48 --samples 1 --light point:0.5,-5,-5";
    let lit = |rest: &str| {
        let run = folder.run(&format!("render boxes.obj {view} {rest} -o a.png"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        let (.., pixels) = png(&folder, "a.png");
        (pixels.chunks(4).filter(|pixel| pixel[0] > 120 && pixel[1] < 90).count(), pixels)
    };
    let methods: &[&str] = if gpu().is_some() { &["rays", "zfail"] } else { &["rays"] };
    for method in methods {
        let (all, pixels) = lit(&format!("--shadow {method}"));
        let (without, received) = lit(&format!("--shadow {method} --no-cast Fl*"));
        assert!(all == 0 && without > 100, "{method}: {all} {without}");
        // The floor is still there: its pixels are those of before, in the light as they were.
        let same = pixels.chunks(4).zip(received.chunks(4)).filter(|(a, b)| a == b).count();
        assert!(same > 1000, "{method}: {same}");
    }
    // Pixels are compared with the shadows of the casters alone, wherever these fall.
    if gpu().is_some() {
        for no_cast in ["Fl*", "Red"] {
            let run = folder.run(&format!(
                "verify boxes.obj --points 100 --light point:1,-5,8 --gpu --size 64x48 --no-cast {no_cast}"
            ));
            assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        }
        let run = folder
            .run("accuracy shadow boxes.obj --light point:1,-5,8 --size 64x48 --rounds 1 --no-cast Red");
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        assert!(run.stdout.contains("device") && run.stdout.contains("every claim holds"), "{}", run.stdout);
    }
    // Silhouettes are those of the casters alone.
    let edges = |rest: &str| {
        folder.json(format!("silhouette boxes.obj --light point:1,5,8 {rest}").trim_end())["lights"].clone()
    };
    assert_eq!(edges("--no-cast Floor"), edges("--only Red"));
    assert_ne!(edges("--no-cast Floor"), edges(""));
    let run = folder.run("verify boxes.obj --points 100 --light point:1,5,8 --no-cast floor");
    assert_eq!(run.code, 2);
    assert!(
        run.stderr.contains("boxes.obj: --no-cast floor: nothing has such a name; use a name"),
        "{}",
        run.stderr
    );
}

#[test]
fn falloff_is_plain_unless_asked_for() {
    let folder = Folder::with_cubes();
    let picture = |rest: &str| {
        let run = folder.run(&format!("render cube.obj --ground --size 64x48 --method rays -o a.png {rest}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        png(&folder, "a.png").2
    };
    let light = "--light point:1.4,1.8,1.6";
    let plain = picture(light);
    assert!(plain == picture(&format!("{light} --falloff plain")));
    assert!(plain == picture(&format!("{light},range=2")), "a range is for physical falloff");
    let note = "note: a light's range is not applied: --falloff physical ends the light there";
    for (rest, noted) in [("", false), (",range=2", true), (",range=2 --falloff physical", false)] {
        let run = folder.run(&format!("render cube.obj --size 8x8 --method rays -o a.png {light}{rest}"));
        assert_eq!(run.stderr.contains(note), noted, "{rest}: {}", run.stderr);
    }
    let physical = picture(&format!("{light} --falloff physical"));
    let ending = picture(&format!("{light},range=2 --falloff physical"));
    let sum = |pixels: &[u8]| pixels.iter().map(|&byte| u64::from(byte)).sum::<u64>();
    assert!(physical != plain);
    let (whole, cut) = (sum(&physical), sum(&ending));
    assert!(cut < whole, "{cut} {whole}");
    // A spot light lights less than the point that it shines from.
    assert!(sum(&picture("--light spot:1.4,1.8,1.6:-1,-1,-1:10")) < sum(&plain));
}

#[test]
fn light_that_is_wrong_is_refused_by_its_part() {
    let folder = Folder::with_cubes();
    for (light, wanted) in [
        (
            "point:1,2",
            "`point:1,2`: the position is 2 numbers, not 3; write point:X,Y,Z[,radius=R][,range=D]\n",
        ),
        ("spot:1,2,3:0,-1,0:95", "the outer angle 95 is not above 0 and at most 90 degrees; write spot:"),
        ("point:1,2,3,range=x", "range `x` is not a number of mesh units above 0; write point:"),
        ("point:1,2,3,radius=-1", "radius `-1` is not a number of mesh units, 0 or more; write point:"),
        ("rect:0,3,0:1,0,0:2,0,0", "the edges [1.0, 0.0, 0.0] and [2.0, 0.0, 0.0] span no area"),
    ] {
        for command in
            ["silhouette cube.obj", "volume cube.obj", "verify cube.obj", "render cube.obj -o a.png"]
        {
            let run = folder.run(&format!("{command} --light {light}"));
            assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{light}");
            assert!(run.stderr.contains(wanted), "{light}: {}", run.stderr);
        }
    }
}

#[test]
fn light_with_an_extent_casts_hard_shadows_from_its_center_and_says_so() {
    let folder = Folder::with_cubes();
    for (light, center) in [
        ("point:1,2,3,radius=1", "point:1,2,3"),
        ("directional:0,-1,0,angle=0.266", "directional:0,-1,0"),
        ("rect:0,3,0:1,0,0:0,0,1", "point:0.5,3,0.5"),
    ] {
        for command in ["silhouette cube.obj --json", "render cube.obj --shadow rays --size 40x30 -o a.png"] {
            let [soft, hard] = [light, center].map(|light| {
                let run = folder.run(&format!("{command} --light {light}"));
                assert_eq!(run.code, 0, "{}", run.stderr);
                (run.stdout, png_bytes(&folder, command), run.stderr)
            });
            assert_eq!((soft.0, soft.1), (hard.0, hard.1), "{light}");
            let note = format!("note: {light}: hard shadows, of its center: {center}");
            assert!(soft.2.contains(&note) && !hard.2.contains("of its center"), "{}", soft.2);
        }
        // A soft technique does not say so, and makes another picture.
        let run = folder.run(&format!(
            "render cube.obj --ground --shadow samples:n=9 --size 40x30 -o s.png --light {light}"
        ));
        assert!(run.code == 0 && !run.stderr.contains("of its center"), "{}", run.stderr);
        assert!(run.stderr.contains(&format!("note: {light}: samples:n=9, on the CPU")), "{}", run.stderr);
    }
}

/// What a command wrote as `a.png`, if it draws.
fn png_bytes(folder: &Folder, command: &str) -> Option<Vec<u8>> {
    command.contains("a.png").then(|| png(folder, "a.png").2)
}

#[test]
fn camera_that_cannot_be_used_stops_only_what_asks_for_it() {
    let folder = Folder::new();
    folder.mesh("cube.glb", &shapes::cube());
    let mut document = document_beside(&folder, "cube.glb", "cube.bin");
    document["cameras"] = serde_json::json!([
        {"name": "wide", "perspective": {"yfov": 3.5, "znear": 0.1}},
        {"name": "front", "perspective": {"yfov": 0.6, "znear": 0.1}}
    ]);
    let nodes = document["nodes"].as_array_mut().unwrap();
    let first = nodes.len();
    nodes.extend([0, 1].map(|camera| serde_json::json!({"camera": camera, "translation": [0, 0, 4]})));
    document["scenes"][0]["nodes"].as_array_mut().unwrap().extend([first, first + 1].map(Into::into));
    fs::write(folder.path("cube.gltf"), document.to_string()).unwrap();

    let why = "its yfov is 3.5, but must be more than 0 and less than pi";
    let run = folder.run("check cube.gltf");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(
        run.stderr.contains(&format!("note: cube.gltf: camera 0: camera left out: {why}\n")),
        "{}",
        run.stderr
    );
    for camera in ["front", "2"] {
        assert_eq!(
            folder.code(&format!("render cube.gltf --size 8x8 --method rays -o a.png --camera {camera}")),
            0
        );
    }
    for camera in ["wide", "1"] {
        let run =
            folder.run(&format!("render cube.gltf --size 8x8 --method rays -o b.png --camera {camera}"));
        let wanted =
            format!("cube.gltf: --camera {camera}: the camera cannot be used: {why}; choose another camera");
        assert!(run.code == 2 && run.stderr.contains(&wanted), "{}", run.stderr);
    }
    assert!(!folder.path("b.png").exists());
}

/// The document of a GLB, whose buffer is written to a file of its own.
fn document_beside(folder: &Folder, glb: &str, bin: &str) -> serde_json::Value {
    let glb = fs::read(folder.path(glb)).unwrap();
    let json_bytes = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut document: serde_json::Value = serde_json::from_slice(&glb[20..20 + json_bytes]).unwrap();
    fs::write(folder.path(bin), &glb[28 + json_bytes..]).unwrap();
    document["buffers"][0]["uri"] = bin.into();
    document
}

#[test]
fn camera_of_the_file_is_chosen_and_an_orthographic_one_drawn_by_rays() {
    let folder = Folder::new();
    folder.mesh("cube.glb", &shapes::cube());
    let mut document = document_beside(&folder, "cube.glb", "cube.bin");
    document["cameras"] = serde_json::json!([
        {"type": "perspective", "name": "front", "perspective": {"yfov": 0.6, "znear": 0.1}},
        {"type": "orthographic", "name": "plan", "orthographic": {"xmag": 2, "ymag": 2, "znear": 0.1, "zfar": 9}}
    ]);
    let nodes = document["nodes"].as_array_mut().unwrap();
    let first = nodes.len();
    nodes.extend([0, 1].map(|camera| serde_json::json!({"camera": camera, "translation": [0, 0, 4]})));
    document["scenes"][0]["nodes"].as_array_mut().unwrap().extend([first, first + 1].map(Into::into));
    fs::write(folder.path("cube.gltf"), document.to_string()).unwrap();

    let picture = |rest: &str| {
        let run =
            folder.run(format!("render cube.gltf --size 64x64 --method rays -o a.png {rest}").trim_end());
        assert_eq!(run.code, 0, "{rest}: {}", run.stderr);
        png(&folder, "a.png").2
    };
    let front = picture("");
    assert!(front == picture("--camera front") && front == picture("--camera 1"));
    let plan = picture("--camera plan");
    assert!(plan != front && plan == picture("--camera 2"));
    assert!(plan == picture("--eye 0,0,4 --target 0,0,0 --ortho 4"));
    // The cube is two units wide and the picture shows four: a quarter of the pixels differs from the background.
    let empty = picture("--camera plan --near 6");
    let covered = plan.chunks(4).zip(empty.chunks(4)).filter(|(a, b)| a != b).count();
    assert!((31 * 31..=33 * 33).contains(&covered), "{covered}");
    assert!(front != picture("--near 3.8"), "the near plane cuts the front off");

    for (rest, wanted) in [
        (
            "--camera side",
            "--camera side: the file has no such camera; use a number from 1 to 2, or a name: front, plan",
        ),
        ("--camera plan --eye 1,2,3 --target 0,0,0", "cannot be used with"),
        ("--ortho 3", "--eye"),
        ("--eye 1,2,3 --target 0,0,0 --ortho 0", "write a distance above 0 in mesh units"),
        ("--near -1", "write a distance above 0 in mesh units"),
    ] {
        let run = folder.run(&format!("render cube.gltf --method rays -o a.png {rest}"));
        assert!(run.code == 2 && run.stderr.contains(wanted), "{rest}: {}", run.stderr);
    }
    if gpu().is_some() {
        for command in ["render -o a.png --method zfail", "verify --gpu --points 10"] {
            let run = folder.run(&format!("{command} cube.gltf --size 64x64 --camera plan"));
            let wanted = "not built yet: an orthographic camera on a graphics adapter; ";
            assert!(run.code == 2 && run.stderr.contains(wanted), "{command}: {}", run.stderr);
        }
        // The planner's are of the CPU.
        let run = folder.run("render cube.gltf --size 64x64 --camera plan -o b.png");
        assert!(run.code == 0 && run.stderr.contains("samples compared, 0 wrong"), "{}", run.stderr);
    }
}
