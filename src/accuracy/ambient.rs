//! Error against time of ambient occlusion, on one mesh or several.

use std::fmt;

use super::Spread;
use super::shadow::timed;
use crate::ambient::disks::{Disks, Emitters, Literal, LiteralForm, Passes};
use crate::ambient::{Ambient, Effort, Per, RayOptions, Receiver, Receivers, Ring, exact_part};
use crate::mesh::Mesh;
use crate::oracle::Oracle;
use crate::oracle::area::SoftOracle;

/// A way to work out ambient occlusion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AmbientMethod {
    /// The mean of the truth everywhere: what a method has to beat.
    Constant,
    /// Exact rays.
    Rays {
        /// Rays from each receiver.
        rays: u32,
        /// Whether neighbors share their values.
        ring: bool,
    },
    /// Disks in a tree.
    Disks(Passes, Emitters),
    /// All disks, by the formula of a tutorial.
    Literal(LiteralForm),
    /// The analytic form. It is the truth, so its error is 0.
    Exact,
}

/// Error and time of one method.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AmbientRow {
    /// The method.
    pub method: AmbientMethod,
    /// Mean of the absolute difference between openness and the truth.
    pub mean_error: f64,
    /// Root of the mean of its square.
    pub rms_error: f64,
    /// 99 of 100 differences are at most this.
    pub p99_error: f64,
    /// Time for what stays valid for other receivers, in milliseconds: the tree of the rays, that of the
    /// disks.
    pub prepare_ms: f64,
    /// Nanoseconds per receiver. Passes over the disks are shared by all receivers of the meshes, and rays
    /// include the estimate of their own error.
    pub ns_per_receiver: Spread,
    /// A method that is at least as fast and has at most the same mean error, and is better in one of the
    /// two.
    pub dominated_by: Option<AmbientMethod>,
}

/// The truth that methods are compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AmbientTruth {
    /// No value of the truth is off by more than this.
    pub bound: f64,
}

/// Errors and times of all methods.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AmbientAccuracy {
    /// Receivers of the meshes: one for each position and normal.
    pub receivers: usize,
    /// Receivers that were compared, evenly spaced among all.
    pub judged: usize,
    /// The truth.
    pub truth: AmbientTruth,
    /// One row per method, in the order asked for.
    pub rows: Vec<AmbientRow>,
}

/// Amount of measuring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AmbientOptions {
    /// Receivers that are compared with the truth, at most.
    pub receivers: usize,
    /// Seed of the rays.
    pub seed: u64,
    /// Number of timed rounds, at least one.
    pub rounds: u32,
}

impl Default for AmbientOptions {
    fn default() -> Self {
        Self { receivers: 1000, seed: 1, rounds: 5 }
    }
}

impl AmbientMethod {
    /// The methods that are measured unless others are asked for.
    #[must_use]
    pub fn usual() -> Vec<Self> {
        let rays =
            [4, 16, 64, 256].into_iter().flat_map(|rays| [false, true].map(|ring| Self::Rays { rays, ring }));
        let disks =
            [1, 2, 4].map(|passes| Self::Disks(Passes { passes, ..Passes::default() }, Emitters::Vertices));
        let literal = [LiteralForm::AsPrinted, LiteralForm::AreaRestored].map(Self::Literal);
        [Self::Constant].into_iter().chain(rays).chain(disks).chain(literal).chain([Self::Exact]).collect()
    }

    /// Short name: that of the command line, for those that it takes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Rays { .. } => "rays",
            Self::Disks(..) => "disks",
            Self::Literal(_) => "literal",
            Self::Exact => "exact",
        }
    }

    /// Names and values of its options.
    #[must_use]
    pub fn parameters(self) -> Vec<(&'static str, String)> {
        match self {
            Self::Constant | Self::Exact => Vec::new(),
            Self::Rays { rays, ring } => {
                let smooth = if ring { "ring" } else { "none" };
                vec![("rays", rays.to_string()), ("smooth", smooth.to_owned())]
            }
            Self::Disks(Passes { theta, passes, damped }, emitters) => {
                let emitters = match emitters {
                    Emitters::Vertices => "vertices",
                    Emitters::Faces => "faces",
                };
                let damped = if damped { "yes" } else { "no" };
                vec![
                    ("theta", theta.to_string()),
                    ("passes", passes.to_string()),
                    ("damped", damped.to_owned()),
                    ("emitters", emitters.to_owned()),
                ]
            }
            Self::Literal(form) => {
                let area = if form == LiteralForm::AsPrinted { "cancelled" } else { "restored" };
                vec![("area", area.to_owned())]
            }
        }
    }
}

