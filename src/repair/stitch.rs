//! The step that inserts vertices into the edges on which they lie.

use super::change::{ChangeKind, Step};
use super::index_map::IndexMap;
use super::rewrite::with_faces;
use crate::check::exact_t_junctions;
use crate::geom::predicate::collinear;
use crate::mesh::{EdgeId, HalfEdgeId, Mesh, MeshError, VertexId};
use crate::topology::Topology;

/// Rounds after which the rest is left: each one inserts into one edge of a face.
const ROUNDS: usize = 64;
/// Tests of each search, of a vertex against an edge; 256 more a face.
const TESTS: u64 = 1 << 24;
/// New faces at most, beyond one for each old one.
const NEW_FACES: usize = 1 << 20;

/// Cuts the faces at exact T-junctions: where a vertex of the boundary lies exactly on the boundary edge of a
/// face, the face becomes a fan around the corner opposite to that edge.
///
/// Guarantee: no position changes, no vertex is new, and the faces cover the same points as before with the
/// same windings. No face without area is made. A face without area is not cut.
///
/// Where more edges lie on each other than can be stitched in some seconds, the rest is left, and the step
/// says so ([`ChangeKind::TJunctionLeft`]).
///
/// ```
/// use umbrage::{repair, testing::shapes, topology::Topology};
/// let (mesh, step) = repair::stitch(shapes::t_junction())?;
/// assert!(step.count == 1 && Topology::of(&mesh).edge_counts().watertight());
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
///
/// # Errors
///
/// [`MeshError::TooLarge`] if there are more faces than [`MAX_TRIANGLES`](crate::mesh::MAX_TRIANGLES).
pub fn stitch(mut mesh: Mesh) -> Result<(Mesh, Step), MeshError> {
    let mut step = Step::new("stitch");
    let most = 2 * mesh.face_count() + NEW_FACES;
    // The face before the step of each face.
    let old_faces = mesh.face_count();
    let mut old_of: Vec<u32> = (0..old_faces as u32).collect();
    for round in 0.. {
        let topology = Topology::of(&mesh);
        let tests = TESTS + 256 * mesh.face_count() as u64;
        let (found, complete) = exact_t_junctions(&mesh, &topology, tests);
        let cuts = cuts(&mesh, &topology, found);
        let inserted: usize = cuts.iter().map(|cut| cut.vertices.len()).sum();
        if round == ROUNDS || mesh.face_count() + inserted > most || !complete {
            for vertex in cuts.iter().flat_map(|cut| &cut.vertices) {
                let at = mesh.positions()[vertex.index()];
                step.add(ChangeKind::TJunctionLeft, Some(vertex.0), Some(vertex.0), at);
            }
            break;
        }
        if cuts.is_empty() {
            break;
        }
        let (mut triangles, mut from) = (Vec::with_capacity(mesh.face_count() + inserted), Vec::new());
        let mut next = cuts.iter().peekable();
        for (face, &corners) in (0..).zip(mesh.triangles()) {
            let before = triangles.len();
            match next.next_if(|cut| cut.face == face) {
                None => triangles.push(corners),
                Some(cut) => {
                    for vertex in &cut.vertices {
                        let at = mesh.positions()[vertex.index()];
                        step.add(ChangeKind::FaceCut, Some(old_of[face as usize]), Some(vertex.0), at);
                    }
                    cut.fan(&topology, &mut triangles);
                }
            }
            from.resize(from.len() + triangles.len() - before, face);
        }
        old_of = from.iter().map(|&face| old_of[face as usize]).collect();
        mesh = with_faces(mesh, triangles, &from)?;
    }
    if step.count > 0 {
        step.faces = Some(IndexMap::backward(&old_of, old_faces));
    }
    Ok((mesh, step))
}

/// A face, and the vertices that lie on one of its edges.
struct Cut {
    face: u32,
    half_edge: HalfEdgeId,
    /// In their order along the half-edge.
    vertices: Vec<VertexId>,
}

impl Cut {
    fn fan(&self, topology: &Topology, triangles: &mut Vec<[u32; 3]>) {
        let apex = topology.tail(topology.prev(self.half_edge)).0;
        let mut from = topology.tail(self.half_edge).0;
        for to in self.vertices.iter().copied().chain([topology.head(self.half_edge)]) {
            triangles.push([from, to.0, apex]);
            from = to.0;
        }
    }
}

