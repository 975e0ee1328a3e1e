//! Materials: base color, alpha mode and cutoff. Textures are not read.

use super::document::{Document, Kind};
use super::notes::Notes;
use super::object::Object;
use crate::read::ReadError;
use crate::scene::{AlphaMode, Material};

/// Material `index` of the document. One that is malformed is noted and taken for an opaque one: it changes
/// no geometry.
pub(super) fn read(document: &Document, index: usize, notes: &Notes) -> Material {
    document.item(Kind::Material, index).and_then(|object| material(&object)).unwrap_or_else(|_| {
        notes.add("malformed material taken for an opaque one", &Object::place(Kind::Material, index));
        Material::default()
    })
}

fn material(object: &Object) -> Result<Material, ReadError> {
    let mut material = Material { name: object.given_name().unwrap_or_default(), ..Material::default() };
    if let Some(pbr) = object.object("pbrMetallicRoughness")? {
        if let Some(factor) = pbr.numbers::<4>("baseColorFactor")? {
            let [r, g, b, alpha] = factor.map(|x| (x as f32).clamp(0.0, 1.0));
            (material.base_color, material.alpha) = (Some([r, g, b]), alpha);
        }
        material.textured = pbr.object("baseColorTexture")?.is_some();
    }
    material.alpha_mode = match object.text("alphaMode")? {
        None | Some("OPAQUE") => AlphaMode::Opaque,
        Some("MASK") => AlphaMode::Mask,
        Some("BLEND") => AlphaMode::Blend,
        Some(_) => return Err(object.error("alphaMode is not OPAQUE, MASK or BLEND")),
    };
    material.alpha_cutoff = object.number("alphaCutoff")?.unwrap_or(material.alpha_cutoff);
    Ok(material)
}
