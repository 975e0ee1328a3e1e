//! Joints and weights, as far as needed to keep apart what a skin moves differently.

use std::collections::HashMap;

use super::accessor;
use super::asset::Asset;
use super::component::Component;
use super::document::Kind;
use super::object::Object;
use crate::read::ReadError;

/// The joints that move a vertex, each with the bits of its weight; those without weight left out, in the
/// order of the joints.
type Influences = Vec<(u32, u32)>;

/// The numbers of vertices: equal for equal influences, also in different meshes.
#[derive(Default)]
pub(super) struct Numbers {
    known: HashMap<Influences, u32>,
    /// One a vertex of all primitives of the mesh so far.
    of_vertices: Vec<u32>,
}

impl Numbers {
    /// The numbers of a mesh, whose primitives have been added.
    pub(super) fn take(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.of_vertices)
    }

    /// Joints and weights of each number.
    pub(super) fn lists(&self) -> Vec<Vec<(u32, f32)>> {
        let mut lists = vec![Vec::new(); self.known.len()];
        for (influences, &number) in &self.known {
            let weighted = influences.iter().map(|&(joint, bits)| (joint, f32::from_bits(bits)));
            lists[number as usize] = weighted.collect();
        }
        lists
    }

    /// Adds the `count` vertices of a primitive. What cannot be read moves nothing, and is noted.
    pub(super) fn add(&mut self, asset: &Asset, primitive: &Object, count: usize) {
        let influences = match read(asset, primitive, count) {
            Ok(influences) => influences,
            Err(error) => {
                let what = "joints and weights that cannot be read ignored";
                asset.notes.because(what, &primitive.place, || error.problem);
                vec![Influences::new(); count]
            }
        };
        for influences in influences {
            let next = self.known.len() as u32; // at most one a vertex
            self.of_vertices.push(*self.known.entry(influences).or_insert(next));
        }
    }
}

/// All sets of four joints and weights: `JOINTS_0` and `WEIGHTS_0`, then `_1`, and so on.
fn read(asset: &Asset, primitive: &Object, count: usize) -> Result<Vec<Influences>, ReadError> {
    let mut all = vec![Influences::new(); count];
    let Some(attributes) = primitive.object("attributes")? else { return Ok(all) };
    for set in 0.. {
        let link = |key: &str| attributes.link(&format!("{key}_{set}"), asset.document, Kind::Accessor);
        let (Some(joints), Some(weights)) = (link("JOINTS")?, link("WEIGHTS")?) else { break };
        for accessor in [joints, weights] {
            if asset.document.item(Kind::Accessor, accessor)?.is_empty() {
                return Err(primitive.error("has joints or weights without data of their own"));
            }
        }
        let joints = integers(asset, joints)?;
        let weights = accessor::vectors::<4>(asset, weights, "a weight")?;
        if joints.len() != count || weights.len() != count {
            let (joints, weights) = (joints.len(), weights.len());
            let problem = format!("has {joints} joints and {weights} weights for {count} vertices");
            return Err(primitive.error(problem));
        }
        for ((influences, joints), weights) in all.iter_mut().zip(joints).zip(weights) {
            let pairs = joints.into_iter().zip(weights);
            influences.extend(pairs.filter(|(_, weight)| *weight != 0.0).map(|(j, w)| (j, w.to_bits())));
        }
    }
    all.iter_mut().for_each(|influences| influences.sort_unstable());
    Ok(all)
}

/// Vectors of four unsigned integers.
fn integers(asset: &Asset, index: usize) -> Result<Vec<[u32; 4]>, ReadError> {
    let object = asset.document.item(Kind::Accessor, index)?;
    let component = match Component::of(&object)? {
        component @ (Component::U8 | Component::U16 | Component::U32) => component,
        _ => return Err(object.error("holds numbers that are not unsigned integers, but a joint is one")),
    };
    if object.text("type")? != Some("VEC4") {
        return Err(object.error("is no VEC4, but joints are four"));
    }
    let size = component.bytes();
    accessor::elements(asset, &object, 4 * size, [0; 4], |bytes| {
        [0, 1, 2, 3].map(|axis| component.whole(&bytes[axis * size..]))
    })
}
