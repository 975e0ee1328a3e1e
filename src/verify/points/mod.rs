//! Every method against every other, at points chosen to be hard.
//!
//! The ray cast counts the faces between a point and the light. The winding number of the emitted volume,
//! computed from the volume's triangles alone, must be the same number. The same holds for the volume of the
//! chosen faces, which is halved where this is allowed. A sample of the points is decided again with big
//! integers. The sides of all faces, which come from a filter, are decided again face by face. A query is a
//! declared tie if the segment only touches the mesh (either answer is right), or if every winding number
//! abstains because the point lies on the volume.
//!
//! Each method is a *judge*: a row of the report.

pub(crate) mod draw;
pub(crate) mod feature;
pub(crate) mod judge;
pub(crate) mod sampler;

pub use draw::STRATA;

use crate::caster::Caster;
use crate::facing::{CasterFaces, classify};
use crate::geom::{Aabb, Light};
use crate::oracle::Verdict;
use crate::parallel;
use crate::shadow::volume::{Caps, ShadowVolume, WindingIndex};
use crate::silhouette::Silhouette;
use crate::verify::Tally;
use judge::Cast;
use sampler::Sampler;

/// Number of points to verify, their seed, and how much of the result to keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Number of points, spread evenly over the strata.
    pub points: usize,
    /// Seed of the points: the same seed gives the same points.
    pub seed: u64,
    /// Maximum number of disagreements kept with their positions.
    pub keep: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { points: 10_000, seed: 1, keep: 10 }
    }
}

/// Verification of one caster under any number of lights.
///
/// ```
/// use umbrage::caster::Caster;
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// use umbrage::verify::points::{Options, Verifier};
///
/// let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
/// let light = Light::point([3.0, 4.0, 5.0])?;
/// let options = Options { points: 500, ..Options::default() };
/// let verification = Verifier::new(&caster).verify(&light, &options, &|_| {});
/// assert!(verification.agrees());
/// assert_eq!(verification.total().disagree, 0);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Verifier<'a> {
    caster: &'a Caster,
}

/// Result of verifying one light.
#[derive(Clone, Debug, PartialEq)]
pub struct Verification {
    /// One row per stratum, in the order of [`STRATA`].
    pub strata: Vec<Stratum>,
    /// One row per judge (method).
    pub judges: Vec<Judge>,
    /// The first disagreements, in the order of the points.
    pub disagreements: Vec<Disagreement>,
}

/// Counts over the points of one stratum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stratum {
    /// Name of the stratum.
    pub name: &'static str,
    /// Number of points.
    pub points: u64,
    /// Points at which all judges agree.
    pub agree: u64,
    /// Declared ties: the segment to the light only touches the surface, or all winding numbers abstain
    /// because the point lies on the volume.
    pub grazing: u64,
    /// Points at which at least one judge contradicts the ray cast.
    pub disagree: u64,
}

/// Counts of one judge (method) against the ray cast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Judge {
    /// Name of the method.
    pub name: &'static str,
    /// Number of points the judge was asked about.
    pub points: u64,
    /// Points at which the judge abstained, because the point lies on a face of the volume.
    pub abstain: u64,
    /// Points at which the judge contradicted the ray cast.
    pub disagree: u64,
}

/// A point at which judges disagree.
#[derive(Clone, Debug, PartialEq)]
pub struct Disagreement {
    /// Name of the point's stratum.
    pub stratum: &'static str,
    /// Position of the point.
    pub point: [f32; 3],
    /// The ray cast's verdict.
    pub verdict: Verdict,
    /// Which judges contradict the ray cast, and how.
    pub what: String,
}

impl Verification {
    /// Whether no judge contradicts another, at any point or about any face.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.judges.iter().all(|judge| judge.disagree == 0) && self.total().disagree == 0
    }

    /// The sum of all strata.
    #[must_use]
    pub fn total(&self) -> Stratum {
        self.strata.iter().fold(Stratum { name: "all", ..Stratum::default() }, |sum, row| sum.plus(row))
    }
}

impl Stratum {
    /// The sum of two rows, under the first one's name.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            name: self.name,
            points: self.points + other.points,
            agree: self.agree + other.agree,
            grazing: self.grazing + other.grazing,
            disagree: self.disagree + other.disagree,
        }
    }

    /// The counts as those of any verification: grazing points are ties.
    #[must_use]
    pub fn tally(&self) -> Tally {
        let judged = self.agree + self.disagree;
        Tally { queries: self.points, ties: self.grazing, judged, wrong: self.disagree }
    }

    /// See [`Tally::bound_95`]. The points of one mesh share its surface and its lights.
    #[must_use]
    pub fn bound_95(&self) -> Option<f64> {
        self.tally().bound_95()
    }
}

