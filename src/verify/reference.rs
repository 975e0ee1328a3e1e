//! Big-integer reference for shadow rays and face sides, sharing no code with the predicates.
//!
//! Coordinates become integers (multiples of 2⁻¹⁴⁹). The point where the segment's line meets a face's plane
//! is a fraction. Whether this point lies inside the face is decided from the face's own cross product. Slow,
//! and written to be obviously right.

use num_bigint::{BigInt, Sign};

use crate::geom::bvh::Step;
use crate::geom::{Facing, Light};
use crate::mesh::Mesh;
use crate::oracle::{Crossings, Oracle, Verdict};

type Vector = [BigInt; 3];

/// Result of the big-integer reference for one shadow ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reference {
    /// The crossings and touches of the shadow ray.
    pub crossings: Crossings,
    /// Number of faces decided with big integers. The bounding boxes of all other faces are disjoint from the
    /// segment's box.
    pub looked_at: usize,
}

/// Crossings of the segment from `p` to `light` with all faces, decided with big integers. Cost: a few
/// microseconds per face whose box meets the segment's box.
#[must_use]
pub fn reference(mesh: &Mesh, p: [f32; 3], light: &Light) -> Reference {
    let mut found = Reference { crossings: Crossings::default(), looked_at: 0 };
    let (start, step, endless) = way(p, light);
    for corners in mesh.triangles() {
        let corners = corners.map(|vertex| mesh.positions()[vertex as usize]);
        if apart(p, light, corners) {
            continue;
        }
        found.looked_at += 1;
        match meeting(&start, &step, endless, &corners.map(vector)) {
            Some(0) => found.crossings.touching += 1,
            Some(1) => found.crossings.front += 1,
            Some(_) => found.crossings.back += 1,
            None => {}
        }
    }
    found
}

impl Oracle {
    /// As [`Oracle::verdict`], but every face that the tree does not cull is decided with big integers. The
    /// two methods share the tree, but no sign. Cost: a few microseconds per face near the segment.
    #[must_use]
    pub fn verdict_in_whole_numbers(&self, p: [f32; 3], light: &Light) -> Verdict {
        let (start, step, endless) = way(p, light);
        let mut verdict = Verdict::Lit;
        self.tree.walk::<false>(p, light, |slot| {
            let corners = self.triangles[slot];
            if !apart(p, light, corners) {
                match meeting(&start, &step, endless, &corners.map(vector)) {
                    None => {}
                    Some(0) => verdict = Verdict::Grazing,
                    Some(_) => verdict = Verdict::Shadowed,
                }
            }
            if verdict == Verdict::Shadowed { Step::Stop } else { Step::On }
        });
        verdict
    }
}

/// The plane of a face in big integers, for any number of lights.
pub(crate) struct WholePlane {
    normal: Vector,
    /// The dot product of the normal and a corner.
    offset: BigInt,
}

impl WholePlane {
    pub(crate) fn of(corners: [[f32; 3]; 3]) -> Self {
        let [a, b, c] = corners.map(vector);
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        let offset = dot(&normal, &a);
        Self { normal, offset }
    }

    /// The side of the plane that a light lies on.
    pub(crate) fn side(&self, light: &WholeLight) -> Facing {
        let mut height = dot(&self.normal, &light.xyz);
        if !light.is_directional {
            height -= &self.offset;
        }
        match sign(&height) {
            1 => Facing::Front,
            0 => Facing::EdgeOn,
            _ => Facing::Back,
        }
    }
}

/// A light in big integers.
pub(crate) struct WholeLight {
    xyz: Vector,
    is_directional: bool,
}

impl From<&Light> for WholeLight {
    fn from(light: &Light) -> Self {
        Self { xyz: vector(light.xyz()), is_directional: light.is_directional() }
    }
}

/// The shadow ray: start + t·step for 0 < t, and t < 1 unless the ray is unbounded (`endless`).
fn way(p: [f32; 3], light: &Light) -> (Vector, Vector, bool) {
    let (start, to_light) = (vector(p), vector(light.xyz()));
    let step = if light.is_directional() { to_light } else { minus(&to_light, &start) };
    (start, step, light.is_directional())
}

/// Whether the bounding boxes of the shadow ray and of the triangle are disjoint.
fn apart(p: [f32; 3], light: &Light, corners: [[f32; 3]; 3]) -> bool {
    (0..3).any(|i| {
        let towards = light.xyz()[i];
        let (low, high) = match (light.is_directional(), towards) {
            (false, l) => (p[i].min(l), p[i].max(l)),
            (true, d) if d > 0.0 => (p[i], f32::INFINITY),
            (true, d) if d < 0.0 => (f32::NEG_INFINITY, p[i]),
            _ => (p[i], p[i]),
        };
        corners.iter().all(|corner| corner[i] < low) || corners.iter().all(|corner| corner[i] > high)
    })
}

