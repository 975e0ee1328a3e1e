//! The steps that cost time, and the counts that their time depends on.

/// A step of a technique, or a part of the casters that several techniques share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Step {
    /// The ray tree over all faces.
    Tree,
    /// Topology, shells and proofs of the casters.
    Topology,
    /// Start of the graphics adapter and of its shaders.
    Device,
    /// The receivers' depth on a device.
    Prepass,
    /// A shadow ray for each sample.
    Rays,
    /// A light grid, and rays where it proves nothing.
    Hybrid,
    /// Samples sorted into cells, and the faces tested against them.
    AliasFree,
    /// Counting by winding numbers on the CPU.
    Counting,
    /// Counting by volumes that are rasterized on the CPU in tiles.
    Counter,
    /// Counting on a device.
    Stencil,
    /// Casters flattened onto one plane, and rays elsewhere.
    Planar,
    /// A shadow map, drawn and looked up.
    Map,
    /// Several shadow rays for each sample.
    Samples,
    /// The analytic fraction of the lamp that each sample sees.
    Area,
    /// A shadow map with a search around each sample.
    SoftMap,
    /// A shadow map, and several rays where it is not sure.
    SoftHybrid,
    /// One value for all samples.
    Plain,
}

/// What a step works on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Work {
    /// Number of samples of the picture.
    pub samples: f64,
    /// Number of samples that face the lamp.
    pub facing: f64,
    /// Number of casting faces.
    pub faces: f64,
    /// Number of facing samples that the technique passes to exact rays, or to the part of it that is exact.
    pub unsure: f64,
    /// Cells or texels along a side.
    pub side: f64,
    /// Rays for each sample that needs several, or texels that are read for each sample.
    pub each: f64,
}

impl Step {
    /// All steps.
    pub const ALL: [Self; 17] = [
        Self::Tree,
        Self::Topology,
        Self::Device,
        Self::Prepass,
        Self::Rays,
        Self::Hybrid,
        Self::AliasFree,
        Self::Counting,
        Self::Counter,
        Self::Stencil,
        Self::Planar,
        Self::Map,
        Self::Samples,
        Self::Area,
        Self::SoftMap,
        Self::SoftHybrid,
        Self::Plain,
    ];

    /// Name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Tree => "tree",
            Self::Topology => "topology",
            Self::Device => "device",
            Self::Prepass => "prepass",
            Self::Rays => "rays",
            Self::Hybrid => "hybrid",
            Self::AliasFree => "alias-free",
            Self::Counting => "counting",
            Self::Counter => "counter",
            Self::Stencil => "stencil",
            Self::Planar => "planar",
            Self::Map => "map",
            Self::Samples => "samples",
            Self::Area => "area",
            Self::SoftMap => "soft-map",
            Self::SoftHybrid => "soft-hybrid",
            Self::Plain => "plain",
        }
    }

    /// What the time is a sum of, for each of which there is a coefficient.
    #[must_use]
    pub fn features(self) -> &'static [&'static str] {
        match self {
            Self::Tree | Self::Topology => &["fixed", "faces"],
            Self::Device => &["fixed"],
            Self::Prepass => &["fixed", "samples", "faces"],
            Self::Rays => &["fixed", "samples", "ray_steps"],
            Self::Hybrid => &["fixed", "samples", "facing", "faces", "cells", "ray_steps"],
            Self::AliasFree => &["fixed", "samples", "facing", "faces"],
            Self::Counting | Self::Counter | Self::Stencil => &["fixed", "samples", "faces", "face_steps"],
            Self::Planar => &["fixed", "samples", "faces", "ray_steps"],
            Self::Map => &["fixed", "samples", "faces", "texels", "reads"],
            Self::Samples | Self::Area => &["fixed", "samples", "ray_steps"],
            Self::SoftMap => &["fixed", "samples", "faces", "texels", "reads"],
            Self::SoftHybrid => &["fixed", "samples", "faces", "texels", "ray_steps"],
            Self::Plain => &["fixed", "samples"],
        }
    }

    /// The counts of these features. Work that threads share is divided among them.
    pub(super) fn counts(self, work: &Work, threads: usize) -> impl Iterator<Item = f64> {
        let work = *work;
        let shared = move |count: f64| count / threads.max(1) as f64;
        // A ray visits as many boxes as the tree is deep.
        let depth = work.faces.max(2.0).ln();
        let rays = match self {
            Self::Rays => work.facing,
            Self::Samples => work.facing * work.each,
            Self::SoftHybrid => work.unsure * work.each,
            // The others cast one ray for each sample that they are not sure of.
            _ => work.unsure,
        };
        self.features().iter().map(move |&feature| match feature {
            "samples" => shared(work.samples),
            "facing" => shared(work.facing),
            "faces" => work.faces,
            // A step over all faces, to each of which a search leads.
            "face_steps" => shared(work.facing * depth),
            "ray_steps" => shared(rays * depth),
            "cells" => (work.side * work.side).min(work.facing),
            "texels" => work.side * work.side,
            "reads" => shared(work.facing * work.each),
            _ => 1.0,
        })
    }
}
