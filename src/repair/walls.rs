//! Pairs of opposite faces that are walls inside a closed solid.

use super::duplicates::Same;
use crate::geom::predicate::{Sign, side_of_point};
use crate::mesh::{EdgeId, FaceId, Mesh, VertexId};
use crate::topology::{Components, Topology};

/// For each of the pairs `alone`, whether it is part of a wall inside a closed solid.
///
/// Pairs that meet at an edge without other faces are one wall. A wall lies inside if it has a rim, if the
/// faces at its rim belong to closed shells once all pairs are left out, and if at each edge of the rim these
/// are two faces and the wall leaves between them behind both: signs are exact, and a wall that touches a
/// face is not inside. `sets` are all sets of faces with the same vertices.
pub(super) fn inner_walls(mesh: &Mesh, sets: &[Same], alone: &[[u32; 2]]) -> Vec<bool> {
    if alone.is_empty() {
        return Vec::new();
    }
    // All other faces, each set of copies once.
    let mut left_out: Vec<u32> = sets.iter().flat_map(Same::faces).collect();
    left_out.sort_unstable();
    let mut once: Vec<u32> = sets.iter().filter_map(Same::surplus).collect();
    once.sort_unstable();
    left_out.retain(|face| once.binary_search(face).is_err());
    let others = (0..mesh.face_count() as u32).filter(|face| left_out.binary_search(face).is_err());
    let others: Vec<[u32; 3]> = others.map(|face| mesh.triangles()[face as usize]).collect();
    let rest = Rest::of(mesh, Topology::build(mesh.vertex_count(), others));

    let mut walls = Components::new(alone.len());
    let mut inside = vec![true; alone.len()];
    let mut has_rim = vec![false; alone.len()];
    // The edges of the pairs, each with its pair.
    let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * alone.len());
    for (pair, &[face, _]) in (0..).zip(alone) {
        let [a, b, c] = mesh.triangles()[face as usize];
        edges.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], pair)));
    }
    edges.sort_unstable();
    for at_edge in edges.chunk_by(|a, b| a.0 == b.0) {
        let [a, b] = at_edge[0].0;
        let edge = rest.topology.edge_between(VertexId(a), VertexId(b));
        match edge {
            None => {
                // A free edge of a single pair is that of a sheet.
                inside[at_edge[0].1 as usize] &= at_edge.len() > 1;
                at_edge[1..].iter().for_each(|&(_, pair)| _ = walls.join(at_edge[0].1, pair));
            }
            Some(edge) => {
                for &(_, pair) in at_edge {
                    let apex = mesh.triangles()[alone[pair as usize][0] as usize]
                        .into_iter()
                        .find(|&vertex| vertex != a && vertex != b);
                    has_rim[pair as usize] = true;
                    inside[pair as usize] &= apex.is_some_and(|apex| rest.encloses(edge, apex));
                }
            }
        }
    }
    let (mut all_inside, mut any_rim) = (vec![true; alone.len()], vec![false; alone.len()]);
    for pair in 0..alone.len() {
        let wall = walls.find(pair as u32) as usize;
        all_inside[wall] &= inside[pair];
        any_rim[wall] |= has_rim[pair];
    }
    let mut is_inner = |pair: usize| {
        let wall = walls.find(pair as u32) as usize;
        all_inside[wall] && any_rim[wall]
    };
    (0..alone.len()).map(|pair| is_inner(pair)).collect()
}

/// The mesh without the pairs.
struct Rest<'a> {
    mesh: &'a Mesh,
    topology: Topology,
    shell_of: Vec<Option<u32>>,
    /// Whether each shell has as many faces along each edge as against it.
    closed: Vec<bool>,
}

impl<'a> Rest<'a> {
    fn of(mesh: &'a Mesh, topology: Topology) -> Self {
        let shells = topology.shells();
        let mut closed = vec![true; shells.count];
        for edge in topology.edges() {
            let sum: i32 = topology.uses(edge).map(|(_, direction)| direction).sum();
            let face = topology.uses(edge).next().map(|(face, _)| face);
            if let Some(shell) = face.and_then(|face| shells.of_face[face.index()]) {
                closed[shell as usize] &= sum == 0;
            }
        }
        Self { mesh, topology, shell_of: shells.of_face, closed }
    }

    /// Whether a face between `edge` and `apex` leaves the edge inside the solid there.
    fn encloses(&self, edge: EdgeId, apex: u32) -> bool {
        let uses: Vec<(FaceId, i32)> = self.topology.uses(edge).collect();
        let (&[(f, 1), (g, -1)] | &[(g, -1), (f, 1)]) = &uses[..] else { return false };
        let closed =
            |face: FaceId| self.shell_of[face.index()].is_some_and(|shell| self.closed[shell as usize]);
        let at = |vertex: u32| self.mesh.positions()[vertex as usize];
        let corners = |face: FaceId| self.topology.triangles()[face.index()];
        let ends = self.topology.vertices(edge).map(|vertex| vertex.0);
        let other = corners(g).into_iter().find(|vertex| !ends.contains(vertex));
        let (Some(other), true) = (other, closed(f)) else { return false };
        let behind = |face: FaceId| side_of_point(corners(face).map(at), at(apex)) == Sign::Negative;
        // Where the solid is wider than half a turn, it is enough to be behind one of them.
        match side_of_point(corners(f).map(at), at(other)) {
            Sign::Positive => behind(f) || behind(g),
            Sign::Negative | Sign::Zero => behind(f) && behind(g),
        }
    }
}
