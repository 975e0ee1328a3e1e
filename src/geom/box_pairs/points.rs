//! Boxes around a point.

use std::ops::ControlFlow;

use super::{FRAMES_FROM, LEAF, Overlaps};
use crate::geom::Aabb;

/// A tree for queries with a point, in which boxes of low index come first.
#[derive(Debug)]
pub(crate) struct PointQueries {
    tree: Overlaps,
    /// For each node the lowest index of a box below it.
    lowest: Vec<u32>,
    stack: Vec<u32>,
}

impl PointQueries {
    pub(crate) fn of(boxes: &[Aabb]) -> Self {
        let tree = Overlaps::of(boxes);
        let width = tree.leaves.len();
        let mut lowest = vec![u32::MAX; 2 * width];
        for (lowest, indices) in lowest[width..].iter_mut().zip(tree.order.chunks(LEAF)) {
            *lowest = indices.iter().copied().min().unwrap_or(u32::MAX);
        }
        for i in (1..width).rev() {
            lowest[i] = lowest[2 * i].min(lowest[2 * i + 1]);
        }
        Self { tree, lowest, stack: Vec::new() }
    }

    /// As [`Overlaps::add_frames`], around the points of each box by its index.
    pub(crate) fn add_frames<const N: usize>(&mut self, points: impl Fn(usize) -> [[f32; 3]; N] + Sync) {
        let order = std::mem::take(&mut self.tree.order);
        self.tree.order = vec![0; order.len()]; // only the number is asked for
        self.tree.add_frames(|slot| points(order[slot] as usize));
        self.tree.order = order;
    }

    pub(crate) fn has_frames(&self) -> bool {
        self.tree.has_frames()
    }

    /// Calls `visit` with the index of every box below `below` that overlaps `query`, a box that reaches
    /// `reach` from `point`, until it breaks; `visit` gives the next `below`. Also calls it with `None` for
    /// every node visited. Boxes with low indices tend to come first.
    pub(crate) fn for_each_at(
        &mut self,
        query: &Aabb,
        (point, reach): ([f32; 3], f64),
        mut visit: impl FnMut(Option<u32>) -> ControlFlow<(), u32>,
    ) -> ControlFlow<()> {
        let Self { tree, lowest, stack } = self;
        let width = tree.leaves.len();
        let mut below = u32::MAX;
        stack.clear();
        stack.push(1);
        while let Some(node) = stack.pop().map(|node| node as usize) {
            let apart = || {
                let frame = node.checked_sub(FRAMES_FROM).and_then(|frame| tree.frames.get(frame));
                frame.is_some_and(|frame| frame.excludes(point, reach))
            };
            if lowest[node] >= below || !tree.nodes[node].overlaps(query) || apart() {
                continue;
            }
            below = visit(None)?;
            if node < width {
                let children = [2 * node, 2 * node + 1];
                let last = usize::from(lowest[children[0]] < lowest[children[1]]);
                stack.extend([children[last] as u32, children[1 - last] as u32]);
                continue;
            }
            let mut hits = tree.leaves[node - width].overlapping(query);
            while hits != 0 {
                let slot = LEAF * (node - width) + hits.trailing_zeros() as usize;
                hits &= hits - 1;
                if tree.order[slot] < below {
                    below = visit(Some(tree.order[slot]))?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}
