//! Running a plan: the visibility of each lamp, by the technique of each group of receivers.

use std::time::{Duration, Instant};

use super::relevance::{Pieces, RelevanceTest, Triple, casting};
use super::{LampPlan, Receivers, ShadowPlan};
use crate::caster::{Caster, CasterGroup};
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::planar::{Ground, Plane};
use crate::shadow::{Claim, PrepareError, Request, Samples, Technique, Visibility};

/// What is to be done for one lamp: a part of a [`ShadowPlan`], or of one that was saved.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Task {
    /// The numbers of the pieces that cast, ascending; `None` for all.
    pub kept: Option<Vec<u32>>,
    /// The technique of each group of receivers.
    pub groups: Vec<(Receivers, Technique)>,
    /// The largest fraction of the samples that the plan allows to be wrong.
    pub bound: f64,
    /// Whether the lamp adds nothing that counts, so that its shadow need not be right.
    pub is_void: bool,
}

impl Task {
    /// One technique for all receivers, from all casters, without an error.
    #[must_use]
    pub fn new(technique: Technique) -> Self {
        Self { kept: None, groups: vec![(Receivers::All, technique)], bound: 0.0, is_void: false }
    }

    /// What a plan says of each lamp.
    #[must_use]
    pub fn of(plan: &ShadowPlan) -> Vec<Self> {
        let of_lamp = |lamp: &LampPlan| {
            let is_void = plan.dropped.iter().any(|dropped| {
                dropped.lamp == lamp.lamp
                    && dropped.what == Triple::Lamp
                    && matches!(dropped.test, RelevanceTest::Zero | RelevanceTest::Faint)
            });
            Self {
                kept: (lamp.kept.len() < lamp.pieces).then(|| lamp.kept.clone()),
                groups: lamp.groups.iter().map(|group| (group.receivers, group.technique)).collect(),
                bound: lamp.groups.iter().map(|group| group.prediction.bound).sum(),
                is_void,
            }
        };
        plan.lamps.iter().map(of_lamp).collect()
    }

    /// The only technique; `None` if groups differ.
    #[must_use]
    pub fn technique(&self) -> Option<Technique> {
        match self.groups[..] {
            [(_, technique)] => Some(technique),
            _ => None,
        }
    }
}

/// What was done for one lamp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Run {
    /// Fraction of the lamp that reaches each sample.
    pub visibility: Visibility,
    /// Time to prepare and to shade.
    pub time: Duration,
    /// Number of techniques that were prepared: 0 where no shadow has to be computed.
    pub prepared: usize,
}

/// Runs the work of each lamp, on the CPU.
///
/// Casters are reduced to the pieces that are kept. Nothing is prepared for `none` and `dark`.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::plan::{Task, run};
/// use umbrage::shadow::{Samples, Technique};
/// use umbrage::testing::shapes;
/// use umbrage::view::{Camera, Size, Up};
///
/// let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
/// let casters = CasterGroup::new(vec![&caster]);
/// let size = Size::new(64, 48)?;
/// let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
/// let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1)?;
/// let lamps = ["point:3,9,5".parse()?, "point:-3,9,5".parse()?];
/// let runs = run(&casters, &lamps, &samples, &[Technique::Rays, Technique::None].map(Task::new))?;
/// assert_eq!((runs[0].prepared, runs[1].prepared), (1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`PrepareError`] of a technique.
///
/// # Panics
///
/// Panics if there is not one work per lamp, or if it names pieces that there are not.
pub fn run(
    casters: &CasterGroup<'_>,
    lamps: &[Lamp],
    samples: &Samples,
    work: &[Task],
) -> Result<Vec<Run>, PrepareError> {
    assert_eq!(lamps.len(), work.len(), "one work per lamp");
    let mut pieces = None;
    let run = |(lamp, work): (&Lamp, &Task)| {
        let start = Instant::now();
        let is_needed = |&(_, technique): &(_, Technique)| prepares(technique);
        let reduced = match (&work.kept, work.groups.iter().any(is_needed)) {
            (Some(kept), true) if can_be_reduced(casters) => {
                casting(casters, pieces.get_or_insert_with(|| Pieces::of(casters)), kept)
            }
            _ => None,
        };
        let group = reduced.as_deref().map(|reduced| group_of(reduced, casters));
        let casters = group.as_ref().unwrap_or(casters);
        let (visibility, prepared) = of_lamp(&Request { casters, lamp, samples }, &work.groups)?;
        Ok(Run { visibility, time: start.elapsed(), prepared })
    };
    lamps.iter().zip(work).map(run).collect()
}

