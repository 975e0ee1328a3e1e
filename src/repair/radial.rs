//! The faces around an edge in the order of their angle, and which of them enclose the solid together.

use std::cmp::Ordering;

use crate::geom::predicate::{Sign, collinear, side_of_point, turn};
use crate::mesh::{EdgeId, HalfEdgeId, Mesh};
use crate::topology::Topology;

/// A face at the edge.
#[derive(Clone, Copy)]
struct Leaf {
    half_edge: HalfEdgeId,
    /// Whether it runs along the edge, from the lower vertex to the higher one.
    along: bool,
    apex: [f32; 3],
}

/// The faces at an edge in pairs, each of which bounds solid between its two: going round the edge, a face
/// that has its back ahead, and the next one that has its back behind, like brackets. So pairs do not cross
/// each other. Exact: only signs of determinants are used. A face that finds no partner is in no pair.
///
/// Faces in one half-plane enclose nothing. A face without area has no angle; it takes a partner that is left.
pub(super) fn pairs(mesh: &Mesh, topology: &Topology, edge: EdgeId) -> Vec<[HalfEdgeId; 2]> {
    let at = |vertex: crate::mesh::VertexId| mesh.positions()[vertex.index()];
    let [a, b] = topology.vertices(edge).map(at);
    let leaves = topology.half_edges(edge).zip(topology.uses(edge)).map(|(half_edge, (_, direction))| Leaf {
        half_edge,
        along: direction > 0,
        apex: at(topology.tail(topology.prev(half_edge))),
    });
    let (flat, mut round): (Vec<Leaf>, Vec<Leaf>) = leaves.partition(|leaf| collinear(a, b, leaf.apex));
    if let Some(&first) = round.first() {
        let plane = Plane { a, b, first: first.apex };
        // Against the edge comes first: where two faces coincide, they enclose nothing rather than all.
        round.sort_by(|one, other| {
            plane
                .order(one.apex, other.apex)
                .then(one.along.cmp(&other.along))
                .then(one.half_edge.cmp(&other.half_edge))
        });
    }
    // A face that runs along the edge has its front ahead, so that it closes what one against it opened.
    let (mut open, mut early, mut pairs) = (Vec::new(), Vec::new(), Vec::new());
    for leaf in round {
        if !leaf.along {
            open.push(leaf.half_edge);
        } else if let Some(opener) = open.pop() {
            pairs.push([opener, leaf.half_edge]);
        } else {
            early.push(leaf.half_edge);
        }
    }
    // What is open at the end is closed past the start.
    early.reverse();
    while let (Some(&opener), Some(&closer)) = (open.last(), early.last()) {
        pairs.push([opener, closer]);
        open.pop();
        early.pop();
    }
    let (along, against): (Vec<Leaf>, Vec<Leaf>) = flat.into_iter().partition(|leaf| leaf.along);
    early.extend(along.iter().map(|leaf| leaf.half_edge));
    open.extend(against.iter().map(|leaf| leaf.half_edge));
    pairs.extend(open.into_iter().zip(early).map(|(opener, closer)| [opener, closer]));
    pairs
}

/// Half-planes at the line from `a` to `b`, by their angle from the one through `first`, counter-clockwise as
/// seen from `b`.
struct Plane {
    a: [f32; 3],
    b: [f32; 3],
    first: [f32; 3],
}

impl Plane {
    /// The angle in quarters: 0 none, 1 below half a turn, 2 half a turn, 3 above.
    fn quarter(&self, apex: [f32; 3]) -> u8 {
        match side_of_point([self.a, self.b, self.first], apex) {
            Sign::Positive => 1,
            Sign::Negative => 3,
            Sign::Zero => {
                let seen = |point, axis| turn(self.a, self.b, point, axis);
                let axis = (0..3).find(|&axis| !seen(self.first, axis).is_zero()).unwrap_or(0);
                if seen(self.first, axis) == seen(apex, axis) { 0 } else { 2 }
            }
        }
    }

    fn order(&self, p: [f32; 3], q: [f32; 3]) -> Ordering {
        let (one, other) = (self.quarter(p), self.quarter(q));
        one.cmp(&other).then_with(|| match one {
            0 | 2 => Ordering::Equal,
            _ => side_of_point([self.a, self.b, q], p).cmp(&Sign::Zero),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexId;
    use crate::testing::shapes;

    /// Faces at the edge from (0, 0, 0) to (0, 0, 1), each at an angle in degrees, along it or against it.
    fn book(pages: &[(f64, bool)]) -> Mesh {
        let mut positions = vec![[0.0; 3], [0.0, 0.0, 1.0]];
        positions.extend(pages.iter().map(|(angle, _)| {
            let (y, x) = angle.to_radians().sin_cos();
            [x as f32, y as f32, 0.5]
        }));
        let page = |(index, &(_, along)): (u32, &(f64, bool))| {
            if along { [0, 1, index + 2] } else { [1, 0, index + 2] }
        };
        Mesh::new(positions, (0..).zip(pages).map(page).collect()).unwrap()
    }

    /// The pairs of faces, sorted.
    fn paired(mesh: &Mesh) -> Vec<[u32; 2]> {
        let topology = Topology::of(mesh);
        let edge = topology.edge_between(VertexId(0), VertexId(1)).unwrap();
        let mut pairs: Vec<[u32; 2]> = pairs(mesh, &topology, edge)
            .iter()
            .map(|pair| pair.map(|half_edge| topology.face(half_edge).0))
            .collect();
        pairs.sort_unstable();
        pairs
    }

    #[test]
    fn pairs_enclose_the_solid_whatever_the_first_face() {
        // Two wedges, from 10 to 50 and from 200 to 300 degrees, in every rotation of the list.
        let wedges = [(10.0, false), (50.0, true), (200.0, false), (300.0, true)];
        for turned in 0..4 {
            let mut pages = wedges.to_vec();
            pages.rotate_left(turned);
            let at = |angle: f64| pages.iter().position(|page| page.0 == angle).unwrap() as u32;
            let mut wanted = vec![[at(10.0), at(50.0)], [at(200.0), at(300.0)]];
            wanted.sort_unstable();
            assert_eq!(paired(&book(&pages)), wanted);
            // Fault injected: one face turned over pairs differently.
            pages[0].1 = !pages[0].1;
            assert_ne!(paired(&book(&pages)), wanted);
        }
    }

    #[test]
    fn pairs_nest_and_do_not_cross() {
        let nested = [(0.0, false), (30.0, false), (60.0, true), (90.0, true)];
        assert_eq!(paired(&book(&nested)), [[0, 3], [1, 2]]);
        // Past the start, opposite half-planes among them.
        let around = [(10.0, true), (190.0, true), (220.0, false), (350.0, false)];
        assert_eq!(paired(&book(&around)), [[2, 1], [3, 0]]);
        // A double-sided sheet pairs with itself, inside a wedge and outside.
        for angle in [30.0, 120.0] {
            let sheet = [(angle, true), (0.0, false), (angle, false), (90.0, true)];
            assert_eq!(paired(&book(&sheet)), [[1, 3], [2, 0]]);
        }
    }

    #[test]
    fn pairs_of_faces_in_one_direction_are_none() {
        assert_eq!(paired(&shapes::book(5)), [[0; 2]; 0]);
    }
}