/// Intersection of a shadow ray and a triangle. `None`: disjoint. `Some(1)`, `Some(-1)`: crossed, with the
/// light in front of or behind the face. `Some(0)`: touched.
fn meeting(start: &Vector, step: &Vector, endless: bool, [a, b, c]: &[Vector; 3]) -> Option<i32> {
    if is_zero(step) {
        return None;
    }
    let normal = cross(&minus(b, a), &minus(c, a));
    if is_zero(&normal) {
        return touches_line(start, step, endless, [a, b, c]).then_some(0);
    }
    // height(t) = above + t·climb
    let (above, climb) = (dot(&normal, &minus(start, a)), dot(&normal, step));
    if sign(&climb) == 0 {
        return (sign(&above) == 0 && touches_in_plane(start, step, endless, [a, b, c], &normal))
            .then_some(0);
    }
    // t = −above / climb, with a positive denominator.
    let (numerator, denominator) =
        if sign(&climb) > 0 { (-above, climb.clone()) } else { (above, -climb.clone()) };
    if sign(&numerator) <= 0 || (!endless && numerator >= denominator) {
        return None;
    }
    // denominator · (point − from), and the side of each edge on which the point lies.
    let hands = [(a, b), (b, c), (c, a)].map(|(from, to)| {
        let reach = plus(&times(&minus(start, from), &denominator), &times(step, &numerator));
        sign(&dot(&cross(&minus(to, from), &reach), &normal))
    });
    match (hands.contains(&-1), hands.contains(&0)) {
        (true, _) => None,
        (false, true) => Some(0),
        // A ray towards a light in front of the face leaves the face on its front side: climb > 0.
        (false, false) => Some(sign(&climb)),
    }
}

/// Whether a ray in the face's plane touches the face: clips the ray's interval against each edge.
fn touches_in_plane(
    start: &Vector,
    step: &Vector,
    endless: bool,
    [a, b, c]: [&Vector; 3],
    normal: &Vector,
) -> bool {
    // Interval bounds are fractions, `None` for no bound. The ray's own bounds are open, the edges' bounds
    // closed.
    let mut from = (BigInt::from(0), BigInt::from(1));
    let mut to = (!endless).then(|| (BigInt::from(1), BigInt::from(1)));
    let (mut from_open, mut to_open) = (true, true);
    for (tail, head) in [(a, b), (b, c), (c, a)] {
        let edge = minus(head, tail);
        let inside = dot(&cross(&edge, &minus(start, tail)), normal);
        let change = dot(&cross(&edge, step), normal);
        match sign(&change) {
            0 if sign(&inside) < 0 => return false,
            0 => {}
            1 => {
                let at = (-inside, change);
                if less(&from, &at) {
                    (from, from_open) = (at, false);
                }
            }
            _ => {
                let at = (inside, -change);
                if to.as_ref().is_none_or(|to| less(&at, to)) {
                    (to, to_open) = (Some(at), false);
                }
            }
        }
    }
    to.is_none_or(|to| less(&from, &to) || (!less(&to, &from) && !from_open && !to_open))
}

/// Whether the ray touches a face that has collapsed to a closed segment or a point.
fn touches_line(start: &Vector, step: &Vector, endless: bool, corners: [&Vector; 3]) -> bool {
    let (low, high) = (corners.iter().min().expect("three"), corners.iter().max().expect("three"));
    let along = minus(high, low);
    let across = cross(step, &along);
    let offset = minus(low, start);
    if is_zero(&across) {
        if !is_zero(&cross(&offset, step)) {
            return false;
        }
        let [first, last] = [low, high].map(|end| dot(&minus(end, start), step));
        let (first, last) = if first < last { (first, last) } else { (last, first) };
        return sign(&last) > 0 && (endless || first < dot(step, step));
    }
    if sign(&dot(&offset, &across)) != 0 {
        return false;
    }
    let unit = dot(&across, &across);
    let t = dot(&cross(&offset, &along), &across);
    let s = dot(&cross(&offset, step), &across);
    sign(&t) > 0 && (endless || t < unit) && sign(&s) >= 0 && s <= unit
}

/// `a < b` for fractions with positive denominators.
fn less(a: &(BigInt, BigInt), b: &(BigInt, BigInt)) -> bool {
    &a.0 * &b.1 < &b.0 * &a.1
}

fn vector(p: [f32; 3]) -> Vector {
    p.map(|x| {
        let bits = x.to_bits();
        let (exponent, fraction) = ((bits >> 23) & 0xff, bits & 0x007f_ffff);
        let magnitude = if exponent == 0 {
            BigInt::from(fraction)
        } else {
            BigInt::from(fraction | 0x0080_0000) << (exponent - 1)
        };
        if x.is_sign_negative() { -magnitude } else { magnitude }
    })
}

fn plus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] + &b[i])
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn times(a: &Vector, factor: &BigInt) -> Vector {
    std::array::from_fn(|i| &a[i] * factor)
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [&a[1] * &b[2] - &a[2] * &b[1], &a[2] * &b[0] - &a[0] * &b[2], &a[0] * &b[1] - &a[1] * &b[0]]
}

fn dot(a: &Vector, b: &Vector) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn sign(x: &BigInt) -> i32 {
    match x.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

fn is_zero(a: &Vector) -> bool {
    a.iter().all(|x| x.sign() == Sign::NoSign)
}
