//! Builds the tree: edges whose planes are near each other side by side, then leaves, then boxes over boxes.

use super::{
    CROWDED_EDGES, CROWDED_LEAVES, LEAF, Leaf, Node, OPEN_SHARE, SilhouetteTree, WIDE, Waiting, Work,
};
use crate::mesh::Mesh;
use crate::parallel;
use crate::silhouette::FacePlanes;
use crate::silhouette::edge_set::EdgeSet;
use crate::silhouette::quantised::Quantised;
use crate::topology::{Entry, Topology};

/// Edges that are arranged by one thread: some milliseconds.
const GRAIN: usize = 1 << 14;

/// A place among planes, and whose it is.
type Slot = (Quantised, u32);

/// A box of planes.
#[derive(Clone, Copy, Debug)]
pub(in crate::silhouette) struct Bound {
    low: Quantised,
    high: Quantised,
}

pub(super) fn build(mesh: &Mesh, topology: &Topology) -> SilhouetteTree {
    assert_eq!(mesh.face_count(), topology.face_count(), "the topology is of another mesh");
    let planes = FacePlanes::new(mesh);
    // The four numbers of a plane together: they are picked in no order.
    let numbers = planes.quantised.all();
    let edge_count = topology.edge_count();
    let (mut slots, mut apart) = (Vec::with_capacity(edge_count), Vec::new());
    for edge in 0..edge_count as u32 {
        match ends(topology, &numbers, edge) {
            Some([a, b]) => {
                let middle = [0, 1, 2, 3].map(|i| ((i32::from(a[i]) + i32::from(b[i])) / 2) as i16);
                slots.push((middle, edge));
            }
            None => apart.push(edge),
        }
    }
    let edges = arrange(slots);
    let mut leaves = vec![(Leaf::EMPTY, Bound::NOTHING); edges.len().div_ceil(LEAF)];
    const LEAVES: usize = GRAIN / LEAF;
    parallel::rows(&mut leaves, LEAVES, |row, leaves| {
        for ((leaf, bound), edges) in leaves.iter_mut().zip(edges[row * LEAVES * LEAF..].chunks(LEAF)) {
            for (place, &edge) in edges.iter().enumerate() {
                let ends = ends(topology, &numbers, edge).expect("it had them before");
                for (side, plane) in leaf.0.iter_mut().zip(ends) {
                    for (row, number) in side.iter_mut().zip(plane) {
                        row[place] = number;
                    }
                    *bound = bound.around(&Bound { low: plane, high: plane });
                }
            }
        }
    });
    let (leaves, bounds) = leaves.into_iter().unzip();
    let work = Work {
        found: EdgeSet::new(edge_count),
        negative: vec![0; edge_count.div_ceil(64)],
        found_count: 0,
        hits: Vec::new(),
        open: Vec::new(),
        nodes: Vec::new(),
        next: Vec::new(),
        facing: Vec::new(),
        signs: Vec::new(),
    };
    SilhouetteTree {
        planes,
        edge_count,
        most_open: edge_count / OPEN_SHARE,
        most_leaves: edges.len().div_ceil(LEAF) / CROWDED_LEAVES,
        most_found: edge_count / CROWDED_EDGES,
        waiting: Waiting::default(),
        leaves,
        edges,
        levels: levels(bounds),
        apart,
        work,
    }
}

/// The nodes over leaves with these bounds, over those nodes, and so on.
pub(in crate::silhouette) fn levels(mut bounds: Vec<Bound>) -> Vec<Vec<Node>> {
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
            (node.0[i][place], node.0[i][WIDE + place]) = (bound.low[i], bound.high[i]);
        }
    }
    node
}

impl Bound {
    const NOTHING: Self = Self { low: [i16::MAX; 4], high: [-i16::MAX; 4] };

    /// Around planes.
    pub(in crate::silhouette) fn of(planes: impl Iterator<Item = Quantised>) -> Self {
        planes.fold(Self::NOTHING, |bound, plane| bound.around(&Self { low: plane, high: plane }))
    }

    fn around(&self, other: &Self) -> Self {
        let mut both = *self;
        for i in 0..4 {
            both.low[i] = both.low[i].min(other.low[i]);
            both.high[i] = both.high[i].max(other.high[i]);
        }
        both
    }
}

/// The planes of the face along an edge and of the face against it, if there are just these and both are known well.
fn ends(topology: &Topology, planes: &[Quantised], edge: u32) -> Option<[Quantised; 2]> {
    let (offsets, entries) = topology.table();
    let entries = &entries[offsets[edge as usize] as usize..offsets[edge as usize + 1] as usize];
    let &[a, b]: &[Entry; 2] = entries.try_into().ok()?;
    if a.against() == b.against() {
        return None;
    }
    let (along, against) = if a.against() == 0 { (a, b) } else { (b, a) };
    let ends = [along, against].map(|entry| planes[entry.face()]);
    ends.iter().all(|plane| *plane != [0; 4]).then_some(ends)
}

/// Orders what has a place so that neighbours in a leaf, in eight leaves, in 64 and so on are near each other: halves at
/// the middle of the widest component, at a whole number of the largest node that fits more than once.
///
/// Halves are arranged each by itself, on threads if they are large; which they are does not depend on that.
pub(in crate::silhouette) fn arrange(mut slots: Vec<Slot>) -> Vec<u32> {
    arrange_part(&mut slots);
    slots.into_iter().map(|slot| slot.1).collect()
}

fn arrange_part(slots: &mut [Slot]) {
    if slots.len() <= GRAIN {
        let mut parts = vec![slots];
        while let Some(part) = parts.pop() {
            parts.extend(halve(part).into_iter().flatten());
        }
    } else if let Some([left, right]) = halve(slots) {
        parallel::join(|| arrange_part(left), || arrange_part(right));
    }
}

fn halve(part: &mut [Slot]) -> Option<[&mut [Slot]; 2]> {
    if part.len() <= LEAF {
        return None;
    }
    let mut unit = LEAF;
    while unit * WIDE < part.len() {
        unit *= WIDE;
    }
    let bound = Bound::of(part.iter().map(|slot| slot.0));
    let width = |i: usize| i32::from(bound.high[i]) - i32::from(bound.low[i]);
    let widest = [0, 1, 2, 3].into_iter().max_by_key(|&i| width(i)).expect("four");
    let half = (part.len() / 2).div_ceil(unit) * unit;
    part.select_nth_unstable_by_key(half, |slot| (slot.0[widest], slot.1));
    let (left, right) = part.split_at_mut(half);
    Some([left, right])
}
