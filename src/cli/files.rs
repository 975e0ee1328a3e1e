//! The files that a command line names: a folder stands for the mesh files in it, `-` for standard input.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use umbrage::read::{self, Format};
use umbrage::scene::Scene;

use super::Failure;

/// The name of standard input.
const STANDARD_INPUT: &str = "-";
/// Bytes of standard input that are taken: 4 GiB. Without an end it would fill the memory.
const MOST_INPUT: u64 = 1 << 32;

/// Reads a file, or standard input.
pub(super) fn read(file: &Path) -> Result<Scene, Failure> {
    if file.is_dir() {
        let problem = "is a directory without mesh files that can be read";
        return Err(Failure::new(problem, "name a mesh file").in_file(file));
    }
    if !is_standard_input(file) {
        return Ok(read::read(file)?);
    }
    Ok(read::read_bytes(&standard_input(file)?, file)?)
}

pub(super) fn is_standard_input(file: &Path) -> bool {
    file == Path::new(STANDARD_INPUT)
}

/// All of standard input, which `file` names.
pub(super) fn standard_input(file: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let failed = |error| {
        let problem = format!("standard input cannot be read: {error}");
        Failure::new(problem, "name a file").in_file(file)
    };
    io::stdin().lock().take(MOST_INPUT + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MOST_INPUT {
        let problem = format!("standard input is longer than {MOST_INPUT} bytes");
        return Err(Failure::new(problem, "write it into a file, and name that").in_file(file));
    }
    Ok(bytes)
}

/// The files, and instead of each folder the mesh files in it and in its folders, by name. A folder without
/// any, or one that cannot be read, stays: reading it says why.
pub(super) fn expand(files: Vec<PathBuf>) -> Vec<PathBuf> {
    let mut expanded = Vec::with_capacity(files.len());
    for file in files {
        let before = expanded.len();
        if !file.is_dir() || list(&file, &mut expanded).is_err() || expanded.len() == before {
            expanded.truncate(before);
            expanded.push(file);
        }
    }
    expanded
}

/// Adds the mesh files of a folder. Links to folders are not followed: they may lead in a circle.
fn list(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    let mut folders = vec![folder.to_owned()];
    let first = files.len();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let path = entry.path();
            if entry.file_type()?.is_dir() {
                folders.push(path);
            } else if path.is_file() && is_mesh(&path) {
                files.push(path);
            }
        }
    }
    files[first..].sort_unstable();
    Ok(())
}

/// Whether the name is that of a mesh file, which may be packed.
fn is_mesh(path: &Path) -> bool {
    let packed = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    let name = if packed { path.with_extension("") } else { path.to_owned() };
    Format::from_extension(&name).is_some()
}
