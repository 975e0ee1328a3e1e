//! Level of detail for shadows: the technique `lod`.
//!
//! Casters are welded within a tolerance, which removes small faces and leaves a legal caster of any mesh.
//! Only shells of which no sample that faces the light is seen are simplified: the surface that casts and the
//! one that receives would differ, and shadow each other. The claim is proven: `bound.rs` counts the samples
//! whose verdict may change.

mod bound;
mod fault;
mod options;
mod shells;
#[cfg(test)]
mod tests;

pub use options::{LodOn, LodOptions, Tolerance};

use self::fault::{Fault, Faults};
use self::shells::{LodShell, ShellOfFace, lod_shells};
use super::visibility::asked;
use super::{Answer, Claim, LampShadow, Samples, Visibility, stencil};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::oracle::{Oracle, Verdict};

/// The shells of all casters, in full and simplified.
#[derive(Debug)]
pub(super) struct LodShadow<'a> {
    casters: &'a CasterGroup<'a>,
    light: Light,
    on: LodOn,
    shells: Vec<LodShell>,
    shell_of_face: ShellOfFace<'a>,
    faults: Faults,
}

/// The verdicts at the samples that are asked, in their order.
struct Found {
    is_dark: Vec<bool>,
    /// How many touch a face or lie on a volume, where both answers are right; `None` if that is not known.
    grazing: Option<u64>,
}

impl<'a> LodShadow<'a> {
    pub(super) fn prepare(casters: &'a CasterGroup<'a>, light: &Light, options: LodOptions) -> Self {
        Self {
            casters,
            light: *light,
            on: options.on,
            shells: lod_shells(casters, light, options.moves.fraction()),
            shell_of_face: ShellOfFace::new(casters),
            faults: Faults::default(),
        }
    }

    /// Whether each shell is simplified: no sample of it is asked.
    fn simplified(&self, samples: &Samples, asked: &[bool]) -> Vec<bool> {
        let mut simplified: Vec<bool> = self.shells.iter().map(|shell| shell.coarse.is_some()).collect();
        if !self.faults.has(Fault::SeenAreSimplified) {
            let seen = samples.hits().iter().zip(asked).filter(|(_, asked)| **asked);
            for shell in seen.filter_map(|(hit, _)| self.shell_of_face.of(hit.as_ref()?)) {
                simplified[shell] = false;
            }
        }
        simplified
    }

    /// Each shell in the form that is used.
    fn forms<'s>(&'s self, simplified: &'s [bool]) -> impl Iterator<Item = &'s shells::Form> {
        self.shells.iter().zip(simplified).map(|(shell, &simplified)| match &shell.coarse {
            Some(coarse) if simplified => &coarse.form,
            _ => &shell.full,
        })
    }

    fn by_rays(&self, simplified: &[bool], points: &[[f32; 3]]) -> Found {
        let meshes: Vec<&Mesh> = self.forms(simplified).map(|form| &form.mesh).collect();
        let own;
        let oracle = if simplified.contains(&true) {
            own = Oracle::over(&meshes);
            &own
        } else {
            self.casters.oracle()
        };
        let mut verdicts = vec![Verdict::Lit; points.len()];
        oracle.verdicts_into(points, &self.light, &mut verdicts);
        let count = |wanted| verdicts.iter().filter(|verdict| **verdict == wanted).count() as u64;
        Found {
            grazing: Some(count(Verdict::Grazing)),
            is_dark: verdicts.iter().map(|&verdict| verdict == Verdict::Shadowed).collect(),
        }
    }

    fn by_counting(&self, simplified: &[bool], samples: &Samples, asked: &[bool]) -> Found {
        let volumes = self.forms(simplified).map(|form| form.volume(&self.light));
        let (counts, _) = stencil::Counter::default().counts(samples, asked, volumes);
        let counts = samples.hits().iter().zip(asked).zip(counts).filter(|((_, asked), _)| **asked);
        let is_dark = counts.filter_map(|((hit, _), count)| {
            let p = hit.as_ref()?.point;
            let exactly = || self.casters.oracle().verdict(p, &self.light) == Verdict::Shadowed;
            Some(count.map_or_else(exactly, |count| count != 0))
        });
        Found { is_dark: is_dark.collect(), grazing: None }
    }

    /// Number of points at which a simplified shell may change the verdict.
    fn changing(&self, simplified: &[bool], points: &[[f32; 3]]) -> u64 {
        let all = self.shells.iter().zip(simplified).filter(|(_, simplified)| **simplified);
        let bounds: Vec<_> = all.filter_map(|(shell, _)| Some(&shell.coarse.as_ref()?.bound)).collect();
        let may_change = |p: &&[f32; 3]| bounds.iter().any(|bound| bound.may_change(**p, self.faults));
        let count = |points: &[[f32; 3]]| points.iter().filter(may_change).count() as u64;
        crate::parallel::fold(points, 256, count, |a, b| a + b)
    }

    /// At most this fraction of the judged samples is wrong. A judged sample does not graze the casters in
    /// full; one that does either grazes the simplified ones too, or may change.
    fn claim(&self, front_lit: usize, grazing: u64, changing: u64) -> Claim {
        let judged = (front_lit as u64).saturating_sub(grazing + changing);
        match changing {
            0 => Claim::Bounded(0.0),
            _ => Claim::Bounded(((changing as f64 / judged.max(1) as f64).min(1.0) as f32).next_up()),
        }
    }
}

impl LampShadow for LodShadow<'_> {
    /// 0 or 1 at each front-lit sample. A grazing ray counts as lit.
    fn shade(&self, samples: &Samples) -> Visibility {
        let asked = asked(samples, &self.light);
        let simplified = self.simplified(samples, &asked);
        let points = samples.hits().iter().zip(&asked).filter(|(_, asked)| **asked);
        let points: Vec<[f32; 3]> = points.filter_map(|(hit, _)| Some(hit.as_ref()?.point)).collect();
        let found = match self.on {
            LodOn::Rays => self.by_rays(&simplified, &points),
            LodOn::ZFail => self.by_counting(&simplified, samples, &asked),
        };
        let claim = found.grazing.map_or(Claim::Approximate, |grazing| {
            self.claim(points.len(), grazing, self.changing(&simplified, &points))
        });
        let mut visibility = Visibility::of(samples, &self.light, claim, |_| Answer::of(1.0));
        visibility.darken(found.is_dark);
        visibility
    }

    fn bytes(&self) -> usize {
        self.shells.iter().map(LodShell::bytes).sum::<usize>() + self.shell_of_face.bytes()
    }
}
