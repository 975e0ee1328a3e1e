//! Normals of corners: those of the faces around a vertex that meet smoothly, weighted by their angles there
//! (Grit Thürmer and Charles A. Wüthrich, *Computing Vertex Normals from Polygonal Facets*, 1998).

use glam::DVec3;

use super::Per;
use crate::geom::predicate::collinear;
use crate::geom::predicate::filter::EPSILON;
use crate::mesh::{FaceId, HalfEdgeId, Mesh};
use crate::topology::{Components, Topology};

/// Cosine of the dihedral angle, 60 degrees, from which on an edge is hard.
const HARD: f64 = 0.5;

/// The most faces at an edge that are compared pair by pair. Beyond, every face keeps its own normal.
const MOST_FACES: usize = 64;

/// The normal of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CornerNormal {
    /// Of length 1.
    Known([f32; 3]),
    /// The normals around the vertex cancel out.
    Cancelled,
    /// No face of the group has an area.
    Flat,
}

/// The unit normal of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceNormal {
    unit: DVec3,
    /// By how much an error of the sides is magnified in the normal: 1 / sin of their angle.
    spread: f64,
}

impl FaceNormal {
    /// `None` for a face without area.
    ///
    /// Whichever corner comes first, the normal is the same; the reversed face has exactly the opposite one.
    pub(super) fn of(corners: [[f32; 3]; 3]) -> Option<Self> {
        let least =
            |&i: &usize, &j: &usize| corners[i].partial_cmp(&corners[j]).expect("positions are finite");
        let first = (0..3).min_by(least).unwrap_or(0);
        let [p, q, r] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
        if collinear(p, q, r) {
            return None;
        }
        let (u, v) = (minus(q, p), minus(r, p));
        let across = u.cross(v);
        let length = across.length();
        (length > 0.0).then(|| Self { unit: across / length, spread: u.length() * v.length() / length })
    }

    pub(super) fn rounded(&self) -> [f32; 3] {
        rounded(self.unit)
    }
}

/// The normal of each corner of each face.
pub(super) fn corner_normals(
    mesh: &Mesh,
    topology: &Topology,
    faces: &[Option<FaceNormal>],
    per: Per,
) -> Vec<CornerNormal> {
    let mut groups = smooth_groups(topology, faces);
    let mut order: Vec<(u32, u32, u32)> = (0..)
        .zip(mesh.triangles().as_flattened())
        .map(|(corner, &vertex)| (vertex, if per == Per::Vertex { 0 } else { groups.find(corner) }, corner))
        .collect();
    drop(groups);
    order.sort_unstable();
    let mut normals = vec![CornerNormal::Flat; order.len()];
    for group in order.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let parts = group.iter().filter_map(|&(_, _, corner)| {
            let (face, at) = (corner as usize / 3, corner as usize % 3);
            faces[face].map(|normal| (normal, angle(mesh.corners(FaceId::new(face)), at)))
        });
        let normal = weighted(parts);
        group.iter().for_each(|&(_, _, corner)| normals[corner as usize] = normal);
    }
    normals
}

/// Corners at one vertex whose faces are connected across edges that are not hard.
fn smooth_groups(topology: &Topology, faces: &[Option<FaceNormal>]) -> Components {
    let mut groups = Components::new(3 * topology.face_count());
    let unit = |half_edge: HalfEdgeId| faces[topology.face(half_edge).index()].map(|normal| normal.unit);
    for edge in topology.edges().filter(|&edge| topology.valence(edge) <= MOST_FACES) {
        let uses = topology.half_edges(edge);
        for (i, a) in uses.clone().enumerate() {
            for b in uses.clone().take(i) {
                // Two faces with the same direction are turned against each other.
                let runs_back = topology.tail(a) != topology.tail(b);
                let meets_smoothly = || unit(a).zip(unit(b)).is_some_and(|(a, b)| a.dot(b) > HARD);
                if runs_back && meets_smoothly() {
                    groups.join(a.0, topology.next(b).0);
                    groups.join(topology.next(a).0, b.0);
                }
            }
        }
    }
    groups
}

/// The sum of unit normals times angles, as a unit normal.
///
/// Derived error bound, ε = 2⁻⁵³: each of the cross products errs by at most 8ε times the lengths of the
/// sides, a normal hence by (8 · spread + 4)ε, an angle by 24ε, and a sum of k terms by kε of its size. What
/// is not above the bound has no direction.
fn weighted(parts: impl Iterator<Item = (FaceNormal, f64)>) -> CornerNormal {
    let (mut sum, mut size, mut error, mut count) = (DVec3::ZERO, 0.0, 0.0, 0.0);
    for (FaceNormal { unit, spread }, angle) in parts {
        sum += angle * unit;
        size += angle;
        error += 24.0 + angle * (8.0 * spread + 5.0);
        count += 1.0;
    }
    if count == 0.0 {
        CornerNormal::Flat
    } else if sum.length() <= EPSILON * (error + count * size) {
        CornerNormal::Cancelled
    } else {
        CornerNormal::Known(rounded(sum / sum.length()))
    }
}

/// The angle of a triangle at a corner; the same for the reversed triangle.
fn angle(corners: [[f32; 3]; 3], at: usize) -> f64 {
    let [p, q, r] = [0, 1, 2].map(|i| corners[(at + i) % 3]);
    let (u, v) = (minus(q, p), minus(r, p));
    u.cross(v).length().atan2(u.dot(v))
}

/// The direction that halves the angle of a triangle at a corner.
pub(super) fn towards_middle(corners: [[f32; 3]; 3], at: usize) -> DVec3 {
    let [p, q, r] = [0, 1, 2].map(|i| corners[(at + i) % 3]);
    minus(q, p).normalize_or_zero() + minus(r, p).normalize_or_zero()
}

/// A given normal with length 1; `None` if it is zero or not finite.
pub(super) fn normalized(normal: [f32; 3]) -> Option<[f32; 3]> {
    let normal = minus(normal, [0.0; 3]);
    let length = normal.length();
    (length.is_finite() && length > 0.0).then(|| rounded(normal / length))
}

fn minus(a: [f32; 3], b: [f32; 3]) -> DVec3 {
    DVec3::from(a.map(f64::from)) - DVec3::from(b.map(f64::from))
}

/// Without a negative zero, which has other bits.
fn rounded(normal: DVec3) -> [f32; 3] {
    normal.to_array().map(|x| x as f32 + 0.0)
}
