//! 3D Manufacturing Format (3MF): a ZIP package with models as XML.
//!
//! 3MF Consortium, *3D Manufacturing Format Core Specification* 1.3, 2021, and *Production Extension* 1.1,
//! 2021. Read are mesh objects, components and build items with their transforms, across all model parts. A
//! required extension that changes geometry is refused by name. Lengths stay in the unit of the file.

mod model;
mod place;
#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::io::{BufReader, Read, Seek};

use zip::ZipArchive;

use super::packed::{member, too_much, unzipped};
use super::{Format, ReadError};
use crate::scene::Scene;
use model::Model;

/// The name of the model part that the package begins with; `None` if this is no 3MF package.
pub(super) fn root(names: &[String]) -> Option<&str> {
    let usual = names.iter().find(|name| name.eq_ignore_ascii_case("3D/3dmodel.model"));
    let any = || names.iter().find(|name| name.to_ascii_lowercase().ends_with(".model"));
    usual.or_else(any).map(String::as_str)
}

/// Reads a package. All parts together may unpack to `most` bytes.
pub(super) fn read<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    root: &str,
    mut most: u64,
) -> Result<Scene, ReadError> {
    let root = related(archive, most).unwrap_or_else(|| root.to_owned());
    let mut parts = Parts::default();
    parts.add(root.clone(), part(archive, &root, &mut most)?);
    // Further parts, each once, in the order in which they are named.
    let mut next = 0;
    while let Some((_, model)) = parts.models.get(next) {
        let wanted: Vec<String> = model.other_parts().map(str::to_owned).collect();
        for name in wanted {
            if !parts.index.contains_key(&name) {
                let model = part(archive, &name, &mut most)?;
                parts.add(name, model);
            }
        }
        next += 1;
    }
    place::scene(parts)
}

/// The model parts of a package, each with its name.
#[derive(Debug, Default)]
struct Parts {
    models: Vec<(String, Model)>,
    index: HashMap<String, usize>,
}

impl Parts {
    fn add(&mut self, name: String, model: Model) {
        self.index.insert(name.clone(), self.models.len());
        self.models.push((name, model));
    }
}

/// The model part that the package's relationships name, if they can be read.
fn related<R: Read + Seek>(archive: &mut ZipArchive<R>, most: u64) -> Option<String> {
    let bytes = member(archive, "_rels/.rels", most).ok()?;
    let target = model::start_part(&bytes)?;
    archive.index_for_name(&target).map(|_| target)
}

/// Reads a part, and takes what it unpacks to from `left`.
fn part<R: Read + Seek>(archive: &mut ZipArchive<R>, name: &str, left: &mut u64) -> Result<Model, ReadError> {
    let file = archive.by_name(name).map_err(|error| unzipped(&error))?;
    if file.encrypted() {
        return Err(error(name, "the part is encrypted"));
    }
    let mut limited = file.take(*left);
    let model = Model::read(BufReader::with_capacity(1 << 16, &mut limited), name);
    *left = limited.limit();
    // What is cut off is not well-formed: the limit is the better reason.
    if *left == 0 { Err(too_much(&format!("part `{name}`"))) } else { model }
}

/// An error in a part of the package.
fn error(part: &str, problem: impl Into<String>) -> ReadError {
    ReadError::new(Format::ThreeMf, super::Place::Item(format!("part `{part}`")), problem)
}
