//! Adversarial queries, without a file: small meshes, lights and points made to break exactness from every side.
//!
//! A query is one mesh, one light, one point. Work goes in rounds: a round draws a small mesh and a light, builds
//! everything once and asks about a few hundred points. A round depends on nothing but seed, stratum and number, so
//! results do not depend on threads.
//!
//! What is held against each other, for every query: the ray cast (tree and exact leaves) and the winding number of
//! the emitted volume, as counts and as "in or out". On a sample of them whole numbers, which share no code with the
//! predicates, and the ray cast that stops at the first face. In every eighth round the volume that is halved where
//! that is proven to be right. Once a round: the sides of all faces by the filter and one by one; and that the volume
//! is closed, as must be one of random signs.
//!
//! Where the way only touches something, both answers are right, and where every winding judge stands on its volume,
//! the ray cast has no second judge: these are ties. They are no way out for a judge: the first of each round where
//! something is touched or stood on are judged in whole numbers, and whenever a winding judge abstains, the point
//! has to lie on a triangle of its volume.
//!
//! Beside it, on every query, runs what most programs do: facing by a cross product in `f32`, and visibility by an
//! `f32` triangle test.

mod minimize;
mod naive_f32;
mod repro;
mod round;
mod stratum;

#[cfg(test)]
mod tests;

pub use repro::{Case, CaseError, Ruling};

use crate::geom::Aabb;
use crate::random::SplitMix64;
use crate::testing::generate::Draw;
use round::{Prepared, Seam};
use stratum::{RECIPES, Recipe};

/// How much to torture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// How many queries, spread evenly over the strata.
    pub queries: u64,
    /// What everything is drawn from; the same seed gives the same queries.
    pub seed: u64,
    /// How many disagreements to keep.
    pub keep: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { queries: 1_000_000, seed: 1, keep: 10 }
    }
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Torture {
    /// One row a stratum.
    pub strata: Vec<Stratum>,
    /// The first disagreements: by stratum, then by round, then by query.
    pub disagreements: Vec<Disagreement>,
    /// The first of them with as few faces and as simple coordinates as could be found.
    pub case: Option<Case>,
}

/// Counts over the queries of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stratum {
    /// What kind.
    pub name: &'static str,
    /// How many.
    pub queries: u64,
    /// Those that graze or abstain: declared to have no second judge.
    pub ties: u64,
    /// Those where the way to the light only touches: either answer is right.
    pub grazing: u64,
    /// Those where every winding judge abstains, because it stands on its volume.
    pub abstained: u64,
    /// Those where judges contradict each other.
    pub wrong: u64,
    /// Those that do not graze and where plain `f32` says in for out.
    pub plain_f32_wrong: u64,
    /// Faces of all rounds.
    pub faces: u64,
    /// Faces whose side is another one by the filter than by the predicate.
    pub faces_wrong: u64,
    /// Faces that plain `f32` takes for the side that they are not on.
    pub plain_f32_faces_wrong: u64,
    /// Volumes whose boundary was summed up.
    pub volumes: u64,
    /// Those of them that are not closed.
    pub open_volumes: u64,
    /// Queries that were judged in whole numbers too.
    pub judged_by_whole_numbers: u64,
    /// Rounds in which some query was no tie.
    pub rounds: u64,
}

/// A query where judges contradict each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Disagreement {
    /// Which kind, by the index of its row.
    pub stratum: usize,
    /// Which round of that stratum, from 0.
    pub round: u64,
    /// Which query of that round, from 0. The first one stands for a fault of the whole round.
    pub query: u64,
    /// Mesh, light and point.
    pub case: Case,
    /// What each judge said.
    pub said: Vec<String>,
}

impl Torture {
    /// Whether no judge contradicts another, about a query, a face, or a volume's being closed.
    #[must_use]
    pub fn agrees(&self) -> bool {
        let total = self.total();
        total.wrong == 0 && total.faces_wrong == 0 && total.open_volumes == 0
    }

