//! The boundary of everything that hides part of a light, seen from a receiver.
//!
//! Every face that the receiver does not see edge-on is turned so that its projection onto the light runs
//! counter-clockwise. The faces cover a light point at least as often as 0 times, and how often is the
//! winding number of their boundaries, added up. Edges between two faces cancel, so that only outlines are
//! left.
//!
//! Nothing is clipped at the sides of the pyramid. Every edge is taken whole, with its projection moved to
//! the nearest point of the light's square: u < 0 to u = 0, and so on. This map is continuous, so that each
//! face's boundary stays closed and winds around every point inside the square as often as before, and both
//! faces of an edge, cut or not, agree about it bit by bit. Two planes cut. At γ = 1, where the light is,
//! faces end, and the cut is part of the boundary. At γ = 0, across the receiver, projections go to infinity:
//! there the cut runs around the square, and the exact side of the face says which way.

use hashbrown::HashTable;
use hashbrown::hash_table::Entry;

use super::fault::{Fault, Faults};
use super::pyramid::{End, Place, Pyramid};
use super::sweep::{Edge, Kind};
use crate::geom::Light;
use crate::geom::predicate::{Homogeneous, Sign, directions_turn, side_of_point};

/// The chain of one receiver. Reused, so that most receivers allocate nothing.
#[derive(Debug, Default)]
pub(super) struct Chain {
    index: HashTable<u32>,
    sides: Vec<Side>,
    /// Cuts at the plane of the light.
    cuts: Vec<[Place; 2]>,
    /// Faces that are not outside of a side of the pyramid, nor seen edge-on.
    pub(super) faces: u32,
    /// What the winding number is just right of u = 0, before [`Chain::left`].
    pub(super) at_left: i32,
    /// Changes of that number along v.
    pub(super) left: Vec<(f64, i32)>,
    pub(super) edges: Vec<Edge>,
    /// Edges whose faces do not cancel.
    pub(super) outlines: u32,
    /// How large an area rounding may have moved across an edge.
    pub(super) moved: f64,
    /// A corner may lie on either side of a light whose plane is known in rounded numbers only.
    pub(super) doubtful: bool,
    pub(super) faults: Faults,
}

/// An edge, from its smaller vertex to its larger one.
#[derive(Clone, Copy, Debug)]
struct Side {
    vertices: [u32; 2],
    ends: [End; 2],
    times: i32,
}

/// A vertex below a receiver, at infinity, the first of several. No mesh has as many.
const NADIR: u32 = u32::MAX - 1;

const OUT_OF_RANGE: [u32; 6] = [1, 2, 4, 8, FAR, NEAR];
/// Not before the plane of the light.
const FAR: u32 = 16;
/// Not in front of the receiver.
const NEAR: u32 = 32;

impl Chain {
    pub(super) fn clear(&mut self) {
        self.index.clear();
        self.sides.clear();
        self.cuts.clear();
        self.left.clear();
        self.edges.clear();
        (self.faces, self.at_left, self.outlines) = (0, 0, 0);
        (self.moved, self.doubtful) = (0.0, false);
    }

    /// Adds the boundary of a face.
    #[inline(always)]
    pub(super) fn add(&mut self, pyramid: &Pyramid, corners: [[f32; 3]; 3], ids: [u32; 3]) {
        let codes = corners.map(|x| self.code(pyramid, pyramid.coordinates(x)));
        if codes[0] & codes[1] & codes[2] != 0 {
            return;
        }
        let side = side_of_point(corners, pyramid.p);
        if side.is_zero() && !self.faults.has(Fault::ZeroIsFront) {
            return;
        }
        self.doubtful |= corners.iter().any(|&x| pyramid.is_doubtful(x));
        self.add_seen(pyramid, corners.map(End::Corner), ids, codes, side);
    }

    /// Adds the boundary of a face with the receiver as its third corner, as seen from just off that corner
    /// in the direction opposite to `down`: of the triangle of directions to both other corners and `down`.
    /// A face that the receiver is on is three of these. Each direction down has a `number`, 0 or 1.
    pub(super) fn add_below(
        &mut self,
        pyramid: &Pyramid,
        [a, b]: [[f32; 3]; 2],
        ids: [u32; 2],
        down: [f32; 3],
        number: u32,
    ) {
        let ends = [End::Corner(a), End::Corner(b), End::Direction(down)];
        let codes = ends.map(|end| self.code(pyramid, pyramid.place(end).coordinates()));
        let Ok(receiver) = Light::point(pyramid.p) else { return };
        let [to_a, to_b] = [a, b].map(|x| Homogeneous::extruded(x, &receiver));
        // Counter-clockwise seen from the receiver is a left-handed triple.
        let side = -directions_turn([to_a, to_b, Homogeneous::point(down)]);
        if codes[0] & codes[1] & codes[2] == 0 && !side.is_zero() {
            self.add_seen(pyramid, ends, [ids[0], ids[1], NADIR + number], codes, side);
        }
    }

