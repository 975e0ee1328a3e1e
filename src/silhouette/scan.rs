//! The silhouette by looking at every edge.

use super::{Silhouette, SilhouetteEdge};
use crate::topology::Topology;

pub(super) fn extract(topology: &Topology, signs: &[i8]) -> Silhouette {
    assert_eq!(signs.len(), topology.face_count(), "one sign a face");
    let multiplicity = |edge| {
        let uses = topology.uses(edge);
        uses.map(|(face, direction)| direction * i32::from(signs[face.index()])).sum::<i32>()
    };
    let edges = topology
        .edges()
        .map(|edge| SilhouetteEdge { edge, multiplicity: multiplicity(edge) })
        .filter(|edge| edge.multiplicity != 0)
        .collect();
    Silhouette { edges }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexId;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    /// For each pair of vertices, every directed use of it, found in no particular way.
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

    proptest! {
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
}
