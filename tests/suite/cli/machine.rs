//! Machine trouble: full disks, closed pipes, signals, memory limits; and equal bytes for any number of
//! threads.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use umbrage::testing::shapes;

use super::Folder;

const LIGHT: &str = "--light point:3,5,4";

/// Every command that writes a file, with the name of the file.
fn writers() -> Vec<(String, &'static str)> {
    let mut writers: Vec<(String, &str)> = ["out.glb", "out.obj", "out.ply"]
        .into_iter()
        .flat_map(|out| {
            [
                (format!("silhouette ball.ply {LIGHT} -o {out}"), out),
                (format!("volume ball.ply {LIGHT} -o {out}"), out),
            ]
        })
        .collect();
    writers.extend([
        ("check open.obj --mark out.glb".to_owned(), "out.glb"),
        ("check open.obj --picture out.png".to_owned(), "out.png"),
        (format!("render ball.ply {LIGHT} --method rays --size 300x200 -o out.png"), "out.png"),
        ("demo --out . --short".to_owned(), "scene.glb"),
    ]);
    if crate::support::gpu().is_some() {
        let size = "--points 10 --size 64x64";
        writers.push((format!("verify ball.ply {LIGHT} --gpu {size} --picture out.png"), "out.png"));
        writers.push((format!("render ball.ply {LIGHT} --method zfail --size 64x64 -o out.png"), "out.png"));
    }
    writers
}

fn folder() -> Folder {
    let folder = Folder::with_cubes();
    folder.mesh("ball.ply", &shapes::icosphere(4));
    folder
}

/// The command as started by a shell, after the shell code `setup`.
#[cfg(unix)]
fn shell(folder: &Folder, setup: &str, arguments: &str) -> Command {
    let mut command = Command::new("sh");
    command
        .current_dir(folder.path("."))
        .env("XDG_RUNTIME_DIR", folder.path("."))
        .args(["-c", &format!("{setup}; exec \"$0\" {arguments}")])
        .arg(assert_cmd::cargo::cargo_bin!("umbrage"));
    command
}

/// The last line of standard error: why the command could not run.
#[cfg(unix)]
fn last_line(stderr: &[u8]) -> String {
    let text = String::from_utf8_lossy(stderr);
    assert!(!text.contains("panicked"), "{text}");
    text.lines().last().unwrap_or_default().to_owned()
}

