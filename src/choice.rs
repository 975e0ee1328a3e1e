//! What was chosen, and why: one type for every choice that the crate makes.

use std::fmt;

/// A choice and its reason. Displays as the reason in words.
///
/// ```
/// use umbrage::silhouette::SilhouetteMethod;
/// let choice = SilhouetteMethod::choose(12, usize::MAX);
/// assert_eq!(choice.what, SilhouetteMethod::Scan);
/// assert_eq!(choice.to_string(), "12 faces: a scan is done before a search has begun");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Choice<T> {
    /// What was chosen.
    pub what: T,
    /// Why.
    pub why: Reason,
}

impl<T> Choice<T> {
    pub(crate) fn new(what: T, why: Reason) -> Self {
        Self { what, why }
    }
}

impl<T> fmt::Display for Choice<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.why.fmt(f)
    }
}

/// Why something was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Reason {
    // Which faces of a shell cast.
    /// All faces were asked for.
    AllFacesAsked,
    /// Front faces were asked for.
    FrontFacesAsked,
    /// Back faces were asked for.
    BackFacesAsked,
    /// All faces: an edge of the shell does not have exactly two faces in opposite directions.
    NotWatertight,
    /// All faces: a face of the shell has no area.
    ZeroAreaFace,
    /// All faces: two faces of the shell intersect.
    MeetsItself,
    /// All faces: the search for self-intersections gave up.
    Unsettled,
    /// All faces: the shell has volume 0.
    NoVolume,
    /// All faces: the light lies on the shell, or so aligned with it that its winding number was not found.
    LightOnShell,
    /// All faces: the shell winds around the light.
    LightInside {
        /// How often.
        winding: i32,
    },
    /// Front faces: watertight, not self-intersecting, positive volume, and the light is outside.
    FrontFacesSuffice,
    /// Back faces: the same with a negative volume.
    BackFacesSuffice,

    // How a shell is counted by a stencil pass.
    /// z-pass was asked for.
    ZPassAsked,
    /// z-fail was asked for.
    ZFailAsked,
    /// z-pass: no face of the shell meets the convex hull of the light and the near rectangle.
    NothingBetween,
    /// z-fail: a face may meet that hull.
    MayLieBetween,

    // How a silhouette is found.
    /// Scan: there is too little to search.
    FewFaces {
        /// How many faces there are.
        faces: u32,
    },
    /// Scan: building a tree would take longer than it saves.
    FewLights {
        /// How many lights are expected.
        lights: u32,
    },
    /// Scan: many edges have other faces than two in opposite directions.
    OpenMesh,
    /// Scan: many faces lie in a plane with the light, or nearly.
    Ties,
    /// Scan: the silhouette runs through most of the mesh.
    Crowded,
    /// Tree: many lights are expected, and this one is not near the last.
    ColdLight,
    /// Tree: the light has moved so far that most certificates would expire.
    FarMove,
    /// Tree: the light seems to move slowly; certificates were made.
    SlowLight,
    /// Certificates: the light has moved little or not at all.
    SmallMove,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::AllFacesAsked => "all faces were asked for",
            Self::FrontFacesAsked => "front faces were asked for; nothing is proven",
            Self::BackFacesAsked => "back faces were asked for; nothing is proven",
            Self::NotWatertight => "the shell is not watertight",
            Self::ZeroAreaFace => "a face of the shell has no area",
            Self::MeetsItself => "the shell meets itself",
            Self::Unsettled => "too many faces reach into one place for a proof",
            Self::NoVolume => "the shell encloses no volume",
            Self::LightOnShell => "the light is on the shell",
            Self::LightInside { .. } => "the light is inside the shell",
            Self::BackFacesSuffice => {
                "watertight, faces inwards, does not meet itself, and the light is outside: back faces are enough"
            }
            Self::FrontFacesSuffice => {
                "watertight, does not meet itself, and the light is outside: front faces are enough"
            }
            Self::ZPassAsked => "z-pass was asked for; nothing is proven",
            Self::ZFailAsked => "z-fail was asked for",
            Self::NothingBetween => "nothing of it can lie between the light and the near rectangle",
            Self::MayLieBetween => "a face may lie between the light and the near rectangle",
            Self::FewFaces { faces } => {
                return write!(f, "{faces} faces: a scan is done before a search has begun");
            }
            Self::FewLights { lights: 1 } => {
                "one look a light: a scan of all edges costs less than building anything first"
            }
            Self::FewLights { lights } => {
                return write!(f, "{lights} lights: scans of all edges cost less than building a tree first");
            }
            Self::OpenMesh => "many edges do not join two faces in opposite directions: no tree holds them",
            Self::Ties => "many faces lie in a plane with the light: each is decided exactly anyway",
            Self::Crowded => "the silhouette runs through most of the mesh: no tree leaves out much of it",
            Self::ColdLight => "many lights: a tree leaves out most edges",
            Self::FarMove => "the light moved far: a tree leaves out most edges",
            Self::SlowLight => "the light moves slowly: searched once more, to follow it from here",
            Self::SmallMove => "the light moved little: only what may have changed is looked at",
        };
        f.write_str(text)
    }
}
