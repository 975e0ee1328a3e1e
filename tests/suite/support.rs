//! Test support of several stages: the graphics adapter, and the real meshes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
#[cfg(feature = "gpu")]
use std::sync::OnceLock;

#[cfg(feature = "gpu")]
use umbrage::gpu::Gpu;

/// The graphics adapter. Without one, prints that the test is skipped, or fails if an adapter is required.
#[cfg(feature = "gpu")]
pub(crate) fn gpu() -> Option<Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| match Gpu::new(None) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var("UMBRAGE_REQUIRE_GPU").is_ok_and(|value| value == "1") => {
            panic!("UMBRAGE_REQUIRE_GPU=1: {error}")
        }
        Err(error) => {
            eprintln!("SKIPPED, no graphics adapter: {error}");
            None
        }
    })
    .clone()
}

/// A build without the feature `gpu` has no adapter.
#[cfg(not(feature = "gpu"))]
pub(crate) fn gpu() -> Option<()> {
    eprintln!("SKIPPED: built without the feature gpu");
    None
}

/// The folder of real meshes; prints a message if the folder is missing.
pub(crate) fn real_meshes() -> Option<PathBuf> {
    let folder = std::env::var_os("UMBRAGE_MESHES").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/meshes")),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("SKIPPED: no real meshes at {}; set UMBRAGE_MESHES to their folder", folder.display());
    None
}

/// The folder of small files made after reports of other tools; prints a message if the folder is missing.
pub(crate) fn reports() -> Option<PathBuf> {
    let folder = std::env::var_os("UMBRAGE_REPORTS").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/reports")),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("SKIPPED: no report files at {}; set UMBRAGE_REPORTS to their folder", folder.display());
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