    /// The sides of the pyramid that a point is not inside of.
    #[inline(always)]
    fn code(&self, pyramid: &Pyramid, [a, b, g]: [f64; 3]) -> u32 {
        let far = self.ends_at_light(pyramid);
        let out = [a <= 0.0, b <= 0.0, g <= a, g <= b, far && g >= 1.0, g <= 0.0];
        (0..6).fold(0, |code, k| code | (u32::from(out[k]) * OUT_OF_RANGE[k]))
    }

    #[inline(always)]
    fn add_seen(
        &mut self,
        pyramid: &Pyramid,
        mut corners: [End; 3],
        mut ids: [u32; 3],
        mut codes: [u32; 3],
        side: Sign,
    ) {
        self.faces += 1;
        if (side == Sign::Positive) != pyramid.mirrored {
            corners.swap(1, 2);
            ids.swap(1, 2);
            codes.swap(1, 2);
        }
        for i in 0..3 {
            self.count([ids[i], ids[(i + 1) % 3]], [corners[i], corners[(i + 1) % 3]]);
        }
        let some = codes[0] | codes[1] | codes[2];
        if some & FAR != 0 {
            let ends =
                crossed(corners, codes, FAR).map(|[x, y]| far_cut(&pyramid.place(x), &pyramid.place(y)));
            self.cuts.push(ends);
        }
        if some & NEAR != 0 {
            let [left, back] = crossed(corners, codes, NEAR)
                .map(|[x, y]| cut_at_receiver(&pyramid.place(x), &pyramid.place(y)).b > 0.0);
            // The cut keeps the square on its left. From above to below it passes u = 0 on its way down,
            // which adds 1 right of there; from below to above it passes u = 1.
            self.at_left += i32::from(left && !back);
        }
    }

    fn ends_at_light(&self, pyramid: &Pyramid) -> bool {
        !pyramid.frame.at_infinity && !self.faults.has(Fault::NoFarPlane)
    }

    #[inline(always)]
    fn count(&mut self, mut vertices: [u32; 2], mut ends: [End; 2]) {
        let mut times = 1;
        if vertices[0] > vertices[1] {
            vertices.swap(0, 1);
            ends.swap(0, 1);
            times = -1;
        }
        let Self { index, sides, .. } = self;
        let same = |&at: &u32| sides[at as usize].vertices == vertices;
        let hash_of = |&at: &u32| hash(sides[at as usize].vertices);
        match index.entry(hash(vertices), same, hash_of) {
            Entry::Occupied(at) => sides[*at.get() as usize].times += times,
            Entry::Vacant(free) => {
                free.insert(sides.len() as u32); // at most three a face
                sides.push(Side { vertices, ends, times });
            }
        }
    }

    /// Turns what does not cancel into edges in (u, v).
    pub(super) fn project(&mut self, pyramid: &Pyramid) {
        let far = self.ends_at_light(pyramid);
        for at in 0..self.sides.len() {
            let Side { ends, mut times, .. } = self.sides[at];
            if self.faults.has(Fault::NoMultiplicity) {
                times = times.signum() * (times.abs() % 2);
            }
            if times == 0 {
                continue;
            }
            self.outlines += 1;
            let [from, to] = in_order(ends);
            let times = if from == ends[0] { times } else { -times };
            let (from, to) = (pyramid.place(from), pyramid.place(to));
            let (mut start, mut end) = (from, to);
            if far {
                match (from.g >= 1.0, to.g >= 1.0) {
                    (true, true) => continue,
                    (true, false) => start = cut_at_light(&from, &to),
                    (false, true) => end = cut_at_light(&from, &to),
                    (false, false) => {}
                }
            }
            match (from.g <= 0.0, to.g <= 0.0) {
                (true, true) => continue,
                (true, false) => start = cut_at_receiver(&from, &to),
                (false, true) => end = cut_at_receiver(&from, &to),
                (false, false) => {}
            }
            self.emit(pyramid, start, end, times);
        }
        for at in 0..self.cuts.len() {
            let [start, end] = self.cuts[at];
            self.emit(pyramid, start, end, 1);
        }
    }

