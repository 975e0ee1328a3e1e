//! Exact winding numbers of a volume at points, from its homogeneous triangles alone.
//!
//! A segment counts +1 where it leaves a closed surface, and −1 where it enters. The sum along a segment from
//! a point to one that nothing encloses is the winding number at the first. Every crossing is decided by
//! orientation signs of homogeneous points, so triangles with vertices at infinity are no special case: a
//! sign at infinity is the limit of the signs along a ray (Jorge Stolfi, *Oriented Projective Geometry*,
//! 1991).

use std::sync::OnceLock;

use super::ShadowVolume;
use crate::geom::bvh::Bvh;
use crate::geom::predicate::{Homogeneous, Sign, directions_turn, orient3d_homogeneous};
use crate::geom::{Aabb, Light, Segment};
use crate::random::SplitMix64;

/// The winding number of `volume` at `p`, from every triangle; `None` if `p` lies on a triangle.
///
/// The reference, in linear time: for many points use a [`WindingIndex`].
///
/// Also `None`, though hardly ever, if the rays from `p` in each of sixteen scattered directions run exactly
/// through an edge.
#[must_use]
pub fn winding_number(volume: &ShadowVolume, p: [f32; 3]) -> Option<i32> {
    winding_of(volume, &weighted(volume), p)
}

/// The winding number of a closed part of a volume, given by its triangles and how often each is there.
pub(in crate::shadow) fn winding_of(
    volume: &ShadowVolume,
    triangles: &[([u32; 3], i32)],
    p: [f32; 3],
) -> Option<i32> {
    (0..TRIES).find_map(|i| to_infinity(volume, triangles, p, scattered(i)).settled())?
}

/// Winding numbers of a volume at many points of a box.
///
/// A segment joins the point to an anchor whose winding number is known, and only triangles near that segment
/// are tested. Building costs about 1 µs per triangle; a query costs some tens of predicates.
///
/// ```
/// use umbrage::caster::Caster;
/// use umbrage::geom::Aabb;
/// use umbrage::shadow::volume::{Caps, WindingIndex};
/// use umbrage::testing::shapes;
/// let volume = Caster::new(shapes::cube()).volume(&"point:2,9,3".parse()?, Caps::Both);
/// let index = WindingIndex::build(&volume, Aabb { low: [-50.0; 3], high: [50.0; 3] });
/// assert_eq!(index.number([-0.5, -5.0, -0.7]), Some(1)); // below the cube: in shadow
/// assert_eq!(index.number([9.0, -5.0, 0.3]), Some(0));
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Debug)]
pub struct WindingIndex<'volume> {
    volume: &'volume ShadowVolume,
    /// Triangles that are not flat, each once, with its number of copies.
    triangles: Vec<([u32; 3], i32)>,
    tree: Bvh,
    /// For each box of the tree, the triangle that it holds a piece of.
    pieces: Vec<u32>,
    within: Aabb,
    /// Scattered points of the box, and their winding numbers once they are asked for.
    anchors: Vec<([f32; 3], OnceLock<Option<i32>>)>,
}

/// Anchors or directions that are tried before a point is given up.
pub(super) const TRIES: u32 = 16;

/// The crossings of a segment with the volume.
enum Path {
    /// The signed number of crossings.
    Sum(i32),
    /// The segment starts on a triangle.
    Starts,
    /// The segment runs through an edge or along a triangle; another one may not.
    Tie,
}

impl Path {
    /// `Some(None)` if the answer is that there is none.
    fn settled(self) -> Option<Option<i32>> {
        match self {
            Self::Sum(sum) => Some(Some(sum)),
            Self::Starts => Some(None),
            Self::Tie => None,
        }
    }
}

impl<'volume> WindingIndex<'volume> {
    /// Prepares `volume` for queries in the closed box `within`.
    ///
    /// Memory: at its peak some 90 bytes per triangle of the volume, up to 130 more for each of at most 16
    /// boxes that hug a long side: 2300 if all are such.
    #[must_use]
    pub fn build(volume: &'volume ShadowVolume, within: Aabb) -> Self {
        let within = thickened(within);
        let triangles = weighted(volume);
        let mut boxes = Vec::new();
        let mut pieces = Vec::new();
        for (index, (triangle, _)) in triangles.iter().enumerate() {
            for_each_piece(volume, *triangle, &within, |aabb| {
                boxes.push(aabb);
                pieces.push(index as u32);
            });
        }
        let tries = if within.is_empty() { 0 } else { TRIES }; // no point to be asked about
        let anchors = (0..tries).map(|i| (scattered_in(&within, i), OnceLock::new())).collect();
        Self { volume, tree: Bvh::build(&boxes), triangles, pieces, within, anchors }
    }

