//! The closed list of techniques: one table with the name and the options of each.

use super::grid::GridOptions;
use super::lod::LodOptions;
use super::map::{ExactOptions, MapOptions, NearestOptions, PcfOptions};
use super::options::{self, Refusal};
use super::planar::{LayersOptions, PlanarOptions, TextureOptions};
use super::reconstruct::ReconstructOptions;
use super::soft::samples::SamplesOptions;
use super::soft::{PcssOptions, SilhouetteOptions, SingleSampleOptions, SoftHybridOptions, SoftMapOptions};
use super::stencil::CounterOptions;

/// Declares [`Technique`] by its table: `Variant(Options) = "name", hard|soft;`. A soft technique takes the
/// lamp's extent into account.
macro_rules! techniques {
    ($(#[$doc:meta])* $name:ident: $(
        $(#[$about:meta])* $variant:ident $(($options:ident))? = $text:literal, $kind:ident;
    )*) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum $name {
            $( $(#[$about])* $variant $(($options))?, )*
        }

        impl $name {
            /// The built techniques, with their default options.
            pub const ALL: [Self; [$($text),*].len()] = [ $( Self::$variant $(($options::DEFAULT))?, )* ];

            /// Name on the command line and in reports, without options.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $( techniques!(@any $variant $($options)?) => $text, )* }
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
                    $( $( Self::$variant(options) => { let options: $options = options; options::listed(&options) } )? )*
                    _ => Vec::new(),
                }
            }

            /// The technique with one option changed.
            pub(super) fn with(self, key: &str, value: &str) -> Result<Self, Refusal> {
                match self {
                    $( $( Self::$variant(options) => {
                        let options: $options = options;
                        options::changed(options, key, value).map(Self::$variant)
                    } )? )*
                    _ => Err(Refusal::Key),
                }
            }

            /// Whether the values of this technique take the lamp's extent into account, so that there are
            /// penumbrae.
            #[must_use]
            pub fn is_soft(self) -> bool {
                match self { $( techniques!(@any $variant $($options)?) => techniques!(@soft $kind), )* }
            }
        }
    };
    (@any $variant:ident) => { Self::$variant };
    (@any $variant:ident $options:ident) => { Self::$variant(_) };
    (@soft hard) => { false };
    (@soft soft) => { true };
}

