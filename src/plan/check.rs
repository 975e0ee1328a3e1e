//! The check of a run: samples drawn at random are compared with the truth.
//!
//! A plan's error may be a prediction. So after the run some samples are drawn, independently, and compared
//! with the exact ray cast, or with the analytic fraction of a lamp with an extent. If the error is surely
//! within what the plan allows, the visibility is accepted. If it is surely not, the lamp falls back to the
//! exact technique. Otherwise twice as many samples are drawn, and in the end all are compared. A wrong
//! prediction costs time then, and not truth.
//!
//! **Surely**: by the bounds of Clopper and Pearson. All looks at all lamps together err with a probability
//! of at most 1 %, since each has its part of it.

use std::time::Instant;

use super::relevance::may_light;
use super::{Budget, Run, Task, binomial};
use crate::caster::CasterGroup;
use crate::oracle::area::{AreaLight, Receiver, SoftOracle, Visible};
use crate::oracle::{PrimaryHit, Verdict};
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::shadow::{PrepareError, Request, Samples, Technique, Visibility};

/// Draws of the first look.
pub const FIRST_LOOK: u64 = 3000;

/// The probability that any of the looks errs.
const ALPHA: f64 = 0.01;

/// How a run is checked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Check {
    /// Number of draws of the first look at each lamp; at least 1.
    pub first: u64,
    /// Seed of the draws: the same one draws the same samples.
    pub seed: u64,
    /// Whether the lamps' light ends at their range, so that nothing beyond is judged.
    pub physical_falloff: bool,
}

impl Default for Check {
    fn default() -> Self {
        Self { first: FIRST_LOOK, seed: 1, physical_falloff: false }
    }
}

/// What became of a lamp that was checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Judgment {
    /// The error is within what the plan allows; for a plan without errors: no draw was wrong.
    Accepted,
    /// It is not. The visibility is now that of this technique, which is exact.
    FellBack(Technique),
    /// It is not, although the technique is the exact one: a defect.
    Failed,
    /// Nothing of the lamp counts: no sample was drawn.
    Void,
}

/// What a check found for one lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Checked {
    /// Number of draws; the number of samples that the lamp may light if `is_all`.
    pub drawn: u64,
    /// Number of those that were wrong.
    pub wrong: u64,
    /// Whether all samples were compared.
    pub is_all: bool,
    /// The fraction of all samples that may be wrong before a fall-back: an upper bound of 99 % confidence,
    /// exact if `is_all`.
    pub bound: f64,
    /// The fraction of all samples that was allowed to be wrong.
    pub allowed: f64,
    /// What follows.
    pub judgment: Judgment,
}

/// The exact technique for a lamp.
#[must_use]
pub fn exact_technique(lamp: &Lamp) -> Technique {
    if area_of(lamp).is_some() { Technique::Area } else { Technique::Rays }
}

fn area_of(lamp: &Lamp) -> Option<AreaLight> {
    AreaLight::of_lamp(lamp).ok().flatten()
}

/// Checks the runs of all lamps. A lamp that is found wrong is run again, by its exact technique, from all
/// casters.
///
/// A plan is held to what it promises: the bounds of its lamps, or, where these leave something of the
/// budget's error over, the whole of this error in the same proportions.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::plan::{Budget, Check, Judgment, Task, check, run};
/// use umbrage::shadow::{Samples, Technique};
/// use umbrage::testing::shapes;
/// use umbrage::view::{Camera, Size, Up};
///
/// let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
/// let casters = CasterGroup::new(vec![&caster]);
/// let size = Size::new(64, 48)?;
/// let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
/// let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1)?;
/// let (lamps, work) = (["point:3,9,5".parse()?], [Task::new(Technique::None)]);
/// let mut runs = run(&casters, &lamps, &samples, &work)?;
/// // A torus shadows itself: no shadow is wrong.
/// let checked = check(&casters, &lamps, &samples, &work, &mut runs, &Budget::default(), &Check::default())?;
/// assert_eq!(checked[0].judgment, Judgment::FellBack(Technique::Rays));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`PrepareError`] of the exact technique.
///
/// # Panics
///
/// Panics if there is not one work and one run per lamp.
pub fn check(
    casters: &CasterGroup<'_>,
    lamps: &[Lamp],
    samples: &Samples,
    work: &[Task],
    runs: &mut [Run],
    budget: &Budget,
    check: &Check,
) -> Result<Vec<Checked>, PrepareError> {
    assert!(lamps.len() == work.len() && lamps.len() == runs.len(), "one work and one run per lamp");
    let promised: f64 = work.iter().filter(|work| !work.is_void).map(|work| work.bound).sum();
    let stretch = if promised > 0.0 { (budget.error / promised).max(1.0) } else { 1.0 };
    let one = |(number, ((lamp, work), run)): (usize, ((&Lamp, &Task), &mut Run))| {
        let request = Request { casters, lamp, samples };
        let judge = Judge::of(&request, &run.visibility, budget, check);
        let allowed = if work.is_void { 1.0 } else { (work.bound * stretch).min(1.0) };
        let seed = check.seed.wrapping_add(number as u64);
        let mut checked = judge.look(allowed, ALPHA / lamps.len() as f64, check.first.max(1), seed);
        if work.is_void {
            return Ok(Checked { judgment: Judgment::Void, ..Checked::NOTHING });
        }
        let exact = exact_technique(lamp);
        match checked.judgment {
            Judgment::FellBack(_) if work.technique() == Some(exact) && work.kept.is_none() => {
                checked.judgment = Judgment::Failed;
            }
            Judgment::FellBack(_) => {
                let start = Instant::now();
                run.visibility = exact.shade(&request)?;
                run.time += start.elapsed();
                run.prepared += 1;
                checked.judgment = Judgment::FellBack(exact);
            }
            _ => {}
        }
        Ok(checked)
    };
    lamps.iter().zip(work).zip(runs).enumerate().map(one).collect()
}

