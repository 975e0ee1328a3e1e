//! All overlapping pairs in a list of boxes: broad-phase collision detection by traversing a BVH against
//! itself.
//!
//! The boxes are split at the median of their centers along the longest axis until at most eight remain. So
//! the tree is complete: its depth is log₂ of the number of boxes for every input, and nodes need no links.
//! Two nodes whose boxes overlap are descended together (Stefan Gottschalk, Ming C. Lin and Dinesh Manocha,
//! *OBBTree: A Hierarchical Structure for Rapid Interference Detection*, 1996, section 5), which reports each
//! pair once.
//!
//! Boxes may belong to sets whose pairs are known already; two nodes within one set are not descended.

mod frame;
mod points;

use std::ops::ControlFlow;

use self::frame::Frame;
pub(crate) use self::points::PointQueries;
use super::Aabb;
use crate::parallel;

/// Boxes per leaf: eight comparisons are a few SIMD instructions.
const LEAF: usize = 8;
/// Levels of the tree below a task's node: a task covers some thousand boxes.
const TASK_LEVELS: u32 = 7;
/// Number of tasks above which tasks are not divided further.
const MOST_TASKS: usize = 1 << 18;
/// Boxes per part that one thread splits down to the leaves, so that the part stays in the cache.
const CHUNK: usize = 4096;

/// A complete binary BVH.
#[derive(Debug)]
pub(crate) struct Overlaps {
    /// Boxes of the nodes: the root is node 1, and the children of node i are 2i and 2i + 1.
    nodes: Vec<Aabb>,
    leaves: Vec<Leaf>,
    order: Vec<u32>,
    /// The set of each box in the order of the leaves, and the set of each node; empty if there are no sets.
    sets: Vec<u32>,
    node_sets: Vec<u32>,
    /// Oriented boxes of the nodes, from [`FRAMES_FROM`] on; empty until they are asked for.
    frames: Vec<Frame>,
}

/// The set of a box that is in none, or of a node whose boxes are not in one.
pub(crate) const NO_SET: u32 = u32::MAX;

/// The first node with an oriented box: there are few nodes above, and each takes a look at everything.
const FRAMES_FROM: usize = 64;

/// Two nodes of one level whose boxes are to be compared; the same node twice for the pairs within that node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Task(u32, u32);

#[derive(Clone, Copy, Debug)]
struct Leaf {
    low: [[f32; LEAF]; 3],
    high: [[f32; LEAF]; 3],
}

impl Leaf {
    /// Boxes that overlap nothing.
    const EMPTY: Self = Self { low: [[f32::INFINITY; LEAF]; 3], high: [[f32::NEG_INFINITY; LEAF]; 3] };

    /// One bit per box of the leaf: whether the box overlaps `aabb`.
    #[inline(always)]
    fn overlapping(&self, aabb: &Aabb) -> u32 {
        let mut hit = [1_u32; LEAF];
        for axis in 0..3 {
            for ((hit, low), high) in hit.iter_mut().zip(&self.low[axis]).zip(&self.high[axis]) {
                *hit &= u32::from(*low <= aabb.high[axis]) & u32::from(aabb.low[axis] <= *high);
            }
        }
        hit.iter().enumerate().fold(0, |bits, (i, hit)| bits | hit << i)
    }

    fn get(&self, i: usize) -> Aabb {
        Aabb { low: [0, 1, 2].map(|axis| self.low[axis][i]), high: [0, 1, 2].map(|axis| self.high[axis][i]) }
    }
}

/// Center and index of a box while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    middle: [f32; 3],
    index: u32,
}

