//! Vertices that get several values: one copy a value.

use std::collections::HashMap;

use super::Occlusion;

/// The receiver of a vertex that no face has.
pub(super) const NONE: u32 = u32::MAX;

/// The vertices of a primitive or mesh after splitting: the old ones, then the copies.
pub(super) struct Split {
    /// The vertex that each copy is of.
    pub(super) copies: Vec<u32>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The receiver of each vertex, [`NONE`] if it has none.
    pub(super) receivers: Vec<u32>,
}

/// For each receiver the first one with the same values: between those no vertex has to be split.
pub(super) fn with_equal_values(occlusion: &Occlusion<'_>) -> Vec<u32> {
    let mut first = HashMap::new();
    let bits = |receiver: usize| {
        let bent = occlusion.bent.map_or([0; 3], |bent| bent[receiver].map(f32::to_bits));
        (occlusion.openness[receiver].to_bits(), bent)
    };
    (0..occlusion.openness.len()).map(|at| *first.entry(bits(at)).or_insert(at as u32)).collect()
}

impl Split {
    /// `corners` are the receivers of the corners of `triangles`.
    pub(super) fn new(vertices: usize, triangles: &[[u32; 3]], corners: &[[u32; 3]]) -> Self {
        let mut receivers = vec![NONE; vertices];
        let mut copy_of: HashMap<(u32, u32), u32> = HashMap::new();
        let mut copies = Vec::new();
        let mut place = |vertex: u32, receiver: u32| {
            let own = &mut receivers[vertex as usize];
            if *own == NONE || *own == receiver {
                *own = receiver;
                return vertex;
            }
            *copy_of.entry((vertex, receiver)).or_insert_with(|| {
                copies.push(vertex);
                receivers.push(receiver);
                receivers.len() as u32 - 1
            })
        };
        let triangles = triangles.iter().zip(corners);
        let triangles = triangles.map(|(t, r)| [0, 1, 2].map(|corner| place(t[corner], r[corner]))).collect();
        Self { copies, triangles, receivers }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_copies_a_vertex_once_a_value() {
        let triangles = [[0, 1, 2], [2, 1, 3], [0, 2, 3]];
        let split = Split::new(5, &triangles, &[[7, 7, 7], [8, 7, 7], [7, 8, 9]]);
        assert_eq!(split.copies, [2, 3]);
        assert_eq!(split.triangles, [[0, 1, 2], [5, 1, 3], [0, 5, 6]]);
        assert_eq!(split.receivers, [7, 7, 7, 7, NONE, 8, 9]);
        // Each corner has the vertex it had and the value that was asked for.
        let source = |vertex: u32| split.copies.get(vertex as usize - 5).copied().unwrap_or(vertex);
        assert_eq!([source(5), source(6)], [2, 3]);
    }

    #[test]
    fn split_is_not_needed_between_equal_values() {
        let values = Occlusion { corners: &[], openness: &[0.5, 0.25, 0.5, -0.0, 0.0], bent: None };
        assert_eq!(with_equal_values(&values), [0, 1, 0, 3, 4]);
        let bent = [[0.0, 0.0, 1.0], [0.0; 3], [0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]];
        assert_eq!(with_equal_values(&Occlusion { bent: Some(&bent), ..values }), [0, 1, 2, 3, 4]);
    }
}
