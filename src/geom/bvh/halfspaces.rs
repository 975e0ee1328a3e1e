//! Boxes against a few half-spaces through or near a point: the sides of a pyramid seen from there.

use glam::Vec4;

use super::super::Aabb;
use super::node::{Node, WIDTH};
use super::wide::Enter;

/// The points x with `normal`·(x − p) ≥ `least`, for a point p.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HalfSpace {
    pub(crate) normal: [f64; 3],
    pub(crate) least: f64,
}

impl HalfSpace {
    /// Whether a box may have a point in the half-space. Wrong only by `true`: by the count of [`Sides`], 8
    /// roundings of the terms are more than what is lost.
    #[inline(always)]
    pub(super) fn may_meet(&self, aabb: &Aabb, p: [f32; 3], reach: [f64; 3]) -> bool {
        let (mut value, mut terms) = (0.0, 0.0);
        for i in 0..3 {
            let far = if self.normal[i] > 0.0 { aabb.high[i] } else { aabb.low[i] };
            value += self.normal[i] * (f64::from(far) - f64::from(p[i]));
            terms += self.normal[i].abs() * reach[i];
        }
        let outside = value < self.least - 4.0 * f64::EPSILON * terms;
        !outside
    }
}

/// Most half-spaces of one query.
pub(crate) const MOST_SIDES: usize = 5;

/// Half-spaces whose normals have a largest entry of ½ to 1, with `least` lowered by what rounding may cost.
///
/// Let u be the rounding unit of `F`. An entry of the normal rounds once, a difference x − p once, their
/// product once, and two sums add at most twice: a value errs by less than 6u of the sum of
/// |normal|·|x − p|. `reach` bounds |x − p| for every plane of every box. `least` is lowered by 8u of that
/// sum, by the rounding of `least` itself, and by 2⁻¹⁴⁰ of the reach, which is more than what entries below
/// the range of `f32` lose. (A test fails without it.)
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides<F> {
    origin: [F; 3],
    sides: [([F; 3], F); MOST_SIDES],
    count: usize,
}

impl Sides<f64> {
    /// `unit`: the rounding unit of the numbers that the test will run in.
    #[inline(always)]
    pub(super) fn new(p: [f32; 3], spaces: &[HalfSpace], reach: [f64; 3], unit: f64) -> Self {
        let mut sides = [([0.0; 3], 0.0); MOST_SIDES];
        for (side, space) in sides.iter_mut().zip(spaces) {
            let largest = space.normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            // A power of two rounds nothing. Normals that are not finite, or 0, let every box pass.
            let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i32 - 1022;
            let scale = f64::from_bits(((1023 - exponent).clamp(1, 2046) as u64) << 52);
            let normal = space.normal.map(|x| x * scale);
            let least = space.least * scale;
            let sum: f64 = (0..3).map(|i| normal[i].abs() * reach[i]).sum();
            let lost =
                8.0 * unit * sum + 2.0 * unit * least.abs() + 2f64.powi(-140) * reach.iter().sum::<f64>();
            *side = (normal, least - lost - f64::MIN_POSITIVE);
        }
        Self { origin: p.map(f64::from), sides, count: spaces.len().min(MOST_SIDES) }
    }

    /// The same for `f32`.
    pub(super) fn narrow(&self) -> Sides<f32> {
        Sides {
            origin: self.origin.map(|x| x as f32),
            sides: self.sides.map(|(normal, least)| (normal.map(|x| x as f32), (least as f32).next_down())),
            count: self.count,
        }
    }
}

impl Enter for Sides<f32> {
    #[inline(always)]
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32) {
        let away = |plane: usize| {
            let [a, b] = node.plane(plane);
            let from = Vec4::splat(self.origin[plane / 2]);
            [a - from, b - from]
        };
        let planes = [away(0), away(1), away(2), away(3), away(4), away(5)];
        let mut hits = node.children();
        for (normal, least) in &self.sides[..self.count] {
            let mut value = [Vec4::ZERO; 2];
            for axis in 0..3 {
                // The corner of the box that lies farthest along the normal.
                let far = &planes[2 * axis + usize::from(normal[axis] > 0.0)];
                let along = Vec4::splat(normal[axis]);
                value = [value[0] + along * far[0], value[1] + along * far[1]];
            }
            let least = Vec4::splat(*least);
            // A value that is not a number lets the box pass.
            let below = value[0].cmplt(least).bitmask() | value[1].cmplt(least).bitmask() << 4;
            hits &= !below;
        }
        ([0.0; WIDTH], hits)
    }

    fn shorten(&mut self, _: f64) {}
}

