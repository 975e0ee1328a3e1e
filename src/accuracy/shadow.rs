//! Every technique's error and time, for one lamp and one view.

use std::hint::black_box;
use std::time::Instant;

use super::Spread;
use crate::caster::CasterGroup;
use crate::scene::Lamp;
use crate::shadow::{Claim, PrepareError, Request, Samples, Technique, Updates};
use crate::verify::errors::{Errors, Made, Truth};

/// Error and time of one technique under one lamp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShadowRow {
    /// The technique.
    pub technique: Technique,
    /// The graphics adapter's name; `None` for the CPU.
    pub device: Option<String>,
    /// The technique's claim.
    pub claim: Claim,
    /// Errors against the truth.
    pub errors: Errors,
    /// Whether the claim holds on these samples.
    pub holds: bool,
    /// Number of samples that the technique could not decide and passed to the exact ray cast; `None` if the
    /// technique never does so.
    pub asked_exactly: Option<u64>,
    /// Time for everything that stays valid while only the camera moves, in milliseconds: the parts of the
    /// casters that the technique needs, each timed when it was built, and the technique's own data for the
    /// light.
    pub prepare_ms: f64,
    /// Time from given samples to the visibility, warm, without read-back, in milliseconds, over the rounds.
    pub frame_ms: Spread,
    /// Time to read a device's result back, in milliseconds.
    pub readback_ms: Option<f64>,
    /// Number of texels read per front-lit sample; `None` without a map.
    pub reads: Option<f64>,
    /// Work of a technique that rasterizes volumes on the CPU, in one frame; `None` for all others.
    pub updates: Option<Updates>,
    /// The shadow map's largest depth bias, as a distance along the light in mesh units.
    pub bias_world: Option<f64>,
    /// The size of the shadow map's texel at the center of the scene, in mesh units.
    pub texel_world: Option<f64>,
    /// Memory held for the light, and for the visibility.
    pub bytes: u64,
    /// A technique that is at least as fast and at least as often right, and strictly better in one of the
    /// two.
    pub dominated_by: Option<Technique>,
    /// The fraction of the lamp that reaches each sample, as the technique has it.
    pub values: Vec<f32>,
}

/// Errors and times of all techniques under one lamp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShadowAccuracy {
    /// The lamp.
    pub lamp: Lamp,
    /// One row per technique, in the order asked for, and then those of a device.
    pub rows: Vec<ShadowRow>,
    /// The techniques that have a device form, but not with these options or for this scene, and what the
    /// device form lacks.
    pub cpu_only: Vec<(Technique, &'static str)>,
    /// What is true at each sample.
    pub truth: Truth,
    /// What the parts of the casters took that counting needs, in milliseconds.
    pub(super) counting_ms: f64,
}

/// Build times of the casters' parts, in milliseconds.
#[derive(Clone, Copy, Debug, Default)]
struct PartTimes {
    oracle: f64,
    counting: f64,
}

/// The result of `work`, and its time in milliseconds.
pub(super) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = black_box(work());
    (result, start.elapsed().as_secs_f64() * 1e3)
}

impl PartTimes {
    /// Builds and times all parts. Parts that are already built take no time.
    fn of(casters: &CasterGroup<'_>) -> Self {
        let (_, oracle) = timed(|| casters.oracle());
        let (_, counting) = timed(|| {
            for caster in casters.casters() {
                black_box((caster.proofs().len(), caster.planes(), caster.shell_boxes()));
            }
        });
        Self { oracle, counting }
    }

    fn needed(self, technique: Technique) -> f64 {
        match technique {
            Technique::Rays
            | Technique::Samples(_)
            | Technique::Area
            | Technique::Hybrid3x3(_)
            | Technique::Hybrid2x2(_)
            | Technique::Hybrid(_)
            | Technique::Lod(_)
            | Technique::SoftHybrid(_)
            | Technique::PenumbraMap(_)
            | Technique::Smoothies(_)
            | Technique::ContactBlur(_)
            | Technique::Planar(_)
            | Technique::PlanarBlur(_)
            | Technique::PlanarContact(_)
            | Technique::PlanarLayers(_)
            | Technique::Blob(_)
            | Technique::Projective(_) => self.oracle,
            Technique::Stencil | Technique::ZFail | Technique::ZPass => self.counting,
            Technique::ZPassReversed | Technique::Counter(_) => self.counting,
            Technique::ZPassPlus => self.counting + self.oracle,
            Technique::Map(_)
            | Technique::Pcf(_)
            | Technique::MapIds(_)
            | Technique::AliasFree(_)
            | Technique::Reconstruct(_)
            | Technique::Pcss(_)
            | Technique::SingleSample(_)
            | Technique::Vsm(_)
            | Technique::Msm(_)
            | Technique::None
            | Technique::Dark => 0.0,
        }
    }
}

