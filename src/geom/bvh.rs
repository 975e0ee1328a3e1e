//! Bounding volume hierarchy with conservative queries. No input makes the build slow or the tree deep.
//!
//! Built top-down by the surface area heuristic over 16 bins (Ingo Wald, *On fast Construction of SAH-based
//! Bounding Volume Hierarchies*, 2007). Where the heuristic finds no split, or has been used for 64 levels, a
//! range is split in half. So a tree over n boxes has at most 64 + log₂ n levels, and its build takes at most
//! as many passes over the boxes, for every input. (Bottom-up builders that merge nearest neighbors take n
//! passes if all boxes are equal, or if each box is larger than the previous one.)

use std::ops::Range;

use super::{Aabb, Segment};

mod collapse;
mod halfspaces;
mod node;
mod split;
mod wide;

pub(crate) use halfspaces::{HalfSpace, MOST_SIDES};
use split::{Hull, Item, split};
pub(crate) use wide::{Step, WideBvh};

/// A bounding volume hierarchy over axis-aligned boxes, stored in depth-first order with skip links: a
/// traversal needs no stack.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// Indices of the boxes in the order of the leaves.
    primitives: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    aabb: Aabb,
    /// The next node if this node's box is missed; for a leaf, the next node in any case.
    skip: u32,
    /// Index of the first primitive of this node's subtree; the last one precedes the first primitive of
    /// `nodes[skip]`.
    first: u32,
}

/// Content of a node.
#[cfg(feature = "verify")]
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Below {
    /// Indices of the two child nodes.
    Nodes([usize; 2]),
    /// Slots of a leaf.
    Slots(Range<u32>),
}

impl Bvh {
    /// Builds a tree over boxes, none of them empty. About 300 ns per box.
    ///
    /// Memory: 68 bytes per box for the tree, 100 during the build.
    ///
    /// # Panics
    ///
    /// Panics if there are 2³¹ boxes or more.
    #[must_use]
    pub fn build(boxes: &[Aabb]) -> Self {
        assert!(boxes.len() < 1 << 31, "{} boxes; a tree holds less than 2^31", boxes.len());
        if boxes.is_empty() {
            return Self::default();
        }
        // A node is visited twice: on the way down, and when its subtree is complete, to set its skip link.
        enum Visit {
            Open { start: usize, end: usize, depth: u32, hull: Hull },
            Close(usize),
        }
        let mut items: Vec<Item> =
            boxes.iter().zip(0..).map(|(aabb, index)| Item::new(aabb, index)).collect();
        let mut nodes: Vec<Node> = Vec::with_capacity(2 * boxes.len());
        let mut stack = vec![Visit::Open { start: 0, end: items.len(), depth: 0, hull: Hull::of(&items) }];
        while let Some(visit) = stack.pop() {
            match visit {
                Visit::Open { start, end, depth, hull } => {
                    let place = nodes.len(); // at most two nodes per box
                    nodes.push(Node { aabb: hull.boxes.aabb(), skip: place as u32 + 1, first: start as u32 });
                    if let Some((left, hulls)) = split(&mut items[start..end], &hull, depth) {
                        let (middle, depth) = (start + left, depth + 1);
                        stack.push(Visit::Close(place));
                        stack.push(Visit::Open { start: middle, end, depth, hull: hulls[1] });
                        stack.push(Visit::Open { start, end: middle, depth, hull: hulls[0] });
                    }
                }
                Visit::Close(place) => nodes[place].skip = nodes.len() as u32,
            }
        }
        nodes.push(Node { aabb: Aabb::EMPTY, skip: 0, first: items.len() as u32 }); // never visited
        Self { nodes, primitives: items.iter().map(|item| item.index()).collect() }
    }

