//! Hard meshes, lights and points, drawn from any source of choices: written once, for the torture, for
//! proptest and for the fuzz targets.
//!
//! A generator asks a [`Draw`] for one small choice after another. Each choice is ordered so that 0 is the
//! simplest one. A stream of zeros therefore gives the simplest mesh, and whoever makes choices smaller makes
//! the mesh simpler. Three sources exist: random numbers (the torture), [`Bytes`] (the fuzz targets), and
//! recorded choices that proptest shrinks ([`strategy`](super::strategy)).
//!
//! ```
//! use umbrage::testing::generate::{Bytes, Draw, light, mesh, point};
//!
//! // No bytes, so all choices are 0: a tetrahedron, a light at the origin.
//! let mut bytes = Bytes::new(&[]);
//! let mesh = mesh(&mut bytes);
//! let light = light(&mut bytes, &mesh);
//! assert_eq!((mesh.face_count(), light.to_string().as_str()), (4, "point:0,0,0"));
//! assert_eq!(point(&mut bytes, &mesh, &light), [0.0; 3]);
//! ```

mod bytes;
mod damage;
mod feature;
mod light;
mod mesh;
mod point;
mod scale;
mod solid;

#[cfg(test)]
mod tests;

use crate::random::SplitMix64;

pub use bytes::Bytes;
pub use damage::Damage;
pub use light::light;
pub use mesh::mesh;
pub use point::point;

pub(crate) use damage::damage;
pub(crate) use feature::Feature;
pub(crate) use light::{LightKind, moderate_light};
pub(crate) use mesh::{Draft, Shape, faces};
pub(crate) use point::{PointKind, Sampler};
pub(crate) use scale::{Scale, power_of_two};
pub(crate) use solid::{bent, cad, closed, hollow, several, voxel_solid};

/// A source of choices.
pub trait Draw {
    /// An integer below `n`, which is not 0. The generators order every choice so that 0 is the simplest.
    fn below(&mut self, n: u32) -> u32;

    /// A number in [0, 1).
    fn unit(&mut self) -> f64;
}

impl Draw for SplitMix64 {
    fn below(&mut self, n: u32) -> u32 {
        Self::below(self, n as usize) as u32 // below `n`
    }

    fn unit(&mut self) -> f64 {
        Self::unit(self)
    }
}

impl dyn Draw + '_ {
    /// An index below `len`, which is 1 to 2³² − 1.
    pub(crate) fn index(&mut self, len: usize) -> usize {
        self.below(len as u32) as usize
    }

    /// One element of a list that is not empty; the first one is the simplest.
    pub(crate) fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.index(list.len())]
    }

    /// True for one of two choices; false is the simpler one.
    pub(crate) fn flag(&mut self) -> bool {
        self.below(2) == 1
    }

    /// An integer from `low`, at most 0, to `high`, at least 0, in the order 0, 1 … `high`, −1 … `low`.
    pub(crate) fn between(&mut self, low: i32, high: i32) -> i32 {
        let n = self.below((high - low + 1) as u32) as i32;
        if n <= high { n } else { high - n }
    }

    /// A number in (−1, 1); 0 is the simplest.
    pub(crate) fn signed(&mut self) -> f64 {
        let u = self.unit();
        if u < 0.5 { 2.0 * u } else { 1.0 - 2.0 * u }
    }

    /// Any finite `f32`, all exponents alike.
    pub(crate) fn bits(&mut self) -> f32 {
        let bits = self.below(1 << 16) << 16 | self.below(1 << 16);
        let any = f32::from_bits(bits);
        // Without the highest bit of its exponent a number is finite.
        if any.is_finite() { any } else { f32::from_bits(bits & !(1 << 30)) }
    }

    /// A coordinate from −3 to 3: four in five are integers, where exact ties are common.
    pub(crate) fn coordinate(&mut self) -> f32 {
        if self.below(5) < 4 { self.between(-3, 3) as f32 } else { (3.0 * self.signed()) as f32 }
    }

    /// A position: three times [`coordinate`](Self::coordinate).
    pub(crate) fn position(&mut self) -> [f32; 3] {
        [(); 3].map(|()| self.coordinate())
    }

    /// What `item` draws, up to `slots` times and at least `least` times: about one in eight is left out.
    ///
    /// All are drawn, so that to leave one out does not change what the others are drawn from.
    pub(crate) fn list<T>(
        &mut self,
        least: usize,
        slots: usize,
        mut item: impl FnMut(&mut dyn Draw) -> T,
    ) -> Vec<T> {
        let mut items = Vec::with_capacity(slots);
        for left in (1..=slots).rev() {
            let is_kept = self.below(8) > 0 || items.len() + left <= least;
            let item = item(self);
            if is_kept {
                items.push(item);
            }
        }
        items
    }
}

/// A position, often on the grid of integers, whose coordinates may be any finite `f32`: next to an integer,
/// tiny, huge, or of any bits.
pub fn position(draw: &mut dyn Draw) -> [f32; 3] {
    [(); 3].map(|()| {
        let (kind, near) = (draw.below(16), draw.coordinate());
        match kind {
            0..=10 => near,
            11 => near.next_up(),
            12 => near.next_down(),
            13 => near * 1e-40,
            14 => near * 8e37,
            _ => draw.bits(),
        }
    })
}