    /// Adds a straight piece with γ ≥ 0, moved into the square.
    fn emit(&mut self, pyramid: &Pyramid, mut start: Place, mut end: Place, times: i32) {
        // Below v = 0 and above v = 1 the moved piece is horizontal and adds nothing.
        let below = [start.b, end.b];
        if below[0] <= 0.0 && below[1] <= 0.0 || start.g <= start.b && end.g <= end.b {
            return;
        }
        if below[0] < 0.0 {
            start = Place { b: 0.0, ..start.zero(&end, below[0], below[1]) };
        } else if below[1] < 0.0 {
            end = Place { b: 0.0, ..start.zero(&end, below[0], below[1]) };
        }
        let above = [start.g - start.b, end.g - end.b];
        let mut v = [start.v(), end.v()];
        if above[0] < 0.0 && above[1] > 0.0 {
            start = start.zero(&end, above[0], above[1]);
            v[0] = 1.0;
        } else if above[1] < 0.0 && above[0] > 0.0 {
            end = start.zero(&end, above[0], above[1]);
            v[1] = 1.0;
        }
        // Left of u = 0 the piece is moved to u = 0.
        let left = [start.a, end.a];
        if left[0] <= 0.0 && left[1] <= 0.0 {
            return self.at_zero(v, times);
        }
        if left[0] < 0.0 {
            start = Place { a: 0.0, ..start.zero(&end, left[0], left[1]) };
            self.at_zero([v[0], start.v()], times);
            v[0] = start.v();
        } else if left[1] < 0.0 {
            end = Place { a: 0.0, ..start.zero(&end, left[0], left[1]) };
            self.at_zero([end.v(), v[1]], times);
            v[1] = end.v();
        }
        // Right of u = 1 it is dropped: the sweep closes there whatever is open.
        let right = [start.g - start.a, end.g - end.a];
        if right[0] <= 0.0 && right[1] <= 0.0 {
            return;
        }
        let mut u = [start.u(), end.u()];
        if right[0] < 0.0 {
            start = start.zero(&end, right[0], right[1]);
            (u[0], v[0]) = (1.0, start.v());
        } else if right[1] < 0.0 {
            end = start.zero(&end, right[0], right[1]);
            (u[1], v[1]) = (1.0, end.v());
        }
        self.edges.extend(Edge::between([u[0], v[0]], [u[1], v[1]], times, Kind::Chain));
        // The piece is at most √2 long. Its ends are off by (δα + δβ + 2δγ)/γ in u and v together.
        self.moved += 2.0 * pyramid.error * (start.terms / start.g).max(end.terms / end.g);
    }

    fn at_zero(&mut self, [from, to]: [f64; 2], times: i32) {
        if from != to && !self.faults.has(Fault::NoLeft) {
            // An edge that runs up has less on its right.
            self.left.extend([(from, -times), (to, times)]);
        }
    }
}

/// One multiplication; the table takes the upper bits for tags and the lower ones for slots.
#[inline(always)]
fn hash([a, b]: [u32; 2]) -> u64 {
    let product = (u64::from(a) << 32 | u64::from(b)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    product ^ product >> 32
}

/// Both ends in an order that depends on their positions alone, not on ids.
fn in_order([x, y]: [End; 2]) -> [End; 2] {
    if x <= y { [x, y] } else { [y, x] }
}

/// The two sides of a face on which it leaves a half-space and comes back, each with its ends in order.
fn crossed(corners: [End; 3], codes: [u32; 3], bit: u32) -> [[End; 2]; 2] {
    let out = |i: usize| codes[i % 3] & bit != 0;
    let side = |found: &dyn Fn(usize) -> bool| {
        let i = (0..3).find(|&i| found(i)).unwrap_or(0); // there is one
        in_order([corners[i], corners[(i + 1) % 3]])
    };
    [side(&|i| !out(i) && out(i + 1)), side(&|i| out(i) && !out(i + 1))]
}

/// Where a segment meets the plane of the light.
fn cut_at_light(from: &Place, to: &Place) -> Place {
    Place { g: 1.0, ..from.zero(to, 1.0 - from.g, 1.0 - to.g) }
}

/// The same as the end of a cut: it may also have moved along the segment, as far as an error of γ shifts it.
fn far_cut(from: &Place, to: &Place) -> Place {
    let cut = cut_at_light(from, to);
    let rise = to.g - from.g;
    let along = (to.a - from.a - cut.a * rise).abs() + (to.b - from.b - cut.b * rise).abs();
    Place { terms: cut.terms + cut.terms / rise.abs() * along, ..cut }
}

/// Where a segment meets the plane across the receiver; never on the line β = 0, where the projection would
/// be neither below nor above the square.
fn cut_at_receiver(from: &Place, to: &Place) -> Place {
    let cut = from.zero(to, from.g, to.g);
    Place { b: if cut.b == 0.0 { f64::MIN_POSITIVE } else { cut.b }, g: 0.0, ..cut }
}
