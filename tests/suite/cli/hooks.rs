//! The files by which other projects call `umbrage check`: `.pre-commit-hooks.yaml` and `action.yml`.

use std::fs;
use std::path::Path;
use std::process::Command;

use umbrage::read::Format;

use super::Folder;

fn text(name: &str) -> String {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap();
    assert!(!text.contains('\t') && text.ends_with('\n'), "{name}: YAML is indented by spaces");
    text
}

/// The keys of a YAML file with their indentation and the text behind them; lines of a block (`key: |`) are
/// joined.
///
/// The part of YAML that these files use: keys, list marks, plain and single-quoted texts, blocks.
fn keys(text: &str) -> Vec<(usize, String, String)> {
    let mut found: Vec<(usize, String, String)> = Vec::new();
    let mut block = None;
    for line in text.lines() {
        let indent = line.len() - line.trim_start().len();
        if let Some(outer) = block {
            if indent > outer || line.is_empty() {
                let last = &mut found.last_mut().unwrap().2;
                last.push_str(line.get(outer + 2..).unwrap_or(""));
                last.push('\n');
                continue;
            }
            block = None;
        }
        if line.trim_start().starts_with('#') || line.is_empty() {
            continue;
        }
        let (indent, line) = match line.trim_start().strip_prefix("- ") {
            Some(rest) => (indent + 2, rest),
            None => (indent, line.trim_start()),
        };
        assert_eq!(indent % 2, 0, "{line}");
        let (key, value) = line.split_once(':').unwrap_or_else(|| panic!("no key: {line}"));
        let value = value.trim();
        assert!(!value.contains(": ") || value.starts_with('\''), "ambiguous in YAML: {line}");
        let value = value.strip_prefix('\'').and_then(|value| value.strip_suffix('\'')).unwrap_or(value);
        if value == "|" {
            block = Some(indent);
            found.push((indent, key.to_owned(), String::new()));
        } else {
            found.push((indent, key.to_owned(), value.to_owned()));
        }
    }
    found
}

fn value<'a>(keys: &'a [(usize, String, String)], name: &str) -> &'a str {
    &keys.iter().find(|(_, key, _)| key == name).unwrap_or_else(|| panic!("no {name}")).2
}

#[test]
fn hook_of_pre_commit_runs_the_check_over_mesh_files() {
    let keys = keys(&text(".pre-commit-hooks.yaml"));
    let names: Vec<&str> = keys.iter().map(|(_, key, _)| key.as_str()).collect();
    assert_eq!(names, ["id", "name", "description", "entry", "language", "files"]);
    assert_eq!(value(&keys, "language"), "rust");
    let entry = value(&keys, "entry").strip_prefix("umbrage ").unwrap();
    let folder = Folder::with_cubes();
    assert_eq!(folder.code(&format!("{entry} cube.obj")), 0);
    assert_eq!(folder.code(&format!("{entry} cube.obj open.obj")), 1);
    assert_eq!(
        folder.code(&format!("{entry} --require even -- open.obj")),
        1,
        "with arguments of the project"
    );
    // Every name that the pattern takes is one of a mesh.
    let (_, rest) = value(&keys, "files").split_once('(').unwrap();
    let (_, rest) = rest.split_once('(').unwrap();
    let extensions: Vec<&str> = rest.split_once(')').unwrap().0.split('|').collect();
    assert_eq!(extensions.len(), 8);
    for extension in extensions {
        let file = format!("a.{extension}");
        assert!(Format::from_extension(Path::new(&file)).is_some(), "{file}");
    }
}

#[test]
fn action_names_its_inputs_and_uses_each() {
    let text = text("action.yml");
    let keys = keys(&text);
    let top: Vec<&str> = keys.iter().filter(|key| key.0 == 0).map(|key| key.1.as_str()).collect();
    assert_eq!(top, ["name", "description", "inputs", "runs"]);
    assert_eq!(value(&keys, "using"), "composite");
    let inputs = keys.iter().skip_while(|key| key.1 != "inputs").skip(1).take_while(|key| key.0 > 0);
    let inputs: Vec<&str> = inputs.filter(|key| key.0 == 2).map(|key| key.1.as_str()).collect();
    assert_eq!(inputs, ["files", "require", "options", "sarif"]);
    for input in inputs {
        assert_eq!(text.matches(&format!("${{{{ inputs.{input} }}}}")).count(), 1, "{input}");
    }
    // What a project writes reaches the shell in variables alone.
    for (_, _, script) in keys.iter().filter(|key| key.1 == "run") {
        assert!(!script.is_empty() && !script.contains("${{"), "{script}");
    }
    let manifest = self::text("Cargo.toml");
    let install = value(&keys, "run");
    let features = install.split_once("--features ").unwrap().1.split_whitespace().next().unwrap();
    for feature in features.split(',') {
        assert!(manifest.contains(&format!("\n{feature} = [")), "{feature}");
    }
    // Fault injected: a key that is nowhere.
    assert!(std::panic::catch_unwind(|| value(&keys, "entrypoint").len()).is_err());
}

/// The second step, as its shell runs it.
#[cfg(unix)]
#[test]
fn action_checks_the_files_it_is_given() {
    let keys = keys(&text("action.yml"));
    let script = &keys.iter().filter(|key| key.1 == "run").nth(1).unwrap().2;
    let folder = Folder::with_cubes();
    fs::create_dir_all(folder.path("umbrage/bin")).unwrap();
    std::os::unix::fs::symlink(assert_cmd::cargo::cargo_bin!("umbrage"), folder.path("umbrage/bin/umbrage"))
        .unwrap();
    fs::copy(folder.path("cube.obj"), folder.path("a cube;true.obj")).unwrap();
    for (files, require, options, sarif, code) in [
        ("cube.obj", "sound", "", "", 0),
        ("cube.obj\na cube;true.obj\n", "watertight,even", "--weld exact", "", 0),
        ("cube.obj\nopen.obj", "sound", "", "out.sarif", 1),
        ("missing.obj", "sound", "", "", 2),
        ("cube.obj", "no-such", "", "", 2),
    ] {
        // As GitHub starts it.
        let output = Command::new("bash")
            .args(["--noprofile", "--norc", "-eo", "pipefail", "-c", script])
            .current_dir(folder.path("."))
            .env("RUNNER_TEMP", folder.path("."))
            .envs([("FILES", files), ("REQUIRE", require), ("OPTIONS", options), ("SARIF", sarif)])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{files}: {said}");
    }
    assert!(folder.path("out.sarif").exists());
}