    /// All strata together.
    #[must_use]
    pub fn total(&self) -> Stratum {
        self.strata.iter().fold(Stratum { name: "all", ..Stratum::default() }, |sum, row| sum.plus(row))
    }

    /// With no disagreement among n queries that were no ties, the rate of disagreement is below 3/n with 95 %
    /// confidence (the rule of three), if these queries were independent draws. They are not: up to 256 of them share a
    /// mesh, a light and a volume; [`Torture::bound_95_rounds`] claims no more than is drawn independently. `None` after
    /// a disagreement, or without such queries.
    #[must_use]
    pub fn bound_95(&self) -> Option<f64> {
        let total = self.total();
        let trials = total.queries - total.ties;
        (self.agrees() && trials > 0).then(|| (3.0 / trials as f64).min(1.0))
    }

    /// The same by rounds, which are drawn independently: less than this part of such rounds holds a disagreement.
    #[must_use]
    pub fn bound_95_rounds(&self) -> Option<f64> {
        let rounds = self.total().rounds;
        (self.agrees() && rounds > 0).then(|| (3.0 / rounds as f64).min(1.0))
    }
}

impl Stratum {
    /// The sum of two rows, under the first one's name.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            name: self.name,
            queries: self.queries + other.queries,
            ties: self.ties + other.ties,
            grazing: self.grazing + other.grazing,
            abstained: self.abstained + other.abstained,
            wrong: self.wrong + other.wrong,
            plain_f32_wrong: self.plain_f32_wrong + other.plain_f32_wrong,
            faces: self.faces + other.faces,
            faces_wrong: self.faces_wrong + other.faces_wrong,
            plain_f32_faces_wrong: self.plain_f32_faces_wrong + other.plain_f32_faces_wrong,
            volumes: self.volumes + other.volumes,
            open_volumes: self.open_volumes + other.open_volumes,
            judged_by_whole_numbers: self.judged_by_whole_numbers + other.judged_by_whole_numbers,
            rounds: self.rounds + other.rounds,
        }
    }
}

/// Queries a round.
const POINTS: u64 = 256;

/// In every so many rounds the halved volume is judged too: proving that it is right costs as much as a round.
const HALF_EVERY: u64 = 8;

/// In every so many rounds, and in the first ones, one query is judged in whole numbers.
const WHOLE_EVERY: u64 = 4;

/// Tortures. `progress` is told of queries as they are done, from any thread.
///
/// About two microseconds of one core a query; memory does not grow with the number of queries.
///
/// ```
/// use umbrage::testing::torture::{Options, run};
/// let found = run(&Options { queries: 10_000, ..Options::default() }, &|_| {});
/// assert!(found.agrees() && found.total().queries == 10_000);
/// ```
#[must_use]
pub fn run(options: &Options, progress: &(dyn Fn(u64) + Sync)) -> Torture {
    run_with(options, progress, Seam::SOUND)
}

/// As [`run`], with a chance to spoil a judge first: tests show with it that a fault is seen.
fn run_with(options: &Options, progress: &(dyn Fn(u64) + Sync), seam: Seam) -> Torture {
    let strata = RECIPES.len() as u64;
    let quota = |stratum: u64| options.queries / strata + u64::from(stratum < options.queries % strata);
    let units = strata * quota(0).div_ceil(POINTS);
    let add = |mut tally: Tally, unit: u64| {
        let (stratum, round) = (unit % strata, unit / strata);
        let points = quota(stratum).saturating_sub(round * POINTS).min(POINTS);
        if points > 0 {
            tally.round(options.seed, stratum as usize, round, points, seam);
            progress(points);
        }
        tally
    };
    let empty = || Tally::new(options.keep);
    #[cfg(feature = "parallel")]
    let sum = {
        use rayon::prelude::*;
        (0..units).into_par_iter().fold(empty, add).reduce(empty, Tally::plus)
    };
    #[cfg(not(feature = "parallel"))]
    let sum = empty().plus((0..units).fold(empty(), add));
    let case = sum.disagreements.first().map(|first| minimize::minimize(&first.case, seam));
    Torture { strata: sum.strata, disagreements: sum.disagreements, case }
}

