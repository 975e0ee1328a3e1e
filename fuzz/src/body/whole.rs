//! Signs and distances by big integers (multiples of 2⁻¹⁴⁹), sharing no code with the crate.

use num_bigint::{BigInt, Sign};
use umbrage::geom::Light;

pub(crate) type Vector = [BigInt; 3];

pub(crate) fn vector(p: [f32; 3]) -> Vector {
    p.map(|x| {
        let bits = x.to_bits();
        let (exponent, fraction) = (bits >> 23 & 0xff, bits & 0x007f_ffff);
        let magnitude = match exponent {
            0 => BigInt::from(fraction),
            _ => BigInt::from(fraction | 0x0080_0000) << (exponent - 1),
        };
        if bits >> 31 == 1 { -magnitude } else { magnitude }
    })
}

pub(crate) fn minus(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// −1, 0 or 1.
pub(crate) fn sign(x: &BigInt) -> i8 {
    match x.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

fn normal(corners: [[f32; 3]; 3]) -> (Vector, Vector) {
    let [a, b, c] = corners.map(vector);
    (cross(&minus(&b, &a), &minus(&c, &a)), a)
}

/// The side of a face that the light is on.
pub(crate) fn side_of_light(corners: [[f32; 3]; 3], light: &Light) -> i8 {
    let (normal, a) = normal(corners);
    let light_at = vector(light.xyz());
    let to_light = if light.is_directional() { light_at } else { minus(&light_at, &a) };
    sign(&dot(&normal, &to_light))
}

/// The side of a face that a point is on.
pub(crate) fn side_of_point(corners: [[f32; 3]; 3], p: [f32; 3]) -> i8 {
    let (normal, a) = normal(corners);
    sign(&dot(&normal, &minus(&vector(p), &a)))
}

/// Whether three points lie on one line.
pub(crate) fn collinear(corners: [[f32; 3]; 3]) -> bool {
    normal(corners).0.iter().all(|x| sign(x) == 0)
}

/// How far along the ray the plane of a face lies, as a fraction with a positive denominator; the ray is not
/// parallel to it.
pub(crate) fn distance(corners: [[f32; 3]; 3], origin: [f32; 3], direction: [f32; 3]) -> (BigInt, BigInt) {
    let (normal, a) = normal(corners);
    let (above, climb) = (dot(&normal, &minus(&vector(origin), &a)), dot(&normal, &vector(direction)));
    if sign(&climb) > 0 { (-above, climb) } else { (above, -climb) }
}

/// Whether two points are at most `reach` apart; `None` where that is so to 2⁻⁴⁰ of it, but not exactly.
pub(crate) fn is_within(a: [f32; 3], b: [f32; 3], reach: f32) -> Option<bool> {
    let between = minus(&vector(a), &vector(b));
    let [reach, ..] = vector([reach; 3]);
    let (square, most) = (dot(&between, &between), &reach * &reach);
    let gap: BigInt = &most - &square;
    let is_rounding = sign(&gap) != 0 && (if sign(&gap) > 0 { gap.clone() } else { -&gap }) << 40 < most;
    (!is_rounding).then_some(sign(&gap) >= 0)
}

/// The sign of the volume that faces enclose.
pub(crate) fn volume_sign(faces: impl Iterator<Item = [[f32; 3]; 3]>) -> i8 {
    let sum: BigInt = faces.map(|corners| corners.map(vector)).map(|[a, b, c]| dot(&a, &cross(&b, &c))).sum();
    sign(&sum)
}

/// Whether two closed triangles with area have a point in common: the separating axis test.
///
/// They have none iff their projections are disjoint on a normal, on the cross product of two edges, or, in
/// one plane, on the normal of an edge.
pub(crate) fn intersect(f: [[f32; 3]; 3], g: [[f32; 3]; 3]) -> bool {
    let (f, g) = (f.map(vector), g.map(vector));
    let edges = |[a, b, c]: &[Vector; 3]| [minus(b, a), minus(c, b), minus(a, c)];
    let (of_f, of_g) = (edges(&f), edges(&g));
    let normals = [cross(&of_f[0], &of_f[1]), cross(&of_g[0], &of_g[1])];
    let in_plane = |normal: &Vector, edges: &[Vector; 3]| edges.clone().map(|edge| cross(normal, &edge));
    let products = of_f.iter().flat_map(|e| of_g.iter().map(move |h| cross(e, h)));
    let mut axes = products
        .chain(in_plane(&normals[0], &of_f))
        .chain(in_plane(&normals[1], &of_g))
        .chain(normals.clone());
    !axes.any(|axis| {
        let projection = |corners: &[Vector; 3]| {
            let mut along = corners.clone().map(|corner| dot(&corner, &axis));
            along.sort();
            along
        };
        let (f, g) = (projection(&f), projection(&g));
        f[2] < g[0] || g[2] < f[0]
    })
}