/// The number of samples at which a visibility is wrong, of all that the lamp may light.
#[must_use]
pub fn count_wrong(
    request: &Request<'_>,
    visibility: &Visibility,
    budget: &Budget,
    physical_falloff: bool,
) -> u64 {
    let check = Check { physical_falloff, ..Check::default() };
    let judge = Judge::of(request, visibility, budget, &check);
    judge.count_wrong(&judge.population)
}

/// Compares samples of one lamp with the truth.
struct Judge<'a> {
    request: Request<'a>,
    visibility: &'a Visibility,
    /// The lamp, if it has an area.
    area: Option<AreaLight>,
    /// The largest difference that is not wrong.
    light: f64,
    /// The samples that the lamp may light.
    population: Vec<u32>,
    /// Number of samples that see a surface.
    seen: usize,
}

impl<'a> Judge<'a> {
    fn of(request: &Request<'a>, visibility: &'a Visibility, budget: &Budget, check: &Check) -> Self {
        let lights = may_light(request.lamp, check.physical_falloff);
        let hits = (0..).zip(request.samples.hits().iter().zip(visibility.asked()));
        // All others are 0 in truth, and by contract.
        let asked = hits.filter(|(_, (hit, asked))| **asked && hit.is_some_and(|hit| lights(hit.point)));
        let area = area_of(request.lamp);
        Self {
            request: *request,
            visibility,
            light: budget.light_of(area.is_some()),
            area,
            population: asked.map(|(index, _)| index).collect(),
            seen: request.samples.hits().iter().flatten().count(),
        }
    }

    /// Draws until it is sure whether no more than a fraction of all samples is wrong.
    fn look(&self, allowed: f64, alpha: f64, first: u64, seed: u64) -> Checked {
        let all = self.population.len() as u64;
        let share = all as f64 / self.seen.max(1) as f64;
        // Exactness is not for statistics to show: no draw of one look may be wrong.
        let most_looks = if allowed > 0.0 { u64::BITS } else { 1 };
        let sizes = (0..most_looks).map_while(|look| first.checked_shl(look).filter(|&size| size < all));
        let sizes: Vec<u64> = sizes.collect();
        let alpha = alpha / sizes.len().max(1) as f64;
        let mut random = SplitMix64(seed);
        let (mut drawn, mut wrong) = (0, 0);
        for size in sizes {
            let more: Vec<u32> =
                (drawn..size).map(|_| self.population[random.below(self.population.len())]).collect();
            (drawn, wrong) = (size, wrong + self.count_wrong(&more));
            let bound = share * binomial::upper(wrong, drawn, alpha);
            let judgment = match allowed > 0.0 {
                false if wrong == 0 => Judgment::Accepted,
                false => Judgment::FellBack(Technique::Rays),
                true if bound <= allowed => Judgment::Accepted,
                true if share * binomial::lower(wrong, drawn, alpha) > allowed => {
                    Judgment::FellBack(Technique::Rays)
                }
                true => continue,
            };
            return Checked { drawn, wrong, is_all: false, bound, allowed, judgment };
        }
        let wrong = self.count_wrong(&self.population);
        let bound = wrong as f64 / self.seen.max(1) as f64;
        let judgment =
            if bound <= allowed { Judgment::Accepted } else { Judgment::FellBack(Technique::Rays) };
        Checked { drawn: all, wrong, is_all: true, bound, allowed, judgment }
    }

