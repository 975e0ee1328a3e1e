//! The competitor: the same queries in plain `f32`, as most programs answer them.

use glam::Vec3A;
use obvhs::ray::Ray;
use obvhs::triangle::Triangle;

use crate::geom::{Facing, Light};
use crate::mesh::{FaceId, Mesh};

/// A mesh and a light without exactness: facing by a cross product, visibility by the triangle test of obvhs
/// (Möller and Trumbore's), with no bias.
pub(super) struct Plain {
    triangles: Vec<Triangle>,
    light: Vec3A,
    directional: bool,
}

impl Plain {
    pub(super) fn new(mesh: &Mesh, light: &Light) -> Self {
        let corners = (0..mesh.face_count()).map(|face| mesh.corners(FaceId::new(face)));
        let triangles = corners.map(|corners| {
            let [v0, v1, v2] = corners.map(Vec3A::from);
            Triangle { v0, v1, v2 }
        });
        let triangles = triangles.collect();
        Self { triangles, light: light.xyz().into(), directional: light.is_directional() }
    }

    /// How many faces get the wrong side. Where the truth is edge-on, both answers are right.
    pub(super) fn faces_wrong(&self, truth: &[Facing]) -> u64 {
        let wrong = |(triangle, truth): (&Triangle, &Facing)| {
            let Triangle { v0, v1, v2 } = *triangle;
            let to_light = if self.directional { self.light } else { self.light - v0 };
            let front = (v1 - v0).cross(v2 - v0).dot(to_light) > 0.0;
            match truth {
                Facing::Front => !front,
                Facing::Back => front,
                Facing::EdgeOn => false,
            }
        };
        self.triangles.iter().zip(truth).map(|pair| u64::from(wrong(pair))).sum()
    }

    /// Whether the shadow ray hits a face.
    #[inline]
    pub(super) fn shadowed(&self, p: [f32; 3]) -> bool {
        let origin = Vec3A::from(p);
        let (direction, tmax) =
            if self.directional { (self.light, f32::INFINITY) } else { (self.light - origin, 1.0) };
        // Not by `Ray::new`, which asserts in debug builds that nothing overflows. Only trees use the
        // inverse.
        let ray = Ray { origin, direction, inv_direction: Vec3A::ZERO, tmin: 0.0, tmax };
        self.triangles.iter().any(|triangle| triangle.intersect(&ray) < f32::INFINITY)
    }
}
