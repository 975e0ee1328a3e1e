//! What is true at each sample: exact verdicts, and the analytic fraction of a lamp with an extent.

use crate::oracle::area::{AreaLight, Receiver, SoftOracle};
use crate::oracle::{PrimaryHit, Verdict};
use crate::shadow::Request;

/// The truth at every sample of a request.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Per sample: `None` where nothing is seen, or where the face turns from the light.
    verdicts: Vec<Option<Verdict>>,
    /// For a lamp with an extent, per sample.
    fractions: Option<Vec<Fraction>>,
}

/// The fraction of a lamp that a sample sees, and the largest error of this fraction.
///
/// A bound of ½ or more says that nothing is known: the sample lies in the plane of the lamp, for example.
/// Such a sample is not judged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fraction {
    /// From 0, nothing of the lamp, to 1.
    pub visible: f64,
    /// Bound of the error of `visible`.
    pub bound: f64,
}

impl Truth {
    /// Exact verdicts for the samples of `request`: one exact shadow ray per front-lit sample, to the lamp's
    /// center. For a lamp with an extent also the visible fraction of the lamp, computed analytically.
    ///
    /// A lamp whose area is too small for `f64` is taken as its center.
    #[must_use]
    pub fn of(request: &Request<'_>) -> Self {
        let front_lit = |hit: &&PrimaryHit| crate::shadow::is_front_lit(hit, request.light());
        let hits: Vec<Option<&PrimaryHit>> =
            request.samples.hits().iter().map(|hit| hit.as_ref().filter(front_lit)).collect();
        let points: Vec<[f32; 3]> = hits.iter().flatten().map(|hit| hit.point).collect();
        let mut verdicts = vec![Verdict::Lit; points.len()];
        request.casters.oracle().verdicts_into(&points, request.light(), &mut verdicts);
        let mut next = verdicts.into_iter();
        let verdicts = hits.iter().map(|hit| hit.and_then(|_| next.next())).collect();
        let light = AreaLight::of_lamp(request.lamp).ok().flatten();
        Self { verdicts, fractions: light.map(|light| fractions(request, &hits, &points, &light)) }
    }

    /// The same truth with the fractions of a lamp with an extent.
    ///
    /// # Panics
    ///
    /// Panics if there is not one fraction per sample.
    #[must_use]
    pub fn with_fractions(self, fractions: Vec<Fraction>) -> Self {
        assert_eq!(fractions.len(), self.verdicts.len(), "one fraction per sample");
        Self { fractions: Some(fractions), ..self }
    }

    /// Per sample: `None` where nothing is seen, or where the face turns from the light.
    #[must_use]
    pub fn verdicts(&self) -> &[Option<Verdict>] {
        &self.verdicts
    }

    /// For a lamp with an extent, one entry per sample.
    #[must_use]
    pub fn fractions(&self) -> Option<&[Fraction]> {
        self.fractions.as_deref()
    }

    /// The largest bound among the fractions that are known; `None` for a lamp without extent.
    #[must_use]
    pub fn bound(&self) -> Option<f64> {
        let known = |fraction: &&Fraction| fraction.bound < 0.5;
        let bounds = |all: &[Fraction]| all.iter().filter(known).map(|it| it.bound).fold(0.0, f64::max);
        self.fractions.as_deref().map(bounds)
    }

    /// The fraction of the lamp that sample `index` sees: of a lamp without extent 0 or 1, exactly.
    pub(super) fn fraction(&self, index: usize, verdict: Verdict) -> Fraction {
        match &self.fractions {
            Some(fractions) => fractions[index],
            None => Fraction { visible: if verdict == Verdict::Shadowed { 0.0 } else { 1.0 }, bound: 0.0 },
        }
    }
}

/// The visible fraction at each sample that is `Some`, of which `points` are the positions.
fn fractions(
    request: &Request<'_>,
    hits: &[Option<&PrimaryHit>],
    points: &[[f32; 3]],
    light: &AreaLight,
) -> Vec<Fraction> {
    let receivers: Vec<Receiver> = points.iter().map(|&point| point.into()).collect();
    let mut visible = vec![None; receivers.len()];
    SoftOracle::new(request.casters.oracle()).visible_into(&receivers, light, &mut visible);
    let mut next = visible.into_iter();
    let fraction = |hit: &Option<&PrimaryHit>| match hit.and_then(|_| next.next()) {
        // Not asked for.
        None => Fraction::default(),
        Some(None) => Fraction { visible: 0.5, bound: 0.5 },
        Some(Some(seen)) => Fraction { visible: seen.fraction, bound: seen.bound },
    };
    hits.iter().map(fraction).collect()
}
