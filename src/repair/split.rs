//! The step that takes fans apart.

use super::change::{ChangeKind, Step};
use super::index_map::IndexMap;
use super::radial;
use crate::mesh::{HalfEdgeId, Mesh, MeshError};
use crate::topology::{Components, Topology};

/// Gives each fan of faces at a vertex a vertex of its own, so that no edge has more than two faces.
///
/// At an edge with more, faces that bound solid between them stay together: exact, by the order of their
/// angles. A face that finds no partner there gets an open edge. The first fan keeps the vertex; the others
/// get new ones, at the end of the list, at the same position. Any later weld of equal positions undoes that.
///
/// Guarantee: faces keep their number, order and winding, and corners their positions, bit for bit. Where two
/// sheets touch along an edge and are one fan at both of its ends, the edge stays as it is, and the step says
/// so ([`ChangeKind::EdgeLeft`]).
///
/// ```
/// use umbrage::{repair, testing::shapes, topology::Topology};
/// let (mesh, step) = repair::split(shapes::cubes_sharing_edge())?;
/// assert!(step.count == 2 && Topology::of(&mesh).edge_counts().watertight());
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
///
/// # Errors
///
/// [`MeshError::TooLarge`] if there are more vertices than 32-bit ids.
pub fn split(mesh: Mesh) -> Result<(Mesh, Step), MeshError> {
    let mut step = Step::new("split");
    let topology = Topology::of(&mesh);
    if topology.edge_counts().non_manifold == 0 && topology.non_manifold_vertices().is_empty() {
        return Ok((mesh, step));
    }
    let mut fans = fans(&mesh, &topology);
    // The vertex of each fan, by its leading corner.
    let mut vertex_of = vec![u32::MAX; 3 * mesh.face_count()];
    let mut is_taken = vec![false; mesh.vertex_count()];
    let mut copied: Vec<u32> = Vec::new();
    let mut triangles = mesh.triangles().to_vec();
    for (corner, old) in (0..).zip(mesh.triangles().as_flattened()) {
        if topology.is_collapsed(topology.face(HalfEdgeId(corner))) {
            continue; // it has no edges, and so no fan
        }
        let fan = fans.find(corner) as usize;
        if vertex_of[fan] == u32::MAX {
            vertex_of[fan] = *old;
            if std::mem::replace(&mut is_taken[*old as usize], true) {
                vertex_of[fan] = (mesh.vertex_count() + copied.len()) as u32; // checked below
                copied.push(*old);
                let at = mesh.positions()[*old as usize];
                step.add(ChangeKind::VertexSplit, Some(*old), Some(vertex_of[fan]), at);
            }
        }
        triangles.as_flattened_mut()[corner as usize] = vertex_of[fan];
    }
    if !copied.is_empty() {
        let old_of: Vec<u32> = (0..mesh.vertex_count() as u32).chain(copied.iter().copied()).collect();
        step.vertices = Some(IndexMap::backward(&old_of, mesh.vertex_count()));
    }
    let mesh = with_copies(mesh, &copied, triangles)?;
    let topology = Topology::of(&mesh);
    for edge in topology.edges().filter(|&edge| topology.valence(edge) > 2) {
        let [a, _] = topology.vertices(edge);
        step.add(ChangeKind::EdgeLeft, None, None, mesh.positions()[a.index()]);
    }
    Ok((mesh, step))
}

/// The corners of all faces, joined where faces stay together at an edge.
fn fans(mesh: &Mesh, topology: &Topology) -> Components {
    let mut fans = Components::new(3 * topology.face_count());
    let mut join = |[one, other]: [HalfEdgeId; 2]| {
        let [mut from, mut to] = [other, topology.next(other)];
        if topology.tail(one) != topology.tail(other) {
            (from, to) = (to, from);
        }
        fans.join(one.0, from.0);
        fans.join(topology.next(one).0, to.0);
    };
    for edge in topology.edges() {
        let mut half_edges = topology.half_edges(edge);
        match (half_edges.len(), half_edges.next(), half_edges.next()) {
            (2, Some(one), Some(other)) => join([one, other]),
            (3.., ..) => radial::pairs(mesh, topology, edge).into_iter().for_each(&mut join),
            _ => {}
        }
    }
    fans
}

