//! Segments and rays for queries, with a box test that never misses.

use glam::Vec4;

use super::{Aabb, Light};

/// A segment from a point to another one (`t` in 0 ..= 1), or a ray along a direction.
///
/// [`Segment::may_meet`] is conservative: `false` guarantees that no point of the closed segment lies in the
/// box.
///
/// ```
/// use umbrage::geom::{Aabb, Segment};
/// let aabb = Aabb { low: [2.0, -1.0, -1.0], high: [3.0, 1.0, 1.0] };
/// assert!(Segment::between([0.0; 3], [4.0, 0.0, 0.0]).may_meet(&aabb));
/// assert!(!Segment::between([0.0; 3], [1.0, 0.0, 0.0]).may_meet(&aabb));
/// assert!(Segment::along([0.0; 3], [1.0, 0.0, 0.0]).may_meet(&aabb));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    origin: [f64; 3],
    direction: [f64; 3],
    /// 1 / direction; infinite where the direction is 0.
    inverse: [f64; 3],
    /// Largest `t` of the segment.
    end: f64,
}

/// Factor that widens exit parameters, so that no box is lost.
///
/// Entry and exit parameters are `(bound − origin) · (1 / direction)`: four roundings (the direction's own
/// among them), so each has a relative error below 5·2⁻⁵³. An entry that is in truth at most an exit is
/// computed larger by a factor of less than 1 + 11·2⁻⁵³. Widening exits by 1 + 16·2⁻⁵³ therefore never loses
/// a box. (The argument is that of Thiago Ize, *Robust BVH Ray Traversal*, 2013, section 3, in `f64` and with
/// exact bounds.) At 1 + 2·2⁻⁵³ boxes are lost. Nothing overflows: `f32` differences and their inverses stay
/// within 2^±149.
const WIDEN: f64 = 1.0 + 8.0 * f64::EPSILON;

impl Segment {
    /// The segment from `origin` to `target`.
    #[must_use]
    pub fn between(origin: [f32; 3], target: [f32; 3]) -> Self {
        let direction = std::array::from_fn(|i| f64::from(target[i]) - f64::from(origin[i]));
        Self::new(origin.map(f64::from), direction, 1.0)
    }

    /// The ray from `origin` along `direction`, without end.
    #[must_use]
    pub fn along(origin: [f32; 3], direction: [f32; 3]) -> Self {
        Self::new(origin.map(f64::from), direction.map(f64::from), f64::INFINITY)
    }

    /// The segment from `origin` to a point light, or the ray towards a directional light.
    #[must_use]
    pub fn to_light(origin: [f32; 3], light: &Light) -> Self {
        if light.is_directional() {
            Self::along(origin, light.xyz())
        } else {
            Self::between(origin, light.xyz())
        }
    }

    fn new(origin: [f64; 3], direction: [f64; 3], end: f64) -> Self {
        Self { origin, direction, inverse: direction.map(f64::recip), end }
    }

    /// The same segment, ending at `t`.
    #[must_use]
    pub(crate) fn until(self, t: f64) -> Self {
        Self { end: t, ..self }
    }

    /// Whether the closed segment may meet the closed box. May be wrong only by answering `true`.
    #[inline]
    #[must_use]
    pub fn may_meet(&self, aabb: &Aabb) -> bool {
        self.entry(aabb).is_some()
    }

    /// Rounded parameter at which the segment enters the box; `None` only if the segment misses the box.
    #[inline]
    #[must_use]
    pub(crate) fn entry(&self, aabb: &Aabb) -> Option<f64> {
        self.widened_entry(aabb, WIDEN)
    }

    #[inline(always)]
    fn widened_entry(&self, aabb: &Aabb, widen: f64) -> Option<f64> {
        let (mut entry, mut exit) = (0.0_f64, self.end);
        for i in 0..3 {
            let (low, high) =
                (f64::from(aabb.low[i]) - self.origin[i], f64::from(aabb.high[i]) - self.origin[i]);
            if self.direction[i] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (t0, t1) = (low * self.inverse[i], high * self.inverse[i]);
            entry = entry.max(t0.min(t1));
            exit = exit.min(t0.max(t1));
        }
        // The sign of an exit is exact, so the exit of a box behind the origin is negative.
        (entry <= exit * widen).then_some(entry)
    }
}

