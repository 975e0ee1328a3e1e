//! Which points of a plane are in shadow: the flattened faces in a tree on the plane, and exact signs.

use super::Plane;
use super::boxes::{Rect, RectTree};
use super::interval::{Interval, Number};
use super::matrix::Flattening;
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::geom::predicate::{Homogeneous, orient3d_homogeneous, side_of_light, side_of_point};
use crate::mesh::FaceId;

/// The flattened faces of all casters under one light.
///
/// A rectangle around each flattened and clipped face, rounded outwards, says which faces may cover a point.
/// Five signs decide whether one does. With the ray cast it shares these signs and nothing else.
#[derive(Clone, Debug)]
pub(super) struct Coverage {
    light: Light,
    flattening: Flattening<Interval>,
    /// How far behind the plane a point may lie: receivers are rounded to `f32`.
    slack: f64,
    tree: RectTree,
    faces: Vec<[[f32; 3]; 3]>,
}

impl Coverage {
    /// Flattens all faces. `None` if the light is in the plane, or too near to tell on which side.
    ///
    /// About 1 µs per face. Memory: 100 bytes per face.
    pub(super) fn new(casters: &CasterGroup<'_>, plane: &Plane, light: &Light) -> Option<Self> {
        let plane = plane.towards(light)?;
        let flattening = Flattening::new(&plane, light);
        let slack = slack(casters, &plane);
        let (mut rects, mut faces) = (Vec::new(), Vec::new());
        for caster in casters.casters() {
            for face in 0..caster.mesh().face_count() {
                let corners = caster.mesh().corners(FaceId::new(face));
                // Edge-on, a face has no shadow.
                if side_of_light(corners, light).is_zero() {
                    continue;
                }
                let polygon = flattening.clipped(corners, slack);
                if !polygon.is_empty() {
                    rects.push(Flattening::around(&polygon));
                    faces.push(corners);
                }
            }
        }
        Some(Self { light: *light, flattening, slack, tree: RectTree::new(&rects), faces })
    }

    /// Whether a point next to the plane is in shadow: whether the open segment from it to the light properly
    /// crosses a face. `None` where this cannot be told on the plane: behind it, or not below the light.
    pub(super) fn covers(&self, p: [f32; 3]) -> Option<bool> {
        let at = self.flattening.at(p);
        let [_, _, divisor, height] = at;
        if !(height + Interval::of(self.slack)).is_not_negative() || !divisor.is_positive() {
            return None;
        }
        let rect: Rect = Flattening::around(&[at]);
        Some(self.tree.any(&rect, |face| crosses(p, &self.light, self.faces[face])))
    }

    pub(super) fn bytes(&self) -> usize {
        self.tree.bytes() + size_of_val(&*self.faces)
    }
}

/// How far a point that is rounded to `f32` may leave the plane within the bounds of the scene.
pub(super) fn slack(casters: &CasterGroup<'_>, plane: &Plane) -> f64 {
    let bounds = casters.bounds();
    let farthest = |i: usize| f64::from(bounds.low[i].abs().max(bounds.high[i].abs()));
    (0..3).map(|i| plane.normal[i].abs() * farthest(i)).sum::<f64>() * f64::from(f32::EPSILON)
}

/// Whether the open segment from `p` to the light properly crosses a face: the line through both passes all
/// three edges on the same side, and the face's plane lies between them. That p and the light are on opposite
/// sides of this plane is both clips at once.
fn crosses(p: [f32; 3], light: &Light, face: [[f32; 3]; 3]) -> bool {
    is_on_line(p, light, face) && side_of_point(face, p) == -side_of_light(face, light)
}

pub(super) fn is_on_line(p: [f32; 3], light: &Light, [a, b, c]: [[f32; 3]; 3]) -> bool {
    let ends = [Homogeneous::point(p), Homogeneous::light(light)];
    let turn =
        |from, to| orient3d_homogeneous([ends[0], ends[1], Homogeneous::point(from), Homogeneous::point(to)]);
    let first = turn(a, b);
    !first.is_zero() && turn(b, c) == first && turn(c, a) == first
}
