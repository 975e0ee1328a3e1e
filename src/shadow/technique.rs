//! The closed list of techniques, and the two steps of each: prepare for a lamp, shade samples.

use super::grid::{GridHybrid, GridOptions};
use super::map::{ExactOptions, HybridShadow, IdShadow, MapError, MapOptions, MapShadow, PcfOptions};
use super::options::{self, Refusal};
use super::plain::Plain;
use super::planar::{self, LayersOptions, PlanarOptions, PlanarShadow, TextureOptions};
use super::rays::Rays;
use super::soft::area::LampArea;
use super::soft::samples::{LampSamples, SamplesOptions};
use super::soft::{
    self, PcssOptions, SilhouetteOptions, SingleSampleOptions, SoftHybridOptions, SoftMapOptions, SoftShadow,
};
use super::stencil::StencilCounting;
use super::{Samples, Visibility};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::scene::Lamp;
use crate::shadow::stencil::StencilMethod;

/// A technique that computes the shadows of one lamp, with its options.
///
/// `Display` and `FromStr` use the form of the command line: the name, and behind a colon the options.
///
/// ```
/// use umbrage::shadow::Technique;
/// assert_eq!("zfail".parse(), Ok(Technique::ZFail));
/// assert_eq!("samples:n=16".parse::<Technique>()?.to_string(), "samples:n=16");
/// assert_eq!(Technique::Rays.to_string(), "rays");
/// assert_eq!("lod".parse::<Technique>().unwrap_err().to_string(), "not built yet: lod");
/// # Ok::<(), umbrage::shadow::TechniqueError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Technique {
    /// An exact shadow ray per sample.
    Rays,
    /// Shadow volumes, counted shell by shell: by z-pass where this is proven correct, otherwise by z-fail.
    Stencil,
    /// Shadow volumes, counted by z-fail for every shell.
    ZFail,
    /// Shadow volumes, counted by z-pass for every shell: wrong if the near rectangle of the camera is in a
    /// shadow.
    ZPass,
    /// The mean of several exact shadow rays per sample, to points spread over the lamp.
    Samples(SamplesOptions),
    /// The analytic fraction of the lamp that each sample sees.
    Area,
    /// A shadow map with a bilinear filter, or none.
    Map(MapOptions),
    /// A shadow map with a wider filter: percentage-closer filtering.
    Pcf(PcfOptions),
    /// A shadow map of face numbers; the faces around a sample are tested exactly.
    MapIds(ExactOptions),
    /// A shadow map where the texels around a sample agree, an exact shadow ray elsewhere.
    Hybrid3x3(ExactOptions),
    /// A shadow map, filtered as wide as the penumbra of the mean blocker: percentage-closer soft shadows.
    Pcss(PcssOptions),
    /// A shadow map; the distance to the nearest edge in it gives the penumbra: Brabec and Seidel.
    SingleSample(SingleSampleOptions),
    /// Exact shadow rays to points of the lamp where a shadow map is not sure.
    SoftHybrid(SoftHybridOptions),
    /// Two filtered moments of depth: variance shadow maps.
    Vsm(SoftMapOptions),
    /// Four filtered moments of depth: moment shadow maps.
    Msm(SoftMapOptions),
    /// Exact silhouette edges, each with its own penumbra: penumbra maps.
    PenumbraMap(SilhouetteOptions),
    /// Exact silhouette edges with one width in the map: smoothies.
    Smoothies(SilhouetteOptions),
    /// The exact hard shadow, blurred in the picture as wide as the penumbra.
    ContactBlur(SoftMapOptions),
    /// A light grid where it proves lit or dark, an exact shadow ray elsewhere.
    Hybrid(GridOptions),
    /// Casters flattened onto the plane of most samples, decided exactly; exact shadow rays elsewhere.
    Planar(PlanarOptions),
    /// The planar shadow, blurred by one width.
    PlanarBlur(TextureOptions),
    /// The planar shadow, blurred as wide as the height of the casters suggests.
    PlanarContact(TextureOptions),
    /// The mean of planar shadows from points spread over the lamp.
    PlanarLayers(LayersOptions),
    /// A dark spot on the plane under each shell: the bounding sphere's ambient occlusion.
    Blob(PlanarOptions),
    /// A map of what casters cover, projected from the lamp onto receivers.
    Projective(TextureOptions),
    /// No shadows: every front-lit sample is lit.
    None,
    /// No light: every sample is dark.
    Dark,
}

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
    /// The technique's data does not fit the memory.
    #[error("{technique}: {bytes} bytes do not fit the memory; choose a smaller {option}")]
    Memory {
        /// The technique, with its options.
        technique: Technique,
        /// What was asked for.
        bytes: usize,
        /// The option that decides about the memory.
        option: &'static str,
    },
    /// The technique's shadow map cannot be made.
    #[error("{technique}: {error}")]
    Map {
        /// The technique, with its options.
        technique: Technique,
        /// Why not.
        error: MapError,
    },
}

