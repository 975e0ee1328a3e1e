//! Coordinates and triangle soups.

use proptest::collection::vec;
use proptest::prelude::*;

use crate::mesh::Mesh;
use crate::testing::shapes;

/// A coordinate: four in five are whole numbers from −3 to 3, where exact ties are common, the others any
/// `f32` from −3 to 3. Shrinks towards 0.
pub fn coordinate() -> impl Strategy<Value = f32> + Clone {
    prop_oneof![4 => (-3_i8..=3).prop_map(f32::from), 1 => -3.0_f32..3.0]
}

/// A place, often on the grid of whole numbers: three times [`coordinate`].
pub fn place() -> impl Strategy<Value = [f32; 3]> + Clone {
    [coordinate(), coordinate(), coordinate()]
}

/// A mesh of fewer than `faces` triangles over 3 to 9 shared vertices at any [`place`]: open, non-manifold, with
/// collapsed and flat faces. Shrinks towards no faces.
pub fn soup(faces: usize) -> impl Strategy<Value = Mesh> + Clone {
    soup_at(faces, place())
}

/// As [`soup`], with vertices at `places`: finite coordinates, for example `[-1.0_f32..1.0, -1.0_f32..1.0,
/// Just(0.0_f32)]` for a flat one.
pub fn soup_at<P>(faces: usize, places: P) -> impl Strategy<Value = Mesh> + Clone
where
    P: Strategy<Value = [f32; 3]> + Clone,
{
    let corners = [any::<u32>(), any::<u32>(), any::<u32>()];
    (vec(places, 3..10), vec(corners, 0..faces)).prop_map(|(positions, picks)| {
        let n = positions.len() as u32; // below ten
        let triangles = picks.into_iter().map(|corners| corners.map(|corner| corner % n)).collect();
        Mesh::new(positions, triangles).expect("the places are finite")
    })
}

/// 2ᵏ for k from −60 to 60, often near 0. Shrinks towards 1.
pub fn power_of_two() -> impl Strategy<Value = f32> + Clone {
    prop_oneof![(-4_i32..=4), (-60_i32..=60)].prop_map(|exponent| 2.0_f32.powi(exponent))
}

/// Meshes from `meshes` times a [`power_of_two`]: exact, unless a coordinate falls below 2⁻¹²⁶.
///
/// # Panics
///
/// A case panics if a coordinate leaves the range of `f32`; those of the strategies here do not.
pub fn at_scale(meshes: impl Strategy<Value = Mesh> + Clone) -> impl Strategy<Value = Mesh> + Clone {
    (meshes, power_of_two()).prop_map(|(mesh, factor)| shapes::scaled(&mesh, factor))
}
