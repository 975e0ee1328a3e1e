//! A polygon of five corners or more to triangles.

use std::cmp::Ordering;

use super::monotone;
use super::outline::{Outline, axes, make_canonical};
use super::sweep::Sweep;
use crate::geom::predicate::{Sign, collinear};

/// Cuts polygons one after the other; the memory is used again for the next one.
#[derive(Default)]
pub(crate) struct Cutter {
    /// The vertices of the corners, in the canonical sequence.
    pub(crate) ring: Vec<u32>,
    /// The corners that are left, and where the next ones are collected.
    corners: Vec<u32>,
    rest: Vec<u32>,
    /// A monotone piece, and the stack of its corners.
    piece: Vec<u32>,
    stack: Vec<(u32, bool)>,
    sweep: Sweep,
}

/// Triangles that are filled in, in the memory that they will have: of corners here, of vertices at the end.
pub(super) struct Filled<'a> {
    triangles: &'a mut [[u32; 3]],
    len: usize,
}

impl Filled<'_> {
    pub(super) fn push(&mut self, triangle: [u32; 3]) {
        // There are never more; if there were, the count would tell.
        if let Some(empty) = self.triangles.get_mut(self.len) {
            *empty = triangle;
        }
        self.len += 1;
    }
}

impl Cutter {
    /// The triangles of the polygon `ring`, in two fewer than it has corners: those of one rule for every
    /// first corner and both windings, listed in one order. `false` if the polygon crosses itself: then they
    /// are a fan around its least corner, as they are if it has no area.
    pub(crate) fn cut(&mut self, positions: &[[f32; 3]], triangles: &mut [[u32; 3]]) -> bool {
        let turned = make_canonical(positions, &mut self.ring);
        let ring = std::mem::take(&mut self.ring);
        let mut simple = axes(positions, &ring).into_iter().any(|axis| {
            self.along(&Outline { positions, ring: &ring, axis }, &mut Filled { triangles, len: 0 })
        });
        if !simple {
            let at = |corner: u32| positions[ring[corner as usize] as usize];
            simple = true;
            for (corner, triangle) in (1..).zip(&mut *triangles) {
                *triangle = [0, corner, corner + 1];
                simple &= collinear(at(0), at(corner), at(corner + 1));
            }
        }
        for triangle in triangles {
            // Corners in the ring's sequence make the ring's winding.
            triangle.sort_unstable();
            if turned {
                triangle.reverse();
            }
            *triangle = triangle.map(|corner| ring[corner as usize]);
        }
        self.ring = ring;
        simple
    }

    /// The triangles, seen along an axis; whether there are some that do not overlap.
    fn along(&mut self, outline: &Outline<'_>, filled: &mut Filled<'_>) -> bool {
        self.corners.clear();
        self.corners.extend(0..outline.ring.len() as u32);
        self.drop_where(filled, |a, b, _| outline.order(a, b) == Ordering::Equal);
        let dropped = filled.len;
        if self.pieces(outline, filled) {
            return true;
        }
        // A failed try leaves triangles that mean nothing.
        filled.len = dropped;
        // Where the polygon runs out and back, nothing can be done but to leave these corners without area.
        let is_spike = |a, b, c| {
            let (to, back) = (outline.order(a, b), outline.order(b, c));
            to == Ordering::Equal || to != back && outline.turn(a, b, c).is_zero()
        };
        self.drop_where(filled, is_spike) && self.pieces(outline, filled)
    }