/// The mesh with copies of some of its vertices at the end, and other faces in the old ones' stead.
fn with_copies(mesh: Mesh, copied: &[u32], triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
    let (name, origins) = (mesh.name.clone(), mesh.origins().cloned());
    let skin = mesh.skin().map(|skin| {
        let copies = copied.iter().map(|&vertex| skin[vertex as usize]);
        skin.iter().copied().chain(copies).collect::<Vec<_>>()
    });
    let (mut positions, _, parts, mut frames) = mesh.into_parts();
    for frame in frames.iter_mut().chain([&mut positions]) {
        let copies: Vec<[f32; 3]> = copied.iter().map(|&vertex| frame[vertex as usize]).collect();
        frame.extend(copies);
    }
    let mesh = Mesh::new(positions, triangles)?.with_name(name).with_parts(parts);
    mesh.with_origins_of(origins).with_skin(skin.map(Into::into)).with_frames(frames)
}

#[cfg(test)]
mod tests {
    use super::super::test_support::corners;
    use super::*;
    use crate::mesh::Weld;
    use crate::testing::shapes;

    #[test]
    fn split_leaves_every_corner_and_no_fan_beside_another() {
        let three = Mesh::concat(&[
            shapes::cuboid([0.0; 3], [1.0; 3]),
            shapes::cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]),
            shapes::cuboid([1.0, 1.0, 1.0], [2.0, 2.0, 2.0]),
        ]);
        let three = super::super::weld(three.unwrap(), Weld::Exact).0;
        for (mesh, new) in [
            (shapes::cubes_sharing_edge(), Some(2)),
            (shapes::cubes_sharing_vertex(), Some(1)),
            (shapes::book(5), Some(8)),
            (shapes::torus(6, 5, 2.0, 0.5), Some(0)),
            (three, None),
        ] {
            let (found, step) = split(mesh.clone()).unwrap();
            assert_eq!(corners(&found), corners(&mesh), "{}", mesh.name);
            assert!(new.is_none_or(|new| step.count == new), "{}: {}", mesh.name, step.count);
            let topology = Topology::of(&found);
            assert!(topology.non_manifold_vertices().is_empty() && topology.edge_counts().non_manifold == 0);
            // What was balanced is watertight now.
            let before = Topology::of(&mesh).edge_counts();
            assert_eq!(topology.edge_counts().watertight(), before.balanced, "{}", mesh.name);
            // A weld undoes it.
            let welded = super::super::weld(found, Weld::Exact).0;
            assert_eq!(welded.vertex_count(), mesh.vertex_count());
            assert_eq!(Topology::of(&welded).edge_counts().non_manifold, before.non_manifold);
        }
    }

    /// An hourglass, open at both ends, whose waist is the edge between its first two vertices: faces there
    /// are in two pairs, those above and those below, or those in front and those behind.
    fn hourglass() -> Mesh {
        let ring = |z: f32| [[-1.5, 0.0, z], [0.0, 1.0, z], [1.5, 0.0, z], [0.0, -1.0, z]];
        let positions = [&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], &ring(1.0)[..], &ring(-1.0)].concat();
        let [p, q, a, b, c, d, e, f, g, h] = std::array::from_fn(|vertex| vertex as u32);
        let above = [[p, q, b], [p, b, a], [q, c, b], [q, p, d], [q, d, c], [p, a, d]];
        let below = [[q, p, f], [f, p, e], [g, q, f], [p, q, h], [h, q, g], [e, p, h]];
        Mesh::new(positions, [above, below].concat()).unwrap()
    }

    #[test]
    fn split_leaves_an_edge_whose_fans_are_one_at_both_ends() {
        // Solid outside the hourglass keeps its two halves together.
        let (mesh, step) = split(hourglass()).unwrap();
        assert_eq!((mesh.vertex_count(), step.count, step.left), (10, 0, 1));
        assert_eq!(step.changes[0].kind, ChangeKind::EdgeLeft);
        // Solid inside parts there.
        let (mesh, step) = split(shapes::inside_out(&hourglass())).unwrap();
        assert_eq!((mesh.vertex_count(), step.count, step.left), (12, 2, 0));
        assert_eq!(Topology::of(&mesh).shells().count, 2);
    }
}
