//! Whether a volume is closed, computed from what was emitted.

/// The boundary of a triangle list as a chain: how many edges do not cancel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoundarySum {
    /// Undirected edges whose two directions are not used equally often.
    pub open_edges: usize,
    /// The largest difference between the two directions at any edge.
    pub largest: u64,
}

impl BoundarySum {
    /// Whether every edge cancels: the triangles are a cycle.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0
    }
}

/// Sorts all directed edges; n·log n.
pub(super) fn boundary_sum(triangles: &[[u32; 3]]) -> BoundarySum {
    // The vertices, smaller first, and the direction in a bit below them.
    let mut edges: Vec<(u64, bool)> = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        for (tail, head) in [(a, b), (b, c), (c, a)] {
            if tail != head {
                edges.push((u64::from(tail.min(head)) << 32 | u64::from(tail.max(head)), tail < head));
            }
        }
    }
    edges.sort_unstable();
    let mut sum = BoundarySum::default();
    for edge in edges.chunk_by(|a, b| a.0 == b.0) {
        let along = edge.iter().filter(|(_, along)| *along).count();
        let difference = along.abs_diff(edge.len() - along) as u64;
        sum.open_edges += usize::from(difference > 0);
        sum.largest = sum.largest.max(difference);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_share_one_end_do_not_cancel() {
        // Two by two, the four open edges share their larger end and run in opposite directions.
        let sum = boundary_sum(&[[0, 1, 2], [1, 0, 3]]);
        assert_eq!(sum, BoundarySum { open_edges: 4, largest: 1 });
        let closed = boundary_sum(&[[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]]);
        assert_eq!(closed, BoundarySum { open_edges: 0, largest: 0 });
    }

    #[test]
    fn an_edge_used_three_times_one_way_differs_by_three() {
        let sum = boundary_sum(&[[0, 1, 2], [0, 1, 3], [0, 1, 4], [5, 5, 5]]);
        assert_eq!(sum, BoundarySum { open_edges: 7, largest: 3 });
    }
}
