//! A receiver with the faces around it: where rays start.

use super::fan::Fan;
use super::{Reach, Receiver, Receivers};
use crate::geom::Light;
use crate::geom::predicate::{on_triangle, side_of_point};
use crate::mesh::FaceId;
use crate::oracle::Oracle;

/// A receiver, and what of the faces through it the ray cast does not see.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub(super) point: [f32; 3],
    /// The faces with the receiver as a corner, or the face whose middle it is.
    pub(super) faces: Vec<FaceId>,
    own: Option<[[f32; 3]; 3]>,
    fan: Fan,
}

/// How steeply a receiver at a hard edge is moved off its own faces, as it is moved into them: by less than a
/// sixteenth of a degree, and by far more than normals are rounded.
const RISE: f64 = 1.0 / 1024.0;

impl Start {
    pub(super) fn at(oracle: &Oracle, receivers: &Receivers, index: usize) -> Self {
        let Receiver { point, normal, face: own_face } = receivers.list[index];
        let (mut faces, mut own) = (Vec::new(), None);
        // Faces through the point: those that the receiver stands for, and others.
        let (mut ours, mut others) = (Vec::new(), Vec::new());
        oracle.for_each_face_near(point, |face, corners| {
            if own_face == Some(face) {
                faces.push(face);
                own = Some(corners);
            } else if corners.contains(&point) {
                faces.push(face);
                let receivers = receivers.corners.get(face.index());
                let is_ours = receivers.is_some_and(|of_face| of_face.contains(&(index as u32)));
                if is_ours { &mut ours } else { &mut others }.push(corners);
            } else if side_of_point(corners, point).is_zero() && on_triangle(corners, point) {
                others.push(corners);
            }
        });
        let mut fan = Fan::default();
        if let Some(normal) = normal {
            let off = receivers.off(index, normal);
            let mut copies: Vec<_> = ours.iter().copied().map(sorted).collect();
            copies.sort_unstable();
            ours.iter().for_each(|&corners| fan.add(point, normal, normal, corners));
            for &corners in &others {
                // The other side of the same sheet is as near as this one.
                let is_copy = copies.binary_search(&sorted(corners)).is_ok();
                fan.add(point, normal, if is_copy { normal } else { off }, corners);
            }
        }
        Self { point, faces, own, fan }
    }

    /// The fault that a test injects: faces through the receiver hide nothing.
    #[cfg(test)]
    pub(super) fn without_fan(self) -> Self {
        Self { fan: Fan::default(), ..self }
    }

    /// Whether the faces through the receiver hide a direction.
    pub(super) fn fan_hides(&self, direction: [f32; 3]) -> bool {
        self.fan.hides(direction)
    }

    /// The share of the light from a direction that is hidden: 0 or 1, or between with [`Reach::Fading`].
    pub(super) fn hidden(&self, oracle: &Oracle, direction: [f32; 3], reach: Reach) -> f64 {
        if self.fan.hides(direction) {
            return 1.0;
        }
        let Some(end) = reach.end(self.point, direction) else { return 0.0 };
        if !oracle.is_crossed(self.point, &end, self.own) {
            return 0.0;
        }
        let Reach::Fading(distance) = reach else { return 1.0 };
        let first = oracle.first_crossing(self.point, direction, self.own);
        first.map_or(0.0, |t| (1.0 - t / f64::from(distance)).clamp(0.0, 1.0))
    }
}

impl Receivers {
    /// Where a receiver is moved, by nothing, to see which side of a face that is not its own it is on: along
    /// its normal. At a hard edge, where the other side of the edge may contain the normal, into its own
    /// faces.
    pub(super) fn off(&self, index: usize, normal: [f32; 3]) -> [f32; 3] {
        match self.inward.get(index) {
            Some(&inward) if inward != [0.0; 3] => {
                [0, 1, 2].map(|i| (f64::from(inward[i]) + RISE * f64::from(normal[i])) as f32)
            }
            _ => normal,
        }
    }
}

/// The corners of a triangle in an order of their own.
fn sorted(corners: [[f32; 3]; 3]) -> [[u32; 3]; 3] {
    let mut bits = corners.map(|corner| corner.map(f32::to_bits));
    bits.sort_unstable();
    bits
}

impl Reach {
    /// The end of a ray. `None` if the ray has no direction or no length.
    fn end(self, p: [f32; 3], direction: [f32; 3]) -> Option<Light> {
        let unlimited = Light::directional(direction.map(|x| -x)).ok()?;
        let (Self::Within(distance) | Self::Fading(distance)) = self else { return Some(unlimited) };
        let length = f64::from(distance);
        let end = std::array::from_fn(|i| (f64::from(p[i]) + length * f64::from(direction[i])) as f32);
        // An end beyond the range of numbers is beyond every mesh.
        (length > 0.0).then(|| Light::point(end).unwrap_or(unlimited))
    }
}
