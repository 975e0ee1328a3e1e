//! Stencil counting on the CPU: the counts of a perfect rasterizer, from winding numbers.
//!
//! The z-fail count at a visible point is the winding number of the closed volume there. The z-pass count is
//! the number of crossings between the near plane and the point: the difference of the winding numbers at the
//! two ends of this segment. The two counts agree iff the winding number at the near end is 0, which z-pass
//! requires.

use super::{ShellMethods, StencilMethod};
use crate::caster::{Caster, CasterGroup};
use crate::geom::{Aabb, Light};
use crate::oracle::{PrimaryHit, Verdict};
use crate::shadow::volume::{Caps, ShadowVolume, WindingIndex};
use crate::shadow::{Answer, Claim, LampShadow, Samples, Visibility};
use crate::view::Projection;

/// The casting faces of each caster, and the parts of their volumes that do not depend on the camera.
#[derive(Debug)]
pub(in crate::shadow) struct StencilCounting<'a> {
    casters: &'a CasterGroup<'a>,
    light: Light,
    /// Counting method for every shell; `None` to choose shell by shell.
    asked: Option<StencilMethod>,
    /// Per caster: the sign of each face, and the volume of all shells if a single method counts them.
    cast: Vec<(Vec<i8>, Option<ShadowVolume>)>,
}

/// A volume with its counting method.
struct Counted<'a> {
    index: WindingIndex<'a>,
    method: StencilMethod,
}

impl<'a> StencilCounting<'a> {
    pub(in crate::shadow) fn prepare(
        casters: &'a CasterGroup<'a>,
        light: &Light,
        asked: Option<StencilMethod>,
    ) -> Self {
        let cast = |caster: &&Caster| {
            let faces = caster.shell_faces(light, None);
            let signs = faces.signs(caster.shells(), &caster.facing(light));
            let volume = asked.map(|_| caster.volume_of_signs(light, &signs, Caps::Both));
            (signs, volume)
        };
        Self { casters, light: *light, asked, cast: casters.casters().iter().map(cast).collect() }
    }

    /// The closed volumes of the shells, one per counting method.
    fn by_method(
        &self,
        caster: &Caster,
        signs: &[i8],
        projection: &Projection,
    ) -> Vec<(StencilMethod, ShadowVolume)> {
        let methods: ShellMethods = caster.shell_boxes().choose(caster.mesh(), projection, &self.light);
        let used = StencilMethod::ALL.into_iter().filter(|&method| methods.count(method) > 0);
        used.map(|method| {
            let signs = methods.signs_of(method, caster.shells(), signs);
            (method, caster.volume_of_signs(&self.light, &signs, Caps::Both))
        })
        .collect()
    }

    /// The casting sign of each face of each caster.
    pub(super) fn signs(&self) -> impl Iterator<Item = &[i8]> {
        self.cast.iter().map(|(signs, _)| &signs[..])
    }

    /// Shades samples: a sample is in shadow if the sum of all counts is not 0. The sum starts with `start`
    /// of the sample's point on the near plane. If a point lies on a volume, or has no start, the exact ray
    /// cast decides.
    pub(super) fn shade_from(
        &self,
        samples: &Samples,
        claim: Claim,
        start: impl Fn([f32; 3]) -> Option<i32> + Sync,
    ) -> Visibility {
        let projection = samples.projection();
        // 1. The volumes that depend on the camera: each shell is counted by the method chosen for it.
        let chosen: Vec<(StencilMethod, ShadowVolume)> = match self.asked {
            Some(_) => Vec::new(),
            None => (self.casters.casters().iter().zip(&self.cast))
                .flat_map(|(caster, (signs, _))| self.by_method(caster, signs, projection))
                .collect(),
        };
        let prepared = self.cast.iter().filter_map(|(_, volume)| Some((self.asked?, volume.as_ref()?)));
        let volumes = prepared.chain(chosen.iter().map(|(method, volume)| (*method, volume)));
        // 2. An index of each volume, over the bounding box of all end points.
        let points = samples.hits().iter().flatten().flat_map(|hit| [hit.point, near_end(projection, hit)]);
        let within = Aabb::around(points);
        let counted: Vec<Counted<'_>> = volumes
            .map(|(method, volume)| Counted { index: WindingIndex::build(volume, within), method })
            .collect();
        // 3. The counts.
        Visibility::of(samples, &self.light, claim, |hit| {
            let start = start(near_end(projection, hit));
            let counts = counted.iter().map(|volume| volume.count(projection, hit));
            match counts.chain([start]).sum::<Option<i32>>() {
                Some(count) => Answer::of(f32::from(u8::from(count == 0))),
                None => {
                    let dark = self.casters.oracle().verdict(hit.point, &self.light) == Verdict::Shadowed;
                    Answer { is_exact: true, ..Answer::of(f32::from(u8::from(!dark))) }
                }
            }
        })
    }
}

impl LampShadow for StencilCounting<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let claim = if self.asked == Some(StencilMethod::ZPass) { Claim::Approximate } else { Claim::Exact };
        self.shade_from(samples, claim, |_| Some(0))
    }

    fn bytes(&self) -> usize {
        let bytes = |(signs, volume): &(Vec<i8>, Option<ShadowVolume>)| {
            signs.len() + volume.as_ref().map_or(0, ShadowVolume::bytes)
        };
        self.cast.iter().map(bytes).sum()
    }
}

impl Counted<'_> {
    /// The stencil count of a hit; `None` if an end of the segment lies on the volume.
    fn count(&self, projection: &Projection, hit: &PrimaryHit) -> Option<i32> {
        let at = self.index.number(hit.point)?;
        match self.method {
            StencilMethod::ZFail => Some(at),
            StencilMethod::ZPass => Some(at - self.index.number(near_end(projection, hit))?),
        }
    }
}

/// The intersection of the near plane and the segment from the eye to a visible point, rounded.
fn near_end(projection: &Projection, hit: &PrimaryHit) -> [f32; 3] {
    let [eye, forward, point] = [projection.eye, projection.forward, hit.point].map(|p| p.map(f64::from));
    let depth: f64 = (0..3).map(|i| (point[i] - eye[i]) * forward[i]).sum();
    let eye =
        if projection.is_orthographic() { [0, 1, 2].map(|i| point[i] - depth * forward[i]) } else { eye };
    let ray = [0, 1, 2].map(|i| point[i] - eye[i]);
    let share = (f64::from(projection.near) / depth).clamp(0.0, 1.0);
    [0, 1, 2].map(|i| (eye[i] + share * ray[i]) as f32)
}
