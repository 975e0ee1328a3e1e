//! What computer-aided design exports look like to a predicate: flat, axis-aligned, full of exact ties.

use proptest::collection::vec;
use proptest::prelude::*;

use super::closed::voxel_solid;
use crate::mesh::Mesh;
use crate::testing::shapes;

/// Axis-aligned solids: overlapping and touching boxes on the grid, or voxel solids stretched along the axes; some
/// with flat sides cut into many faces. Closed; most coordinates, edges and planes coincide with others.
pub fn cad() -> impl Strategy<Value = Mesh> + Clone {
    let size = prop_oneof![Just(1.0_f32), Just(0.125), Just(24.0)];
    (prop_oneof![boxes(), stretched(), quartered()], size)
        .prop_map(|(mesh, size)| shapes::scaled(&mesh, size))
}

/// One to four boxes with corners at small whole numbers, without shared vertices.
fn boxes() -> impl Strategy<Value = Mesh> + Clone {
    let corner = [-3_i8..=2, -3_i8..=2, -3_i8..=2];
    let size = [1_i8..=3, 1_i8..=3, 1_i8..=3];
    vec((corner, size), 1..=4).prop_map(|boxes| {
        let boxes = boxes.into_iter().map(|(low, size)| {
            let high = std::array::from_fn(|i| f32::from(low[i] + size[i]));
            shapes::cuboid(low.map(f32::from), high)
        });
        Mesh::concat(&boxes.collect::<Vec<_>>()).expect("few faces")
    })
}

/// A voxel solid whose layers have different thicknesses, in quarters.
fn stretched() -> impl Strategy<Value = Mesh> + Clone {
    let layers = || [1_u8..=8, 1_u8..=8, 1_u8..=8];
    (voxel_solid(3), [layers(), layers(), layers()]).prop_map(|(mesh, layers)| {
        let (mut positions, triangles, ..) = mesh.into_parts();
        for position in &mut positions {
            *position = std::array::from_fn(|axis| {
                // Voxels are centered by one cell: from −1 to 2.
                let below = (position[axis] + 1.0) as usize;
                let quarters: u8 = layers[axis][..below].iter().sum();
                f32::from(quarters) * 0.25 - 2.0
            });
        }
        Mesh::new(positions, triangles).expect("small numbers")
    })
}

/// A voxel solid each of whose faces is cut into four: vertices inside flat sides, at halves.
fn quartered() -> impl Strategy<Value = Mesh> + Clone {
    voxel_solid(2).prop_map(|mesh| {
        let mut triangles = Vec::with_capacity(4 * mesh.face_count());
        let mut positions = Vec::with_capacity(12 * mesh.face_count());
        for &[a, b, c] in mesh.triangles() {
            let [a, b, c] = [a, b, c].map(|vertex| mesh.positions()[vertex as usize]);
            let middle = |p: [f32; 3], q: [f32; 3]| std::array::from_fn(|i| 0.5 * (p[i] + q[i]));
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                let first = positions.len() as u32; // at most 12 · 96
                triangles.push([first, first + 1, first + 2]);
                positions.extend(corners);
            }
        }
        let soup = Mesh::new(positions, triangles).expect("small numbers");
        crate::mesh::weld(&soup, crate::mesh::Weld::Exact).mesh
    })
}
