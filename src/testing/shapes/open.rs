//! Open surfaces, and one that is closed and encloses nothing.

use super::circle::turn;
use super::{Mesh, build, grid};

/// The square [0, n]² in the plane z = 0 as n × n unit quads, facing +z: V (n + 1)², E 3n² + 2n, F 2n², χ 1.
///
/// Its boundary is one loop of 4n edges.
///
/// # Panics
///
/// Panics if `quads` is 2¹⁵ or more: more faces than ids.
#[must_use]
pub fn sheet(quads: u32) -> Mesh {
    assert!(quads < 1 << 15, "a sheet of {quads} × {quads} quads has more faces than 32-bit ids can name");
    let points = quads + 1;
    let positions = (0..points).flat_map(|i| (0..points).map(move |j| [i as f32, j as f32, 0.0])).collect();
    build("sheet", positions, grid(quads, quads, |i, j| i * points + j))
}

/// [`sheet`] of one quad with each triangle a second time, with the opposite winding: V 4, E 5, F 4, χ 3.
///
/// Balanced and without a boundary edge; its volume is zero, and each face has a duplicate of opposite
/// winding.
#[must_use]
pub fn double_sheet() -> Mesh {
    let (positions, mut triangles, ..) = sheet(1).into_parts();
    triangles.extend_from_within(..);
    for triangle in &mut triangles[2..] {
        triangle.swap(1, 2);
    }
    build("double sheet", positions, triangles)
}

/// A Möbius strip of n `segments`, width 1, around a circle of radius 1 in the plane z = 0: V 2n, E 4n, F
/// 2n, χ 0.
///
/// Its boundary is one loop of 2n edges. No choice of windings agrees everywhere; here the one edge where the
/// strip closes is misoriented.
///
/// # Panics
///
/// Panics if `segments` is below 3, or the faces are more than ids.
#[must_use]
pub fn mobius(segments: u32) -> Mesh {
    assert!(segments >= 3, "a strip of {segments} segments does not close: at least 3");
    assert!(segments < 1 << 29, "a strip of {segments} segments has more faces than 32-bit ids can name");
    let positions = (0..segments).flat_map(|i| {
        let ([cos_u, sin_u], [cos_half, sin_half]) =
            (turn(i.into(), segments.into()), turn(i.into(), 2 * u64::from(segments)));
        [-0.5, 0.5].map(|across| {
            let out = 1.0 + across * cos_half;
            [out * cos_u, out * sin_u, across * sin_half].map(|x| x as f32)
        })
    });
    let positions = positions.collect();
    // Half a turn swaps the two rims.
    let triangles = grid(segments, 1, |i, j| if i == segments { 1 - j } else { 2 * i + j });
    build("Möbius strip", positions, triangles)
}

/// Triangles on one shared edge, spread evenly around it: V n + 2, E 2n + 1, F n, χ 1, for n `pages`.
///
/// The edge runs from the origin to (0, 0, 1), in the same direction in every triangle: n faces on one edge,
/// all against each other.
///
/// # Panics
///
/// Panics if the faces are more than ids.
#[must_use]
pub fn book(pages: u32) -> Mesh {
    assert!(pages < 1 << 30, "{pages} pages are more faces than 32-bit ids can name");
    let mut positions = vec![[0.0; 3], [0.0, 0.0, 1.0]];
    positions.extend((0..pages).map(|page| {
        let [x, y] = turn(page.into(), pages.into());
        [x as f32, y as f32, 0.5]
    }));
    build("book", positions, (0..pages).map(|page| [0, 1, page + 2]).collect())
}

/// A capsule around the z axis as modelling programs write it: a grid of longitudes and latitudes that is
/// sewn up by position alone. V (s + 1)(2r + 2), F 2s(2r + 1), E their sum − 1, χ 1, for s `segments`
/// around and r `rings` of quads on each hemisphere.
///
/// The first column of vertices repeats as the last, and each pole is s + 1 vertices at one point. An exact
/// weld leaves 2rs + 2 vertices, and 2s faces collapse, the s at each pole; what remains is closed with χ
/// 2. `half_length` is the distance from the middle to the center of a hemisphere.
///
/// # Panics
///
/// Panics if `segments` is below 3 or `rings` is 0, the faces are more than ids, or a coordinate is not
/// finite.
#[must_use]
pub fn uv_capsule(segments: u32, rings: u32, radius: f32, half_length: f32) -> Mesh {
    assert!(segments >= 3 && rings >= 1, "{segments} segments, {rings} rings: at least 3 and 1");
    let vertices = (u64::from(segments) + 1) * (2 * u64::from(rings) + 2);
    assert!(
        vertices < 1 << 29,
        "{segments} segments by {rings} rings have more faces than 32-bit ids can name"
    );
    let [radius, half_length] = [radius, half_length].map(f64::from);
    let rows = 2 * rings + 2;
    let mut positions = Vec::with_capacity(vertices as usize);
    for column in 0..=segments {
        let [cos_u, sin_u] = turn(column.into(), segments.into());
        for row in 0..rows {
            // From the south pole to the equator, the equator once more, and on to the north pole.
            let south = row <= rings;
            let latitude = if south { rings - row } else { row - rings - 1 };
            let [cos_v, sin_v] = turn(latitude.into(), 4 * u64::from(rings));
            let z = half_length + radius * sin_v;
            let out = radius * cos_v;
            positions.push([out * cos_u, out * sin_u, if south { -z } else { z }].map(|x| x as f32));
        }
    }
    build("capsule", positions, grid(segments, rows - 1, |i, j| i * rows + j))
}