/// What can be cut now, ascending by the face: one edge of each face that has area.
fn cuts(mesh: &Mesh, topology: &Topology, found: Vec<(VertexId, EdgeId)>) -> Vec<Cut> {
    let mut by_edge: Vec<(EdgeId, VertexId)> = found.into_iter().map(|(v, edge)| (edge, v)).collect();
    by_edge.sort_unstable();
    let mut cuts: Vec<Cut> = Vec::new();
    for on_edge in by_edge.chunk_by(|a, b| a.0 == b.0) {
        let Some(half_edge) = topology.half_edges(on_edge[0].0).next() else { continue };
        let face = topology.face(half_edge);
        let [a, b, c] = mesh.corners(face);
        if collinear(a, b, c) {
            continue;
        }
        let [tail, head] = [topology.tail(half_edge), topology.head(half_edge)];
        let at = |vertex: VertexId| mesh.positions()[vertex.index()];
        // Points of a line come in the order of any coordinate that changes along it.
        let Some(axis) = (0..3).find(|&axis| at(tail)[axis] != at(head)[axis]) else { continue };
        let mut vertices: Vec<VertexId> = on_edge.iter().map(|&(_, vertex)| vertex).collect();
        vertices.sort_by(|&p, &q| at(p)[axis].total_cmp(&at(q)[axis]).then(p.cmp(&q)));
        // Of several vertices at one point, the first; a face without area would lie between them.
        vertices.dedup_by(|q, p| at(*p) == at(*q));
        if at(tail)[axis] > at(head)[axis] {
            vertices.reverse();
        }
        cuts.push(Cut { face: face.0, half_edge, vertices });
    }
    cuts.sort_by_key(|cut| cut.face);
    cuts.dedup_by_key(|cut| cut.face);
    cuts
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{bits, boundary_chain};
    use super::*;
    use crate::check::CrackReport;
    use crate::testing::shapes;

    /// A unit square in two triangles, beside another in strips that end on its side: `n` T-junctions.
    fn strips(n: u32) -> Mesh {
        let mut positions = vec![[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [-1.0, 8.0, 0.0], [0.0, 8.0, 0.0]];
        let mut triangles = vec![[0, 3, 1], [1, 3, 2]];
        let step = 8.0 / (n + 1) as f32;
        let mut at = |k: u32, x: f32| {
            positions.push([x, step * k as f32, 0.0]);
            positions.len() as u32 - 1
        };
        for k in 0..=n {
            let [a, b, c, d] = [at(k, 0.0), at(k, 1.0), at(k + 1, 1.0), at(k + 1, 0.0)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        let mesh = Mesh::new(positions, triangles).unwrap();
        super::super::weld(mesh, crate::mesh::Weld::Exact).0
    }

    #[test]
    fn stitched_edges_are_shared_and_nothing_else_changes() {
        for n in [1, 3, 7] {
            let before = strips(n);
            let (mesh, step) = stitch(before.clone()).unwrap();
            assert_eq!((step.count, step.left), (n as usize, 0));
            assert_eq!(mesh.face_count(), before.face_count() + n as usize);
            assert_eq!(bits(&mesh), bits(&before));
            let report = CrackReport::of(&mesh, &Topology::of(&mesh));
            assert_eq!((report.counts.t_junctions, report.counts.zero_area_faces), (0, 0));
            // The border that is left is the outer one: two long sides, one of them in n + 1 pieces, and two
            // short ones on each end.
            assert_eq!(report.counts.boundary_edges, 1 + (n as usize + 1) + 4);
            assert_eq!(report.counts.misoriented_edges, 0);
            // Fault injected: without the last of the new faces an edge is open.
            let fewer: Vec<u32> = (0..mesh.face_count() as u32 - 1).collect();
            let fewer = super::super::rewrite::keep_faces(mesh.clone(), &fewer);
            assert_ne!(boundary_chain(&fewer), boundary_chain(&mesh));
        }
    }

    #[test]
    fn stitch_cuts_all_three_edges_of_a_face_and_leaves_a_face_without_area() {
        // A triangle in a hole whose three sides are in two pieces each, as of a subdivided neighbor.
        let positions = vec![
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
            [0.0, 4.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
            [2.0, -2.0, 0.0],
            [4.0, 4.0, 0.0],
            [-2.0, 2.0, 0.0],
        ];
        let fins = [[3, 0, 6], [1, 3, 6], [4, 1, 7], [2, 4, 7], [5, 2, 8], [0, 5, 8]];
        let mesh = Mesh::new(positions, [&[[0, 1, 2]], &fins[..]].concat()).unwrap();
        let (stitched, step) = stitch(mesh.clone()).unwrap();
        assert_eq!((step.count, stitched.face_count()), (3, 4 + 6));
        assert!(step.changes.iter().all(|change| change.old == Some(0)));
        let counts = Topology::of(&stitched).edge_counts();
        assert_eq!((counts.boundary, counts.non_manifold, counts.misoriented), (6, 0, 0));
        let (same, step) = stitch(shapes::collinear_face()).unwrap();
        assert_eq!((step.count, same.face_count()), (0, 14));
    }

    #[test]
    fn stitch_of_edges_all_on_a_line_ends() {
        let corner = |k: u32| [[k as f32, 0.0, 0.0], [(k + 150) as f32, 0.0, 0.0], [k as f32, 1.0, k as f32]];
        let positions: Vec<_> = (0..50).flat_map(corner).collect();
        let triangles = (0..50).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let mesh = Mesh::new(positions, triangles).unwrap();
        let (stitched, step) = stitch(mesh).unwrap();
        assert!(step.count > 50 && stitched.face_count() < 1 << 20);
    }
}
