//! A loop to triangles.

use super::ears::by_ears;
use super::least_area::least_area;
use crate::geom::polygon::{Cutter, Quad};
use crate::geom::predicate::{collinear, orient3d};
use crate::mesh::{Mesh, VertexId};
use crate::topology::Topology;

/// Corners of a loop up to which the least area is sought: 10 million triangles are weighed.
const MOST_CORNERS: usize = 400;
/// Triangles that are weighed for all loops together: some seconds. Loops after that are cut by ears.
const MOST_WEIGHED: u64 = 1 << 28;

/// Cuts one loop after the other.
pub(super) struct Triangulator<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    cutter: Cutter,
    /// How many more triangles may be weighed.
    weighed: u64,
}

impl<'a> Triangulator<'a> {
    pub(super) fn new(mesh: &'a Mesh, topology: &'a Topology) -> Self {
        Self { mesh, topology, cutter: Cutter::default(), weighed: MOST_WEIGHED }
    }

    /// The faces that close the loop, two fewer than it has corners, in its winding.
    pub(super) fn cut(&mut self, ring: &[u32]) -> Vec<[u32; 3]> {
        if let &[a, b, c] = ring {
            return vec![[a, b, c]];
        }
        if let Some(flat) = self.cut_flat(ring) {
            return flat;
        }
        let n = ring.len() as u64;
        let weighed = n * n * n / 6;
        let points: Vec<[f32; 3]> = ring.iter().map(|&vertex| self.at(vertex)).collect();
        let few = ring.len() <= MOST_CORNERS && weighed <= self.weighed;
        self.weighed -= if few { weighed } else { 0 };
        let in_use = |i: usize, j: usize| self.is_edge(ring[i], ring[j]);
        let faces = if few { least_area(&points, in_use) } else { by_ears(&points, in_use) };
        faces.into_iter().map(|corners| corners.map(|corner| ring[corner])).collect()
    }

    fn at(&self, vertex: u32) -> [f32; 3] {
        self.mesh.positions()[vertex as usize]
    }

    fn is_edge(&self, a: u32, b: u32) -> bool {
        self.topology.edge_between(VertexId(a), VertexId(b)).is_some()
    }

    /// The triangles of a loop that lies in a plane exactly and does not cross itself, if all of them have
    /// area and no diagonal is an edge already.
    fn cut_flat(&mut self, ring: &[u32]) -> Option<Vec<[u32; 3]>> {
        let mesh = self.mesh;
        let at = |vertex: u32| mesh.positions()[vertex as usize];
        let (a, b) = (at(ring[0]), at(ring[1]));
        let c = ring[2..].iter().map(|&vertex| at(vertex)).find(|&c| !collinear(a, b, c))?;
        if ring[2..].iter().any(|&vertex| !orient3d(a, b, c, at(vertex)).is_zero()) {
            return None;
        }
        let mut triangles = vec![[0; 3]; ring.len() - 2];
        if let &[a, b, c, d] = ring {
            let quad = Quad::of([a, b, c, d].map(at));
            triangles.copy_from_slice(&if quad.from == 0 {
                [[a, b, c], [a, c, d]]
            } else {
                [[b, c, d], [b, d, a]]
            });
            if quad.crosses {
                return None;
            }
        } else {
            self.cutter.ring.clear();
            self.cutter.ring.extend_from_slice(ring);
            if !self.cutter.cut(mesh.positions(), &mut triangles) {
                return None;
            }
        }
        let has_area = |&[a, b, c]: &[u32; 3]| !collinear(at(a), at(b), at(c));
        (triangles.iter().all(has_area) && !self.uses_an_edge(ring, &triangles)).then_some(triangles)
    }

    /// Whether a diagonal of the triangles is an edge of the mesh.
    fn uses_an_edge(&self, ring: &[u32], triangles: &[[u32; 3]]) -> bool {
        let mut sides: Vec<[u32; 2]> =
            (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]).map(sorted).collect();
        sides.sort_unstable();
        let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]].map(sorted));
        let mut diagonals = edges.filter(|edge| sides.binary_search(edge).is_err());
        diagonals.any(|[a, b]| self.is_edge(a, b))
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
