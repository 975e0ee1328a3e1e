//! Translation of a mesh that lies far from the origin, so that pixels are compared near the origin.
//!
//! A visible point is an `f32` point. A million units from the origin the spacing of `f32` is a sixteenth of
//! a unit, far more than a pixel's footprint. Translating everything by a vertex changes no verdict if every
//! difference is exact. For a mesh that is small compared with its distance from the origin, every difference
//! is exact. (The exception is a light that is farther still: then the comparison is only as good as the
//! spacing of `f32` at the mesh, and may call a mismatch real that lies within this spacing.)

use crate::geom::Light;
use crate::mesh::Mesh;
use crate::view::Projection;

/// A mesh, its light and its eye, translated so that a vertex becomes the origin.
pub(super) struct Recentered {
    pub(super) mesh: Mesh,
    pub(super) light: Light,
    pub(super) projection: Projection,
    /// The vertex that was subtracted.
    pub(super) origin: [f32; 3],
}

impl Recentered {
    /// `None` if the mesh is not far from the origin, or if the translation would round.
    pub(super) fn of(mesh: &Mesh, light: &Light, projection: &Projection) -> Option<Self> {
        let [low, high] = mesh.bounds()?;
        let widest = (0..3).map(|i| high[i] - low[i]).fold(0.0, f32::max);
        let farthest = low.iter().chain(&high).fold(0.0_f32, |most, x| most.max(x.abs()));
        if farthest <= 4.0 * widest {
            return None;
        }
        let origin = mesh.positions()[0];
        let less = |p: [f32; 3]| -> Option<[f32; 3]> {
            let moved = [0, 1, 2].map(|i| p[i] - origin[i]);
            (0..3).all(|i| rounding(p[i], origin[i], moved[i]) == 0.0).then_some(moved)
        };
        let positions = mesh.positions().iter().map(|&p| less(p)).collect::<Option<Vec<_>>>()?;
        let mut moved = mesh.clone();
        moved.set_positions(positions).ok()?;
        let light = if light.is_directional() { *light } else { Light::point(less(light.xyz())?).ok()? };
        let projection = Projection { eye: less(projection.eye)?, ..*projection };
        Some(Self { mesh: moved, light, projection, origin })
    }
}

/// The rounding error of `difference`, the rounded `a − b`. NaN if `difference` overflowed (Donald E. Knuth,
/// *The Art of Computer Programming*, vol. 2, §4.2.2, theorem B).
fn rounding(a: f32, b: f32, difference: f32) -> f32 {
    let of_b = a - difference;
    let of_a = difference + of_b;
    (a - of_a) + (of_b - b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    fn projection(eye: [f32; 3]) -> Projection {
        let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
        Projection { eye, right, up, forward, near: 0.1, kind: Default::default() }
    }

    #[test]
    fn local_moves_what_is_far_away_and_only_exactly() {
        let far = shapes::translated(&shapes::cube(), [4096.0, -8192.0, 0.0]);
        let at = |x: f32| Light::point([4098.0, -8190.0, x]).unwrap();
        let local = Recentered::of(&far, &at(3.0), &projection([4096.5, -8192.0, 5.0])).unwrap();
        for (moved, p) in local.mesh.positions().iter().zip(far.positions()) {
            assert_eq!([0, 1, 2].map(|i| moved[i] + local.origin[i]), *p);
        }
        assert!(Recentered::of(&far, &at(1e-30), &projection([4096.5, -8192.0, 5.0])).is_none());
        assert!(Recentered::of(&shapes::cube(), &at(3.0), &projection([0.0, 0.0, 5.0])).is_none());
    }
}
