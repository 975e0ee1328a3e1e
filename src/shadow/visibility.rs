//! Visibility: how much of a light reaches each sample.

use super::{Claim, Samples};
use crate::geom::Light;
use crate::geom::predicate::side_of_light;
use crate::oracle::PrimaryHit;

/// Fraction of one light that reaches each sample of a view: 0 in shadow, 1 lit.
///
/// The value is exactly 0 where nothing is seen, and where the face turns away from the light. The technique
/// is not asked about such a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    values: Vec<f32>,
    asked: Vec<bool>,
    claim: Claim,
    asked_exactly: u64,
    reads: u64,
    updates: Option<Updates>,
    /// In ascending order.
    outside: Vec<usize>,
}

/// Work of a rasterizer that counts on the CPU: the same numbers on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Updates {
    /// Samples of volume triangles that were drawn.
    pub fragments: u64,
    /// Those that changed a count.
    pub updates: u64,
}

/// A technique's answer for one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Answer {
    /// The fraction of the light that reaches the sample.
    pub(crate) value: f32,
    /// Whether the exact ray cast had to decide.
    pub(crate) is_exact: bool,
    /// Number of texels read.
    pub(crate) reads: u32,
    /// Whether the sample lies outside the shadow map.
    pub(crate) is_outside: bool,
}

impl Answer {
    /// A value that no map and no exact ray cast was needed for.
    pub(crate) fn of(value: f32) -> Self {
        Self { value, ..Self::default() }
    }
}

impl Visibility {
    /// One value per sample, from 0 to 1; 0 where nothing is seen.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Whether the technique was asked, per sample: a surface is seen there, and this surface faces the
    /// light.
    #[must_use]
    pub fn asked(&self) -> &[bool] {
        &self.asked
    }

    /// The technique's claim about these values.
    #[must_use]
    pub fn claim(&self) -> Claim {
        self.claim
    }

    /// Number of samples that the technique could not decide and passed to the exact ray cast.
    #[must_use]
    pub fn asked_exactly(&self) -> u64 {
        self.asked_exactly
    }

    /// Number of texels of shadow maps that were read for all samples.
    #[must_use]
    pub fn reads(&self) -> u64 {
        self.reads
    }

    /// Work of the rasterizer; `None` for a technique that draws no volume on the CPU.
    #[must_use]
    pub fn updates(&self) -> Option<Updates> {
        self.updates
    }

    /// The same with the work of a rasterizer.
    pub(crate) fn with_updates(self, updates: Updates) -> Self {
        Self { updates: Some(updates), ..self }
    }

    /// The samples that lie outside the shadow map, where light is assumed, in ascending order.
    #[must_use]
    pub fn outside(&self) -> &[usize] {
        &self.outside
    }

    /// Memory of this visibility, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.values.len() * size_of::<f32>() + self.asked.len()
    }

    /// A visibility from given values, such as values read back from a device, or values with a fault
    /// injected by a test.
    ///
    /// The value of a sample that is not front-lit is replaced by 0.
    ///
    /// # Panics
    ///
    /// Panics if there is not one value per sample, or if a value is not in 0..=1.
    #[must_use]
    pub fn from_values(samples: &Samples, light: &Light, mut values: Vec<f32>, claim: Claim) -> Self {
        assert_eq!(values.len(), samples.len(), "one value per sample");
        assert!(values.iter().all(|value| (0.0..=1.0).contains(value)), "values are from 0 to 1");
        let asked = asked(samples, light);
        for (value, &asked) in values.iter_mut().zip(&asked) {
            *value *= f32::from(u8::from(asked));
        }
        Self { values, asked, claim, asked_exactly: 0, reads: 0, updates: None, outside: Vec::new() }
    }

    /// Sets to 0 the front-lit samples for which `dark` yields true. `dark` yields one item per front-lit
    /// sample, in sample order.
    pub(crate) fn darken(&mut self, dark: impl IntoIterator<Item = bool>) {
        let asked = self.values.iter_mut().zip(&self.asked).filter(|(_, asked)| **asked);
        for ((value, _), dark) in asked.zip(dark) {
            if dark {
                *value = 0.0;
            }
        }
    }

    /// Lowers the values of front-lit samples to `most`.
    pub(crate) fn cut(&mut self, samples: &Samples, most: impl Fn(&PrimaryHit) -> f32 + Sync) {
        let row_len = samples.row_len();
        let asked = &self.asked;
        crate::parallel::rows(&mut self.values, row_len, |row, values| {
            for (x, (value, hit)) in values.iter_mut().zip(samples.row(row)).enumerate() {
                if let Some(hit) = hit.as_ref().filter(|_| asked[row * row_len + x]) {
                    *value = value.min(most(hit));
                }
            }
        });
    }

    /// Calls `answer` for every front-lit sample. With the feature `parallel`, rows are shared among threads.
    pub(crate) fn of(
        samples: &Samples,
        light: &Light,
        claim: Claim,
        answer: impl Fn(&PrimaryHit) -> Answer + Sync,
    ) -> Self {
        Self::of_indexed(samples, light, claim, |_, hit| answer(hit))
    }

    /// The same with the index of each sample.
    pub(crate) fn of_indexed(
        samples: &Samples,
        light: &Light,
        claim: Claim,
        answer: impl Fn(usize, &PrimaryHit) -> Answer + Sync,
    ) -> Self {
        let mut found: Vec<Option<Answer>> = vec![None; samples.len()];
        crate::parallel::rows(&mut found, samples.row_len(), |row, found| {
            for (x, (found, hit)) in found.iter_mut().zip(samples.row(row)).enumerate() {
                let hit = hit.as_ref().filter(|hit| is_front_lit(hit, light));
                *found = hit.map(|hit| answer(row * samples.row_len() + x, hit));
            }
        });
        Self {
            values: found.iter().map(|found| found.map_or(0.0, |answer| answer.value)).collect(),
            asked: found.iter().map(Option::is_some).collect(),
            claim,
            asked_exactly: found.iter().flatten().filter(|answer| answer.is_exact).count() as u64,
            reads: found.iter().flatten().map(|answer| u64::from(answer.reads)).sum(),
            updates: None,
            outside: (found.iter().enumerate())
                .filter(|(_, answer)| answer.is_some_and(|answer| answer.is_outside))
                .map(|(index, _)| index)
                .collect(),
        }
    }
}

/// Whether the light lies on the visible side of the face.
pub(crate) fn is_front_lit(hit: &PrimaryHit, light: &Light) -> bool {
    side_of_light(hit.corners, light) == hit.side
}

/// Whether each sample is front-lit: a surface is seen there, and this surface faces the light.
pub(crate) fn asked(samples: &Samples, light: &Light) -> Vec<bool> {
    samples.hits().iter().map(|hit| hit.as_ref().is_some_and(|hit| is_front_lit(hit, light))).collect()
}
