//! The tree with all mutants in it, and its test binary; mutants that do not build are given up.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::plan::{self, Plan, Spot};

/// How to build.
pub struct Options {
    /// The tree as it is.
    pub root: PathBuf,
    /// The copy that is changed.
    pub copy: PathBuf,
    /// Options of `cargo test --no-run`.
    pub cargo: Vec<String>,
}

/// Copies what git knows of the tree, and what is new in it; files that are as they were keep their time.
/// Those that are `changed` are written later.
fn copy(root: &Path, to: &Path, changed: &[&str]) -> Result<(), String> {
    let listed = Command::new("git")
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .current_dir(root)
        .output()
        .map_err(|error| format!("git: {error}"))?;
    for name in String::from_utf8_lossy(&listed.stdout).split('\0').filter(|name| !name.is_empty()) {
        if changed.contains(&name) {
            continue;
        }
        if let Ok(bytes) = fs::read(root.join(name)) {
            write(&to.join(name), &bytes)?;
        }
    }
    Ok(())
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    if fs::read(path).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    let fail = |error: std::io::Error| format!("{}: {error}", path.display());
    fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).map_err(fail)?;
    fs::write(path, bytes).map_err(fail)
}

/// The root of the crate with the module of the switch; warnings would be thousands.
fn with_switch(lib: &str) -> String {
    format!("#![allow(warnings)] {lib}\nmod mutant;\n")
}

/// Builds the tests with every mutant of `plan` that builds; those that do not are put into `given_up`.
pub fn build(options: &Options, plan: &Plan, given_up: &mut HashSet<u32>) -> Result<PathBuf, String> {
    let (root, to) = (&options.root, &options.copy);
    let originals =
        plan.files.iter().map(|(file, _)| plan::read(&root.join(file))).collect::<Result<Vec<_>, _>>()?;
    let mut changed = plan.files.iter().map(|(file, _)| file.as_str()).collect::<Vec<_>>();
    changed.extend(["src/lib.rs", "Cargo.toml"]);
    copy(root, to, &changed)?;
    write(&to.join("src/mutant.rs"), include_bytes!("switch.rs"))?;
    // A crate that depends on itself, for its tests in files of their own, would be built twice.
    let manifest = plan::read(&root.join("Cargo.toml"))?;
    let kept = manifest.lines().filter(|line| !line.contains("{ path = \".\"")).collect::<Vec<_>>();
    write(&to.join("Cargo.toml"), (kept.join("\n") + "\n").as_bytes())?;
    let lib = plan::read(&root.join("src/lib.rs"))?;
    for round in 1.. {
        let mut spots: HashMap<&str, Vec<Spot>> = HashMap::new();
        for ((file, places), source) in plan.files.iter().zip(&originals) {
            let (mut text, these) = plan::rewrite(source, places, given_up);
            if file == "src/lib.rs" {
                text = with_switch(&text);
            }
            write(&to.join(file), text.as_bytes())?;
            spots.insert(file, these);
        }
        if !spots.contains_key("src/lib.rs") {
            write(&to.join("src/lib.rs"), with_switch(&lib).as_bytes())?;
        }
        eprintln!("building, round {round}: {} mutants do not build", given_up.len());
        let output = Command::new("cargo")
            .args(["test", "--no-run", "--lib", "--message-format=json", "--quiet"])
            .args(&options.cargo)
            .current_dir(to)
            .stderr(Stdio::inherit())
            .output()
            .map_err(|error| format!("cargo: {error}"))?;
        let before = given_up.len();
        let mut unexplained = Vec::new();
        for line in String::from_utf8_lossy(&output.stdout).lines() {
            let Ok(message) = serde_json::from_str::<serde_json::Value>(line) else { continue };
            if let Some(binary) = message["executable"].as_str() {
                return Ok(binary.into());
            }
            let message = &message["message"];
            if message["level"] == "error"
                && message["spans"].as_array().is_some_and(|spans| !spans.is_empty())
            {
                match blamed(message, &spots, given_up) {
                    mutants if mutants.is_empty() => unexplained.push(message["rendered"].to_string()),
                    mutants => given_up.extend(mutants),
                }
            }
        }
        if given_up.len() == before {
            return Err(format!("the tree does not build: {}", unexplained.join("\n").replace("\\n", "\n")));
        }
    }
    unreachable!()
}

/// The mutants to which an error belongs: those of the narrowest place that holds one of its spans, the main one
/// first.
fn blamed(error: &serde_json::Value, spots: &HashMap<&str, Vec<Spot>>, given_up: &HashSet<u32>) -> Vec<u32> {
    let mut spans = Vec::new();
    flatten(error, &mut spans);
    for (file, start, end) in &spans {
        let Some(spots) = spots.get(file.as_str()) else { continue };
        let holding = spots.iter().filter(|spot| spot.bytes.start <= *start && *end <= spot.bytes.end);
        let mut holding = holding.collect::<Vec<_>>();
        holding.sort_by_key(|spot| (spot.bytes.len(), spot.mutants.len()));
        for spot in holding {
            let left = spot.mutants.clone().filter(|mutant| !given_up.contains(mutant)).collect::<Vec<_>>();
            if !left.is_empty() {
                return left;
            }
        }
    }
    // No place holds it: the places that it holds.
    for (file, start, end) in &spans {
        let within = spots.get(file.as_str()).into_iter().flatten();
        let within = within.filter(|spot| *start <= spot.bytes.start && spot.bytes.end <= *end);
        let left = within
            .flat_map(|spot| spot.mutants.clone())
            .filter(|mutant| !given_up.contains(mutant))
            .collect::<Vec<_>>();
        if !left.is_empty() {
            return left;
        }
    }
    Vec::new()
}

/// File, first and last byte of each span of an error: main ones first, then others, then those below it.
fn flatten(error: &serde_json::Value, into: &mut Vec<(String, usize, usize)>) {
    let spans = error["spans"].as_array().map_or(&[][..], |spans| spans);
    for primary in [true, false] {
        for span in spans.iter().filter(|span| span["is_primary"] == primary) {
            let mut span = span;
            // The call of a macro, not its text.
            loop {
                let number = |key: &str| span[key].as_u64().unwrap_or_default() as usize;
                let file = span["file_name"].as_str().unwrap_or_default().to_owned();
                into.push((file, number("byte_start"), number("byte_end")));
                if !span["expansion"].is_object() {
                    break;
                }
                span = &span["expansion"]["span"];
            }
        }
    }
    for child in error["children"].as_array().into_iter().flatten() {
        flatten(child, into);
    }
}