#[cfg(target_os = "linux")]
#[test]
fn machine_disk_that_fills_up_leaves_the_old_file() {
    for (arguments, out) in writers() {
        let folder = folder();
        fs::write(folder.path(out), "old").unwrap();
        let before = folder.names();
        // Limits in blocks of 512 bytes or a kilobyte: no byte at all, and after some bytes.
        for blocks in [0, 1] {
            let output =
                shell(&folder, &format!("trap '' XFSZ; ulimit -f {blocks}"), &arguments).output().unwrap();
            let said = last_line(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{arguments}: {said}");
            let names_it = said.starts_with(&format!("umbrage: {out}: ")) || said.starts_with("umbrage: ./");
            assert!(names_it && said.contains("cannot be written: "), "{arguments}: {said}");
            assert_eq!(folder.names(), before, "{arguments}");
            assert_eq!(fs::read(folder.path(out)).unwrap(), b"old", "{arguments}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn machine_place_that_cannot_be_written_is_refused() {
    let folder = folder();
    fs::create_dir(folder.path("out.glb")).unwrap();
    let before = folder.names();
    // Not even root can create files in /sys.
    for (place, said) in [
        ("/dev/full", "extension"),
        ("out.glb", "is a directory"),
        ("/sys/out.glb", "check the permissions"),
        ("cube.obj/out.glb", "there is no folder"),
    ] {
        let run = folder.run(&format!("volume ball.ply {LIGHT} -o {place}"));
        assert_eq!(run.code, 2, "{place}");
        let last = run.stderr.lines().last().unwrap_or_default();
        assert!(last.starts_with(&format!("umbrage: {place}")) && last.contains(said), "{place}: {last}");
        assert_eq!(folder.names(), before);
    }
    for arguments in ["demo --out /sys/umbrage", "demo --out cube.obj"] {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.stderr.lines().count()), (2, 1), "{arguments}: {}", run.stderr);
    }
}

#[cfg(unix)]
#[test]
fn machine_folder_or_file_without_permission_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    fs::create_dir(folder.path("closed")).unwrap();
    let close =
        |name: &str, mode| fs::set_permissions(folder.path(name), fs::Permissions::from_mode(mode)).unwrap();
    close("closed", 0o555);
    close("cube.obj", 0);
    if fs::write(folder.path("closed/probe"), "").is_ok() {
        crate::support::skipped("permissions do not hold for this user (root)");
    } else {
        let run = folder.run(&format!("volume ball.ply {LIGHT} -o closed/out.glb"));
        let last = run.stderr.lines().last().unwrap_or_default();
        assert!(run.code == 2 && last.contains("check the permissions"), "{last}");
        let run = folder.run("check cube.obj");
        assert!(run.code == 2 && run.stderr.contains("check the permissions"), "{}", run.stderr);
    }
    close("closed", 0o755);
}

#[cfg(unix)]
#[test]
fn machine_pipe_that_is_closed_changes_neither_files_nor_exit_code() {
    let folder = folder();
    let cases = [
        ("--help".to_owned(), 0),
        ("help volume".to_owned(), 0),
        ("--version".to_owned(), 0),
        ("check open.obj".to_owned(), 1),
        ("check open.obj --json --mark out.glb".to_owned(), 1),
        (format!("silhouette ball.ply {LIGHT} --json -o out.obj"), 0),
        (format!("volume ball.ply {LIGHT} --json -o out.ply"), 0),
        (format!("verify ball.ply {LIGHT} --points 50 --json"), 0),
    ];
    for (arguments, code) in cases {
        for stream in ["1", "2"] {
            // The other end of the pipe is closed before the command starts.
            let script =
                format!("{{ sleep 0.1; \"$0\" {arguments} 2>&{stream} >&{stream}; echo $? >code; }} | true");
            let run = Command::new("sh")
                .current_dir(folder.path("."))
                .args(["-c", &script])
                .arg(assert_cmd::cargo::cargo_bin!("umbrage"))
                .stderr(Stdio::null())
                .status();
            assert!(run.unwrap().success());
            let found = fs::read_to_string(folder.path("code")).unwrap();
            assert_eq!(found.trim(), code.to_string(), "{arguments}");
        }
    }
    for name in ["out.glb", "out.obj", "out.ply"] {
        umbrage::read::read(folder.path(name)).unwrap();
    }
    assert!(!folder.names().iter().any(|name| name.ends_with(".tmp")));
}

/// Whether signals reach the processes started here: a runner in the background of a script has them ignored.
#[cfg(target_os = "linux")]
fn signals_are_ignored() -> bool {
    const HANGUP_INTERRUPT_TERMINATE: u64 = 1 | 1 << 1 | 1 << 14;
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap().trim();
    let ignored = u64::from_str_radix(mask, 16).unwrap() & HANGUP_INTERRUPT_TERMINATE != 0;
    if ignored {
        crate::support::skipped("whoever runs the tests has signals ignored");
    }
    ignored
}

#[cfg(target_os = "linux")]
fn signal(child: &Child, name: &str) {
    let status = Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status();
    assert!(status.unwrap().success());
}

/// Which of the signals hang-up, interrupt and terminate the command catches, and which it ignores. `None`
/// until the process is the command (a shell starts it) and has decided about all three.
#[cfg(target_os = "linux")]
fn listens(pid: u32) -> Option<[u64; 2]> {
    const ALL: u64 = 1 | 1 << 1 | 1 << 14;
    let status = fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let mask = |name| {
        let mask = status.lines().find_map(|line| line.strip_prefix(name))?.trim();
        u64::from_str_radix(mask, 16).ok().map(|mask| mask & ALL)
    };
    let (caught, ignored) = (mask("SigCgt:")?, mask("SigIgn:")?);
    (status.starts_with("Name:\tumbrage\n") && caught | ignored == ALL).then_some([caught, ignored])
}

/// Waits until `ready` holds; `false` if the command ended before.
#[cfg(target_os = "linux")]
fn wait_for(child: &mut Child, ready: impl Fn(u32) -> bool) -> bool {
    let start = Instant::now();
    while !ready(child.id()) {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        assert!(start.elapsed() < Duration::from_secs(100), "never ready");
        sleep(Duration::from_millis(1));
    }
    true
}

/// Starts the command, and sends the signal `name` once `ready` holds. Returns exit code and message; `None`
/// if the command ended before.
#[cfg(target_os = "linux")]
fn interrupted(mut command: Command, name: &str, ready: impl Fn(u32) -> bool) -> Option<(i32, String)> {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    if !wait_for(&mut child, ready) {
        return None;
    }
    signal(&child, name);
    Some(ended(child))
}

/// Exit code and message of a command that ends without a signal.
#[cfg(target_os = "linux")]
fn ended(child: Child) -> (i32, String) {
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code().unwrap_or_else(|| panic!("{}: {said}", output.status)), said)
}