impl Overlaps {
    /// Builds the tree. About 100 ns per box. Memory: 34 to 64 bytes per box, and 16 more during the build.
    ///
    /// # Panics
    ///
    /// Panics if there are 2³¹ boxes or more.
    pub(crate) fn of(boxes: &[Aabb]) -> Self {
        assert!(boxes.len() < 1 << 31, "{} boxes; a tree holds less than 2^31", boxes.len());
        // Halves are added, since the sum could overflow.
        let middle = |aabb: &Aabb| [0, 1, 2].map(|i| 0.5 * aabb.low[i] + 0.5 * aabb.high[i]);
        let mut items: Vec<Item> =
            boxes.iter().zip(0..).map(|(aabb, index)| Item { middle: middle(aabb), index }).collect();
        let width = boxes.len().div_ceil(LEAF).next_power_of_two();
        let mut part = LEAF * width;
        while part > CHUNK {
            parallel::rows(&mut items, part, |_, items| halve(items, part));
            part /= 2;
        }
        parallel::rows(&mut items, part, |_, items| {
            let mut part = part;
            while part > LEAF {
                items.chunks_mut(part).for_each(|items| halve(items, part));
                part /= 2;
            }
        });
        let mut nodes = vec![Aabb::EMPTY; 2 * width];
        let mut leaves = vec![Leaf::EMPTY; width];
        for ((items, leaf), node) in items.chunks(LEAF).zip(&mut leaves).zip(&mut nodes[width..]) {
            for (i, item) in items.iter().enumerate() {
                let aabb = &boxes[item.index as usize];
                for axis in 0..3 {
                    (leaf.low[axis][i], leaf.high[axis][i]) = (aabb.low[axis], aabb.high[axis]);
                }
                *node = node.join(aabb);
            }
        }
        for i in (1..width).rev() {
            nodes[i] = nodes[2 * i].join(&nodes[2 * i + 1]);
        }
        let order = items.iter().map(|item| item.index).collect();
        let (sets, node_sets, frames) = (Vec::new(), Vec::new(), Vec::new());
        Self { nodes, leaves, order, sets, node_sets, frames }
    }

    /// The same tree without the pairs within a set. `sets` has an entry for each box, which may be
    /// [`NO_SET`].
    pub(crate) fn without_pairs_within(mut self, sets: &[u32]) -> Self {
        let width = self.leaves.len();
        self.sets = self.order.iter().map(|&index| sets[index as usize]).collect();
        self.node_sets = vec![NO_SET; 2 * width];
        let one = |sets: &[u32]| if sets.iter().all(|&set| set == sets[0]) { sets[0] } else { NO_SET };
        for (node, sets) in self.node_sets[width..].iter_mut().zip(self.sets.chunks(LEAF)) {
            *node = one(sets);
        }
        // A leaf without boxes overlaps nothing, so that its set does not matter.
        let full = self.sets.len().div_ceil(LEAF).max(1);
        let last = self.node_sets[width + full - 1];
        self.node_sets[width + full..].fill(last);
        for i in (1..width).rev() {
            self.node_sets[i] = one(&self.node_sets[2 * i..2 * i + 2]);
        }
        self
    }

    /// Adds oriented boxes, around the `points` of each box (by its position in [`Overlaps::order`]). Then
    /// fewer nodes are descended where long thin things lie aslant. About a microsecond per box; 30 bytes per
    /// box.
    pub(crate) fn add_frames<const N: usize>(&mut self, points: impl Fn(usize) -> [[f32; 3]; N] + Sync) {
        let width = self.leaves.len();
        let mut frames = vec![Frame::around(std::iter::empty()); (2 * width).saturating_sub(FRAMES_FROM)];
        let boxes = self.order.len();
        parallel::rows(&mut frames, 1, |i, frame| {
            let node = i + FRAMES_FROM;
            let level = 1 << node.ilog2();
            let count = LEAF * (width / level);
            let from = (node - level) * count;
            frame[0] = Frame::around((from..(from + count).min(boxes)).flat_map(&points));
        });
        self.frames = frames;
    }

    /// Whether [`Overlaps::add_frames`] was called.
    pub(crate) fn has_frames(&self) -> bool {
        !self.frames.is_empty()
    }

    /// Whether two nodes whose boxes overlap need not be compared.
    #[inline]
    fn settled(&self, a: usize, b: usize) -> bool {
        if !self.node_sets.is_empty() && self.node_sets[a] != NO_SET && self.node_sets[a] == self.node_sets[b]
        {
            return true;
        }
        let frames = a.checked_sub(FRAMES_FROM).zip(b.checked_sub(FRAMES_FROM)).filter(|_| a != b);
        frames.is_some_and(|(a, b)| match (self.frames.get(a), self.frames.get(b)) {
            (Some(a), Some(b)) => a.apart(b),
            _ => false,
        })
    }

    /// Indices of the boxes in the order of the leaves: boxes that are close in this order are close in
    /// space.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// The search as independent tasks; each pair belongs to exactly one task. The order of the tasks, and of
    /// the pairs within each task, depends only on the boxes.
    pub(crate) fn tasks(&self) -> Vec<Task> {
        let mut tasks = vec![Task(1, 1)];
        for _ in TASK_LEVELS..self.leaves.len().ilog2() {
            if tasks.len() > MOST_TASKS {
                break; // most boxes overlap most others: the list would get too long
            }
            let mut finer = Vec::new();
            tasks.iter().for_each(|&task| self.within(task, |task| finer.push(task)));
            tasks = finer;
        }
        tasks
    }

