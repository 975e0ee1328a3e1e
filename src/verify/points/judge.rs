//! The ray cast at one point, and the winding numbers that agree with it.

use std::ops::RangeInclusive;

use crate::geom::{Facing, Light};
use crate::mesh::Mesh;
use crate::oracle::{Crossings, Intersection, Oracle, Verdict};
use crate::verify::reference;

/// Crossings of the segment between a point and the light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Cast {
    /// Crossings with all faces.
    pub(crate) crossings: Crossings,
    /// Of the faces that cast in the halved volume: how many are crossed, how many touched.
    chosen: [u32; 2],
}

impl Cast {
    /// Casts the segment from `p` to `light`. `chosen` holds a sign per face: faces whose sign is not 0 cast
    /// in the halved volume.
    #[inline]
    pub(crate) fn of(oracle: &Oracle, p: [f32; 3], light: &Light, chosen: &[i8]) -> Self {
        let mut cast = Self::default();
        oracle.for_each_meeting(p, light, |face, meeting| {
            let is_chosen = u32::from(chosen[face.index()] != 0);
            match meeting {
                Intersection::Crossing(side) => {
                    cast.crossings.front += u32::from(side == Facing::Front);
                    cast.crossings.back += u32::from(side == Facing::Back);
                    cast.chosen[0] += is_chosen;
                }
                _ => {
                    cast.crossings.touching += 1;
                    cast.chosen[1] += is_chosen;
                }
            }
        });
        cast
    }

    /// Fault injected for a test: every crossed face is reported as only touched.
    #[cfg(test)]
    pub(crate) fn touch_all(&mut self) {
        let Crossings { front, back, touching } = self.crossings;
        self.crossings = Crossings { front: 0, back: 0, touching: front + back + touching };
        self.chosen = [0, self.chosen[0] + self.chosen[1]];
    }

    pub(crate) fn verdict(&self) -> Verdict {
        self.crossings.verdict()
    }

    /// The winding numbers that the volume of all faces may have.
    ///
    /// A winding number that does not abstain lies on no triangle of the volume, so the number is the same
    /// for all points nearby. Every face that is crossed from `p` is crossed from those points too, and any
    /// face that is touched from `p` may be crossed from them.
    pub(crate) fn all(&self) -> RangeInclusive<i32> {
        let Crossings { front, back, touching } = self.crossings;
        let crossed = (front + back) as i32; // at most the number of faces
        crossed..=crossed + touching as i32
    }

    /// The winding numbers that the halved volume may have.
    pub(crate) fn chosen(&self) -> RangeInclusive<i32> {
        let [crossed, touching] = self.chosen.map(|count| count as i32);
        crossed..=crossed + touching
    }

    /// Whether a winding number agrees with the ray cast: as a count, and as an inside/outside answer.
    #[inline]
    pub(crate) fn allows(&self, winding: i32, expected: &RangeInclusive<i32>) -> bool {
        let in_or_out = match self.verdict() {
            Verdict::Shadowed => winding > 0,
            Verdict::Lit => winding == 0,
            Verdict::Grazing => true,
        };
        in_or_out && expected.contains(&winding)
    }

    /// Checks the crossings against the big-integer reference. `Err` describes what the reference found
    /// instead.
    pub(crate) fn in_whole_numbers(&self, mesh: &Mesh, p: [f32; 3], light: &Light) -> Result<(), String> {
        let truth = reference(mesh, p, light).crossings;
        if truth == self.crossings {
            return Ok(());
        }
        let Crossings { front, back, touching } = self.crossings;
        Err(format!("{truth:?}, not {front}, {back}, {touching}"))
    }
}
