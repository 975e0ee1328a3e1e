//! The same tree with several children a node: fewer, wider steps, each of them one vector test.
//!
//! Half the levels are dropped by taking the place of the child with the largest surface by its own children
//! (Wald, Benthin and Boulos, *Getting Rid of Packets*, 2008). A node is two cache lines.

use super::{Bvh, half_area};
use crate::geom::segment::Narrow;
use crate::geom::{Aabb, Light, Segment};

/// Children of a node.
pub(crate) const WIDTH: usize = 4;

/// A tree over the slots of a [`Bvh`] for queries along a segment.
#[derive(Clone, Debug)]
pub(crate) struct WideBvh {
    nodes: Vec<Node>,
    bounds: Aabb,
    /// How many nodes a walk puts off at most.
    most_put_off: usize,
    /// Whether its numbers are in the range of [`Narrow`].
    narrow: bool,
}

/// The boxes of the children, axis by axis, and what is in them.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    /// Low x, high x, low y, high y, low z, high z. Where there is no child: a box that nothing meets.
    pub(crate) bounds: [[f32; WIDTH]; 6],
    /// The child's place, or the first slot of a leaf.
    children: [u32; WIDTH],
    /// How many slots a leaf has; 0 for a node.
    counts: [u8; WIDTH],
}

impl Node {
    const EMPTY: Self = Self {
        bounds: {
            let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
            [low, high, low, high, low, high]
        },
        children: [0; WIDTH],
        counts: [0; WIDTH],
    };

    fn aabb(&self, lane: usize) -> Aabb {
        let [x, y, z] = [0, 2, 4];
        let at = |i: usize| self.bounds[i][lane];
        Aabb { low: [at(x), at(y), at(z)], high: [at(x + 1), at(y + 1), at(z + 1)] }
    }
}

impl WideBvh {
    /// Of a binary tree, in one pass.
    pub(crate) fn of(tree: &Bvh) -> Self {
        let bounds = tree.bounds();
        let mut wide = Self { nodes: Vec::new(), bounds, most_put_off: 0, narrow: Narrow::fits(&bounds) };
        if tree.nodes.len() < 2 {
            return wide;
        }
        wide.nodes.reserve_exact(tree.nodes.len() / 4);
        let is_leaf = |at: usize| tree.nodes[at].skip as usize == at + 1;
        // A node of the binary tree that is still to be taken over, where its place is to be written, and its depth.
        let mut open = vec![(0, None::<(usize, usize)>, 1_usize)];
        while let Some((at, parent, depth)) = open.pop() {
            let mut members = [at; WIDTH];
            let mut count = 1;
            while count < WIDTH {
                let largest = (0..count)
                    .filter(|&i| !is_leaf(members[i]))
                    .map(|i| (half_area(&tree.nodes[members[i]].aabb), i))
                    .reduce(|most, next| if next.0 > most.0 { next } else { most });
                let Some((_, chosen)) = largest else { break };
                let left = members[chosen] + 1;
                members[chosen] = left;
                members[count] = tree.nodes[left].skip as usize;
                count += 1;
            }
            let place = wide.nodes.len();
            if let Some((node, lane)) = parent {
                wide.nodes[node].children[lane] = place as u32;
            }
            let mut node = Node::EMPTY;
            for (lane, &member) in members[..count].iter().enumerate() {
                let Aabb { low, high } = tree.nodes[member].aabb;
                for axis in 0..3 {
                    node.bounds[2 * axis][lane] = low[axis];
                    node.bounds[2 * axis + 1][lane] = high[axis];
                }
                if is_leaf(member) {
                    let first = tree.nodes[member].first;
                    node.children[lane] = first;
                    node.counts[lane] = (tree.nodes[member + 1].first - first) as u8; // at most LEAF
                } else {
                    open.push((member, Some((place, lane)), depth + 1));
                }
            }
            if wide.nodes.len() == wide.nodes.capacity() {
                wide.nodes.reserve_exact(wide.nodes.len() / 4 + 1);
            }
            wide.nodes.push(node);
            wide.most_put_off = wide.most_put_off.max(depth * (WIDTH - 1));
        }
        wide
    }

    /// The box around everything; empty for an empty tree.
    pub(crate) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Visits every slot whose leaf box the way to a light may meet, as far as `visit` wants to go.
    #[inline(always)]
    pub(crate) fn walk(&self, p: [f32; 3], light: &Light, visit: impl FnMut(usize) -> Step) {
        match Narrow::to_light(p, light).filter(|_| self.narrow) {
            Some(mut narrow) if self.most_put_off < SHORT => {
                self.walk_by(&mut narrow, &mut [0; SHORT], visit);
            }
            Some(narrow) => self.walk_far(narrow, visit),
            None => self.walk_far(Segment::to_light(p, light), visit),
        }
    }

    /// Where the way to a light enters the box around everything, roughly; `None` only if it does not meet it.
    #[inline]
    pub(crate) fn entry(&self, p: [f32; 3], light: &Light) -> Option<[f32; 3]> {
        match Narrow::to_light(p, light) {
            Some(narrow) if self.narrow => narrow.entry(&self.bounds),
            _ => Some(p),
        }
    }