    fn count_wrong(&self, indices: &[u32]) -> u64 {
        let hits = indices.iter().filter_map(|&index| self.request.samples.hits()[index as usize].as_ref());
        let hits: Vec<&PrimaryHit> = hits.collect();
        let values = indices.iter().map(|&index| f64::from(self.visibility.values()[index as usize]));
        let oracle = self.request.casters.oracle();
        let is_wrong: Vec<bool> = match &self.area {
            None => {
                let points: Vec<[f32; 3]> = hits.iter().map(|hit| hit.point).collect();
                let mut verdicts = vec![Verdict::Lit; points.len()];
                oracle.verdicts_into(&points, self.request.light(), &mut verdicts);
                let differs = |(value, verdict): (f64, &Verdict)| match verdict {
                    Verdict::Lit => 1.0 - value > self.light,
                    Verdict::Shadowed => value > self.light,
                    Verdict::Grazing => false,
                };
                values.zip(&verdicts).map(differs).collect()
            }
            Some(area) => {
                let receivers: Vec<Receiver> = hits.iter().map(|hit| hit.point.into()).collect();
                let mut visible = vec![None; receivers.len()];
                SoftOracle::new(oracle).visible_into(&receivers, area, &mut visible);
                // The value was rounded to `f32`.
                let slack = |truth: &Visible| self.light + truth.bound + f64::from(f32::EPSILON);
                let differs = |(value, truth): (f64, &Option<Visible>)| {
                    truth.as_ref().is_some_and(|truth| (value - truth.fraction).abs() > slack(truth))
                };
                values.zip(&visible).map(differs).collect()
            }
        };
        is_wrong.into_iter().filter(|&is_wrong| is_wrong).count() as u64
    }
}

impl Checked {
    const NOTHING: Self =
        Self { drawn: 0, wrong: 0, is_all: false, bound: 0.0, allowed: 1.0, judgment: Judgment::Void };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::mesh::Mesh;
    use crate::shadow::Claim;
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    fn scene(up: f32) -> (Caster, Samples) {
        let floor = shapes::cuboid([-9.0, -9.0, -2.0], [9.0, 9.0, -1.5]);
        let caster = Caster::new(Mesh::concat(&[floor, shapes::torus(24, 12, 2.0, 0.7)]).unwrap());
        let size = Size::new(120, 90).unwrap();
        let camera = Camera::look_at([4.0, -9.0, up], [0.0; 3], 0.9, Up::Z).unwrap();
        let projection = camera.projection(size, 0.1);
        let samples = Samples::of_view(&CasterGroup::new(vec![&caster]), &projection, size, 1).unwrap();
        (caster, samples)
    }

    /// The check of a visibility with a fraction of the samples that the lamp may light turned over.
    fn checked(lamp: &str, allowed: f64, every: usize, first: u64) -> (Checked, Run, Visibility) {
        let (caster, samples) = scene(7.0);
        let casters = CasterGroup::new(vec![&caster]);
        let lamps: [Lamp; 1] = [lamp.parse().unwrap()];
        let work = [Task { bound: allowed, ..Task::new(Technique::None) }];
        let request = Request { casters: &casters, lamp: &lamps[0], samples: &samples };
        let exact = exact_technique(&lamps[0]).shade(&request).unwrap();
        let mut values = exact.values().to_vec();
        let asked = (0..values.len()).filter(|&index| exact.asked()[index]);
        for index in asked.step_by(every) {
            values[index] = if values[index] > 0.5 { 0.0 } else { 1.0 };
        }
        let visibility = Visibility::from_values(&samples, lamps[0].light(), values, Claim::Approximate);
        let mut runs = [Run { visibility, time: std::time::Duration::ZERO, prepared: 0 }];
        let options = Check { first, ..Check::default() };
        let found =
            check(&casters, &lamps, &samples, &work, &mut runs, &Budget::default(), &options).unwrap();
        let [run] = runs;
        (found[0], run, exact)
    }

    const NEVER: usize = usize::MAX;

