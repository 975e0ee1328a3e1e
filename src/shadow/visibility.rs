//! How much of a light reaches each sample.

use super::{Claim, Samples};
use crate::geom::Light;
use crate::geom::predicate::side_of_light;
use crate::oracle::PrimaryHit;

/// How much of one light reaches each sample of a view: 0 in shadow, 1 lit.
///
/// A sample whose face turns away from the light is 0, exactly, and the technique was not asked about it; neither was it
/// where nothing is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    values: Vec<f32>,
    asked: Vec<bool>,
    claim: Claim,
    asked_exactly: u64,
}

impl Visibility {
    /// One value per sample, 0 to 1: 0 where nothing is seen.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Whether the technique was asked: something is seen there, and it faces the light.
    #[must_use]
    pub fn asked(&self) -> &[bool] {
        &self.asked
    }

    /// What the technique promises of these values.
    #[must_use]
    pub fn claim(&self) -> Claim {
        self.claim
    }

    /// At how many samples the technique had no answer of its own and asked the exact ray cast.
    #[must_use]
    pub fn asked_exactly(&self) -> u64 {
        self.asked_exactly
    }

    /// The bytes that it holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.values.len() * size_of::<f32>() + self.asked.len()
    }

    /// Values from elsewhere, such as those read back from a device or spoiled by a test.
    ///
    /// A value where the technique is not asked is replaced by 0.
    ///
    /// # Panics
    ///
    /// Panics if there is not one value per sample, or a value is not in 0..=1.
    #[must_use]
    pub fn from_values(samples: &Samples, light: &Light, mut values: Vec<f32>, claim: Claim) -> Self {
        assert_eq!(values.len(), samples.len(), "one value per sample");
        assert!(values.iter().all(|value| (0.0..=1.0).contains(value)), "values are from 0 to 1");
        let asked = asked(samples, light);
        for (value, &asked) in values.iter_mut().zip(&asked) {
            *value *= f32::from(u8::from(asked));
        }
        Self { values, asked, claim, asked_exactly: 0 }
    }

    /// Sets to 0 those of the asked samples that `dark` says, in their order.
    pub(crate) fn darken(&mut self, dark: impl IntoIterator<Item = bool>) {
        let asked = self.values.iter_mut().zip(&self.asked).filter(|(_, asked)| **asked);
        for ((value, _), dark) in asked.zip(dark) {
            if dark {
                *value = 0.0;
            }
        }
    }

    /// Asks `answer` about every sample that is front-lit: how much of the light reaches it, and whether that had to be
    /// decided by the exact ray cast. On several threads with the feature `parallel`.
    pub(crate) fn of(
        samples: &Samples,
        light: &Light,
        claim: Claim,
        answer: impl Fn(&PrimaryHit) -> (f32, bool) + Sync,
    ) -> Self {
        let mut found = vec![None; samples.len()];
        crate::parallel::rows(&mut found, samples.row_len(), |row, found| {
            for (found, hit) in found.iter_mut().zip(samples.row(row)) {
                *found = hit.as_ref().filter(|hit| is_front_lit(hit, light)).map(&answer);
            }
        });
        Self {
            values: found.iter().map(|found| found.map_or(0.0, |(value, _)| value)).collect(),
            asked: found.iter().map(Option::is_some).collect(),
            claim,
            asked_exactly: found.iter().flatten().filter(|(_, exactly)| *exactly).count() as u64,
        }
    }
}

/// Whether the side of the face that is seen is the side that the light is on.
pub(crate) fn is_front_lit(hit: &PrimaryHit, light: &Light) -> bool {
    side_of_light(hit.corners, light) == hit.side
}

/// Per sample: whether something is seen there that faces the light.
pub(crate) fn asked(samples: &Samples, light: &Light) -> Vec<bool> {
    samples.hits().iter().map(|hit| hit.as_ref().is_some_and(|hit| is_front_lit(hit, light))).collect()
}
