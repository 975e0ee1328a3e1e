//! Which way to a silhouette is the cheapest: scan, tree or certificates, and why.

use std::fmt;

use crate::choice::{Choice, Reason};

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

impl SilhouetteMethod {
    /// The way to begin with, for a mesh of so many faces and so many lights that are still to come: scan or tree.
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

/// The silhouettes of a mesh at rest for one light after another, each found in the cheapest way.
///
/// ```
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// use umbrage::facing::CasterFaces;
/// use umbrage::silhouette::{SilhouetteFinder, SilhouetteMethod};
/// let sphere = shapes::icosphere(4);
/// let topology = Topology::of(&sphere);
/// let mut finder = SilhouetteFinder::new(&sphere, &topology, CasterFaces::All, usize::MAX);
/// let mut method = SilhouetteMethod::Scan;
/// for i in 0..5 {
///     let light = Light::point([3.0, 4.0, 5.0 + 0.0001 * i as f32])?;
///     method = finder.find(&sphere, &topology, &light).what;
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
    way: Choice<SilhouetteMethod>,
    edge_count: usize,
    /// Of the last light, if it was not found by certificates.
    list: Silhouette,
    ways: Ways,
}

#[derive(Clone, Debug)]
enum Ways {
    Scan { planes: Box<FacePlanes>, facing: Vec<Facing>, signs: Vec<i8>, reason: Reason },
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
            Choice { what: SilhouetteMethod::Scan, why } => scan(Box::new(FacePlanes::new(mesh)), why),
            _ => {
                let tree = SilhouetteTree::new(mesh, topology);
                if tree.is_idle() {
                    scan(Box::new(tree.into_planes()), Reason::OpenMesh)
                } else {
                    let short = SHORT_MOVE * f64::from(tree.planes().reach());
                    Ways::Tree { tree: Box::new(tree), moving: None, followed: false, short }
                }
            }
        };
        let way = Choice::new(SilhouetteMethod::Scan, Reason::FewLights { lights: 0 }); // until there is a light
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
    pub fn find(&mut self, mesh: &Mesh, topology: &Topology, light: &Light) -> Choice<SilhouetteMethod> {
        if self.last.as_ref() != Some(light) {
            self.way = self.search(mesh, topology, light);
            self.last = Some(*light);
            self.edge_count = self.list.edges.len() + self.moving().map_or(0, KineticSilhouette::len);
        }
        self.way
    }

    fn search(&mut self, mesh: &Mesh, topology: &Topology, light: &Light) -> Choice<SilhouetteMethod> {
        match &mut self.ways {
            Ways::Scan { planes, facing, signs, reason } => {
                planes.classify_into(mesh, light, facing);
                self.casters.signs_into(facing, signs);
                self.list.extract_into(topology, signs);
                Choice::new(SilhouetteMethod::Scan, *reason)
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
                            Choice::new(SilhouetteMethod::Kinetic, Reason::SmallMove)
                        }
                        KineticStep::Searched => Choice::new(SilhouetteMethod::Tree, Reason::FarMove),
                        KineticStep::Renewed => Choice::new(SilhouetteMethod::Tree, Reason::SlowLight),
                    };
                }
                if let Some(moving) = moving.as_mut().filter(|_| short) {
                    moving.wait();
                }
                match tree.search_into(mesh, topology, light, self.casters, &mut self.list) {
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
        let topology = Topology::of(&mesh);
        let mut finder = SilhouetteFinder::new(&mesh, &topology, CasterFaces::All, usize::MAX);
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
            assert_eq!(finder.find(&mesh, &topology, &light), Choice::new(method, reason), "{light}");
            let silhouette =
                Silhouette::extract(&topology, &CasterFaces::All.signs(&classify(&mesh, &light)));
            assert_eq!(finder.edges().collect::<Vec<_>>(), silhouette.edges, "{light}");
            assert_eq!(finder.edge_count(), silhouette.edges.len(), "{light}");
        }
    }

    #[test]
    fn silhouette_finder_scans_where_a_tree_does_not_pay() {
        let reason = |mesh: &Mesh, lights| {
            let topology = Topology::of(mesh);
            let mut finder = SilhouetteFinder::new(mesh, &topology, CasterFaces::Front, lights);
            let light = Light::directional([1.0, 2.0, 3.0]).unwrap();
            let Choice { what: method, why: reason } = finder.find(mesh, &topology, &light);
            assert_eq!(method, SilhouetteMethod::Scan);
            let silhouette =
                Silhouette::extract(&topology, &CasterFaces::Front.signs(&classify(mesh, &light)));
            assert_eq!(finder.edges().collect::<Vec<_>>(), silhouette.edges);
            reason
        };
        let sphere = shapes::icosphere(3);
        assert_eq!(reason(&shapes::cube(), usize::MAX), Reason::FewFaces { faces: 12 });
        assert_eq!(reason(&sphere, 3), Reason::FewLights { lights: 3 });
        assert_eq!(reason(&shapes::soup(&sphere), usize::MAX), Reason::OpenMesh);
        // The light travels in the planes of most faces.
        let sponge = shapes::menger_sponge(2);
        let topology = Topology::of(&sponge);
        let mut finder = SilhouetteFinder::new(&sponge, &topology, CasterFaces::All, usize::MAX);
        let axis = Light::directional([0.0, 0.0, -1.0]).unwrap();
        let found = finder.find(&sponge, &topology, &axis);
        assert_eq!(found, Choice::new(SilhouetteMethod::Scan, Reason::Ties));
    }
}