impl ShadowAccuracy {
    /// Measures techniques for each lamp, on the CPU. A warm-up round is compared with the truth, then
    /// `rounds` rounds are timed.
    ///
    /// `view` makes the samples after the ray cast over the casters has been built. `progress` is called with
    /// the number of steps done: per lamp one, and one per technique. Gives the samples too.
    ///
    /// ```
    /// use std::error::Error;
    /// use umbrage::accuracy::ShadowAccuracy;
    /// use umbrage::caster::{Caster, CasterGroup};
    /// use umbrage::shadow::Samples;
    /// use umbrage::testing::shapes;
    /// use umbrage::view::{Camera, Size, Up};
    /// let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
    /// let casters = CasterGroup::new(vec![&caster]);
    /// let size = Size::new(32, 24)?;
    /// let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
    /// let projection = camera.projection(size, camera.near([caster.mesh()], size));
    /// let view = |casters: &CasterGroup<'_>| Ok(Samples::of_view(casters, &projection, size, 1)?);
    /// let (lamps, techniques) = (["point:3,9,5".parse()?], ["rays".parse()?, "samples:n=4".parse()?]);
    /// let (_, found) =
    ///     ShadowAccuracy::measure::<Box<dyn Error>>(&casters, &lamps, &techniques, view, 1, &|_| {})?;
    /// assert!(found[0].rows.iter().all(|row| row.holds));
    /// # Ok::<(), Box<dyn Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The error of `view`, or [`PrepareError`] of a technique.
    pub fn measure<E: From<PrepareError>>(
        casters: &CasterGroup<'_>,
        lamps: &[Lamp],
        techniques: &[Technique],
        view: impl FnOnce(&CasterGroup<'_>) -> Result<Samples, E>,
        rounds: u32,
        progress: &dyn Fn(u64),
    ) -> Result<(Samples, Vec<Self>), E> {
        let parts = PartTimes::of(casters);
        let samples = view(casters)?;
        let measure = |lamp: &Lamp| {
            let request = Request { casters, lamp, samples: &samples };
            Self::of_lamp(&request, techniques, parts, rounds, progress)
        };
        let found = lamps.iter().map(measure).collect::<Result<_, PrepareError>>()?;
        Ok((samples, found))
    }

    fn of_lamp(
        request: &Request<'_>,
        techniques: &[Technique],
        parts: PartTimes,
        rounds: u32,
        progress: &dyn Fn(u64),
    ) -> Result<Self, PrepareError> {
        let truth = Truth::of(request);
        progress(1);
        let mut rows = Vec::with_capacity(techniques.len());
        for &technique in techniques {
            rows.push(row(request, &truth, technique, parts.needed(technique), rounds)?);
            progress(1);
        }
        mark_dominated(&mut rows);
        Ok(Self {
            lamp: request.lamp.clone(),
            rows,
            cpu_only: Vec::new(),
            truth,
            counting_ms: parts.counting,
        })
    }

    /// Whether every claim holds.
    #[must_use]
    pub fn claims_hold(&self) -> bool {
        self.rows.iter().all(|row| row.holds)
    }
}

fn row(
    request: &Request<'_>,
    truth: &Truth,
    technique: Technique,
    parts_ms: f64,
    rounds: u32,
) -> Result<ShadowRow, PrepareError> {
    let (prepared, prepare_ms) = timed(|| technique.prepare(request.casters, request.lamp));
    let prepared = prepared?;
    let visibility = prepared.shade(request.samples);
    let made = Made { texel: prepared.texel_world(), is_soft: technique.is_soft(), ..Made::default() };
    let errors = Errors::of(request, &visibility, truth, &made);
    let asked = visibility.asked().iter().filter(|asked| **asked).count().max(1);
    let frames = (0..rounds.max(1)).map(|_| timed(|| prepared.shade(request.samples)).1).collect();
    Ok(ShadowRow {
        technique,
        device: None,
        claim: visibility.claim(),
        holds: errors.hold(visibility.claim()),
        errors,
        asked_exactly: asks_exactly(technique).then_some(visibility.asked_exactly()),
        prepare_ms: parts_ms + prepare_ms,
        frame_ms: Spread::of(frames),
        readback_ms: None,
        reads: made.texel.map(|_| visibility.reads() as f64 / asked as f64),
        updates: visibility.updates(),
        bias_world: prepared.bias_world(),
        texel_world: made.texel,
        bytes: (prepared.bytes() + visibility.bytes()) as u64,
        dominated_by: None,
        values: visibility.values().to_vec(),
    })
}

/// Whether the technique passes samples to the exact ray cast.
fn asks_exactly(technique: Technique) -> bool {
    matches!(
        technique,
        Technique::Stencil
            | Technique::ZFail
            | Technique::ZPass
            | Technique::ZPassPlus
            | Technique::ZPassReversed
            | Technique::Counter(_)
            | Technique::Hybrid3x3(_)
            | Technique::Hybrid2x2(_)
            | Technique::Hybrid(_)
            | Technique::SoftHybrid(_)
            | Technique::PenumbraMap(_)
            | Technique::Smoothies(_)
            | Technique::ContactBlur(_)
            | Technique::Planar(_)
            | Technique::PlanarBlur(_)
            | Technique::PlanarContact(_)
            | Technique::PlanarLayers(_)
            | Technique::Blob(_)
            | Technique::Projective(_)
    )
}

/// Finds for each row the technique that dominates it, by mean error (for a lamp without extent: wrong
/// samples, then mean error) and median frame time. Of several dominating techniques the fastest is named.
pub(super) fn mark_dominated(rows: &mut [ShadowRow]) {
    let costs: Vec<(Technique, f64, (u64, f64))> = rows
        .iter()
        .map(|row| {
            // Under a lamp with extent the verdicts by its center are no error of the picture.
            let wrong = if row.errors.has_fractions { 0 } else { row.errors.wrong };
            (row.technique, row.frame_ms.median, (wrong, row.errors.mean))
        })
        .collect();
    for (row, &(_, time, error)) in rows.iter_mut().zip(&costs) {
        let better = costs.iter().filter(|(_, other, errors)| {
            *other <= time && *errors <= error && (*other < time || *errors < error)
        });
        row.dominated_by = better.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(technique, ..)| *technique);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    #[test]
    fn accuracy_of_shadows_marks_what_is_slower_and_not_more_often_right() {
        let row = |technique, ms: f64, wrong| ShadowRow {
            technique,
            device: None,
            claim: Claim::Approximate,
            errors: Errors { wrong, ..Errors::default() },
            holds: true,
            asked_exactly: None,
            prepare_ms: 0.0,
            frame_ms: Spread::of(vec![ms]),
            readback_ms: None,
            reads: None,
            updates: None,
            bias_world: None,
            texel_world: None,
            bytes: 0,
            dominated_by: None,
            values: Vec::new(),
        };
        let mut rows = [
            row(Technique::Rays, 2.0, 0),
            row(Technique::Stencil, 3.0, 0),
            row(Technique::None, 1.0, 5),
            row(Technique::Dark, 1.0, 9),
        ];
        mark_dominated(&mut rows);
        let by = rows.map(|row| row.dominated_by);
        assert_eq!(by, [None, Some(Technique::Rays), None, Some(Technique::None)]);
    }

    #[test]
    fn accuracy_of_shadows_has_a_row_per_technique_and_every_claim_holds() {
        // The eye is inside the outer cube's shadow: z-pass is wrong there, and its claim promises nothing.
        let caster = Caster::new(shapes::nested_cubes(2));
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(24, 18).unwrap();
        let camera = Camera::look_at([-4.0, -3.0, -5.0], [0.0; 3], 0.6, Up::Y).unwrap();
        let projection = camera.projection(size, 0.1);
        let view = |casters: &CasterGroup<'_>| Ok(Samples::of_view(casters, &projection, size, 1).unwrap());
        let lights = ["point:9,7,11", "point:-9,-2,-11"].map(|light| light.parse().unwrap());
        let (_, found) =
            ShadowAccuracy::measure::<PrepareError>(&casters, &lights, &Technique::ALL, view, 1, &|_| {})
                .unwrap();
        for of_lamp in &found {
            assert_eq!(of_lamp.rows.iter().map(|row| row.technique).collect::<Vec<_>>(), Technique::ALL);
            assert!(of_lamp.claims_hold(), "{of_lamp:?}");
        }
        assert!(found[1].rows[0].errors.judged > 100);
    }
}
