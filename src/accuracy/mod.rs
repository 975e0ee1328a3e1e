//! Error against time: how often each way to answer a question is wrong, beside what it costs, on the same questions.
//!
//! The ways (methods) take turns within each round, each round in another order, on one thread; medians over the rounds
//! are reported with their spread. Every answer is held against the truth, which comes from whole numbers and shares no
//! code with the predicates. Questions are drawn by kinds (strata), since the kind decides both error and time: where
//! nothing is aimed at, `f32` is nearly always right and a filter nearly always enough.
//!
//! A tie is a question with two right answers: a face exactly edge-on, a way to the light that only touches. A method
//! that knows no ties may give either answer; an exact one has to declare the tie.

mod compare;
mod facing;
mod lights;
mod plain;
mod points;
mod shadow;
#[cfg(test)]
mod tests;
mod visibility;

pub use shadow::{ShadowAccuracy, ShadowRow};

use crate::geom::Light;
use crate::mesh::Mesh;
use crate::verify::Tally;

/// Of more lights than these as many are taken, evenly spread over all of them.
pub const MOST_LIGHTS: usize = 16;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// Which side of a face a light is on. A query is one face and one light.
    Facing,
    /// Whether a point is in shadow. A query is one point and one light.
    Visibility,
}

/// How much to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// About how many queries a stratum: of facing as many lights as this takes, each with all faces.
    pub queries: u64,
    /// What lights and points are drawn from; the same seed gives the same answers.
    pub seed: u64,
    /// How many rounds are timed, at least one.
    pub rounds: u32,
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Accuracy {
    /// The first one is the baseline of the others: plain `f32`.
    pub methods: Vec<Method>,
    /// How many queries were judged in whole numbers against all faces; the others against those that a tree leaves
    /// over. `None` where no tree is asked.
    pub judged_by_all_faces: Option<u64>,
}

/// One way to answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Short, for tables and charts.
    pub name: &'static str,
    /// Whether it claims to be always right, ties included.
    pub exact: bool,
    /// What is prepared once for a mesh, in nanoseconds a face; measured once.
    pub prepare_ns: Option<f64>,
    /// Every how many queries it is asked: more than 1 for what is too slow to be asked all.
    pub every: usize,
    /// Median over the rounds of its time a query over the baseline's in the same round.
    pub ratio: f64,
    /// Whether another method is at least as fast and at least as often right, and one of them strictly.
    pub dominated: bool,
    /// One row a stratum, in the order of [`Question::strata`].
    pub strata: Vec<Row>,
    /// All strata together.
    pub total: Row,
}

/// Answers and time of one method on the queries of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// What kind.
    pub name: &'static str,
    /// How many.
    pub queries: u64,
    /// Those with two right answers.
    pub ties: u64,
    /// Those where the method can be wrong: all for an exact method, for others those that are no ties.
    pub judged: u64,
    /// Wrong answers.
    pub wrong: u64,
    /// Nanoseconds a query.
    pub time: Spread,
}

/// A time over the rounds, in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// The middle value.
    pub median: f64,
    /// The fastest round.
    pub min: f64,
    /// The slowest round.
    pub max: f64,
}

impl Question {
    /// As it is written on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Facing => "facing",
            Self::Visibility => "visibility",
        }
    }

    /// How many queries a stratum take some seconds on a mesh of 10⁵ faces.
    #[must_use]
    pub fn usual_queries(self) -> u64 {
        match self {
            Self::Facing => 1_000_000,
            Self::Visibility => 10_000,
        }
    }

    /// The names of the strata.
    ///
    /// Facing, by the light:
    ///
    /// - `given`: the lights that were asked for;
    /// - `general`: a point in a box five times as large as the mesh;
    /// - `vertex`: on a vertex; `face_plane`: in the plane of a face, rounded;
    /// - `one_ulp_off`: off a vertex, an edge or a plane by one ulp in one, two or three coordinates;
    /// - `far`: 2³⁰ to 2⁴⁰ diagonals away;
    /// - `axis`: directional, along an axis; `along_face`: directional, along an edge or in a face's plane.
    ///
    /// Visibility, by the point, under the lights that were asked for:
    ///
    /// - those of [`verify`](super::STRATA): `box`, `near_face`, `shadow_boundary`, `face_plane`, `vertex_or_edge`;
    /// - `behind_vertex`, `behind_edge`: the way to the light passes a vertex, or a point of an edge, but for rounding.
    #[must_use]
    pub fn strata(self) -> Vec<&'static str> {
        match self {
            Self::Facing => lights::STRATA.map(|(name, _)| name).to_vec(),
            Self::Visibility => points::STRATA.to_vec(),
        }
    }

    /// How many steps [`Question::measure`] reports.
    #[must_use]
    pub fn steps(self, options: &Options) -> u64 {
        // The truth, a round to warm up, and those that are timed.
        self.strata().len() as u64 * (u64::from(options.rounds.max(1)) + 2)
    }

    /// Measures all methods on `mesh`, which is welded. `None` if it has no faces, or there are no lights.
    ///
    /// `progress` is told of steps as they are done, [`Question::steps`] in all. Memory: a byte a query, and for
    /// visibility its point.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::testing::shapes;
    /// use umbrage::accuracy::{Options, Question};
    /// let lights = [Light::point([2.0, 3.0, 5.0])?];
    /// let options = Options { queries: 1000, seed: 1, rounds: 1 };
    /// let found = Question::Facing.measure(&shapes::torus(20, 10, 2.0, 0.7), &lights, &options, &|_| {}).unwrap();
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
    /// Whether no exact method has given a wrong answer.
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
    /// Of some values, at least one; the median of an even number is the mean of the two in the middle.
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let (half, last) = (values.len() / 2, values.len() - 1);
        let median =
            if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) };
        Self { median, min: values[0], max: values[last] }
    }
}