techniques! {
    /// A technique that computes the shadows of one lamp, with its options.
    ///
    /// `Display` and `FromStr` use the form of the command line: the name, and behind a colon the options.
    ///
    /// ```
    /// use umbrage::shadow::Technique;
    /// assert_eq!("zfail".parse(), Ok(Technique::ZFail));
    /// assert_eq!("samples:n=16".parse::<Technique>()?.to_string(), "samples:n=16");
    /// assert_eq!(Technique::Rays.to_string(), "rays");
    /// assert_eq!("auto".parse::<Technique>().unwrap_err().to_string(), "not built yet: auto");
    /// # Ok::<(), umbrage::shadow::TechniqueError>(())
    /// ```
    Technique:
    /// An exact shadow ray per sample.
    Rays = "rays", hard;
    /// Shadow volumes, counted shell by shell: by z-pass where this is proven correct, otherwise by z-fail.
    Stencil = "stencil", hard;
    /// Shadow volumes, counted by z-fail for every shell.
    ZFail = "zfail", hard;
    /// Shadow volumes, counted by z-pass for every shell: wrong if the near rectangle of the camera is in a
    /// shadow.
    ZPass = "zpass", hard;
    /// Shadow volumes, counted by z-pass from the number of casting faces between the near rectangle and the
    /// lamp.
    ZPassPlus = "zpass-plus", hard;
    /// Shadow volumes, counted by the complement of z-fail's depth test: Bilodeau and Songy.
    ZPassReversed = "zpass-reversed", hard;
    /// Shadow volumes, rasterized on the CPU in tiles, each counted by the method with fewer triangles.
    Counter(CounterOptions) = "counter", hard;
    /// The mean of several exact shadow rays per sample, to points spread over the lamp.
    Samples(SamplesOptions) = "samples", soft;
    /// The analytic fraction of the lamp that each sample sees.
    Area = "area", soft;
    /// A shadow map with a bilinear filter, or none.
    Map(MapOptions) = "map", hard;
    /// A shadow map with a wider filter: percentage-closer filtering.
    Pcf(PcfOptions) = "pcf", hard;
    /// A shadow map of face numbers; the faces around a sample are tested exactly.
    MapIds(ExactOptions) = "map-ids", hard;
    /// A shadow map where the texels around a sample agree, an exact shadow ray elsewhere.
    Hybrid3x3(ExactOptions) = "hybrid-3x3", hard;
    /// The same with the four texels around a sample, as published by Chan and Durand in 2004.
    Hybrid2x2(NearestOptions) = "hybrid-2x2", hard;
    /// The shadow volume of the surface that a shadow map shows: McCool.
    Reconstruct(ReconstructOptions) = "reconstruct", hard;
    /// A shadow map, filtered as wide as the penumbra of the mean blocker: percentage-closer soft shadows.
    Pcss(PcssOptions) = "pcss", soft;
    /// A shadow map; the distance to the nearest edge in it gives the penumbra: Brabec and Seidel.
    SingleSample(SingleSampleOptions) = "single-sample", soft;
    /// Exact shadow rays to points of the lamp where a shadow map is not sure.
    SoftHybrid(SoftHybridOptions) = "soft-hybrid", soft;
    /// Two filtered moments of depth: variance shadow maps.
    Vsm(SoftMapOptions) = "vsm", soft;
    /// Four filtered moments of depth: moment shadow maps.
    Msm(SoftMapOptions) = "msm", soft;
    /// Exact silhouette edges, each with its own penumbra: penumbra maps.
    PenumbraMap(SilhouetteOptions) = "penumbra-map", soft;
    /// Exact silhouette edges with one width in the map: smoothies.
    Smoothies(SilhouetteOptions) = "smoothies", soft;
    /// The exact hard shadow, blurred in the picture as wide as the penumbra.
    ContactBlur(SoftMapOptions) = "contact-blur", soft;
    /// A light grid where it proves lit or dark, an exact shadow ray elsewhere.
    Hybrid(GridOptions) = "hybrid", hard;
    /// The samples sorted into cells, and every face tested exactly against those of its cells.
    AliasFree(GridOptions) = "alias-free", hard;
    /// Shells of which no lit side is seen, simplified within a tolerance; exact shadow rays.
    Lod(LodOptions) = "lod", hard;
    /// Casters flattened onto the plane of most samples, decided exactly; exact shadow rays elsewhere.
    Planar(PlanarOptions) = "planar", hard;
    /// The planar shadow, blurred by one width.
    PlanarBlur(TextureOptions) = "planar-blur", soft;
    /// The planar shadow, blurred as wide as the height of the casters suggests.
    PlanarContact(TextureOptions) = "planar-contact", soft;
    /// The mean of planar shadows from points spread over the lamp.
    PlanarLayers(LayersOptions) = "planar-layers", soft;
    /// A dark spot on the plane under each shell: the bounding sphere's ambient occlusion.
    Blob(PlanarOptions) = "blob", hard;
    /// A map of what casters cover, projected from the lamp onto receivers.
    Projective(TextureOptions) = "projective", hard;
    /// No shadows: every front-lit sample is lit.
    None = "none", hard;
    /// No light: every sample is dark.
    Dark = "dark", hard;
}

impl Technique {
    /// The technique as [`Technique::ALL`] lists it.
    pub(super) fn with_default_options(self) -> Self {
        Self::ALL.into_iter().find(|technique| technique.name() == self.name()).unwrap_or(self)
    }
}
