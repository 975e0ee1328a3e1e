//! A bounding hierarchy over planes, eight children per node: for faces, and for edges between two planes.

mod node;

pub(crate) use node::{Heights, Node, WIDE, undecided_child};

use crate::facing::quantized::Quantized;
use crate::parallel;

/// Planes, or pairs of them, per leaf.
pub(crate) const LEAF: usize = 32;

/// Keys that one thread sorts: some milliseconds.
pub(crate) const GRAIN: usize = 1 << 14;

/// A position among planes, and the face or edge that it belongs to.
pub(crate) type Slot<const N: usize> = ([i16; N], u32);

/// A box of planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bound {
    pub(crate) low: Quantized,
    pub(crate) high: Quantized,
}

/// The levels of nodes over leaves with these bounds, from the lowest to the root.
pub(crate) fn levels(mut bounds: Vec<Bound>) -> Vec<Vec<Node>> {
    let mut levels = Vec::new();
    while !bounds.is_empty() {
        levels.push(bounds.chunks(WIDE).map(over).collect());
        if bounds.len() <= WIDE {
            break;
        }
        bounds = bounds
            .chunks(WIDE)
            .map(|children| children.iter().fold(Bound::NOTHING, |all, child| all.around(child)))
            .collect();
    }
    levels
}

fn over(children: &[Bound]) -> Node {
    let mut node = Node::default();
    for (place, bound) in children.iter().enumerate() {
        for i in 0..4 {
            (node.0[i][0][place], node.0[i][1][place]) = (bound.low[i], bound.high[i]);
        }
    }
    node
}

impl Bound {
    pub(crate) const NOTHING: Self = Self { low: [i16::MAX; 4], high: [-i16::MAX; 4] };

    /// Around planes.
    pub(crate) fn of(planes: impl Iterator<Item = Quantized>) -> Self {
        planes.fold(Self::NOTHING, |bound, plane| bound.around(&Self { low: plane, high: plane }))
    }

    pub(crate) fn around(&self, other: &Self) -> Self {
        let mut both = *self;
        for i in 0..4 {
            both.low[i] = both.low[i].min(other.low[i]);
            both.high[i] = both.high[i].max(other.high[i]);
        }
        both
    }
}

/// Orders faces or edges so that those in a leaf, in eight leaves, in 64 and so on are near each other:
/// splits at the median of the widest component, rounded to a multiple of the largest node that fits more
/// than once.
///
/// Halves are sorted separately, on several threads if they are large; the order does not depend on that.
pub(crate) fn arrange<const N: usize>(mut slots: Vec<Slot<N>>) -> Vec<u32> {
    arrange_part(&mut slots);
    slots.into_iter().map(|slot| slot.1).collect()
}

fn arrange_part<const N: usize>(slots: &mut [Slot<N>]) {
    if slots.len() <= GRAIN {
        let mut parts = vec![slots];
        while let Some(part) = parts.pop() {
            parts.extend(halve(part).into_iter().flatten());
        }
    } else if let Some([left, right]) = halve(slots) {
        parallel::join(|| arrange_part(left), || arrange_part(right));
    }
}

fn halve<const N: usize>(part: &mut [Slot<N>]) -> Option<[&mut [Slot<N>]; 2]> {
    if part.len() <= LEAF {
        return None;
    }
    let mut unit = LEAF;
    while unit * WIDE < part.len() {
        unit *= WIDE;
    }
    let (mut low, mut high) = ([i16::MAX; N], [i16::MIN; N]);
    for (place, _) in &*part {
        for i in 0..N {
            (low[i], high[i]) = (low[i].min(place[i]), high[i].max(place[i]));
        }
    }
    let widest = (0..N).max_by_key(|&i| i32::from(high[i]) - i32::from(low[i])).expect("some");
    let half = (part.len() / 2).div_ceil(unit) * unit;
    part.select_nth_unstable_by_key(half, |slot| (slot.0[widest], slot.1));
    let (left, right) = part.split_at_mut(half);
    Some([left, right])
}
