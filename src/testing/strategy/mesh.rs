//! Coordinates and meshes.

use proptest::collection::vec;
use proptest::prelude::*;

use super::choices::{Choices, drawn};
use crate::mesh::Mesh;
use crate::testing::{generate, shapes};

/// A coordinate: four in five are integers from −3 to 3, where exact ties are common, the others any `f32`
/// from −3 to 3. Shrinks towards 0.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::testing::strategy::coordinate;
///
/// proptest!(|(x in coordinate())| prop_assert!((-3.0..=3.0).contains(&x)));
/// ```
pub fn coordinate() -> impl Strategy<Value = f32> + Clone {
    drawn(|draw| draw.coordinate())
}

/// A position, often on the grid of integers: three times [`coordinate`].
pub fn place() -> impl Strategy<Value = [f32; 3]> + Clone {
    drawn(|draw| draw.position())
}

/// A mesh of fewer than `faces` triangles over 3 to 9 shared vertices at any [`place`]: open, non-manifold,
/// with collapsed and flat faces. Shrinks towards no faces.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::testing::strategy::soup;
/// use umbrage::topology::Topology;
///
/// proptest!(|(mesh in soup(24))| {
///     let topology = Topology::of(&mesh);
///     prop_assert!(topology.edge_count() <= 3 * mesh.face_count());
/// });
/// ```
pub fn soup(faces: usize) -> impl Strategy<Value = Mesh> + Clone {
    soup_at(faces, place())
}

/// As [`soup`], with vertices at `places`: finite coordinates, for example `[-1.0_f32..1.0, -1.0_f32..1.0,
/// Just(0.0_f32)]` for a flat one.
pub fn soup_at<P>(faces: usize, places: P) -> impl Strategy<Value = Mesh> + Clone
where
    P: Strategy<Value = [f32; 3]> + Clone,
{
    // A face over nine vertices, of which some may be left out.
    let slots = drawn(move |draw| {
        let slots = draw.index(faces.max(1));
        generate::faces(draw, 0..=slots, 9)
    });
    (vec(places, 3..10), slots).prop_map(|(positions, faces)| {
        let n = positions.len() as u32; // below ten
        let triangles = faces.into_iter().map(|corners| corners.map(|corner| corner % n)).collect();
        Mesh::new(positions, triangles).expect("the places are finite")
    })
}

/// Any closed mesh: one of the four strategies below. Balanced at every edge, often not manifold, sometimes
/// meeting itself.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::testing::strategy::closed;
/// use umbrage::topology::Topology;
///
/// proptest!(|(mesh in closed())| prop_assert!(Topology::of(&mesh).edge_counts().balanced));
/// ```
pub fn closed() -> impl Strategy<Value = Mesh> + Clone {
    drawn(generate::closed)
}

/// The boundary of up to `side`³ unit cells around the origin, never none. Parts may touch in an edge or a
/// corner alone, and there may be cavities. Shrinks towards few cells.
///
/// See [`shapes::voxels`].
///
/// # Panics
///
/// Panics if `side` is 0, or over 32.
pub fn voxel_solid(side: u32) -> impl Strategy<Value = Mesh> + Clone {
    assert!((1..=32).contains(&side), "a voxel solid has 1 to 32 cells along a side, not {side}");
    drawn(move |draw| generate::voxel_solid(draw, [side; 3]))
}

/// A cube of 4³ cells with cavities: its surface is whole, and any of the eight cells inside may be missing,
/// at least one is.
pub fn hollow() -> impl Strategy<Value = Mesh> + Clone {
    drawn(generate::hollow)
}

/// A solid whose vertices have been moved, each by up to an eighth in every coordinate: faces are not
/// axis-aligned any more and quads no longer flat, and no edge opens. Half of the offsets are none. Shrinks
/// towards the solid itself.
pub fn bent() -> impl Strategy<Value = Mesh> + Clone {
    drawn(|draw| generate::bent(draw, 0.125))
}

/// One to three closed meshes in any [`place`], without shared vertices: apart, touching, or through each
/// other.
pub fn several() -> impl Strategy<Value = Mesh> + Clone {
    drawn(generate::several)
}

/// What computer-aided design exports look like to a predicate. Axis-aligned solids: overlapping and touching
/// boxes on the grid, or voxel solids stretched along the axes; some with flat sides cut into many faces.
/// Closed; most coordinates, edges and planes coincide with others.
pub fn cad() -> impl Strategy<Value = Mesh> + Clone {
    drawn(generate::cad)
}

/// Any small mesh with a face, as the torture and the fuzz targets draw them: solids, sheets, soups, slivers,
/// half of them damaged, some of them tiny, huge or far away.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::check::CrackReport;
/// use umbrage::testing::strategy::mesh;
/// use umbrage::topology::Topology;
///
/// proptest!(|(mesh in mesh())| {
///     let topology = Topology::of(&mesh);
///     prop_assert_eq!(CrackReport::of(&mesh, &topology).counts.faces, mesh.face_count());
/// });
/// ```
pub fn mesh() -> impl Strategy<Value = Mesh> + Clone {
    drawn(generate::mesh)
}

/// 2ᵏ for k from −60 to 60, often near 0. Shrinks towards 1.
pub fn power_of_two() -> impl Strategy<Value = f32> + Clone {
    drawn(generate::power_of_two)
}

/// Meshes from `meshes` times a [`power_of_two`]: exact, unless a coordinate falls below 2⁻¹²⁶.
///
/// # Panics
///
/// A case panics if a coordinate leaves the range of `f32`; those of [`mesh()`] may, those of the other
/// strategies here do not.
pub fn at_scale(meshes: impl Strategy<Value = Mesh> + Clone) -> impl Strategy<Value = Mesh> + Clone {
    (meshes, power_of_two()).prop_map(|(mesh, factor)| shapes::scaled(&mesh, factor))
}

/// A mesh, and what was done to it, in that order.
#[derive(Clone, Debug)]
pub struct Damaged {
    /// The mesh as it is now.
    pub mesh: Mesh,
    /// What was done.
    pub damage: Vec<generate::Damage>,
}

/// Meshes from `meshes`, each with one to `most` pieces of random [`Damage`](super::Damage) that unbalance an
/// edge of every closed mesh. Shrinks towards little damage.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::testing::strategy::{damaged, voxel_solid};
/// use umbrage::topology::Topology;
///
/// proptest!(|(damaged in damaged(voxel_solid(2), 1))| {
///     prop_assert!(!Topology::of(&damaged.mesh).edge_counts().balanced, "{:?}", damaged.damage);
/// });
/// ```
///
/// # Panics
///
/// Panics if `most` is 0.
pub fn damaged(
    meshes: impl Strategy<Value = Mesh> + Clone,
    most: usize,
) -> impl Strategy<Value = Damaged> + Clone {
    (meshes, vec(Choices::<2>::any(), 1..=most)).prop_map(|(mesh, pieces)| {
        let mut draft = generate::Draft::from(mesh);
        let damage = pieces.iter().filter_map(|choices| {
            choices.give(|draw| generate::damage(draw, generate::Damage::UNBALANCING, &mut draft))
        });
        let damage = damage.collect();
        Damaged { mesh: draft.into(), damage }
    })
}
