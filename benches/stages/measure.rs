//! Interleaved rounds of methods that must all give the right answer.

use std::hint::black_box;
use std::time::{Duration, Instant};

use crate::report;

/// One run of a method: its time and its answer.
#[derive(Debug)]
pub(crate) struct Sample {
    elapsed: Duration,
    answer: String,
}

impl Sample {
    /// A sample timed by the caller: for work that returns its buffers after the answer has been read.
    pub(crate) fn new(elapsed: Duration, answer: String) -> Self {
        Self { elapsed, answer }
    }
}

/// Times `work` only: its input is prepared before, and `answer` is computed from its result afterwards.
pub(crate) fn timed<T>(work: impl FnOnce() -> T, answer: impl FnOnce(&T) -> String) -> Sample {
    let start = Instant::now();
    let result = black_box(work());
    let elapsed = start.elapsed();
    Sample { elapsed, answer: answer(&result) }
}

/// Time that a row should reach. Times are reported, never asserted, because machines differ.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    None,
    /// Nanoseconds per unit.
    Time(f64),
    /// Fraction of the baseline's time.
    Ratio(f64),
    /// Multiple of the time needed to move the row's bytes.
    Limits(f64),
    /// Multiple of the time of the best other method, which then is the row's baseline.
    Best(f64),
}

/// A method that does a group's work.
pub(crate) struct Contender<'a> {
    name: &'static str,
    expected: Option<String>,
    bytes: Option<f64>,
    target: Target,
    repeats: Option<&'static str>,
    run: Box<dyn FnMut() -> Sample + 'a>,
}

impl<'a> Contender<'a> {
    pub(crate) fn new(name: &'static str, run: impl FnMut() -> Sample + 'a) -> Self {
        Self { name, expected: None, bytes: None, target: Target::None, repeats: None, run: Box::new(run) }
    }

    /// A second copy of an earlier method. Its ratio over the earlier one shows the noise of ratios; it is
    /// compared with nothing else.
    pub(crate) fn repeats(self, name: &'static str) -> Self {
        Self { repeats: Some(name), ..self }
    }

    /// Sets the expected answer. Without it, all answers must only be equal.
    pub(crate) fn expects(self, answer: impl Into<String>) -> Self {
        Self { expected: Some(answer.into()), ..self }
    }

    /// Sets the bytes per unit that any program must read or write once: input and output.
    pub(crate) fn moves(self, bytes: f64) -> Self {
        Self { bytes: Some(bytes), ..self }
    }

    pub(crate) fn aims_at(self, target: Target) -> Self {
        Self { target, ..self }
    }

    fn sample(&mut self) -> f64 {
        let Sample { elapsed, answer } = (self.run)();
        let expected = self.expected.get_or_insert_with(|| answer.clone());
        assert_eq!(answer, *expected, "{} gives another answer", self.name);
        elapsed.as_nanos() as f64
    }
}

/// Methods for the same work; the first one is the baseline.
pub(crate) struct Group<'a> {
    pub(crate) stage: &'static str,
    pub(crate) mesh: String,
    /// Amount of work, in units of `unit`.
    pub(crate) units: usize,
    pub(crate) unit: &'static str,
    pub(crate) contenders: Vec<Contender<'a>>,
}

/// Times of one method, in nanoseconds per unit.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) stage: &'static str,
    pub(crate) mesh: String,
    pub(crate) units: usize,
    pub(crate) unit: &'static str,
    pub(crate) name: &'static str,
    pub(crate) median: f64,
    pub(crate) min: f64,
    pub(crate) max: f64,
    /// Median over the rounds of the method's time divided by the baseline's time in the same round; `None`
    /// for the baseline.
    pub(crate) ratio: Option<f64>,
    /// Time needed to move the row's bytes on this machine.
    pub(crate) limit: Option<f64>,
    pub(crate) target: Target,
    pub(crate) answer: String,
}

impl Row {
    pub(crate) fn meets_target(&self) -> Option<bool> {
        match self.target {
            Target::None => None,
            Target::Time(most) => Some(self.median <= most),
            Target::Ratio(most) | Target::Best(most) => self.ratio.map(|ratio| ratio <= most),
            Target::Limits(most) => self.limit.map(|limit| self.median <= most * limit),
        }
    }
}

