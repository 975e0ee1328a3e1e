//! Silhouettes of light after light by the cheapest method: scan, tree or certificates, and why.

use std::fmt;
use std::sync::Arc;

use crate::choice::{Choice, Reason};

use super::kinetic::travel;
use super::{KineticSilhouette, KineticStep, Silhouette, SilhouetteEdge, SilhouetteTree, TreeSearch};
use crate::caster::{Caster, CasterRule, KeptRule};
use crate::facing::FacePlanes;
use crate::geom::{Facing, Light};

/// With fewer faces than this, a scan takes about a microsecond.
const FEW_FACES: usize = 256;
/// Building the tree takes the time of about 256 scans, on scanned heads as on spheres.
const FEW_LIGHTS: usize = 256;
/// A light that moves less than this share of the reach of the mesh is expected to move on.
const SHORT_MOVE: f64 = 1.0 / 64.0;

/// A method to find silhouettes on the processor. All methods give the same edges.
///
/// ```
/// use umbrage::silhouette::SilhouetteMethod;
/// assert_eq!(SilhouetteMethod::choose(1_000_000, 3).what, SilhouetteMethod::Scan);
/// assert_eq!(SilhouetteMethod::choose(1_000_000, usize::MAX).what, SilhouetteMethod::Tree);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SilhouetteMethod {
    /// Every face, then every edge.
    Scan,
    /// [`SilhouetteTree`].
    Tree,
    /// [`KineticSilhouette`].
    Kinetic,
}

impl fmt::Display for SilhouetteMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Scan => "scan",
            Self::Tree => "tree",
            Self::Kinetic => "kinetic",
        })
    }
}

impl SilhouetteMethod {
    /// The method to begin with, scan or tree, for a mesh of `faces` faces and `lights` lights that are still
    /// to come.
    #[must_use]
    pub fn choose(faces: usize, lights: usize) -> Choice<Self> {
        if faces < FEW_FACES {
            Choice::new(Self::Scan, Reason::FewFaces { faces: faces as u32 }) // fewer than FEW_FACES
        } else if lights < FEW_LIGHTS {
            Choice::new(Self::Scan, Reason::FewLights { lights: lights as u32 }) // fewer than FEW_LIGHTS
        } else {
            Choice::new(Self::Tree, Reason::ColdLight)
        }
    }
}

/// The silhouettes of a caster at rest for one light after another, each found by the cheapest method.
///
/// Allocates nothing once its buffers have grown: those of a light that moves are made when it first moves a
/// little.
///
/// ```
/// use umbrage::caster::Caster;
/// use umbrage::geom::Light;
/// use umbrage::silhouette::{SilhouetteFinder, SilhouetteMethod};
/// use umbrage::testing::shapes;
/// let caster = Caster::new(shapes::icosphere(4));
/// let mut finder = SilhouetteFinder::new(&caster, usize::MAX);
/// let mut faces = Default::default(); // kept for its memory
/// let mut method = SilhouetteMethod::Scan;
/// for i in 0..5 {
///     let light = Light::point([3.0, 4.0, 5.0 + 0.0001 * i as f32])?;
///     caster.shell_faces_into(&light, None, &mut faces);
///     method = finder.find(&caster, &light, caster.rule(&faces)).what;
/// }
/// assert_eq!(method, SilhouetteMethod::Kinetic);
/// assert!(finder.edges().count() > 100);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SilhouetteFinder {
    lights: usize,
    planes: Arc<FacePlanes>,
    casters: KeptRule,
    last: Option<Light>,
    /// How the silhouette of the last light was found.
    found: Choice<SilhouetteMethod>,
    /// Its edges, unless it was found by certificates.
    list: Silhouette,
    edge_count: usize,
    /// `Σ|m|` over its edges.
    copies: usize,
    search: Search,
}

#[derive(Clone, Debug)]
enum Search {
    Scan { facing: Vec<Facing>, signs: Vec<i8>, reason: Reason },
    Tree { tree: Box<SilhouetteTree>, moving: Option<Box<KineticSilhouette>>, followed: bool, short: f64 },
}

impl SilhouetteFinder {
    /// Prepares for about `lights` lights; `usize::MAX` if there is no end of them. A tree costs about 200 ns
    /// per face.
    #[must_use]
    pub fn new(caster: &Caster, lights: usize) -> Self {
        let planes = caster.shared_planes().clone();
        let scan = |reason| Search::Scan { facing: Vec::new(), signs: Vec::new(), reason };
        let search = match SilhouetteMethod::choose(caster.mesh().face_count(), lights) {
            Choice { what: SilhouetteMethod::Scan, why } => scan(why),
            _ => {
                let tree = SilhouetteTree::with_planes(caster.mesh(), caster.topology(), planes.clone());
                if tree.is_idle() {
                    scan(Reason::OpenMesh)
                } else {
                    let short = SHORT_MOVE * f64::from(planes.reach());
                    Search::Tree { tree: Box::new(tree), moving: None, followed: false, short }
                }
            }
        };
        // Until there is a light.
        let found = Choice::new(SilhouetteMethod::Scan, Reason::FewLights { lights: 0 });
        let (casters, list) = (KeptRule::default(), Silhouette::default());
        Self { lights, planes, casters, last: None, found, list, edge_count: 0, copies: 0, search }
    }

