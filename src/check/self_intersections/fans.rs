//! Faces around a vertex or an edge that has very many: each pair of them overlaps in its boxes, so that they
//! are compared by direction instead.
//!
//! Two triangles with a common corner have a point in common besides it exactly if they have a direction from
//! it in common, since a triangle holds the beginning of each ray from a corner between its sides. So the
//! boxes of the arcs that faces cut out of a small sphere find the pairs.
//!
//! Two triangles on a common edge meet beyond it exactly if they lie in the same half-plane of it: sorting
//! them around the edge finds the pairs.

use std::cmp::{Ordering, Reverse};

use super::triangles::{Corners, Point, folded};
use crate::geom::Aabb;
use crate::geom::predicate::{Sign, orient3d};

/// Faces around a vertex, or an edge, above which they are compared by direction.
const MANY: usize = 48;

/// Faces with a common vertex or edge, as indices into a list of faces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Fan {
    /// The vertex, and its faces.
    Vertex(u32, Vec<u32>),
    /// The ends of the edge, and its faces.
    Edge([u32; 2], Vec<u32>),
}

impl Fan {
    pub(super) fn faces(&self) -> &[u32] {
        let (Self::Vertex(_, faces) | Self::Edge(_, faces)) = self;
        faces
    }
}

/// Fans of more than [`MANY`] among some faces, no face in two of them.
pub(super) fn fans(faces: &[u32], corners: &dyn Fn(u32) -> Corners) -> Vec<Fan> {
    if faces.len() <= MANY {
        return Vec::new();
    }
    let hubs = hubs(faces.len(), &|| faces.iter().flat_map(|&face| corners(face).ids));
    if hubs.is_empty() {
        return Vec::new();
    }
    let count = |id: u32| hubs.binary_search_by_key(&id, |hub| hub.0).ok().map(|at| hubs[at].1);
    // Each face goes to its vertex with most faces.
    let mut members: Vec<(u32, u32)> = Vec::new();
    for &face in faces {
        let ids = corners(face).ids.into_iter();
        let best = ids.filter_map(|id| Some((count(id)?, Reverse(id)))).max();
        members.extend(best.map(|(_, Reverse(hub))| (hub, face)));
    }
    members.sort_unstable();
    let mut found = Vec::new();
    for group in members.chunk_by(|a, b| a.0 == b.0) {
        let hub = group[0].0;
        // Edges of the vertex by their other end: those with many faces are fans of their own.
        let mut spokes: Vec<(u32, u32)> = Vec::with_capacity(2 * group.len());
        for &(_, face) in group {
            spokes.extend(corners(face).ids.into_iter().filter(|&id| id != hub).map(|id| (id, face)));
        }
        spokes.sort_unstable();
        let mut pages: Vec<u32> = Vec::new();
        for spoke in spokes.chunk_by(|a, b| a.0 == b.0).filter(|spoke| spoke.len() > MANY) {
            let free = |face: &u32| pages.binary_search(face).is_err();
            let free: Vec<u32> = spoke.iter().map(|spoke| spoke.1).filter(free).collect();
            pages.extend(&free);
            pages.sort_unstable();
            found.push(Fan::Edge([hub, spoke[0].0], free));
        }
        let rest = group.iter().map(|entry| entry.1).filter(|face| pages.binary_search(face).is_err());
        found.push(Fan::Vertex(hub, rest.collect()));
    }
    found.retain(|fan| fan.faces().len() > 1);
    found
}

/// Vertices with many faces, ascending, and their numbers of faces.
fn hubs<I: Iterator<Item = u32>>(faces: usize, ids: &dyn Fn() -> I) -> Vec<(u32, u32)> {
    let low = ids().min().unwrap_or(0);
    let range = (ids().max().unwrap_or(0) - low) as usize + 1;
    // A small part of a large mesh must not cost as much as the whole.
    if range > 16 * faces {
        let mut sorted: Vec<u32> = ids().collect();
        sorted.sort_unstable();
        let runs = sorted.chunk_by(|a, b| a == b).filter(|run| run.len() > MANY);
        return runs.map(|run| (run[0], run.len() as u32)).collect();
    }
    let mut counts = vec![0_u32; range];
    ids().for_each(|id| counts[(id - low) as usize] += 1);
    (low..).zip(counts).filter(|&(_, count)| count as usize > MANY).collect()
}

/// A box around the arc that a face with the corner `hub` cuts out of the unit sphere around it.
///
/// With u = 2⁻⁵³: a component of a unit vector errs by 6 u of itself at most (a rounded difference, a rounded
/// length, a quotient), far less than the next `f32` is away. An arc of less than half a turn leaves its
/// chord by 1 − cos θ ≤ sin² θ, a quarter of the chord squared; half of it covers the rounding of the chord.
pub(super) fn arc_box(face: &Corners, hub: u32) -> Aabb {
    let at = face.ids.iter().position(|&id| id == hub).unwrap_or(0);
    let [center, a, b] = face.from(at);
    let (a, b) = (direction(center, a), direction(center, b));
    let chord: f64 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
    let bulge = 0.5 * chord;
    Aabb {
        low: std::array::from_fn(|i| ((a[i].min(b[i]) - bulge) as f32).next_down().next_down()),
        high: std::array::from_fn(|i| ((a[i].max(b[i]) + bulge) as f32).next_up().next_up()),
    }
}

fn direction(from: Point, to: Point) -> [f64; 3] {
    let v: [f64; 3] = std::array::from_fn(|i| f64::from(to[i]) - f64::from(from[i]));
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| x / length)
}

/// Runs of faces in the same half-plane of an edge, each of two faces at least.
pub(super) fn same_half_planes(
    edge: [u32; 2],
    faces: &[u32],
    corners: &dyn Fn(u32) -> Corners,
) -> Vec<Vec<u32>> {
    let of = |&face: &u32| {
        let face = corners(face);
        let at = |id| face.ids.iter().position(|&other| other == id).unwrap_or(0);
        let [i, j] = edge.map(at);
        [face.at[i], face.at[j], face.at[3 - i - j]]
    };
    let Some(first) = faces.first() else { return Vec::new() };
    let [a, b, zero] = of(first);
    // The quarter of the turn from the first face on: in its half-plane, beyond it, opposite, before it.
    let quarter = |p: Point| match orient3d(a, b, zero, p) {
        Sign::Zero if folded(a, b, zero, p) => 0,
        Sign::Positive => 1,
        Sign::Zero => 2,
        Sign::Negative => 3,
    };
    let mut around: Vec<(u8, Point, u32)> = faces
        .iter()
        .map(|face| {
            let [.., apex] = of(face);
            (quarter(apex), apex, *face)
        })
        .collect();
    let angle = |x: &(u8, Point, u32), y: &(u8, Point, u32)| {
        let turn = || match orient3d(a, b, x.1, y.1) {
            Sign::Positive => Ordering::Less,
            Sign::Zero => Ordering::Equal,
            Sign::Negative => Ordering::Greater,
        };
        x.0.cmp(&y.0).then_with(|| if x.0 % 2 == 1 { turn() } else { Ordering::Equal })
    };
    around.sort_unstable_by(|x, y| angle(x, y).then(x.2.cmp(&y.2)));
    let runs = around.chunk_by(|x, y| angle(x, y).is_eq()).filter(|run| run.len() > 1);
    runs.map(|run| run.iter().map(|entry| entry.2).collect()).collect()
}