/// The rows so far, and the options for more.
pub(crate) struct Bench<'a> {
    pub(crate) quick: bool,
    filter: &'a str,
    bytes_per_ns: f64,
    pub(crate) rows: Vec<Row>,
}

impl<'a> Bench<'a> {
    pub(crate) fn new(quick: bool, filter: &'a str, bytes_per_ns: f64) -> Self {
        Self { quick, filter, bytes_per_ns, rows: Vec::new() }
    }

    /// Whether the filter includes a stage.
    pub(crate) fn wants(&self, stage: &str) -> bool {
        stage.contains(self.filter)
    }

    /// Runs a group and prints its rows.
    pub(crate) fn run(&mut self, group: Group<'_>) {
        let rounds = if self.quick { 2 } else { 9 };
        let table = report::table(self.measure(group, rounds));
        // A closed pipe is no error; the answers are still asserted.
        let _ = report::print(&table);
    }

    /// Runs a group and returns its rows.
    ///
    /// After a warm-up round, every method runs once per round (a short one several times). The order changes
    /// each round, so that no method always follows the same one. A short method runs once more before its
    /// timed runs, untimed: its predecessor may have emptied the caches.
    pub(crate) fn measure(&mut self, mut group: Group<'_>, rounds: usize) -> &[Row] {
        let least = if self.quick { 0.0 } else { 2e7 };
        let count = group.contenders.len();
        let runs: Vec<u32> = group
            .contenders
            .iter_mut()
            .map(|c| (least / c.sample()).ceil().clamp(1.0, 32.0) as u32)
            .collect();
        let mut times = vec![Vec::new(); count];
        for round in 0..rounds {
            for step in 0..count {
                let step = if round % 2 == 0 { step } else { count - 1 - step };
                let index = (step + round / 2) % count;
                let contender = &mut group.contenders[index];
                if runs[index] > 1 {
                    contender.sample();
                }
                let total: f64 = (0..runs[index]).map(|_| contender.sample()).sum();
                times[index].push(total / f64::from(runs[index]) / group.units as f64);
            }
        }
        let first = self.rows.len();
        let names: Vec<_> = group.contenders.iter().map(|contender| contender.name).collect();
        let repeats: Vec<_> = group
            .contenders
            .iter()
            .map(|contender| names.iter().position(|&name| Some(name) == contender.repeats))
            .collect();
        for (index, contender) in group.contenders.into_iter().enumerate() {
            let baseline = match (repeats[index], contender.target) {
                (Some(same), _) => same,
                (None, Target::Best(_)) => {
                    best_of(&times, |other| other != index && repeats[other].is_none())
                }
                _ => 0,
            };
            let ratios = times[index].iter().zip(&times[baseline]).map(|(time, baseline)| time / baseline);
            self.rows.push(Row {
                stage: group.stage,
                mesh: group.mesh.clone(),
                units: group.units,
                unit: group.unit,
                name: contender.name,
                median: median(times[index].iter().copied()),
                min: times[index].iter().copied().fold(f64::INFINITY, f64::min),
                max: times[index].iter().copied().fold(0.0, f64::max),
                ratio: (index > 0).then(|| median(ratios)),
                limit: contender.bytes.map(|bytes| bytes / self.bytes_per_ns),
                // Times of small meshes mean nothing.
                target: if self.quick { Target::None } else { contender.target },
                answer: contender.expected.expect("it ran"),
            });
        }
        &self.rows[first..]
    }
}

/// Index of the method with the smallest median among those that `is_one` selects.
fn best_of(times: &[Vec<f64>], is_one: impl Fn(usize) -> bool) -> usize {
    let of = |&index: &usize| median(times[index].iter().copied());
    (0..times.len()).filter(|&index| is_one(index)).min_by(|a, b| of(a).total_cmp(&of(b))).unwrap_or(0)
}

/// The median; for an even number of values the mean of the two in the middle.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { (values[half - 1] + values[half]) / 2.0 }
}

/// SplitMix64 (Steele, Lea and Flood, 2014): scattered points, the same in every run.
#[derive(Debug)]
pub(crate) struct Scatter(pub(crate) u64);

impl Scatter {
    /// The next number in [−1, 1).
    pub(crate) fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    }

    pub(crate) fn point(&mut self, reach: f32) -> [f32; 3] {
        std::array::from_fn(|_| self.next() * reach)
    }
}
