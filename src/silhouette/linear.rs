//! Silhouettes by a linear scan of all edges.
//!
//! Nearly all edges of nearly all meshes have two faces in opposite directions. Where 64 consecutive edges
//! do, the signs of their faces are compared without branches, into a word of 64 bits, and only edges whose
//! bits are set are visited; the multiplicities of other edges are summed up one by one.

use multiversion::multiversion;

use super::edge_set::Bits;
use super::{Silhouette, SilhouetteEdge};
use crate::mesh::EdgeId;
use crate::topology::{Entry, Topology};

/// Edges per block.
const BLOCK: usize = 64;

pub(super) fn extract_into(topology: &Topology, signs: &[i8], silhouette: &mut Silhouette) {
    assert_eq!(signs.len(), topology.face_count(), "one sign per face");
    silhouette.edges.clear();
    let table = topology.table();
    let all_pairs = topology.edge_counts().watertight();
    fill(table, all_pairs, signs, &mut silhouette.edges);
}

/// The silhouette edges of a table. `all_pairs`: all edges are known to have two faces in opposite
/// directions.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn fill(
    (offsets, entries): (&[u32], &[Entry]),
    all_pairs: bool,
    signs: &[i8],
    edges: &mut Vec<SilhouetteEdge>,
) {
    let edge_count = offsets.len() - 1;
    for first in (0..edge_count).step_by(BLOCK) {
        let offsets = &offsets[first..edge_count.min(first + BLOCK) + 1];
        let block = entries[offsets[0] as usize..].first_chunk::<{ 2 * BLOCK }>();
        match (block, <&[u32; BLOCK + 1]>::try_from(offsets)) {
            (Some(block), Ok(offsets)) if all_pairs || are_pairs(offsets, block) => {
                for slot in Bits(changes(block, signs)) {
                    let [a, b] = [block[2 * slot as usize], block[2 * slot as usize + 1]];
                    let along = i32::from(signs[a.face()]) - i32::from(signs[b.face()]);
                    let edge = EdgeId(first as u32 + slot); // edge ids are 32 bits
                    edges.push(SilhouetteEdge { edge, multiplicity: a.direction() * along });
                }
            }
            _ => {
                for (edge, ends) in (first as u32..).map(EdgeId).zip(offsets.windows(2)) {
                    let entries = &entries[ends[0] as usize..ends[1] as usize];
                    let cast = |entry: &Entry| entry.direction() * i32::from(signs[entry.face()]);
                    let multiplicity = entries.iter().map(cast).sum();
                    if multiplicity != 0 {
                        edges.push(SilhouetteEdge { edge, multiplicity });
                    }
                }
            }
        }
    }
}

/// Whether all edges of a block have two faces in opposite directions.
#[inline(always)]
fn are_pairs(offsets: &[u32; BLOCK + 1], entries: &[Entry; 2 * BLOCK]) -> bool {
    let mut others = 0;
    for i in 0..BLOCK {
        others |= offsets[i + 1].wrapping_sub(offsets[i]) ^ 2;
    }
    for i in 0..BLOCK {
        others |= entries[2 * i].against() ^ entries[2 * i + 1].against() ^ 1;
    }
    others == 0
}

