//! Closed meshes: at every edge as many faces in one direction as in the other.

use super::Draw;
use super::mesh::{CLOSED, Draft, KNOWN};
use crate::mesh::{Mesh, Weld, weld};
use crate::testing::shapes;

/// Any closed mesh, often not manifold, sometimes meeting itself.
pub(crate) fn closed(draw: &mut dyn Draw) -> Mesh {
    match draw.below(4) {
        0 => voxel_solid(draw, [3; 3]),
        1 => bent(draw, 0.125),
        2 => hollow(draw),
        _ => several(draw),
    }
}

/// Solids as computer-aided design exports them: axis-aligned, full of exact ties.
pub(crate) fn cad(draw: &mut dyn Draw) -> Mesh {
    let size = draw.pick(&[1.0, 0.125, 24.0]);
    let mesh = match draw.below(3) {
        0 => boxes(draw),
        1 => stretched(draw),
        _ => quartered(draw),
    };
    shapes::scaled(&mesh, size)
}

/// The boundary of cells of a grid around the origin, never none.
pub(crate) fn voxel_solid(draw: &mut dyn Draw, size: [u32; 3]) -> Mesh {
    let [x, y, z] = size;
    let mut cells: Vec<bool> = (0..x * y * z).map(|_| draw.flag()).collect();
    cells[0] |= !cells.contains(&true);
    centered(size, |[i, j, k]| cells[((k * y + j) * x + i) as usize])
}

/// A cube of 4³ cells of which at least one of the eight inside is missing.
pub(crate) fn hollow(draw: &mut dyn Draw) -> Mesh {
    let mut missing = [(); 8].map(|()| draw.flag());
    missing[0] |= !missing.contains(&true);
    centered([4; 3], |cell| {
        let is_inside = cell.iter().all(|n| (1..=2).contains(n));
        let inner: usize = (0..3).map(|axis| (cell[axis].saturating_sub(1) << axis) as usize).sum();
        !(is_inside && missing[inner])
    })
}

/// The boundary of the cells for which `filled` holds, moved to the middle by integers.
fn centered(size: [u32; 3], filled: impl Fn([u32; 3]) -> bool) -> Mesh {
    shapes::translated(&shapes::voxels(size, filled), size.map(|cells| -((cells / 2) as f32)))
}

/// A known or a voxel solid whose vertices have been moved, each by up to `most` in every coordinate, half of
/// them in none: faces are not axis-aligned any more and quads no longer flat, and no edge opens.
pub(crate) fn bent(draw: &mut dyn Draw, most: f64) -> Mesh {
    let known = draw.pick(&KNOWN[..CLOSED]);
    let mut draft = Draft::from(if draw.flag() { voxel_solid(draw, [2; 3]) } else { known() });
    draft.bend(draw, most);
    draft.into()
}

/// One to three closed meshes at any position, without shared vertices: apart, touching, or through each
/// other.
pub(crate) fn several(draw: &mut dyn Draw) -> Mesh {
    let slots = 1 + draw.index(3);
    let parts = draw.list(1, slots, |draw| {
        let (position, is_turned) = (draw.position(), draw.flag());
        let mesh = if draw.flag() { bent(draw, 0.125) } else { voxel_solid(draw, [2; 3]) };
        let mesh = shapes::translated(&mesh, position);
        if is_turned { shapes::inside_out(&mesh) } else { mesh }
    });
    Mesh::concat(&parts).expect("few faces")
}

/// One to four boxes with corners at small integers, without shared vertices.
pub(crate) fn boxes(draw: &mut dyn Draw) -> Mesh {
    let slots = 1 + draw.index(4);
    let boxes = draw.list(1, slots, |draw| {
        let low = [(); 3].map(|()| draw.between(-3, 2));
        let high = low.map(|x| (x + 1 + draw.between(0, 2)) as f32);
        shapes::cuboid(low.map(|x| x as f32), high)
    });
    Mesh::concat(&boxes).expect("few faces")
}

/// A voxel solid whose layers have different thicknesses, in quarters.
fn stretched(draw: &mut dyn Draw) -> Mesh {
    let layers = [(); 3].map(|()| [(); 3].map(|()| 1 + draw.below(8)));
    let mut draft = Draft::from(voxel_solid(draw, [3; 3]));
    for position in &mut draft.positions {
        *position = [0, 1, 2].map(|axis| {
            // Voxels are centered by one cell: from −1 to 2.
            let below = (position[axis] + 1.0) as usize;
            let quarters: u32 = layers[axis][..below].iter().sum();
            quarters as f32 * 0.25 - 2.0
        });
    }
    draft.into()
}

/// A voxel solid each of whose faces is cut into four: vertices inside flat sides, at halves.
fn quartered(draw: &mut dyn Draw) -> Mesh {
    let mesh = voxel_solid(draw, [2; 3]);
    let mut quarters = Draft::default();
    for face in mesh.triangles() {
        let [a, b, c] = face.map(|vertex| mesh.positions()[vertex as usize]);
        let middle = |p: [f32; 3], q: [f32; 3]| [0, 1, 2].map(|i| 0.5 * (p[i] + q[i]));
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            quarters.join(Draft { positions: corners.to_vec(), triangles: vec![[0, 1, 2]] });
        }
    }
    weld(&quarters.into(), Weld::Exact).mesh
}