impl fmt::Display for AmbientMethod {
    /// The name, and after it the options: `rays:rays=16,smooth=ring`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        for (index, (key, value)) in self.parameters().iter().enumerate() {
            write!(f, "{}{key}={value}", if index == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}

impl AmbientAccuracy {
    /// Measures methods at the receivers of meshes in one space, on the CPU. `None` if there are no faces.
    ///
    /// `progress` is called with the number of steps done: one for the truth, and one per method.
    ///
    /// ```
    /// use umbrage::accuracy::{AmbientAccuracy, AmbientMethod, AmbientOptions};
    /// use umbrage::testing::shapes;
    /// let torus = shapes::torus(20, 10, 2.0, 0.7);
    /// let methods = [4, 64].map(|rays| AmbientMethod::Rays { rays, ring: false });
    /// let options = AmbientOptions { receivers: 50, seed: 1, rounds: 1 };
    /// let found = AmbientAccuracy::measure(&[&torus], &methods, &options, &|_| {}).unwrap();
    /// assert!(found.truth.bound < 1e-9 && found.judged == 50 && found.receivers == 200);
    /// assert!(found.rows[1].mean_error < found.rows[0].mean_error);
    /// ```
    ///
    /// # Panics
    ///
    /// As [`Receivers::of`].
    #[must_use]
    pub fn measure(
        meshes: &[&Mesh],
        methods: &[AmbientMethod],
        options: &AmbientOptions,
        progress: &dyn Fn(u64),
    ) -> Option<Self> {
        let all = Receivers::of(meshes, Per::Corner);
        let chosen = all.spread(options.receivers.max(1));
        let only = all.only(&chosen);
        if chosen.is_empty() {
            return None;
        }
        let (oracle, oracle_ms) = timed(|| Oracle::over(meshes));
        let (soft, weld_ms) = timed(|| SoftOracle::new(&oracle));
        let (truth, truth_ms) = timed(|| exact_part(&soft, &only, 0..only.list().len()));
        progress(1);
        let of = Measuring { meshes, all: &all, chosen: &chosen, only: &only, oracle: &oracle, options };
        let mut rows = Vec::with_capacity(methods.len());
        for &method in methods {
            let found = match method {
                AmbientMethod::Constant => {
                    let mean = truth.openness.iter().sum::<f64>() / chosen.len() as f64;
                    Found { values: vec![mean; chosen.len()], prepare_ms: 0.0, ns: vec![0.0] }
                }
                AmbientMethod::Exact => {
                    let ns = vec![1e6 * truth_ms / chosen.len() as f64];
                    Found { values: truth.openness.clone(), prepare_ms: oracle_ms + weld_ms, ns }
                }
                AmbientMethod::Rays { rays, ring } => Found { prepare_ms: oracle_ms, ..of.rays(rays, ring) },
                AmbientMethod::Disks(passes, emitters) => of.disks(&passes, emitters),
                AmbientMethod::Literal(form) => of.literal(form),
            };
            rows.push(row(method, found, &truth.openness));
            progress(1);
        }
        mark_dominated(&mut rows);
        let truth = AmbientTruth { bound: truth.bound };
        Some(Self { receivers: all.list().len(), judged: chosen.len(), truth, rows })
    }
}

/// What a method says at the chosen receivers, and how long it took.
struct Found {
    values: Vec<f64>,
    prepare_ms: f64,
    /// Nanoseconds per receiver of each round.
    ns: Vec<f64>,
}

struct Measuring<'a> {
    meshes: &'a [&'a Mesh],
    all: &'a Receivers,
    chosen: &'a [u32],
    /// The chosen ones.
    only: &'a Receivers,
    oracle: &'a Oracle,
    options: &'a AmbientOptions,
}

impl Measuring<'_> {
    fn rays(&self, rays: u32, ring: bool) -> Found {
        let options = RayOptions {
            effort: Effort::Rays(rays),
            seed: self.options.seed,
            ring: if ring { Ring::On } else { Ring::Off },
            ..RayOptions::default()
        };
        let around = ring.then(|| self.all.around(self.chosen));
        let (receivers, at) = match &around {
            Some((receivers, at)) => (receivers, Some(at)),
            None => (self.only, None),
        };
        let cast = || Ambient::by_rays(self.oracle, receivers, &options, &|_| {}).0.openness;
        let (all, ns) = self.rounds(receivers.list().len(), cast);
        let values = match at {
            Some(at) => at.iter().map(|&index| all[index as usize]).collect(),
            None => all,
        };
        Found { values, prepare_ms: 0.0, ns }
    }

    fn disks(&self, passes: &Passes, emitters: Emitters) -> Found {
        let (mut disks, prepare_ms) = timed(|| Disks::of(self.meshes, emitters));
        let ((), passes_ms) = timed(|| disks.run(passes));
        let before = 1e6 * passes_ms / self.all.list().len() as f64;
        let list = self.only.list();
        let (values, ns) = self.rounds(list.len(), || disks.openness(list).openness);
        Found { values, prepare_ms, ns: ns.into_iter().map(|ns| before + ns).collect() }
    }

    fn literal(&self, form: LiteralForm) -> Found {
        let (literal, prepare_ms) = timed(|| Literal::of(self.meshes, form));
        let list: &[Receiver] = self.only.list();
        let (values, ns) = self.rounds(list.len(), || literal.openness(list));
        Found { values, prepare_ms, ns }
    }

    /// The values of a warm-up round, and nanoseconds per receiver of the timed rounds.
    fn rounds(&self, receivers: usize, work: impl Fn() -> Vec<f32>) -> (Vec<f64>, Vec<f64>) {
        let values = work().into_iter().map(f64::from).collect();
        let round = |_| 1e6 * timed(&work).1 / receivers as f64;
        (values, (0..self.options.rounds.max(1)).map(round).collect())
    }
}

