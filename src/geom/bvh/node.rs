//! A BVH node with eight children in 80 bytes.
//!
//! Boxes are rounded outwards to a grid of 256 planes per axis (Ylitie, Karras and Laine, *Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*, 2017, section 3). Here the grid step is a
//! power of two, and all planes are multiples of the step, at most 2²⁴ times the step. So every plane is an
//! `f32`, decoding rounds nothing, and a decoded box is tested like any other box. (In the paper the origin
//! is arbitrary, and the distance to a plane has an error that grows with the node's error.)

use glam::Vec4;

use super::super::Aabb;

/// Number of children per node.
pub(super) const WIDTH: usize = 8;

/// Boxes of the children, axis by axis, and their contents: inner nodes first, then leaves, then unused
/// slots.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(super) struct Node {
    /// Low x, high x, low y, high y, low z, high z in grid steps.
    pub(super) bounds: [[u8; WIDTH]; 6],
    /// Origin of the grid, a multiple of its step.
    pub(super) origin: [f32; 3],
    /// Step of the grid: the exponent of a power of two, plus 127.
    pub(super) steps: [u8; 3],
    /// Number of children, plus 16 times the number of children that are inner nodes.
    pub(super) children: u8,
    /// Index of the first child that is an inner node; the others follow.
    pub(super) first_node: u32,
    /// First slot of the first leaf.
    pub(super) first_slot: u32,
    /// For a leaf: offset of its slots from `first_slot` times 8, plus their number. 0 for an inner node or
    /// an unused slot.
    pub(super) leaves: [u8; WIDTH],
}

const _: () = assert!(size_of::<Node>() == 80);

impl Node {
    /// A node without children.
    pub(super) const EMPTY: Self = Self {
        bounds: [[0; WIDTH]; 6],
        origin: [0.0; 3],
        steps: [1; 3],
        children: 0,
        first_node: 0,
        first_slot: 0,
        leaves: [0; WIDTH],
    };

    /// One plane of each child; exact if no coordinate reaches 2¹²⁷.
    #[inline(always)]
    pub(super) fn plane(&self, plane: usize) -> [Vec4; 2] {
        let axis = plane / 2;
        let step = Vec4::splat(f32::from_bits(u32::from(self.steps[axis]) << 23));
        let origin = Vec4::splat(self.origin[axis]);
        let steps = &self.bounds[plane];
        let four = |i: usize| Vec4::from([steps[i], steps[i + 1], steps[i + 2], steps[i + 3]].map(f32::from));
        [origin + four(0) * step, origin + four(4) * step]
    }

    /// The stored box of a child.
    pub(super) fn aabb(&self, lane: usize) -> Aabb {
        let grid = |axis: usize| Grid { origin: self.origin[axis], step: self.steps[axis] };
        let at = |plane: usize| {
            let at = grid(plane / 2).plane(self.bounds[plane][lane]);
            at.clamp(-f64::from(f32::MAX), f64::from(f32::MAX)) as f32 // boxes end there, too
        };
        Aabb { low: [at(0), at(2), at(4)], high: [at(1), at(3), at(5)] }
    }

    /// One bit per child.
    #[inline(always)]
    pub(super) fn children(&self) -> u32 {
        (1 << (self.children & 15)) - 1
    }

    /// One bit per child that is an inner node.
    #[inline(always)]
    pub(super) fn inner(&self) -> u32 {
        (1 << (self.children >> 4)) - 1
    }

    /// Stores the boxes of the children, rounded outwards.
    pub(super) fn store(&mut self, boxes: impl Iterator<Item = Aabb> + Clone) {
        let around = boxes.clone().fold(Aabb::EMPTY, |around, next| around.join(&next));
        for axis in 0..3 {
            let bounds = boxes.clone().map(|aabb| (aabb.low[axis], aabb.high[axis]));
            let grid = Grid::over(around.low[axis], around.high[axis]);
            (self.origin[axis], self.steps[axis]) = (grid.origin, grid.step);
            for (lane, (low, high)) in bounds.enumerate() {
                self.bounds[2 * axis][lane] = grid.below(low);
                self.bounds[2 * axis + 1][lane] = grid.above(high);
            }
        }
    }
}

/// Grid of 256 planes across an axis. All planes are multiples of the step, at most 2²⁴ times the step:
/// numbers of 24 bits.
#[derive(Clone, Copy, Debug)]
struct Grid {
    origin: f32,
    /// As [`Node::steps`].
    step: u8,
}

impl Grid {
    /// The finest grid that covers `low` to `high`.
    fn over(low: f32, high: f32) -> Self {
        let exponent = |x: f32| (x.to_bits() >> 23 & 0xff) as i32; // biased by 127
        let largest = exponent(low).max(exponent(high));
        // At least 128 steps and less than 256. If 255 steps do not suffice, the doubled step does.
        let extent = f64::from(high) - f64::from(low);
        let across = (extent.to_bits() >> 52) as i32 - 1023 + 127 - 7;
        let mut step = across.max(largest - 23).clamp(1, 254);
        loop {
            let size = power(step);
            let origin = (f64::from(low) / size).floor() * size;
            if origin + 255.0 * size >= f64::from(high) {
                return Self { origin: origin as f32, step: step as u8 };
            }
            step += 1;
        }
    }

    /// The origin in `f64`; −2¹²⁸ is stored as −∞.
    fn origin(self) -> f64 {
        f64::from(self.origin).max(-power(127 + 128))
    }

    fn plane(self, steps: u8) -> f64 {
        self.origin() + f64::from(steps) * power(i32::from(self.step))
    }

