//! Errors of a visibility against exact truth, by kind.
//!
//! Hard shadows: a *judged* sample is front-lit, its exact verdict is not grazing, and it lies outside the
//! footprint of the technique that drew it. A judged sample is wrong if its value and the truth lie on
//! different sides of one half. The kind of a wrong sample depends on its surroundings. Outside a shadow map
//! nothing could be known. If the exact verdict changes within two texels of a map, measured on the plane of
//! the sample's face, the error is aliasing, dark or lit. Otherwise a false shadow is acne, and false light
//! is a leak. Techniques without texels have no aliasing.
//!
//! Soft shadows, of a lamp with an extent: the truth is the fraction of the lamp that a sample sees. Every
//! front-lit sample outside the footprint is judged, and the magnitude of its error counts. A technique for
//! hard shadows is judged in both ways: by the lamp's center, and by what its hard shadow lacks in softness.

mod boundary;
mod magnitude;
mod truth;
#[cfg(test)]
mod tests;

pub use truth::{Fraction, Truth};

use self::boundary::changes_nearby;
use self::magnitude::Magnitudes;
use crate::oracle::Verdict;
use crate::shadow::{Claim, Request, Visibility};

/// What [`Errors::of`] has to know about the technique that made a visibility.
#[derive(Clone, Copy, Debug, Default)]
pub struct Made<'a> {
    /// Which samples lie within the rasterizer's footprint and are therefore not judged: one entry per
    /// sample. Empty for none.
    pub footprint: &'a [bool],
    /// The side of a shadow map's texel, projected onto the scene, in mesh units. `None` for a technique
    /// without texels.
    pub texel: Option<f64>,
    /// Whether the technique takes the lamp's extent into account.
    pub is_soft: bool,
}

/// Error counts and magnitudes of a visibility, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Errors {
    /// Number of samples.
    pub samples: u64,
    /// Number of judged samples: the denominator of every rate.
    pub judged: u64,
    /// Front-lit samples that are not judged: their exact verdict is grazing, their fraction is not known, or
    /// they lie within the footprint.
    pub excused: u64,
    /// Judged samples whose value lies on the wrong side of one half. Always 0 for a soft technique under a
    /// lamp with an extent, as are the counts by kind.
    pub wrong: u64,
    /// False shadows away from any shadow boundary.
    pub acne: u64,
    /// False light away from any shadow boundary.
    pub leak: u64,
    /// False shadows within two texels of a shadow boundary.
    pub alias_dark: u64,
    /// False light within two texels of a shadow boundary.
    pub alias_lit: u64,
    /// Wrong samples outside the shadow map.
    pub outside: u64,
    /// Samples whose face turns from the light although their value is not 0.
    pub turned_away: u64,
    /// Judged samples that differ from the truth by more than its bound and the rounding of an `f32`.
    pub off: u64,
    /// Mean of |value − truth| over the judged samples.
    pub mean: f64,
    /// Mean of value − truth over the judged samples: above 0 if too much is lit.
    pub mean_signed: f64,
    /// The 99th percentile of |value − truth| over the judged samples.
    pub p99: f64,
    /// The largest |value − truth| over the judged samples.
    pub max: f64,
    /// Mean of |value − truth| over the judged samples that see a part of the lamp, more than 1/256 and less
    /// than 255/256; `None` if there are none.
    pub penumbra_mean: Option<f64>,
    /// Whether the lamp has an extent, so that the magnitudes are about the fraction of it that is seen.
    pub has_fractions: bool,
    /// Whether the magnitudes, and not the verdicts, are what a claim is about: a soft technique, and a lamp
    /// with an extent. The verdicts are not counted then.
    pub is_soft: bool,
}

