//! Building the tree: edges ordered so that those of similar planes are neighbors, then leaves, then nodes.

use std::sync::Arc;

use super::leaf::{Leaf, column};
use super::{Limits, SilhouetteTree, Store, Waiting, Work};
use crate::facing::FacePlanes;
use crate::facing::plane_tree::{Bound, GRAIN, LEAF, arrange, levels};
use crate::mesh::Mesh;
use crate::parallel;
use crate::topology::{Entry, Topology};

pub(super) fn build(mesh: &Mesh, topology: &Topology, planes: Arc<FacePlanes>) -> SilhouetteTree {
    assert_eq!(mesh.face_count(), topology.face_count(), "the topology is of another mesh");
    assert_eq!(mesh.face_count(), planes.offset.len(), "the planes are of another mesh");
    // The four integers of a plane together, for random access.
    let numbers = planes.quantized.all();
    let edge_count = topology.edge_count();
    let (mut slots, mut apart) = (Vec::with_capacity(edge_count), Vec::new());
    for edge in 0..edge_count as u32 {
        let ends = pair(topology, edge).map(|faces| faces.map(|face| numbers[face]));
        match ends.filter(|ends| ends.iter().all(|plane| *plane != [0; 4])) {
            Some([a, b]) => {
                // Sorted by midpoint and half extent: long segments do not widen the boxes of short ones.
                let mut key = [0; 8];
                for i in 0..4 {
                    let (a, b) = (i32::from(a[i]), i32::from(b[i]));
                    (key[i], key[4 + i]) = (((a + b) / 2) as i16, ((a - b).abs() / 2) as i16);
                }
                slots.push((key, edge));
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
            for slot in 0..LEAF {
                // The first edge fills the rest of the last leaf.
                let edge = edges.get(slot).unwrap_or(&edges[0]);
                let faces = pair(topology, *edge).expect("it has two faces");
                for (side, face) in pairs.iter_mut().zip(faces) {
                    let [x, y, z, offset] = fine[face].map(f64::from);
                    side[column(slot)] = [x, y, z, offset / reach];
                    bound = bound.around(&Bound { low: numbers[face], high: numbers[face] });
                }
            }
            *leaf = Some((Leaf::new(&pairs), bound));
        }
    });
    let (leaves, bounds) = leaves.into_iter().map(|leaf| leaf.expect("each leaf is built")).unzip();
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

/// The face along an edge and the face against it, if the edge has exactly these two.
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
