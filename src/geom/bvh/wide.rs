//! The binary BVH collapsed to eight children per node: fewer steps, each a few SIMD tests, and under a
//! quarter of the memory traffic, which is the bottleneck on large meshes.

use glam::Vec4;

use super::Bvh;
use super::collapse::{Child, Plan};
use super::halfspaces::{HalfSpace, Sides};
use super::node::{Node, WIDTH};
use super::split::half_area;
use crate::geom::segment::Narrow;
use crate::geom::{Aabb, Light, Segment};

/// A wide BVH over the slots of a [`Bvh`], for queries along a segment.
#[derive(Clone, Debug)]
pub(crate) struct WideBvh {
    nodes: Vec<Node>,
    bounds: Aabb,
    /// Largest number of groups of children on the traversal stack.
    most_put_off: usize,
    /// Whether the coordinates are in the range of [`Narrow`].
    narrow: bool,
}

impl WideBvh {
    /// The wide form of a binary tree, built in one pass, and the indices of the boxes in the order of the
    /// leaves.
    pub(crate) fn of(tree: &Bvh) -> (Self, Vec<u32>) {
        let bounds = tree.bounds();
        let mut wide = Self { nodes: Vec::new(), bounds, most_put_off: 0, narrow: Narrow::fits(&bounds) };
        let mut order = Vec::with_capacity(tree.primitives.len());
        if tree.nodes.len() < 2 {
            return (wide, order);
        }
        let plan = Plan::of(tree);
        wide.nodes.push(Node::EMPTY);
        // Nodes of the binary tree still to be converted, each with its index in the wide tree and its depth.
        let mut open = vec![(0, 0, 1)];
        while let Some((at, place, depth)) = open.pop() {
            let (mut children, count) = plan.children(tree, at);
            let children = &mut children[..count];
            let boxed = |child: &Child| tree.nodes[child.at].aabb;
            children.sort_unstable_by(|a, b| {
                let area = |child| half_area(&boxed(child));
                a.is_leaf.cmp(&b.is_leaf).then_with(|| area(b).total_cmp(&area(a))).then(a.at.cmp(&b.at))
            });
            let inner = children.iter().filter(|child| !child.is_leaf).count();
            let (first_node, first_slot) = (wide.nodes.len(), order.len());
            let mut node = Node {
                children: (inner << 4 | count) as u8,
                first_node: first_node as u32,
                first_slot: first_slot as u32,
                ..Node::EMPTY
            };
            node.store(children.iter().map(boxed));
            for (leaf, child) in node.leaves.iter_mut().zip(&*children).skip(inner) {
                let slots = tree.slots_below(child.at);
                *leaf = ((order.len() - first_slot) << 3 | slots.len()) as u8; // at most LEAF per leaf
                order.extend_from_slice(&tree.primitives[slots]);
            }
            wide.nodes[place] = node;
            if first_node + inner > wide.nodes.capacity() {
                wide.nodes.reserve_exact(first_node / 4 + WIDTH);
            }
            wide.nodes.resize(first_node + inner, Node::EMPTY);
            open.extend((0..inner).rev().map(|lane| (children[lane].at, first_node + lane, depth + 1)));
            wide.most_put_off = wide.most_put_off.max(depth);
        }
        (wide, order)
    }

    /// Bounding box of all boxes; empty for an empty tree.
    pub(crate) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Visits every slot whose leaf box the segment from `p` to the light may meet, until `visit` stops the
    /// traversal.
    ///
    /// With `NEAREST`, the child that is entered first is visited first. This order pays only for the nearest
    /// face. For any face, visiting the largest child first takes as many steps, and each step is cheaper.
    #[inline(always)]
    pub(crate) fn walk<const NEAREST: bool>(
        &self,
        p: [f32; 3],
        light: &Light,
        visit: impl FnMut(usize) -> Step,
    ) {
        self.walk_to::<NEAREST>(p, light, None, visit);
    }