    #[test]
    fn check_of_a_technique_wrong_at_two_percent_falls_back_to_the_exact_one() {
        for (lamp, first) in [("point:1,-3,9", 1000), ("directional:0.3,0.2,-1", 500)] {
            // As an exact technique, and as one that may be wrong at half a percent.
            for allowed in [0.0, 0.005] {
                let (found, run, exact) = checked(lamp, allowed, 50, first);
                assert_eq!(found.judgment, Judgment::FellBack(Technique::Rays), "{found:?}");
                assert!(found.wrong > 0 && found.bound > allowed);
                assert_eq!((run.visibility.values(), run.prepared), (exact.values(), 1));
            }
            // Where 5 % may be wrong, the same is accepted and stays as it is.
            let (found, run, exact) = checked(lamp, 0.05, 50, first);
            assert_eq!(found.judgment, Judgment::Accepted, "{found:?}");
            assert!(found.bound <= 0.05 && run.prepared == 0);
            assert_ne!(run.visibility.values(), exact.values());
        }
    }

    #[test]
    fn check_of_what_is_right_accepts_after_one_look() {
        for allowed in [0.0, 0.02] {
            let (found, run, _) = checked("point:1,-3,9", allowed, NEVER, 1000);
            // One sample is turned over, and found only if it is drawn.
            assert!(found.wrong <= 4, "{found:?}");
            if found.wrong == 0 || allowed > 0.0 {
                assert_eq!((found.judgment, found.drawn, found.is_all), (Judgment::Accepted, 1000, false));
                assert_eq!(run.prepared, 0);
            }
        }
    }

    #[test]
    fn check_near_the_allowed_error_looks_again_and_in_the_end_at_all() {
        // 2 % of the samples that face the lamp are fewer of all: this is what is allowed, exactly.
        let (reference, ..) = checked("point:1,-3,9", 1e-9, 50, u64::MAX);
        assert!(reference.is_all);
        let (found, ..) = checked("point:1,-3,9", reference.bound, 50, 100);
        assert_eq!((found.judgment, found.is_all), (Judgment::Accepted, true), "{found:?}");
        assert_eq!(found.wrong, reference.wrong);
        // One sample fewer is allowed: all are compared, and the lamp falls back.
        let (found, ..) = checked("point:1,-3,9", reference.bound * 0.999, 50, 100);
        assert_eq!(found.judgment, Judgment::FellBack(Technique::Rays), "{found:?}");
    }

    #[test]
    fn check_of_a_lamp_with_extent_is_against_the_fraction_of_it() {
        let lamp = "point:1,-3,9,radius=0.8";
        let (found, run, exact) = checked(lamp, 0.0, 50, 300);
        assert_eq!(found.judgment, Judgment::FellBack(Technique::Area), "{found:?}");
        assert_eq!(run.visibility.values(), exact.values());
        // Its hard shadow is wrong in the penumbra alone.
        let (caster, samples) = scene(7.0);
        let casters = CasterGroup::new(vec![&caster]);
        let lamps = [lamp.parse().unwrap()];
        let budget = |text: &str| text.parse::<Budget>().unwrap();
        let judge = |text: &str, technique: Technique| {
            let work = [Task { bound: budget(text).error, ..Task::new(technique) }];
            let mut runs = crate::plan::run(&casters, &lamps, &samples, &work).unwrap();
            let options = Check { first: 300, ..Check::default() };
            check(&casters, &lamps, &samples, &work, &mut runs, &budget(text), &options).unwrap()[0].judgment
        };
        assert_eq!(judge("error=0", Technique::Rays), Judgment::FellBack(Technique::Area));
        assert_eq!(judge("error=0.5", Technique::Rays), Judgment::Accepted);
        assert_eq!(judge("light=1", Technique::Rays), Judgment::Accepted);
        assert_eq!(judge("error=0", Technique::Area), Judgment::Accepted);
    }

    #[test]
    fn check_errs_no_more_often_than_it_says() {
        // The truth is just above what is allowed: it may be accepted once in a hundred times at most.
        let wrong: Vec<u64> = (0..400)
            .map(|seed| {
                let mut random = SplitMix64(seed);
                let mut hits = 0;
                let sizes = [100, 200, 400, 800];
                let mut drawn = 0;
                for size in sizes {
                    hits += (drawn..size).filter(|_| random.unit() < 0.05).count() as u64;
                    drawn = size;
                    let alpha = ALPHA / sizes.len() as f64;
                    if binomial::upper(hits, drawn, alpha) < 0.05
                        || binomial::lower(hits, drawn, alpha) > 0.05
                    {
                        return 1;
                    }
                }
                0
            })
            .collect();
        // Both sides together: 2 % of 400 are 8, and 20 have a probability below 10⁻⁴.
        assert!(wrong.iter().sum::<u64>() < 20);
    }
}
