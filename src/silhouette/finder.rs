//! Which way to a silhouette is the cheapest: scan, tree or certificates, and why.

use std::fmt;

use super::kinetic::way;
use super::{KineticSilhouette, KineticStep, Silhouette, SilhouetteEdge, SilhouetteTree, TreeSearch};
use crate::facing::{CasterFaces, FacePlanes};
use crate::geom::Facing;
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::topology::Topology;

/// Below so many faces a scan takes about a microsecond.
const FEW_FACES: usize = 256;
/// Building the tree takes the time of about so many scans, on scanned heads as on spheres.
const FEW_LIGHTS: usize = 256;
/// A light that moves less than this share of the mesh's reach is taken for one that moves on.
const SHORT_MOVE: f64 = 1.0 / 64.0;

/// A way to find silhouettes on the processor. All give the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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

/// Why a [`SilhouetteMethod`] was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SilhouetteReason {
    /// Scan: there is too little to search.
    FewFaces {
        /// How many faces there are.
        faces: usize,
    },
    /// Scan: building a tree would take longer than it saves.
    FewLights {
        /// How many lights are expected.
        lights: usize,
    },
    /// Scan: many edges have other faces than two in opposite directions.
    OpenMesh,
    /// Scan: many faces lie in a plane with the light, or nearly.
    Ties,
    /// Scan: the silhouette runs through most of the mesh.
    Crowded,
    /// Tree: many lights are expected, and this one is not near the last.
    ColdLight,
    /// Tree: the light has moved so far that most certificates would run out.
    FarMove,
    /// Tree: the light seems to move slowly; certificates were made.
    SlowLight,
    /// Certificates: the light has moved little or not at all.
    SmallMove,
}

impl fmt::Display for SilhouetteReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FewFaces { faces } => write!(f, "{faces} faces: a scan is done before a search has begun"),
            Self::FewLights { lights: 1 } => {
                f.write_str("one look a light: a scan of all edges costs less than building anything first")
            }
            Self::FewLights { lights } => {
                write!(f, "{lights} lights: scans of all edges cost less than building a tree first")
            }
            Self::OpenMesh => {
                f.write_str("many edges do not join two faces in opposite directions: no tree holds them")
            }
            Self::Ties => {
                f.write_str("many faces lie in a plane with the light: each is decided exactly anyway")
            }
            Self::Crowded => {
                f.write_str("the silhouette runs through most of the mesh: no tree leaves out much of it")
            }
            Self::ColdLight => f.write_str("many lights: a tree leaves out most edges"),
            Self::FarMove => f.write_str("the light moved far: a tree leaves out most edges"),
            Self::SlowLight => {
                f.write_str("the light moves slowly: searched once more, to follow it from here")
            }
            Self::SmallMove => f.write_str("the light moved little: only what may have changed is looked at"),
        }
    }
}

impl SilhouetteMethod {
    /// The way to begin with, for a mesh of so many faces and so many lights that are still to come: scan or tree.
    #[must_use]
    pub fn choose(faces: usize, lights: usize) -> (Self, SilhouetteReason) {
        if faces < FEW_FACES {
            (Self::Scan, SilhouetteReason::FewFaces { faces })
        } else if lights < FEW_LIGHTS {
            (Self::Scan, SilhouetteReason::FewLights { lights })
        } else {
            (Self::Tree, SilhouetteReason::ColdLight)
        }
    }
}

/// The silhouettes of a mesh at rest for one light after another, each found in the cheapest way.
///
/// ```
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// use umbrage::facing::CasterFaces;
/// use umbrage::silhouette::{SilhouetteFinder, SilhouetteMethod};
/// let sphere = shapes::icosphere(4);
/// let topology = Topology::build(sphere.vertex_count(), sphere.triangles().to_vec());
/// let mut finder = SilhouetteFinder::new(&sphere, &topology, CasterFaces::All, usize::MAX);
/// let mut method = SilhouetteMethod::Scan;
/// for i in 0..5 {
///     let light = Light::point([3.0, 4.0, 5.0 + 0.0001 * i as f32])?;
///     (method, _) = finder.find(&sphere, &topology, &light);
/// }
/// assert_eq!(method, SilhouetteMethod::Kinetic);
/// assert!(finder.edges().count() > 100);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SilhouetteFinder {
    casters: CasterFaces,
    last: Option<Light>,
    /// How the silhouette of the last light was found, and how many edges it has.
    way: (SilhouetteMethod, SilhouetteReason),
    edge_count: usize,
    /// Of the last light, if it was not found by certificates.
    list: Silhouette,
    ways: Ways,
}