/// What one thread has found so far.
struct Tally {
    strata: Vec<Stratum>,
    disagreements: Vec<Disagreement>,
    keep: usize,
}

impl Tally {
    fn new(keep: usize) -> Self {
        let row = |recipe: &Recipe| Stratum { name: recipe.name, ..Stratum::default() };
        Self { strata: RECIPES.iter().map(row).collect(), disagreements: Vec::new(), keep }
    }

    fn plus(mut self, other: Self) -> Self {
        self.strata.iter_mut().zip(&other.strata).for_each(|(sum, row)| *sum = sum.plus(row));
        self.keep_first(other.disagreements);
        self
    }

    fn keep_first(&mut self, more: Vec<Disagreement>) {
        if !more.is_empty() {
            self.disagreements.extend(more);
            self.disagreements.sort_by_key(|found| (found.stratum, found.round, found.query));
            self.disagreements.truncate(self.keep);
        }
    }

    /// Draws one round, and judges it.
    fn round(&mut self, seed: u64, stratum: usize, round: u64, points: u64, seam: Seam) {
        // 1. Mesh and light.
        let mut random = source(seed, stratum, round);
        let (mesh, light) = RECIPES[stratum].draw(&mut random);
        let signs = random.next();
        let prepared = Prepared::new(&mesh, &light, signs, round.is_multiple_of(HALF_EVERY), seam);

        // 2. Points.
        let sampler = prepared.sampler();
        let kinds = RECIPES[stratum].points;
        let draw: &mut dyn Draw = &mut random;
        let points: Vec<[f32; 3]> = (0..points)
            .map(|_| {
                let kind = draw.pick(kinds);
                sampler.draw(kind, draw)
            })
            .collect();
        let asked = round < WHOLE_EVERY || round.is_multiple_of(WHOLE_EVERY);
        let asked = asked.then(|| random.below(points.len()));

        // 3. Judge them.
        let within = Aabb::around(points.iter().copied());
        let mut bench = prepared.bench(within);
        let found = prepared.found;
        let mut row = Stratum {
            faces: found.faces,
            faces_wrong: found.faces_wrong,
            plain_f32_faces_wrong: found.plain_f32_faces_wrong,
            volumes: found.volumes,
            open_volumes: found.open_volumes,
            queries: points.len() as u64,
            ..Stratum::default()
        };
        let mut disagreements = Vec::new();
        let fault = found.faces_wrong + found.open_volumes > 0;
        for (query, &point) in points.iter().enumerate() {
            let judged = bench.judge(point, asked == Some(query));
            let wrong = judged.is_wrong();
            row.wrong += u64::from(wrong);
            row.ties += u64::from(!wrong && judged.is_tie());
            row.grazing += u64::from(!wrong && judged.grazes());
            row.abstained += u64::from(!wrong && judged.abstained());
            row.judged_by_whole_numbers += u64::from(judged.audited);
            row.plain_f32_wrong += u64::from(judged.plain_wrong());
            if (wrong || (fault && query == 0)) && disagreements.len() < self.keep {
                let case = Case { mesh: mesh.clone(), light, point, signs, within };
                let said = [found.say(), judged.say()].concat();
                disagreements.push(Disagreement { stratum, round, query: query as u64, case, said });
            }
        }
        row.rounds = u64::from(row.queries > row.ties);
        let sum = &mut self.strata[stratum];
        *sum = sum.plus(&row);
        self.keep_first(disagreements);
    }
}

/// A source for one round, unlike that of any other.
fn source(seed: u64, stratum: usize, round: u64) -> SplitMix64 {
    let of_stratum = SplitMix64(seed).next() ^ stratum as u64;
    SplitMix64(SplitMix64(SplitMix64(of_stratum).next() ^ round).next())
}
