//! At which points a simplified caster may change the verdict: a proven bound.
//!
//! No vertex moves by more than δ, so no point of a face does. The faces with their signs are a chain; its
//! boundary are the silhouette edges (and the edges of edge-on faces, which are not in the chain and may turn
//! into it). Let the light be directional, and consider the tube of radius δ around the segment from a point
//! p to the light. If no edge of the boundary meets the tube, and the surface does not come within δ of p:
//!
//! - The chain crosses all parallels in the tube equally often, since nothing of its boundary is between
//!   them. If it does so never, no face is in the tube, and none can move onto the segment: lit stays lit.
//! - The number of signed crossings changes only where the boundary is swept over the segment, or the surface
//!   over an end: dark stays dark.
//!
//! For a point light at distance d_b or more from the caster, δ is seen at an angle of at most δ/(d_b − δ),
//! and the tube becomes a cone of that half-angle with its apex at the light. At the point's distance D from
//! the light the cone is δ·D/(d_b − δ) wide: so far does the shadow of an edge move. A tube of radius δ is
//! not enough.
//!
//! All comparisons are widened by far more than the rounding of `f64`, and the cone's end by another δ.

use glam::DVec3;

use super::fault::{Fault, Faults};
use crate::facing::{CasterFaces, classify};
use crate::geom::bvh::Bvh;
use crate::geom::{Aabb, Light, Segment};
use crate::mesh::{FaceId, Mesh};
use crate::silhouette::Silhouette;
use crate::topology::{Topology, has_collapsed};

/// Factor by which distances are widened: rounding is 2⁻⁴⁵ of the largest distance, and a vertex moves by at
/// least 2⁻²⁰ of the shell's diagonal.
const WIDER: f64 = 1.0 + 1.0 / (1_u64 << 20) as f64;

/// The boundary and the surface of a shell that is simplified.
#[derive(Debug)]
pub(super) struct MoveBound {
    light: Light,
    /// The largest move.
    delta: f64,
    /// Least distance from a point light.
    nearest: f64,
    edges: Vec<[[f32; 3]; 2]>,
    edge_tree: Bvh,
    faces: Vec<[[f32; 3]; 3]>,
    face_tree: Bvh,
}

/// What a move looks like from one point.
struct Reach {
    /// Unit vector from the light's side to the light, seen from the point.
    towards: DVec3,
    /// Distance of a point light; infinite for a directional one.
    distance: f64,
    /// Half-angle of the cone; 0 for a tube.
    angle: f64,
    /// Radius around the point in which the surface must not come.
    around: f64,
}

impl MoveBound {
    pub(super) fn of(mesh: &Mesh, light: &Light, delta: f64) -> Self {
        let topology = Topology::of(mesh);
        let signs = CasterFaces::All.signs(&classify(mesh, light));
        let mut edges: Vec<[[f32; 3]; 2]> = Silhouette::extract(&topology, &signs)
            .edges
            .iter()
            .map(|edge| topology.vertices(edge.edge).map(|vertex| mesh.positions()[vertex.index()]))
            .collect();
        let faces = (0..mesh.face_count()).filter(|&face| !has_collapsed(mesh.triangles()[face]));
        let faces: Vec<[[f32; 3]; 3]> = faces
            .map(|face| {
                let [a, b, c] = mesh.corners(FaceId::new(face));
                if signs[face] == 0 {
                    edges.extend([[a, b], [b, c], [c, a]]);
                }
                [a, b, c]
            })
            .collect();
        let boxes: Vec<Aabb> = edges.iter().map(|edge| Aabb::around(*edge)).collect();
        let edge_tree = Bvh::build(&boxes);
        let boxes: Vec<Aabb> = faces.iter().map(|face| Aabb::around(*face)).collect();
        let face_tree = Bvh::build(&boxes);
        let nearest = distance_to_box(wide(light.xyz()), &face_tree.bounds());
        Self { light: *light, delta: delta * WIDER, nearest, edges, edge_tree, faces, face_tree }
    }

    pub(super) fn bytes(&self) -> usize {
        // A node of the trees takes about 36 bytes.
        size_of_val(&self.edges[..])
            + size_of_val(&self.faces[..])
            + 72 * (self.edges.len() + self.faces.len())
    }

    /// Whether the verdict at `p` may change.
    pub(super) fn may_change(&self, p: [f32; 3], faults: Faults) -> bool {
        let Some(reach) = self.reach(p, faults) else { return true };
        self.has_edge_near(p, &reach) || self.has_face_near(p, reach.around)
    }

    /// `None` if the light is too near for a bound.
    fn reach(&self, p: [f32; 3], faults: Faults) -> Option<Reach> {
        let light = wide(self.light.xyz());
        if self.light.is_directional() {
            let towards = light.normalize();
            return Some(Reach { towards, distance: f64::INFINITY, angle: 0.0, around: self.delta });
        }
        if self.nearest <= 2.0 * self.delta {
            return None;
        }
        let to_light = light - wide(p);
        let distance = to_light.length();
        let angle = match faults.has(Fault::EdgeMovesByDelta) {
            false => WIDER * self.delta / (self.nearest - self.delta),
            true => self.delta / distance,
        };
        let towards = to_light.try_normalize()?;
        Some(Reach { towards, distance, angle, around: angle * distance + self.delta })
    }

