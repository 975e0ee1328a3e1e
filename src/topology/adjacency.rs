//! Index buffers of triangles with adjacency.

use super::Topology;
use crate::mesh::{EdgeId, HalfEdgeId};

impl Topology {
    /// Six vertices a face, as `GL_TRIANGLES_ADJACENCY` takes them: each corner, and after it the vertex
    /// across the edge that begins there, which is the third corner of the other face at that edge.
    ///
    /// Where there is no other face (an open edge, a collapsed face) it is the third corner of the face
    /// itself, so that the edge lies between a face and its own reverse: a silhouette from every side.
    ///
    /// # Errors
    ///
    /// The first edge with more than two faces: six vertices cannot name them. Split the mesh first.
    ///
    /// ```
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// let adjacency = Topology::of(&shapes::tetrahedron()).adjacency().expect("two faces an edge");
    /// let [a, over_ab, b, over_bc, c, over_ca] = adjacency[0];
    /// assert_eq!([over_ab, over_bc, over_ca], [6 - a - b - c; 3]); // the fourth vertex
    /// assert!(Topology::of(&shapes::book(3)).adjacency().is_err());
    /// ```
    pub fn adjacency(&self) -> Result<Vec<[u32; 6]>, EdgeId> {
        let third = |half_edge: HalfEdgeId| self.tail(self.prev(half_edge)).0;
        let own = |face: usize, corner: usize| third(HalfEdgeId::new(3 * face + corner));
        let mut adjacency: Vec<[u32; 6]> = (0..)
            .zip(self.triangles())
            .map(|(face, &[a, b, c])| [a, own(face, 0), b, own(face, 1), c, own(face, 2)])
            .collect();
        for edge in self.edges() {
            let mut half_edges = self.half_edges(edge);
            match (half_edges.len(), half_edges.next(), half_edges.next()) {
                (2, Some(one), Some(other)) => {
                    for (at, across) in [(one, other), (other, one)] {
                        adjacency[at.index() / 3][2 * (at.index() % 3) + 1] = third(across);
                    }
                }
                (3.., ..) => return Err(edge),
                _ => {}
            }
        }
        Ok(adjacency)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    /// By comparing each face with each.
    fn naive(triangles: &[[u32; 3]]) -> Vec<[u32; 6]> {
        let across = |face: usize, corner: usize| {
            let t = triangles[face];
            let ends = [t[corner], t[(corner + 1) % 3]];
            let others = triangles.iter().enumerate().filter(|&(other, _)| other != face);
            let mut with_both = others.filter(|(_, other)| ends.iter().all(|end| other.contains(end)));
            let third = |other: &[u32; 3]| *other.iter().find(|vertex| !ends.contains(vertex)).unwrap();
            with_both.next().map_or(t[(corner + 2) % 3], |(_, other)| third(other))
        };
        let row = |face: usize| {
            let t = triangles[face];
            [t[0], across(face, 0), t[1], across(face, 1), t[2], across(face, 2)]
        };
        (0..triangles.len()).map(row).collect()
    }

    #[test]
    fn adjacency_is_that_of_each_face_with_each() {
        for mesh in [
            shapes::cube(),
            shapes::open_cube(),
            shapes::torus(5, 4, 2.0, 0.5),
            shapes::mobius(7),
            shapes::misoriented_cube(),
            shapes::sheet(3),
        ] {
            let found = Topology::of(&mesh).adjacency().unwrap();
            assert_eq!(found, naive(mesh.triangles()), "{}", mesh.name);
            // Fault injected: one vertex across.
            let mut spoiled = found;
            spoiled[0][1] = spoiled[0][0];
            assert_ne!(spoiled, naive(mesh.triangles()));
        }
    }
}