    /// The winding number at `p`; `None` if `p` lies on a triangle of the volume (or, hardly ever, where
    /// [`winding_number`] abstains).
    ///
    /// A point outside the box is answered too, slowly, and so is one from which every anchor is hidden
    /// behind edges.
    #[must_use]
    pub fn number(&self, p: [f32; 3]) -> Option<i32> {
        let settled = if self.within.contains(p) { self.by_anchors(p) } else { None };
        settled.unwrap_or_else(|| winding_number(self.volume, p))
    }

    /// `None` if the segment to every anchor runs through an edge, or every anchor lies on the volume.
    fn by_anchors(&self, p: [f32; 3]) -> Option<Option<i32>> {
        // The nearest anchor first: a short segment has few candidates.
        let distance = |anchor: [f32; 3]| -> f64 {
            (0..3).map(|i| (f64::from(anchor[i]) - f64::from(p[i])).powi(2)).sum()
        };
        let mut nearest: Vec<&([f32; 3], OnceLock<Option<i32>>)> = self.anchors.iter().collect();
        nearest.sort_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
        let mut near = Vec::new();
        nearest.into_iter().find_map(|(anchor, known)| {
            let known = *known.get_or_init(|| winding_number(self.volume, *anchor));
            let known = known?;
            near.clear();
            self.tree.for_each_along(&Segment::between(p, *anchor), |piece| {
                near.push(self.pieces[piece as usize]);
            });
            near.sort_unstable();
            near.dedup();
            let candidates = near.iter().map(|&index| self.triangles[index as usize]);
            let path = walk(self.volume, candidates, p, Homogeneous::point(*anchor));
            path.settled().map(|sum| sum.map(|sum| sum + known))
        })
    }
}

/// The triangles without the flat ones (which enclose nothing) and with copies counted once.
pub(in crate::shadow) fn weighted(volume: &ShadowVolume) -> Vec<([u32; 3], i32)> {
    let mut weighted: Vec<([u32; 3], i32)> = Vec::with_capacity(volume.triangles.len());
    for &triangle in &volume.triangles {
        // Copies of a triangle are adjacent, or two apart for the triangles of a quad.
        let last = weighted.len().saturating_sub(2);
        match weighted[last..].iter_mut().find(|(other, _)| *other == triangle) {
            Some((_, copies)) => *copies += 1,
            None => weighted.push((triangle, 1)),
        }
    }
    weighted.retain(|(triangle, _)| !is_flat(volume.corners(*triangle)));
    weighted
}

/// Whether three homogeneous points span no triangle. A triangle wholly at infinity is not called flat.
fn is_flat(corners: [Homogeneous; 3]) -> bool {
    let Some(k) = corners.iter().position(Homogeneous::is_finite) else { return false };
    let [a, b, c] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
    axes().into_iter().all(|axis| orient3d_homogeneous([a, b, c, axis]).is_zero())
}

/// The sum over `triangles` of their crossings with the segment from `p` to `q`.
fn walk(
    volume: &ShadowVolume,
    triangles: impl Iterator<Item = ([u32; 3], i32)>,
    p: [f32; 3],
    q: Homogeneous,
) -> Path {
    let p = Homogeneous::point(p);
    let (mut sum, mut tie) = (0, false);
    for (triangle, copies) in triangles {
        let corners = volume.corners(triangle);
        if !corners.iter().any(Homogeneous::is_finite) {
            continue; // at infinity: no finite point of the segment lies there
        }
        match crossing(corners, p, q) {
            Crossing::Miss => {}
            Crossing::Through(sign) => sum += copies * sign,
            Crossing::Starts => return Path::Starts,
            Crossing::Tie => tie = true,
        }
    }
    if tie { Path::Tie } else { Path::Sum(sum) }
}

