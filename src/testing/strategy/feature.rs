//! A place on a mesh that is drawn before the mesh is known.

use proptest::prelude::*;
use proptest::sample::Index;

use crate::mesh::Mesh;

/// A vertex, or a place on an edge, inside a face, or in a face's plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feature {
    /// The face, and which of its corners is the first.
    pub(super) face: Index,
    pub(super) first: u8,
    /// From the first corner so many eighths towards the second, and towards the third.
    pub(super) eighths: [i8; 2],
}

pub(super) fn feature() -> impl Strategy<Value = Feature> + Clone {
    let eighths = prop_oneof![
        2 => Just([0, 0]),                                                 // a vertex
        2 => (0_i8..=8).prop_map(|u| [u, 0]),                              // on an edge
        1 => Just([4, 0]),                                                 // its middle
        2 => (1_i8..=6, 1_i8..=6).prop_map(|(u, v)| [u, v.min(7 - u).max(1)]), // inside the face
        2 => [-16_i8..=24, -16_i8..=24],                                   // in its plane
    ];
    (any::<Index>(), 0_u8..3, eighths).prop_map(|(face, first, eighths)| Feature { face, first, eighths })
}

impl Feature {
    /// The place, in `f64` and not rounded on meshes of moderate coordinates; the origin where there is no face.
    pub(super) fn at(&self, mesh: &Mesh) -> [f64; 3] {
        if mesh.face_count() == 0 {
            return [0.0; 3];
        }
        let mut face = mesh.triangles()[self.face.index(mesh.face_count())];
        face.rotate_left(self.first.into());
        let [a, b, c] = face.map(|vertex| mesh.positions()[vertex as usize].map(f64::from));
        let [u, v] = self.eighths.map(|n| f64::from(n) / 8.0);
        [0, 1, 2].map(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]))
    }
}

/// How many units in the last place each coordinate is moved: mostly none.
pub(super) fn ulps() -> impl Strategy<Value = [i8; 3]> + Clone {
    prop_oneof![3 => Just([0; 3]), 1 => [-1_i8..=1, -1_i8..=1, -1_i8..=1]]
}

/// The nearest finite `f32` place, moved by `ulps`.
pub(super) fn rounded(place: [f64; 3], ulps: [i8; 3]) -> [f32; 3] {
    std::array::from_fn(|i| {
        let x = place[i] as f32;
        let x = match ulps[i] {
            0 => x,
            steps if steps > 0 => x.next_up(),
            _ => x.next_down(),
        };
        x.clamp(f32::MIN, f32::MAX) + 0.0
    })
}
