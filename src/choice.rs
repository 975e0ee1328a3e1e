//! A choice with its reason: one type for every automatic choice of the crate.

use std::fmt;

/// A choice and its reason. `Display` writes the reason in words.
///
/// ```
/// use umbrage::silhouette::SilhouetteMethod;
/// let choice = SilhouetteMethod::choose(12, usize::MAX);
/// assert_eq!(choice.what, SilhouetteMethod::Scan);
/// assert_eq!(choice.to_string(), "12 faces: a scan is done before a search has begun");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Choice<T> {
    /// The chosen value.
    pub what: T,
    /// The reason for `what`.
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

/// Reason for a [`Choice`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Reason {
    // Faces of a shell that cast the shadow volume.
    /// All faces were asked for.
    AllFacesAsked,
    /// Front faces were asked for.
    FrontFacesAsked,
    /// Back faces were asked for.
    BackFacesAsked,
    /// All faces cast: some edge of the shell does not have exactly two faces in opposite directions.
    NotWatertight,
    /// All faces cast: a face of the shell has zero area.
    ZeroAreaFace,
    /// All faces cast: two faces of the shell intersect.
    MeetsItself,
    /// All faces cast: the search for self-intersections gave up.
    Unsettled,
    /// All faces cast: the shell has zero volume.
    NoVolume,
    /// All faces cast: the light lies on the shell, or is so aligned with the shell that no winding number
    /// was found.
    LightOnShell,
    /// All faces cast: the shell winds around the light.
    LightInside {
        /// Winding number of the shell around the light.
        winding: i32,
    },
    /// Front faces cast: the shell is watertight, has no self-intersection and has positive volume, and the
    /// light is outside.
    FrontFacesSuffice,
    /// Back faces cast: as [`Reason::FrontFacesSuffice`], but with negative volume.
    BackFacesSuffice,

    // Stencil counting method of a shell.
    /// z-pass was asked for.
    ZPassAsked,
    /// z-fail was asked for.
    ZFailAsked,
    /// z-pass: no face of the shell intersects the convex hull of the light and the near rectangle.
    NothingBetween,
    /// z-fail: a face of the shell may intersect the convex hull of the light and the near rectangle.
    MayLieBetween,

    // Search method for the silhouette.
    /// Linear scan: the mesh is too small for a search to pay.
    FewFaces {
        /// Number of faces.
        faces: u32,
    },
    /// Linear scan: building a tree would take longer than the tree saves.
    FewLights {
        /// Number of lights expected.
        lights: u32,
    },
    /// Linear scan: many edges do not have exactly two faces in opposite directions.
    OpenMesh,
    /// Linear scan: the light lies in, or nearly in, the planes of many faces.
    Ties,
    /// Linear scan: the silhouette runs through most of the mesh.
    Crowded,
    /// Tree: many lights are expected, and the present light is far from the previous one.
    ColdLight,
    /// Tree: the light has moved so far that most certificates would expire.
    FarMove,
    /// Tree: the light seems to move slowly, so certificates were made during the search.
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
            Self::NothingBetween => {
                "no face of the shell can lie between the light and the near rectangle of the camera"
            }
            Self::MayLieBetween => {
                "a face of the shell may lie between the light and the near rectangle of the camera"
            }
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