/// Whether a technique has something to prepare.
fn prepares(technique: Technique) -> bool {
    !matches!(technique, Technique::None | Technique::Dark)
}

/// Whether all that is seen stays seen if casters are left out. The only caster is all that is seen itself.
fn can_be_reduced(casters: &CasterGroup<'_>) -> bool {
    casters.seen_caster().is_some() || casters.casters().len() == 1
}

/// Some casters in a scene of which the same is seen as before.
fn group_of<'a>(reduced: &'a [Caster], casters: &CasterGroup<'a>) -> CasterGroup<'a> {
    let seen = casters.seen_caster().unwrap_or(casters.casters()[0]);
    CasterGroup::new(reduced.iter().collect()).seen_with(seen)
}

/// The visibility of one lamp, and the number of techniques that were prepared.
fn of_lamp(
    request: &Request<'_>,
    groups: &[(Receivers, Technique)],
) -> Result<(Visibility, usize), PrepareError> {
    let prepared = groups.iter().filter(|&&(_, technique)| prepares(technique)).count();
    if let [(Receivers::All, technique)] = groups {
        return Ok((shade(*technique, request)?, prepared));
    }
    let (samples, light) = (request.samples, request.light());
    let plane = Ground::Most.plane(samples, light);
    let mut values = vec![0.0; samples.len()];
    let mut claim = Claim::Exact;
    for &(receivers, technique) in groups {
        let holds = |hit: &PrimaryHit| is_of(hit, receivers, plane.as_ref());
        let part = samples.only(holds);
        let shaded = shade(technique, &Request { samples: &part, ..*request })?;
        claim = weaker(claim, shaded.claim());
        // Values of samples of the other groups are 0: nothing is seen there.
        values.iter_mut().zip(shaded.values()).for_each(|(value, &part)| *value += part);
    }
    Ok((Visibility::from_values(samples, light, values, claim), prepared))
}

fn is_of(hit: &PrimaryHit, receivers: Receivers, plane: Option<&Plane>) -> bool {
    let is_on_plane = plane.is_some_and(|plane| plane.holds(hit.corners));
    match receivers {
        Receivers::All => true,
        Receivers::Plane => is_on_plane,
        Receivers::Others => !is_on_plane,
    }
}

fn shade(technique: Technique, request: &Request<'_>) -> Result<Visibility, PrepareError> {
    if prepares(technique) {
        return technique.shade(request);
    }
    let value = if technique == Technique::None { 1.0 } else { 0.0 };
    let values = vec![value; request.samples.len()];
    // The claim of the technique: whether no shadow is right, only the plan knows.
    Ok(Visibility::from_values(request.samples, request.light(), values, Claim::Approximate))
}