impl Technique {
    /// The built techniques, with their default options.
    pub const ALL: [Self; 27] = [
        Self::Rays,
        Self::Stencil,
        Self::ZFail,
        Self::ZPass,
        Self::Samples(SamplesOptions::DEFAULT),
        Self::Area,
        Self::Map(MapOptions::DEFAULT),
        Self::Pcf(PcfOptions::DEFAULT),
        Self::MapIds(ExactOptions::DEFAULT),
        Self::Hybrid3x3(ExactOptions::DEFAULT),
        Self::Pcss(PcssOptions::DEFAULT),
        Self::SingleSample(SingleSampleOptions::DEFAULT),
        Self::SoftHybrid(SoftHybridOptions::DEFAULT),
        Self::Vsm(SoftMapOptions::DEFAULT),
        Self::Msm(SoftMapOptions::DEFAULT),
        Self::PenumbraMap(SilhouetteOptions::DEFAULT),
        Self::Smoothies(SilhouetteOptions::DEFAULT),
        Self::ContactBlur(SoftMapOptions::DEFAULT),
        Self::Hybrid(GridOptions::DEFAULT),
        Self::Planar(PlanarOptions::DEFAULT),
        Self::PlanarBlur(TextureOptions::DEFAULT),
        Self::PlanarContact(TextureOptions::DEFAULT),
        Self::PlanarLayers(LayersOptions::DEFAULT),
        Self::Blob(PlanarOptions::DEFAULT),
        Self::Projective(TextureOptions::DEFAULT),
        Self::None,
        Self::Dark,
    ];