/// For coordinates outside the range of `f32` products.
impl Enter for Sides<f64> {
    fn entries(&self, node: &Node) -> ([f32; WIDTH], u32) {
        let mut hits = node.children();
        for lane in 0..WIDTH {
            let aabb = node.aabb(lane);
            let outside = self.sides[..self.count].iter().any(|(normal, least)| {
                let along = |axis: usize| {
                    let far = if normal[axis] > 0.0 { aabb.high[axis] } else { aabb.low[axis] };
                    normal[axis] * (f64::from(far) - self.origin[axis])
                };
                along(0) + along(1) + along(2) < *least
            });
            if outside {
                hits &= !(1 << lane);
            }
        }
        ([0.0; WIDTH], hits)
    }

    fn shorten(&mut self, _: f64) {}
}

#[cfg(test)]
mod tests {
    use super::super::Bvh;
    use super::*;
    use crate::geom::Aabb;
    use crate::random::SplitMix64;

    /// Boxes with a corner in all half-spaces that a walk does not visit, and the visits it saves.
    fn lost(scale: f32, shrunk: f64) -> (usize, usize) {
        let mut random = SplitMix64(11);
        let mut number = || (random.unit() as f32 * 2.0 - 1.0) * scale;
        let boxes: Vec<Aabb> = (0..2000)
            .map(|_| {
                let low = [number(), number(), number()];
                Aabb::around([low, low.map(|x| x + 0.01 * scale)])
            })
            .collect();
        let (wide, order) = Bvh::build(&boxes).into_wide();
        let (mut lost, mut saved) = (0, 0);
        for round in 0..60 {
            let p = [number(), number(), number()];
            let mut spaces = [HalfSpace::default(); 3];
            for space in &mut spaces {
                // Every second half-space goes through a corner of a box exactly.
                space.normal = [(); 3].map(|()| f64::from(number()));
                let corner = boxes[round * 7].high;
                let at = |x: [f32; 3]| -> f64 {
                    (0..3).map(|i| space.normal[i] * (f64::from(x[i]) - f64::from(p[i]))).sum()
                };
                space.least = if round % 2 == 0 { at(corner) } else { 0.0 };
            }
            let mut seen = vec![false; boxes.len()];
            let mut asked = spaces;
            asked.iter_mut().for_each(|space| space.least += shrunk * f64::from(scale).powi(2));
            wide.walk_within(p, wide.reach(p), &asked, |slot| seen[order[slot] as usize] = true);
            for (aabb, seen) in boxes.iter().zip(seen) {
                let inside = (0..8).any(|corner: usize| {
                    let x = [0, 1, 2].map(|i| if corner >> i & 1 == 0 { aabb.low[i] } else { aabb.high[i] });
                    spaces.iter().all(|space| {
                        let value: f64 =
                            (0..3).map(|i| space.normal[i] * (f64::from(x[i]) - f64::from(p[i]))).sum();
                        value >= space.least
                    })
                });
                lost += usize::from(inside && !seen);
                saved += usize::from(!seen);
            }
        }
        (lost, saved)
    }

    #[test]
    fn half_spaces_lose_no_box_and_save_most() {
        for scale in [1.0, 1e-42, 1e-30, 1e15, 1e30, 1e38] {
            let (lost, saved) = lost(scale, 0.0);
            // Boxes near the end of the range are coarse.
            assert!(lost == 0 && (saved > 60 * 500 || scale < 1e-40), "{scale}: {lost} lost, {saved} saved");
        }
        // The sabotage: half-spaces a little too small.
        assert!(lost(1.0, 1e-2).0 > 0);
    }
}
