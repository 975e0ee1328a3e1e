//! Defects of single faces: zero area, and duplicates.

use crate::geom::predicate::collinear;
use crate::mesh::{FaceId, Mesh};
use crate::topology::Topology;

/// Faces with three different corners on one line, ascending.
pub(super) fn zero_area(mesh: &Mesh, topology: &Topology) -> Vec<FaceId> {
    let on_a_line = |&face: &FaceId| {
        let [a, b, c] = mesh.corners(face);
        collinear(a, b, c) && !topology.is_collapsed(face)
    };
    topology.faces().filter(on_a_line).collect()
}

/// A face with the same three vertices as an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Duplicate {
    pub(super) extra: FaceId,
    /// The first face with these vertices.
    pub(super) original: FaceId,
    pub(super) same_winding: bool,
}

/// Duplicates, ascending by the extra face. Linear time for edges of few faces.
///
/// Every face is visited once, at the edge of its two lower-numbered vertices. Faces with the same third
/// vertex there are duplicates; their directions along the edge give the winding.
pub(super) fn duplicates(topology: &Topology) -> Vec<Duplicate> {
    let mut found = Vec::new();
    let mut apexes = Vec::new();
    for edge in topology.edges().filter(|&edge| topology.valence(edge) > 1) {
        let apex = |half_edge| topology.tail(topology.prev(half_edge));
        let mut half_edges = topology.half_edges(edge);
        if let (2, Some(a), Some(b)) = (half_edges.len(), half_edges.next(), half_edges.next())
            && apex(a) != apex(b)
        {
            continue; // nearly every edge of nearly every mesh
        }
        let larger = topology.vertices(edge)[1];
        apexes.clear();
        let uses = topology.half_edges(edge).zip(topology.uses(edge));
        apexes.extend(uses.map(|(half_edge, (face, direction))| (apex(half_edge), face, direction)));
        apexes.retain(|entry| entry.0 > larger);
        apexes.sort_unstable();
        for same in apexes.chunk_by(|a, b| a.0 == b.0) {
            let (_, original, direction) = same[0];
            found.extend(same[1..].iter().map(|&(_, extra, other)| Duplicate {
                extra,
                original,
                same_winding: other == direction,
            }));
        }
    }
    found.sort_unstable();
    found
}
