//! Adversarial queries, without a file: small meshes, lights and points made to break exactness.
//!
//! A query is one mesh, one light, one point. Work is divided into rounds: a round draws a small mesh and a
//! light, builds everything once and asks about a few hundred points. A round depends on seed, stratum and
//! number alone, so results do not depend on threads.
//!
//! Compared in every query: the ray cast (tree and exact leaves) and the winding number of the emitted
//! volume, as counts and as inside or outside. On a sample of them also big integers, which share no code
//! with the predicates, and the ray cast that stops at the first face. In every eighth round also the volume
//! that is halved where that is proven to be right. Once per round: the sides of all faces, by the filter and
//! face by face; and that the volume is closed, as must be one of random signs.
//!
//! A query is a tie if the segment only touches the mesh (either answer is right), or if every winding number
//! abstains because the point lies on the volume (nothing is left to check the ray cast). Abstaining cannot
//! hide an error: the first ties of each round are decided again with big integers, and every abstention must
//! be confirmed by a triangle of the volume that contains the point.
//!
//! The same queries are answered as most programs do: facing by a cross product in `f32`, and visibility by
//! an `f32` triangle test.

mod minimize;
mod naive_f32;
mod repro;
mod round;
mod stratum;

#[cfg(test)]
mod tests;

#[cfg(feature = "files")]
pub use repro::ReproError;
pub use repro::{Repro, Ruling};

use crate::geom::Aabb;
use crate::parallel;
use crate::random::SplitMix64;
use crate::testing::generate::Draw;
use crate::verify::Tally;
use round::{Prepared, Seam};
use stratum::{RECIPES, Recipe};

/// How many queries, from which seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// How many queries, spread evenly over the strata.
    pub queries: u64,
    /// The seed of all random numbers; the same seed gives the same queries.
    pub seed: u64,
    /// How many disagreements to keep.
    pub keep: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Self { queries: 1_000_000, seed: 1, keep: 10 }
    }
}

/// The result of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Torture {
    /// One row per stratum.
    pub strata: Vec<Outcomes>,
    /// The first disagreements: by stratum, then by round, then by query.
    pub disagreements: Vec<Contradiction>,
    /// The first of them, minimized: as few faces and as simple coordinates as were found.
    pub case: Option<Repro>,
}

/// Counts over the queries of one stratum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outcomes {
    /// The name of the stratum.
    pub name: &'static str,
    /// The number of queries.
    pub queries: u64,
    /// Those that graze or abstain: nothing is left to check the ray cast.
    pub ties: u64,
    /// Those whose segment to the light only touches the mesh: either answer is right.
    pub grazing: u64,
    /// Those where every winding number abstains, because the point lies on its volume.
    pub abstained: u64,
    /// Those where methods contradict each other.
    pub wrong: u64,
    /// Those that do not graze and where plain `f32` confuses lit and shadowed.
    pub plain_f32_wrong: u64,
    /// Faces of all rounds.
    pub faces: u64,
    /// Faces whose side by the filter differs from that by the predicate.
    pub faces_wrong: u64,
    /// Faces whose side is wrong in plain `f32`.
    pub plain_f32_faces_wrong: u64,
    /// Volumes that were checked to be closed.
    pub volumes: u64,
    /// Those of them that are not closed.
    pub open_volumes: u64,
    /// Queries that were decided again with big integers.
    pub judged_by_whole_numbers: u64,
    /// Rounds in which at least one query was not a tie.
    pub rounds: u64,
}

/// A query where methods contradict each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// The stratum, as the index of its row.
    pub stratum: usize,
    /// The round of that stratum, from 0.
    pub round: u64,
    /// The query of that round, from 0. The first one represents a fault of the whole round.
    pub query: u64,
    /// Mesh, light and point.
    pub case: Repro,
    /// What each method answered.
    pub said: Vec<String>,
}

impl Torture {
    /// Whether no method contradicts another in a query or at a face, and all volumes are closed.
    #[must_use]
    pub fn agrees(&self) -> bool {
        let total = self.total();
        total.wrong == 0 && total.faces_wrong == 0 && total.open_volumes == 0
    }

    /// The sum over all strata.
    #[must_use]
    pub fn total(&self) -> Outcomes {
        self.strata.iter().fold(Outcomes { name: "all", ..Outcomes::default() }, |sum, row| sum.plus(row))
    }

    /// See [`Tally::bound_95`], if these queries were independent draws. They are not: up to 256 of them
    /// share a mesh, a light and a volume. [`Torture::bound_95_rounds`] claims no more than is drawn
    /// independently.
    #[must_use]
    pub fn bound_95(&self) -> Option<f64> {
        self.total().tally().bound_95().filter(|_| self.agrees())
    }

