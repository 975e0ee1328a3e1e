//! Collapse of the binary BVH to a wide one: which nodes become children of a wide node.
//!
//! The collapse of least cost (Ylitie, Karras and Laine, *Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs*, 2017, section 3.1). Dynamic programming from the leaves up: a subtree gets at most
//! j slots of a wide node. The cheapest use is to split the slots between its two children, or to use fewer;
//! with one slot it becomes a wide node of its own, or a leaf.

use super::Bvh;
use super::node::WIDTH;
use super::split::{LEAF, half_area};

/// Cost of reading a node, weighted by the probability that a line which meets the root meets the node's box.
const NODE_COST: f32 = 1.0;
/// Cost of testing a primitive of a leaf, weighted likewise by the leaf's box. (Measured: at 0.3 and at 1
/// verdicts take a few percent longer.)
const SLOT_COST: f32 = 0.5;
/// Cost of a node that is never read: with all other costs equal, the plan has few nodes.
const SPACE: f32 = 1.0 / (1 << 24) as f32;

/// The best representation of every node of a binary tree.
pub(super) struct Plan(Vec<Choice>);

/// The decision for one node of the binary tree. For each number of children j from 2 to [`WIDTH`], four bits
/// hold how many of them represent the first half, or 0 where fewer than j children are as good. The lowest
/// bit is [`AS_LEAF`].
#[derive(Clone, Copy)]
struct Choice(u32);

const AS_LEAF: u32 = 1;

impl Choice {
    fn left(self, children: usize) -> usize {
        (self.0 >> (4 * (children - 1)) & 15) as usize
    }
}

/// A child of a wide node, given by a node of the binary tree.
#[derive(Clone, Copy, Default)]
pub(super) struct Child {
    pub(super) at: usize,
    pub(super) is_leaf: bool,
}

impl Plan {
    pub(super) fn of(tree: &Bvh) -> Self {
        let mut choices = vec![Choice(AS_LEAF); tree.nodes.len() - 1];
        let share = 1.0 / half_area(&tree.nodes[0].aabb).max(f64::MIN_POSITIVE);
        // Costs of subtrees whose parents are still to come, indexed by the number of children minus one. The
        // two halves of the current node are on top.
        let mut costs: Vec<[f32; WIDTH - 1]> = Vec::new();
        for at in (0..choices.len()).rev() {
            let area = (half_area(&tree.nodes[at].aabb) * share) as f32 + SPACE;
            let slots = tree.slots_below(at).len();
            let as_leaf = if slots <= LEAF { area * SLOT_COST * slots as f32 } else { f32::INFINITY };
            if tree.is_leaf(at) {
                costs.push([as_leaf; WIDTH - 1]);
                continue;
            }
            let (left, right) = (costs.pop().expect("first half"), costs.pop().expect("second half"));
            let (mut divided, mut choice) = ([f32::INFINITY; WIDTH + 1], 0);
            for children in 2..=WIDTH {
                let mut best = 0;
                for to_left in 1..children {
                    let cost = left[to_left - 1] + right[children - to_left - 1];
                    if cost < divided[children] {
                        (divided[children], best) = (cost, to_left);
                    }
                }
                choice |= (best as u32) << (4 * (children - 1));
            }
            let as_node = divided[WIDTH] + NODE_COST * area;
            let mut cost = [as_node.min(as_leaf); WIDTH - 1];
            for children in 2..WIDTH {
                cost[children - 1] = cost[children - 2].min(divided[children]);
                if divided[children] >= cost[children - 2] {
                    choice &= !(15 << (4 * (children - 1)));
                }
            }
            choices[at] = Choice(if as_leaf <= as_node { choice | AS_LEAF } else { choice });
            costs.push(cost);
        }
        Self(choices)
    }

