//! Input files: which are read, in which format, and that they are never changed.

use std::fs;

use umbrage::testing::shapes;

use super::Folder;

#[cfg(unix)]
#[test]
fn input_that_is_a_pipe_is_refused_at_once() {
    let folder = Folder::new();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap();
    assert!(made.success());
    let run = folder.run("check pipe");
    assert_eq!(run.code, 2);
    assert_eq!(run.stderr, "umbrage: pipe: is not a regular file; name a mesh file\n");
    let document = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"pipe","byteLength":36}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}"#;
    fs::write(folder.path("a.gltf"), document).unwrap();
    let run = folder.run("check a.gltf");
    assert!(run.code == 2 && run.stderr.contains("`pipe` is not a regular file"), "{}", run.stderr);
}

#[test]
fn input_is_never_overwritten() {
    let folder = Folder::new();
    folder.mesh("a.obj", &shapes::open_cube());
    folder.mesh("a.glb", &shapes::open_cube());
    fs::copy(folder.path("a.obj"), folder.path("a.png")).unwrap();
    let before = ["a.obj", "a.glb", "a.png"].map(|name| fs::read(folder.path(name)).unwrap());
    let mut asked = vec![
        "silhouette a.obj -o a.obj",
        "volume a.glb -o ./a.glb",
        "check a.glb --mark a.glb",
        "check a.png --picture a.png",
        "render a.png -o a.png",
    ];
    if cfg!(unix) {
        #[cfg(unix)]
        std::os::unix::fs::symlink("a.obj", folder.path("link.obj")).unwrap();
        asked.extend(["silhouette a.obj -o link.obj", "volume link.obj -o a.obj"]);
    }
    for arguments in asked {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments}");
        assert!(run.stderr.contains("names the input file"), "{}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    }
    assert_eq!(["a.obj", "a.glb", "a.png"].map(|name| fs::read(folder.path(name)).unwrap()), before);
    assert_eq!(folder.code("silhouette a.obj -o other.obj"), 0);
    assert_eq!(
        folder.run("silhouette a.obj --light point:1,2,3 -o other.obj").stderr,
        "umbrage: wrote other.obj\n"
    );
}

#[test]
fn input_in_obj_format_is_told_by_its_content() {
    let folder = Folder::with_cubes();
    let text = fs::read_to_string(folder.path("cube.obj")).unwrap();
    for name in ["cube", "cube.txt", "cube.stl", "cube.glb"] {
        fs::write(folder.path(name), &text).unwrap();
        let document = folder.json(&format!("check {name}"));
        assert_eq!((&document["files"][0]["format"], &document["verdict"]), (&"obj".into(), &"sound".into()));
    }
    for (name, content, said) in [
        ("comment", "# nothing yet\n", ""),
        ("note", "see the other file\n", "neither the content nor the extension tells the format"),
        ("note.glb", "see the other file\n", "the content is text, but not that of a file in glb format"),
        ("note.stl", "see the other file\n", "the content is text, but not that of a file in stl format"),
        ("note.bin", "v\0\0\0", "neither the content nor the extension tells the format"),
    ] {
        fs::write(folder.path(name), content).unwrap();
        let run = folder.run(&format!("check {name}"));
        assert_eq!(run.code, if said.is_empty() { 1 } else { 2 }, "{name}: {}", run.stderr);
        assert!(run.stderr.contains(said), "{name}: {}", run.stderr);
    }
}

#[test]
fn input_without_faces_is_noted_by_every_command() {
    let folder = Folder::new();
    fs::write(folder.path("empty.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    fs::write(folder.path("point.obj"), "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\nf 3 2 1\n").unwrap();
    for (file, said) in
        [("empty.obj", "there are no faces"), ("point.obj", "all 2 faces collapse when welded")]
    {
        for command in ["check", "silhouette", "volume", "verify --points 100", "render --size 8x8 -o a.png"]
        {
            let run = folder.run(&format!("{command} {file}"));
            assert_eq!(run.code, i32::from(command == "check"), "{command} {file}: {}", run.stderr);
            assert!(run.stderr.contains(&format!("note: {file}: {said}")), "{command}: {}", run.stderr);
        }
        let text = folder.run(&format!("check {file}")).stdout;
        assert!(text.contains("empty: there are no faces to check"), "{text}");
    }
}

#[test]
fn check_reads_standard_input_and_the_mesh_files_of_a_folder() {
    let folder = Folder::with_cubes();
    fs::create_dir_all(folder.path("assets/deeper")).unwrap();
    fs::create_dir(folder.path("empty")).unwrap();
    fs::copy(folder.path("cube.obj"), folder.path("assets/b.obj")).unwrap();
    fs::copy(folder.path("cube.obj"), folder.path("assets/deeper/a.OBJ")).unwrap();
    fs::write(folder.path("assets/notes.txt"), "no mesh").unwrap();
    let document = folder.json("check assets cube.obj");
    let files: Vec<&str> =
        document["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    assert_eq!(files, ["assets/b.obj", "assets/deeper/a.OBJ", "cube.obj"]);
    let run = folder.run("check empty cube.obj");
    assert!(
        run.code == 2 && run.stderr.contains("empty: is a directory without mesh files"),
        "{}",
        run.stderr
    );
    assert!(run.stdout.contains("cube.obj"), "the others are still done");

    let bytes = fs::read(folder.path("cube.obj")).unwrap();
    let piped = folder.command("check - --json").write_stdin(bytes).output().unwrap();
    let from_file = folder.run("check cube.obj --json").stdout;
    assert_eq!(String::from_utf8(piped.stdout).unwrap(), from_file.replace("cube.obj", "-"));
    let nothing = folder.command("check -").write_stdin("").output().unwrap();
    assert_eq!(nothing.status.code(), Some(2));
    assert!(String::from_utf8(nothing.stderr).unwrap().contains("-: the file is empty"));
}