    #[cold]
    #[inline(never)]
    fn walk_far(&self, mut way: impl Enter, visit: impl FnMut(usize) -> Step) {
        self.walk_by(&mut way, &mut vec![0; self.most_put_off + 1], visit);
    }

    #[inline(always)]
    fn walk_by(&self, way: &mut impl Enter, put_off: &mut [u32], mut visit: impl FnMut(usize) -> Step) {
        let mut waiting = 0;
        let Some(mut node) = self.nodes.first() else { return };
        loop {
            let (at, mut hits) = way.entries(node);
            let (mut next, mut nearest) = (u32::MAX, f32::INFINITY);
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize % WIDTH;
                hits &= hits - 1;
                let child = node.children[lane];
                let count = node.counts[lane];
                if count > 0 {
                    for slot in child..child + u32::from(count) {
                        match visit(slot as usize) {
                            Step::On => {}
                            Step::NoFarther(t) => way.shorten(t),
                            Step::Stop => return,
                        }
                    }
                    continue;
                }
                let mut later = child;
                if at[lane] < nearest {
                    nearest = at[lane];
                    (next, later) = (child, next);
                }
                if later != u32::MAX {
                    put_off[waiting] = later;
                    waiting += 1;
                }
            }
            if next == u32::MAX {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                next = put_off[waiting];
            }
            node = &self.nodes[next as usize];
        }
    }
}

/// Room for so many nodes costs nothing to make; most trees need no more.
const SHORT: usize = 64;

/// How a walk goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    On,
    /// As far as this parameter of the way.
    NoFarther(f64),
    Stop,
}

/// What a walk asks of the way.
trait Enter {
    /// Where the children's boxes are entered, rounded, and a bit for each child that may be met.
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32);

    /// Ends at `t`.
    fn shorten(&mut self, t: f64);
}

impl Enter for Narrow {
    #[inline(always)]
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32) {
        self.entries(&node.bounds)
    }

    #[inline(always)]
    fn shorten(&mut self, t: f64) {
        self.shorten(t);
    }
}

/// Where numbers leave the range of [`Narrow`].
impl Enter for Segment {
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32) {
        let (mut at, mut hits) = ([0.0; WIDTH], 0);
        for lane in 0..WIDTH {
            let aabb = node.aabb(lane);
            if let Some(entry) = self.entry(&aabb).filter(|_| !aabb.is_empty()) {
                at[lane] = (entry as f32).min(f32::MAX);
                hits |= 1 << lane;
            }
        }
        (at, hits)
    }

    fn shorten(&mut self, t: f64) {
        *self = self.until(t);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

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

    /// How many boxes that a way meets are not visited, over many ways; none may be visited twice.
    fn lost(boxes: &[Aabb], scale: f32, fault: impl Fn(&mut WideBvh)) -> usize {
        let tree = Bvh::build(boxes);
        let mut wide = WideBvh::of(&tree);
        fault(&mut wide);
        let mut lost = 0;
        for query in boxes.iter().step_by(boxes.len() / 100 + 1) {
            let up = query.low.map(|x| 2.0 * x + scale);
            for light in [Light::point([0.5 * scale; 3]), Light::directional(up), Light::point(query.high)] {
                let (light, p) = (light.unwrap(), query.low);
                let mut seen = vec![false; boxes.len()];
                wide.walk(p, &light, |slot| {
                    assert!(!std::mem::replace(&mut seen[tree.order()[slot] as usize], true));
                    Step::On
                });
                let segment = Segment::to_light(p, &light);
                lost +=
                    boxes.iter().zip(&seen).filter(|&(aabb, &seen)| !seen && segment.may_meet(aabb)).count();
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
        assert!(WideBvh::of(&Bvh::build(&[])).nodes.is_empty());
    }

    #[test]
    fn bvh_wide_of_nested_boxes_is_complete() {
        // So deep that what is put off does not fit where it mostly does.
        let nested: Vec<Aabb> = (0..4000)
            .map(|i| Aabb { low: [0.0; 3], high: [2.0_f32.powi(i % 80 - 40) * (1.0 + i as f32 / 4000.0); 3] })
            .collect();
        assert!(WideBvh::of(&Bvh::build(&nested)).most_put_off >= SHORT);
        assert_eq!(lost(&nested, 1.0, |_| {}), 0);
    }

    #[test]
    fn bvh_wide_faults_would_be_seen() {
        let boxes = boxes(3000, 1.0);
        let root = |wide: &mut WideBvh, fault: fn(&mut Node)| fault(&mut wide.nodes[0]);
        assert!(lost(&boxes, 1.0, |wide| root(wide, |node| node.bounds[1][0] *= 0.75)) > 0);
        assert!(lost(&boxes, 1.0, |wide| root(wide, |node| node.bounds[0][1] = f32::INFINITY)) > 0);
        assert!(
            lost(&boxes, 1.0, |wide| wide
                .nodes
                .iter_mut()
                .for_each(|node| node.counts[0] = node.counts[0].min(1)))
                > 0
        );
    }
}