/// A [`Segment`] in `f32` for tests against several boxes at once.
///
/// Let u = 2⁻²⁴. The direction, its inverse, the difference and the product round once each. An entry or exit
/// therefore has a relative error below 4.01u, or an absolute error of 2⁻¹⁵⁰ where the product is subnormal.
/// An entry that is in truth at most an exit is computed larger by a factor of less than 1 + 8.1u. Widening
/// the inverse for exits by 1 + 16u, itself rounded once, never loses a box. The smallest normal number,
/// added to the exit, exceeds what subnormal products lose. The exit of a box behind the origin has the
/// correct sign. (At 1 + 2u boxes are lost.)
///
/// Ranges: let coordinates be below 2⁶⁰, planes rounded outwards below 2⁶¹, and direction components in
/// 2⁻⁶⁰ .. 2⁶⁰. Then inverses are normal and parameters stay below 2¹²², that is, finite. A component of 0
/// has an infinite inverse. Its products are infinite with the correct sign, or NaN where the origin lies in
/// a plane of the box. If one operand is NaN, `max` and `min` of vectors may return either: a bound is
/// dropped or becomes NaN, and then no comparison says that the box is missed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Narrow {
    origin: [f32; 3],
    /// 1 / direction, for the planes entered through.
    first: [f32; 3],
    /// 1 / direction, widened, for the planes left through.
    last: [f32; 3],
    /// 1 where the direction is negative, so that the high plane is the entry plane.
    turned: [usize; 3],
    /// Largest parameter, widened likewise.
    end: f32,
}

const NARROW_WIDEN: f32 = 1.0 + 8.0 * f32::EPSILON;
/// Coordinates and direction components must be smaller in magnitude.
const MOST: f32 = (1_u64 << 60) as f32;
/// Direction components must be larger in magnitude, unless they are 0.
const LEAST: f32 = 1.0 / MOST;

impl Narrow {
    /// Whether the coordinates of boxes within `bounds` are in range.
    pub(crate) fn fits(bounds: &Aabb) -> bool {
        (0..3).all(|i| bounds.low[i] > -MOST && bounds.high[i] < MOST)
    }

    /// The segment from `origin` to a light; `None` where the range of `f32` might not suffice.
    #[inline(always)]
    pub(crate) fn to_light(origin: [f32; 3], light: &Light) -> Option<Self> {
        Self::widened(origin, light, NARROW_WIDEN)
    }

    #[inline(always)]
    fn widened(origin: [f32; 3], light: &Light, widen: f32) -> Option<Self> {
        let [x, y, z] = light.xyz();
        let (direction, end) = if light.is_directional() {
            ([x, y, z], f32::MAX)
        } else {
            ([x - origin[0], y - origin[1], z - origin[2]], widen)
        };
        let (mut first, mut last, mut turned) = ([0.0; 3], [0.0; 3], [0; 3]);
        let mut fits = true;
        for i in 0..3 {
            let size = direction[i].abs();
            fits &= (origin[i].abs() < MOST) & (size < MOST) & ((size > LEAST) | (size == 0.0));
            first[i] = 1.0 / (direction[i] + 0.0); // never 1 / −0.0, as `turned` ignores its sign
            last[i] = first[i] * widen;
            turned[i] = usize::from(direction[i] < 0.0);
        }
        fits.then_some(Self { origin, first, last, turned, end })
    }

    /// Ends the segment at `t`.
    #[inline]
    pub(crate) fn shorten(&mut self, t: f64) {
        self.end = ((t * f64::from(NARROW_WIDEN)) as f32).min(f32::MAX);
    }

    /// Approximate point where the segment enters a box; `None` only if the segment misses the box.
    #[inline]
    pub(crate) fn entry(&self, aabb: &Aabb) -> Option<[f32; 3]> {
        let ([t], hits) = self.entries(|plane| [Vec4::splat([aabb.low, aabb.high][plane % 2][plane / 2])]);
        let t = t.x;
        (hits != 0).then(|| {
            let at = |i: usize| self.origin[i] + if t > 0.0 { t / self.first[i] } else { 0.0 };
            [at(0), at(1), at(2)]
        })
    }