/// One bit per edge: whether the signs of its two faces differ.
#[inline(always)]
fn changes(entries: &[Entry; 2 * BLOCK], signs: &[i8]) -> u64 {
    // Face ids in a loop of their own, which is compiled to vector instructions.
    let mut faces = [0; 2 * BLOCK];
    for (face, entry) in faces.iter_mut().zip(entries) {
        *face = entry.face() as u32;
    }
    let mut changes = [0_u8; BLOCK];
    for (change, [a, b]) in changes.iter_mut().zip(faces.as_chunks().0) {
        *change = u8::from(signs[*a as usize] != signs[*b as usize]);
    }
    let mut word = 0;
    for (shift, eight) in (0..).step_by(8).zip(changes.as_chunks::<8>().0) {
        // The lowest bits of eight bytes, gathered in the highest byte.
        word |= (u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56) << shift;
    }
    word
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexId;
    use crate::testing::shapes;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    fn extract(topology: &Topology, signs: &[i8]) -> Silhouette {
        Silhouette::extract(topology, signs)
    }

    /// The signed sum over all directed uses of each pair of vertices, from the triangles alone.
    fn naive(triangles: &[[u32; 3]], signs: &[i8]) -> BTreeMap<[VertexId; 2], i32> {
        let mut sums = BTreeMap::new();
        for (corners, &sign) in triangles.iter().zip(signs) {
            let [a, b, c] = *corners;
            if a == b || b == c || c == a {
                continue;
            }
            for (tail, head) in [(a, b), (b, c), (c, a)] {
                let key = [VertexId(tail.min(head)), VertexId(tail.max(head))];
                *sums.entry(key).or_insert(0) += if tail < head { i32::from(sign) } else { -i32::from(sign) };
            }
        }
        sums.retain(|_, sum| *sum != 0);
        sums
    }

    fn found(triangles: &[[u32; 3]], signs: &[i8], vertex_count: usize) -> BTreeMap<[VertexId; 2], i32> {
        let topology = Topology::build(vertex_count, triangles.to_vec());
        let silhouette = extract(&topology, signs);
        assert!(silhouette.edges.is_sorted_by_key(|edge| edge.edge));
        silhouette.edges.iter().map(|edge| (topology.vertices(edge.edge), edge.multiplicity)).collect()
    }

    fn soup() -> impl Strategy<Value = Vec<([u32; 3], i8)>> {
        prop::collection::vec(([0_u32..8, 0_u32..8, 0_u32..8], -1_i8..=1), 0..60)
    }

    /// The same from the table, edge by edge: the reference for blocks.
    fn one_by_one(topology: &Topology, signs: &[i8]) -> Vec<SilhouetteEdge> {
        let multiplicity = |edge| {
            topology.uses(edge).map(|(face, along)| along * i32::from(signs[face.index()])).sum::<i32>()
        };
        let all = topology.edges().map(|edge| SilhouetteEdge { edge, multiplicity: multiplicity(edge) });
        all.filter(|edge| edge.multiplicity != 0).collect()
    }

    proptest! {
        /// Surfaces of several blocks: closed, with a hole, with faces turned, with faces twice.
        #[test]
        fn silhouette_scan_by_blocks_equals_the_scan_edge_by_edge(
            size in (3_u32..24, 3_u32..12),
            gone in prop::collection::vec(any::<prop::sample::Index>(), 0..2),
            turned in prop::collection::vec(any::<prop::sample::Index>(), 0..3),
            doubled in prop::collection::vec(any::<prop::sample::Index>(), 0..3),
            signs in prop::collection::vec(-1_i8..=1, 1000),
        ) {
            let mesh = shapes::torus(size.0, size.1, 2.0, 1.0);
            let mut triangles = mesh.triangles().to_vec();
            for place in turned {
                let place = place.index(triangles.len());
                triangles[place].swap(0, 1);
            }
            for place in doubled {
                triangles.push(triangles[place.index(triangles.len())]);
            }
            for place in gone {
                triangles.remove(place.index(triangles.len()));
            }
            let topology = Topology::build(mesh.vertex_count(), triangles);
            let signs = &signs[..topology.face_count()];
            let expected = one_by_one(&topology, signs);
            prop_assert_eq!(extract(&topology, signs).edges, expected);
        }

        #[test]
        fn silhouette_scan_equals_summing_every_directed_use(soup in soup()) {
            let (triangles, signs): (Vec<_>, Vec<_>) = soup.into_iter().unzip();
            prop_assert_eq!(found(&triangles, &signs, 8), naive(&triangles, &signs));
        }
    }

    #[test]
    fn silhouette_a_flipped_sign_is_seen_by_the_comparison() {
        let triangles = [[0, 1, 2], [2, 1, 3]];
        let expected = naive(&triangles, &[1, 1]);
        assert_eq!(found(&triangles, &[1, 1], 4), expected);
        assert_ne!(found(&triangles, &[1, -1], 4), expected);
    }

    #[test]
    fn silhouette_scan_that_takes_every_edge_for_a_pair_is_caught() {
        let mesh = shapes::torus(9, 9, 2.0, 1.0);
        let mut triangles = mesh.triangles().to_vec();
        triangles.remove(40);
        triangles[7].swap(0, 1);
        let topology = Topology::build(mesh.vertex_count(), triangles);
        let signs: Vec<i8> = (0..topology.face_count()).map(|face| (face * face % 3) as i8 - 1).collect();
        let filled = |all_pairs| {
            let mut edges = Vec::new();
            fill(topology.table(), all_pairs, &signs, &mut edges);
            edges
        };
        let expected = one_by_one(&topology, &signs);
        assert_eq!(filled(false), expected);
        assert_ne!(filled(true), expected);
    }
}
