//! Error against time: how often each method is wrong and what it costs, on the same queries.
//!
//! Methods take turns within each round, in a different order each round, on one thread. Reports give medians
//! over the rounds with their spread. Every answer is compared with the truth, which comes from big integers
//! and shares no code with the predicates. Queries are drawn from strata, because the kind of a query decides
//! both error and time: for arbitrary queries `f32` is nearly always right, and a filter nearly always
//! decides.
//!
//! A tie is a query with two right answers: a face exactly edge-on, a shadow ray that only touches the mesh.
//! A method that knows no ties may give either answer; an exact method has to declare the tie.

mod ambient;
mod compare;
mod facing;
mod lights;
mod plain;
mod points;
mod shadow;
#[cfg(feature = "gpu")]
mod shadow_device;
#[cfg(test)]
mod tests;
mod visibility;

pub use ambient::{AmbientAccuracy, AmbientMethod, AmbientOptions, AmbientRow, AmbientTruth};
pub use shadow::{ShadowAccuracy, ShadowRow};

use crate::geom::Light;
use crate::mesh::Mesh;
use crate::verify::Tally;

/// Maximum number of given lights used: from a longer list this many are taken, evenly spaced.
pub const MOST_LIGHTS: usize = 16;

/// The quantity that the methods compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// Which side of a face a light is on. A query is one face and one light.
    Facing,
    /// Whether a point is in shadow. A query is one point and one light.
    Visibility,
}

/// Amount of measuring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Approximate number of queries per stratum. For facing, enough lights are drawn to reach this number,
    /// each queried with all faces.
    pub queries: u64,
    /// Seed of the lights and points: the same seed gives the same answers.
    pub seed: u64,
    /// Number of timed rounds, at least one.
    pub rounds: u32,
}

/// Result of measuring one question.
#[derive(Clone, Debug, PartialEq)]
pub struct Accuracy {
    /// All methods. The first one, plain `f32`, is the baseline of the others.
    pub methods: Vec<Method>,
    /// Number of queries whose truth was decided with big integers against all faces; the others were decided
    /// against the faces that a tree does not cull. `None` if no tree is involved.
    pub judged_by_all_faces: Option<u64>,
}

/// Errors and times of one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Short name, for tables and charts.
    pub name: &'static str,
    /// Whether the method claims to be always right, ties included.
    pub exact: bool,
    /// Preparation time per mesh, in nanoseconds per face; measured once.
    pub prepare_ns: Option<f64>,
    /// Sampling stride: 1 for every query, more for slow methods.
    pub every: usize,
    /// Median over the rounds of the method's time per query, divided by the baseline's time in the same
    /// round.
    pub ratio: f64,
    /// Whether another method is at least as fast and at least as often right, and strictly better in one of
    /// the two.
    pub dominated: bool,
    /// One row per stratum, in the order of [`Question::strata`].
    pub strata: Vec<Row>,
    /// Sum over all strata.
    pub total: Row,
}

/// Errors and times of one method on the queries of one stratum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Name of the stratum.
    pub name: &'static str,
    /// Number of queries.
    pub queries: u64,
    /// Queries with two right answers.
    pub ties: u64,
    /// Queries on which the method can be wrong: all for an exact method; for others those that are not ties.
    pub judged: u64,
    /// Wrong answers.
    pub wrong: u64,
    /// Nanoseconds per query.
    pub time: Spread,
}

/// A time over the rounds, in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The fastest round.
    pub min: f64,
    /// The slowest round.
    pub max: f64,
}

impl Question {
    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Facing => "facing",
            Self::Visibility => "visibility",
        }
    }

    /// Default number of queries per stratum: takes some seconds on a mesh of 10⁵ faces.
    #[must_use]
    pub fn usual_queries(self) -> u64 {
        match self {
            Self::Facing => 1_000_000,
            Self::Visibility => 10_000,
        }
    }

    /// Names of the strata.
    ///
    /// Facing, by the light:
    ///
    /// - `given`: the lights given by the user;
    /// - `general`: a point in a box five times as large as the mesh;
    /// - `vertex`: on a vertex; `face_plane`: in the plane of a face, rounded;
    /// - `one_ulp_off`: off a vertex, an edge or a plane by one ulp in one, two or three coordinates;
    /// - `far`: 2³⁰ to 2⁴⁰ diagonals away;
    /// - `axis`: directional, along an axis; `along_face`: directional, along an edge or in a face's plane.
    ///
    /// Visibility, by the point, under the lights given by the user:
    ///
    /// - those of [`verify::points`](crate::verify::points::STRATA): `box`, `near_face`, `shadow_boundary`,
    ///   `face_plane`, `vertex_or_edge`;
    /// - `behind_vertex`, `behind_edge`: up to rounding, the segment to the light passes through a vertex, or
    ///   through a point of an edge.
    #[must_use]
    pub fn strata(self) -> Vec<&'static str> {
        match self {
            Self::Facing => lights::STRATA.map(|(name, _)| name).to_vec(),
            Self::Visibility => points::STRATA.to_vec(),
        }
    }

    /// Number of steps that [`Question::measure`] reports.
    #[must_use]
    pub fn steps(self, options: &Options) -> u64 {
        // The truth, a warm-up round, and the timed rounds.
        self.strata().len() as u64 * (u64::from(options.rounds.max(1)) + 2)
    }

    /// Measures all methods on `mesh`, which must be welded. `None` if the mesh has no faces, or there are no
    /// lights.
    ///
    /// `progress` is called with the number of steps done, [`Question::steps`] in all. Memory: one byte per
    /// query, and for visibility also the query's point.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::testing::shapes;
    /// use umbrage::accuracy::{Options, Question};
    /// let lights = [Light::point([2.0, 3.0, 5.0])?];
    /// let options = Options { queries: 1000, seed: 1, rounds: 1 };
    /// let torus = shapes::torus(20, 10, 2.0, 0.7);
    /// let found = Question::Facing.measure(&torus, &lights, &options, &|_| {}).unwrap();
    /// assert!(found.exact_is_right());
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn measure(
        self,
        mesh: &Mesh,
        lights: &[Light],
        options: &Options,
        progress: &dyn Fn(u64),
    ) -> Option<Accuracy> {
        if mesh.face_count() == 0 || lights.is_empty() {
            return None;
        }
        Some(match self {
            Self::Facing => facing::measure(mesh, lights, options, progress),
            Self::Visibility => visibility::measure(mesh, lights, options, progress),
        })
    }
}

impl Accuracy {
    /// Whether no exact method gave a wrong answer.
    #[must_use]
    pub fn exact_is_right(&self) -> bool {
        self.methods.iter().all(|method| !method.exact || method.total.wrong == 0)
    }
}

impl Row {
    /// The counts as those of any verification.
    #[must_use]
    pub fn tally(&self) -> Tally {
        let Self { queries, ties, judged, wrong, .. } = *self;
        Tally { queries, ties, judged, wrong }
    }

    /// Wrong answers per judged query.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.tally().error()
    }

    /// See [`Tally::bound_95`]. The queries of one mesh share its surface and its lights.
    #[must_use]
    pub fn bound_95(&self) -> Option<f64> {
        self.tally().bound_95()
    }
}

impl Spread {
    /// Spread of at least one value. The median of an even number of values is the mean of the two in the
    /// middle.
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let (half, last) = (values.len() / 2, values.len() - 1);
        let median =
            if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) };
        Self { median, min: values[0], max: values[last] }
    }
}