    /// Rounded entry parameters, and one bit per box that the segment may meet; no bit is missing.
    ///
    /// `plane` returns low x, high x, low y, high y, low z, high z of each box, four boxes per vector.
    #[inline(always)]
    pub(crate) fn entries<const N: usize>(&self, plane: impl Fn(usize) -> [Vec4; N]) -> ([Vec4; N], u32) {
        let (mut entry, mut exit) = ([Vec4::ZERO; N], [Vec4::splat(self.end); N]);
        for axis in 0..3 {
            let turned = self.turned[axis] & 1;
            let (first, last) = (plane(2 * axis + turned), plane(2 * axis + (turned ^ 1)));
            let origin = Vec4::splat(self.origin[axis]);
            for i in 0..N {
                let t0 = (first[i] - origin) * Vec4::splat(self.first[axis]);
                let t1 = (last[i] - origin) * Vec4::splat(self.last[axis]);
                (entry[i], exit[i]) = (t0.max(entry[i]), t1.min(exit[i]));
            }
        }
        let mut hits = 0;
        for i in 0..N {
            // A box counts as met unless the comparison proves a miss; see above on NaN.
            let misses = entry[i].cmpgt(exit[i] + Vec4::splat(f32::MIN_POSITIVE));
            hits |= (misses.bitmask() ^ 15) << (4 * i);
        }
        (entry, hits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A box around a point of the segment must be met, without any outward rounding.
        #[test]
        fn segment_never_misses_a_box_around_one_of_its_points(
            origin in [-1e3_f32..1e3, -1e3_f32..1e3, -1e3_f32..1e3],
            step in [-8_i8..8, -8_i8..8, -8_i8..8],
            eighths in 0_u8..=8,
            size in 0.0_f32..2.0,
        ) {
            // Integers make the target and the point on the segment exact.
            let origin = origin.map(f32::round);
            let target: [f32; 3] = std::array::from_fn(|i| origin[i] + 8.0 * f32::from(step[i]));
            let point: [f32; 3] = std::array::from_fn(|i| origin[i] + f32::from(eighths) * f32::from(step[i]));
            let aabb = Aabb { low: point.map(|x| x - size), high: point };
            prop_assert!(Segment::between(origin, target).may_meet(&aabb));
            let beside = Aabb { low: point.map(|x| x + 5000.0), high: point.map(|x| x + 6000.0) };
            prop_assert!(!Segment::between(origin, target).may_meet(&beside));
        }

        /// The same for a ray, scaled to the ends of the `f32` range; components may be zero.
        #[test]
        fn segment_along_a_direction_never_misses_a_box_around_one_of_its_points(
            origin in [-1000_i16..1000, -1000_i16..1000, -1000_i16..1000],
            step in [-8_i8..8, -8_i8..8, -8_i8..8],
            steps in 0_u8..100,
            exponent in prop_oneof![Just(0), Just(-149), Just(-130), Just(110)],
        ) {
            let scale = 2.0_f64.powi(exponent) as f32;
            let origin = origin.map(f32::from);
            let at = |t: f32| -> [f32; 3] { std::array::from_fn(|i| (origin[i] + t * f32::from(step[i])) * scale) };
            let segment = Segment::along(at(0.0), step.map(|x| f32::from(x) * scale));
            let point = at(f32::from(steps));
            let holds = Aabb { low: point, high: point };
            prop_assert!(segment.may_meet(&holds));
            prop_assert!(segment.until(f64::from(steps)).may_meet(&holds));
            // Fault injected: a segment that ends too early misses the box.
            if steps > 1 && step != [0; 3] {
                prop_assert!(!segment.until(f64::from(steps) - 0.5).may_meet(&holds));
            }
        }
    }

    #[test]
    fn segment_bound_holds_and_smaller_ones_are_caught() {
        let mut random = crate::random::SplitMix64(1);
        let mut missed = [0; 4];
        for _ in 0..300_000 {
            let mut whole = |most: usize| random.below(2 * most + 1) as f32 - most as f32;
            let origin = [(); 3].map(|()| whole(1000));
            let step = [(); 3].map(|()| whole(4000));
            let (k, n) = (whole(500).abs(), 500.0);
            let at = |t: f32| [0, 1, 2].map(|i| origin[i] + t * step[i]);
            let segment = Segment::between(origin, at(n));
            let holds = Aabb { low: at(k), high: at(k) };
            for (missed, ulps) in missed.iter_mut().zip([8.0, 1.0, 0.5, 0.0]) {
                let widen = 1.0 + ulps * f64::EPSILON;
                *missed += usize::from(segment.widened_entry(&holds, widen).is_none());
            }
        }
        assert!(missed[0] == 0 && missed[3] > 0, "{missed:?}");
    }

    /// Whether a box that consists of one point of the segment is met; every number is exact.
    fn meets_point_of_way(random: &mut crate::random::SplitMix64, widen: f32) -> bool {
        let mut whole = |most: usize| random.below(2 * most + 1) as f32 - most as f32;
        let origin = [(); 3].map(|()| whole(1000));
        let step = [(); 3].map(|()| whole(4000));
        let (k, n, directional) = (whole(500).abs(), 500.0, whole(1) > 0.0 && step != [0.0; 3]);
        let scale = 2.0_f32.powi(whole(36) as i32);
        let at = |t: f32| [0, 1, 2].map(|i| (origin[i] + t * step[i]) * scale);
        let light = match directional {
            true => Light::directional(step.map(|x| -x * scale)).unwrap(),
            false => Light::point(at(n)).unwrap(),
        };
        let narrow = Narrow::widened(at(0.0), &light, widen).expect("numbers are in range");
        narrow.entries(|plane| [Vec4::splat(at(k)[plane / 2])]).1 == 15
    }

    #[test]
    fn segment_in_f32_never_misses_a_point_of_its_own_and_smaller_bounds_are_caught() {
        let mut missed = [0; 3];
        for (missed, ulps) in missed.iter_mut().zip([8.0, 1.0, 0.0]) {
            let mut random = crate::random::SplitMix64(2);
            for _ in 0..300_000 {
                *missed += usize::from(!meets_point_of_way(&mut random, 1.0 + ulps * f32::EPSILON));
            }
        }
        assert!(missed[0] == 0 && missed[2] > 0, "{missed:?}");
    }

    #[test]
    fn segment_in_f32_meets_what_it_meets_in_f64_and_little_more() {
        let mut random = crate::random::SplitMix64(3);
        let (mut met, mut more, mut all) = (0, 0, 0);
        for _ in 0..100_000 {
            let mut next = || (random.below(4001) as f32 - 2000.0) / 1024.0;
            let mut vector = || [next(), next(), next()];
            let (p, l, low, size) = (vector(), vector(), vector(), vector());
            let aabb = Aabb { low, high: [0, 1, 2].map(|i| low[i] + 0.3 * size[i].abs()) };
            for light in [Light::point(l), Light::directional([l[0], 0.0, 1.0])].map(Result::unwrap) {
                let Some(narrow) = Narrow::to_light(p, &light) else { continue };
                let (wide, narrow) =
                    (Segment::to_light(p, &light).may_meet(&aabb), narrow.entry(&aabb).is_some());
                assert!(narrow || !wide, "{p:?} {light} {aabb:?}");
                all += 1;
                met += i32::from(wide);
                more += i32::from(narrow && !wide);
            }
        }
        assert!(met > all / 1000 && more * 1000 < all, "{met} and {more} of {all}");
    }

    #[test]
    fn segment_in_f32_declines_what_may_leave_its_range() {
        let far = Light::point([1e30, 0.0, 0.0]).unwrap();
        let flat = Light::directional([1.0, 1e-30, 0.0]).unwrap();
        assert!(Narrow::to_light([0.0; 3], &far).is_none() && Narrow::to_light([0.0; 3], &flat).is_none());
        assert!(!Narrow::fits(&Aabb { low: [0.0; 3], high: [0.0, 0.0, 1e19] }));
    }
}
