//! EXT_mesh_gpu_instancing: a node places its mesh many times, each by a transform below its own.

use glam::{DMat4, DQuat, DVec3, Mat4};

use super::accessor::vectors;
use super::asset::Asset;
use super::document::Kind;
use super::node::rotation;
use super::object::Object;
use crate::read::ReadError;
use crate::scene::Instance;

/// The transforms of a node's instances, each finite as `f32`; `None` if the node has no instances of its
/// own.
pub(super) fn read(asset: &Asset, node: &Object, world: DMat4) -> Result<Option<Vec<Mat4>>, ReadError> {
    let Some(extension) = node.extension("EXT_mesh_gpu_instancing") else { return Ok(None) };
    let attributes = extension.required("attributes", extension.object("attributes")?)?;
    let link = |key| attributes.link(key, asset.document, Kind::Accessor);
    let translations =
        link("TRANSLATION")?.map(|index| vectors::<3>(asset, index, "a translation")).transpose()?;
    let rotations = link("ROTATION")?.map(|index| vectors::<4>(asset, index, "a rotation")).transpose()?;
    let scales = link("SCALE")?.map(|index| vectors::<3>(asset, index, "a scale")).transpose()?;

    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let mut counts = counts.into_iter().flatten();
    let Some(count) = counts.next() else {
        asset.notes.add("instancing without transforms read as a single instance", &node.place);
        return Ok(None);
    };
    if let Some(other) = counts.find(|&other| other != count) {
        return Err(
            attributes.error(format!("has {count} and {other} transforms, but must have as many of each"))
        );
    }
    // Each instance holds its transform and a name.
    let bytes = size_of::<Instance>() + node.name().len();
    asset.charge_bytes(count.saturating_mul(bytes), &attributes)?;
    let transform = |index: usize| {
        let vector =
            |list: &Option<Vec<[f32; 3]>>| list.as_ref().map(|list| DVec3::from(list[index].map(f64::from)));
        let turn = match &rotations {
            None => DQuat::IDENTITY,
            Some(list) => rotation(list[index].map(f64::from))
                .ok_or_else(|| attributes.error(format!("instance {index} has a rotation of length zero")))?,
        };
        let (scale, translation) =
            (vector(&scales).unwrap_or(DVec3::ONE), vector(&translations).unwrap_or(DVec3::ZERO));
        let placed = (world * DMat4::from_scale_rotation_translation(scale, turn, translation)).as_mat4();
        let beyond = || format!("instance {index} stands beyond the range of 32-bit floats");
        if placed.is_finite() { Ok(placed) } else { Err(attributes.error(beyond())) }
    };
    (0..count).map(transform).collect::<Result<_, _>>().map(Some)
}