    /// As [`WideBvh::walk`], but no farther than a parameter of the segment from the start.
    #[inline(always)]
    pub(crate) fn walk_to<const NEAREST: bool>(
        &self,
        p: [f32; 3],
        light: &Light,
        end: Option<f64>,
        visit: impl FnMut(usize) -> Step,
    ) {
        fn ending(mut way: impl Enter, end: Option<f64>) -> impl Enter {
            if let Some(end) = end {
                way.shorten(end);
            }
            way
        }
        match Narrow::to_light(p, light).filter(|_| self.narrow) {
            Some(narrow) if self.most_put_off < SHORT => {
                self.walk_by::<NEAREST>(&mut ending(narrow, end), &mut [(0, 0); SHORT], visit);
            }
            Some(narrow) => self.walk_far(ending(narrow, end), visit),
            None => self.walk_far(ending(Segment::to_light(p, light), end), visit),
        }
    }

    /// As [`WideBvh::walk`], for every segment that begins within `slack` of `p` in each coordinate. A slack
    /// of at least two units in the last place of `p`'s largest coordinate also covers the rounding of the
    /// boxes that it widens: where the planes of a box are so far away that they absorb it, it is less than
    /// an eighth of what the test allows for rounding.
    pub(crate) fn walk_loosely(
        &self,
        p: [f32; 3],
        slack: f32,
        light: &Light,
        visit: impl FnMut(usize) -> Step,
    ) {
        match Narrow::to_light(p, light).filter(|_| self.narrow && slack < 1e15) {
            Some(way) if self.most_put_off < SHORT => {
                self.walk_by::<false>(&mut Loose { way, slack }, &mut [(0, 0); SHORT], visit);
            }
            Some(way) => self.walk_far(Loose { way, slack }, visit),
            None => self.walk_far(Loose { way: Segment::to_light(p, light), slack }, visit),
        }
    }

    /// Approximate point where the segment from `p` to the light enters the bounding box; `None` only if the
    /// segment misses the box.
    #[inline]
    pub(crate) fn entry(&self, p: [f32; 3], light: &Light) -> Option<[f32; 3]> {
        match Narrow::to_light(p, light) {
            Some(narrow) if self.narrow => narrow.entry(&self.bounds),
            _ => Some(p),
        }
    }

    /// Bounds |x − p|, axis by axis, for every plane x of every box of the tree. A stored plane lies at most
    /// one grid step outside: 1/63 of the extent, or two units in the last place of the largest coordinate.
    #[inline]
    pub(crate) fn reach(&self, p: [f32; 3]) -> [f64; 3] {
        let Aabb { low, high } = self.bounds;
        std::array::from_fn(|i| {
            let [low, high, p] = [low[i], high[i], p[i]].map(f64::from);
            let step = ((high - low) / 63.0).max(low.abs().max(high.abs()) * 2f64.powi(-21));
            (high - p).max(p - low).max(0.0) + step + f64::from(f32::MIN_POSITIVE)
        })
    }

    /// Visits every slot whose leaf box may have a point in all of the half-spaces, which are given around
    /// `p`; at most [`super::MOST_SIDES`] of them. `reach` is that of `p`.
    #[inline(always)]
    pub(crate) fn walk_within(
        &self,
        p: [f32; 3],
        reach: [f64; 3],
        spaces: &[HalfSpace],
        mut visit: impl FnMut(usize),
    ) {
        if !spaces.iter().all(|space| space.may_meet(&self.bounds, p, reach)) {
            return;
        }
        let visit = |slot| {
            visit(slot);
            Step::On
        };
        let within = |x: &f32| x.abs() < (1_u64 << 60) as f32;
        if self.narrow && p.iter().all(within) && self.most_put_off < SHORT {
            let mut sides = Sides::new(p, spaces, reach, 2f64.powi(-24)).narrow();
            self.walk_by::<false>(&mut sides, &mut [(0, 0); SHORT], visit);
        } else {
            self.walk_far(Sides::new(p, spaces, reach, 2f64.powi(-53)), visit);
        }
    }

    #[cold]
    #[inline(never)]
    fn walk_far(&self, mut way: impl Enter, visit: impl FnMut(usize) -> Step) {
        self.walk_by::<true>(&mut way, &mut vec![(0, 0); self.most_put_off + 1], visit);
    }

