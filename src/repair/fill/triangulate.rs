//! A loop to triangles.

use super::clear::{Clear, clear};
use super::ears::by_ears;
use super::least_angle::least_angle;
use super::least_area::least_area;
use super::shape::normal;
use crate::geom::polygon::{Cutter, Quad};
use crate::geom::predicate::{collinear, orient3d};
use crate::mesh::{Mesh, VertexId};
use crate::topology::Topology;

/// Corners of a loop up to which the least area is sought: 10 million triangles are weighed.
const MOST_CORNERS: usize = 400;
/// Triangles that are weighed for all loops together: some seconds. Loops after that are cut by ears.
const MOST_WEIGHED: u64 = 1 << 28;

/// How a loop is cut. Each is tried where the patch of the one before it would meet other faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Exactly where the loop is flat, else so that the area is least; by ears where it is too long.
    LeastArea,
    /// So that it bends little.
    LeastAngle,
    /// By its shortest diagonals.
    Ears,
}

impl Method {
    pub(super) const ALL: [Self; 3] = [Self::LeastArea, Self::LeastAngle, Self::Ears];
}

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

    /// The faces that close the loop by a method, two fewer than it has corners, in its winding. `None` if
    /// the method gives those of one before it.
    pub(super) fn cut(&mut self, ring: &[u32], method: Method) -> Option<Vec<[u32; 3]>> {
        let first = method == Method::ALL[0];
        if let &[a, b, c] = ring {
            return first.then(|| vec![[a, b, c]]);
        }
        if first && let Some(flat) = self.cut_flat(ring) {
            return Some(flat);
        }
        let n = ring.len() as u64;
        let weighed = n * n * n / 6;
        let few = ring.len() <= MOST_CORNERS && weighed <= self.weighed;
        if method != Method::Ears && few {
            self.weighed -= weighed;
        }
        let points: Vec<[f32; 3]> = ring.iter().map(|&vertex| self.at(vertex)).collect();
        let in_use = |i: usize, j: usize| self.is_edge(ring[i], ring[j]);
        let faces = match method {
            Method::LeastArea if few => least_area(&points, in_use),
            Method::LeastAngle if few => least_angle(&points, &self.normals_around(ring), in_use),
            Method::LeastArea => by_ears(&points, in_use),
            // Too long for the others, it was cut by ears already.
            _ if !few => return None,
            _ => by_ears(&points, in_use),
        };
        Some(faces.into_iter().map(|corners| corners.map(|corner| ring[corner])).collect())
    }

    /// A patch that meets no face of `with`: the mesh with the patches found so far.
    pub(super) fn clear(&mut self, with: &Mesh, ring: &[u32]) -> Clear {
        if ring.len() > MOST_CORNERS {
            return Clear::NotFound;
        }
        let topology = self.topology;
        let in_use =
            |i: usize, j: usize| topology.edge_between(VertexId(ring[i]), VertexId(ring[j])).is_some();
        clear(with, ring, in_use, &mut self.weighed)
    }

    /// The normal of the face at each side of a loop.
    fn normals_around(&self, ring: &[u32]) -> Vec<[f64; 3]> {
        let side = |i: usize| {
            let edge = self.topology.edge_between(VertexId(ring[i]), VertexId(ring[(i + 1) % ring.len()]))?;
            let half_edge = self.topology.half_edges(edge).next()?;
            Some(normal(self.mesh.corners(self.topology.face(half_edge))))
        };
        (0..ring.len()).map(|i| side(i).unwrap_or([0.0; 3])).collect()
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