fn row(method: AmbientMethod, found: Found, truth: &[f64]) -> AmbientRow {
    let mut errors: Vec<f64> =
        found.values.iter().zip(truth).map(|(value, truth)| (value - truth).abs()).collect();
    errors.sort_by(f64::total_cmp);
    let count = errors.len() as f64;
    // As in a table of shadows: the error that 99 in 100 do not exceed.
    let p99 = errors[(errors.len() * 99).div_ceil(100) - 1];
    AmbientRow {
        method,
        mean_error: errors.iter().sum::<f64>() / count,
        rms_error: (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt(),
        p99_error: p99,
        prepare_ms: found.prepare_ms,
        ns_per_receiver: Spread::of(found.ns),
        dominated_by: None,
    }
}

/// Of several dominating methods the fastest is named.
fn mark_dominated(rows: &mut [AmbientRow]) {
    let costs: Vec<(AmbientMethod, f64, f64)> =
        rows.iter().map(|row| (row.method, row.ns_per_receiver.median, row.mean_error)).collect();
    for (row, &(_, time, error)) in rows.iter_mut().zip(&costs) {
        let better = costs.iter().filter(|&&(_, other, errors)| {
            other <= time && errors <= error && (other < time || errors < error)
        });
        row.dominated_by = better.min_by(|a, b| a.1.total_cmp(&b.1)).map(|&(method, ..)| method);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    fn measured(mesh: &Mesh, receivers: usize) -> AmbientAccuracy {
        let options = AmbientOptions { receivers, seed: 1, rounds: 1 };
        AmbientAccuracy::measure(&[mesh], &AmbientMethod::usual(), &options, &|_| {}).unwrap()
    }

    #[test]
    fn accuracy_of_ambient_has_a_row_per_method_and_errors_fall_with_rays() {
        for mesh in [shapes::menger_sponge(1), shapes::torus(30, 16, 2.0, 1.2)] {
            let found = measured(&mesh, 60);
            let methods: Vec<AmbientMethod> = found.rows.iter().map(|row| row.method).collect();
            assert_eq!(methods, AmbientMethod::usual());
            assert!(found.judged == 60 && found.receivers > 60 && found.truth.bound < 1e-9);
            let error = |method| found.rows.iter().find(|row| row.method == method).unwrap().mean_error;
            let rays = [4, 16, 64, 256].map(|rays| error(AmbientMethod::Rays { rays, ring: false }));
            assert!(rays.is_sorted_by(|more, less| more > less) && rays[3] < 0.006, "{rays:?}");
            // The sabotage: what knows nothing of the shape is far off.
            assert!(error(AmbientMethod::Constant) > 4.0 * rays[2]);
            assert_eq!(error(AmbientMethod::Exact), 0.0);
            for row in &found.rows {
                assert!(row.mean_error <= row.rms_error && row.rms_error <= row.p99_error.max(row.rms_error));
                assert!(row.mean_error <= row.p99_error || row.p99_error == 0.0, "{row:?}");
            }
        }
    }

    #[test]
    fn accuracy_of_ambient_repeats_itself_but_for_times() {
        let torus = shapes::torus(10, 6, 2.0, 0.7);
        let errors = |found: &AmbientAccuracy| {
            found.rows.iter().map(|row| [row.mean_error, row.rms_error, row.p99_error]).collect::<Vec<_>>()
        };
        let known = errors(&measured(&torus, 12));
        assert_eq!(errors(&measured(&torus, 12)), known);
        // The sabotage: other receivers have other errors.
        assert_ne!(errors(&measured(&torus, 13)), known);
        let empty = Mesh::new(Vec::new(), Vec::new()).unwrap();
        assert_eq!(AmbientAccuracy::measure(&[&empty], &[], &AmbientOptions::default(), &|_| {}), None);
    }

    #[test]
    fn accuracy_of_ambient_marks_what_is_slower_and_not_nearer_to_the_truth() {
        let made = |rays, ns: f64, error: f64| {
            let method = AmbientMethod::Rays { rays, ring: false };
            row(method, Found { values: vec![error], prepare_ms: 0.0, ns: vec![ns] }, &[0.0])
        };
        let mut rows = [made(1, 2.0, 0.0), made(2, 3.0, 0.0), made(3, 1.0, 0.5), made(4, 1.0, 0.25)];
        mark_dominated(&mut rows);
        let by = |rays| Some(AmbientMethod::Rays { rays, ring: false });
        assert_eq!(rows.map(|row| row.dominated_by), [None, by(1), by(4), None]);
    }
}
