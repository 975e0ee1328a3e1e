//! Test support of several stages: the graphics adapter, the real meshes, and what is skipped without them.

use std::collections::HashMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
#[cfg(feature = "gpu")]
use std::sync::OnceLock;

#[cfg(feature = "gpu")]
use umbrage::gpu::Gpu;

/// Says that the current test is skipped. `cargo test` swallows what a passing test says, so that the line is
/// also appended to the file that UMBRAGE_SKIPPED names; `tests/run.sh` prints it at its end.
pub(crate) fn skipped(why: &str) {
    let thread = std::thread::current();
    let line = format!("SKIPPED {}: {why}\n", thread.name().unwrap_or("a test"));
    eprint!("{line}");
    if let Some(path) = std::env::var_os("UMBRAGE_SKIPPED") {
        let file = OpenOptions::new().create(true).append(true).open(&path);
        let written = file.and_then(|mut file| file.write_all(line.as_bytes()));
        written.unwrap_or_else(|error| panic!("UMBRAGE_SKIPPED={}: {error}", path.display()));
    }
}

fn is_required(variable: &str) -> bool {
    std::env::var(variable).is_ok_and(|value| value == "1")
}

/// The graphics adapter. Without one, says that the test is skipped, or fails if an adapter is required.
#[cfg(feature = "gpu")]
pub(crate) fn gpu() -> Option<Gpu> {
    static GPU: OnceLock<Result<Gpu, String>> = OnceLock::new();
    match GPU.get_or_init(|| Gpu::new(None).map_err(|error| error.to_string())) {
        Ok(gpu) => Some(gpu.clone()),
        Err(error) if is_required("UMBRAGE_REQUIRE_GPU") => panic!("UMBRAGE_REQUIRE_GPU=1: {error}"),
        Err(error) => {
            skipped(&format!("no graphics adapter: {error}"));
            None
        }
    }
}

/// A build without the feature `gpu` has no adapter.
#[cfg(not(feature = "gpu"))]
pub(crate) fn gpu() -> Option<()> {
    skipped("built without the feature gpu");
    None
}

/// The folder of real meshes. Without it, says that the test is skipped, or fails if the meshes are required.
pub(crate) fn real_meshes() -> Option<PathBuf> {
    beside("meshes", "UMBRAGE_MESHES")
}

/// The folder of small inputs made after public reports, likewise.
pub(crate) fn reports() -> Option<PathBuf> {
    beside("reports", "UMBRAGE_REPORTS")
}

fn beside(name: &str, variable: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(name);
    let folder = std::env::var_os(variable).map_or_else(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    let why = format!("no {name} at {}; set {variable} to their folder", folder.display());
    assert!(!is_required("UMBRAGE_REQUIRE_MESHES"), "UMBRAGE_REQUIRE_MESHES=1: {why}");
    skipped(&why);
    None
}

/// The rows of `facts.csv` by column name: measurements of the real meshes by other programs.
pub(crate) fn facts(folder: &Path) -> Vec<HashMap<String, String>> {
    // A quoted field may hold commas.
    let fields = |line: &str| -> Vec<String> {
        let (mut fields, mut quoted) = (vec![String::new()], false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => fields.push(String::new()),
                _ => fields.last_mut().expect("never empty").push(c),
            }
        }
        fields
    };
    let csv = std::fs::read_to_string(folder.join("facts.csv")).expect("facts.csv lies beside the meshes");
    let mut lines = csv.lines();
    let header = fields(lines.next().expect("a header"));
    lines.map(|line| header.iter().cloned().zip(fields(line)).collect()).collect()
}
