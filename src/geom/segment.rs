//! The part of a line that a query looks along, and a box test that never misses.

use super::{Aabb, Light};

/// From a point towards another one (`t` in 0 ..= 1) or along a direction without end.
///
/// [`Segment::may_meet`] is conservative: it says no only if no point of the closed segment lies in the box.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    origin: [f64; 3],
    direction: [f64; 3],
    /// 1 / direction, infinite where that is 0.
    inverse: [f64; 3],
    /// Largest `t`.
    end: f64,
}

/// Entry and exit parameters are `(bound − origin) · (1 / direction)`: four roundings (the direction's own
/// among them), so each is off by less than 5·2⁻⁵³ of itself, and an entry that truly comes no later than an
/// exit is found later by a factor of less than 1 + 11·2⁻⁵³. Widening exits by 1 + 16·2⁻⁵³ therefore never
/// loses a box. (The argument of Thiago Ize, *Robust BVH Ray Traversal*, 2013, section 3, in `f64` and with
/// the bounds exact.) Boxes are lost at 1 + 2·2⁻⁵³. Nothing overflows: `f32` differences and their inverses stay within 2^±149.
const WIDEN: f64 = 1.0 + 8.0 * f64::EPSILON;

impl Segment {
    /// From `origin` to `target`.
    #[must_use]
    pub fn between(origin: [f32; 3], target: [f32; 3]) -> Self {
        let direction = std::array::from_fn(|i| f64::from(target[i]) - f64::from(origin[i]));
        Self::new(origin.map(f64::from), direction, 1.0)
    }

    /// From `origin` along `direction` without end.
    #[must_use]
    pub fn along(origin: [f32; 3], direction: [f32; 3]) -> Self {
        Self::new(origin.map(f64::from), direction.map(f64::from), f64::INFINITY)
    }

    /// From `origin` to a light.
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

    /// The same line, no farther than `t`.
    #[must_use]
    pub(crate) fn until(self, t: f64) -> Self {
        Self { end: t, ..self }
    }

    /// Whether the closed segment may meet the closed box: no false "no".
    #[inline]
    #[must_use]
    pub fn may_meet(&self, aabb: &Aabb) -> bool {
        self.entry(aabb).is_some()
    }

    /// Where the segment may enter the box, rounded; `None` only if it does not meet it.
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
        // The sign of an exit is exact, so a box behind the origin has a negative one.
        (entry <= exit * widen).then_some(entry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A box drawn around a point of the segment, rounded outwards by nothing at all, must be met.
        #[test]
        fn segment_never_misses_a_box_around_one_of_its_points(
            origin in [-1e3_f32..1e3, -1e3_f32..1e3, -1e3_f32..1e3],
            step in [-8_i8..8, -8_i8..8, -8_i8..8],
            eighths in 0_u8..=8,
            size in 0.0_f32..2.0,
        ) {
            // Whole numbers make the target and the point on the way exact.
            let origin = origin.map(f32::round);
            let target: [f32; 3] = std::array::from_fn(|i| origin[i] + 8.0 * f32::from(step[i]));
            let point: [f32; 3] = std::array::from_fn(|i| origin[i] + f32::from(eighths) * f32::from(step[i]));
            let aabb = Aabb { low: point.map(|x| x - size), high: point };
            prop_assert!(Segment::between(origin, target).may_meet(&aabb));
            let beside = Aabb { low: point.map(|x| x + 5000.0), high: point.map(|x| x + 6000.0) };
            prop_assert!(!Segment::between(origin, target).may_meet(&beside));
        }

        /// The same along a direction without end, scaled to the ends of `f32`; components may be zero.
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
            // The sabotage: a segment that ends too soon misses it.
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
}