    /// The same by rounds, which are drawn independently: less than this fraction of such rounds holds a
    /// contradiction.
    #[must_use]
    pub fn bound_95_rounds(&self) -> Option<f64> {
        let rounds = self.total().rounds;
        Tally { queries: rounds, judged: rounds, ..Tally::default() }.bound_95().filter(|_| self.agrees())
    }
}

impl Outcomes {
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

    /// The counts as those of any verification.
    #[must_use]
    pub fn tally(&self) -> Tally {
        let Self { queries, ties, wrong, .. } = *self;
        Tally { queries, ties, judged: queries - ties, wrong }
    }
}

/// Queries per round.
const POINTS: u64 = 256;

/// The halved volume is checked in every eighth round: proving that it is right costs as much as a round.
const HALF_EVERY: u64 = 8;

/// One query is decided with big integers in the first four rounds, and in every fourth after them.
const WHOLE_EVERY: u64 = 4;

/// Runs adversarial queries. `progress` is called with numbers of finished queries, from any thread.
///
/// Costs about two microseconds of one core per query. Memory does not grow with the number of queries.
///
/// ```
/// use umbrage::testing::torture::{Effort, run};
/// let found = run(&Effort { queries: 10_000, ..Effort::default() }, &|_| {});
/// assert!(found.agrees() && found.total().queries == 10_000);
/// ```
#[must_use]
pub fn run(effort: &Effort, progress: &(dyn Fn(u64) + Sync)) -> Torture {
    run_with(effort, progress, Seam::SOUND)
}

/// As [`run`], with an injected fault: tests show with it that a fault is found.
fn run_with(effort: &Effort, progress: &(dyn Fn(u64) + Sync), seam: Seam) -> Torture {
    let strata = RECIPES.len() as u64;
    let quota = |stratum: u64| effort.queries / strata + u64::from(stratum < effort.queries % strata);
    let units = strata * quota(0).div_ceil(POINTS);
    let add = |mut rows: Rows, unit: u64| {
        let (stratum, round) = (unit % strata, unit / strata);
        let points = quota(stratum).saturating_sub(round * POINTS).min(POINTS);
        if points > 0 {
            rows.round(effort.seed, stratum as usize, round, points, seam);
            progress(points);
        }
        rows
    };
    let sum = parallel::sum(units, || Rows::new(effort.keep), add, Rows::plus);
    let case = sum.disagreements.first().map(|first| minimize::minimize(&first.case, seam));
    Torture { strata: sum.strata, disagreements: sum.disagreements, case }
}

/// What one thread has found so far.
struct Rows {
    strata: Vec<Outcomes>,
    disagreements: Vec<Contradiction>,
    keep: usize,
}

impl Rows {
    fn new(keep: usize) -> Self {
        let row = |recipe: &Recipe| Outcomes { name: recipe.name, ..Outcomes::default() };
        Self { strata: RECIPES.iter().map(row).collect(), disagreements: Vec::new(), keep }
    }

    fn plus(mut self, other: Self) -> Self {
        self.strata.iter_mut().zip(&other.strata).for_each(|(sum, row)| *sum = sum.plus(row));
        self.keep_first(other.disagreements);
        self
    }

    fn keep_first(&mut self, more: Vec<Contradiction>) {
        if !more.is_empty() {
            self.disagreements.extend(more);
            self.disagreements.sort_by_key(|found| (found.stratum, found.round, found.query));
            self.disagreements.truncate(self.keep);
        }
    }

    /// Draws one round, and runs it.
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

        // 3. Answers.
        let within = Aabb::around(points.iter().copied());
        let mut bench = prepared.bench(within);
        let found = prepared.found;
        let mut row = Outcomes {
            faces: found.faces,
            faces_wrong: found.faces_wrong,
            plain_f32_faces_wrong: found.plain_f32_faces_wrong,
            volumes: found.volumes,
            open_volumes: found.open_volumes,
            queries: points.len() as u64,
            ..Outcomes::default()
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
                let case = Repro { mesh: mesh.clone(), light, point, signs, within };
                let said = [found.say(), judged.say()].concat();
                disagreements.push(Contradiction { stratum, round, query: query as u64, case, said });
            }
        }
        row.rounds = u64::from(row.queries > row.ties);
        let sum = &mut self.strata[stratum];
        *sum = sum.plus(&row);
        self.keep_first(disagreements);
    }
}

/// A source of random numbers for one round, different from that of any other.
fn source(seed: u64, stratum: usize, round: u64) -> SplitMix64 {
    let of_stratum = SplitMix64(seed).next() ^ stratum as u64;
    SplitMix64(SplitMix64(SplitMix64(of_stratum).next() ^ round).next())
}
