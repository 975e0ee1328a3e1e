//! Queries that start at a point of the surface itself.

use multiversion::multiversion;

use super::primary_hit::{NEARLY, distance};
use super::{Intersection, Oracle, Verdict};
use crate::geom::Light;
use crate::geom::bvh::Step;
use crate::mesh::FaceId;

impl Oracle {
    /// Calls `visit` with every face whose box contains `p`, and some others near it.
    pub(crate) fn for_each_face_near(&self, p: [f32; 3], mut visit: impl FnMut(FaceId, [[f32; 3]; 3])) {
        // A segment without length meets the boxes around its point.
        let Ok(here) = Light::point(p) else { return };
        self.tree.walk::<false>(p, &here, |slot| {
            visit(FaceId(self.order[slot]), self.triangles[slot]);
            Step::On
        });
    }

    /// Whether the open segment from `p` to the light properly crosses a face that is not `own` or a copy of
    /// it.
    pub(crate) fn is_crossed(&self, p: [f32; 3], light: &Light, own: Option<[[f32; 3]; 3]>) -> bool {
        match own {
            None => self.verdict(p, light) == Verdict::Shadowed,
            Some(own) => is_crossed(self, p, light, own),
        }
    }

    /// Distance along a ray to the first face that it properly crosses, in lengths of `direction`, without
    /// `own` and its copies. Rounded.
    pub(crate) fn first_crossing(
        &self,
        p: [f32; 3],
        direction: [f32; 3],
        own: Option<[[f32; 3]; 3]>,
    ) -> Option<f64> {
        let towards = Light::directional(direction.map(|x| -x)).ok()?;
        let mut first = None;
        self.meetings::<true>(p, &towards, &self.way(p, &towards), |slot, meeting| {
            let triangle = self.triangles[slot];
            if meeting == Intersection::Touching || own.is_some_and(|own| has_corners(triangle, own)) {
                return Step::On;
            }
            let t = distance(p, &towards, triangle);
            let least = first.map_or(t, |first: f64| first.min(t));
            first = Some(least);
            Step::NoFarther(least * NEARLY)
        });
        first
    }
}

/// The traversal, with AVX2 instructions where the processor has them.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn is_crossed(oracle: &Oracle, p: [f32; 3], light: &Light, own: [[f32; 3]; 3]) -> bool {
    let mut crossed = false;
    oracle.meetings::<false>(p, light, &oracle.way(p, light), |slot, meeting| {
        if meeting == Intersection::Touching || has_corners(oracle.triangles[slot], own) {
            return Step::On;
        }
        crossed = true;
        Step::Stop
    });
    crossed
}

/// Whether two triangles have the same corners, in any order.
fn has_corners(triangle: [[f32; 3]; 3], own: [[f32; 3]; 3]) -> bool {
    own.iter().all(|corner| triangle.contains(corner)) && triangle.iter().all(|corner| own.contains(corner))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::oracle::Hit;
    use crate::testing::shapes;

    #[test]
    fn faces_near_a_vertex_are_all_that_have_it_as_a_corner() {
        for scale in [1.0, 1e-38, 1e30] {
            let mesh = shapes::scaled(&shapes::torus(20, 10, 2.0, 0.75), scale);
            let oracle = Oracle::build(&mesh);
            for &p in mesh.positions() {
                let (mut near, mut at) = (0, 0);
                oracle.for_each_face_near(p, |face, corners| {
                    assert_eq!(corners, mesh.corners(face));
                    near += 1;
                    at += usize::from(corners.contains(&p));
                });
                assert!(at == 6 && near < 120, "{at} of {near}");
            }
        }
    }

    #[test]
    fn own_face_and_its_copies_are_left_out_and_others_are_not() {
        // Copies of one face, one of them turned over, and a smaller one in the same plane.
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let mut positions = corners.to_vec();
        positions.push([3.0, 0.0, 0.0]);
        let (p, up) = ([0.5, 0.5, -1.0], [0.0, 0.0, 1.0]);
        let light = Light::directional([0.0, 0.0, -1.0]).unwrap();
        for (faces, crossed) in [(vec![[0, 1, 2], [2, 1, 0]], false), (vec![[0, 1, 2], [0, 3, 2]], true)] {
            let oracle = Oracle::build(&Mesh::new(positions.clone(), faces).unwrap());
            assert_eq!(oracle.is_crossed(p, &light, Some(corners)), crossed);
            assert_eq!(oracle.first_crossing(p, up, Some(corners)), crossed.then_some(1.0));
            assert!(oracle.is_crossed(p, &light, None));
        }
    }

    #[test]
    fn first_crossing_from_a_vertex_is_the_first_hit() {
        let mesh = shapes::torus(20, 10, 2.0, 0.75);
        let oracle = Oracle::build(&mesh);
        let mut found = 0;
        for (i, &p) in mesh.positions().iter().enumerate() {
            let turn = i as f32;
            let direction = [turn.cos(), (3.0 * turn).sin(), 0.3 * (7.0 * turn).cos()];
            let hit = oracle.first_hit(p, direction);
            assert_eq!(oracle.first_crossing(p, direction, None), hit.map(|Hit { t, .. }| t));
            found += usize::from(hit.is_some());
        }
        assert!(found > 60, "{found}");
    }
}