/// How a segment meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crossing {
    /// Not at all.
    Miss,
    /// Through its inside: +1 from back to front, −1 from front to back.
    Through(i32),
    /// It starts on the triangle.
    Starts,
    /// It ends on the triangle, runs in its plane, or meets an edge or a corner.
    Tie,
}

/// Decides how the segment from `p` to `q` meets a triangle that is not flat. `p` is finite; `q` may lie at
/// infinity.
pub(super) fn crossing(corners: [Homogeneous; 3], p: Homogeneous, q: Homogeneous) -> Crossing {
    crossing_to(corners, p, q, side_of(corners, q))
}

/// Which side of a triangle a point is on: positive behind it.
#[inline]
pub(super) fn side_of([a, b, c]: [Homogeneous; 3], q: Homogeneous) -> Sign {
    orient3d_homogeneous([a, b, c, q])
}

/// As [`crossing`], where the side that `q` is on is known.
#[inline]
pub(super) fn crossing_to([a, b, c]: [Homogeneous; 3], p: Homogeneous, q: Homogeneous, to: Sign) -> Crossing {
    let from = side_of([a, b, c], p);
    if from == to {
        return if from.is_zero() { Crossing::Tie } else { Crossing::Miss };
    }
    // The lines of most candidates pass two edges on different sides.
    let first = orient3d_homogeneous([p, q, a, b]);
    let second = orient3d_homogeneous([p, q, b, c]);
    if first == -second && !first.is_zero() {
        return Crossing::Miss;
    }
    let edges = [first, second, orient3d_homogeneous([p, q, c, a])];
    if edges.contains(&Sign::Positive) && edges.contains(&Sign::Negative) {
        Crossing::Miss
    } else if from.is_zero() {
        Crossing::Starts
    } else if to.is_zero() || edges.contains(&Sign::Zero) {
        Crossing::Tie
    } else {
        Crossing::Through(from.value()) // positive is behind the triangle, that is, inside
    }
}

/// From `p` along `direction` to infinity, and through the dark cap that lies there.
fn to_infinity(
    volume: &ShadowVolume,
    triangles: &[([u32; 3], i32)],
    p: [f32; 3],
    direction: [f32; 3],
) -> Path {
    let light = Light::directional(direction).expect("scattered directions are not zero");
    let target = Homogeneous::light(&light);
    let mut sum = match walk(volume, triangles.iter().copied(), p, target) {
        Path::Sum(sum) => sum,
        unsettled => return unsettled,
    };
    for (triangle, copies) in triangles {
        let [a, b, c] = volume.corners(*triangle);
        if [a, b, c].iter().any(Homogeneous::is_finite) {
            continue;
        }
        let side = directions_turn([a, b, c]);
        let edges = [(a, b), (b, c), (c, a)].map(|(a, b)| directions_turn([target, a, b]));
        if edges.contains(&Sign::Positive) && edges.contains(&Sign::Negative) {
            continue;
        }
        if side.is_zero() || edges.contains(&Sign::Zero) {
            if side.is_zero() && edges.iter().any(|edge| !edge.is_zero()) {
                continue; // flat, and the direction is not in it
            }
            return Path::Tie;
        }
        // All edges turn as the triangle does, or all in the opposite sense: then the opposite direction hits
        // it.
        if edges[0] == side {
            sum += copies * side.value();
        }
    }
    Path::Sum(sum)
}

/// How many pieces an unbounded triangle is cut into at most, so that their boxes hug it.
const PIECES: f64 = 16.0;

