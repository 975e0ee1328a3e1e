//! Polygons of any shape: cut into monotone pieces by a sweep from left to right. n·log n.
//!
//! After Michael I. Shamos, Dan Hoey, *Geometric Intersection Problems*, 1976 (sides that cross are neighbors
//! before they do) and Garey, Johnson, Preparata, Tarjan 1978 (diagonals to the last corner met between two
//! sides). Every decision is the exact sign of a turn or an exact comparison.
//!
//! Sides that run to the right have the inside above them, sides that run to the left have it below. A
//! polygon is taken if, on every vertical line, the sides alternate from below: right, left, right, left; if
//! none cross; and if the corners at one position are nested, so that they can be pulled apart. It may touch
//! itself, then: at corners, along sides, and where it runs along a side and back. Of two sides on top of
//! each other the one to the left is below, as the gap between them is outside.

use std::cmp::Ordering;

use super::outline::Outline;
use super::status::Status;
use crate::geom::predicate::Sign;

/// The sweep over one polygon; the memory is used again for the next one.
#[derive(Default)]
pub(super) struct Sweep {
    /// Corners from left to right.
    events: Vec<u32>,
    status: Status,
    /// For each side that runs to the right: the last corner met between it and the side above.
    helpers: Vec<Helper>,
    /// The diagonals.
    chords: Vec<[u32; 2]>,
    /// Sides at the current position: those that were there, from below; those that go on; all of the new
    /// ones.
    old: Vec<u32>,
    kept: Vec<u32>,
    new: Vec<u32>,
    /// Corners at the current position whose first side was met and whose second one was not.
    open: Vec<u32>,
    /// Corners at the current position above a side: the side, the corner, whether the inside parts there.
    met: Vec<(u32, u32, bool)>,
}

#[derive(Clone, Copy, Default)]
struct Helper {
    corner: u32,
    /// Whether the corner still needs a diagonal to the right.
    waits: bool,
}

/// Where the two sides of a corner lie.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sides {
    Left,
    Right,
    /// One to the left, one to the right; whether the polygon runs to the right there.
    Through {
        rightward: bool,
    },
}

/// A polygon of the corners `ring[0]`, `ring[1]`, … of an outline, counter-clockwise. Side `i` runs from
/// corner `i` to the next one.
struct Shape<'a> {
    outline: &'a Outline<'a>,
    ring: &'a [u32],
}

impl Shape<'_> {
    fn next(&self, corner: u32) -> u32 {
        if corner as usize + 1 == self.ring.len() { 0 } else { corner + 1 }
    }

    fn previous(&self, corner: u32) -> u32 {
        if corner == 0 { self.ring.len() as u32 - 1 } else { corner - 1 }
    }

    fn order(&self, a: u32, b: u32) -> Ordering {
        self.outline.order(self.ring[a as usize], self.ring[b as usize])
    }

    fn turn(&self, a: u32, b: u32, c: u32) -> Sign {
        let [a, b, c] = [a, b, c].map(|corner| self.ring[corner as usize]);
        self.outline.turn(a, b, c)
    }

    fn is_rightward(&self, side: u32) -> bool {
        self.order(side, self.next(side)) == Ordering::Less
    }

    /// The left and the right end of a side.
    fn ends(&self, side: u32) -> [u32; 2] {
        let next = self.next(side);
        if self.is_rightward(side) { [side, next] } else { [next, side] }
    }

    fn sides(&self, corner: u32) -> Sides {
        match (self.is_rightward(self.previous(corner)), self.is_rightward(corner)) {
            (true, false) => Sides::Left,
            (false, true) => Sides::Right,
            (rightward, _) => Sides::Through { rightward },
        }
    }

    /// The order, from below, of two sides at a position that is on both and the right end of neither.
    fn above(&self, at: u32, a: u32, b: u32) -> Ordering {
        match self.turn(at, self.ends(a)[1], self.ends(b)[1]) {
            Sign::Positive => Ordering::Less,
            Sign::Negative => Ordering::Greater,
            Sign::Zero => self.is_rightward(a).cmp(&self.is_rightward(b)),
        }
    }

    /// Whether two neighboring sides stay one above the other as far as both reach.
    fn stay_apart(&self, low: u32, high: u32) -> bool {
        let ([low_left, low_right], [high_left, high_right]) = (self.ends(low), self.ends(high));
        match self.order(low_right, high_right) {
            Ordering::Less => self.turn(high_left, high_right, low_right) != Sign::Positive,
            Ordering::Greater => self.turn(low_left, low_right, high_right) != Sign::Negative,
            Ordering::Equal => true,
        }
    }
}

impl Sweep {
    /// The diagonals that cut a polygon into monotone pieces, as pairs of indices into `ring`, the lower one
    /// first; `None` if the polygon is not one that can be taken, or if it runs clockwise. No two neighboring
    /// corners may be at the same position.
    pub(super) fn chords(&mut self, outline: &Outline<'_>, ring: &[u32]) -> Option<&mut Vec<[u32; 2]>> {
        let shape = Shape { outline, ring };
        let mut events = std::mem::take(&mut self.events);
        events.clear();
        events.extend(0..ring.len() as u32);
        events.sort_unstable_by(|&a, &b| shape.order(a, b).then(a.cmp(&b)));
        self.status.clear();
        self.chords.clear();
        self.helpers.clear();
        self.helpers.resize(ring.len(), Helper::default());
        let mut positions = events.chunk_by(|&a, &b| shape.order(a, b) == Ordering::Equal);
        let taken = positions.try_for_each(|corners| self.position(&shape, corners));
        self.events = events;
        taken.filter(|()| self.status.is_empty())?;
        Some(&mut self.chords)
    }

