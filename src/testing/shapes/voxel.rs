//! Boundaries of sets of unit cells: closed by construction, often not manifold.

use super::closed::CUBE_SIDES;
use super::{Mesh, build, split};

/// The boundary of the unit cells of a box of `size` cells for which `filled([x, y, z])` holds.
///
/// Cell `[x, y, z]` reaches from that point one unit along each axis; coordinates are small integers. Two
/// faces lie between each filled cell and each empty neighbor, and corners are shared, so that every edge has
/// as many faces in one direction as in the other: 0, 1 or 2 in each, 2 where two cells touch along the edge
/// alone. Good for random closed meshes with a known inside. Linear in the cells of the box, eight bytes
/// each.
///
/// # Panics
///
/// Panics if the box has 2³² lattice points or more, or a side over 2²⁴.
#[must_use]
pub fn voxels(size: [u32; 3], filled: impl Fn([u32; 3]) -> bool) -> Mesh {
    assert!(size.iter().all(|&n| n <= 1 << 24), "{size:?}: a side has at most 2^24 cells");
    let points = size.map(|n| n as usize + 1);
    let count = points.iter().try_fold(1_usize, |product, &n| product.checked_mul(n)).unwrap_or(usize::MAX);
    assert!(count < 1 << 32, "{size:?}: a box has fewer than 2^32 lattice points");
    // The vertex at each lattice point, given out as faces ask for it.
    let mut vertices: Vec<Option<u32>> = vec![None; count];
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let cell = [x, y, z];
                if !filled(cell) {
                    continue;
                }
                for (side, quad) in CUBE_SIDES.into_iter().enumerate() {
                    // Sides come in the order −x, +x, −y, +y, −z, +z.
                    let (axis, up) = (side / 2, side % 2 == 1);
                    let mut beside = cell;
                    beside[axis] = if up { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
                    if beside[axis] < size[axis] && filled(beside) {
                        continue;
                    }
                    triangles.extend(split(quad.map(|corner| {
                        let at: [u32; 3] = std::array::from_fn(|i| cell[i] + (corner >> i & 1));
                        let [x, y, z] = at.map(|n| n as usize);
                        *vertices[(z * points[1] + y) * points[0] + x].get_or_insert_with(|| {
                            positions.push(at.map(|n| n as f32));
                            positions.len() as u32 - 1
                        })
                    })));
                }
            }
        }
    }
    build("voxels", positions, triangles)
}

/// The Menger sponge of side 3ⁿ in unit cells, n = `level`: F 4·20ⁿ + 8·8ⁿ, E 6·20ⁿ + 12·8ⁿ, volume 20ⁿ.
///
/// V and χ for levels 0 to 3: 8 and 2; 64 and −8 (genus 5); 896 and −160; 15,232 and −2816. Only the
/// boundary, with shared corners; every edge has two faces. Every coordinate is a small integer, so lights
/// on the lattice meet many edge-on faces, and most lights see several layers.
///
/// # Panics
///
/// Panics if `level` is over 5 (12.9 million faces).
#[must_use]
pub fn menger_sponge(level: u32) -> Mesh {
    assert!(level <= 5, "a Menger sponge of level {level} is too large: the highest level is 5");
    let side = 3_u32.pow(level);
    // A cell is empty where, at some scale, two of its three base-3 digits are the middle one.
    let filled = |mut cell: [u32; 3]| {
        (0..level).all(|_| {
            let middle = cell.iter().filter(|&&n| n % 3 == 1).count();
            cell = cell.map(|n| n / 3);
            middle < 2
        })
    };
    voxels([side; 3], filled).with_name(format!("Menger sponge {level}"))
}

/// Two unit cubes that share one edge and its two vertices: V 14, E 35, F 24, χ 3.
///
/// Closed; the shared edge has four faces, two in each direction. Which of them pair up decides whether there
/// is one shell or two: an edge table with two slots overwrites.
#[must_use]
pub fn cubes_sharing_edge() -> Mesh {
    voxels([2, 2, 1], |[x, y, _]| x == y).with_name("cubes sharing an edge")
}

/// Two unit cubes that share one vertex: V 15, E 36, F 24, χ 3.
///
/// Closed, every edge has two faces, and yet the shared vertex is not manifold: its faces form two fans.
#[must_use]
pub fn cubes_sharing_vertex() -> Mesh {
    voxels([2, 2, 2], |[x, y, z]| x == y && y == z).with_name("cubes sharing a vertex")
}