#[derive(Clone, Debug)]
enum Ways {
    Scan { planes: Box<FacePlanes>, facing: Vec<Facing>, signs: Vec<i8>, reason: SilhouetteReason },
    Tree { tree: Box<SilhouetteTree>, moving: Option<Box<KineticSilhouette>>, followed: bool, short: f64 },
}

impl SilhouetteFinder {
    /// Prepares for about so many lights; `usize::MAX` if they are without number.
    ///
    /// # Panics
    ///
    /// Panics if `topology` has another number of faces than `mesh`.
    #[must_use]
    pub fn new(mesh: &Mesh, topology: &Topology, casters: CasterFaces, lights: usize) -> Self {
        let scan = |planes, reason| Ways::Scan { planes, facing: Vec::new(), signs: Vec::new(), reason };
        let ways = match SilhouetteMethod::choose(mesh.face_count(), lights) {
            (SilhouetteMethod::Scan, reason) => scan(Box::new(FacePlanes::new(mesh)), reason),
            _ => {
                let tree = SilhouetteTree::new(mesh, topology);
                if tree.is_idle() {
                    scan(Box::new(tree.into_planes()), SilhouetteReason::OpenMesh)
                } else {
                    let short = SHORT_MOVE * f64::from(tree.planes().reach());
                    Ways::Tree { tree: Box::new(tree), moving: None, followed: false, short }
                }
            }
        };
        let way = (SilhouetteMethod::Scan, SilhouetteReason::FewLights { lights }); // until there is a light
        Self { casters, last: None, way, edge_count: 0, list: Silhouette::default(), ways }
    }

    /// Finds the silhouette for a light; how, and why so. For the light of the last time nothing is done, and the answer
    /// is that of the last time.
    ///
    /// # Panics
    ///
    /// Panics if mesh or topology have other numbers of faces or edges than those it was made with, and the light is
    /// another one.
    #[inline]
    pub fn find(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &Light,
    ) -> (SilhouetteMethod, SilhouetteReason) {
        if self.last.as_ref() != Some(light) {
            self.way = self.search(mesh, topology, light);
            self.last = Some(*light);
            self.edge_count = self.list.edges.len() + self.moving().map_or(0, KineticSilhouette::len);
        }
        self.way
    }

