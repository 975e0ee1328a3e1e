//! A ground plane that receives shadows.

use glam::DVec3;

use crate::geom::Aabb;
use crate::mesh::{FaceId, Mesh, MeshError, Part};
use crate::view::Up;

/// Two real faces below a mesh: they receive shadows and, for a light from below, cast them.
///
/// ```
/// use umbrage::render::Ground;
/// use umbrage::testing::shapes;
/// use umbrage::view::Up;
///
/// let (mesh, ground) = Ground::under(shapes::cube(), Up::Y)?;
/// assert_eq!(mesh.face_count(), 12 + 2);
/// assert_eq!(ground.first_face.index(), 12);
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// The first of the two ground faces; all faces before it belong to the mesh.
    pub first_face: FaceId,
    pub(super) center: DVec3,
    pub(super) diagonal: f64,
}

/// Half the side of the ground, in diagonals of the mesh's box.
const REACH: f64 = 64.0;

/// Distance of the ground below the box, in diagonals: less than a pixel in most pictures, but enough to
/// avoid z-fighting with a flat underside.
const GAP: f64 = 1.0 / 4096.0;

/// Distances between which the ground fades into the background, in diagonals from the center of the box.
pub(super) const FADE: [f64; 2] = [1.0, 7.0];

impl Ground {
    /// Appends a ground below `mesh`: a level square with a side of 128 diagonals of the mesh's box.
    /// Animation frames are dropped.
    ///
    /// # Errors
    ///
    /// [`MeshError::TooLarge`] if four more vertices and two more faces do not fit 32-bit ids.
    pub fn under(mesh: Mesh, up: Up) -> Result<(Mesh, Self), MeshError> {
        let bounds = mesh.bounds().map_or(Aabb::EMPTY, |[low, high]| Aabb { low, high });
        Self::below(mesh, &bounds, up)
    }

    /// The same below `bounds`, the box of a scene that `mesh` is a part of.
    ///
    /// # Errors
    ///
    /// As [`Ground::under`].
    pub fn below(mesh: Mesh, bounds: &Aabb, up: Up) -> Result<(Mesh, Self), MeshError> {
        let zero = Aabb { low: [0.0; 3], high: [0.0; 3] };
        let bounds = if bounds.is_empty() { &zero } else { bounds };
        let low = bounds.low;
        let diagonal = if bounds.diagonal() > 0.0 { bounds.diagonal() } else { 1.0 };
        let center = DVec3::from(bounds.center().map(f64::from));
        let most = f64::from(f32::MAX);
        let level = (f64::from(low[up.axis()]) - GAP * diagonal).max(-most) as f32;
        let corner = |right: f64, back: f64| {
            let step = DVec3::from(up.turn([right, 0.0, back])) * (REACH * diagonal);
            let mut at = (center + step).to_array().map(|x| x.clamp(-most, most) as f32);
            // If rounding loses the gap, the next smaller number still lies below the box.
            at[up.axis()] = level.min(low[up.axis()].next_down().max(f32::MIN));
            at
        };

        let name = mesh.name.clone();
        let (mut positions, mut triangles, mut parts, _) = mesh.into_parts();
        // `Mesh::new` below returns the error if the ids do not fit.
        let (vertex, face) = (positions.len() as u32, triangles.len() as u32);
        positions.extend([corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)]);
        triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i: u32| vertex.wrapping_add(i))));
        if parts.is_empty() {
            parts.push(Part::new(name.clone(), 0..face));
        }
        parts.push(Part::new("ground", face..triangles.len() as u32));
        let mesh = Mesh::new(positions, triangles)?.with_name(name).with_parts(parts);
        Ok((mesh, Self { first_face: FaceId(face), center, diagonal }))
    }

    /// Weight of the background at `point`: 0 near the mesh, 1 far away.
    pub(super) fn fade(&self, point: [f32; 3]) -> f32 {
        let diagonals = DVec3::from(point.map(f64::from)).distance(self.center) / self.diagonal;
        let x = ((diagonals - FADE[0]) / (FADE[1] - FADE[0])).clamp(0.0, 1.0);
        (x * x * (3.0 - 2.0 * x)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    #[test]
    fn ground_lies_below_and_looks_up() {
        let tiny = shapes::scaled(&shapes::cube(), 1e-44);
        let far = shapes::translated(&shapes::cube(), [1e8; 3]);
        let huge = shapes::scaled(&shapes::cube(), 3e38);
        for mesh in [shapes::cube(), shapes::sheet(1), tiny, far, huge, Mesh::default()] {
            for up in [Up::Y, Up::Z] {
                let axis = up.axis();
                let count = mesh.face_count();
                let low = mesh.bounds().map_or(0.0, |[low, _]| low[axis]);
                let (with, ground) = Ground::under(mesh.clone(), up).unwrap();
                assert_eq!((ground.first_face.index(), with.face_count()), (count, count + 2));
                for face in [ground.first_face, FaceId(ground.first_face.0 + 1)] {
                    let [a, b, c] = with.corners(face);
                    assert!(a[axis] < low && b[axis] == a[axis] && c[axis] == a[axis], "{a:?} {low}");
                    assert_eq!(crate::geom::predicate::turn(a, b, c, axis).value(), 1);
                    assert_eq!(with.part_name(face), Some("ground"));
                }
            }
        }
    }
}
