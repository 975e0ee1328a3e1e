//! Command tests: exit codes, JSON keys, refusals, and the files left behind by a failure.

mod accuracy;
mod ambient;
mod animate;
mod check;
mod check_page;
mod corpus;
mod demo;
mod gates;
mod hooks;
mod input;
mod machine;
mod plan;
mod prepare;
mod readme;
mod render;
mod rules;
mod scene;
mod schema;
mod silhouette;
mod timeout;
mod torture;
mod verify;
mod volume;

use std::fs;
use std::path::PathBuf;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::{Map, Value};
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;
use umbrage::write::{Layer, Model, write};

use super::support::real_meshes;

/// A folder with a few meshes in which the command runs.
struct Folder(tempfile::TempDir);

/// Result of a run: exit code and output.
struct Run {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with the cube, closed and open, a file that is no mesh, and a subfolder.
    fn with_cubes() -> Self {
        let folder = Self::new();
        folder.mesh("cube.obj", &shapes::cube());
        folder.mesh("open.obj", &shapes::open_cube());
        fs::write(folder.path("garbled.stl"), b"solid\nfacet normal 0 0\n").unwrap();
        fs::create_dir(folder.path("folder")).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn mesh(&self, name: &str, mesh: &Mesh) {
        write(&Model { layers: vec![Layer::from(mesh)] }, self.path(name)).unwrap();
    }

    /// Runs the command; arguments are separated by spaces.
    fn run(&self, arguments: &str) -> Run {
        self.run_in(&[], arguments)
    }

    /// Runs the command with no graphics adapter visible.
    #[cfg(target_os = "linux")]
    fn run_without_adapter(&self, arguments: &str) -> Run {
        let nowhere = "/no/such/driver.json";
        let none = [("VK_DRIVER_FILES", nowhere), ("VK_ICD_FILENAMES", nowhere), ("UMBRAGE_ADAPTER", "")];
        self.run_in(&none, arguments)
    }

    /// The command, not yet run.
    fn command(&self, arguments: &str) -> assert_cmd::Command {
        let mut command = cargo_bin_cmd!("umbrage");
        // Without this variable Mesa complains on standard error, which the test checks.
        command.current_dir(self.0.path()).env("XDG_RUNTIME_DIR", self.0.path()).args(arguments.split(' '));
        command
    }

    fn run_in(&self, environment: &[(&str, &str)], arguments: &str) -> Run {
        let output = self.command(arguments).envs(environment.iter().copied()).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let run = Run {
            code: output.status.code().expect("no signal ends it"),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        };
        assert!(!run.stderr.contains("panicked"), "{arguments}: {}", run.stderr);
        run
    }

    fn code(&self, arguments: &str) -> i32 {
        self.run(arguments).code
    }

    /// Runs the command, which must succeed in running, and parses its JSON output.
    fn json(&self, arguments: &str) -> Value {
        let run = self.run(&format!("{arguments} --json"));
        assert_ne!(run.code, 2, "{arguments}: {}", run.stderr);
        serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("{error}: {}", run.stdout))
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// The keys of an object, in the order that other programs rely on.
fn keys(value: &Value) -> String {
    let Value::Object(object) = value else { panic!("not an object: {value}") };
    object.keys().map(String::as_str).collect::<Vec<_>>().join(" ")
}

/// A document with every number, text and boolean replaced by its type, and arrays cut to their first entry.
fn shape(value: &Value) -> Value {
    match value {
        Value::Null => Value::Null,
        Value::Bool(_) => "bool".into(),
        Value::Number(_) => "number".into(),
        Value::String(_) => "text".into(),
        Value::Array(entries) => entries.iter().take(1).map(shape).collect(),
        Value::Object(object) => Value::Object(
            object.iter().map(|(key, value)| (key.clone(), shape(value))).collect::<Map<_, _>>(),
        ),
    }
}

fn assert_shape(name: &str, value: &Value) {
    insta::with_settings!({ snapshot_path => "../snapshots", prepend_module_to_snapshot => false }, {
        insta::assert_json_snapshot!(name, shape(value));
    });
}

/// The path of a real mesh; `None` if the real meshes are missing.
fn real(name: &str) -> Option<PathBuf> {
    real_meshes().map(|folder| fs::canonicalize(folder.join(name)).unwrap())
}

#[test]
fn cli_usage_errors_exit_with_two() {
    let folder = Folder::with_cubes();
    for arguments in
        ["check", "chekc cube.obj", "check --no-such-option cube.obj", "check cube.obj --limit x"]
    {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments}");
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
        assert!(run.stderr.starts_with("umbrage: ") && run.stderr.contains("; "), "{}", run.stderr);
    }
    assert_eq!(folder.code("--version"), 0);
}

/// Builds without the window say how to get it; builds with it, what it needs.
#[test]
#[cfg(all(unix, not(target_os = "macos")))]
fn cli_view_without_a_display_says_what_to_do() {
    let folder = Folder::with_cubes();
    let none = [("DISPLAY", ""), ("WAYLAND_DISPLAY", ""), ("WAYLAND_SOCKET", "")];
    let run = folder.run_in(&none, "view cube.obj");
    let wanted = match cfg!(feature = "viewer") {
        true => "there is no display for a window; run it on a desktop",
        false => "without the feature viewer; cargo install umbrage --features viewer",
    };
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains(wanted) && run.stderr.lines().count() == 1, "{}", run.stderr);
}

