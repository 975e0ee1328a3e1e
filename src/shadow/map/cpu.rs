//! Filtered shadow maps on the CPU: the techniques `map` and `pcf`.

use glam::DVec3;

use super::options::{Fit, MapOptions};
use super::receiver::{Receiver, Tap};
use super::space::{LightSpace, unit_normal, wide};
use super::{Bias, DepthSource, Filter, Layered, MapError, Rule, ShadowMap, Texel};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::visibility::Answer;
use crate::shadow::{Claim, LampShadow, Samples, Visibility};

/// A map of one lamp with the rule that reads it.
#[derive(Debug)]
pub struct MapShadow<'a> {
    casters: &'a CasterGroup<'a>,
    light: Light,
    options: MapOptions,
    scene: Drawn,
}

/// A drawn map.
#[derive(Debug)]
pub(super) struct Drawn {
    rule: Rule,
    filter: Filter,
    texels: Texels,
}

#[derive(Debug)]
enum Texels {
    Depth(ShadowMap<f32>),
    /// For [`Bias::Second`].
    Layered(ShadowMap<Layered>),
}

impl<'a> MapShadow<'a> {
    /// Draws the map of the scene.
    ///
    /// # Errors
    ///
    /// [`MapError`] if the size is not 1 to 16384, the texels do not fit the memory, or [`Bias::Offset`]
    /// comes with another depth than [`DepthSource::Interpolated`].
    pub fn prepare(
        casters: &'a CasterGroup<'a>,
        lamp: &Lamp,
        options: &MapOptions,
    ) -> Result<Self, MapError> {
        if options.bias == Bias::Offset && options.depth != DepthSource::Interpolated {
            return Err(MapError::OffsetOfPlane);
        }
        let space = LightSpace::of_scene(casters, lamp, options.size)?;
        let light = *lamp.light();
        let scene = Drawn::draw(casters, &light, options, space, Self::rule(options, &space))?;
        Ok(Self { casters, light, options: *options, scene })
    }

    fn rule(options: &MapOptions, space: &LightSpace) -> Rule {
        Rule::new(options.bias, options.filter.reach(), options.depth, space)
    }

    /// The filtered map at each front-lit sample.
    #[must_use]
    pub fn shade(&self, samples: &Samples) -> Visibility {
        let views = self.of_view(samples);
        Visibility::of(samples, &self.light, Claim::Approximate, |hit| {
            let point = wide(hit.point);
            views.iter().find(|drawn| drawn.holds(point)).unwrap_or(&self.scene).answer(hit)
        })
    }

    /// The maps of the view, the finest first; that of the scene is for what they do not hold. A map that
    /// does not fit the memory beside that of the scene is done without.
    fn of_view(&self, samples: &Samples) -> Vec<Drawn> {
        let spaces = match self.options.fit {
            Fit::Scene => Vec::new(),
            Fit::View => self.space().of_view(samples, self.options.cascades),
        };
        let draw = |space| {
            let rule = Self::rule(&self.options, &space);
            Drawn::draw(self.casters, &self.light, &self.options, space, rule).ok()
        };
        spaces.into_iter().filter_map(draw).collect()
    }

    /// The space of the map of the scene.
    #[must_use]
    pub fn space(&self) -> &LightSpace {
        self.scene.space()
    }

    /// Memory of the texels, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.scene.texels {
            Texels::Depth(map) => map.bytes(),
            Texels::Layered(map) => map.bytes(),
        }
    }

    /// Side of a texel in mesh units, in the middle of what is seen.
    #[must_use]
    pub fn texel_world(&self) -> f64 {
        self.space().texel_world(wide(self.casters.bounds().center()))
    }

    /// The bias in mesh units along the light, in the middle of what is seen, for a plane that meets the
    /// light at 45° in the worst direction.
    #[must_use]
    pub fn bias_world(&self) -> f64 {
        self.texel_world() * self.scene.rule.texels_at_45()
    }
}

impl LampShadow for MapShadow<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        self.shade(samples)
    }

    fn bytes(&self) -> usize {
        self.bytes()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.texel_world())
    }

    fn bias_world(&self) -> Option<f64> {
        Some(self.bias_world())
    }
}

