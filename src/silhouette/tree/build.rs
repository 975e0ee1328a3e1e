//! Builds the tree: edges whose planes are near each other side by side, then leaves, then boxes over boxes.

use super::leaf::{Leaf, column};
use super::{LEAF, Limits, Node, SilhouetteTree, Store, WIDE, Waiting, Work};
use crate::mesh::Mesh;
use crate::parallel;
use crate::silhouette::FacePlanes;
use crate::silhouette::quantised::Quantised;
use crate::topology::{Entry, Topology};

/// Edges that are arranged by one thread: some milliseconds.
const GRAIN: usize = 1 << 14;

/// A place, and whose it is.
type Slot<const N: usize> = ([i16; N], u32);

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
        let ends = pair(topology, edge).map(|faces| faces.map(|face| numbers[face]));
        match ends.filter(|ends| ends.iter().all(|plane| *plane != [0; 4])) {
            Some([a, b]) => {
                // The middle of the two and half of what is between them: long ones do not widen the boxes of short ones.
                let mut place = [0; 8];
                for i in 0..4 {
                    let (a, b) = (i32::from(a[i]), i32::from(b[i]));
                    (place[i], place[4 + i]) = (((a + b) / 2) as i16, ((a - b).abs() / 2) as i16);
                }
                slots.push((place, edge));
            }
            None => apart.push(edge),
        }
    }
    let edges = arrange(slots);
    let (fine, reach) = (planes.together(), f64::from(planes.reach()));
    let mut leaves = vec![None; edges.len().div_ceil(LEAF)];
    const LEAVES: usize = GRAIN / LEAF;
    parallel::rows(&mut leaves, LEAVES, |row, leaves| {
        for (leaf, edges) in leaves.iter_mut().zip(edges[row * LEAVES * LEAF..].chunks(LEAF)) {
            let (mut bound, mut pairs) = (Bound::NOTHING, [[[0.0; 4]; LEAF]; 2]);
            for place in 0..LEAF {
                // The first edge fills what is left of the last leaf.
                let edge = edges.get(place).unwrap_or(&edges[0]);
                let faces = pair(topology, *edge).expect("it was one before");
                for (side, face) in pairs.iter_mut().zip(faces) {
                    let [x, y, z, offset] = fine[face].map(f64::from);
                    side[column(place)] = [x, y, z, offset / reach];
                    bound = bound.around(&Bound { low: numbers[face], high: numbers[face] });
                }
            }
            *leaf = Some((Leaf::new(&pairs), bound));
        }
    });
    let (leaves, bounds) = leaves.into_iter().map(|leaf| leaf.expect("all are made")).unzip();
    SilhouetteTree {
        planes,
        edge_count,
        limits: Limits::new(edge_count, edges.len()),
        waiting: Waiting::default(),
        store: Store { leaves, edges, levels: levels(bounds) },
        apart,
        work: Work::new(edge_count),
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
            (node.0[i][0][place], node.0[i][1][place]) = (bound.low[i], bound.high[i]);
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

/// The face along an edge and the face against it, if there are just these.
fn pair(topology: &Topology, edge: u32) -> Option<[usize; 2]> {
    let (offsets, entries) = topology.table();
    let entries = &entries[offsets[edge as usize] as usize..offsets[edge as usize + 1] as usize];
    let &[a, b]: &[Entry; 2] = entries.try_into().ok()?;
    if a.against() == b.against() {
        return None;
    }
    let (along, against) = if a.against() == 0 { (a, b) } else { (b, a) };
    Some([along.face(), against.face()])
}

/// Orders what has a place so that neighbours in a leaf, in eight leaves, in 64 and so on are near each other: halves at
/// the middle of the widest component, at a whole number of the largest node that fits more than once.
///
/// Halves are arranged each by itself, on threads if they are large; which they are does not depend on that.
pub(in crate::silhouette) fn arrange<const N: usize>(mut slots: Vec<Slot<N>>) -> Vec<u32> {
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