    /// Indices of the boxes in the order of the leaves. Data stored in this order is accessed in runs.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.primitives
    }

    /// Bounding box of all boxes; empty for an empty tree.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |root| root.aabb)
    }

    /// A node by its index, 0 for the root of a non-empty tree: its box, and its content.
    #[cfg(feature = "verify")]
    pub(crate) fn node(&self, at: usize) -> (Aabb, Below) {
        let node = self.nodes[at];
        let (left, right) = (at + 1, node.skip as usize);
        if left == right {
            return (node.aabb, Below::Slots(node.first..self.nodes[left].first));
        }
        (node.aabb, Below::Nodes([left, self.nodes[left].skip as usize]))
    }

    /// Visits every slot (index into [`Bvh::order`]) whose leaf box passes `test`, in order, until `visit`
    /// returns `false`.
    #[inline]
    pub fn walk(&self, mut test: impl FnMut(&Aabb) -> bool, mut visit: impl FnMut(usize) -> bool) {
        let end = self.nodes.len().saturating_sub(1);
        let mut at = 0;
        while at < end {
            let node = &self.nodes[at];
            if !test(&node.aabb) {
                at = node.skip as usize;
                continue;
            }
            at += 1;
            if node.skip as usize == at {
                for slot in node.first..self.nodes[at].first {
                    if !visit(slot as usize) {
                        return;
                    }
                }
            }
        }
    }

    fn is_leaf(&self, at: usize) -> bool {
        self.nodes[at].skip as usize == at + 1
    }

    fn slots_below(&self, at: usize) -> Range<usize> {
        let node = &self.nodes[at];
        node.first as usize..self.nodes[node.skip as usize].first as usize
    }

    /// The same tree collapsed to eight children per node, and the indices of the boxes in the order of its
    /// leaves.
    pub(crate) fn into_wide(mut self) -> (WideBvh, Vec<u32>) {
        self.nodes.shrink_to_fit();
        WideBvh::of(&self)
    }

    /// Visits the index of every box that may meet `segment`, and of some boxes that do not.
    #[inline]
    pub fn for_each_along(&self, segment: &Segment, mut visit: impl FnMut(u32)) {
        self.walk(
            |aabb| segment.may_meet(aabb),
            |slot| {
                visit(self.primitives[slot]);
                true
            },
        );
    }

    /// Visits the index of every box that may overlap `query`, and of some boxes that do not: all boxes of a
    /// leaf are visited together.
    #[inline]
    pub fn for_each_overlapping(&self, query: &Aabb, mut visit: impl FnMut(u32)) {
        self.walk(
            |aabb| aabb.overlaps(query),
            |slot| {
                visit(self.primitives[slot]);
                true
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes on a scattered grid: some are equal, some huge, some points.
    fn boxes(n: u32, scale: f32) -> Vec<Aabb> {
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 20) as f32 / 4096.0
        };
        (0..n)
            .map(|i| {
                let low = [next(), next(), next()].map(|x| x * scale);
                let size = if i % 7 == 0 { 0.0 } else { 0.05 * scale };
                Aabb { low, high: low.map(|x| x + size) }
            })
            .collect()
    }

    fn found(visit: impl FnOnce(&mut dyn FnMut(u32))) -> Vec<u32> {
        let mut all = Vec::new();
        visit(&mut |index| all.push(index));
        all.sort_unstable();
        all
    }

    #[test]
    fn bvh_finds_what_a_loop_over_all_boxes_finds() {
        for (n, scale) in [(0, 1.0), (1, 1.0), (2, 1.0), (3, 1e-38), (500, 1.0), (500, 1e38), (64, 1e-44)] {
            let boxes = boxes(n, scale);
            let bvh = Bvh::build(&boxes);
            let mut order = bvh.order().to_vec();
            order.sort_unstable();
            assert_eq!(order, (0..n).collect::<Vec<_>>());
            for query in &boxes {
                let candidates = found(|visit| bvh.for_each_overlapping(query, visit));
                let all = (0..n).filter(|&i| boxes[i as usize].overlaps(query));
                assert!(all.clone().all(|i| candidates.binary_search(&i).is_ok()));
                let segment = Segment::between(query.low, [0.5 * scale; 3]);
                let candidates = found(|visit| bvh.for_each_along(&segment, visit));
                let mut all = (0..n).filter(|&i| segment.may_meet(&boxes[i as usize]));
                assert!(all.all(|i| candidates.binary_search(&i).is_ok()));
            }
        }
    }

    #[test]
    fn bvh_of_equal_boxes_is_finite_and_complete() {
        let boxes = vec![Aabb { low: [1.0; 3], high: [1.0; 3] }; 10_000];
        let bvh = Bvh::build(&boxes);
        assert_eq!(found(|visit| bvh.for_each_overlapping(&boxes[0], visit)).len(), 10_000);
    }

    #[test]
    fn bvh_with_a_bound_that_is_too_small_would_be_seen() {
        let boxes = boxes(500, 1.0);
        let mut bvh = Bvh::build(&boxes);
        bvh.nodes[0].aabb.high[0] *= 0.5; // fault injected
        let lost = boxes.iter().any(|query| {
            let candidates = found(|visit| bvh.for_each_overlapping(query, visit));
            (0..500).any(|i| boxes[i as usize].overlaps(query) && candidates.binary_search(&i).is_err())
        });
        assert!(lost);
    }
}