    fn has_edge_near(&self, p: [f32; 3], reach: &Reach) -> bool {
        let (way, light) = (Segment::to_light(p, &self.light), wide(self.light.xyz()));
        let mut found = false;
        self.edge_tree.walk(
            |aabb| {
                let width = match reach.distance.is_finite() {
                    true => reach.angle * farthest_in_box(light, aabb) + self.delta,
                    false => self.delta,
                };
                way.may_meet(&grown(aabb, width))
            },
            |slot| {
                let edge = self.edges[self.edge_tree.order()[slot] as usize].map(wide);
                found = match reach.distance.is_finite() {
                    true => meets_cone(edge.map(|end| end - light), reach, self.delta),
                    false => meets_tube(edge.map(|end| end - wide(p)), reach.towards, self.delta),
                };
                !found
            },
        );
        found
    }

    fn has_face_near(&self, p: [f32; 3], radius: f64) -> bool {
        let within = grown(&Aabb { low: p, high: p }, radius);
        let mut found = false;
        self.face_tree.walk(
            |aabb| aabb.overlaps(&within),
            |slot| {
                let face = self.faces[self.face_tree.order()[slot] as usize];
                found = distance_to_triangle(wide(p), face.map(wide)) <= WIDER * radius;
                !found
            },
        );
        found
    }
}

/// Whether the segment between two points relative to the light meets the cone around the segment to p, no
/// farther from the light than p.
fn meets_cone(ends: [DVec3; 2], reach: &Reach, delta: f64) -> bool {
    let (axis, step) = (-reach.towards, ends[1] - ends[0]);
    let closest = (-ends[0].dot(step) / step.length_squared()).clamp(0.0, 1.0);
    if (ends[0] + closest * step).length() > WIDER * (reach.distance + delta) {
        return false;
    }
    // |x × axis| ≤ tan·(x·axis): on the segment a convex function, least where its derivative is 0 or at an
    // end.
    let tan = reach.angle.min(1.5).tan();
    let (from, by) = (ends[0].cross(axis), step.cross(axis));
    let (along, gain) = (tan * ends[0].dot(axis), tan * step.dot(axis));
    let inside = |t: f64| {
        let height = along + t * gain;
        height >= 0.0 && (from + t * by).length() <= WIDER * height
    };
    let (square, linear) = (by.length_squared() - gain * gain, from.dot(by) - along * gain);
    inside(0.0) || inside(1.0) || square > 0.0 && inside((-linear / square).clamp(0.0, 1.0))
}

/// Whether the segment between two points relative to p comes within `radius` of the ray to the light.
fn meets_tube(ends: [DVec3; 2], towards: DVec3, radius: f64) -> bool {
    let step = ends[1] - ends[0];
    let (from, by) = (ends[0].cross(towards), step.cross(towards));
    let closest = (-from.dot(by) / by.length_squared()).clamp(0.0, 1.0);
    let closest = if closest.is_nan() { 0.0 } else { closest };
    // A segment that comes near the line behind p counts too if one end lies before p.
    let is_before = ends.iter().any(|end| end.dot(towards) >= -WIDER * radius);
    is_before && (from + closest * by).length() <= WIDER * radius
}

fn grown(aabb: &Aabb, by: f64) -> Aabb {
    let by = WIDER * by;
    Aabb {
        low: aabb.low.map(|x| ((f64::from(x) - by) as f32).next_down().max(f32::MIN)),
        high: aabb.high.map(|x| ((f64::from(x) + by) as f32).next_up().min(f32::MAX)),
    }
}

fn distance_to_box(p: DVec3, aabb: &Aabb) -> f64 {
    let (low, high) = (wide(aabb.low), wide(aabb.high));
    (low - p).max(p - high).max(DVec3::ZERO).length() / WIDER
}

fn farthest_in_box(p: DVec3, aabb: &Aabb) -> f64 {
    WIDER * (p - wide(aabb.low)).abs().max((p - wide(aabb.high)).abs()).length()
}

/// (Christer Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5.)
fn distance_to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_edge = |from: DVec3, to: DVec3| {
        let (along, at) = (to - from, p - from);
        let t = at.dot(along) / along.length_squared();
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        (at - t * along).length()
    };
    let normal = (b - a).cross(c - a);
    let is_above = [(a, b), (b, c), (c, a)].iter().all(|&(u, v)| (v - u).cross(p - u).dot(normal) >= 0.0);
    let height = (p - a).dot(normal).abs() / normal.length();
    if is_above && height.is_finite() {
        return height;
    }
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}
