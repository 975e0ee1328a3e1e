//! The node tree of a scene, and the world transform of each node.
//!
//! Walked with an explicit stack, not by recursion: the file decides how deep the tree is.

use glam::{DMat4, DQuat, DVec3, DVec4, Vec3};

use super::document::{Document, Kind};
use super::notes::Notes;
use super::object::Object;
use super::tree::Tree;
use crate::animate::Local;
use crate::read::ReadError;

/// A node of the scene.
pub(super) struct Placed {
    /// Its index in the document.
    pub(super) index: usize,
    /// Finite, also as `f32`.
    pub(super) world_from_node: DMat4,
    /// Whether it or a node above it says that it is not to be seen.
    pub(super) hidden: bool,
    /// Its place in this list.
    pub(super) parent: Option<usize>,
    /// Its own transform.
    pub(super) local: Local,
}

/// The nodes of the default scene, parents before children. Transforms are multiplied in `f64`.
pub(super) fn scene_nodes(document: &Document, notes: &Notes) -> Result<Vec<Placed>, ReadError> {
    let tree = Tree::new(document, notes)?;
    let mut nodes = Vec::new();
    let mut pending: Vec<(usize, Option<usize>)> =
        tree.roots.iter().rev().map(|&root| (root, None)).collect();
    while let Some((index, parent)) = pending.pop() {
        let node = document.item(Kind::Node, index)?;
        let above = parent.map(|parent: usize| &nodes[parent]);
        let (world_from_parent, hidden) =
            above.map_or((DMat4::IDENTITY, false), |above: &Placed| (above.world_from_node, above.hidden));
        let local = parent_from_node(&node)?;
        let world_from_node = world_from_parent * local.matrix();
        if !world_from_node.as_mat4().is_finite() {
            return Err(node.error("stands beyond the range of 32-bit floats"));
        }
        let hidden = hidden || hides(&node, notes);
        let this = Some(nodes.len());
        nodes.push(Placed { index, world_from_node, hidden, parent, local });
        pending.extend(tree.children[index].iter().rev().map(|&child| (child, this)));
    }
    Ok(nodes)
}

/// Whether a node hides itself and what is below it (KHR_node_visibility).
fn hides(node: &Object, notes: &Notes) -> bool {
    let Some(extension) = node.extension("KHR_node_visibility") else { return false };
    match extension.flag_or("visible", true) {
        Ok(true) => false,
        Ok(false) => {
            notes.add("hidden node (KHR_node_visibility) left out, with all below it", &node.place);
            true
        }
        Err(error) => {
            notes.because("node taken for visible", &node.place, || error.problem);
            false
        }
    }
}

/// A node's own transform: a matrix, or translation, rotation and scale.
fn parent_from_node(node: &Object) -> Result<Local, ReadError> {
    if let Some(columns) = node.numbers::<16>("matrix")? {
        let matrix = DMat4::from_cols_array(&columns);
        if matrix.row(3) != DVec4::W {
            return Err(node.error("has a matrix whose last row is not 0, 0, 0, 1"));
        }
        return Ok(Local::Matrix(matrix));
    }
    let translation = node.numbers("translation")?.map_or(DVec3::ZERO, DVec3::from_array);
    let scale = node.numbers("scale")?.map_or(DVec3::ONE, DVec3::from_array);
    let rotation = match node.numbers("rotation")? {
        None => DQuat::IDENTITY,
        Some(xyzw) => rotation(xyzw).ok_or_else(|| node.error("has a rotation of length zero"))?,
    };
    Ok(Local::Parts { translation, rotation, scale })
}

/// A quaternion at unit length: written as 32-bit floats, or less, it is a unit only nearly. `None` if it has
/// length zero.
pub(super) fn rotation(xyzw: [f64; 4]) -> Option<DQuat> {
    DVec4::from_array(xyzw).try_normalize().map(DQuat::from_vec4)
}

/// The world direction of the node's `axis`, unit length; `None` if it has length zero in the world.
pub(super) fn direction(world: DMat4, axis: DVec3) -> Option<Vec3> {
    Some(world.transform_vector3(axis).try_normalize()?.as_vec3())
}