    /// Calls `visit` with the pairs of child nodes that may contain overlapping boxes.
    #[inline(always)]
    fn within(&self, Task(a, b): Task, mut visit: impl FnMut(Task)) {
        for i in 0..2 {
            for j in if a == b { i } else { 0 }..2 {
                let (a, b) = (2 * a + i, 2 * b + j);
                let [i, j] = [a as usize, b as usize];
                if self.nodes[i].overlaps(&self.nodes[j]) && !self.settled(i, j) {
                    visit(Task(a, b));
                }
            }
        }
    }

    #[inline]
    fn within_a_set(&self, [i, j]: [usize; 2]) -> bool {
        !self.sets.is_empty() && self.sets[i] != NO_SET && self.sets[i] == self.sets[j]
    }

    /// Calls `visit` with the positions in [`Overlaps::order`] of every two boxes of a task that overlap,
    /// until `visit` breaks. Also calls `visit` with `None` for every pair of nodes visited, so that a caller
    /// can limit work that finds nothing.
    pub(crate) fn for_each_pair(
        &self,
        task: Task,
        mut visit: impl FnMut(Option<[usize; 2]>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let width = self.leaves.len();
        let mut open = vec![task];
        while let Some(Task(a, b)) = open.pop() {
            visit(None)?;
            if (a as usize) < width {
                self.within(Task(a, b), |task| open.push(task));
                continue;
            }
            let [a, b] = [a, b].map(|node| node as usize - width);
            let [one, other] = [a, b].map(|leaf| &self.leaves[leaf]);
            let within = &self.nodes[width + b];
            for i in 0..LEAF {
                let aabb = one.get(i);
                if !aabb.overlaps(within) {
                    continue;
                }
                let mut hits = other.overlapping(&aabb);
                if a == b {
                    hits &= !1 << i; // each pair once, and no box with itself
                }
                while hits != 0 {
                    let pair = [LEAF * a + i, LEAF * b + hits.trailing_zeros() as usize];
                    hits &= hits - 1;
                    if !self.within_a_set(pair) {
                        visit(Some(pair))?;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// Partitions a part with room for `part` items along its longest axis: the `part` / 2 items with the
/// smallest centers come first, even if the part is not full.
fn halve(items: &mut [Item], part: usize) {
    if items.len() <= part / 2 {
        return;
    }
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for item in items.iter() {
        for axis in 0..3 {
            low[axis] = low[axis].min(item.middle[axis]);
            high[axis] = high[axis].max(item.middle[axis]);
        }
    }
    let extent = |axis: usize| f64::from(high[axis]) - f64::from(low[axis]);
    let axis = (1..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best });
    // Equal centers are ordered by index, so that the same boxes always give the same tree.
    let before = |a: &Item, b: &Item| a.middle[axis].total_cmp(&b.middle[axis]).then(a.index.cmp(&b.index));
    items.select_nth_unstable_by(part / 2, before);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn found(tree: &Overlaps) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for task in tree.tasks() {
            let _ = tree.for_each_pair(task, |places| {
                let Some(places) = places else { return ControlFlow::Continue(()) };
                let [i, j] = places.map(|place| tree.order()[place]);
                pairs.push([i.min(j), i.max(j)]);
                ControlFlow::Continue(())
            });
        }
        pairs.sort_unstable();
        pairs
    }

    fn naive(boxes: &[Aabb]) -> Vec<[u32; 2]> {
        let pairs = (0..boxes.len()).flat_map(|i| (i + 1..boxes.len()).map(move |j| [i, j]));
        pairs.filter(|&[i, j]| boxes[i].overlaps(&boxes[j])).map(|pair| pair.map(|i| i as u32)).collect()
    }

    /// Scattered boxes: some are equal, some are points, some cover everything.
    fn boxes(count: usize, scale: f32) -> Vec<Aabb> {
        let mut random = SplitMix64(count as u64);
        let mut whole = |most: usize| random.below(most) as f32;
        (0..count)
            .map(|i| {
                let low = [(); 3].map(|()| whole(64) * scale);
                let size = if i % 50 == 7 { 64.0 } else { whole(4) };
                Aabb { low, high: low.map(|x| x + size * scale) }
            })
            .collect()
    }

    #[test]
    fn overlaps_are_those_of_a_loop_over_all_pairs() {
        for (count, scale) in
            [(0, 1.0), (1, 1.0), (8, 1.0), (9, 1.0), (64, 1e-45), (500, 1e36), (3000, 1.0), (10_000, 1.0)]
        {
            let mut boxes = boxes(count, scale);
            if count < 9000 {
                assert_eq!(found(&Overlaps::of(&boxes)), naive(&boxes), "{count} boxes");
            } else {
                // Enough boxes for several tasks.
                boxes.iter_mut().for_each(|aabb| aabb.high = aabb.low);
                let tree = Overlaps::of(&boxes);
                assert!(tree.tasks().len() > 4);
                assert_eq!(found(&tree), naive(&boxes));
            }
        }
    }

    #[test]
    fn overlaps_of_equal_boxes_are_all_pairs() {
        let boxes = vec![Aabb { low: [1.0; 3], high: [2.0; 3] }; 300];
        assert_eq!(found(&Overlaps::of(&boxes)).len(), 300 * 299 / 2);
    }

    #[test]
    fn overlaps_in_a_tree_with_a_bound_that_is_too_small_are_lost() {
        let boxes = boxes(500, 1.0);
        let mut tree = Overlaps::of(&boxes);
        tree.nodes[2].high = tree.nodes[2].low; // fault injected
        assert_ne!(found(&tree), naive(&boxes));
    }

    #[test]
    fn overlaps_count_work_that_finds_nothing() {
        // Thin rods along all axes: almost none overlap, but almost all boxes around eight rods do.
        let mut random = SplitMix64(5);
        let mut unit = || random.below(1 << 20) as f32 / (1 << 20) as f32;
        let boxes: Vec<Aabb> = (0..4096)
            .map(|i| {
                let low = [(); 3].map(|()| unit());
                let mut high = low.map(|x| x + 1e-7);
                high[i % 3] += 1.0;
                Aabb { low, high }
            })
            .collect();
        let tree = Overlaps::of(&boxes);
        let (mut looks, mut pairs) = (0, 0);
        for task in tree.tasks() {
            let _ = tree.for_each_pair(task, |places| {
                *if places.is_some() { &mut pairs } else { &mut looks } += 1;
                ControlFlow::Continue(())
            });
        }
        assert!(looks > 50_000 && pairs < 100, "{looks} looks, {pairs} pairs");
    }

    /// Needles at random angles: pairs that share an end, of which no search may lose one.
    fn needles() -> (Vec<[[f32; 3]; 2]>, Vec<[u32; 2]>) {
        let mut random = SplitMix64(11);
        let mut whole = || random.below(1 << 12) as f32 / 64.0 + 1000.0;
        let ends: Vec<[f32; 3]> = (0..1500).map(|_| [whole(), whole(), whole()]).collect();
        let needles: Vec<[[f32; 3]; 2]> =
            (0..3000).map(|i| [ends[i % 1500], ends[(7 * i + i / 1500) % 1500]]).collect();
        let shares = |i: usize, j: usize| needles[i].iter().any(|end| needles[j].contains(end));
        let pairs = (0..needles.len()).flat_map(|i| (i + 1..needles.len()).map(move |j| [i, j]));
        let sharing = pairs.filter(|&[i, j]| shares(i, j)).map(|pair| pair.map(|i| i as u32)).collect();
        (needles, sharing)
    }

    #[test]
    fn overlaps_with_oriented_boxes_keep_every_pair_that_touches() {
        let (needles, sharing) = needles();
        let boxes: Vec<Aabb> = needles.iter().map(|&ends| Aabb::around(ends)).collect();
        let mut tree = Overlaps::of(&boxes);
        let plain = found(&tree).len();
        let order = tree.order().to_vec();
        tree.add_frames(|slot| needles[order[slot] as usize]);
        let all = found(&tree);
        assert!(sharing.len() > 3000 && sharing.iter().all(|pair| all.binary_search(pair).is_ok()));
        assert!(all.len() < plain, "{} of {plain}", all.len());
        // Fault injected: boxes that are far too small lose some.
        tree.frames.iter_mut().for_each(|frame| frame.shrink(0.2));
        let fewer = found(&tree);
        assert!(sharing.iter().any(|pair| fewer.binary_search(pair).is_err()));
    }

    #[test]
    fn overlaps_without_pairs_within_sets_are_the_others() {
        let boxes = boxes(700, 1.0);
        let sets: Vec<u32> = (0..700).map(|i| if i % 3 == 0 { NO_SET } else { i / 200 }).collect();
        let apart = |pair: &[u32; 2]| {
            let [i, j] = pair.map(|i| sets[i as usize]);
            i == NO_SET || i != j
        };
        let expected: Vec<[u32; 2]> = naive(&boxes).into_iter().filter(apart).collect();
        let tree = Overlaps::of(&boxes).without_pairs_within(&sets);
        assert_eq!(found(&tree), expected);
        // Fault injected: a box over all others in another set.
        let mut other = sets.clone();
        other[7] = 9;
        assert_ne!(found(&Overlaps::of(&boxes).without_pairs_within(&other)), expected);
    }
}
