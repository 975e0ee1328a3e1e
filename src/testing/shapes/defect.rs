//! Cubes and tetrahedra with one known defect each.

use super::{Mesh, build, cube};

/// [`cube`] without its top (+z): V 8, E 17, F 10, χ 1. One boundary loop of four edges.
#[must_use]
pub fn open_cube() -> Mesh {
    let (positions, mut triangles, ..) = cube().into_parts();
    triangles.truncate(10);
    build("open cube", positions, triangles)
}

/// [`cube`] with the winding of its last face reversed: V 8, E 18, F 12, χ 2. Three misoriented edges.
#[must_use]
pub fn misoriented_cube() -> Mesh {
    let (positions, mut triangles, ..) = cube().into_parts();
    triangles[11].swap(1, 2);
    build("misoriented cube", positions, triangles)
}

/// [`cube`] with its last face twice: V 8, E 18, F 13, χ 3. Three edges with three faces.
#[must_use]
pub fn duplicated_face() -> Mesh {
    let (positions, mut triangles, ..) = cube().into_parts();
    triangles.push(triangles[11]);
    build("duplicated face", positions, triangles)
}

/// [`cube`] with its edge from vertex 4 to 5 split at the middle in the top only: V 9, E 21, F 13, χ 1.
///
/// Looks closed, and is not: vertex 8 lies exactly on the undivided edge of the neighbor, and three boundary
/// edges lie on top of each other.
#[must_use]
pub fn t_junction() -> Mesh {
    let (mut positions, mut triangles, ..) = cube().into_parts();
    positions.push([0.0, -1.0, 1.0]);
    debug_assert_eq!(triangles[10], [4, 5, 7]);
    triangles[10] = [4, 8, 7];
    triangles.push([8, 5, 7]);
    build("T-junction", positions, triangles)
}

/// [`t_junction`] with its slit closed by a face without area: V 9, E 21, F 14, χ 2.
///
/// Watertight; the corners of the last face lie on one line, so it is edge-on to every light.
#[must_use]
pub fn collinear_face() -> Mesh {
    let (positions, mut triangles, ..) = t_junction().into_parts();
    triangles.push([4, 5, 8]);
    build("collinear face", positions, triangles)
}

/// [`cube`] whose top (+z) has its own four vertices, `gap_ulps` units in the last place above the rest:
/// V 12, E 22, F 12, χ 2. Eight boundary edges.
///
/// With 0 an exact weld closes it; with more only a weld with a tolerance of at least `gap_ulps` · 2⁻²³ does.
///
/// # Panics
///
/// Panics if `gap_ulps` is 2³⁰ or more, where numbers end.
#[must_use]
pub fn seam(gap_ulps: u32) -> Mesh {
    assert!(gap_ulps < 1 << 30, "a gap of {gap_ulps} units in the last place leaves the range of f32");
    let (mut positions, mut triangles, ..) = cube().into_parts();
    positions.extend_from_within(4..);
    for position in &mut positions[8..] {
        position[2] = f32::from_bits(1_f32.to_bits() + gap_ulps);
    }
    for triangle in &mut triangles[10..] {
        *triangle = triangle.map(|vertex| vertex + 4);
    }
    build(format!("seam {gap_ulps}"), positions, triangles)
}

/// A tetrahedron that is flat to 2⁻⁴⁰: V 4, E 6, F 4, χ 2, volume 2⁻⁴⁰/3.
///
/// The first face is a needle 2 long and 2⁻⁴⁰ high. Watertight, and exact in `f32`, while
/// three faces all but coincide: from most lights their orientation is below the rounding of plain `f32`.
#[must_use]
pub fn sliver() -> Mesh {
    let height = f32::EPSILON / (1 << 17) as f32;
    let positions = vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, height, 0.0], [0.0, 0.0, 1.0]];
    build("sliver", positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}
