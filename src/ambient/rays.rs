//! Openness by exact rays from exactly the receiver: no offset, no tolerance.
//!
//! Directions have the density of the cosine, so that openness is the share of rays that cross nothing. They
//! are a lattice with a shift of its own for each position; its error falls with the number N of rays about
//! as 0.4·N^(−¾).

use glam::DVec3;

use super::lattice::{Lattice, shift};
use super::ring::{Pairs, helps};
use super::start::Start;
use super::{Ambient, Receiver, Receivers};
use crate::geom::Aabb;
use crate::oracle::{Curve, Oracle};

/// How far a face may be to hide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Reach {
    /// However far it is.
    #[default]
    Unlimited,
    /// Up to this distance.
    Within(f32),
    /// Fully at distance 0, linearly less up to this distance (Zhukov, Iones and Kronin, *An Ambient Light
    /// Illumination Model*, 1998).
    Fading(f32),
}

/// How many rays are cast from each receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// This number, from 1 to [`MOST_RAYS`].
    Rays(u32),
    /// As many as keep the standard error of a value at this size or below, but at most [`MOST_RAYS`].
    Error(f64),
}

/// Whether each value is replaced by the mean over itself and those of its neighbors that have a similar
/// normal, and a value that differs by no more than noise explains: by 1.2·N^(−¾) for N rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ring {
    /// With at most 64 rays, given as a number.
    #[default]
    Auto,
    /// Always.
    On,
    /// Never.
    Off,
}

/// The most rays from one receiver.
pub const MOST_RAYS: u32 = 1 << 20;

/// How openness is worked out by rays.
///
/// ```
/// use umbrage::ambient::{Effort, RayOptions};
/// let options = RayOptions { effort: Effort::Error(0.01), ..RayOptions::default() };
/// assert_eq!(options.seed, 1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayOptions {
    /// How many rays.
    pub effort: Effort,
    /// Any number; another one draws other directions.
    pub seed: u64,
    /// How far faces hide.
    pub reach: Reach,
    /// Whether neighbors share their values.
    pub ring: Ring,
    /// Whether [`Ambient::bent`] is wanted.
    pub bent: bool,
}

impl Default for RayOptions {
    fn default() -> Self {
        Self { effort: Effort::Rays(64), seed: 1, reach: Reach::Unlimited, ring: Ring::Auto, bent: false }
    }
}

/// What was done for an [`Ambient`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cast {
    /// Rays from each receiver.
    pub rays: u32,
    /// Whether neighbors share their values.
    pub ring: bool,
}

/// What the rays from one receiver found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sample {
    pub(super) openness: f32,
    /// The sum of the open directions, over the number of rays.
    pub(super) bent: [f32; 3],
    /// In another solid.
    pub(super) buried: bool,
}

/// Receivers per task.
const RUN: usize = 64;

/// Errors are about this times N^(−¾), before it is measured.
const CONSTANT: f64 = 0.4;

impl Ambient {
    /// Openness by exact rays. `oracle` is over the same meshes as the receivers; more meshes may follow.
    ///
    /// A face through the receiver hides what it hides from a receiver that is moved outwards by nothing. A
    /// receiver in a solid has openness 0. `progress` is called with the number of further receivers that are
    /// done, from any thread. [`Ambient::standard_error`] is that of one value before neighbors share, from
    /// four shifts of the lattice at up to 256 receivers.
    ///
    /// Time: about half a microsecond a ray. The result does not depend on the number of threads.
    ///
    /// ```
    /// use umbrage::ambient::{Ambient, Per, RayOptions, Receivers};
    /// use umbrage::oracle::Oracle;
    /// use umbrage::testing::shapes;
    /// let (small, room) = (shapes::cube(), shapes::cuboid([-3.0; 3], [3.0; 3]));
    /// let both = [&small, &room];
    /// let receivers = Receivers::of(&both, Per::Corner);
    /// let (ambient, cast) =
    ///     Ambient::by_rays(&Oracle::over(&both), &receivers, &RayOptions::default(), &|_| {});
    /// assert_eq!((ambient.openness[0], ambient.openness[24], cast.rays), (0.0, 1.0, 64));
    /// assert_eq!(ambient.inside.len(), 24); // the small cube is in the solid of the other
    /// ```
    #[must_use]
    pub fn by_rays(
        oracle: &Oracle,
        receivers: &Receivers,
        options: &RayOptions,
        progress: &(dyn Fn(u64) + Sync),
    ) -> (Self, Cast) {
        let (rays, standard_error) = settle(oracle, receivers, options);
        let mut samples = samples(oracle, receivers, rays, options, progress);
        let inside =
            (0..).zip(&samples).filter(|(_, sample)| sample.buried).map(|(index, _)| index).collect();
        let may_share = match options.ring {
            Ring::On => true,
            Ring::Auto => matches!(options.effort, Effort::Rays(_)),
            Ring::Off => false,
        };
        let shares = may_share && (options.ring == Ring::On || helps(rays));
        if shares {
            // The same whichever receivers there are: their own standard error is not.
            let error = CONSTANT * f64::from(rays).powf(-0.75);
            samples = Pairs::of(receivers).smooth(&receivers.list, &samples, error);
        }
        let unit = |sample: &Sample| {
            DVec3::from(sample.bent.map(f64::from)).normalize_or_zero().to_array().map(|x| x as f32)
        };
        let ambient = Self {
            openness: samples.iter().map(|sample| sample.openness).collect(),
            bent: options.bent.then(|| samples.iter().map(unit).collect()),
            inside,
            standard_error,
        };
        (ambient, Cast { rays, ring: shares })
    }
}

