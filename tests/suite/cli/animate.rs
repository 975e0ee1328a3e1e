//! Poses on the command line: `--time`, `--frame`, `--clip`, `--fps`, `render --animate`, `check --all-frames`.

use std::fs;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::json;
use umbrage::testing::shapes;

use super::Folder;
use super::schema;

/// A cube that a morph target turns inside out, by the clip `turn`: whole at 0 s and 2 s, inside out at 1 s.
/// The clip `still` is the cube at rest.
pub(super) fn folder() -> Folder {
    let folder = Folder::with_cubes();
    let cube = shapes::cube();
    let mut bytes = Vec::new();
    let mut views = Vec::new();
    let mut add = |part: Vec<u8>| {
        views.push(json!({"buffer": 0, "byteOffset": bytes.len(), "byteLength": part.len()}));
        bytes.extend(part);
    };
    let f32s = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let positions = cube.positions().as_flattened();
    add(f32s(positions));
    add(f32s(&positions.iter().map(|x| -2.0 * x).collect::<Vec<f32>>()));
    add(cube.triangles().as_flattened().iter().flat_map(|corner| corner.to_le_bytes()).collect());
    add(f32s(&[0.0, 1.0, 2.0]));
    add(f32s(&[0.0, 1.0, 0.0]));
    add(f32s(&[0.0; 3]));
    let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&bytes));
    let clip = |name: &str, output: u32| {
        json!({
            "name": name,
            "samplers": [{"input": 3, "output": output}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
        })
    };
    let scalars =
        |view: u32| json!({"bufferView": view, "componentType": 5126, "type": "SCALAR", "count": 3});
    let vectors = |view: u32| json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 8});
    let indices = json!({"bufferView": 2, "componentType": 5125, "type": "SCALAR", "count": 36});
    let primitive = json!({"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}], "indices": 2});
    let document = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        "accessors": [vectors(0), vectors(1), indices, scalars(3), scalars(4), scalars(5)],
        "bufferViews": views,
        "buffers": [{"byteLength": bytes.len(), "uri": uri}],
        "animations": [clip("turn", 4), clip("still", 5)],
    });
    fs::write(folder.path("moving.gltf"), serde_json::to_vec(&document).unwrap()).unwrap();
    folder
}

#[test]
fn pose_is_that_of_the_time_the_frame_and_the_clip() {
    let folder = folder();
    let posed =
        |options: &str| folder.json(format!("check moving.gltf {options}").trim())["files"][0].clone();
    let is_inward = |options: &str| posed(options)["total"]["inside_out_shells"] != 0;
    for (options, wanted) in [
        ("", false),
        ("--time 0", false),
        ("--time 1", true),
        ("--time 0.75", true),
        ("--time 0.25", false),
        ("--time 9", false),
        ("--time -3", false),
        ("--frame 24", true),
        ("--frame 1 --fps 1", true),
        ("--time 1 --clip turn", true),
        ("--time 1 --clip 2", false),
        ("--time 1 --clip still", false),
        ("--clip turn", false),
    ] {
        assert_eq!(is_inward(options), wanted, "{options}");
    }
    // Not asked for, nothing is said but that it is not done; asked for, nothing of that.
    let run = folder.run("check moving.gltf");
    assert!(run.stderr.contains("animation 0 and 1 more: animation ignored"), "{}", run.stderr);
    let run = folder.run("check moving.gltf --time 1");
    assert!(!run.stderr.contains("animation ignored"), "{}", run.stderr);
    let run = folder.run("check moving.gltf --time 9");
    assert!(run.stderr.contains("time 9 s is outside of clip turn (0 to 2 s)"), "{}", run.stderr);
    let run = folder.run("check cube.obj --time 1");
    assert!(run.code == 0 && run.stderr.contains("nothing in it moves"), "{}", run.stderr);
    assert_eq!(run.stdout, folder.run("check cube.obj").stdout);
}