impl Judge {
    /// The sum of two rows, under the first one's name.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            name: self.name,
            points: self.points + other.points,
            abstain: self.abstain + other.abstain,
            disagree: self.disagree + other.disagree,
        }
    }
}

/// Points per run; each run is judged on one thread.
const RUN: usize = 256;

/// Faces that the big-integer reference tests in total (less than a second of work). The reference is asked
/// about at least 4 and at most 200 points per stratum.
const REFERENCE_FACES: usize = 400_000;

impl<'a> Verifier<'a> {
    /// A verifier for a caster whose mesh is welded. Topology, proofs, planes and ray cast are built on first
    /// use.
    #[must_use]
    pub fn new(caster: &'a Caster) -> Self {
        Self { caster }
    }

    /// Builds what all lights share: topology, shells, proofs, planes and ray cast. Otherwise the first light
    /// builds it, which for a million faces takes some seconds.
    pub fn prepare(&self) {
        let caster = self.caster;
        let _ = caster.topology();
        let _ = caster.planes();
        let _ = caster.oracle();
        let _ = caster.proofs();
    }

    /// Verifies one light. `progress` is called with the number of points done, from any thread.
    #[must_use]
    pub fn verify(&self, light: &Light, options: &Options, progress: &(dyn Fn(u64) + Sync)) -> Verification {
        self.verify_with(light, options, progress, |_| {})
    }

    /// As [`Verifier::verify`], but `spoil` may change the casting signs first. Tests inject a fault with
    /// `spoil` and check that verification reports the fault.
    fn verify_with(
        &self,
        light: &Light,
        options: &Options,
        progress: &(dyn Fn(u64) + Sync),
        spoil: impl Fn(&mut [i8]),
    ) -> Verification {
        let (mesh, topology) = (self.caster.mesh(), self.caster.topology());
        let facing = self.caster.facing(light);
        let chosen = self.caster.shell_faces(light, None).signs(self.caster.shells(), &facing);
        let extrude = |mut signs: Vec<i8>| {
            spoil(&mut signs);
            let silhouette = Silhouette::extract(topology, &signs);
            ShadowVolume::extrude(mesh, topology, light, &signs, &silhouette, Caps::Both)
        };
        let edges = Silhouette::extract(topology, &CasterFaces::All.signs(&facing));
        let points = draw::draw(&Sampler::new(mesh, light, topology, &edges), options);
        let within = Aabb::around(points.iter().map(|(_, p)| *p));
        let (all, half) = (extrude(CasterFaces::All.signs(&facing)), extrude(chosen.clone()));
        let bench = Bench {
            verifier: self,
            light,
            chosen: &chosen,
            all: WindingIndex::build(&all, within),
            half: WindingIndex::build(&half, within),
            reference_every: self.reference_every(options.points / STRATA.len().max(1)),
        };
        let mut verification = bench.judge_all(&points, options.keep, progress);
        let truth = classify(mesh, light);
        let wrong = facing.iter().zip(&truth).filter(|(filtered, exact)| filtered != exact).count() as u64;
        let name = "sides of all faces, one by one";
        let judge = Judge { name, points: truth.len() as u64, abstain: 0, disagree: wrong };
        verification.judges.push(judge);
        verification
    }

    /// Sampling stride of the big-integer reference within a stratum of `points` points.
    fn reference_every(&self, points: usize) -> usize {
        let samples =
            (REFERENCE_FACES / (self.caster.mesh().face_count() + 1)).clamp(20, 1000) / STRATA.len();
        points.div_ceil(samples).max(1)
    }
}

/// Everything needed to judge the points of one light.
struct Bench<'a> {
    verifier: &'a Verifier<'a>,
    light: &'a Light,
    chosen: &'a [i8],
    all: WindingIndex<'a>,
    half: WindingIndex<'a>,
    reference_every: usize,
}

const JUDGES: [&str; 4] =
    ["ray cast", "winding number, all faces", "winding number, chosen faces", "whole numbers"];