#[cfg(target_os = "linux")]
#[test]
fn machine_interrupted_work_writes_nothing() {
    if signals_are_ignored() {
        return;
    }
    let folder = folder();
    fs::write(folder.path("out.png"), "old").unwrap();
    let before = folder.names();
    for name in ["INT", "TERM", "HUP"] {
        for arguments in [
            format!(
                "render ball.ply {LIGHT} --method rays --size 6000x6000 --samples 16 --threads 2 -o out.png"
            ),
            format!("verify ball.ply {LIGHT} --points 5000000 --threads 2"),
        ] {
            let (code, said) =
                interrupted(shell(&folder, ":", &arguments), name, |pid| listens(pid).is_some())
                    .expect("it is long");
            assert_eq!(
                (code, said.as_str()),
                (130, "umbrage: interrupted; nothing was written\n"),
                "{arguments}"
            );
            assert_eq!(folder.names(), before);
            assert_eq!(fs::read(folder.path("out.png")).unwrap(), b"old");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn machine_interrupted_writing_leaves_the_old_file_and_no_other() {
    if signals_are_ignored() {
        return;
    }
    let folder = Folder::new();
    folder.mesh("ball.ply", &shapes::icosphere(6));
    fs::write(folder.path("out.obj"), "old").unwrap();
    let before = folder.names();
    let lights = LIGHT.to_owned() + " --light point:-9,1,1 --light point:1,-9,2 --light directional:1,2,3";
    let arguments = format!("volume ball.ply {lights} --faces all -o out.obj");
    let half_written = |_| folder.names().iter().any(|name| name.ends_with(".tmp"));
    // One ignored signal does not affect the others.
    for (setup, name) in [(":", "INT"), (":", "TERM"), ("trap '' HUP", "TERM"), ("trap '' INT", "HUP")] {
        let caught =
            (0..20).any(|_| match interrupted(shell(&folder, setup, &arguments), name, half_written) {
                Some((130, said)) if said.contains("nothing was written") => {
                    assert_eq!((said.lines().count(), folder.names()), (1, before.clone()), "{said}");
                    assert_eq!(fs::read(folder.path("out.obj")).unwrap(), b"old");
                    true
                }
                // The signal came too late: then the file is complete.
                found => {
                    if let Some((code, said)) = found {
                        assert!(code == 0 || said.contains("1 file was written before"), "{code}: {said}");
                    }
                    umbrage::read::read(folder.path("out.obj")).unwrap();
                    assert_eq!(folder.names(), before);
                    fs::write(folder.path("out.obj"), "old").unwrap();
                    false
                }
            });
        assert!(caught, "{setup}: never caught by {name} while writing");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn machine_hangup_that_is_ignored_stays_ignored() {
    if signals_are_ignored() {
        return;
    }
    let folder = folder();
    let arguments = format!("verify ball.ply {LIGHT} --points 20000000 --threads 2");
    let mut child = shell(&folder, "trap '' HUP", &arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    assert!(wait_for(&mut child, |pid| listens(pid).is_some()));
    let (interrupt_and_terminate, hangup) = (1 << 1 | 1 << 14, 1);
    assert_eq!(listens(child.id()), Some([interrupt_and_terminate, hangup]));
    signal(&child, "TERM");
    assert_eq!(ended(child).0, 130);
}

/// A full pipe blocks whoever writes to standard error and holds its lock: first the thread that reports the
/// interruption, then the thread that reports the written file.
#[cfg(target_os = "linux")]
#[test]
fn machine_second_signal_ends_it_though_nobody_reads_standard_error() {
    if signals_are_ignored() {
        return;
    }
    let folder = folder();
    for (arguments, out) in [
        (format!("verify ball.ply {LIGHT} --points 20000000 --threads 2"), None),
        (format!("volume ball.ply {LIGHT} -o out.obj"), Some(folder.path("out.obj"))),
    ] {
        let mut child = shell(&folder, "timeout 0.5 cat /dev/zero >&2", &arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let ready = |pid| listens(pid).is_some() && out.as_ref().is_none_or(|out| out.exists());
        assert!(wait_for(&mut child, ready));
        let mut sent = 0;
        let status = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break status;
            }
            if sent == 100 {
                child.kill().unwrap();
                child.wait().unwrap();
                panic!("{arguments}: still there after {sent} signals");
            }
            signal(&child, "TERM");
            sent += 1;
            sleep(Duration::from_millis(200));
        };
        assert_eq!(status.code(), Some(130), "{arguments}");
        assert!(sent > 1, "{arguments}: nothing was in the way of the first signal");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn machine_interrupted_while_it_prints_does_not_say_that_nothing_was_written() {
    if signals_are_ignored() {
        return;
    }
    let folder = folder();
    folder.mesh("soup.ply", &shapes::soup(&shapes::icosphere(4)));
    // More than a pipe holds: after its first byte is read, the rest is still being written.
    let mut child = shell(&folder, ":", "check soup.ply --weld none --limit 100000 --json")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdout = child.stdout.take().unwrap();
    std::io::Read::read_exact(&mut stdout, &mut [0]).unwrap();
    signal(&child, "TERM");
    assert_eq!(ended(child), (130, "umbrage: interrupted\n".to_owned()));
}

/// Small files that claim to be large, and a mesh that all stages accept.
#[cfg(target_os = "linux")]
fn hostile(folder: &Folder) -> Vec<&'static str> {
    let mut stl = vec![0; 80];
    stl.extend(u32::MAX.to_le_bytes());
    stl.resize(184, 0);
    let gltf = |count: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{{"componentType":5126,"type":"VEC3","count":{count}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{{"mesh":0}}]}}"#
        )
    };
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
               property float z\nend_header\n";
    let mut md2 = b"IDP2\x08\0\0\0".to_vec();
    md2.resize(68, 255);
    for (name, bytes) in [
        ("count.stl", stl),
        ("count.gltf", gltf("4000000000").into_bytes()),
        ("zeros.gltf", gltf("3000000").into_bytes()),
        ("count.ply", ply.into()),
        ("count.md2", md2),
        ("index.obj", b"v 0 0 0\nf 1 1 4000000000\n".to_vec()),
        ("line.obj", [b"f".as_slice(), &b" 1".repeat(1 << 20)].concat()),
        ("deep.gltf", [b"{\"a\":".as_slice(), &b"[".repeat(1 << 20)].concat()),
    ] {
        fs::write(folder.path(name), bytes).unwrap();
    }
    folder.mesh("soup.ply", &shapes::soup(&shapes::icosphere(4)));
    // Sparse files of a terabyte that take no space on the disk.
    for (name, head) in
        [("vast.stl", &[0; 80][..]), ("vast.glb", b"glTF\x02\0\0\0"), ("vast.md2", b"IDP2\x08\0\0\0")]
    {
        fs::write(folder.path(name), head).unwrap();
        let file = fs::OpenOptions::new().append(true).open(folder.path(name)).unwrap();
        // The STL's header states the true count.
        let (count, len) = (4_000_000_000_u32, 1_u64 << 38);
        if name == "vast.stl" {
            std::io::Write::write_all(&mut &file, &count.to_le_bytes()).unwrap();
        }
        file.set_len(if name == "vast.stl" { 84 + 50 * u64::from(count) } else { len }).unwrap();
    }
    vec![
        "count.stl",
        "count.gltf",
        "zeros.gltf",
        "count.ply",
        "count.md2",
        "index.obj",
        "line.obj",
        "deep.gltf",
        "soup.ply",
        "vast.stl",
        "vast.glb",
        "vast.md2",
    ]
}

#[cfg(target_os = "linux")]
#[test]
fn machine_limit_on_memory_is_met_by_an_answer_or_one_line() {
    let folder = Folder::new();
    for name in hostile(&folder) {
        let output = shell(&folder, "ulimit -v 600000", &format!("check {name}"))
            .stdout(Stdio::piped())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        let answered = match name {
            "zeros.gltf" | "soup.ply" => matches!(output.status.code(), Some(0 | 1)),
            _ => {
                output.status.code() == Some(2) && said.lines().count() == 1 && said.starts_with("umbrage: ")
            }
        };
        assert!(answered, "{name}: {}: {said}", output.status);
    }
}

/// The files and the output of a command, without anything that may differ between runs.
fn outcome(arguments: &str, out: &[&str]) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = folder();
    let run = folder.run(arguments);
    assert!(matches!(run.code, 0 | 1), "{arguments}: {}", run.stderr);
    let mut bytes = vec![(PathBuf::from("stdout"), run.stdout.into_bytes())];
    bytes.extend(out.iter().map(|&name| (PathBuf::from(name), fs::read(folder.path(name)).unwrap())));
    bytes
}

#[test]
fn machine_number_of_threads_changes_no_byte() {
    let mut cases = vec![
        (format!("verify ball.ply {LIGHT} --points 2000 --json"), vec![]),
        (format!("verify open.obj {LIGHT} --points 2000"), vec![]),
        (format!("render ball.ply {LIGHT} --method rays --size 200x150 --ground -o a.png"), vec!["a.png"]),
    ];
    if cfg!(feature = "parallel") {
        let demo = [
            "scene.glb",
            "report.json",
            "marked.glb",
            "silhouettes.glb",
            "volume-0.glb",
            "volume-1.glb",
            "picture.png",
            "verification.txt",
        ];
        cases.push(("demo --out . --short".to_owned(), demo.to_vec()));
    }
    for (arguments, out) in cases {
        let [one, eight] = [1, 8].map(|n| outcome(&format!("{arguments} --threads {n}"), &out));
        assert!(one == eight, "{arguments}");
    }
    // Commands without the option `--threads` run twice.
    for (arguments, out) in [
        ("check open.obj --json --mark a.glb --picture a.png".to_owned(), vec!["a.glb", "a.png"]),
        (format!("silhouette ball.ply {LIGHT} --json -o a.obj"), vec!["a.obj"]),
        (format!("volume ball.ply {LIGHT} --json -o a.ply"), vec!["a.ply"]),
    ] {
        assert_eq!(outcome(&arguments, &out), outcome(&arguments, &out), "{arguments}");
    }
}

#[test]
fn machine_another_seed_is_seen_by_the_comparison_of_threads() {
    let verify = |seed: u32| outcome(&format!("verify open.obj {LIGHT} --points 2000 --seed {seed}"), &[]);
    assert_ne!(verify(1), verify(2));
}