/// Boxes that together cover the part of a triangle inside `within`.
///
/// An unbounded triangle is `{P + t·D}` between two rays: from two points along one direction, or from one
/// point along two. A piece lies between two values of `t`, the same numbers for both rays and for the piece
/// that follows, so the box of its four corners covers it.
fn for_each_piece(volume: &ShadowVolume, triangle: [u32; 3], within: &Aabb, mut visit: impl FnMut(Aabb)) {
    let corners = volume.corners(triangle).map(Homogeneous::to_f64);
    let finite: Vec<[f64; 4]> = corners.into_iter().filter(|corner| corner[3] != 0.0).collect();
    let far: Vec<[f64; 4]> = corners.into_iter().filter(|corner| corner[3] == 0.0).collect();
    let rays = match (finite.as_slice(), far.as_slice()) {
        ([a, b], [d]) => [(*a, *d), (*b, *d)],
        ([a], [d, e]) => [(*a, *d), (*a, *e)],
        ([a, b, c], []) => {
            let points = [a, b, c].map(|p| [0, 1, 2].map(|i| p[i] as f32)); // exact: they are mesh vertices
            let aabb = Aabb::around(points);
            if aabb.overlaps(within) {
                visit(aabb);
            }
            return;
        }
        _ => return,
    };
    // Beyond `end` both rays have left the box on the same side; twice that is safe from rounding.
    let mut end = f64::INFINITY;
    for i in 0..3 {
        let leave = |(p, d): &([f64; 4], [f64; 4])| {
            let bound = if d[i] > 0.0 { within.high[i] } else { within.low[i] };
            (f64::from(bound) - p[i]) / d[i]
        };
        if rays[0].1[i] * rays[1].1[i] > 0.0 {
            end = end.min(2.0 * leave(&rays[0]).max(leave(&rays[1])).max(0.0));
        }
    }
    if end == f64::INFINITY {
        visit(*within);
        return;
    }
    let length = |d: [f64; 4]| (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    let longest = end * length(rays[0].1).max(length(rays[1].1));
    // (`min` and `max` let go of NaN, which a box that is a single point would make.)
    let pieces = PIECES.min((PIECES * longest / within.diagonal()).ceil()).max(1.0);
    for k in 0..pieces as u32 {
        let span = [f64::from(k), f64::from(k + 1)].map(|k| end * (k / pieces));
        let mut aabb = Aabb::EMPTY;
        for (p, d) in rays {
            for t in span {
                aabb = aabb.join(&around(p, d, t, SLACK));
            }
        }
        if aabb.overlaps(within) {
            visit(Aabb {
                low: [0, 1, 2].map(|i| aabb.low[i].max(within.low[i])),
                high: [0, 1, 2].map(|i| aabb.high[i].min(within.high[i])),
            });
        }
    }
}

/// A point `p + t·d` errs by three roundings, of `d`, of `t·d` and of the sum: at most `3·2⁻⁵³` of the
/// magnitudes, and computing the step outwards by another few of the step itself. Without a step coordinates
/// near 0 are lost, where terms cancel; elsewhere the rounding to `f32`, which goes outwards too, would do.
const SLACK: f64 = 8.0 * f64::EPSILON;

/// A box around `p + t·d`: outwards by `slack` of the magnitudes, and then to `f32`.
#[inline]
fn around(p: [f64; 4], d: [f64; 4], t: f64, slack: f64) -> Aabb {
    let value = |i: usize| p[i] + t * d[i];
    let slack = |i: usize| slack * (p[i].abs() + (t * d[i]).abs());
    Aabb {
        low: [0, 1, 2].map(|i| ((value(i) - slack(i)) as f32).next_down()),
        high: [0, 1, 2].map(|i| ((value(i) + slack(i)) as f32).next_up()),
    }
}

/// A direction without a pattern; never zero.
pub(super) fn scattered(i: u32) -> [f32; 3] {
    let mut random = SplitMix64(u64::from(i) + 1000);
    [(); 3].map(|()| (2.0 * random.unit() - 1.0) as f32)
}

/// Whether `p` lies on a triangle of the volume that is not flat, its edges and corners included: in the
/// plane of the triangle, and along an axis that leaves the plane not on different sides of its edges.
///
/// Reference for abstentions: tests every triangle directly.
#[cfg(feature = "verify")]
pub(crate) fn stands_on(volume: &ShadowVolume, p: [f32; 3]) -> bool {
    let p = Homogeneous::point(p);
    volume.triangles.iter().any(|&triangle| {
        let [a, b, c] = volume.corners(triangle);
        let is_finite = [a, b, c].iter().any(Homogeneous::is_finite);
        if !is_finite || !orient3d_homogeneous([a, b, c, p]).is_zero() {
            return false;
        }
        let leaves = |axis: &Homogeneous| !orient3d_homogeneous([a, b, c, *axis]).is_zero();
        axes().into_iter().find(leaves).is_some_and(|axis| {
            let sides = [(a, b), (b, c), (c, a)].map(|(a, b)| orient3d_homogeneous([p, axis, a, b]));
            !(sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative))
        })
    })
}

/// The three axes, as points at infinity.
pub(in crate::shadow) fn axes() -> [Homogeneous; 3] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        .map(|unit| Homogeneous::light(&Light::directional(unit).expect("a unit vector is a direction")))
}

