//! `umbrage demo`.

use super::Folder;
use crate::support::gpu;

/// Without the tour.
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
    let tour = [
        "accuracy.html",
        "caster.glb",
        "moving.glb",
        "moving.png",
        "silhouette.png",
        "title.png",
        "volume.png",
    ];
    let mut wanted: Vec<&str> = FILES.into_iter().chain(tour).collect();
    wanted.sort_unstable();
    assert_eq!(names, wanted);
    assert!(run.stdout.contains("$ umbrage plan scene.glb") && run.stdout.contains("\nOpen first: "));
    // The knot turns: its first vertex is elsewhere after a quarter of the clip, and the ground is not.
    let moving = umbrage::read::read(there.join("moving.glb")).unwrap();
    let posed = |time: f64| {
        let scene = moving.pose(&umbrage::animate::Pose::at(time)).unwrap();
        let meshes = scene.bake(umbrage::scene::Scope::Mesh).unwrap();
        let first = |name: &str| {
            let mesh = meshes.iter().find(|mesh| mesh.name.starts_with(name)).unwrap();
            mesh.positions()[0]
        };
        [first("torus knot"), first("ground")]
    };
    let (before, after) = (posed(0.0), posed(0.5));
    assert!(before[0] != after[0] && before[1] == after[1]);
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
    let run = folder.run_without_adapter("demo --out there --short");
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