    #[inline(always)]
    fn walk_by<const NEAREST: bool>(
        &self,
        way: &mut impl Enter,
        put_off: &mut [(u32, u32)],
        mut visit: impl FnMut(usize) -> Step,
    ) {
        let mut waiting = 0;
        let Some(mut node) = self.nodes.first() else { return };
        loop {
            let (at, hits) = way.entries(node);
            let inner = node.inner();
            let mut leaves = hits & !inner;
            while leaves != 0 {
                let leaf = u32::from(node.leaves[leaves.trailing_zeros() as usize % WIDTH]);
                leaves &= leaves - 1;
                let first = node.first_slot + (leaf >> 3);
                for slot in first..first + (leaf & 7) {
                    match visit(slot as usize) {
                        Step::On => {}
                        Step::NoFarther(t) => way.shorten(t),
                        Step::Stop => return,
                    }
                }
            }
            let (mut first, mut nodes) = (node.first_node, hits & inner);
            if nodes == 0 {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                (first, nodes) = put_off[waiting];
            }
            let mut lane = nodes.trailing_zeros();
            if NEAREST && hits & inner != 0 {
                let mut rest = nodes & (nodes - 1);
                while rest != 0 {
                    let next = rest.trailing_zeros();
                    rest &= rest - 1;
                    if at[next as usize % WIDTH] < at[lane as usize % WIDTH] {
                        lane = next;
                    }
                }
            }
            let others = nodes & !(1 << lane);
            if others != 0 {
                put_off[waiting] = (first, others);
                waiting += 1;
            }
            node = &self.nodes[(first + lane) as usize];
        }
    }
}

/// Stack entries that are allocated at no cost; most trees need no more.
const SHORT: usize = 32;

/// Next step of a traversal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    On,
    /// Continue, but only up to this parameter of the segment.
    NoFarther(f64),
    Stop,
}

/// Interface of a segment, or of another region, to the traversal.
pub(super) trait Enter {
    /// Rounded parameters at which the children's boxes are entered, and one bit per child that the segment
    /// may meet.
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32);

    /// Ends the segment at `t`.
    fn shorten(&mut self, t: f64);
}

impl Enter for Narrow {
    #[inline(always)]
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32) {
        let ([a, b], hits) = self.entries(|plane| node.plane(plane));
        let at = [a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w];
        (at, hits & node.children())
    }

    #[inline(always)]
    fn shorten(&mut self, t: f64) {
        self.shorten(t);
    }
}

/// For coordinates outside the range of [`Narrow`].
impl Enter for Segment {
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32) {
        let (mut at, mut hits) = ([0.0; WIDTH], 0);
        for lane in 0..WIDTH {
            if let Some(entry) = self.entry(&node.aabb(lane)) {
                at[lane] = (entry as f32).min(f32::MAX);
                hits |= 1 << lane;
            }
        }
        (at, hits & node.children())
    }

    fn shorten(&mut self, t: f64) {
        *self = self.until(t);
    }
}

/// A segment with boxes widened on all sides.
struct Loose<E> {
    way: E,
    slack: f32,
}

impl Enter for Loose<Narrow> {
    #[inline(always)]
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32) {
        let slack = Vec4::splat(self.slack);
        let ([a, b], hits) = self.way.entries(|plane| {
            let [a, b] = node.plane(plane);
            if plane % 2 == 0 { [a - slack, b - slack] } else { [a + slack, b + slack] }
        });
        ([a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w], hits & node.children())
    }

    fn shorten(&mut self, t: f64) {
        self.way.shorten(t);
    }
}