    /// Last plane that is not above `x`.
    fn below(self, x: f32) -> u8 {
        let steps = self.steps_to(x).floor() as u8;
        steps - u8::from(self.plane(steps) > f64::from(x))
    }

    /// First plane that is not below `x`.
    fn above(self, x: f32) -> u8 {
        let steps = self.steps_to(x).ceil() as u8;
        steps + u8::from(self.plane(steps) < f64::from(x))
    }

    /// Distance from the origin to `x` in steps, rounded to `f64`.
    fn steps_to(self, x: f32) -> f64 {
        (f64::from(x) - self.origin()) / power(i32::from(self.step))
    }
}

/// 2 to the power of `biased` − 127.
#[inline]
fn power(biased: i32) -> f64 {
    f64::from_bits(((biased - 127 + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    /// Boxes of eight children: ordinary, flat, points, far from the origin, at the ends of the range.
    fn cases() -> Vec<[Aabb; WIDTH]> {
        let mut random = SplitMix64(6);
        let mut cases = Vec::new();
        for exponent in [-149, -140, -126, -60, -3, 0, 10, 59, 126] {
            for offset in [0.0, 1.0, -3.0, 1000.0, -1e6] {
                for _ in 0..100 {
                    let scale = 2.0_f64.powi(exponent);
                    let mut number = || ((offset + random.unit()) * scale).clamp(-MOST, MOST) as f32;
                    cases.push(
                        [(); WIDTH].map(|()| Aabb::around([(); 2].map(|()| [(); 3].map(|()| number())))),
                    );
                }
            }
        }
        // Arbitrary finite coordinates.
        let mut number = || loop {
            let number = f32::from_bits(random.next() as u32);
            if number.is_finite() {
                return number;
            }
        };
        for _ in 0..3000 {
            cases.push([(); WIDTH].map(|()| Aabb::around([(); 2].map(|()| [(); 3].map(|()| number())))));
        }
        let ends = [f32::MAX, f32::MIN, 0.0, f32::MIN_POSITIVE, 1e-45, -1e-45, 16_777_217.0, -0.0];
        cases.push(ends.map(|x| Aabb::around([[x, 1.0, 0.0], [0.0, 1.0, x]])));
        cases.push(ends.map(|x| Aabb { low: [x; 3], high: [x; 3] }));
        cases.push(ends.map(|x| Aabb { low: [f32::MIN; 3], high: [-x.abs(); 3] }));
        cases.push([Aabb { low: [f32::MIN; 3], high: [f32::MIN; 3] }; WIDTH]);
        cases.push([Aabb { low: [f32::MAX; 3], high: [f32::MAX; 3] }; WIDTH]);
        cases
    }

    const MOST: f64 = f32::MAX as f64;

    /// Number of cases in which some box is not within the box stored for it.
    fn lost(fault: impl Fn(&mut Node)) -> usize {
        let loses = |boxes: &[Aabb; WIDTH]| {
            let mut node = Node::EMPTY;
            node.store(boxes.iter().copied());
            fault(&mut node);
            (0..WIDTH).any(|lane| !node.aabb(lane).contains_box(&boxes[lane]))
        };
        cases().iter().filter(|boxes| loses(boxes)).count()
    }

    #[test]
    fn bvh_node_boxes_hold_what_was_stored_and_a_plane_further_in_does_not() {
        assert_eq!(lost(|_| {}), 0);
        for plane in 0..6 {
            let inward = |node: &mut Node| {
                for steps in &mut node.bounds[plane] {
                    *steps = if plane % 2 == 0 { steps.saturating_add(1) } else { steps.saturating_sub(1) };
                }
            };
            assert!(2 * lost(inward) > cases().len(), "{plane}");
        }
        assert!(lost(|node| node.steps[1] -= u8::from(node.steps[1] > 1)) > 1000);
        assert!(lost(|node| node.origin[2] = node.origin[2].next_up()) > 1000);
    }

    #[test]
    fn bvh_node_planes_are_exact_in_f32_and_at_most_a_step_away() {
        let (mut compared, mut exact) = (0, 0);
        for boxes in cases() {
            let mut node = Node::EMPTY;
            node.store(boxes.iter().copied());
            let largest = boxes.iter().flat_map(|aabb| [aabb.low, aabb.high]).flatten();
            let in_range = largest.fold(0.0_f32, |most, x| most.max(x.abs())) < 2.0_f32.powi(126);
            for plane in 0..6 {
                let ([a, b], step) = (node.plane(plane), power(i32::from(node.steps[plane / 2])));
                let fast = [a.to_array(), b.to_array()].concat();
                for (lane, aabb) in boxes.iter().enumerate() {
                    let stored = node.aabb(lane);
                    let bound = |aabb: &Aabb| [aabb.low, aabb.high][plane % 2][plane / 2];
                    assert!(!in_range || fast[lane] == bound(&stored), "{boxes:?}");
                    assert!((f64::from(bound(&stored)) - f64::from(bound(aabb))).abs() <= step);
                    exact += usize::from(bound(&stored) == bound(aabb));
                    compared += usize::from(in_range);
                }
            }
            for axis in 0..3 {
                let around = boxes.iter().fold(Aabb::EMPTY, |around, next| around.join(next));
                let extent = f64::from(around.high[axis]) - f64::from(around.low[axis]);
                let largest = around.low[axis].abs().max(around.high[axis].abs());
                let ulp = f64::from(largest) - f64::from(largest.next_down());
                let step = power(i32::from(node.steps[axis]));
                assert!(
                    step <= (extent / 63.0).max(2.0 * ulp).max(f64::from(f32::MIN_POSITIVE)),
                    "{boxes:?}"
                );
            }
        }
        assert!(compared > 100_000 && exact > 1000, "{compared} {exact}");
    }
}
