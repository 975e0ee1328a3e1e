//! Closed solids.

use super::circle::turn;
use super::{Mesh, build, grid, inside_out, split};

/// The six sides of a box whose corner `i` is low or high in x, y, z by bits 0, 1, 2 of `i`.
pub(super) const CUBE_SIDES: [[u32; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The cube [−1, 1]³: V 8, E 18, F 12, χ 2.
///
/// Vertex `i` lies high in x, y, z where bit 0, 1, 2 of `i` is set; faces come in pairs, one pair a side,
/// in the order −x, +x, −y, +y, −z, +z. Lit along a body diagonal, its silhouette has six edges.
///
/// ```
/// let cube = umbrage::testing::shapes::cube();
/// assert_eq!((cube.vertex_count(), cube.face_count()), (8, 12));
/// ```
#[must_use]
pub fn cube() -> Mesh {
    cuboid([-1.0; 3], [1.0; 3]).with_name("cube")
}

/// An axis-aligned box from corner `low` to corner `high`, laid out as [`cube`]: V 8, E 18, F 12, χ 2.
///
/// Flat where `low` equals `high` in a coordinate, inside out where an odd number of them is swapped.
///
/// # Panics
///
/// Panics if a coordinate is not finite.
#[must_use]
pub fn cuboid(low: [f32; 3], high: [f32; 3]) -> Mesh {
    let corner =
        |i: usize| std::array::from_fn(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
    build("cuboid", (0..8).map(corner).collect(), CUBE_SIDES.into_iter().flat_map(split).collect())
}

/// The regular tetrahedron on four corners of [`cube`], exact: V 4, E 6, F 4, χ 2, volume 8/3.
#[must_use]
pub fn tetrahedron() -> Mesh {
    let positions = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    build("tetrahedron", positions, vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
}

/// The regular octahedron with its corners one unit along each axis, exact: V 6, E 12, F 8, χ 2, volume 4/3.
#[must_use]
pub fn octahedron() -> Mesh {
    let positions = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let triangles =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    build("octahedron", positions, triangles)
}

/// The unit sphere: an icosahedron, each face cut into four `subdivisions` times and pushed out to radius 1.
///
/// With 4ⁿ for n subdivisions: V 10·4ⁿ + 2, E 30·4ⁿ, F 20·4ⁿ, χ 2. The four parts of a face are stored side
/// by side in the list, at every level, so that faces near in the list are near in space. Good for timing:
/// 1.3 million faces at n = 8. Linear in the faces, without hashing.
///
/// # Panics
///
/// Panics if `subdivisions` is over 13: more faces than ids.
#[must_use]
pub fn icosphere(subdivisions: u32) -> Mesh {
    assert!(subdivisions <= 13, "{subdivisions} subdivisions make more faces than 32-bit ids can name");
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions = Vec::with_capacity((10 << (2 * subdivisions)) + 2);
    for [a, b] in [[-1.0, golden], [1.0, golden], [-1.0, -golden], [1.0, -golden]] {
        positions.push(unit([a, b, 0.0]));
    }
    for [a, b] in [[-1.0, golden], [1.0, golden], [-1.0, -golden], [1.0, -golden]] {
        positions.push(unit([0.0, a, b]));
    }
    for [a, b] in [[-1.0, golden], [1.0, golden], [-1.0, -golden], [1.0, -golden]] {
        positions.push(unit([b, 0.0, a]));
    }
    #[rustfmt::skip]
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2],
        [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11],
        [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    let (mut edges, mut sides) = edges_of(&triangles);
    for _ in 0..subdivisions {
        // Edge e gets its midpoint as vertex `first + e`, and becomes the edges 2e (at its tail) and 2e + 1.
        let first = positions.len() as u32;
        for &[tail, head] in &edges {
            let (p, q) = (positions[tail as usize], positions[head as usize]);
            positions.push(unit(std::array::from_fn(|i| f64::from(p[i]) + f64::from(q[i]))));
        }
        let half = |edge: u32, vertex: u32| 2 * edge + u32::from(edges[edge as usize][0] != vertex);
        let mut next_edges = Vec::with_capacity(4 * edges.len());
        for (middle, &[tail, head]) in (first..).zip(&edges) {
            next_edges.extend([[tail, middle], [middle, head]]);
        }
        let mut next_triangles = Vec::with_capacity(4 * triangles.len());
        let mut next_sides = Vec::with_capacity(4 * triangles.len());
        for (&[a, b, c], &[ab, bc, ca]) in triangles.iter().zip(&sides) {
            let [x, y, z] = [first + ab, first + bc, first + ca];
            let inner = next_edges.len() as u32;
            let [zx, xy, yz] = [inner, inner + 1, inner + 2];
            next_edges.extend([[z, x], [x, y], [y, z]]);
            next_triangles.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
            next_sides.extend([
                [half(ab, a), zx, half(ca, a)],
                [half(ab, b), half(bc, b), xy],
                [yz, half(bc, c), half(ca, c)],
                [xy, yz, zx],
            ]);
        }
        (edges, triangles, sides) = (next_edges, next_triangles, next_sides);
    }
    build(format!("icosphere {subdivisions}"), positions, triangles)
}

/// The edges of a few triangles, and for each triangle which three of them it has. Quadratic.
fn edges_of(triangles: &[[u32; 3]]) -> (Vec<[u32; 2]>, Vec<[u32; 3]>) {
    let mut edges: Vec<[u32; 2]> = Vec::new();
    let sides = triangles.iter().map(|&[a, b, c]| {
        [[a, b], [b, c], [c, a]].map(|[tail, head]| {
            let known = edges.iter().position(|&edge| edge == [tail, head] || edge == [head, tail]);
            known.unwrap_or_else(|| {
                edges.push([tail, head]);
                edges.len() - 1
            }) as u32
        })
    });
    let sides = sides.collect();
    (edges, sides)
}

/// `v` at length 1, rounded to `f32` once.
fn unit(v: [f64; 3]) -> [f32; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| (x / length) as f32)
}

/// A torus around the z axis: V mn, E 3mn, F 2mn, χ 0, for m `major_segments` around the axis and n
/// `minor_segments` around the tube.
///
/// `major_radius` reaches to the middle of the tube, `minor_radius` is the tube's own. It crosses itself
/// where the minor radius is the larger one.
///
/// # Panics
///
/// Panics if a count is below 3, the faces are more than ids, or a coordinate is not finite.
#[must_use]
pub fn torus(major_segments: u32, minor_segments: u32, major_radius: f32, minor_radius: f32) -> Mesh {
    let [r, tube] = [major_radius, minor_radius].map(f64::from);
    ring_surface("torus", major_segments, minor_segments, |i, j| {
        let ([cos_u, sin_u], [cos_v, sin_v]) =
            (turn(i.into(), major_segments.into()), turn(j.into(), minor_segments.into()));
        let out = r + tube * cos_v;
        [out * cos_u, out * sin_u, tube * sin_v]
    })
}

/// A tube of radius `tube_radius` along the (p, q) torus knot: V mn, E 3mn, F 2mn, χ 0, for m `segments`
/// along the knot and n `ring_segments` around the tube.
///
/// The knot lies on the torus with radii 2 and 1 around the z axis; it winds `p` times around the axis and
/// `q` times through the hole. (2, 3) is the trefoil, whose tube stays clear of itself up to a radius of
/// about 0.4. Good for long silhouettes with many crossings.
///
/// # Panics
///
/// Panics if a count is below 3, `p` and `q` have a common divisor, the faces are more than ids, or a
/// coordinate is not finite.
#[must_use]
pub fn torus_knot(p: u32, q: u32, segments: u32, ring_segments: u32, tube_radius: f32) -> Mesh {
    let (mut a, mut b) = (p, q);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    assert!(a == 1, "a ({p}, {q}) torus knot runs over itself: the numbers have the common divisor {a}");
    let radius = f64::from(tube_radius);
    ring_surface(&format!("torus knot {p} {q}"), segments, ring_segments, |i, j| {
        let [cos_p, sin_p] = turn(u64::from(p) * u64::from(i), segments.into());
        let [cos_q, sin_q] = turn(u64::from(q) * u64::from(i), segments.into());
        let out = 2.0 + cos_q;
        let center = [out * cos_p, out * sin_p, sin_q];
        // The torus's normal is square to every curve on the torus: a frame that closes and never flips.
        let normal = [cos_q * cos_p, cos_q * sin_p, sin_q];
        let (p, q) = (f64::from(p), f64::from(q));
        let tangent = [-q * sin_q * cos_p - p * out * sin_p, -q * sin_q * sin_p + p * out * cos_p, q * cos_q];
        let length = tangent.iter().map(|x| x * x).sum::<f64>().sqrt();
        let side = [
            normal[1] * tangent[2] - normal[2] * tangent[1],
            normal[2] * tangent[0] - normal[0] * tangent[2],
            normal[0] * tangent[1] - normal[1] * tangent[0],
        ];
        let [cos_v, sin_v] = turn(j.into(), ring_segments.into());
        std::array::from_fn(|i| center[i] + radius * (cos_v * normal[i] + sin_v * side[i] / length))
    })
}

/// A grid of `columns` × `rows` quads that closes in both directions, its corners at `point(column, row)`.
fn ring_surface(name: &str, columns: u32, rows: u32, point: impl Fn(u32, u32) -> [f64; 3]) -> Mesh {
    assert!(columns >= 3 && rows >= 3, "{columns} × {rows} segments do not close: each count is at least 3");
    assert!(
        columns.checked_mul(rows).is_some(),
        "{columns} × {rows} segments are more than 32-bit ids can name"
    );
    let positions = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    let positions = positions.map(|(i, j)| point(i, j).map(|x| x as f32)).collect();
    build(name, positions, grid(columns, rows, |i, j| i % columns * rows + j % rows))
}

/// A cube with a cubic cavity, [−2, 2]³ without [−1, 1]³: V 16, E 36, F 24, χ 4, volume 56.
///
/// Two shells; the inner one has negative volume and is sound, as it bounds a hole.
#[must_use]
pub fn hollow_cube() -> Mesh {
    let (outer, cavity) = (cuboid([-2.0; 3], [2.0; 3]).with_name("outer"), cube().with_name("cavity"));
    joined("hollow cube", &[outer, inside_out(&cavity).with_name("cavity")])
}

/// The cubes [−k, k]³ for k = `count` … 1, one in another, every one facing outward: V 8n, E 18n, F 12n, χ
/// 2n.
///
/// A ray to the middle enters n volumes and leaves none: what overflows an 8-bit stencil. Nesting parity
/// makes every second shell inside out.
///
/// # Panics
///
/// Panics if `count` is over 2²⁴, where sizes stop being distinct.
#[must_use]
pub fn nested_cubes(count: u32) -> Mesh {
    assert!(count <= 1 << 24, "{count} nested cubes: their sizes are distinct up to 2^24");
    let cubes: Vec<Mesh> = (1..=count)
        .rev()
        .map(|k| cuboid([-(k as f32); 3], [k as f32; 3]).with_name(format!("cube {k}")))
        .collect();
    joined("nested cubes", &cubes)
}

/// A watertight prism, z from −1 to 1, over a polygon that crosses itself: V 8, E 18, F 12, χ 2, volume 6.
///
/// The polygon is (2, −2), (2, 2), (−1, −1), (−1, 1): its sides cross at the origin, the lobe at positive x
/// has winding number +1 and area 4, the one at negative x has −1 and area 1. Combinatorially a cube, so no
/// edge count finds anything, while a winding-number test that stops at "inside or outside" errs in the
/// lesser lobe.
#[must_use]
pub fn figure_eight_prism() -> Mesh {
    let polygon = [[2.0, -2.0], [2.0, 2.0], [-1.0, -1.0], [-1.0, 1.0]];
    let positions = [-1.0, 1.0].into_iter().flat_map(|z| polygon.map(|[x, y]| [x, y, z])).collect();
    let mut triangles = Vec::from(split([4, 5, 6, 7]));
    triangles.extend(split([0, 3, 2, 1]));
    for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        triangles.extend(split([i, j, j + 4, i + 4]));
    }
    build("figure-eight prism", positions, triangles)
}

/// Several meshes as one, each a part.
fn joined(name: &str, meshes: &[Mesh]) -> Mesh {
    Mesh::concat(meshes)
        .unwrap_or_else(|error| panic!("the arguments of a generated mesh are out of range: {error}"))
        .with_name(name)
}
