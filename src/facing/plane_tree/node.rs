//! Nodes: the bounds of eight children.

use super::super::quantized::{self, BACK, FRONT, Quantized};

/// Children of a node.
pub(crate) const WIDE: usize = 8;

/// The bounds of eight children: for each component the lower bounds, then the upper ones.
#[derive(Clone, Debug, Default)]
pub(crate) struct Node(pub(crate) [[[i16; WIDE]; 2]; 4]);

/// Bounds on the heights of the planes of eight children: the lower ones, then the upper ones.
pub(crate) type Heights = [[i16; WIDE]; 2];

impl Node {
    /// The height of a plane never falls when a number of it grows whose counterpart of the light is not
    /// negative, and never rises otherwise. So one corner of the box is the lowest that any plane within
    /// reaches, in the very numbers that decide a plane, and another corner the highest: nothing but the
    /// bound of [`Quantized`] is needed.
    #[inline(always)]
    pub(crate) fn heights(&self, light: &Quantized, heights: &mut Heights) {
        for (end, heights) in heights.iter_mut().enumerate() {
            let [x, y, z, w] = [0, 1, 2, 3].map(|i| &self.0[i][end ^ usize::from(light[i] < 0)]);
            for place in 0..WIDE {
                heights[place] = quantized::height([x[place], y[place], z[place], w[place]], light);
            }
        }
    }

    /// One byte per child: 1 if it may hold planes of both sides, or one that is left open. And one byte per
    /// child: 1 if the light is in front of all its planes.
    #[inline(never)]
    pub(crate) fn decided(&self, light: &Quantized) -> [u64; 2] {
        let mut heights = Heights::default();
        self.heights(light, &mut heights);
        let (mut undecided, mut in_front) = ([0_u8; WIDE], [0_u8; WIDE]);
        for place in 0..WIDE {
            undecided[place] = undecided_child(&heights, place) as u8;
            in_front[place] = u8::from(heights[0][place] >= FRONT);
        }
        [undecided, in_front].map(u64::from_le_bytes)
    }
}

/// 1 for a child that may hold planes of both sides, or one that is left open; otherwise 0.
#[inline(always)]
pub(crate) fn undecided_child([least, most]: &Heights, place: usize) -> usize {
    usize::from((least[place] < FRONT) & (most[place] > BACK))
}
