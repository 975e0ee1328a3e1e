//! A bounding-volume hierarchy whose answers never miss: obvhs finds the tree, the bounds are our own.
//!
//! obvhs clusters scaled copies of the boxes (Daniel Meister and Jiří Bittner, *Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction*, 2018), since surface areas of the originals may leave
//! `f32`. Only the shape of its tree is taken; bounds are joined anew from the boxes themselves, so nothing that
//! happens there can lose a primitive.

use obvhs::bvh2::{Bvh2, leaf_collapser::collapse};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::{Aabb, Segment};

/// A tree over axis-aligned boxes, stored in depth-first order with skip links: a walk needs no stack, so no
/// input can make it too deep.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// Indices of the boxes that the tree was built of, in the order of the leaves.
    primitives: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    aabb: Aabb,
    /// The node that follows when this one's box is missed; one further on for a leaf.
    skip: u32,
    /// Where the primitives of this node's subtree start; they end where those of `nodes[skip]` start.
    first: u32,
}

/// Most primitives in a leaf, and what a box test costs against a primitive's.
const LEAF: u32 = 4;
const BOX_COST: f32 = 1.0;

impl Bvh {
    /// Builds a tree over boxes, none of them empty. About 250 ns a box; 64 bytes a box while it lives.
    ///
    /// # Panics
    ///
    /// Panics if there are 2³¹ boxes or more.
    #[must_use]
    pub fn build(boxes: &[Aabb]) -> Self {
        assert!(boxes.len() < 1 << 31, "{} boxes; a tree holds less than 2^31", boxes.len());
        match boxes {
            [] => Self::default(),
            [only] => Self { nodes: vec![Node { aabb: *only, skip: 1, first: 0 }, END], primitives: vec![0] }
                .ended(),
            _ => Self::flatten(&cluster(boxes), boxes),
        }
    }

    /// Depth-first order with skip links, and bounds from the leaves upwards.
    fn flatten(tree: &Bvh2, boxes: &[Aabb]) -> Self {
        let mut nodes: Vec<Node> = Vec::with_capacity(tree.nodes.len() + 1);
        let mut primitives = Vec::with_capacity(boxes.len());
        // A node is met twice: first on the way down, then, when all below it is placed, to be closed.
        enum Visit {
            Open(u32),
            Close(u32),
        }
        let mut stack = vec![Visit::Open(0)];
        while let Some(visit) = stack.pop() {
            match visit {
                Visit::Open(source) => {
                    let source = &tree.nodes[source as usize];
                    let place = nodes.len() as u32; // at most two nodes a box
                    nodes.push(Node { aabb: Aabb::EMPTY, skip: 0, first: primitives.len() as u32 });
                    stack.push(Visit::Close(place));
                    let range = source.first_index..source.first_index + source.prim_count;
                    if range.is_empty() {
                        stack.push(Visit::Open(source.first_index + 1));
                        stack.push(Visit::Open(source.first_index));
                    } else {
                        primitives.extend(range.map(|slot| tree.primitive_indices[slot as usize]));
                    }
                }
                Visit::Close(place) => {
                    let range = nodes[place as usize].first as usize..primitives.len();
                    let skip = nodes.len() as u32;
                    let aabb = if skip == place + 1 {
                        primitives[range].iter().fold(Aabb::EMPTY, |aabb, &i| aabb.join(&boxes[i as usize]))
                    } else {
                        let left = nodes[place as usize + 1];
                        left.aabb.join(&nodes[left.skip as usize].aabb)
                    };
                    let node = &mut nodes[place as usize];
                    (node.aabb, node.skip) = (aabb, skip);
                }
            }
        }
        assert_eq!(primitives.len(), boxes.len(), "the tree holds every box");
        nodes.push(END);
        Self { nodes, primitives }.ended()
    }

    fn ended(mut self) -> Self {
        let count = self.primitives.len() as u32;
        let end = self.nodes.last_mut().expect("the end was pushed");
        end.first = count;
        self
    }

    /// The boxes' indices in the order of the leaves: data laid out this way is met in runs.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.primitives
    }

    /// The box around everything; empty for an empty tree.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |root| root.aabb)
    }

    /// Visits every slot (index into [`Bvh::order`]) whose leaf box passes `test`, in order, until `visit`
    /// says to stop by returning `false`.
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

    /// Visits every slot whose leaf box `enter` gives a distance for, nearer boxes first; `enter` is asked again
    /// before a box that was put off is opened, so that it may have become out of reach.
    #[inline]
    pub(crate) fn walk_nearest_first(
        &self,
        mut enter: impl FnMut(&Aabb) -> Option<f64>,
        mut visit: impl FnMut(usize),
    ) {
        let mut put_off: Vec<u32> = Vec::new();
        let mut next = (self.nodes.len() > 1 && enter(&self.nodes[0].aabb).is_some()).then_some(0);
        while let Some(at) = next.take().or_else(|| {
            std::iter::from_fn(|| put_off.pop()).find(|&at| enter(&self.nodes[at as usize].aabb).is_some())
        }) {
            let left = at + 1;
            let [node, first] = [at, left].map(|at| self.nodes[at as usize]);
            if node.skip == left {
                (node.first..first.first).for_each(|slot| visit(slot as usize));
                continue;
            }
            let right = first.skip;
            next = match (enter(&first.aabb), enter(&self.nodes[right as usize].aabb)) {
                (Some(l), Some(r)) => {
                    let (near, far) = if r < l { (right, left) } else { (left, right) };
                    put_off.push(far);
                    Some(near)
                }
                (Some(_), None) => Some(left),
                (None, Some(_)) => Some(right),
                (None, None) => None,
            };
        }
    }

    /// Visits the index of every box that may meet `segment` (and of some that do not).
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

    /// Visits the index of every box in whose leaf something may overlap `query` (and of some that do not).
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

/// Stands after the last node; never visited.
const END: Node = Node { aabb: Aabb::EMPTY, skip: 0, first: 0 };

/// obvhs's tree over the boxes, brought near the unit cube by a power of two so that areas stay in range.
fn cluster(boxes: &[Aabb]) -> Bvh2 {
    let largest =
        boxes.iter().flat_map(|aabb| aabb.low.iter().chain(&aabb.high)).fold(0.0_f32, |m, x| m.max(x.abs()));
    let scale = if largest > 0.0 { (-f64::from(largest).log2().ceil()).exp2() } else { 1.0 };
    let near = |corner: [f32; 3]| glam::Vec3::from(corner.map(|x| (f64::from(x) * scale) as f32)).into();
    let scaled: Vec<obvhs::aabb::Aabb> =
        boxes.iter().map(|aabb| obvhs::aabb::Aabb::new(near(aabb.low), near(aabb.high))).collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Low,
        &scaled,
        indices,
        SortPrecision::U64,
        2,
    );
    collapse(&mut tree, LEAF, BOX_COST);
    tree
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes on a scattered grid, some equal, some huge, some points.
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
        bvh.nodes[0].aabb.high[0] *= 0.5; // the sabotage
        let lost = boxes.iter().any(|query| {
            let candidates = found(|visit| bvh.for_each_overlapping(query, visit));
            (0..500).any(|i| boxes[i as usize].overlaps(query) && candidates.binary_search(&i).is_err())
        });
        assert!(lost);
    }
}
