//! The closed list of techniques, and the two steps of each: prepare for a light, shade samples.

use std::fmt;
use std::str::FromStr;

use super::plain::Plain;
use super::rays::Rays;
use super::stencil::StencilCounting;
use super::{Samples, Visibility};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::shadow::stencil::StencilMethod;

/// A technique that computes the shadows of one light.
///
/// `Display` and `FromStr` use the name on the command line.
///
/// ```
/// use umbrage::shadow::Technique;
/// assert_eq!("zfail".parse(), Ok(Technique::ZFail));
/// assert_eq!(Technique::Rays.to_string(), "rays");
/// assert_eq!("msm".parse::<Technique>().unwrap_err().to_string(), "not built yet: msm");
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
    /// No shadows: every front-lit sample is lit.
    None,
    /// No light: every sample is dark.
    Dark,
}

/// Input of a technique: casters, light and samples.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The shadow casters.
    pub casters: &'a CasterGroup<'a>,
    /// The light.
    pub light: &'a Light,
    /// The visible points.
    pub samples: &'a Samples,
}

/// Error of a text that names no [`Technique`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TechniqueError {
    /// The technique of this name is planned, but not built yet.
    #[error("not built yet: {0}")]
    NotBuilt(String),
    /// No technique has this name.
    #[error("`{0}` is not a technique; write one of {names}", names = names())]
    Unknown(String),
    /// The technique has no such option.
    #[error("`{technique}` has no option `{key}`; {has}", has = keys(technique))]
    UnknownKey {
        /// The technique's name.
        technique: &'static str,
        /// The unknown key.
        key: String,
    },
}

/// Names of planned techniques.
const PLANNED: [&str; 29] = [
    "auto",
    "zpass-plus",
    "zpass-reversed",
    "hybrid",
    "hybrid-3x3",
    "hybrid-2x2",
    "alias-free",
    "counter",
    "reconstruct",
    "lod",
    "map",
    "map-ids",
    "pcf",
    "vsm",
    "msm",
    "pcss",
    "single-sample",
    "smoothies",
    "penumbra-map",
    "contact-blur",
    "soft-hybrid",
    "samples",
    "area",
    "planar",
    "planar-blur",
    "planar-contact",
    "planar-layers",
    "blob",
    "projective",
];

fn names() -> String {
    Technique::ALL.map(Technique::name).join(", ")
}

fn keys(_technique: &str) -> &'static str {
    "it has none" // no built technique has any option
}

impl Technique {
    /// The built techniques.
    pub const ALL: [Self; 6] = [Self::Rays, Self::Stencil, Self::ZFail, Self::ZPass, Self::None, Self::Dark];

    /// Name on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Rays => "rays",
            Self::Stencil => "stencil",
            Self::ZFail => "zfail",
            Self::ZPass => "zpass",
            Self::None => "none",
            Self::Dark => "dark",
        }
    }

    /// Prepares the data that stays valid while only the camera moves: shadow volumes, for the techniques
    /// that use them.
    #[must_use]
    pub fn prepare<'a>(self, casters: &'a CasterGroup<'a>, light: &Light) -> Prepared<'a> {
        let counting = |method| Step::Counting(StencilCounting::prepare(casters, light, method));
        let step = match self {
            Self::Rays => Step::Rays(Rays::prepare(casters)),
            Self::Stencil => counting(None),
            Self::ZFail => counting(Some(StencilMethod::ZFail)),
            Self::ZPass => counting(Some(StencilMethod::ZPass)),
            Self::None => Step::Plain(Plain::Lit),
            Self::Dark => Step::Plain(Plain::Dark),
        };
        Prepared { technique: self, light: *light, step }
    }

    /// Prepares and shades, on the CPU.
    #[must_use]
    pub fn shade(self, request: &Request<'_>) -> Visibility {
        self.prepare(request.casters, request.light).shade(request.samples)
    }
}

/// A technique prepared for one light, ready for any number of views.
#[derive(Debug)]
pub struct Prepared<'a> {
    technique: Technique,
    light: Light,
    step: Step<'a>,
}

#[derive(Debug)]
enum Step<'a> {
    Rays(Rays<'a>),
    Counting(StencilCounting<'a>),
    Plain(Plain),
}

impl Prepared<'_> {
    /// The technique.
    #[must_use]
    pub fn technique(&self) -> Technique {
        self.technique
    }

    /// Fraction of the light that reaches each sample.
    #[must_use]
    pub fn shade(&self, samples: &Samples) -> Visibility {
        match &self.step {
            Step::Rays(rays) => rays.shade(&self.light, samples),
            Step::Counting(counting) => counting.shade(samples),
            Step::Plain(plain) => plain.shade(&self.light, samples),
        }
    }

    /// Memory held for the light, in bytes, without the casters.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.step {
            Step::Rays(_) | Step::Plain(_) => 0,
            Step::Counting(counting) => counting.bytes(),
        }
    }
}

impl fmt::Display for Technique {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Technique {
    type Err = TechniqueError;

    fn from_str(text: &str) -> Result<Self, TechniqueError> {
        let (name, options) = text.split_once(':').unwrap_or((text, ""));
        let found = Self::ALL.into_iter().find(|technique| technique.name() == name);
        let Some(technique) = found else {
            return Err(match PLANNED.contains(&name) {
                true => TechniqueError::NotBuilt(name.to_owned()),
                false => TechniqueError::Unknown(name.to_owned()),
            });
        };
        match options.split(',').find(|option| !option.is_empty()) {
            None => Ok(technique),
            Some(option) => {
                let key = option.split('=').next().unwrap_or(option).to_owned();
                Err(TechniqueError::UnknownKey { technique: technique.name(), key })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn technique_names_parse_back_and_others_are_told_apart() {
        for technique in Technique::ALL {
            assert_eq!(technique.to_string().parse(), Ok(technique));
            assert!(!PLANNED.contains(&technique.name()));
        }
        let error = |text: &str| text.parse::<Technique>().unwrap_err().to_string();
        assert_eq!(error("projective:size=64"), "not built yet: projective");
        assert_eq!(
            error("ray"),
            "`ray` is not a technique; write one of rays, stencil, zfail, zpass, none, dark"
        );
        assert_eq!(error("zfail:size=3,x"), "`zfail` has no option `size`; it has none");
    }
}
