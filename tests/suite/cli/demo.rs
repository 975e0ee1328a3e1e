//! `umbrage demo`.

use super::Folder;

#[test]
fn demo_does_all_of_it_and_its_files_can_be_read() {
    let folder = Folder::new();
    let run = folder.run("demo --out here/and/there");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains("verdict: all judges agree"), "{}", run.stdout);
    let there = folder.path("here/and/there");
    let mut names: Vec<String> = std::fs::read_dir(&there)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "marked.glb",
            "picture.png",
            "report.json",
            "scene.glb",
            "silhouettes.glb",
            "verification.txt",
            "volume-0.glb",
            "volume-1.glb"
        ]
    );
    for name in names.iter().filter(|name| name.ends_with(".glb")) {
        umbrage::read::read(there.join(name)).unwrap();
    }
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(there.join("report.json")).unwrap()).unwrap();
    // The sheet and the ground are open; the knot and the sphere are not.
    assert_eq!(
        (&report["verdict"], &report["files"][0]["total"]["closed_shells"]),
        (&"cracked".into(), &2.into())
    );
}

#[test]
fn demo_says_when_its_folder_cannot_be_made() {
    let folder = Folder::with_cubes();
    let run = folder.run("demo --out cube.obj");
    assert_eq!(run.code, 2);
    assert!(run.stderr.lines().count() == 1 && run.stderr.contains("cube.obj"), "{}", run.stderr);
}
