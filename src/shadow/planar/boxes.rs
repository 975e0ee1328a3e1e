//! A tree of rectangles on a plane.

/// A closed rectangle; its ends may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

impl Rect {
    pub(super) const EMPTY: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    pub(super) fn join(&self, other: &Self) -> Self {
        Self {
            low: [0, 1].map(|i| self.low[i].min(other.low[i])),
            high: [0, 1].map(|i| self.high[i].max(other.high[i])),
        }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }

    /// Where the rectangle is sorted in along an axis: its middle, or the end that is finite.
    fn middle(&self, axis: usize) -> f64 {
        let (low, high) = (self.low[axis], self.high[axis]);
        match (low.is_finite(), high.is_finite()) {
            (true, true) => 0.5 * low + 0.5 * high,
            (true, false) => low,
            (false, true) => high,
            _ => 0.0,
        }
    }
}

/// Rectangles per leaf, at most.
const LEAF: usize = 4;
/// Halving a list of less than 2³² rectangles ends after this many steps.
const DEPTH: usize = 32;

/// A binary tree that halves the list of rectangles along the longer axis of their middles.
#[derive(Clone, Debug)]
pub(super) struct RectTree {
    nodes: Vec<Node>,
    rects: Vec<Rect>,
    /// The number of each rectangle in the list given.
    order: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    around: Rect,
    /// The second child; the first one comes next. 0 for a leaf.
    second: u32,
    /// Rectangles of a leaf.
    from: u32,
    to: u32,
}

impl RectTree {
    /// Time n log n, 40 bytes per rectangle and 24 for the nodes.
    pub(super) fn new(rects: &[Rect]) -> Self {
        let mut order: Vec<u32> = (0..rects.len() as u32).collect(); // faces have 32 bits
        let mut nodes = Vec::with_capacity(rects.len().div_ceil(2));
        if !rects.is_empty() {
            build(rects, &mut order, 0, &mut nodes);
        }
        Self { nodes, rects: order.iter().map(|&index| rects[index as usize]).collect(), order }
    }

    /// Whether `test` holds for one of the rectangles that overlap a query. It stops at the first.
    pub(super) fn any(&self, query: &Rect, mut test: impl FnMut(usize) -> bool) -> bool {
        let mut stack = [0_u32; DEPTH + 1];
        let mut left = usize::from(!self.nodes.is_empty());
        while left > 0 {
            left -= 1;
            let index = stack[left];
            let node = &self.nodes[index as usize];
            if !node.around.overlaps(query) {
                continue;
            }
            if node.second > 0 {
                stack[left] = node.second;
                stack[left + 1] = index + 1;
                left += 2;
                continue;
            }
            for slot in node.from as usize..node.to as usize {
                if self.rects[slot].overlaps(query) && test(self.order[slot] as usize) {
                    return true;
                }
            }
        }
        false
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.rects) + size_of_val(&*self.order)
    }
}

/// Adds the subtree over `order`, which begins at `from` of the whole list.
fn build(rects: &[Rect], order: &mut [u32], from: usize, nodes: &mut Vec<Node>) {
    let rect = |index: u32| &rects[index as usize];
    let around = order.iter().fold(Rect::EMPTY, |all, &index| all.join(rect(index)));
    let own = nodes.len();
    let [from_slot, to_slot] = [from, from + order.len()].map(|slot| slot as u32);
    nodes.push(Node { around, second: 0, from: from_slot, to: to_slot });
    if order.len() <= LEAF {
        return;
    }
    let spread = |axis: usize| {
        let middles = order.iter().map(|&index| rect(index).middle(axis));
        let (least, most) =
            middles.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| (least.min(x), most.max(x)));
        most - least
    };
    let axis = usize::from(spread(1) > spread(0));
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |&a, &b| {
        rect(a).middle(axis).total_cmp(&rect(b).middle(axis)).then(a.cmp(&b))
    });
    let (first, second) = order.split_at_mut(half);
    build(rects, first, from, nodes);
    nodes[own].second = nodes.len() as u32;
    build(rects, second, from + half, nodes);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn rectangles_found_by_the_tree_are_those_of_a_loop() {
        let mut random = SplitMix64(3);
        for count in [0, 1, 4, 5, 300] {
            let rects: Vec<Rect> = (0..count)
                .map(|i| {
                    let low = [0; 2].map(|_| 10.0 * random.unit());
                    let mut rect = Rect { low, high: low.map(|x| x + random.unit().powi(3)) };
                    match i % 7 {
                        0 => rect.low[i % 2] = f64::NEG_INFINITY,
                        1 => rect.high = [f64::INFINITY; 2],
                        _ => {}
                    }
                    rect
                })
                .collect();
            let tree = RectTree::new(&rects);
            for _ in 0..200 {
                let low = [0; 2].map(|_| 11.0 * random.unit());
                let query = Rect { low, high: low };
                let mut found = Vec::new();
                assert!(!tree.any(&query, |index| {
                    found.push(index);
                    false
                }));
                found.sort_unstable();
                let all: Vec<usize> = (0..count).filter(|&i| rects[i].overlaps(&query)).collect();
                assert_eq!(found, all);
                assert_eq!(tree.any(&query, |_| true), !all.is_empty());
            }
        }
    }

    /// All in one spot: still halved.
    #[test]
    fn rectangles_that_coincide_make_a_tree_of_bounded_depth() {
        let rects = vec![Rect { low: [1.0; 2], high: [2.0; 2] }; 5000];
        let tree = RectTree::new(&rects);
        let mut count = 0;
        tree.any(&Rect { low: [1.5; 2], high: [1.5; 2] }, |_| {
            count += 1;
            false
        });
        assert_eq!(count, 5000);
    }
}