    /// The children of the wide node that represents `at`, and their number.
    pub(super) fn children(&self, tree: &Bvh, at: usize) -> ([Child; WIDTH], usize) {
        let (mut children, mut count) = ([Child::default(); WIDTH], 0);
        // Subtrees, each with the number of children that represent it.
        let (mut open, mut waiting) = ([(at, WIDTH); WIDTH], 1);
        while waiting > 0 {
            waiting -= 1;
            let (at, mut most) = open[waiting];
            let choice = self.0[at];
            while most > 1 && choice.left(most) == 0 {
                most -= 1;
            }
            if tree.is_leaf(at) || most == 1 {
                children[count] = Child { at, is_leaf: choice.0 & AS_LEAF != 0 };
                count += 1;
                continue;
            }
            let left = at + 1;
            open[waiting] = (tree.nodes[left].skip as usize, most - choice.left(most));
            open[waiting + 1] = (left, choice.left(most));
            waiting += 2;
        }
        (children, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;
    use crate::random::SplitMix64;

    fn tree(n: usize) -> Bvh {
        let mut random = SplitMix64(n as u64);
        let mut next = || random.unit() as f32;
        let boxes: Vec<Aabb> = (0..n)
            .map(|_| {
                Aabb::around(
                    [[next(), next(), next()], [next(), next(), next()]].map(|p| p.map(|x| x * x * x)),
                )
            })
            .collect();
        Bvh::build(&boxes)
    }

    fn area(tree: &Bvh, at: usize) -> f64 {
        half_area(&tree.nodes[at].aabb) / half_area(&tree.nodes[0].aabb) + f64::from(SPACE)
    }

    fn leaf(tree: &Bvh, at: usize) -> f64 {
        match tree.slots_below(at).len() {
            slots if slots <= LEAF => area(tree, at) * slots as f64 * f64::from(SLOT_COST),
            _ => f64::INFINITY,
        }
    }

    /// Reference: the least cost of a subtree, by trying all splits.
    fn least(tree: &Bvh, at: usize, children: usize) -> f64 {
        if tree.is_leaf(at) {
            return leaf(tree, at);
        }
        let (left, right) = (at + 1, tree.nodes[at + 1].skip as usize);
        let divided = |children: usize| {
            (1..children)
                .map(move |k| least(tree, left, k) + least(tree, right, children - k))
                .fold(f64::INFINITY, f64::min)
        };
        let as_one = (divided(WIDTH) + area(tree, at) * f64::from(NODE_COST)).min(leaf(tree, at));
        (2..=children).map(divided).fold(as_one, f64::min)
    }

    /// Cost of the plan.
    fn planned(tree: &Bvh, plan: &Plan, at: usize) -> f64 {
        let (children, count) = plan.children(tree, at);
        let below = children[..count].iter().map(|child| match child.is_leaf {
            true => leaf(tree, child.at),
            false => planned(tree, plan, child.at),
        });
        area(tree, at) * f64::from(NODE_COST) + below.sum::<f64>()
    }

    #[test]
    fn bvh_plan_costs_the_least_of_all_and_another_one_costs_more() {
        for n in [5, 7, 9, 14, 20] {
            let tree = tree(n);
            let mut plan = Plan::of(&tree);
            let wide = |tree: &Bvh| {
                let (left, right) = (1, tree.nodes[1].skip as usize);
                let ways = (1..WIDTH).map(|k| least(tree, left, k) + least(tree, right, WIDTH - k));
                ways.fold(f64::INFINITY, f64::min) + area(tree, 0) * f64::from(NODE_COST)
            };
            let (least, planned_cost) = (wide(&tree), planned(&tree, &plan, 0));
            assert!((planned_cost - least).abs() < 1e-5 * least, "{planned_cost} {least}");
            // Fault injected: two children, however many are allowed.
            plan.0[0] = Choice(1 << (4 * (WIDTH - 1)) | 1 << 4);
            let right = tree.nodes[1].skip as usize;
            plan.0[right] = Choice(plan.0[right].0 & (15 << (4 * (WIDTH - 1)) | AS_LEAF));
            assert!(n < 9 || planned(&tree, &plan, 0) > 1.001 * least);
        }
    }
}
