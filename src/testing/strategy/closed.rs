//! Closed meshes: at every edge as many faces one way as the other.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

use super::mesh::place;
use crate::mesh::Mesh;
use crate::testing::shapes;

/// Any closed mesh: one of the four strategies below. Balanced at every edge, often not manifold, sometimes
/// meeting itself.
pub fn closed() -> impl Strategy<Value = Mesh> + Clone {
    prop_oneof![voxel_solid(3), hollow(), bent(), several()]
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
    vec(any::<bool>(), side.pow(3) as usize).prop_map(move |mut cells| {
        if !cells.contains(&true) {
            cells[0] = true;
        }
        centered(side, |[x, y, z]| cells[((z * side + y) * side + x) as usize])
    })
}

/// A cube of 4³ cells with cavities: its surface is whole, and any of the eight cells inside may be missing, at
/// least one is.
pub fn hollow() -> impl Strategy<Value = Mesh> + Clone {
    any::<[bool; 8]>().prop_map(|mut filled| {
        filled[0] &= filled.contains(&false);
        centered(4, |cell| {
            let inside = cell.iter().all(|n| (1..=2).contains(n));
            !inside
                || filled[cell.iter().enumerate().map(|(axis, n)| ((n - 1) << axis) as usize).sum::<usize>()]
        })
    })
}

/// A solid whose vertices have been moved, each by up to an eighth in every coordinate: faces are not axis-aligned
/// any more and quads no longer flat, and no edge opens. Half of the offsets are none. Shrinks towards the solid
/// itself.
pub fn bent() -> impl Strategy<Value = Mesh> + Clone {
    let known = select(vec![
        shapes::tetrahedron(),
        shapes::octahedron(),
        shapes::cube(),
        shapes::icosphere(0),
        shapes::torus(5, 3, 2.0, 0.75),
        shapes::figure_eight_prism(),
        shapes::hollow_cube(),
    ]);
    let offset = || prop_oneof![Just(0.0_f32), -0.125_f32..=0.125];
    let offsets = vec([offset(), offset(), offset()], 1..24);
    (prop_oneof![known, voxel_solid(2)], offsets).prop_map(|(mesh, offsets)| {
        let (mut positions, triangles, ..) = mesh.into_parts();
        for (position, offset) in positions.iter_mut().zip(offsets.iter().cycle()) {
            *position = std::array::from_fn(|i| position[i] + offset[i]);
        }
        Mesh::new(positions, triangles).expect("small numbers")
    })
}

/// One to three closed meshes in any [`place`], without shared vertices: apart, touching, or through each other.
pub fn several() -> impl Strategy<Value = Mesh> + Clone {
    let one = prop_oneof![voxel_solid(2), bent()];
    vec((one, place(), any::<bool>()), 1..=3).prop_map(|parts| {
        let placed: Vec<Mesh> = parts
            .into_iter()
            .map(|(mesh, place, turn)| {
                let mesh = shapes::translated(&mesh, place);
                if turn { shapes::inside_out(&mesh) } else { mesh }
            })
            .collect();
        Mesh::concat(&placed).expect("few faces")
    })
}

/// The boundary of the cells for which `filled` holds, moved to the middle by whole units.
pub(super) fn centered(side: u32, filled: impl Fn([u32; 3]) -> bool) -> Mesh {
    shapes::translated(&shapes::voxels([side; 3], filled), [-((side / 2) as f32); 3])
}