    /// Name on the command line and in reports, without options.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Rays => "rays",
            Self::Stencil => "stencil",
            Self::ZFail => "zfail",
            Self::ZPass => "zpass",
            Self::Samples(_) => "samples",
            Self::Area => "area",
            Self::Map(_) => "map",
            Self::Pcf(_) => "pcf",
            Self::MapIds(_) => "map-ids",
            Self::Hybrid3x3(_) => "hybrid-3x3",
            Self::Pcss(_) => "pcss",
            Self::SingleSample(_) => "single-sample",
            Self::SoftHybrid(_) => "soft-hybrid",
            Self::Vsm(_) => "vsm",
            Self::Msm(_) => "msm",
            Self::PenumbraMap(_) => "penumbra-map",
            Self::Smoothies(_) => "smoothies",
            Self::ContactBlur(_) => "contact-blur",
            Self::Hybrid(_) => "hybrid",
            Self::Planar(_) => "planar",
            Self::PlanarBlur(_) => "planar-blur",
            Self::PlanarContact(_) => "planar-contact",
            Self::PlanarLayers(_) => "planar-layers",
            Self::Blob(_) => "blob",
            Self::Projective(_) => "projective",
            Self::None => "none",
            Self::Dark => "dark",
        }
    }

    /// The options with their values, in a fixed order; empty for a technique without options.
    ///
    /// ```
    /// # use umbrage::shadow::Technique;
    /// assert_eq!("samples".parse::<Technique>()?.parameters(), [("n", "64".to_owned())]);
    /// # Ok::<(), umbrage::shadow::TechniqueError>(())
    /// ```
    #[must_use]
    pub fn parameters(self) -> Vec<(&'static str, String)> {
        match self {
            Self::Samples(options) => options::listed(&options),
            Self::Map(options) => options::listed(&options),
            Self::Pcf(options) => options::listed(&options),
            Self::MapIds(options) | Self::Hybrid3x3(options) => options::listed(&options),
            Self::Pcss(options) => options::listed(&options),
            Self::SingleSample(options) => options::listed(&options),
            Self::SoftHybrid(options) => options::listed(&options),
            Self::Vsm(options) => options::listed(&options),
            Self::Msm(options) => options::listed(&options),
            Self::PenumbraMap(options) => options::listed(&options),
            Self::Smoothies(options) => options::listed(&options),
            Self::ContactBlur(options) => options::listed(&options),
            Self::Hybrid(options) => options::listed(&options),
            Self::Planar(options) | Self::Blob(options) => options::listed(&options),
            Self::PlanarBlur(options) | Self::PlanarContact(options) | Self::Projective(options) => {
                options::listed(&options)
            }
            Self::PlanarLayers(options) => options::listed(&options),
            _ => Vec::new(),
        }
    }

    /// The technique with one option changed.
    pub(super) fn with(self, key: &str, value: &str) -> Result<Self, Refusal> {
        match self {
            Self::Samples(options) => options::changed(options, key, value).map(Self::Samples),
            Self::Map(options) => options::changed(options, key, value).map(Self::Map),
            Self::Pcf(options) => options::changed(options, key, value).map(Self::Pcf),
            Self::MapIds(options) => options::changed(options, key, value).map(Self::MapIds),
            Self::Hybrid3x3(options) => options::changed(options, key, value).map(Self::Hybrid3x3),
            Self::Pcss(options) => options::changed(options, key, value).map(Self::Pcss),
            Self::SingleSample(options) => options::changed(options, key, value).map(Self::SingleSample),
            Self::SoftHybrid(options) => options::changed(options, key, value).map(Self::SoftHybrid),
            Self::Vsm(options) => options::changed(options, key, value).map(Self::Vsm),
            Self::Msm(options) => options::changed(options, key, value).map(Self::Msm),
            Self::PenumbraMap(options) => options::changed(options, key, value).map(Self::PenumbraMap),
            Self::Smoothies(options) => options::changed(options, key, value).map(Self::Smoothies),
            Self::ContactBlur(options) => options::changed(options, key, value).map(Self::ContactBlur),
            Self::Hybrid(options) => options::changed(options, key, value).map(Self::Hybrid),
            Self::Planar(options) => options::changed(options, key, value).map(Self::Planar),
            Self::PlanarBlur(options) => options::changed(options, key, value).map(Self::PlanarBlur),
            Self::PlanarContact(options) => options::changed(options, key, value).map(Self::PlanarContact),
            Self::PlanarLayers(options) => options::changed(options, key, value).map(Self::PlanarLayers),
            Self::Blob(options) => options::changed(options, key, value).map(Self::Blob),
            Self::Projective(options) => options::changed(options, key, value).map(Self::Projective),
            _ => Err(Refusal::Key),
        }
    }

    /// The technique as [`Technique::ALL`] lists it.
    pub(super) fn with_default_options(self) -> Self {
        Self::ALL.into_iter().find(|technique| technique.name() == self.name()).unwrap_or(self)
    }

    /// Whether the values of this technique take the lamp's extent into account, so that there are penumbrae.
    #[must_use]
    pub fn is_soft(self) -> bool {
        match self {
            Self::Samples(_)
            | Self::Area
            | Self::Pcss(_)
            | Self::SingleSample(_)
            | Self::SoftHybrid(_)
            | Self::Vsm(_)
            | Self::Msm(_)
            | Self::PenumbraMap(_)
            | Self::Smoothies(_)
            | Self::ContactBlur(_)
            | Self::PlanarBlur(_)
            | Self::PlanarContact(_)
            | Self::PlanarLayers(_) => true,
            Self::Rays
            | Self::Stencil
            | Self::ZFail
            | Self::ZPass
            | Self::Map(_)
            | Self::Pcf(_)
            | Self::MapIds(_)
            | Self::Hybrid3x3(_)
            | Self::Hybrid(_)
            | Self::Planar(_)
            | Self::Blob(_)
            | Self::Projective(_)
            | Self::None
            | Self::Dark => false,
        }
    }

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
        let light = lamp.light();
        let counting = |method| Step::Counting(StencilCounting::prepare(casters, light, method));
        let refused = |error| PrepareError::Map { technique: self, error };
        let step = match self {
            Self::Rays => Step::Rays(Rays::prepare(casters)),
            Self::Stencil => counting(None),
            Self::ZFail => counting(Some(StencilMethod::ZFail)),
            Self::ZPass => counting(Some(StencilMethod::ZPass)),
            Self::Samples(options) => Step::Samples(LampSamples::prepare(casters, lamp, options)),
            Self::Area => Step::Area(LampArea::prepare(casters, lamp)),
            Self::Map(options) | Self::Pcf(PcfOptions(options)) => {
                Step::Map(Box::new(MapShadow::prepare(casters, lamp, &options).map_err(refused)?))
            }
            Self::MapIds(options) => {
                Step::Ids(Box::new(IdShadow::prepare(casters, lamp, &options).map_err(refused)?))
            }
            Self::Hybrid3x3(options) => {
                Step::Hybrid(Box::new(HybridShadow::prepare(casters, lamp, &options).map_err(refused)?))
            }
            Self::Pcss(options) => Step::Soft(soft::pcss(casters, lamp, options).map_err(refused)?),
            Self::SingleSample(options) => {
                Step::Soft(soft::single_sample(casters, lamp, options).map_err(refused)?)
            }
            Self::SoftHybrid(options) => {
                Step::Soft(soft::soft_hybrid(casters, lamp, options).map_err(refused)?)
            }
            Self::Vsm(options) => Step::Soft(soft::vsm(casters, lamp, options).map_err(refused)?),
            Self::Msm(options) => Step::Soft(soft::msm(casters, lamp, options).map_err(refused)?),
            Self::PenumbraMap(options) => {
                Step::Soft(soft::penumbra_map(casters, lamp, options).map_err(refused)?)
            }
            Self::Smoothies(options) => Step::Soft(soft::smoothies(casters, lamp, options).map_err(refused)?),
            Self::ContactBlur(options) => {
                Step::Soft(soft::contact_blur(casters, lamp, options).map_err(refused)?)
            }
            Self::Hybrid(options) => Step::Grid(GridHybrid::prepare(casters, light, options)),
            Self::Planar(options) => Step::Planar(planar::planar(casters, lamp, options)),
            Self::PlanarBlur(options) => Step::Planar(planar::planar_blur(casters, lamp, options)),
            Self::PlanarContact(options) => Step::Planar(planar::planar_contact(casters, lamp, options)),
            Self::PlanarLayers(options) => Step::Planar(planar::planar_layers(casters, lamp, options)),
            Self::Blob(options) => Step::Planar(planar::blob(casters, lamp, options)),
            Self::Projective(options) => {
                Step::Planar(planar::projective(casters, lamp, options).map_err(refused)?)
            }
            Self::None => Step::Plain(Plain::Lit),
            Self::Dark => Step::Plain(Plain::Dark),
        };
        Ok(Prepared { technique: self, lamp: lamp.clone(), step })
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
    lamp: Lamp,
    step: Step<'a>,
}

