//! Methods that take turns at the same queries, timed and compared with the truth.

use std::hint::black_box;
use std::time::{Duration, Instant};

use super::{Method, Row, Spread};
use crate::geom::Facing;
use crate::oracle::Verdict;

/// The answer of a method to one query.
pub(super) trait Answer: Copy + PartialEq {
    /// Whether this answer, as the truth, is a tie: a query with two right answers.
    fn is_tie(self) -> bool;
}

impl Answer for Facing {
    fn is_tie(self) -> bool {
        self == Self::EdgeOn
    }
}

impl Answer for Verdict {
    fn is_tie(self) -> bool {
        self == Self::Grazing
    }
}

/// A stratum of queries: its name and the true answers, one batch per light.
pub(super) struct Stratum<A> {
    pub(super) name: &'static str,
    pub(super) truth: Vec<Vec<A>>,
}

/// A function that answers the queries of one batch, at the method's sampling stride. The arguments are the
/// indices of the stratum and of the batch, and a buffer whose content is replaced.
pub(super) type Ask<'a, A> = Box<dyn FnMut(usize, usize, &mut Vec<A>) + 'a>;

/// A method under test.
pub(super) struct Contender<'a, A> {
    pub(super) name: &'static str,
    pub(super) exact: bool,
    pub(super) prepare_ns: Option<f64>,
    pub(super) every: usize,
    pub(super) ask: Ask<'a, A>,
}

/// Minimum time of one measurement, in nanoseconds: shorter work is repeated within a round.
const LEAST_NS: f64 = 2e6;
/// Maximum number of repetitions within a round.
const MOST_REPEATS: f64 = 64.0;

/// Checks and times the methods; the first one is the baseline. A warm-up round is compared with the truth,
/// then `rounds` rounds are timed. `progress` is called with 1 after each stratum.
pub(super) fn compare<A: Answer>(
    strata: &[Stratum<A>],
    contenders: &mut [Contender<'_, A>],
    rounds: u32,
    progress: &dyn Fn(u64),
) -> Vec<Method> {
    let (rounds, count) = (rounds.max(1) as usize, contenders.len());
    let mut answers = Vec::new();

    // 1. Compare with the truth, and determine how often each method has to be repeated.
    let mut rows = vec![Vec::with_capacity(strata.len()); count];
    let mut repeats = vec![Vec::with_capacity(strata.len()); count];
    for (index, stratum) in strata.iter().enumerate() {
        for (contender, (rows, repeats)) in contenders.iter_mut().zip(rows.iter_mut().zip(&mut repeats)) {
            let (row, took) = contender.judge(index, stratum, &mut answers);
            rows.push(row);
            repeats.push((LEAST_NS / (took.as_nanos() as f64 + 1.0)).ceil().clamp(1.0, MOST_REPEATS) as u32);
        }
        progress(1);
    }

    // 2. Time: the order changes with each round and stratum, so that no method always follows the same one.
    let mut times = vec![vec![Vec::with_capacity(rounds); strata.len()]; count];
    for round in 0..rounds {
        for (index, stratum) in strata.iter().enumerate() {
            let turn = round + index;
            for step in 0..count {
                let step = if turn % 2 == 0 { step } else { count - 1 - step };
                let who = (step + turn / 2) % count;
                let contender = &mut contenders[who];
                let took = contender.time(index, stratum.truth.len(), repeats[who][index], &mut answers);
                times[who][index].push(took);
            }
            progress(1);
        }
    }

    // 3. Nanoseconds per query, by stratum and over all strata.
    let totals: Vec<Vec<f64>> = times
        .iter()
        .zip(&rows)
        .map(|(times, rows)| {
            let queries = rows.iter().map(|row: &Row| row.queries).sum::<u64>().max(1) as f64;
            (0..rounds).map(|round| times.iter().map(|times| times[round]).sum::<f64>() / queries).collect()
        })
        .collect();
    let mut methods: Vec<Method> = Vec::with_capacity(count);
    for (who, (contender, mut strata)) in contenders.iter().zip(rows).enumerate() {
        for (row, times) in strata.iter_mut().zip(&times[who]) {
            row.time = Spread::of(times.iter().map(|time| time / row.queries.max(1) as f64).collect());
        }
        let ratios = totals[who].iter().zip(&totals[0]).map(|(time, baseline)| time / baseline.max(1e-9));
        methods.push(Method {
            name: contender.name,
            exact: contender.exact,
            prepare_ns: contender.prepare_ns,
            every: contender.every,
            ratio: Spread::of(ratios.collect()).median,
            dominated: false,
            total: total(&strata, Spread::of(totals[who].clone())),
            strata,
        });
    }
    mark_dominated(&mut methods);
    methods
}

impl<A: Answer> Contender<'_, A> {
    /// Answers all batches of a stratum once: the counts against the truth, and the time taken.
    fn judge(&mut self, index: usize, stratum: &Stratum<A>, answers: &mut Vec<A>) -> (Row, Duration) {
        let Stratum { name, truth } = stratum;
        let mut row = Row { name, queries: 0, ties: 0, judged: 0, wrong: 0, time: Spread::default() };
        let mut took = Duration::ZERO;
        for (batch, truth) in truth.iter().enumerate() {
            let start = Instant::now();
            (self.ask)(index, batch, answers);
            took += start.elapsed();
            let truth = truth.iter().step_by(self.every);
            debug_assert_eq!(truth.len(), answers.len(), "{} answers every question", self.name);
            for (&answer, &truth) in answers.iter().zip(truth) {
                let judged = self.exact || !truth.is_tie();
                row.queries += 1;
                row.ties += u64::from(truth.is_tie());
                row.judged += u64::from(judged);
                row.wrong += u64::from(judged && answer != truth);
            }
        }
        (row, took)
    }

    /// Time for all batches of a stratum, in nanoseconds.
    fn time(&mut self, stratum: usize, batches: usize, repeats: u32, answers: &mut Vec<A>) -> f64 {
        let start = Instant::now();
        for _ in 0..repeats {
            for batch in 0..batches {
                (self.ask)(stratum, batch, answers);
                black_box(&*answers);
            }
        }
        start.elapsed().as_nanos() as f64 / f64::from(repeats)
    }
}

/// The sum of all strata.
fn total(strata: &[Row], time: Spread) -> Row {
    let sum = |of: fn(&Row) -> u64| strata.iter().map(of).sum();
    Row {
        name: "all",
        queries: sum(|row| row.queries),
        ties: sum(|row| row.ties),
        judged: sum(|row| row.judged),
        wrong: sum(|row| row.wrong),
        time,
    }
}

/// Marks dominated methods, by median time and rate of wrong answers over all strata.
pub(super) fn mark_dominated(methods: &mut [Method]) {
    let costs: Vec<[f64; 2]> =
        methods.iter().map(|method| [method.total.time.median, method.total.error()]).collect();
    for (method, [time, error]) in methods.iter_mut().zip(&costs) {
        method.dominated = costs
            .iter()
            .any(|[other, wrong]| other <= time && wrong <= error && (other < time || wrong < error));
    }
}

/// Runs a preparation once: its result, and its time in nanoseconds per face.
pub(super) fn prepared<T>(faces: usize, prepare: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let value = black_box(prepare());
    (value, start.elapsed().as_nanos() as f64 / faces.max(1) as f64)
}