impl Bench<'_> {
    fn judge_all(
        &self,
        points: &[(usize, [f32; 3])],
        keep: usize,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Verification {
        let runs: Vec<&[(usize, [f32; 3])]> = points.chunks(RUN).collect();
        let judge_run = |mut rows: Rows, run: u64| {
            let run = run as usize; // an index of `runs`
            for (i, &(stratum, p)) in runs[run].iter().enumerate() {
                self.judge(run * RUN + i, stratum, p, &mut rows);
            }
            progress(runs[run].len() as u64);
            rows
        };
        let sum = parallel::sum(runs.len() as u64, || Rows::new(keep), judge_run, Rows::plus);
        Verification { strata: sum.strata, judges: sum.judges, disagreements: sum.disagreements }
    }

    fn judge(&self, index: usize, stratum: usize, p: [f32; 3], rows: &mut Rows) {
        // 1. The ray cast: all faces on the segment, the faces that cast in the halved volume, and the
        //    touched faces.
        let cast = Cast::of(self.verifier.caster.oracle(), p, self.light, self.chosen);
        let verdict = cast.verdict();
        rows.judges[0].points += 1;
        let mut contradictions = Vec::new();

        // 2. The winding numbers of the two volumes.
        let mut abstain = 0;
        for (judge, volume, expected) in [(1, &self.all, cast.all()), (2, &self.half, cast.chosen())] {
            let row = &mut rows.judges[judge];
            row.points += 1;
            match volume.number(p) {
                None => {
                    row.abstain += 1;
                    abstain += 1;
                }
                Some(winding) if !cast.allows(winding, &expected) => {
                    row.disagree += 1;
                    contradictions.push(format!("{} is {winding}, expected {expected:?}", JUDGES[judge]));
                }
                Some(_) => {}
            }
        }

        // 3. The big-integer reference, on a sample of the points.
        if (index / STRATA.len()).is_multiple_of(self.reference_every) {
            let row = &mut rows.judges[3];
            row.points += 1;
            if let Err(what) = cast.in_whole_numbers(self.verifier.caster.mesh(), p, self.light) {
                row.disagree += 1;
                contradictions.push(format!("{}: {what}", JUDGES[3]));
            }
        }

        let row = &mut rows.strata[stratum];
        row.points += 1;
        if !contradictions.is_empty() {
            row.disagree += 1;
            if rows.disagreements.len() < rows.keep {
                let (stratum, what) = (STRATA[stratum], contradictions.join("; "));
                rows.disagreements.push(Disagreement { stratum, point: p, verdict, what });
            }
        } else if verdict == Verdict::Grazing || abstain == 2 {
            row.grazing += 1;
        } else {
            row.agree += 1;
        }
    }
}

/// What one thread has found so far.
struct Rows {
    strata: Vec<Stratum>,
    judges: Vec<Judge>,
    disagreements: Vec<Disagreement>,
    keep: usize,
}

impl Rows {
    fn new(keep: usize) -> Self {
        Self {
            strata: STRATA.iter().map(|&name| Stratum { name, ..Stratum::default() }).collect(),
            judges: JUDGES.iter().map(|&name| Judge { name, ..Judge::default() }).collect(),
            disagreements: Vec::new(),
            keep,
        }
    }

    fn plus(mut self, other: Self) -> Self {
        self.strata.iter_mut().zip(&other.strata).for_each(|(sum, row)| *sum = sum.plus(row));
        self.judges.iter_mut().zip(&other.judges).for_each(|(sum, row)| *sum = sum.plus(row));
        let room = self.keep - self.disagreements.len();
        self.disagreements.extend(other.disagreements.into_iter().take(room));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    #[test]
    fn verify_sees_a_single_face_that_is_taken_for_its_opposite() {
        let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
        let verifier = Verifier::new(&caster);
        let light = Light::point([3.0, 4.0, 5.0]).unwrap();
        let options = Options { points: 5000, ..Options::default() };
        let sound = verifier.verify(&light, &options, &|_| {});
        assert!(sound.agrees(), "{:?}", sound.disagreements);
        let spoiled = verifier.verify_with(&light, &options, &|_| {}, |signs| {
            let face = signs.iter().position(|&sign| sign == 1).unwrap();
            signs[face] = -1;
        });
        assert!(spoiled.total().disagree > 0);
        assert_eq!(spoiled.disagreements.len().min(1), 1);
    }

    #[test]
    fn verify_draws_the_same_points_from_the_same_seed_and_fills_every_stratum() {
        let caster = Caster::new(shapes::sheet(4));
        let verifier = Verifier::new(&caster);
        let light = Light::directional([0.2, 0.1, -1.0]).unwrap();
        let options = Options { points: 1000, ..Options::default() };
        let first = verifier.verify(&light, &options, &|_| {});
        assert_eq!(first, verifier.verify(&light, &options, &|_| {}));
        assert!(first.strata.iter().all(|row| row.points == 200));
        assert_eq!(first.total().disagree, 0, "{:?}", first.disagreements);
        let judged = first.judges.iter().find(|judge| judge.name == "whole numbers").unwrap();
        assert!(judged.points > 100);
    }
}
