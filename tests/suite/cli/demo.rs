//! `umbrage demo`.

use super::Folder;
use crate::support::gpu;

const FILES: [&str; 9] = [
    "marked.glb",
    "picture.png",
    "report.json",
    "scene.glb",
    "silhouettes.glb",
    "verdicts.png",
    "verification.txt",
    "volume-0.glb",
    "volume-1.glb",
];

fn names(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn demo_does_all_of_it_and_its_files_can_be_read() {
    if gpu().is_none() {
        return; // covered by the next test
    }
    let folder = Folder::new();
    let run = folder.run("demo --out here/and/there");
    assert_eq!(run.code, 0, "{}", run.stderr);
    for verdict in ["verdict: all methods agree", "verdict: every pixel agrees or grazes"] {
        assert!(run.stdout.contains(verdict), "{}", run.stdout);
    }
    let there = folder.path("here/and/there");
    let names = names(&there);
    assert_eq!(names, FILES);
    for name in names.iter().filter(|name| name.ends_with(".glb")) {
        umbrage::read::read(there.join(name)).unwrap();
    }
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(there.join("report.json")).unwrap()).unwrap();
    // The sheet and the ground are open; the knot and the sphere are closed.
    assert_eq!(
        (&report["verdict"], &report["files"][0]["total"]["closed_shells"]),
        (&"cracked".into(), &2.into())
    );
}

#[cfg(target_os = "linux")]
#[test]
fn demo_without_an_adapter_says_so_and_does_everything_else() {
    let folder = Folder::new();
    let run = folder.run_without_adapter("demo --out there");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("note: no stencil pass, the picture comes from the ray cast: "));
    assert!(run.stderr.contains("apt-get install mesa-vulkan-drivers"), "{}", run.stderr);
    assert!(run.stdout.contains("verdict: all methods agree") && !run.stdout.contains("Pixels: "));
    let wanted: Vec<&str> = FILES.into_iter().filter(|&name| name != "verdicts.png").collect();
    assert_eq!(names(&folder.path("there")), wanted);
}

#[test]
fn demo_says_when_its_folder_cannot_be_made() {
    let folder = Folder::with_cubes();
    let run = folder.run("demo --out cube.obj");
    assert_eq!(run.code, 2);
    assert!(run.stderr.lines().count() == 1 && run.stderr.contains("cube.obj"), "{}", run.stderr);
}