impl Enter for Loose<Segment> {
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32) {
        let (mut at, mut hits) = ([0.0; WIDTH], 0);
        for lane in 0..WIDTH {
            let Aabb { low, high } = node.aabb(lane);
            let low = low.map(|x| (x - self.slack).next_down().max(f32::MIN));
            let high = high.map(|x| (x + self.slack).next_up().min(f32::MAX));
            if let Some(entry) = self.way.entry(&Aabb { low, high }) {
                at[lane] = (entry as f32).min(f32::MAX);
                hits |= 1 << lane;
            }
        }
        (at, hits & node.children())
    }

    fn shorten(&mut self, t: f64) {
        self.way = self.way.until(t);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    impl WideBvh {
        /// Fault for the tests of other modules: boxes rounded inwards.
        pub(crate) fn round_inwards(&mut self) {
            for node in &mut self.nodes {
                node.bounds[0] = node.bounds[0].map(|steps| steps.saturating_add(1));
                node.bounds[3] = node.bounds[3].map(|steps| steps.saturating_sub(1));
            }
        }
    }

    fn boxes(n: usize, scale: f32) -> Vec<Aabb> {
        let mut random = SplitMix64(9);
        let mut next = |most: f64| (random.unit() * most) as f32 * scale;
        (0..n)
            .map(|i| {
                let low = [next(1.0), next(1.0), next(1.0)];
                let size = if i % 7 == 0 { 0.0 } else { next(0.1) };
                Aabb { low, high: low.map(|x| x + size) }
            })
            .collect()
    }

    /// Number of boxes that a segment meets but a traversal does not visit, over many segments. No box may be
    /// visited twice.
    fn lost(boxes: &[Aabb], scale: f32, fault: impl Fn(&mut WideBvh)) -> usize {
        let (mut wide, order) = Bvh::build(boxes).into_wide();
        fault(&mut wide);
        let mut lost = 0;
        for query in boxes.iter().step_by(boxes.len() / 100 + 1) {
            let up = query.low.map(|x| 2.0 * x + scale);
            for light in [Light::point([0.5 * scale; 3]), Light::directional(up), Light::point(query.high)] {
                let (light, p) = (light.unwrap(), query.low);
                let mut seen = vec![0; boxes.len()];
                wide.walk::<false>(p, &light, |slot| {
                    seen[order[slot] as usize] += 1;
                    Step::On
                });
                wide.walk::<true>(p, &light, |slot| {
                    seen[order[slot] as usize] += 16;
                    Step::On
                });
                assert!(seen.iter().all(|seen| [0, 17].contains(seen)));
                let segment = Segment::to_light(p, &light);
                lost += boxes
                    .iter()
                    .zip(&seen)
                    .filter(|&(aabb, &seen)| seen == 0 && segment.may_meet(aabb))
                    .count();
            }
        }
        lost
    }

    #[test]
    fn bvh_wide_visits_what_a_loop_over_all_boxes_finds() {
        for n in [1, 2, 3, 5, 40, 3000] {
            for scale in [1.0, 1e-44, 1e-30, 1e30, 1e38] {
                let boxes = boxes(n, scale);
                assert_eq!(lost(&boxes, scale, |_| {}), 0, "{n} {scale}");
            }
        }
        assert!(Bvh::build(&[]).into_wide().0.nodes.is_empty());
    }

    #[test]
    fn bvh_wide_of_nested_boxes_is_complete() {
        let nested: Vec<Aabb> = (0..4000)
            .map(|i| Aabb { low: [0.0; 3], high: [2.0_f32.powi(i % 80 - 40) * (1.0 + i as f32 / 4000.0); 3] })
            .collect();
        assert_eq!(lost(&nested, 1.0, |_| {}), 0);
        // The same with the stack on the heap, as for very deep trees.
        assert_eq!(lost(&nested, 1.0, |wide| wide.most_put_off = SHORT), 0);
    }

    #[test]
    fn bvh_wide_never_puts_off_more_than_it_says() {
        for boxes in [boxes(3000, 1.0), vec![Aabb { low: [1.0; 3], high: [1.0; 3] }; 3000]] {
            let (wide, _) = Bvh::build(&boxes).into_wide();
            let depth = |most: &mut Vec<usize>| {
                for (at, node) in wide.nodes.iter().enumerate() {
                    for lane in 0..node.inner().count_ones() as usize {
                        most[node.first_node as usize + lane] = most[at] + 1;
                    }
                }
                most.iter().copied().max()
            };
            assert_eq!(depth(&mut vec![1; wide.nodes.len()]), Some(wide.most_put_off));
            assert!(wide.nodes.len() * WIDTH < 2 * boxes.len(), "{} nodes", wide.nodes.len());
        }
    }

    #[test]
    fn bvh_wide_faults_would_be_seen() {
        let boxes = boxes(3000, 1.0);
        let all = |fault: fn(&mut Node)| lost(&boxes, 1.0, |wide| wide.nodes.iter_mut().for_each(fault));
        // Boxes rounded inwards, on either side.
        assert!(all(|node| node.bounds[0] = node.bounds[0].map(|steps| steps.saturating_add(1))) > 0);
        assert!(all(|node| node.bounds[3] = node.bounds[3].map(|steps| steps.saturating_sub(1))) > 0);
        // A child or a slot dropped.
        assert!(all(|node| node.children -= u8::from(node.children & 15 == WIDTH as u8)) > 0);
        assert!(all(|node| node.leaves[7] &= !2) > 0);
    }
}