#[test]
fn cli_help_names_every_default() {
    let folder = Folder::new();
    assert!(folder.run("--help").stdout.contains("Exit codes: 0 sound"));
    let commands = [
        "check",
        "prepare",
        "silhouette",
        "volume",
        "verify",
        "render",
        "view",
        "ambient",
        "plan",
        "torture",
        "accuracy",
    ];
    for command in commands {
        let run = folder.run(&format!("{command} --help"));
        assert_eq!(run.code, 0);
        // A line with an option starts a block, which ends at the next option.
        let mut blocks: Vec<String> = Vec::new();
        for line in run.stdout.lines() {
            if line.starts_with("      --") || line.starts_with("  -") {
                blocks.push(String::new());
            }
            if let Some(block) = blocks.last_mut() {
                block.push_str(line);
            }
        }
        let valued: Vec<&String> = blocks.iter().filter(|block| block.contains('<')).collect();
        assert!(valued.len() > 4, "{}", run.stdout);
        for block in valued {
            let said = ["[default: ", "[default with ", "(required)"];
            assert!(said.iter().any(|words| block.contains(words)), "{command}: {block}");
        }
    }
}

#[test]
fn cli_refuses_values_that_mean_nothing() {
    let folder = Folder::with_cubes();
    for (arguments, named) in [
        ("check cube.obj --weld -1", "-1"),
        ("check cube.obj --weld nan", "nan"),
        ("check cube.obj --weld 1mm", "1mm"),
        ("check cube.obj --scope planet", "planet"),
        ("check cube.obj --require closed", "closed"),
        ("check cube.obj --mark a.stl", ".stl"),
        ("check cube.obj open.obj --mark a.glb", "--mark"),
        ("check cube.obj --fast --weld 0.1", "--weld DIST"),
        ("check cube.obj --fast --require even", "--require even"),
        ("check cube.obj --fast --require watertight", "--require watertight"),
        ("check cube.obj --fast --self-intersections", "--self-intersections"),
        ("check cube.obj --fast --mark a.glb", "--mark"),
        ("check cube.obj --fast --picture a.png", "--picture"),
        ("silhouette cube.obj --light spot:1,2,3", "spot:1,2,3"),
        ("silhouette cube.obj --light point:1,2", "point:1,2"),
        ("silhouette cube.obj --light directional:0,0,0", "0,0,0"),
        ("silhouette cube.obj --light point:1,2,inf", "inf"),
        ("silhouette cube.obj -o a.png", ".png"),
        ("check cube.obj --picture a.jpg", ".png"),
        ("check cube.obj open.obj --picture a.png", "--picture"),
        ("view cube.obj --screenshot a.jpg", ".png"),
        ("view cube.obj --screenshot no/a.png", "no"),
        ("view cube.obj --shadow plan.json", "draws no saved plan"),
        ("view cube.obj --show walls", "walls"),
        ("render cube.obj", "--output"),
        ("render cube.obj -o a.jpg", ".png"),
        ("render cube.obj -o a.png --size 99999x99999", "99999x99999"),
        ("render cube.obj -o a.png --size 0x9", "0x9"),
        ("render cube.obj -o a.png --eye 1,2,3", "--target"),
        ("render cube.obj -o a.png --eye 1,2 --target 0,0,0", "1,2"),
        ("render cube.obj -o a.png --eye -1,2,3 --target -1,2,3", "-1,2,3"),
        ("render cube.obj -o a.png --eye 1,2,3 --target 0,0,0 --fov 180", "180"),
        ("render cube.obj -o a.png --fov 50", "--eye"),
        ("render cube.obj -o a.png --samples 2", "write 1, 4, 9 or 16"),
        ("volume cube.obj --far 0", "0"),
        ("volume cube.obj --far -3", "above 0"),
        ("check cube.obj --limit -1", "write a whole number"),
        ("verify cube.obj --points many", "write a whole number"),
        ("verify cube.obj --size 64x64", "add --gpu"),
        ("verify cube.obj --eye 1,2,3 --target 0,0,0", "add --gpu"),
        ("verify cube.obj --eye 1,2,3 --target 0,0,0 --fov 40", "add --gpu"),
        ("verify cube.obj --picture a.png", "add --gpu"),
        ("verify cube.obj --adapter llvmpipe", "add --gpu"),
        ("verify cube.obj --gpu --size 0x9", "0x9"),
        ("verify cube.obj --gpu --picture a.jpg", ".png"),
        ("verify cube.obj --gpu --fov 40", "--eye"),
        ("verify cube.obj --gpu --eye 1,2,3 --target 1,2,3", "1,2,3"),
        ("verify cube.obj --seed -1", "write a whole number"),
        ("verify cube.obj --threads 0", "from 1 to 1024"),
        ("check cube.obj --threads 0", "from 1 to 1024"),
        ("silhouette cube.obj --threads 0", "from 1 to 1024"),
        ("volume cube.obj --threads 0", "from 1 to 1024"),
        ("accuracy facing cube.obj --threads 0", "from 1 to 1024"),
        ("verify cube.obj --threads 1025", "from 1 to 1024"),
        ("verify cube.obj --threads 99999999999999999999", "from 1 to 1024"),
        ("render cube.obj -o a.png --eye 1,2,3 --target 0,0,0 --fov wide", "write a number of degrees"),
        ("torture --queries 0", "is not between 1 and"),
        ("torture --queries many", "write a whole number"),
        ("torture --queries -1", "write a whole number"),
        ("torture --queries 1e30", "write a whole number"),
        ("torture --seed x", "write a whole number"),
        ("torture --case nowhere/case.obj", "no folder nowhere"),
        ("torture --replay cube.obj --queries 5", "--queries"),
        ("accuracy shape cube.obj", "shape"),
        ("accuracy facing", "<FILE>"),
        ("accuracy facing cube.obj --queries 0", "is not between 1 and"),
        ("accuracy facing cube.obj --queries 1e12", "is not between 1 and"),
        ("accuracy facing cube.obj --queries -1", "write a whole number"),
        ("accuracy facing cube.obj --rounds 0", "from 1 to 1000"),
        ("accuracy facing cube.obj --rounds 1001", "from 1 to 1000"),
        ("accuracy facing cube.obj --csv a.txt", ".csv"),
        ("accuracy facing cube.obj --svg a.png", ".svg"),
        ("accuracy facing cube.obj --svg nowhere/a.svg", "no folder nowhere"),
        ("volume cube.obj --caps one", "one"),
        ("volume cube.obj -o a", "extension"),
    ] {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments}");
        assert!(run.stderr.contains(named), "{arguments}: {}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    }
    assert_eq!(folder.names(), ["cube.obj", "folder", "garbled.stl", "open.obj"]);
}

#[test]
fn cli_prints_the_same_on_any_number_of_threads() {
    let folder = Folder::with_cubes();
    folder.mesh("knot.obj", &shapes::torus(40, 30, 2.0, 1.9));
    for command in ["check --self-intersections", "silhouette", "volume", "verify --points 1e3"] {
        let run = |threads: u32| folder.run(&format!("{command} knot.obj --json --threads {threads}"));
        let (one, more) = (run(1), run(3));
        assert_eq!((one.code, &one.stdout), (0, &more.stdout), "{command}: {}", one.stderr);
        assert!(one.stdout.len() > 200, "{command}: {}", one.stdout);
    }
    // Negative test: another mesh.
    let of = |file: &str| folder.run(&format!("check {file} --json --threads 1")).stdout;
    assert_ne!(of("cube.obj"), of("knot.obj"));
}

#[test]
fn cli_errors_are_one_line_that_names_the_file() {
    let folder = Folder::with_cubes();
    for command in [
        "check",
        "prepare -o a.glb",
        "ambient -o a.glb",
        "silhouette",
        "volume",
        "render --method rays -o a.png",
    ] {
        for (file, problem) in
            [("missing.obj", "cannot be opened"), ("garbled.stl", ""), ("folder", "is a directory")]
        {
            let run = folder.run(&format!("{command} {file}"));
            assert_eq!(run.code, 2, "{command} {file}");
            assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
            assert!(run.stderr.starts_with(&format!("umbrage: {file}")), "{}", run.stderr);
            assert!(run.stderr.contains(problem) && run.stderr.contains("; "), "{}", run.stderr);
        }
    }
}

#[test]
fn cli_leaves_nothing_half_written() {
    let folder = Folder::with_cubes();
    fs::write(folder.path("old.glb"), "old").unwrap();
    let before = folder.names();
    for arguments in [
        "check missing.obj --mark old.glb",
        "check garbled.stl --mark new.glb",
        "check open.obj --mark nowhere/new.glb",
        "silhouette missing.obj -o old.glb",
        "silhouette cube.obj -o nowhere/new.obj",
        "volume garbled.stl -o new.glb",
        "volume cube.obj -o folder/nowhere/new.ply",
    ] {
        assert_eq!(folder.code(arguments), 2, "{arguments}");
        assert_eq!(folder.names(), before, "{arguments}");
        assert_eq!(fs::read(folder.path("old.glb")).unwrap(), b"old", "{arguments}");
    }
}

#[test]
fn cli_is_quiet_when_the_pipe_is_closed() {
    let folder = Folder::new();
    // More than a pipe holds, so that the command meets the closed end while writing.
    folder.mesh("soup.obj", &shapes::soup(&shapes::icosphere(4)));
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("umbrage"))
        .current_dir(folder.0.path())
        .args(["check", "soup.obj", "--weld", "none", "--json"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(output.status.code(), Some(1), "the verdict is the same, read or not");
}

#[cfg(target_os = "linux")]
#[test]
fn cli_says_when_standard_output_is_full() {
    let folder = Folder::with_cubes();
    for arguments in [&["check", "cube.obj"][..], &["help", "check"], &["--version"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("umbrage"))
            .current_dir(folder.0.path())
            .args(arguments)
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("standard output cannot be written"));
    }
}
