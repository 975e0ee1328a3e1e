//! What is right to say of a point: the ray cast, and the counts that agree with it.

use std::ops::RangeInclusive;

use crate::geom::Facing;
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::oracle::{Crossings, Intersection, Oracle, Verdict};
use crate::verify::reference;

/// What the ray cast found between a point and the light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Cast {
    /// All faces.
    pub(crate) crossings: Crossings,
    /// Of the faces that cast in the halved volume: crossed, touched.
    chosen: [u32; 2],
}

impl Cast {
    /// `chosen` holds a sign for each face: those that are not 0 cast in the halved volume.
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

    /// As if every face that is crossed were only touched: a fault that a test must see.
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
    /// A judge that does not abstain stands on no triangle of the volume, so that its count is that of the points
    /// around: every face that is crossed here is crossed there, and any that is touched may be.
    pub(crate) fn all(&self) -> RangeInclusive<i32> {
        let Crossings { front, back, touching } = self.crossings;
        let crossed = (front + back) as i32; // at most the faces
        crossed..=crossed + touching as i32
    }

    /// The winding numbers that the halved volume may have.
    pub(crate) fn chosen(&self) -> RangeInclusive<i32> {
        let [crossed, touching] = self.chosen.map(|count| count as i32);
        crossed..=crossed + touching
    }

    /// Whether a winding number agrees: as a count, and as an answer to "in or out?".
    #[inline]
    pub(crate) fn allows(&self, winding: i32, expected: &RangeInclusive<i32>) -> bool {
        let in_or_out = match self.verdict() {
            Verdict::Shadowed => winding > 0,
            Verdict::Lit => winding == 0,
            Verdict::Grazing => true,
        };
        in_or_out && expected.contains(&winding)
    }

    /// Asks the whole-number judge: what it found instead, if it differs.
    pub(crate) fn in_whole_numbers(&self, mesh: &Mesh, p: [f32; 3], light: &Light) -> Result<(), String> {
        let truth = reference(mesh, p, light).crossings;
        if truth == self.crossings {
            return Ok(());
        }
        let Crossings { front, back, touching } = self.crossings;
        Err(format!("{truth:?}, not {front}, {back}, {touching}"))
    }
}