/// The values of all receivers, in their order. They are taken along a Morton curve, so that neighbors read
/// the same faces.
fn samples(
    oracle: &Oracle,
    receivers: &Receivers,
    rays: u32,
    options: &RayOptions,
    progress: &(dyn Fn(u64) + Sync),
) -> Vec<Sample> {
    let list = &receivers.list;
    let lattice = Lattice::new(rays);
    let curve = Curve::in_box(&Aabb::around(list.iter().map(|receiver| receiver.point)));
    let mut order: Vec<(u32, u32)> =
        list.iter().zip(0..).map(|(receiver, index)| (curve.place(receiver.point), index)).collect();
    order.sort_unstable();
    let mut found = vec![Sample::default(); order.len()];
    crate::parallel::rows(&mut found, RUN, |run, found| {
        for ((_, index), found) in order[run * RUN..].iter().zip(&mut *found) {
            let index = *index as usize;
            let start = Start::at(oracle, receivers, index);
            *found = if receivers.solids.hold(oracle, receivers, index, &start) {
                Sample { buried: true, ..Sample::default() }
            } else {
                sample(oracle, &list[index], &start, &lattice, options.seed, options.reach)
            };
        }
        progress(found.len() as u64);
    });
    let mut samples = vec![Sample::default(); order.len()];
    for ((_, index), found) in order.iter().zip(found) {
        samples[*index as usize] = found;
    }
    samples
}

/// Casts the rays of one receiver.
pub(super) fn sample(
    oracle: &Oracle,
    receiver: &Receiver,
    start: &Start,
    lattice: &Lattice,
    seed: u64,
    reach: Reach,
) -> Sample {
    let (mut hidden, mut bent, mut rays) = (0.0, DVec3::ZERO, 0.0);
    for direction in lattice.directions(receiver.normal, shift(seed, receiver.point)) {
        let share = start.hidden(oracle, direction, reach);
        hidden += share;
        bent += (1.0 - share) * DVec3::from(direction.map(f64::from));
        rays += 1.0;
    }
    let bent = (bent / rays).to_array().map(|x| x as f32);
    Sample { openness: (1.0 - hidden / rays) as f32, bent, buried: false }
}

/// The number of rays, and the standard error that they have. For a wanted error, the constant is measured
/// once and corrected.
fn settle(oracle: &Oracle, receivers: &Receivers, options: &RayOptions) -> (u32, Option<f64>) {
    let measured = |rays| standard_error(oracle, receivers, rays, options);
    match options.effort {
        Effort::Rays(rays) => {
            let rays = rays.clamp(1, MOST_RAYS);
            (rays, measured(rays))
        }
        Effort::Error(wanted) => {
            let rays = rays_for(CONSTANT / wanted);
            match measured(rays) {
                Some(error) if error > wanted && rays < MOST_RAYS => {
                    let more = rays_for(error * f64::from(rays).powf(0.75) / wanted);
                    (more, measured(more))
                }
                error => (rays, error),
            }
        }
    }
}

/// N for which N^¾ is `ratio`. What is not a number asks for the most.
fn rays_for(ratio: f64) -> u32 {
    let rays = ratio.abs().powf(4.0 / 3.0).ceil();
    if rays < f64::from(MOST_RAYS) { (rays as u32).max(1) } else { MOST_RAYS }
}

/// The root mean square of the standard error of one value, from shifts at some receivers. `None` without
/// receivers.
fn standard_error(oracle: &Oracle, receivers: &Receivers, rays: u32, options: &RayOptions) -> Option<f64> {
    const SHIFTS: u64 = 4;
    let list = &receivers.list;
    let count = (list.len() / 8).clamp(1, 256).min(list.len());
    if count == 0 {
        return None;
    }
    let lattice = Lattice::new(rays);
    let mut variances = vec![0.0; count];
    crate::parallel::rows(&mut variances, 1, |index, variance| {
        let index = index * list.len() / count;
        let (receiver, start) = (&list[index], Start::at(oracle, receivers, index));
        let value = |shift| {
            let seed = options.seed.wrapping_add(shift << 32);
            f64::from(sample(oracle, receiver, &start, &lattice, seed, options.reach).openness)
        };
        let values: Vec<f64> = (1..=SHIFTS).map(value).collect();
        let mean = values.iter().sum::<f64>() / SHIFTS as f64;
        variance[0] = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (SHIFTS - 1) as f64;
    });
    Some((variances.iter().sum::<f64>() / count as f64).sqrt())
}