    /// Takes the tree for any mesh and light.
    #[cfg(test)]
    pub(crate) fn unlimited(caster: &Caster) -> Self {
        let planes = caster.shared_planes().clone();
        let tree = SilhouetteTree::with_planes(caster.mesh(), caster.topology(), planes).unlimited();
        let short = SHORT_MOVE * f64::from(caster.planes().reach());
        let search = Search::Tree { tree: Box::new(tree), moving: None, followed: false, short };
        Self { search, ..Self::new(caster, usize::MAX) }
    }

    /// Finds the silhouette for a light. Returns the method, and why it was chosen.
    ///
    /// `casters` is a [`CasterFaces`](crate::facing::CasterFaces), or what [`Caster::rule`] gives; it may
    /// differ from light to light. For the same light and casters as the last time nothing is done. After
    /// [`Caster::repose`], and for another caster, the finder is first built again.
    ///
    /// # Panics
    ///
    /// Panics if `casters` are of another mesh.
    #[inline]
    pub fn find<'a>(
        &mut self,
        caster: &Caster,
        light: &Light,
        casters: impl Into<CasterRule<'a>>,
    ) -> Choice<SilhouetteMethod> {
        let casters = &casters.into();
        if !self.is_of(caster) {
            *self = Self::new(caster, self.lights);
        }
        if self.last.as_ref() != Some(light) || !self.casters.equals(casters) {
            self.found = self.search(caster, light, casters);
            self.last = Some(*light);
            self.casters.keep(casters);
            (self.edge_count, self.copies) = match self.moving() {
                Some(moving) => (moving.len(), moving.copies()),
                None => {
                    let copies = |edge: &SilhouetteEdge| edge.multiplicity.unsigned_abs() as usize;
                    (self.list.edges.len(), self.list.edges.iter().map(copies).sum())
                }
            };
        }
        self.found
    }

    /// Whether this was built for the caster as it is now.
    pub(crate) fn is_of(&self, caster: &Caster) -> bool {
        Arc::ptr_eq(&self.planes, caster.shared_planes())
    }

    fn search(
        &mut self,
        caster: &Caster,
        light: &Light,
        casters: &CasterRule<'_>,
    ) -> Choice<SilhouetteMethod> {
        let (mesh, topology) = (caster.mesh(), caster.topology());
        match &mut self.search {
            Search::Scan { facing, signs, reason } => {
                self.planes.classify_into(mesh, light, facing);
                casters.signs_into(facing, signs);
                self.list.extract_into(topology, signs);
                Choice::new(SilhouetteMethod::Scan, *reason)
            }
            Search::Tree { tree, moving, followed, short } => {
                let length = self.last.map_or(f64::INFINITY, |last| travel(&last, light));
                let short = length <= *short;
                let was_followed = std::mem::replace(followed, false);
                *followed = short && moving.as_ref().is_none_or(|moving| length <= moving.longest_step());
                if *followed {
                    let moving = moving.get_or_insert_with(|| {
                        let last = self.last.as_ref().expect("otherwise the length is infinite");
                        Box::new(KineticSilhouette::new(mesh, topology, tree, last, *casters))
                    });
                    self.list.edges.clear();
                    // If certificates were not used for the last light, their light is an earlier one.
                    let length = if was_followed { length } else { travel(&moving.light(), light) };
                    return match moving.step_by(mesh, topology, tree, light, length, casters) {
                        KineticStep::Rested | KineticStep::Followed { .. } => {
                            Choice::new(SilhouetteMethod::Kinetic, Reason::SmallMove)
                        }
                        KineticStep::Searched => Choice::new(SilhouetteMethod::Tree, Reason::FarMove),
                        KineticStep::Renewed => Choice::new(SilhouetteMethod::Tree, Reason::SlowLight),
                    };
                }
                if let Some(moving) = moving.as_mut().filter(|_| short) {
                    moving.wait();
                }
                match tree.search_into(mesh, topology, light, *casters, &mut self.list) {
                    TreeSearch::Scanned => Choice::new(SilhouetteMethod::Scan, Reason::Ties),
                    TreeSearch::Crowded => Choice::new(SilhouetteMethod::Scan, Reason::Crowded),
                    TreeSearch::Searched { .. } if short => {
                        Choice::new(SilhouetteMethod::Tree, Reason::FarMove)
                    }
                    TreeSearch::Searched { .. } => Choice::new(SilhouetteMethod::Tree, Reason::ColdLight),
                }
            }
        }
    }

    /// The silhouette edges for the last light, ascending.
    pub fn edges(&self) -> impl Iterator<Item = SilhouetteEdge> + '_ {
        let moving = self.moving().into_iter().flat_map(KineticSilhouette::edges);
        self.list.edges.iter().copied().chain(moving)
    }

    /// How many edges are silhouette for the last light.
    #[inline]
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.edge_count
    }

    /// `Σ|m|` over the silhouette: how many quads the sides of its volume are.
    #[inline]
    pub(crate) fn copies(&self) -> usize {
        self.copies
    }

    /// Whether anything but a scan is ever done.
    pub(crate) fn has_tree(&self) -> bool {
        matches!(self.search, Search::Tree { .. })
    }

    /// The sign that each face casts with for the last light, if they were all computed.
    pub(crate) fn signs(&self) -> Option<&[i8]> {
        match &self.search {
            _ if self.last.is_none() || self.found.what != SilhouetteMethod::Scan => None,
            Search::Scan { signs, .. } => Some(signs),
            Search::Tree { tree, .. } => Some(tree.scanned_signs()),
        }
    }

    /// What holds the last silhouette, if it was found by certificates.
    fn moving(&self) -> Option<&KineticSilhouette> {
        match &self.search {
            Search::Tree { moving, followed: true, .. } => moving.as_deref(),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facing::{CasterFaces, classify};
    use crate::mesh::Mesh;
    use crate::testing::shapes;

    #[test]
    fn silhouette_finder_takes_the_method_that_fits_the_move_and_says_why() {
        let caster = Caster::new(shapes::icosphere(6));
        let mut finder = SilhouetteFinder::new(&caster, usize::MAX);
        use Reason::{ColdLight, SmallMove};
        use SilhouetteMethod::{Kinetic, Tree};
        let expected = [
            ([3.0, 4.0, 5.0], Tree, ColdLight),
            ([3.0, 4.0001, 5.0], Kinetic, SmallMove),
            ([3.0, 4.0001, 5.0], Kinetic, SmallMove),
            ([-3.0, 4.0, 1.0], Tree, ColdLight),
        ];
        for (place, method, reason) in expected {
            let light = Light::point(place).unwrap();
            let found = finder.find(&caster, &light, CasterFaces::All);
            assert_eq!(found, Choice::new(method, reason), "{light}");
            let signs = CasterFaces::All.signs(&classify(caster.mesh(), &light));
            let silhouette = Silhouette::extract(caster.topology(), &signs);
            assert_eq!(finder.edges().collect::<Vec<_>>(), silhouette.edges, "{light}");
            assert_eq!(finder.edge_count(), silhouette.edges.len(), "{light}");
            assert_eq!(finder.copies(), 2 * silhouette.edges.len(), "{light}");
        }
    }

    #[test]
    fn silhouette_finder_scans_where_a_tree_does_not_pay() {
        let reason = |mesh: &Mesh, lights| {
            let caster = Caster::new(mesh.clone());
            let mut finder = SilhouetteFinder::new(&caster, lights);
            let light = Light::directional([1.0, 2.0, 3.0]).unwrap();
            let found = finder.find(&caster, &light, CasterFaces::Front);
            assert_eq!(found.what, SilhouetteMethod::Scan);
            let signs = CasterFaces::Front.signs(&classify(mesh, &light));
            assert_eq!(finder.signs(), Some(&signs[..]));
            let silhouette = Silhouette::extract(caster.topology(), &signs);
            assert_eq!(finder.edges().collect::<Vec<_>>(), silhouette.edges);
            found.why
        };
        let sphere = shapes::icosphere(3);
        assert_eq!(reason(&shapes::cube(), usize::MAX), Reason::FewFaces { faces: 12 });
        assert_eq!(reason(&sphere, 3), Reason::FewLights { lights: 3 });
        assert_eq!(reason(&shapes::soup(&sphere), usize::MAX), Reason::OpenMesh);
        // The light travels in the planes of most faces.
        let sponge = Caster::new(shapes::menger_sponge(2));
        let mut finder = SilhouetteFinder::new(&sponge, usize::MAX);
        let axis = Light::directional([0.0, 0.0, -1.0]).unwrap();
        let found = finder.find(&sponge, &axis, CasterFaces::All);
        assert_eq!(found, Choice::new(SilhouetteMethod::Scan, Reason::Ties));
    }

    #[test]
    fn silhouette_finder_is_built_again_for_another_pose() {
        let mut caster = Caster::new(shapes::icosphere(4));
        let mut finder = SilhouetteFinder::new(&caster, usize::MAX);
        let light = Light::point([3.0, 4.0, 5.0]).unwrap();
        finder.find(&caster, &light, CasterFaces::All);
        let before: Vec<SilhouetteEdge> = finder.edges().collect();
        let turned = caster.mesh().positions().iter().map(|&[x, y, z]| [y, -x, z]).collect();
        caster.repose(turned).unwrap();
        finder.find(&caster, &light, CasterFaces::All);
        let now: Vec<SilhouetteEdge> = finder.edges().collect();
        assert_eq!(now, caster.silhouette(&light, CasterFaces::All).edges);
        assert_ne!(now, before);
    }
}
