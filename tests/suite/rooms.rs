//! Module order: no module imports one that comes after it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The modules of the library, lowest first. `gpu` wraps wgpu and knows no mesh. `built`, `choice`, `fault`,
/// `parallel` and `random` are single files that every module may use.
const ORDER: [&str; 30] = [
    "random",
    "fault",
    "parallel",
    "choice",
    "geom",
    "mesh",
    "built",
    "view",
    "gpu",
    "animate",
    "scene",
    "read",
    "write",
    "oracle",
    "topology",
    "check",
    "repair",
    "facing",
    "caster",
    "silhouette",
    "light_grid",
    "shadow",
    "ambient",
    "plan",
    "verify",
    "testing",
    "accuracy",
    "render",
    "json",
    "determinism",
];

/// All Rust files below a folder.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The code of a file without comments and without its unit tests, which may import anything.
fn code(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    // A module that is declared here and stored in a file of its own ends with a semicolon.
    let is_tests =
        |pair: &[&str]| pair[0] == "#[cfg(test)]" && pair[1].contains("mod ") && pair[1].ends_with('{');
    let end = lines.windows(2).position(is_tests).unwrap_or(lines.len());
    lines[..end].iter().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The modules that a file's code names by `crate::…`.
fn imports(code: &str) -> Vec<String> {
    assert!(!code.contains("crate::{"), "one module per import, so that this test can read it");
    let name = |rest: &str| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    code.split("crate::").skip(1).map(name).filter(|module| !module.is_empty()).collect()
}

/// Imports of later modules, as "a/b.rs imports c".
fn upward(sources: &BTreeMap<String, String>) -> Vec<String> {
    let place = |module: &str| ORDER.iter().position(|other| *other == module);
    let mut found = Vec::new();
    for (path, text) in sources {
        let room = path.split(['/', '.']).next().unwrap_or_default();
        let Some(own) = place(room) else {
            panic!("{path}: the module `{room}` has no place in the order");
        };
        for module in imports(&code(text)) {
            // Other names are types or macros of the crate root.
            if place(&module).is_some_and(|there| there > own) {
                found.push(format!("{path} imports {module}"));
            }
        }
    }
    found.dedup();
    found
}

fn sources() -> BTreeMap<String, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    files(&root, &mut paths);
    let read = |path: &PathBuf| {
        let name = path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
        (name, fs::read_to_string(path).unwrap())
    };
    let library = |name: &str| !name.starts_with("cli/") && !matches!(name, "main.rs" | "lib.rs");
    // Files compiled for tests only.
    let tests = |name: &str| {
        name.contains("/tests/")
            || name.ends_with("tests.rs")
            || name.ends_with("test_support.rs")
            || name.ends_with("emulation.rs")
    };
    paths.iter().map(read).filter(|(name, _)| library(name) && !tests(name)).collect()
}

#[test]
fn rooms_import_nothing_that_comes_after_them() {
    let mut sources = sources();
    assert!(sources.len() > 150, "{}", sources.len());
    assert_eq!(upward(&sources), Vec::<String>::new());
    // Negative test: an upward import is found however it is written. In a test or a comment it is none.
    let spoil = |text: &str| BTreeMap::from([("oracle/mod.rs".to_owned(), text.to_owned())]);
    for text in
        ["use crate::topology::Topology;", "fn a() {\n    crate::caster::x();\n}", "pub use crate::check;"]
    {
        assert_eq!(upward(&spoil(text)).len(), 1, "{text}");
    }
    let declared = "#[cfg(test)]\nmod tests;\nuse crate::caster::Caster;";
    assert_eq!(upward(&spoil(declared)).len(), 1);
    let harmless = "use crate::geom::Light; // crate::caster\n#[cfg(test)]\nmod tests {\n    use crate::caster::Caster;\n}\n";
    assert_eq!(upward(&spoil(harmless)), Vec::<String>::new());
    sources.insert("geom/extra.rs".to_owned(), "use crate::mesh::Mesh;".to_owned());
    assert_eq!(upward(&sources), ["geom/extra.rs imports mesh"]);
}
