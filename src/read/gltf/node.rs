//! The node tree of a scene, and the world transform of each node.
//!
//! Walked with an explicit stack, not by recursion: the file decides how deep the tree is.

use glam::{DMat4, DQuat, DVec3, DVec4, Vec3};

use super::Notes;
use super::document::{Document, Kind, Object};
use crate::read::ReadError;

/// The nodes of the default scene, parents before children, each with `world_from_node`.
///
/// Transforms are multiplied in `f64`. Each is finite, also as `f32`.
pub(super) fn scene_nodes(document: &Document, notes: &mut Notes) -> Result<Vec<(usize, DMat4)>, ReadError> {
    let tree = Tree::new(document)?;
    let mut nodes = Vec::new();
    let mut pending: Vec<(usize, DMat4)> =
        tree.roots(document, notes)?.into_iter().rev().map(|root| (root, DMat4::IDENTITY)).collect();
    while let Some((index, world_from_parent)) = pending.pop() {
        let node = document.item(Kind::Node, index)?;
        let world = world_from_parent * parent_from_node(&node)?;
        if !world.as_mat4().is_finite() {
            return Err(node.error("stands beyond the range of 32-bit floats"));
        }
        nodes.push((index, world));
        pending.extend(tree.children[index].iter().rev().map(|&child| (child, world)));
    }
    Ok(nodes)
}

/// Parents and children: every node has at most one parent, and none is its own ancestor.
struct Tree {
    children: Vec<Vec<usize>>,
    parent: Vec<Option<usize>>,
}

impl Tree {
    fn new(document: &Document) -> Result<Self, ReadError> {
        let count = document.list(Kind::Node).len();
        let mut children = Vec::with_capacity(count);
        let mut parent = vec![None; count];
        for index in 0..count {
            let node = document.item(Kind::Node, index)?;
            let links = node.links("children", document, Kind::Node)?;
            for &child in &links {
                if let Some(other) = parent[child].replace(index) {
                    let problem = format!("has two parents, node {other} and node {index}");
                    return Err(document.item(Kind::Node, child)?.error(problem));
                }
            }
            children.push(links);
        }
        // With one parent per node, a node that no root leads to is on a cycle or below one.
        let mut reached = vec![false; count];
        let mut pending: Vec<usize> = (0..count).filter(|&node| parent[node].is_none()).collect();
        while let Some(node) = pending.pop() {
            reached[node] = true;
            pending.extend(&children[node]);
        }
        if let Some(mut node) = reached.iter().position(|&reached| !reached) {
            for _ in 0..count {
                node = parent[node].expect("what no root leads to has a parent"); // ends on the cycle
            }
            return Err(document.item(Kind::Node, node)?.error("is its own ancestor"));
        }
        Ok(Self { children, parent })
    }

    /// The roots of the default scene, or else of the first, or else of all nodes.
    fn roots(&self, document: &Document, notes: &mut Notes) -> Result<Vec<usize>, ReadError> {
        let scenes = document.list(Kind::Scene).len();
        let stated = document.object().link("scene", document, Kind::Scene)?;
        let Some(index) = stated.or((scenes > 0).then_some(0)) else {
            return Ok((0..self.parent.len()).filter(|&node| self.parent[node].is_none()).collect());
        };
        let scene = document.item(Kind::Scene, index)?;
        notes.add_many("read, the other scenes left out", &scene.place, usize::from(scenes > 1));
        let roots = scene.links("nodes", document, Kind::Node)?;
        let mut listed = vec![false; self.parent.len()];
        for &root in &roots {
            if let Some(parent) = self.parent[root] {
                return Err(
                    scene.error(format!("lists node {root} as a root, but it is a child of node {parent}"))
                );
            }
            if std::mem::replace(&mut listed[root], true) {
                return Err(scene.error(format!("lists node {root} twice")));
            }
        }
        Ok(roots)
    }
}

/// A node's own transform: a matrix, or translation, rotation and scale.
fn parent_from_node(node: &Object) -> Result<DMat4, ReadError> {
    if let Some(columns) = node.numbers::<16>("matrix")? {
        let matrix = DMat4::from_cols_array(&columns);
        if matrix.row(3) != DVec4::W {
            return Err(node.error("has a matrix whose last row is not 0, 0, 0, 1"));
        }
        return Ok(matrix);
    }
    let translation = node.numbers("translation")?.map_or(DVec3::ZERO, DVec3::from_array);
    let scale = node.numbers("scale")?.map_or(DVec3::ONE, DVec3::from_array);
    let rotation = match node.numbers("rotation")? {
        None => DQuat::IDENTITY,
        // Written as 32-bit floats, a unit quaternion is one only nearly.
        Some(xyzw) => match DVec4::from_array(xyzw).try_normalize() {
            Some(unit) => DQuat::from_vec4(unit),
            None => return Err(node.error("has a rotation of length zero")),
        },
    };
    Ok(DMat4::from_scale_rotation_translation(scale, rotation, translation))
}

/// The world direction of the node's `axis`, unit length; `None` if it has length zero in the world.
pub(super) fn direction(world: DMat4, axis: DVec3) -> Option<Vec3> {
    Some(world.transform_vector3(axis).try_normalize()?.as_vec3())
}