    /// One position of the sweep, with all corners that lie there.
    fn position(&mut self, shape: &Shape<'_>, corners: &[u32]) -> Option<()> {
        let at = corners[0];
        let gap = self.status.gap(|side| {
            let [left, right] = shape.ends(side);
            shape.turn(left, right, at) == Sign::Positive
        });
        let before = self.status.before(gap);
        self.old.clear();
        let mut after = None;
        for side in self.status.after(gap) {
            let [left, right] = shape.ends(side);
            if shape.turn(left, right, at) == Sign::Negative {
                after = Some(side);
                break;
            }
            self.old.push(side);
        }
        self.end_sides(shape, at, corners, before)?;
        self.begin_sides(shape, at, corners, before)?;
        // The sides alternate, and neighbors do not cross.
        let mut below = before;
        for above in self.new.iter().copied().map(Some).chain([after]) {
            let inside = below.is_some_and(|side| shape.is_rightward(side));
            match above {
                Some(above) if shape.is_rightward(above) == inside => return None,
                None if inside => return None,
                _ => {}
            }
            if let (Some(below), Some(above)) = (below, above)
                && !shape.stay_apart(below, above)
            {
                return None;
            }
            below = above;
        }
        self.status.replace(gap, self.old.len(), &self.new);
        Some(())
    }

    /// Ends the sides that end here, and finds those that go on, or are gone on with: `kept`.
    fn end_sides(&mut self, shape: &Shape<'_>, at: u32, corners: &[u32], before: Option<u32>) -> Option<()> {
        let mut ending = corners
            .iter()
            .map(|&corner| match shape.sides(corner) {
                Sides::Left => 2,
                Sides::Right => 0,
                Sides::Through { .. } => 1,
            })
            .sum::<usize>();
        self.kept.clear();
        self.open.clear();
        let old = std::mem::take(&mut self.old);
        let mut below = before;
        for &side in &old {
            let rightward = shape.is_rightward(side);
            let end = shape.ends(side)[1];
            if shape.order(end, at) != Ordering::Equal {
                self.kept.push(side);
                self.open.is_empty().then_some(())?;
                below = Some(side);
                continue;
            }
            ending = ending.checked_sub(1)?;
            self.touch(if rightward { side } else { below? }, end);
            match shape.sides(end) {
                Sides::Through { rightward } => {
                    self.open.is_empty().then_some(())?;
                    let on = if rightward { end } else { shape.previous(end) };
                    self.helpers[on as usize] = Helper { corner: end, waits: false };
                    self.kept.push(on);
                }
                _ if self.open.last() != Some(&end) => self.open.push(end),
                _ => {
                    self.open.pop();
                    let inside = match self.open.last() {
                        // Its own side below: whatever waits between its two sides ends here with them.
                        _ if !rightward => {
                            self.touch(shape.previous(end), end);
                            below = Some(side);
                            continue;
                        }
                        Some(&around) => shape.previous(around),
                        None => self.kept.last().copied().or(before)?,
                    };
                    // The sides end, and the inside goes on around them.
                    shape.is_rightward(inside).then_some(())?;
                    self.touch(inside, end);
                    self.helpers[inside as usize].waits = true;
                }
            }
            below = Some(side);
        }
        self.old = old;
        (self.open.is_empty() && ending == 0).then_some(())
    }

    /// Sorts the sides that go on and those that begin here: `new`.
    fn begin_sides(
        &mut self,
        shape: &Shape<'_>,
        at: u32,
        corners: &[u32],
        before: Option<u32>,
    ) -> Option<()> {
        self.new.clone_from(&self.kept);
        for &corner in corners.iter().filter(|&&corner| shape.sides(corner) == Sides::Right) {
            self.new.extend([shape.previous(corner), corner]);
        }
        let mut new = std::mem::take(&mut self.new);
        new.sort_by(|&a, &b| shape.above(at, a, b));
        let (mut below, mut kept) = (before, self.kept.iter());
        self.open.clear();
        self.met.clear();
        for &side in &new {
            let start = shape.ends(side)[0];
            let begins = shape.order(start, at) == Ordering::Equal && shape.sides(start) == Sides::Right;
            if !begins {
                // They are in the order in which they came, or they cross here.
                (self.open.is_empty() && kept.next() == Some(&side)).then_some(())?;
                if shape.order(start, at) == Ordering::Equal && !shape.is_rightward(side) {
                    self.met.push((below?, start, false));
                }
            } else if self.open.last() == Some(&start) {
                self.open.pop();
            } else {
                self.open.push(start);
                // Its first side from below runs to the left: the inside is on the left of the corner, and
                // parts here.
                if !shape.is_rightward(side) {
                    self.met.push((below?, start, true));
                }
                self.helpers[start as usize] = Helper { corner: start, waits: false };
            }
            below = Some(side);
        }
        (self.open.is_empty() && kept.next().is_none()).then_some(())?;
        for index in 0..self.met.len() {
            let (side, corner, parts) = self.met[index];
            self.helpers[side as usize].waits |= parts;
            self.touch(side, corner);
        }
        self.new = new;
        Some(())
    }

    /// A corner is met above a side that runs to the right: a diagonal to the corner that waits there.
    fn touch(&mut self, side: u32, corner: u32) {
        let helper = &mut self.helpers[side as usize];
        if helper.waits && helper.corner != corner {
            self.chords.push([helper.corner.min(corner), helper.corner.max(corner)]);
        }
        *helper = Helper { corner, waits: false };
    }
}
