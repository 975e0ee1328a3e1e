//! Visibility in `f32` as most programs compute it: the traversal and the triangle test of obvhs.

use std::collections::VecDeque;

use glam::Vec3A;
use obvhs::aabb::Aabb as Box32;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ray::{Ray, safe_inverse};
use obvhs::triangle::Triangle;

use crate::geom::bvh::{Below, Bvh};
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;

/// The binary tree of the exact oracle, converted to the layout of obvhs. (The builders of obvhs take
/// quadratic time where all boxes are equal.)
pub(super) struct PlainTree {
    tree: Bvh2,
    leaves: Vec<Triangle>,
}

/// Traversal stack size in levels, an upper bound of the tree's depth: 64, and one for each bit of a face id.
const DEPTH: usize = 128;

impl PlainTree {
    pub(super) fn build(mesh: &Mesh) -> Self {
        let corners = |face: &[u32; 3]| face.map(|vertex| mesh.positions()[vertex as usize]);
        let boxes: Vec<Aabb> = mesh.triangles().iter().map(|face| Aabb::around(corners(face))).collect();
        let tree = Bvh::build(&boxes);
        let triangles: Vec<[[f32; 3]; 3]> =
            tree.order().iter().map(|&face| corners(&mesh.triangles()[face as usize])).collect();
        let leaf = |corners: &[[f32; 3]; 3]| {
            let [v0, v1, v2] = corners.map(Vec3A::from);
            Triangle { v0, v1, v2 }
        };
        let mut nodes = Vec::with_capacity(2 * triangles.len());
        if !triangles.is_empty() {
            nodes.push(Bvh2Node::default());
        }
        // Siblings are stored side by side: their slots are allocated when their parent is written.
        let mut open: VecDeque<[usize; 2]> = (0..nodes.len()).map(|root| [root, root]).collect();
        while let Some([from, to]) = open.pop_front() {
            let (aabb, below) = tree.node(from);
            let aabb = Box32::new(aabb.low.into(), aabb.high.into());
            nodes[to] = match below {
                Below::Slots(slots) => Bvh2Node::new(aabb, slots.end - slots.start, slots.start),
                Below::Nodes(children) => {
                    let first = nodes.len();
                    for (child, place) in children.into_iter().zip(first..) {
                        nodes.push(Bvh2Node::default());
                        open.push_back([child, place]);
                    }
                    Bvh2Node::new(aabb, 0, first as u32)
                }
            };
        }
        let tree = Bvh2 { nodes, max_depth: DEPTH, ..Bvh2::default() };
        Self { tree, leaves: triangles.iter().map(leaf).collect() }
    }

    /// Whether the segment from `p` to the light hits a face.
    #[inline]
    pub(super) fn shadowed(&self, p: [f32; 3], light: &Light) -> bool {
        let (origin, towards) = (Vec3A::from(p), Vec3A::from(light.xyz()));
        let (direction, tmax) =
            if light.is_directional() { (towards, f32::INFINITY) } else { (towards - origin, 1.0) };
        // As `Ray::new`, which asserts in debug builds that nothing overflows.
        let inv_direction = Vec3A::from(direction.to_array().map(safe_inverse));
        let ray = Ray { origin, direction, inv_direction, tmin: 0.0, tmax };
        !self.tree.ray_traverse_miss(ray, |ray, slot| self.leaves[slot].intersect(ray))
    }
}
