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

use glam::DVec3;

use crate::geom::Light;
use crate::geom::predicate::side_of_point;
use crate::oracle::area::{AreaLight, Receiver, SoftOracle};
use crate::oracle::{Oracle, PrimaryHit, Verdict};
use crate::shadow::{Claim, Request, Visibility};

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
    fn fraction(&self, index: usize, verdict: Verdict) -> Fraction {
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

/// Radii of the rings around a sample that are searched for a shadow boundary, in texels.
const RINGS: [f64; 2] = [1.0, 2.0];
/// Directions searched per ring.
const DIRECTIONS: u32 = 16;

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
        assert_eq!(truth.verdicts.len(), samples.len(), "the truth is of other samples");
        assert!(truth.fractions.as_ref().is_none_or(|all| all.len() == samples.len()), "of other samples");
        assert!(made.footprint.is_empty() || made.footprint.len() == samples.len(), "one entry per sample");
        let is_soft = made.is_soft && truth.fractions.is_some();
        let mut errors = Self {
            samples: samples.len() as u64,
            has_fractions: truth.fractions.is_some(),
            is_soft,
            ..Self::default()
        };
        let mut magnitudes = Magnitudes::default();
        for (index, (hit, verdict)) in samples.hits().iter().zip(&truth.verdicts).enumerate() {
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

/// The magnitudes of errors, as they are collected.
#[derive(Default)]
struct Magnitudes {
    /// |value − truth| of every judged sample.
    differences: Vec<f32>,
    sum: f64,
    sum_signed: f64,
    /// Sum and number in penumbrae.
    penumbra: (f64, u64),
    off: u64,
}

impl Magnitudes {
    fn add(&mut self, value: f32, truth: Fraction) {
        let difference = f64::from(value) - truth.visible;
        let size = difference.abs();
        self.differences.push(size as f32);
        self.sum += size;
        self.sum_signed += difference;
        if truth.visible > 1.0 / 256.0 && truth.visible < 255.0 / 256.0 {
            self.penumbra.0 += size;
            self.penumbra.1 += 1;
        }
        // A value is the truth rounded to the nearest f32 of at most 1.
        self.off += u64::from(size > truth.bound + f64::from(f32::EPSILON) / 4.0);
    }

    fn finish(mut self, errors: &mut Errors) {
        let count = errors.judged.max(1) as f64;
        (errors.mean, errors.mean_signed) = (self.sum / count, self.sum_signed / count);
        (errors.p99, errors.max) = percentile_and_max(&mut self.differences);
        let (sum, count) = self.penumbra;
        errors.penumbra_mean = (count > 0).then(|| sum / count as f64);
    }
}

/// The 99th percentile (the value that 99 of 100 do not exceed), and the maximum.
fn percentile_and_max(differences: &mut [f32]) -> (f64, f64) {
    let Some(last) = differences.len().checked_sub(1) else { return (0.0, 0.0) };
    let at = (differences.len() * 99).div_ceil(100) - 1;
    let (_, p99, above) = differences.select_nth_unstable_by(at, f32::total_cmp);
    let p99 = *p99;
    let max = if at == last { p99 } else { above.iter().fold(p99, |most, &x| most.max(x)) };
    (f64::from(p99), f64::from(max))
}

/// Whether the exact verdict changes within two texels of a sample, on the plane of the sample's face.
fn changes_nearby(oracle: &Oracle, light: &Light, hit: &PrimaryHit, verdict: Verdict, texel: f64) -> bool {
    let [a, b, c] = hit.corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let across = normal.any_orthonormal_vector();
    let along = normal.cross(across);
    let point = DVec3::from(hit.point.map(f64::from));
    RINGS.iter().any(|ring| {
        (0..DIRECTIONS).any(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
            let beside = point + (across * cos + along * sin) * (ring * texel);
            lifted(hit, normal, beside).is_some_and(|beside| oracle.verdict(beside, light) != verdict)
        })
    })
}

/// A point near a sample, moved off the face's plane until the point lies strictly on the visible side. The
/// steps start at one unit in the last place and double, as for [`PrimaryHit::point`]. `None` if `f32` has no
/// such point.
fn lifted(hit: &PrimaryHit, normal: DVec3, beside: DVec3) -> Option<[f32; 3]> {
    let away = normal * f64::from(hit.side.value());
    let largest = beside.abs().max_element().min(f64::from(f32::MAX)) as f32;
    let mut step = f64::from(largest.next_up()) - f64::from(largest);
    for _ in 0..f32::MANTISSA_DIGITS {
        let at: [f32; 3] = (beside + away * step).as_vec3().into();
        if at.iter().all(|x| x.is_finite()) && side_of_point(hit.corners, at) == hit.side {
            return Some(at);
        }
        step *= 2.0;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::{Caster, CasterGroup};
    use crate::mesh::Mesh;
    use crate::scene::Lamp;
    use crate::shadow::{Samples, Technique};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    /// Scene: a plate over a floor, seen from above at an angle.
    fn scene() -> Caster {
        let floor = shapes::scaled(&shapes::sheet(1), 8.0);
        let plate = shapes::translated(&shapes::scaled(&shapes::sheet(1), 2.0), [3.0, 3.0, 2.0]);
        Caster::new(Mesh::concat(&[floor, plate]).unwrap())
    }

    fn with_request<T>(caster: &Caster, light: &Light, work: impl FnOnce(&Request<'_>) -> T) -> T {
        let casters = CasterGroup::new(vec![caster]);
        let size = Size::new(96, 72).unwrap();
        let camera = Camera::look_at([4.0, -6.0, 9.0], [4.0, 4.0, 0.0], 0.9, Up::Z).unwrap();
        let projection = camera.projection(size, 0.125);
        let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
        let lamp = (*light).into();
        work(&Request { casters: &casters, lamp: &lamp, samples: &samples })
    }

    #[test]
    fn errors_of_exact_rays_are_none_and_one_flipped_sample_breaks_the_claim() {
        let light = Light::directional([0.2, 0.1, -1.0]).unwrap();
        with_request(&scene(), &light, |request| {
            let truth = Truth::of(request);
            let rays = Technique::Rays.shade(request).unwrap();
            let errors = Errors::of(request, &rays, &truth, &Made::default());
            assert!(errors.hold(Claim::Exact) && errors.judged > 1000, "{errors:?}");
            let lit = rays.values().iter().position(|&value| value == 1.0).unwrap();
            let dark =
                (0..rays.values().len()).find(|&i| rays.asked()[i] && rays.values()[i] == 0.0).unwrap();
            for (at, value, kind) in [(lit, 0.0, [1, 0]), (dark, 1.0, [0, 1])] {
                let mut values = rays.values().to_vec();
                values[at] = value;
                let spoiled = Visibility::from_values(request.samples, &light, values, Claim::Exact);
                let errors = Errors::of(request, &spoiled, &truth, &Made::default());
                assert!(!errors.hold(Claim::Exact) && !errors.hold(Claim::WithinFootprint));
                assert_eq!([errors.acne, errors.leak], kind);
                assert!(errors.hold(Claim::Bounded(0.01)) && !errors.hold(Claim::Bounded(1e-7)));
                // A sample within the footprint is not judged.
                let mut footprint = vec![false; request.samples.len()];
                footprint[at] = true;
                let made = Made { footprint: &footprint, ..Made::default() };
                assert!(Errors::of(request, &spoiled, &truth, &made).hold(Claim::WithinFootprint));
            }
            // Negative test: a sample that turns from the light must have the value 0.
            let away = Light::directional([0.0, 0.0, 1.0]).unwrap().into();
            let turned = Request { lamp: &away, ..*request };
            let truth = Truth::of(&turned);
            assert!(!Errors::of(&turned, &rays, &truth, &Made::default()).hold(Claim::Approximate));
        });
    }

    /// A lamp above the plate, so large that the whole floor lies in its penumbra; the fractions are made up.
    #[test]
    fn errors_of_soft_shadows_are_magnitudes_and_those_of_hard_ones_are_both() {
        let caster = scene();
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(96, 72).unwrap();
        let camera = Camera::look_at([4.0, -6.0, 9.0], [4.0, 4.0, 0.0], 0.9, Up::Z).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
        let lamp: Lamp = "rect:3,3,9:2,0,0:0,2,0".parse().unwrap();
        let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
        let fraction = |i: usize| [0.0, 0.25, 1.0, 0.75][i % 4];
        let bound = 1e-12;
        let fractions = (0..samples.len()).map(|i| Fraction { visible: fraction(i), bound }).collect();
        let truth = Truth::of(&request).with_fractions(fractions);
        let soft = Made { is_soft: true, ..Made::default() };
        let visibility = |off: f32| {
            let values = (0..samples.len()).map(|i| (fraction(i) as f32 + off).clamp(0.0, 1.0)).collect();
            Visibility::from_values(&samples, lamp.light(), values, Claim::Exact)
        };
        let errors = Errors::of(&request, &visibility(0.0), &truth, &soft);
        assert!(errors.hold(Claim::Exact) && errors.mean == 0.0 && errors.judged > 1000, "{errors:?}");
        assert_eq!((errors.penumbra_mean, errors.wrong), (Some(0.0), 0));

        // Fault injected: 1/8 too much light, cut at 1: none of it where all of the lamp is seen.
        let errors = Errors::of(&request, &visibility(0.125), &truth, &soft);
        assert!(!errors.hold(Claim::Exact) && errors.wrong == 0, "{errors:?}");
        assert!(errors.hold(Claim::Bounded(0.1)) && !errors.hold(Claim::Bounded(0.09)), "{errors:?}");
        assert!((errors.mean - 0.09375).abs() < 1e-3 && errors.mean == errors.mean_signed, "{errors:?}");
        assert_eq!((errors.penumbra_mean, errors.max), (Some(0.125), 0.125));
        // A value off by a single unit in the last place, where the truth is ¾.
        let errors = Errors::of(&request, &visibility(0.75_f32.next_up() - 0.75), &truth, &soft);
        assert!(!errors.hold(Claim::Exact) && errors.off > 200, "{errors:?}");

        // Hard shadows: right by the center, and off by what softness they lack.
        let rays = Technique::Rays.shade(&request).unwrap();
        let errors = Errors::of(&request, &rays, &truth, &Made::default());
        assert!(errors.hold(Claim::Exact) && errors.wrong == 0 && errors.mean > 0.2, "{errors:?}");
    }

    #[test]
    fn errors_at_the_boundary_are_aliasing_and_those_away_from_it_are_not() {
        let (light, moved) = ([0.2, 0.1, -1.0], [0.35, 0.1, -1.0]);
        let [light, moved] = [light, moved].map(|travel| Light::directional(travel).unwrap());
        with_request(&scene(), &light, |request| {
            let truth = Truth::of(request);
            // The shadow of a slightly displaced light is wrong in stripes 0.3 wide along the shadow's
            // boundary.
            let off = Technique::Rays.shade(&Request { lamp: &moved.into(), ..*request }).unwrap();
            let errors =
                |texel| Errors::of(request, &off, &truth, &Made { texel: Some(texel), ..Made::default() });
            let found = errors(0.3);
            assert!(found.alias_dark > 5 && found.alias_lit > 5, "{found:?}");
            assert_eq!([found.acne, found.leak], [0, 0], "{found:?}");
            assert_eq!(found.wrong, found.alias_dark + found.alias_lit);
            // Texels far smaller than the stripes explain few of the errors.
            let fine = errors(0.003);
            assert!(fine.acne + fine.leak > found.wrong / 2, "{fine:?}");
            // With values 0 and 1 the mean error is the fraction of wrong samples. The signed mean is
            // positive if shadow is missing, negative if light is missing.
            assert!((found.mean - found.wrong as f64 / found.judged as f64).abs() < f64::EPSILON);
            let lit = Errors::of(request, &Technique::None.shade(request).unwrap(), &truth, &Made::default());
            let dark =
                Errors::of(request, &Technique::Dark.shade(request).unwrap(), &truth, &Made::default());
            assert!(lit.mean_signed > 0.0 && dark.mean_signed < 0.0);
            assert_eq!(lit.wrong + dark.wrong, lit.judged);
        });
    }

    #[test]
    fn percentile_of_a_hundred_leaves_one_out() {
        let mut values: Vec<f32> = (0..100).map(|i| i as f32).rev().collect();
        assert_eq!(percentile_and_max(&mut values), (98.0, 99.0));
        assert_eq!(percentile_and_max(&mut [3.0]), (3.0, 3.0));
        assert_eq!(percentile_and_max(&mut []), (0.0, 0.0));
    }
}
