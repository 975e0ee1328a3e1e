//! The materials that show a ramp: those of the primitives that have its coordinates, and of no others.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use serde_json::{Value, json};

use super::document::{Document, whole};
use super::{OcclusionOptions, WriteError, ramp};

const TEXTURE: &str = "occlusionTexture";
const MAPPINGS: &str = "/extensions/KHR_materials_variants/mappings";

/// The most sets of texture coordinates that viewers read.
const SETS: usize = 4;

/// Where a primitive names a material: itself, or one of its variants.
struct Use {
    /// JSON pointer of the object with the key `material`.
    at: String,
    material: Option<usize>,
    /// The set of coordinates with the ramp, if it has one.
    set: Option<usize>,
}

/// The set of texture coordinates that the primitive at `pointer` has free: one that it does not have, and
/// that its materials do not ask for.
pub(super) fn free_set(root: &Value, pointer: &str) -> Result<usize, WriteError> {
    let mut taken = BTreeSet::new();
    let uses = uses_of(root, pointer, None);
    let materials = uses.iter().filter_map(|found| root.pointer(&format!("/materials/{}", found.material?)));
    materials.for_each(|material| sets_of(material, &mut taken));
    let has = |set: &usize| root.pointer(&format!("{pointer}/attributes/TEXCOORD_{set}")).is_some();
    (0..SETS).find(|set| !taken.contains(&(*set as u64)) && !has(set)).ok_or_else(|| {
        let problem =
            format!("{pointer} has {SETS} sets of texture coordinates already, and viewers read no more");
        WriteError::new(problem, "use --as attribute")
    })
}

/// The sets of coordinates that the textures of a material use, but for the one that is replaced.
fn sets_of(value: &Value, sets: &mut BTreeSet<u64>) {
    let Some(object) = value.as_object() else { return };
    let set = object.get("texCoord").and_then(Value::as_u64);
    sets.extend(set.or(object.contains_key("index").then_some(0)));
    object.iter().filter(|(key, _)| *key != TEXTURE).for_each(|(_, value)| sets_of(value, sets));
}

/// The uses of materials by the primitive at `pointer`.
fn uses_of(root: &Value, pointer: &str, set: Option<usize>) -> Vec<Use> {
    let exists = |index: &usize| root.pointer(&format!("/materials/{index}")).is_some();
    let named = |at: String| {
        let material = whole(root.pointer(&format!("{at}/material"))).filter(exists);
        Use { at, material, set }
    };
    let mappings = root.pointer(&format!("{pointer}{MAPPINGS}")).and_then(Value::as_array);
    let variants =
        (0..mappings.map_or(0, Vec::len)).map(|index| named(format!("{pointer}{MAPPINGS}/{index}")));
    let variants = variants.filter(|found| found.material.is_some());
    std::iter::once(named(pointer.to_owned())).chain(variants).collect()
}

/// Refuses materials of the primitive at `pointer` that have an occlusion texture already.
pub(super) fn refuse_replacing(root: &Value, pointer: &str) -> Result<(), WriteError> {
    for index in uses_of(root, pointer, None).into_iter().filter_map(|found| found.material) {
        let material = &root["materials"][index];
        if material.get(TEXTURE).is_some() {
            let name = material.get("name").and_then(Value::as_str);
            let name = name.map_or_else(String::new, |name| format!(" ({name})"));
            let problem = format!("material {index}{name} has an occlusion texture already");
            return Err(WriteError::new(problem, "replace it with --replace, or use --as attribute"));
        }
    }
    Ok(())
}

/// Gives the primitives of `sets`, by their pointers, materials with a ramp that is read at these sets of
/// coordinates. A material that others use as well stays theirs, and a copy is made. Returns how many of the
/// materials are unlit.
pub(super) fn add(
    document: &mut Document<'_, '_>,
    sets: &HashMap<String, usize>,
    options: &OcclusionOptions,
) -> Result<usize, WriteError> {
    let mut uses: BTreeMap<Option<usize>, Vec<Use>> = BTreeMap::new();
    for mesh in 0..document.list("meshes").len() {
        let primitives = document.root["meshes"][mesh].get("primitives").and_then(Value::as_array);
        for primitive in 0..primitives.map_or(0, Vec::len) {
            let pointer = format!("/meshes/{mesh}/primitives/{primitive}");
            for found in uses_of(&document.root, &pointer, sets.get(&pointer).copied()) {
                uses.entry(found.material).or_default().push(found);
            }
        }
    }
    let texture = ramp::add(document)?;
    let mut unlit = 0;
    for (material, uses) in uses {
        let wanted: BTreeSet<usize> = uses.iter().filter_map(|found| found.set).collect();
        // The material itself is changed last, and only if nothing else shows it.
        let own = wanted.last().copied().filter(|_| material.is_some());
        let own = own.filter(|_| uses.iter().all(|found| found.set.is_some()));
        for set in wanted {
            let index = match material {
                Some(material) if own == Some(set) => material,
                Some(material) => {
                    let copy = document.root["materials"][material].clone();
                    document.push("materials", copy)
                }
                None => document.push("materials", options.fresh.clone()),
            };
            let changed = document.object(&format!("/materials/{index}"))?;
            changed.insert(TEXTURE.to_owned(), json!({"index": texture, "texCoord": set}));
            let extensions = changed.get("extensions");
            unlit += usize::from(extensions.is_some_and(|all| all.get("KHR_materials_unlit").is_some()));
            for found in uses.iter().filter(|found| found.set == Some(set)) {
                document.object(&found.at)?.insert("material".to_owned(), index.into());
            }
        }
    }
    Ok(unlit)
}