#[derive(Debug)]
enum Step<'a> {
    Rays(Rays<'a>),
    Counting(StencilCounting<'a>),
    Samples(LampSamples<'a>),
    Area(LampArea<'a>),
    Map(Box<MapShadow<'a>>),
    Ids(Box<IdShadow<'a>>),
    Hybrid(Box<HybridShadow<'a>>),
    Soft(Box<dyn SoftShadow + 'a>),
    Grid(GridHybrid<'a>),
    Planar(Box<dyn PlanarShadow + 'a>),
    Plain(Plain),
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
        match &self.step {
            Step::Rays(rays) => rays.shade(self.lamp.light(), samples),
            Step::Counting(counting) => counting.shade(samples),
            Step::Samples(rays) => rays.shade(samples),
            Step::Area(area) => area.shade(samples),
            Step::Map(map) => map.shade(samples),
            Step::Ids(map) => map.shade(samples),
            Step::Hybrid(map) => map.shade(samples),
            Step::Soft(map) => {
                let mut visibility = map.shade(samples);
                if !map.sees_horizon() {
                    soft::above_horizon(&mut visibility, samples, &self.lamp);
                }
                visibility
            }
            Step::Grid(grid) => grid.shade(samples),
            Step::Planar(planar) => planar.shade(samples),
            Step::Plain(plain) => plain.shade(self.lamp.light(), samples),
        }
    }

    /// Memory held for the lamp, in bytes, without the casters.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.step {
            Step::Rays(_) | Step::Plain(_) => 0,
            Step::Counting(counting) => counting.bytes(),
            Step::Samples(rays) => rays.bytes(),
            Step::Area(area) => area.bytes(),
            Step::Map(map) => map.bytes(),
            Step::Ids(map) => map.bytes(),
            Step::Hybrid(map) => map.bytes(),
            Step::Soft(map) => map.bytes(),
            Step::Grid(grid) => grid.bytes(),
            Step::Planar(planar) => planar.bytes(),
        }
    }

    /// Size of a shadow map's texel at the center of the scene, in mesh units; `None` without a map.
    #[must_use]
    pub fn texel_world(&self) -> Option<f64> {
        match &self.step {
            Step::Map(map) => Some(map.texel_world()),
            Step::Ids(map) => Some(map.texel_world()),
            Step::Hybrid(map) => Some(map.texel_world()),
            Step::Soft(map) => Some(map.texel_world()),
            Step::Planar(planar) => planar.texel_world(),
            _ => None,
        }
    }

    /// Depth bias of a shadow map for a plane that meets the light at 45°, as a distance along the light at
    /// the center of the scene, in mesh units; `None` without a map that is filtered.
    #[must_use]
    pub fn bias_world(&self) -> Option<f64> {
        match &self.step {
            Step::Map(map) => Some(map.bias_world()),
            Step::Soft(map) => Some(map.bias_world()),
            _ => None,
        }
    }
}
