//! Interleaved rounds of contenders that must all give the right answer.

use std::hint::black_box;
use std::time::{Duration, Instant};

use crate::report;

/// One run of a contender.
#[derive(Debug)]
pub(crate) struct Sample {
    elapsed: Duration,
    answer: String,
}

impl Sample {
    /// For work that gives back what it was given, once its answer is read.
    pub(crate) fn new(elapsed: Duration, answer: String) -> Self {
        Self { elapsed, answer }
    }
}

/// Times `work` alone: what it needs is made before, and `answer` is read off its result afterwards.
pub(crate) fn timed<T>(work: impl FnOnce() -> T, answer: impl FnOnce(&T) -> String) -> Sample {
    let start = Instant::now();
    let result = black_box(work());
    let elapsed = start.elapsed();
    Sample { elapsed, answer: answer(&result) }
}

/// What a row should reach. A timing is reported, never asserted: machines differ.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    None,
    /// Nanoseconds a unit.
    Time(f64),
    /// Of the baseline's time.
    Ratio(f64),
    /// Of the time that moving its bytes takes.
    Limits(f64),
    /// Of the time of the best of the others, which is then what the row is compared with.
    Best(f64),
}

/// One way to do a group's work.
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

    /// The same as an earlier contender, made once more: its ratio over that one tells how far ratios are to be believed,
    /// and nothing else is compared with it.
    pub(crate) fn repeats(self, name: &'static str) -> Self {
        Self { repeats: Some(name), ..self }
    }

    /// What the answer must be. Without this it must only stay the same.
    pub(crate) fn expects(self, answer: impl Into<String>) -> Self {
        Self { expected: Some(answer.into()), ..self }
    }

    /// Bytes a unit that any program must read or write once: input and output, each a single time.
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

/// Contenders for the same work; the first is the baseline of the others.
pub(crate) struct Group<'a> {
    pub(crate) stage: &'static str,
    pub(crate) mesh: String,
    /// How many units the work has, and what they are.
    pub(crate) units: usize,
    pub(crate) unit: &'static str,
    pub(crate) contenders: Vec<Contender<'a>>,
}

/// What was measured of one contender. Times are nanoseconds a unit.
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
    /// Median over the rounds of its time over the baseline's in the same round; `None` for the baseline.
    pub(crate) ratio: Option<f64>,
    /// The time that moving its bytes takes on this machine.
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

/// All rows so far, and how to make more.
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

    /// Whether the filter lets a stage pass.
    pub(crate) fn wants(&self, stage: &str) -> bool {
        stage.contains(self.filter)
    }

    /// Runs a group and prints its rows.
    pub(crate) fn run(&mut self, group: Group<'_>) {
        let rounds = if self.quick { 2 } else { 9 };
        let table = report::table(self.measure(group, rounds));
        // A reader who closes the pipe has seen enough; the answers are still asserted.
        let _ = report::print(&table);
    }

    /// Runs a group, for its rows.
    ///
    /// One round to warm up, then rounds in which every contender runs once (a short one several times), each
    /// round in another order, so that no contender always follows the same one. A short one runs once more before
    /// that, untimed: a scan of everything empties the caches, and whoever follows it would pay for that.
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
                // Of small meshes times mean nothing.
                target: if self.quick { Target::None } else { contender.target },
                answer: contender.expected.expect("it ran"),
            });
        }
        &self.rows[first..]
    }
}

/// Which of these contenders has the least median.
fn best_of(times: &[Vec<f64>], is_one: impl Fn(usize) -> bool) -> usize {
    let of = |&index: &usize| median(times[index].iter().copied());
    (0..times.len()).filter(|&index| is_one(index)).min_by(|a, b| of(a).total_cmp(&of(b))).unwrap_or(0)
}

/// The middle value; of an even number the mean of the two in the middle.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { (values[half - 1] + values[half]) / 2.0 }
}

/// SplitMix64 (Steele, Lea and Flood, 2014), for scattered points that are the same in every run.
#[derive(Debug)]
pub(crate) struct Scatter(pub(crate) u64);

impl Scatter {
    /// In [−1, 1).
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
