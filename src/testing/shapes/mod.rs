//! Generated meshes: small known shapes, sound and broken, for tests, benches, examples and the demo.
//!
//! Each function says how many vertices (V), edges (E) and faces (F) its mesh has and its Euler
//! characteristic χ = V − E + F, before any weld. Lengths are mesh units; faces run counter-clockwise seen
//! from outside. Vertices are shared between faces unless the function says otherwise.
//!
//! The same arguments give the same bytes on every platform: coordinates come from `+ − × ÷ √` alone, which
//! IEEE 754 rounds in one way only, never from the platform's sine.
//!
//! - sound: [`cube`], [`cuboid`], [`tetrahedron`], [`octahedron`], [`icosphere`], [`torus`], [`torus_knot`],
//!   [`menger_sponge`], [`hollow_cube`]
//! - closed and hard: [`voxels`], [`nested_cubes`], [`figure_eight_prism`], [`cubes_sharing_edge`],
//!   [`cubes_sharing_vertex`], [`sliver`], [`collinear_face`], [`double_sheet`]
//! - open: [`sheet`], [`mobius`], [`book`], [`open_cube`], [`t_junction`], [`seam`], [`uv_capsule`]
//! - badly wound or doubled: [`duplicated_face`], [`misoriented_cube`], [`inside_out`]
//! - the same shape, stored otherwise: [`shuffled`], [`soup`], [`translated`], [`scaled`]

mod arrange;
mod circle;
mod closed;
mod defect;
mod open;
mod voxel;

#[cfg(test)]
mod tests;

use crate::mesh::Mesh;

pub use arrange::{inside_out, scaled, shuffled, soup, translated};
pub use closed::{
    cube, cuboid, figure_eight_prism, hollow_cube, icosphere, nested_cubes, octahedron, tetrahedron, torus,
    torus_knot,
};
pub use defect::{collinear_face, duplicated_face, misoriented_cube, open_cube, seam, sliver, t_junction};
pub use open::{book, double_sheet, mobius, sheet, uv_capsule};
pub use voxel::{cubes_sharing_edge, cubes_sharing_vertex, menger_sponge, voxels};

/// A mesh from a generator, which knows that its indices are in range.
fn build(name: impl Into<String>, positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(positions, triangles)
        .unwrap_or_else(|error| panic!("the arguments of a generated mesh are out of range: {error}"))
        .with_name(name)
}

/// A quad, counter-clockwise from the front, as two triangles on the diagonal from its first corner.
fn split([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// The triangles of a grid of `columns` × `rows` quads whose corner in column `i` and row `j` is `vertex(i,
/// j)`.
///
/// Front-facing where the step to the next column crossed with the step to the next row points at the viewer.
fn grid(columns: u32, rows: u32, vertex: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(2 * columns as usize * rows as usize);
    for i in 0..columns {
        for j in 0..rows {
            let quad = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            triangles.extend(split(quad));
        }
    }
    triangles
}
