//! Invariants of the edge table, checked against the triangles.

use super::{EdgeCounts, Topology};

impl Topology {
    /// Checks every invariant; debug builds run it after every build. Linear time.
    ///
    /// Each half-edge of a face that has not collapsed is in the table once, at the edge of its two vertices,
    /// with its direction. Edges ascend, and none is empty. The counts are those of the table.
    ///
    /// # Panics
    ///
    /// Panics with the values where an invariant does not hold.
    pub fn validate(&self) {
        // A bit for each half-edge.
        let mut seen = vec![0_u64; (3 * self.face_count()).div_ceil(64)];
        let mut before = None;
        let mut counts = EdgeCounts::NONE;
        assert_eq!(self.offsets.first(), Some(&0));
        assert_eq!(self.offsets.last().map(|&end| end as usize), Some(self.entries.len()));
        for edge in self.edges() {
            let entries = self.entries(edge);
            assert!(!entries.is_empty(), "{edge:?} has no half-edge");
            assert!(entries.is_sorted_by_key(|entry| entry.0), "half-edges of {edge:?} are out of order");
            let [a, b] = self.vertices(edge);
            assert!(a < b && b.index() < self.vertex_count, "{edge:?} runs from {a:?} to {b:?}");
            assert!(before < Some((a, b)), "{edge:?} is out of order");
            before = Some((a, b));
            counts.add(entries.len(), entries.iter().map(|entry| entry.direction()).sum());
            for entry in entries {
                let half_edge = entry.half_edge();
                let ends = (self.tail(half_edge), self.head(half_edge));
                let expected = if entry.direction() == 1 { (a, b) } else { (b, a) };
                assert_eq!(ends, expected, "{half_edge:?} of {edge:?}");
                assert!(
                    !self.is_collapsed(self.face(half_edge)),
                    "{half_edge:?} belongs to a collapsed face"
                );
                let (word, bit) = (&mut seen[half_edge.index() / 64], 1 << (half_edge.index() % 64));
                assert_eq!(*word & bit, 0, "{half_edge:?} is in the table twice");
                *word |= bit;
            }
        }
        assert_eq!(self.edge_counts(), counts);
        let collapsed = self.faces().filter(|&face| self.is_collapsed(face)).count();
        assert_eq!(collapsed, self.collapsed_faces);
        let seen: u32 = seen.iter().map(|word| word.count_ones()).sum();
        assert_eq!(seen as usize, 3 * (self.face_count() - collapsed));
    }
}