impl Drawn {
    pub(super) fn draw(
        casters: &CasterGroup<'_>,
        light: &Light,
        options: &MapOptions,
        space: LightSpace,
        rule: Rule,
    ) -> Result<Self, MapError> {
        let offset = rule.polygon_offset();
        let texels = match options.bias {
            Bias::Second => Texels::Layered(ShadowMap::draw(casters, light, space, options.depth, offset)?),
            _ => Texels::Depth(ShadowMap::draw(casters, light, space, options.depth, offset)?),
        };
        Ok(Self { rule, filter: options.filter, texels })
    }

    pub(super) fn space(&self) -> &LightSpace {
        match &self.texels {
            Texels::Depth(map) => map.space(),
            Texels::Layered(map) => map.space(),
        }
    }

    /// Whether all texels that are read for a point lie on the map. With the first of several maps that holds
    /// a point there is no seam between them, and nothing to blend.
    pub(super) fn holds(&self, point: DVec3) -> bool {
        let footprint = self.rule.footprint();
        let inside = footprint..=f64::from(self.space().size()) - footprint;
        self.space().at(point).is_some_and(|at| inside.contains(&at.tx) && inside.contains(&at.ty))
    }

    /// The answer at a visible point.
    fn answer(&self, hit: &PrimaryHit) -> Answer {
        // A face of which rounding leaves no normal is edge-on to everything.
        let Some(normal) = unit_normal(hit.corners) else { return Answer::of(1.0) };
        self.answer_at(wide(hit.point), normal * f64::from(hit.side.value()))
    }

    /// Part of the filter that is lit at a point of a plane whose unit normal points to the light's side.
    /// What lies outside the map is lit.
    fn answer_at(&self, point: DVec3, normal: DVec3) -> Answer {
        let space = self.space();
        let outside = Answer { is_outside: true, ..Answer::of(1.0) };
        let offset_in = |layer| self.rule.normal_offset(layer, normal, point);
        let layer = space.layer_of(point);
        let mut offset = offset_in(layer);
        // A lookup that moves across the seam of a cube is read along other axes.
        let moved = space.layer_of(point + offset * normal);
        if moved != layer {
            offset = offset.max(offset_in(moved));
        }
        let Some(receiver) = Receiver::new(space, point + offset * normal, normal) else { return outside };
        let (mut lit, mut dark, mut reads) = (0.0, 0.0, 0);
        self.filter.for_each_texel(receiver.lookup().tx, receiver.lookup().ty, |i, j, weight| {
            *(if self.blocks(&receiver, i, j) { &mut dark } else { &mut lit }) += weight;
            reads += 1;
        });
        // Exactly 0 or 1 where all texels agree.
        let value = if dark == 0.0 { 1.0 } else { (lit / (lit + dark)) as f32 };
        Answer { reads, is_outside: !space.shows(receiver.lookup()), ..Answer::of(value) }
    }

    #[cfg(test)]
    pub(super) fn value_at(&self, point: DVec3, normal: DVec3) -> f32 {
        self.answer_at(point, normal).value
    }

    /// Whether a texel shadows the receiver. What lies outside the map is lit.
    fn blocks(&self, receiver: &Receiver<'_>, i: i64, j: i64) -> bool {
        receiver.tap(i, j).is_some_and(|tap| self.blocks_tap(&tap))
    }

    pub(super) fn blocks_tap(&self, tap: &Tap) -> bool {
        let (stored, second) = match &self.texels {
            Texels::Depth(map) => (map.texel(tap.layer, tap.i, tap.j).map(Texel::depth), None),
            Texels::Layered(map) => {
                let texel = map.texel(tap.layer, tap.i, tap.j);
                (texel.map(Texel::depth), texel.map(Layered::second))
            }
        };
        stored.is_some_and(|stored| self.rule.blocks(tap, stored, second))
    }

    /// The same texels, read in another space.
    #[cfg(test)]
    pub(super) fn clone_in(&self, space: LightSpace) -> Self {
        let texels = match &self.texels {
            Texels::Depth(map) => Texels::Depth(map.clone_in(space)),
            Texels::Layered(map) => Texels::Layered(map.clone_in(space)),
        };
        Self { rule: self.rule, filter: self.filter, texels }
    }
}