#[test]
fn pose_that_is_none_is_refused_with_a_remedy() {
    let folder = folder();
    for (arguments, said) in [
        ("check moving.gltf --time nan", "write a finite number of seconds"),
        ("check moving.gltf --frame -1", "write a whole number from 0"),
        ("check moving.gltf --time 1 --frame 1", "cannot be used with"),
        ("check moving.gltf --fps 3", "--fps without a moment; add --time or --frame"),
        ("check moving.gltf --time 1 --fps 0", "write a number of frames above 0"),
        ("check moving.gltf --clip walk", "no such clip; use a number from 1 to 2, or a name: turn, still"),
        ("check moving.gltf --time 1 --clip 3", "no such clip"),
        ("check cube.obj --clip walk", "nor any other; leave out --clip"),
        ("check moving.gltf --fast --time 1", "--fast only decides"),
        ("check cube.obj --all-frames", "nothing in the file moves over time"),
        ("check moving.gltf --all-frames --time 1", "cannot be used with"),
        ("check moving.gltf --all-frames --fps 100000", "--all-frames: 200001 frames are too many"),
        ("render moving.gltf", "--output <OUT.png>"),
        ("render moving.gltf --animate a.png -o b.png", "cannot be used with"),
        ("render moving.gltf --animate a.gif", "name a file that ends in .png or .apng"),
        ("render moving.gltf --animate a_%d.png --fps 1e6", "--animate: 2000001 frames are too many"),
        ("render moving.gltf --animate a_%d.png --from -1e300 --to 1e300", "frames are too many"),
        ("check moving.gltf --frame 5 --fps 1e-320", "time is inf, which is no time; write a finite number"),
        ("render moving.gltf --animate a_%d.png --from 2 --to 1", "--to 1 is before --from 2; exchange"),
        ("render moving.gltf --animate a.png --shadow plan.json", "a saved plan is for one picture"),
        ("render moving.gltf --animate none/a_%d.png", "there is no folder none"),
        ("render cube.obj --animate a_%d.png", "nothing in the file moves over time"),
        ("render moving.gltf --from 1 -o a.png", "--from is for --animate; add --animate"),
    ] {
        let run = folder.run(arguments);
        assert_eq!(run.code, 2, "{arguments}: {}", run.stderr);
        assert!(run.stderr.contains(said), "{arguments}: {}", run.stderr);
    }
}

#[test]
fn pose_reaches_every_command_that_takes_a_light() {
    let folder = folder();
    let light = "--light point:3,5,4";
    for command in [
        "silhouette moving.gltf --json",
        "volume moving.gltf -o out.obj --json",
        "verify moving.gltf --points 60 --json",
        "plan moving.gltf --size 32x32 --json",
        "accuracy facing moving.gltf --queries 500 --rounds 1 --json",
    ] {
        let run = folder.run(&format!("{command} {light} --time 0.25"));
        assert_eq!(run.code, 0, "{command}: {}", run.stderr);
    }
    // At 0.25 s the cube has half its size.
    folder.run(&format!("volume moving.gltf {light} -o rest.obj"));
    folder.run(&format!("volume moving.gltf {light} -o posed.obj --time 0.25"));
    let [rest, posed] = ["rest.obj", "posed.obj"].map(|name| fs::read(folder.path(name)).unwrap());
    assert_ne!(rest, posed);
    folder.run(&format!("volume moving.gltf {light} -o again.obj --time 0"));
    assert_eq!(fs::read(folder.path("again.obj")).unwrap(), rest);
}