impl Errors {
    /// Compares every sample with the truth. A wrong sample costs up to 32 more shadow rays, which decide its
    /// kind.
    ///
    /// # Panics
    ///
    /// Panics if `visibility`, `truth` or the footprint has another number of samples than `request`.
    ///
    /// ```
    /// use umbrage::caster::{Caster, CasterGroup};
    /// use umbrage::scene::Lamp;
    /// use umbrage::shadow::{Claim, Request, Samples, Technique};
    /// use umbrage::testing::shapes;
    /// use umbrage::verify::errors::{Errors, Made, Truth};
    /// use umbrage::view::{Camera, Size, Up};
    ///
    /// let caster = Caster::new(shapes::cube());
    /// let casters = CasterGroup::new(vec![&caster]);
    /// let size = Size::new(32, 24).unwrap();
    /// let projection = Camera::look_at([4.0, -6.0, 5.0], [0.0; 3], 0.9, Up::Z)?.projection(size, 0.1);
    /// let samples = Samples::of_view(&casters, &projection, size, 1)?;
    /// let lamp: Lamp = "point:2,-5,8".parse()?;
    /// let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
    ///
    /// let truth = Truth::of(&request);
    /// let rays = Technique::Rays.shade(&request)?;
    /// let errors = Errors::of(&request, &rays, &truth, &Made::default());
    /// assert_eq!(errors.wrong, 0);
    /// assert!(errors.hold(Claim::Exact));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(request: &Request<'_>, visibility: &Visibility, truth: &Truth, made: &Made<'_>) -> Self {
        let samples = request.samples;
        assert_eq!(visibility.values().len(), samples.len(), "the visibility is of other samples");
        assert_eq!(truth.verdicts().len(), samples.len(), "the truth is of other samples");
        assert!(truth.fractions().is_none_or(|all| all.len() == samples.len()), "of other samples");
        assert!(made.footprint.is_empty() || made.footprint.len() == samples.len(), "one entry per sample");
        let is_soft = made.is_soft && truth.fractions().is_some();
        let mut errors = Self {
            samples: samples.len() as u64,
            has_fractions: truth.fractions().is_some(),
            is_soft,
            ..Self::default()
        };
        let mut magnitudes = Magnitudes::default();
        for (index, (hit, verdict)) in samples.hits().iter().zip(truth.verdicts()).enumerate() {
            let value = visibility.values()[index];
            let (Some(hit), Some(verdict)) = (hit, *verdict) else {
                errors.turned_away += u64::from(value != 0.0);
                continue;
            };
            let is_grazing = verdict == Verdict::Grazing && !is_soft;
            let truth = truth.fraction(index, verdict);
            if is_grazing || truth.bound >= 0.5 || made.footprint.get(index) == Some(&true) {
                errors.excused += 1;
                continue;
            }
            errors.judged += 1;
            magnitudes.add(value, truth);
            if is_soft {
                continue;
            }
            let lit = verdict == Verdict::Lit;
            errors.off += u64::from(value != if lit { 1.0 } else { 0.0 });
            if (value >= 0.5) != lit {
                errors.wrong += 1;
                let at_boundary = made.texel.is_some_and(|texel| {
                    changes_nearby(request.casters.oracle(), request.light(), hit, verdict, texel)
                });
                let is_outside = visibility.outside().binary_search(&index).is_ok();
                *match (lit, at_boundary) {
                    _ if is_outside => &mut errors.outside,
                    (true, true) => &mut errors.alias_dark,
                    (true, false) => &mut errors.acne,
                    (false, true) => &mut errors.alias_lit,
                    (false, false) => &mut errors.leak,
                } += 1;
            }
        }
        if is_soft {
            errors.off = magnitudes.off;
        }
        magnitudes.finish(&mut errors);
        errors
    }

    /// Whether the compared visibility meets a claim. For [`Claim::WithinFootprint`] the comparison must have
    /// excluded the footprint ([`Made::footprint`]).
    #[must_use]
    pub fn hold(&self, claim: Claim) -> bool {
        let exact = self.turned_away == 0;
        match claim {
            Claim::Exact | Claim::WithinFootprint => exact && self.off == 0,
            Claim::Bounded(error) if self.is_soft => exact && self.mean <= f64::from(error),
            Claim::Bounded(fraction) => {
                exact && self.wrong as f64 <= f64::from(fraction) * self.judged as f64
            }
            Claim::Approximate => exact,
        }
    }
}
