//! The edges of a mesh as a list for other programs.

use super::Topology;
use crate::mesh::{FaceId, VertexId};

/// An edge, and the faces at it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ListedEdge {
    /// The vertex with the lower number.
    pub a: VertexId,
    /// The vertex with the higher number.
    pub b: VertexId,
    /// The faces at the edge, ascending; a face may be there twice.
    pub faces: Vec<FaceId>,
    /// The number of faces that run from `a` to `b`, minus the number of those that run from `b` to `a`: 0
    /// where they balance, ±1 at an open edge.
    pub multiplicity: i32,
}

impl Topology {
    /// Every edge with its faces, in ascending order of the vertices. Collapsed faces have no edges.
    ///
    /// ```
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// let topology = Topology::of(&shapes::tetrahedron());
    /// let edges: Vec<_> = topology.edge_list().collect();
    /// assert_eq!(edges.len(), 6);
    /// assert!(edges.iter().all(|edge| edge.faces.len() == 2 && edge.multiplicity == 0));
    /// ```
    pub fn edge_list(&self) -> impl ExactSizeIterator<Item = ListedEdge> + '_ {
        self.edges().map(|edge| {
            let [a, b] = self.vertices(edge);
            let faces: Vec<FaceId> = self.uses(edge).map(|(face, _)| face).collect();
            let multiplicity = self.uses(edge).map(|(_, sign)| sign).sum();
            ListedEdge { a, b, faces, multiplicity }
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::mesh::Mesh;
    use crate::random::SplitMix64;
    use crate::testing::shapes;

    type Edges = BTreeMap<[u32; 2], (Vec<u32>, i32)>;

    /// Face after face, from the triangles alone.
    fn naive(triangles: &[[u32; 3]]) -> Edges {
        let mut edges = Edges::new();
        for (face, &[a, b, c]) in (0..).zip(triangles) {
            if a == b || b == c || c == a {
                continue;
            }
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let (faces, multiplicity) = edges.entry([from.min(to), from.max(to)]).or_default();
                faces.push(face);
                *multiplicity += if from < to { 1 } else { -1 };
            }
        }
        edges
    }

    fn listed(mesh: &Mesh) -> Edges {
        let topology = Topology::of(mesh);
        let ids = |faces: Vec<FaceId>| faces.into_iter().map(|face| face.0).collect();
        topology
            .edge_list()
            .map(|edge| ([edge.a.0, edge.b.0], (ids(edge.faces), edge.multiplicity)))
            .collect()
    }

    #[test]
    fn edge_list_is_that_of_the_triangles_one_by_one() {
        let mut random = SplitMix64(12);
        let mut meshes =
            vec![shapes::open_cube(), shapes::book(5), shapes::mobius(9), shapes::double_sheet()];
        meshes.extend((0..100).map(|_| {
            let faces = (0..12).map(|_| [(); 3].map(|()| random.below(8) as u32)).collect();
            Mesh::new((0..8).map(|k| [k as f32, 0.0, 0.0]).collect(), faces).unwrap()
        }));
        let mut unbalanced = 0;
        for mesh in &meshes {
            let edges = listed(mesh);
            assert_eq!(edges, naive(mesh.triangles()), "{}", mesh.name);
            unbalanced +=
                edges.values().filter(|(faces, sum)| sum.unsigned_abs() as usize != faces.len() % 2).count();
            let order: Vec<[u32; 2]> =
                Topology::of(mesh).edge_list().map(|edge| [edge.a.0, edge.b.0]).collect();
            assert!(order.is_sorted());
        }
        assert!(unbalanced > 20, "{unbalanced}");
        // Fault injected: one face turned over.
        let (positions, mut triangles, ..) = shapes::cube().into_parts();
        triangles[3].swap(0, 1);
        let turned = Mesh::new(positions, triangles).unwrap();
        assert_ne!(listed(&turned), naive(shapes::cube().triangles()));
    }
}
