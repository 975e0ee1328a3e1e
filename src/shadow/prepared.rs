//! The two steps of every technique: prepare for a lamp, shade samples.

use std::fmt::Debug;

use super::grid::{AliasFree, GridHybrid};
use super::lod::LodShadow;
use super::map::{HybridShadow, IdShadow, MapError, MapShadow, PcfOptions};
use super::plain::Plain;
use super::planar;
use super::rays::Rays;
use super::reconstruct::Reconstruction;
use super::soft;
use super::soft::area::LampArea;
use super::soft::samples::LampSamples;
use super::stencil::{StencilCounting, StencilMethod, TiledCounting, ZPassPlus};
use super::{Samples, Technique, Visibility};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::scene::Lamp;

/// Input of a technique: casters, lamp and samples.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The shadow casters.
    pub casters: &'a CasterGroup<'a>,
    /// The lamp. Techniques for hard shadows take its center.
    pub lamp: &'a Lamp,
    /// The visible points.
    pub samples: &'a Samples,
}

impl Request<'_> {
    /// The light that casts hard shadows: the lamp's center.
    #[must_use]
    pub fn light(&self) -> &Light {
        self.lamp.light()
    }
}

/// Error of a technique that cannot be prepared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// The technique's shadow map cannot be made.
    #[error("{technique}: {error}")]
    Map {
        /// The technique, with its options.
        technique: Technique,
        /// Why not.
        error: MapError,
    },
}

/// What a technique holds for one lamp.
pub(super) trait LampShadow: Debug + Send + Sync {
    /// Fraction of the lamp that each sample sees.
    fn shade(&self, samples: &Samples) -> Visibility;

    /// Memory held for the lamp, in bytes, without the casters.
    fn bytes(&self) -> usize {
        0
    }

    /// Side of a shadow map's texel in mesh units, at the center of the scene; `None` without a map.
    fn texel_world(&self) -> Option<f64> {
        None
    }

    /// Depth bias of a plane that meets the light at 45° in the worst direction, in mesh units along the
    /// light; `None` without a map that is filtered.
    fn bias_world(&self) -> Option<f64> {
        None
    }
}

impl Technique {
    /// Prepares the data that stays valid while only the camera moves: shadow volumes or shadow maps, for the
    /// techniques that use them.
    ///
    /// # Errors
    ///
    /// [`PrepareError`] if this data does not fit the memory, or an option is out of range.
    pub fn prepare<'a>(
        self,
        casters: &'a CasterGroup<'a>,
        lamp: &Lamp,
    ) -> Result<Prepared<'a>, PrepareError> {
        let shadow =
            self.shadow(casters, lamp).map_err(|error| PrepareError::Map { technique: self, error })?;
        Ok(Prepared { technique: self, shadow })
    }

    fn shadow<'a>(
        self,
        casters: &'a CasterGroup<'a>,
        lamp: &Lamp,
    ) -> Result<Box<dyn LampShadow + 'a>, MapError> {
        let light = lamp.light();
        let counting = |method| Box::new(StencilCounting::prepare(casters, light, method));
        Ok(match self {
            Self::Rays => Box::new(Rays::prepare(casters, light)),
            Self::Stencil => counting(None),
            Self::ZFail => counting(Some(StencilMethod::ZFail)),
            Self::ZPass => counting(Some(StencilMethod::ZPass)),
            Self::ZPassPlus => Box::new(ZPassPlus::prepare(casters, light)),
            Self::ZPassReversed => Box::new(TiledCounting::prepare_reversed(casters, light)),
            Self::Counter(options) => Box::new(TiledCounting::prepare(casters, light, options)),
            Self::Samples(options) => Box::new(LampSamples::prepare(casters, lamp, options)),
            Self::Area => Box::new(LampArea::prepare(casters, lamp)),
            Self::Map(options) | Self::Pcf(PcfOptions(options)) => {
                Box::new(MapShadow::prepare(casters, lamp, &options)?)
            }
            Self::MapIds(options) => Box::new(IdShadow::prepare(casters, lamp, &options)?),
            Self::Hybrid3x3(options) => Box::new(HybridShadow::prepare(casters, lamp, &options)?),
            Self::Hybrid2x2(options) => Box::new(HybridShadow::prepare_nearest(casters, lamp, &options)?),
            Self::Reconstruct(options) => Box::new(Reconstruction::prepare(casters, lamp, options)?),
            Self::Pcss(options) => soft::pcss(casters, lamp, options)?,
            Self::SingleSample(options) => soft::single_sample(casters, lamp, options)?,
            Self::SoftHybrid(options) => soft::soft_hybrid(casters, lamp, options)?,
            Self::Vsm(options) => soft::vsm(casters, lamp, options)?,
            Self::Msm(options) => soft::msm(casters, lamp, options)?,
            Self::PenumbraMap(options) => soft::penumbra_map(casters, lamp, options)?,
            Self::Smoothies(options) => soft::smoothies(casters, lamp, options)?,
            Self::ContactBlur(options) => soft::contact_blur(casters, lamp, options)?,
            Self::Hybrid(options) => Box::new(GridHybrid::prepare(casters, light, options)),
            Self::AliasFree(options) => Box::new(AliasFree::prepare(casters, light, options)),
            Self::Lod(options) => Box::new(LodShadow::prepare(casters, light, options)),
            Self::Planar(options) => planar::planar(casters, lamp, options),
            Self::PlanarBlur(options) => planar::planar_blur(casters, lamp, options),
            Self::PlanarContact(options) => planar::planar_contact(casters, lamp, options),
            Self::PlanarLayers(options) => planar::planar_layers(casters, lamp, options),
            Self::Blob(options) => planar::blob(casters, lamp, options),
            Self::Projective(options) => planar::projective(casters, lamp, options)?,
            Self::None => Box::new(Plain { value: 1.0, light: *light }),
            Self::Dark => Box::new(Plain { value: 0.0, light: *light }),
        })
    }

    /// Prepares and shades, on the CPU.
    ///
    /// # Errors
    ///
    /// [`PrepareError`] if the technique's data does not fit the memory.
    pub fn shade(self, request: &Request<'_>) -> Result<Visibility, PrepareError> {
        Ok(self.prepare(request.casters, request.lamp)?.shade(request.samples))
    }
}

/// A technique prepared for one lamp, ready for any number of views.
#[derive(Debug)]
pub struct Prepared<'a> {
    technique: Technique,
    shadow: Box<dyn LampShadow + 'a>,
}

impl Prepared<'_> {
    /// The technique.
    #[must_use]
    pub fn technique(&self) -> Technique {
        self.technique
    }

    /// Fraction of the lamp's light that reaches each sample.
    #[must_use]
    pub fn shade(&self, samples: &Samples) -> Visibility {
        self.shadow.shade(samples)
    }

    /// Memory held for the lamp, in bytes, without the casters.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.shadow.bytes()
    }

    /// Size of a shadow map's texel at the center of the scene, in mesh units; `None` without a map.
    #[must_use]
    pub fn texel_world(&self) -> Option<f64> {
        self.shadow.texel_world()
    }

    /// Depth bias of a shadow map for a plane that meets the light at 45°, as a distance along the light at
    /// the center of the scene, in mesh units; `None` without a map that is filtered.
    #[must_use]
    pub fn bias_world(&self) -> Option<f64> {
        self.shadow.bias_world()
    }
}
