//! `umbrage check --file-timeout`: a file that takes too long, or whose process crashes, stops no other.

use std::fs;
use std::process::{Command, Stdio};

use serde_json::Value;
use umbrage::testing::shapes;

use super::Folder;

/// More than any of these files takes, on a slow machine.
const LONG: &str = "--file-timeout 100";

#[test]
fn file_timeout_that_is_kept_changes_no_byte() {
    let folder = Folder::with_cubes();
    folder.mesh("inward.ply", &shapes::inside_out(&shapes::cube()));
    fs::write(folder.path("empty.stl"), "solid\nendsolid\n").unwrap();
    let files = "cube.obj open.obj garbled.stl missing.obj inward.ply empty.stl";
    for form in [
        "",
        " --json",
        " --json-lines",
        " --summary",
        " --quiet",
        " --color always --limit 1",
        " --require even",
    ] {
        let [one, many] = ["", LONG].map(|option| {
            let arguments = format!("check {files}{form} {option}");
            folder.run(arguments.trim_end())
        });
        assert_eq!(one.code, 2, "{form}: {}", one.stderr);
        assert_eq!((one.code, &one.stdout, &one.stderr), (many.code, &many.stdout, &many.stderr), "{form}");
    }
    // Documents of all files, and what is new.
    let before = folder.run("check open.obj --json").stdout;
    fs::write(folder.path("before.json"), before).unwrap();
    let written = |option: &str| {
        let run = folder.run(&format!(
            "check {files} --quiet --junit out.xml --sarif out.sarif --baseline before.json{option}"
        ));
        let read = |name: &str| fs::read_to_string(folder.path(name)).unwrap();
        (run.code, run.stderr, read("out.xml"), read("out.sarif"))
    };
    let (one, many) = (written(""), written(&format!(" {LONG}")));
    assert_eq!(one, many);
    assert!(one.2.contains("BOUNDARY_LOOP") && one.2.contains("UNREADABLE"), "{}", one.2);
    assert!(one.1.contains("new: inward.ply: INSIDE_OUT_SHELL") && !one.1.contains("new: open.obj"));
    for (files, code) in
        [("cube.obj", 0), ("open.obj", 1), ("cube.obj open.obj", 1), ("missing.obj", 2), ("-- cube.obj", 0)]
    {
        assert_eq!(folder.code(&format!("check {LONG} {files}")), code, "{files}");
    }
    // Fault injected: another limit on what is listed is seen.
    let [one, other] =
        ["5", "0"].map(|limit| folder.run(&format!("check open.obj {LONG} --limit {limit}")).stdout);
    assert_ne!(one, other);
}

/// Standard input that never ends takes forever.
#[test]
fn file_timeout_ends_a_file_and_goes_on_with_the_others() {
    let folder = Folder::with_cubes();
    let run = |arguments: &str| {
        let mut child = Command::new(assert_cmd::cargo::cargo_bin!("umbrage"))
            .args(arguments.split(' '))
            .current_dir(folder.path("."))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Held open until the command has ended.
        let input = child.stdin.take();
        let output = child.wait_with_output().unwrap();
        drop(input);
        (
            output.status.code(),
            String::from_utf8(output.stdout).unwrap(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    let (code, stdout, stderr) = run("check cube.obj - open.obj --summary --file-timeout 0.5");
    assert_eq!(code, Some(2), "{stderr}");
    assert_eq!(stdout, "sound: cube.obj\nerror: -\ncracked: open.obj: 1 boundary loop\n");
    assert_eq!(
        stderr,
        "umbrage: -: not finished within 0.5 s; raise --file-timeout, or check it with --fast\n"
    );
    let (_, stdout, _) = run("check - open.obj --json --file-timeout 0.5");
    let document: Value = serde_json::from_str(&stdout).unwrap();
    assert!(document["files"][0]["error"].as_str().unwrap().contains("not finished"), "{document}");
    assert_eq!(
        (&document["files"][1]["total"]["faces"], &document["verdict"]),
        (&10.into(), &"cracked".into())
    );
}

/// The number of the process that another one started, once there is one.
#[cfg(target_os = "linux")]
fn worker_of(pid: u32) -> String {
    let path = format!("/proc/{pid}/task/{pid}/children");
    loop {
        match fs::read_to_string(&path).unwrap().split_whitespace().next() {
            Some(worker) => return worker.to_owned(),
            None => std::thread::yield_now(),
        }
    }
}

#[cfg(target_os = "linux")]
fn with_endless_input(folder: &Folder, arguments: &str) -> std::process::Child {
    Command::new(assert_cmd::cargo::cargo_bin!("umbrage"))
        .args(arguments.split(' '))
        .current_dir(folder.path("."))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn file_timeout_reports_a_process_that_crashes() {
    let folder = Folder::with_cubes();
    let mut child = with_endless_input(&folder, "check - open.obj --summary --file-timeout 100");
    let input = child.stdin.take();
    let worker = worker_of(child.id());
    assert!(Command::new("kill").args(["-KILL", &worker]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    drop(input);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "error: -\ncracked: open.obj: 1 boundary loop\n");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("-: the process that checked it ended without a report (signal: 9"), "{said}");
}

/// An interrupted command leaves no worker behind.
#[cfg(target_os = "linux")]
#[test]
fn file_timeout_that_is_interrupted_ends_its_process() {
    let folder = Folder::with_cubes();
    let mut child = with_endless_input(&folder, "check - --file-timeout 100");
    let input = child.stdin.take();
    let worker = worker_of(child.id());
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    // Gone, or another process of that number that is no umbrage.
    let command = fs::read_to_string(format!("/proc/{worker}/cmdline")).unwrap_or_default();
    drop(input);
    assert_eq!(output.status.code(), Some(130));
    assert!(!command.contains("--worker"), "{command}");
}

#[test]
fn file_timeout_refuses_what_needs_the_mesh_itself_and_what_is_no_time() {
    let folder = Folder::with_cubes();
    for option in ["--mark a.glb", "--picture a.png", "--html a.html", "--fast"] {
        let run = folder.run(&format!("check cube.obj {LONG} {option}"));
        assert!(run.code == 2 && run.stderr.contains("--file-timeout"), "{option}: {}", run.stderr);
    }
    for time in ["0", "-1", "x", "nan", "1e-12", "inf", "1e300"] {
        let run = folder.run(&format!("check cube.obj --file-timeout {time}"));
        assert!(
            run.code == 2 && run.stderr.contains("write a number of seconds above 0"),
            "{time}: {}",
            run.stderr
        );
    }
}