    fn search(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &Light,
    ) -> (SilhouetteMethod, SilhouetteReason) {
        match &mut self.ways {
            Ways::Scan { planes, facing, signs, reason } => {
                planes.classify_into(mesh, light, facing);
                self.casters.signs_into(facing, signs);
                self.list.extract_into(topology, signs);
                (SilhouetteMethod::Scan, *reason)
            }
            Ways::Tree { tree, moving, followed, short } => {
                let length = self.last.map_or(f64::INFINITY, |last| way(&last, light));
                let short = length <= *short;
                let was_followed = std::mem::replace(followed, false);
                *followed = short && moving.as_ref().is_none_or(|moving| length <= moving.longest_step());
                if *followed {
                    let moving = moving.get_or_insert_with(|| {
                        let last = self.last.as_ref().expect("else the way were infinite");
                        Box::new(KineticSilhouette::new(mesh, topology, tree, last, self.casters))
                    });
                    self.list.edges.clear();
                    // Where certificates have stood still meanwhile, the way from there is another one.
                    let length = if was_followed { length } else { way(&moving.light(), light) };
                    return match moving.step_by(mesh, topology, tree, light, length) {
                        KineticStep::Rested | KineticStep::Followed { .. } => {
                            (SilhouetteMethod::Kinetic, SilhouetteReason::SmallMove)
                        }
                        KineticStep::Searched => (SilhouetteMethod::Tree, SilhouetteReason::FarMove),
                        KineticStep::Renewed => (SilhouetteMethod::Tree, SilhouetteReason::SlowLight),
                    };
                }
                if let Some(moving) = moving.as_mut().filter(|_| short) {
                    moving.wait();
                }
                match tree.search_into(mesh, topology, light, self.casters, &mut self.list) {
                    TreeSearch::Scanned => (SilhouetteMethod::Scan, SilhouetteReason::Ties),
                    TreeSearch::Crowded => (SilhouetteMethod::Scan, SilhouetteReason::Crowded),
                    TreeSearch::Searched { .. } if short => {
                        (SilhouetteMethod::Tree, SilhouetteReason::FarMove)
                    }
                    TreeSearch::Searched { .. } => (SilhouetteMethod::Tree, SilhouetteReason::ColdLight),
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

    /// What holds the last silhouette, if it was found by certificates.
    fn moving(&self) -> Option<&KineticSilhouette> {
        match &self.ways {
            Ways::Tree { moving, followed: true, .. } => moving.as_deref(),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facing::classify;
    use crate::testing::shapes;

    #[test]
    fn silhouette_finder_takes_the_way_that_fits_the_move_and_says_why() {
        let mesh = shapes::icosphere(6);
        let topology = Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
        let mut finder = SilhouetteFinder::new(&mesh, &topology, CasterFaces::All, usize::MAX);
        use SilhouetteMethod::{Kinetic, Tree};
        use SilhouetteReason::{ColdLight, SmallMove};
        let expected = [
            ([3.0, 4.0, 5.0], Tree, ColdLight),
            ([3.0, 4.0001, 5.0], Kinetic, SmallMove),
            ([3.0, 4.0001, 5.0], Kinetic, SmallMove),
            ([-3.0, 4.0, 1.0], Tree, ColdLight),
        ];
        for (place, method, reason) in expected {
            let light = Light::point(place).unwrap();
            assert_eq!(finder.find(&mesh, &topology, &light), (method, reason), "{light}");
            let silhouette =
                Silhouette::extract(&topology, &CasterFaces::All.signs(&classify(&mesh, &light)));
            assert_eq!(finder.edges().collect::<Vec<_>>(), silhouette.edges, "{light}");
            assert_eq!(finder.edge_count(), silhouette.edges.len(), "{light}");
        }
    }

    #[test]
    fn silhouette_finder_scans_where_a_tree_does_not_pay() {
        let reason = |mesh: &Mesh, lights| {
            let topology = Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
            let mut finder = SilhouetteFinder::new(mesh, &topology, CasterFaces::Front, lights);
            let light = Light::directional([1.0, 2.0, 3.0]).unwrap();
            let (method, reason) = finder.find(mesh, &topology, &light);
            assert_eq!(method, SilhouetteMethod::Scan);
            let silhouette =
                Silhouette::extract(&topology, &CasterFaces::Front.signs(&classify(mesh, &light)));
            assert_eq!(finder.edges().collect::<Vec<_>>(), silhouette.edges);
            reason
        };
        let sphere = shapes::icosphere(3);
        assert_eq!(reason(&shapes::cube(), usize::MAX), SilhouetteReason::FewFaces { faces: 12 });
        assert_eq!(reason(&sphere, 3), SilhouetteReason::FewLights { lights: 3 });
        assert_eq!(reason(&shapes::soup(&sphere), usize::MAX), SilhouetteReason::OpenMesh);
        // The light travels in the planes of most faces.
        let sponge = shapes::menger_sponge(2);
        let topology = Topology::build(sponge.vertex_count(), sponge.triangles().to_vec());
        let mut finder = SilhouetteFinder::new(&sponge, &topology, CasterFaces::All, usize::MAX);
        let axis = Light::directional([0.0, 0.0, -1.0]).unwrap();
        let found = finder.find(&sponge, &topology, &axis);
        assert_eq!(found, (SilhouetteMethod::Scan, SilhouetteReason::Ties));
    }
}