    /// Cuts off the middle one of three neighboring corners wherever they are such, and again where that
    /// makes new neighbors; whether there are any.
    fn drop_where(&mut self, filled: &mut Filled<'_>, drops: impl Fn(u32, u32, u32) -> bool) -> bool {
        let n = self.corners.len();
        let mut left = n;
        // A stack of corners that stay so far; those at its start are met again at the end.
        self.rest.clear();
        for index in 0..n {
            let corner = self.corners[index];
            while left > 3
                && let [.., a, b] = self.rest[..]
                && drops(a, b, corner)
            {
                filled.push([a, b, corner]);
                self.rest.pop();
                left -= 1;
            }
            self.rest.push(corner);
        }
        // Around the start: the last corner between its neighbors, then the first one.
        let mut start = 0;
        loop {
            let rest = &self.rest[start..];
            let &[first, second, .., before, last] = rest else { break };
            if left <= 3 {
                break;
            }
            if drops(before, last, first) {
                filled.push([before, last, first]);
                self.rest.pop();
            } else if drops(last, first, second) {
                filled.push([last, first, second]);
                start += 1;
            } else {
                break;
            }
            left -= 1;
        }
        self.corners.clear();
        self.corners.extend_from_slice(&self.rest[start..]);
        left < n
    }

    /// Cuts what is left; `false` if that crosses itself: then what was added means nothing.
    fn pieces(&mut self, outline: &Outline<'_>, filled: &mut Filled<'_>) -> bool {
        let before = filled.len;
        if let [a, b, c] = self.corners[..] {
            filled.push([a, b, c]);
            return !outline.turn(a, b, c).is_zero();
        }
        match winding_of_convex(outline, &self.corners) {
            Sign::Positive => {}
            Sign::Negative => self.corners.reverse(),
            Sign::Zero => {
                // One of the two directions is counter-clockwise; the other ends at its first corner.
                return (0..2).any(|_| {
                    filled.len = before;
                    let simple = self.swept(outline, filled);
                    self.corners.reverse();
                    simple
                });
            }
        }
        monotone::cut(outline, &self.corners, &mut self.stack, filled);
        true
    }

    /// The triangles of a polygon that runs counter-clockwise; `false` if there are none.
    fn swept(&mut self, outline: &Outline<'_>, filled: &mut Filled<'_>) -> bool {
        let before = filled.len;
        let Some(chords) = self.sweep.chords(outline, &self.corners) else { return false };
        // Chords do not cross, so those that end at a corner are met from the innermost out.
        chords.sort_unstable_by_key(|&[a, b]| (b, std::cmp::Reverse(a)));
        chords.dedup();
        let (rest, piece) = (&mut self.rest, &mut self.piece);
        let mut cut = |piece: &[u32]| {
            if piece.len() > 2 {
                monotone::cut(outline, piece, &mut self.stack, filled);
            }
        };
        rest.clear();
        let mut chords = chords.iter().peekable();
        for index in 0..self.corners.len() as u32 {
            while let Some([from, _]) = chords.next_if(|chord| chord[1] == index) {
                let start = rest.partition_point(|corner| corner < from);
                if rest.get(start) != Some(from) {
                    return false;
                }
                piece.clear();
                piece.extend(rest[start..].iter().chain([&index]).map(|&i| self.corners[i as usize]));
                rest.truncate(start + 1);
                cut(piece);
            }
            rest.push(index);
        }
        piece.clear();
        piece.extend(rest.iter().map(|&index| self.corners[index as usize]));
        cut(piece);
        // The sweep has seen to both; an error in it must not become one of the mesh.
        filled.len == before + self.corners.len() - 2
            && filled.triangles[before..filled.len]
                .iter()
                .all(|&[a, b, c]| outline.turn(a, b, c) != Sign::Negative)
    }
}

/// The winding of a convex polygon, with area; zero if it is not convex.
fn winding_of_convex(outline: &Outline<'_>, corners: &[u32]) -> Sign {
    let n = corners.len();
    let (mut winding, mut flips) = (Sign::Zero, 0);
    let [mut a, mut b] = [corners[n - 2], corners[n - 1]];
    let mut to = outline.order(a, b);
    for &c in corners {
        let turn = outline.turn(a, b, c);
        if !turn.is_zero() && turn == -winding {
            return Sign::Zero;
        }
        if winding.is_zero() {
            winding = turn;
        }
        // A convex polygon runs to the right once, and to the left once.
        let on = outline.order(b, c);
        flips += u32::from(on != to);
        if flips > 2 {
            return Sign::Zero;
        }
        (a, b, to) = (b, c, on);
    }
    winding
}