#[test]
fn check_of_all_frames_tells_what_only_some_poses_have() {
    let folder = folder();
    let document = folder.json("check moving.gltf --all-frames");
    schema::require(&document);
    let frames = &document["files"][0]["frames"];
    assert_eq!((&frames["count"], &frames["clip"]), (&json!(3), &json!("turn")));
    let found = json!([{"kind": "inside_out_shell", "frames": 1, "first": 1, "worst": 1, "most": 1}]);
    assert_eq!(frames["kinds"], found);
    assert_eq!(frames["list"][1]["time"], 1.0);
    assert_eq!(frames["list"][1]["defects"]["inside_out_shell"], 1);
    assert_eq!((&document["verdict"], &frames["verdict"]), (&json!("cracked"), &json!("cracked")));
    let run = folder.run("check moving.gltf --all-frames");
    assert_eq!(run.code, 1);
    assert!(run.stdout.contains("cracked: 1 of 3 poses of clip turn"), "{}", run.stdout);
    let row = run.stdout.lines().find(|line| line.contains("inside_out_shell")).unwrap();
    let words: Vec<&str> = row.split_whitespace().collect();
    assert_eq!(words, ["inside_out_shell", "(only", "some)", "1", "1", "s", "1", "1", "s"]);
    // A case of its own for build servers: the first pose alone is sound.
    let junit = |clip: &str| {
        folder.run(&format!("check moving.gltf --all-frames --clip {clip} --junit out.xml"));
        fs::read_to_string(folder.path("out.xml")).unwrap()
    };
    let turned = junit("turn");
    assert!(
        turned.contains("tests=\"2\" failures=\"1\"") && turned.contains("name=\"all poses\""),
        "{turned}"
    );
    assert!(turned.contains("1 of 3 poses: INSIDE_OUT_SHELL"), "{turned}");
    assert!(junit("still").contains("tests=\"2\" failures=\"0\""));
    // A clip in which nothing is wrong; more poses than keys.
    assert_eq!(folder.code("check moving.gltf --all-frames --clip still"), 0);
    let many = folder.json("check moving.gltf --all-frames --fps 4");
    assert_eq!(many["files"][0]["frames"]["count"], 9);
    // At 0.5 s and at 1.5 s all vertices are one point, and every face is without an area.
    assert_eq!(many["files"][0]["frames"]["list"][2]["defects"]["zero_area_face"], 12);
    // Not asked for, the key is not there.
    assert!(folder.json("check moving.gltf")["files"][0].get("frames").is_none());
}

#[test]
fn render_of_an_animation_is_the_pictures_of_its_times() {
    let folder = folder();
    let view = "--eye 4,3,6 --target 0,0,0 --light point:3,5,4 --size 24x16 --shadow rays";
    let run = folder.run(&format!("render moving.gltf {view} --animate a_%02d.png --fps 2"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    let said: Vec<&str> = run.stderr.lines().collect();
    assert_eq!(said.len(), 2, "the frames are noted once: {said:?}");
    assert_eq!(said[1], "umbrage: wrote 5 pictures, a_00.png to a_04.png");
    for frame in 0..5 {
        let time = f64::from(frame) / 2.0;
        assert_eq!(folder.code(&format!("render moving.gltf {view} --time {time} -o b.png")), 0);
        let [a, b] = [format!("a_0{frame}.png"), "b.png".to_owned()];
        assert_eq!(fs::read(folder.path(&a)).unwrap(), fs::read(folder.path(&b)).unwrap(), "{a}");
    }
    assert!(!folder.path("a_05.png").exists());
    // Some of the clip as one file: the same pixels.
    let run = folder.run(&format!("render moving.gltf {view} --animate c.png --fps 2 --from 0.5 --to 1"));
    assert!(run.code == 0 && run.stderr.ends_with("umbrage: wrote c.png\n"), "{}", run.stderr);
    let bytes = fs::read(folder.path("c.png")).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    assert_eq!(reader.info().animation_control.unwrap().num_frames, 2);
    for name in ["a_01.png", "a_02.png"] {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, super::render::png(&folder, name).2, "{name}");
    }
    // One camera for all: the fitted one does not follow the cube as it shrinks.
    let plain = "--light point:3,5,4 --size 24x16 --shadow rays --fps 2";
    assert_eq!(
        folder.code(&format!("render moving.gltf {plain} --animate d_%d.png --from 0.25 --to 0.25")),
        0
    );
    assert_eq!(folder.code(&format!("render moving.gltf {plain} --animate e_%d.png --from 0 --to 0.5")), 0);
    let near = fs::read(folder.path("d_0.png")).unwrap();
    assert_ne!(near, fs::read(folder.path("e_0.png")).unwrap());
}