fn weaker(a: Claim, b: Claim) -> Claim {
    let rank = |claim: Claim| match claim {
        Claim::Exact => 0,
        Claim::WithinFootprint => 1,
        Claim::Bounded(_) => 2,
        Claim::Approximate => 3,
    };
    match (a, b) {
        (Claim::Bounded(a), Claim::Bounded(b)) => Claim::Bounded((a + b).min(1.0)),
        _ if rank(a) >= rank(b) => a,
        _ => b,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::plan::relevance::{Question, TestSet, relevant};
    use crate::testing::{record_built, shapes};
    use crate::view::{Camera, Size, Up};

    /// A floor, a cube over it, and a cube below it.
    fn scene() -> (Caster, Samples) {
        let floor = shapes::cuboid([-9.0, -2.0, -9.0], [9.0, -1.5, 9.0]);
        let below = shapes::translated(&shapes::cube(), [0.0, -5.0, 0.0]);
        let caster = Caster::new(Mesh::concat(&[floor, shapes::cube(), below]).unwrap());
        let size = Size::new(48, 36).unwrap();
        let camera = Camera::look_at([7.0, 6.0, 8.0], [0.0; 3], 0.9, Up::Y).unwrap();
        let casters = CasterGroup::new(vec![&caster]);
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1).unwrap();
        drop(casters);
        (caster, samples)
    }

    fn lamp(text: &str) -> Lamp {
        text.parse().unwrap()
    }

    #[test]
    fn run_of_the_kept_pieces_is_that_of_all_casters_for_every_exact_technique() {
        let (caster, samples) = scene();
        let casters = CasterGroup::new(vec![&caster]);
        let lamp = lamp("point:1,9,2");
        let pieces = Pieces::of(&casters);
        let question = Question {
            casters: &casters,
            pieces: &pieces,
            lamp: &lamp,
            number: 0,
            samples: &samples,
            physical_falloff: false,
            level: 0.0,
            tests: TestSet::ALL,
        };
        let kept = relevant(&question).kept;
        assert!(!kept.is_empty() && kept.len() < pieces.len(), "{kept:?}");
        let values = |work: Task| {
            let runs = run(&casters, std::slice::from_ref(&lamp), &samples, &[work]).unwrap();
            assert_eq!(runs[0].prepared, 1);
            runs[0].visibility.values().to_vec()
        };
        let truth = values(Task::new(Technique::Rays));
        assert!(truth.contains(&0.0) && truth.contains(&1.0));
        for name in ["rays", "hybrid", "alias-free", "zfail", "counter", "hybrid-3x3", "planar"] {
            let technique = name.parse().unwrap();
            let all = values(Task::new(technique));
            let few = values(Task { kept: Some(kept.clone()), ..Task::new(technique) });
            let differ = all.iter().zip(&few).filter(|(a, b)| a != b).count();
            // An approximate technique may differ: its map is of fewer casters.
            assert!(differ == 0 || name == "hybrid-3x3" && differ < 9, "{name}: {differ}");
        }
        // The cube is what is kept: without it there is no shadow on the floor.
        let none = values(Task { kept: Some(Vec::new()), ..Task::new(Technique::Rays) });
        assert_ne!(none, truth);
    }

    #[test]
    fn run_prepares_and_builds_nothing_for_a_lamp_without_shadows() {
        let (caster, samples) = scene();
        let casters = CasterGroup::new(vec![&caster]);
        let lamps = [lamp("point:1,9,2"), lamp("point:1,9,2"), lamp("point:1,9,2")];
        let of = |technique| Task { kept: Some(vec![0]), ..Task::new(technique) };
        let work = [of(Technique::None), of(Technique::Dark), of(Technique::None)];
        let (runs, built) = record_built(|| run(&casters, &lamps, &samples, &work).unwrap());
        assert!(built.is_empty(), "{built:?}");
        assert!(runs.iter().all(|run| run.prepared == 0));
        let asked = runs[0].visibility.asked().iter().filter(|asked| **asked).count();
        let lit = |run: &Run| run.visibility.values().iter().filter(|&&value| value == 1.0).count();
        assert!(asked > 100);
        assert_eq!([lit(&runs[0]), lit(&runs[1])], [asked, 0]);
        // The same log sees what a technique builds.
        let work = [of(Technique::None), of(Technique::Rays), of(Technique::ZFail)];
        let (runs, built) = record_built(|| run(&casters, &lamps, &samples, &work).unwrap());
        assert!(!built.is_empty() && runs[1].prepared == 1 && runs[0].prepared == 0);
    }

    #[test]
    fn run_of_groups_shades_each_by_its_own_technique() {
        let (caster, samples) = scene();
        let casters = CasterGroup::new(vec![&caster]);
        let lamp = lamp("point:1,9,2");
        let values = |groups: &[(Receivers, Technique)]| {
            let work = Task { groups: groups.to_vec(), ..Task::new(Technique::Rays) };
            run(&casters, std::slice::from_ref(&lamp), &samples, &[work]).unwrap()[0].visibility.clone()
        };
        let (planar, rays) = ("planar".parse().unwrap(), Technique::Rays);
        let all = values(&[(Receivers::All, rays)]);
        let split = values(&[(Receivers::Plane, planar), (Receivers::Others, rays)]);
        assert_eq!(all.values(), split.values());
        // Each group has samples: dark ones show which.
        let lit = |visibility: &Visibility| visibility.values().iter().filter(|&&value| value > 0.0).count();
        let plane = values(&[(Receivers::Plane, rays), (Receivers::Others, Technique::Dark)]);
        let others = values(&[(Receivers::Plane, Technique::Dark), (Receivers::Others, rays)]);
        assert!(lit(&plane) > 0 && lit(&others) > 0);
        assert_eq!(lit(&plane) + lit(&others), lit(&all));
        assert_eq!(plane.claim(), Claim::Approximate);
    }
}