/// A flat box made thicker: where all points lie in the plane of a cap, anchors in it would be of no use. A
/// sixteenth of the diagonal on either side, and an ulp at least.
pub(super) fn thickened(within: Aabb) -> Aabb {
    let least = within.diagonal() / 16.0;
    let mut thick = within;
    for i in (0..3).filter(|_| !within.is_empty()) {
        let (low, high) = (f64::from(within.low[i]), f64::from(within.high[i]));
        if high - low <= least {
            thick.low[i] = ((low - least) as f32).min(within.low[i].next_down()).max(f32::MIN);
            thick.high[i] = ((high + least) as f32).max(within.high[i].next_up()).min(f32::MAX);
        }
    }
    thick
}

pub(super) fn scattered_in(within: &Aabb, i: u32) -> [f32; 3] {
    let mut random = SplitMix64(u64::from(i));
    [0, 1, 2].map(|axis| {
        let (low, high) = (f64::from(within.low[axis]), f64::from(within.high[axis]));
        let at = (low + (high - low) * random.unit()) as f32;
        at.clamp(within.low[axis], within.high[axis])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::volume::test_support::under;

    #[test]
    fn winding_index_of_a_flat_box_is_settled_by_its_anchors_without_the_fallback() {
        // The box lies in the plane of the light cap, and all but its rim on it; far from 0 a sixteenth of
        // its diagonal is less than an ulp.
        for away in [0.0, 1e7] {
            let volume = under([0.3, 0.2, away + 5.0], away);
            for p in [[1.000_976_6, 0.5, away], [-0.001, 0.25, away]] {
                let within = Aabb::around([p, [0.5, 0.75, away]]);
                let index = WindingIndex::build(&volume, within);
                assert_eq!(index.by_anchors(p), Some(Some(0)), "{away} {p:?}");
                // Without thickness no anchor is of use.
                let anchors = (0..TRIES).map(|i| (scattered_in(&within, i), OnceLock::new())).collect();
                assert_eq!(WindingIndex { anchors, ..index }.by_anchors(p), None, "{away} {p:?}");
                let point = WindingIndex::build(&volume, Aabb::around([p]));
                assert_eq!(point.by_anchors(p), Some(Some(0)), "a box of one point: {away} {p:?}");
            }
        }
    }

    #[cfg(feature = "verify")]
    #[test]
    fn winding_number_abstains_exactly_at_points_on_a_triangle() {
        let volume = under([0.3, 0.2, 5.0], 0.0);
        let (mut on, mut off) = (0, 0);
        for i in 0..1000 {
            let p = [i % 10, i / 10 % 10, i / 100].map(|n| (n - 4) as f32 * 0.25);
            assert_eq!(stands_on(&volume, p), winding_number(&volume, p).is_none(), "{p:?}");
            *(if stands_on(&volume, p) { &mut on } else { &mut off }) += 1;
        }
        assert!(on > 20 && off > 500, "{on} {off}");
    }

    #[test]
    fn winding_boxes_of_pieces_hold_their_corners_and_without_slack_do_not() {
        let mut random = SplitMix64(1);
        let mut lost = [0; 2];
        for _ in 0..20_000 {
            // −p and t·d are equal but for the rounding of t, in 2⁻⁵² … 2⁻⁷⁶.
            let [p, d] = [(); 2].map(|()| (random.below(1 << 24) + 1) as i64);
            let t = p as f64 / d as f64;
            let exponent = (t.to_bits() >> 52) as i32 - 1023 - 52;
            let mantissa = (t.to_bits() & ((1 << 52) - 1)) | (1 << 52);
            let unit = 2.0_f64.powi(exponent);
            let exact = i128::from(mantissa) * i128::from(d) - ((p as f64 / unit) as i128);
            for (lost, slack) in lost.iter_mut().zip([SLACK, 0.0]) {
                let aabb = around([-(p as f64); 4], [d as f64; 4], t, slack);
                let holds = f64::from(aabb.low[0]) / unit <= exact as f64
                    && exact as f64 <= f64::from(aabb.high[0]) / unit;
                *lost += usize::from(!holds);
            }
        }
        assert!(lost[0] == 0 && lost[1] > 1000, "{lost:?}");
    }
}
