//! The silhouette of a light that moves while the mesh rests: certificates say how far their faces stay as they are.
//!
//! A face at height `|N·(L − o) + w·D|` over its plane keeps its side until the light has travelled that far, since `N`
//! has length 1. So runs of 32 faces carry the least height among them, less its error, as a certificate; it is compared
//! with an odometer of the light's way, and only runs whose certificate has run out are looked at again. A face that
//! changes its side changes the multiplicities of its three edges, on any mesh whatever. (Certificates that fail in
//! time: Julien Basch, Leonidas J. Guibas, John Hershberger, *Data Structures for Mobile Data*, 1999. Here they are
//! looked for at each step instead of being queued, and several faces share one.)

mod certificates;

use super::edge_set::EdgeSet;
use super::{Silhouette, SilhouetteEdge, SilhouetteTree, TreeSearch};
use crate::facing::planes::LocalLight;
use crate::facing::{CasterFaces, FacePlanes};
use crate::geom::Light;
use crate::mesh::{EdgeId, Mesh};
use crate::topology::Topology;
use certificates::Certificates;

/// Looking again at a run and at what changes takes about as long as so many nodes and leaves of the tree.
const RUN_COST: usize = 3;
/// Where the tree only scans: one run in so many may run out before that is cheaper.
const EXPIRED_SHARE: usize = 8;
/// Steps by the tree after which certificates are worth another try, at twice the length of step.
const PATIENCE: u32 = 64;

/// An edge whose multiplicity a step changed; 0 where it is not silhouette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeChange {
    /// Which edge.
    pub edge: EdgeId,
    /// Its multiplicity before.
    pub before: i32,
    /// Its multiplicity now: another one.
    pub after: i32,
}

/// How a step of [`KineticSilhouette`] was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KineticStep {
    /// The light has not moved.
    Rested,
    /// By certificates.
    Followed {
        /// Runs of 32 faces that were looked at again.
        runs: usize,
    },
    /// By the tree, since too many certificates ran out.
    Searched,
    /// By the tree, and every certificate was made anew: the light seems to move slowly again.
    Renewed,
}

/// The silhouette of a mesh at rest for a light that moves, always up to date and sorted.
///
/// Equal to [`Silhouette::extract`] after every step, whatever the step. Holds 37 bytes a face and 4 an edge besides
/// the tree.
///
/// ```
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// use umbrage::facing::CasterFaces;
/// use umbrage::silhouette::{KineticSilhouette, SilhouetteTree};
/// let sphere = shapes::icosphere(3);
/// let topology = Topology::of(&sphere);
/// let mut tree = SilhouetteTree::new(&sphere, &topology);
/// let light = Light::point([3.0, 4.0, 5.0])?;
/// let mut moving = KineticSilhouette::new(&sphere, &topology, &mut tree, &light, CasterFaces::All);
/// moving.step(&sphere, &topology, &mut tree, &Light::point([3.0, 4.1, 5.0])?);
/// for change in moving.changes() {
///     assert_eq!(moving.multiplicity(change.edge), change.after);
/// }
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct KineticSilhouette {
    casters: CasterFaces,
    light: Light,
    /// Its sides are those of some earlier light while `renewed` is false.
    certificates: Certificates,
    /// The edges of each face, in the order of the certificates.
    face_edges: Vec<[Use; 3]>,
    /// Whether sides and certificates are those of `light`.
    renewed: bool,
    /// With more runs than these, the last search of the tree was cheaper.
    most_expired: usize,
    /// The longest step for which certificates are tried.
    longest: f64,
    searches: u32,
    multiplicity: Vec<i32>,
    edges: EdgeSet,
    len: usize,
    turned: Vec<(usize, i32)>,
    touched: Vec<(u32, u32, i32)>,
    changes: Vec<EdgeChange>,
}

/// An edge of a face, doubled, plus 1 if the face runs against it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Use(u32);

impl Use {
    /// Of a collapsed face.
    const NONE: Self = Self(u32::MAX);
}

impl KineticSilhouette {
    /// Starts at a light. Linear time.
    ///
    /// # Panics
    ///
    /// Panics if mesh, topology and tree do not belong together.
    #[must_use]
    pub fn new(
        mesh: &Mesh,
        topology: &Topology,
        tree: &mut SilhouetteTree,
        light: &Light,
        casters: CasterFaces,
    ) -> Self {
        let faces = tree.face_order(topology);
        let mut place = vec![0; faces.len()];
        for (slot, face) in faces.iter().enumerate() {
            place[face.index()] = slot;
        }
        let mut face_edges = vec![[Use::NONE; 3]; topology.face_count()];
        for edge in topology.edges() {
            for (half_edge, (face, direction)) in topology.half_edges(edge).zip(topology.uses(edge)) {
                // Half-edges number less than 2^31, and edges no more.
                let value = Use(edge.0 << 1 | u32::from(direction < 0));
                face_edges[place[face.index()]][half_edge.index() % 3] = value;
            }
        }
        let mut moving = Self {
            casters,
            light: *light,
            certificates: Certificates::new(tree.planes(), faces),
            face_edges,
            renewed: false,
            most_expired: 0,
            longest: f64::INFINITY,
            searches: 0,
            multiplicity: vec![0; topology.edge_count()],
            edges: EdgeSet::new(topology.edge_count()),
            len: 0,
            turned: Vec::new(),
            touched: Vec::new(),
            changes: Vec::new(),
        };
        moving.search(mesh, topology, tree);
        moving.renew(mesh, tree.planes());
        moving.changes.clear();
        moving
    }

    /// Moves the light, and brings the silhouette up to date.
    ///
    /// A step costs a look at each 1024th face, a look at the faces whose certificates run out, and what changes. Where
    /// so many run out that the last search of the tree was cheaper, it costs another search.
    ///
    /// # Panics
    ///
    /// Panics if mesh, topology or tree have other numbers of faces or edges than those it was made with, and the light
    /// has moved.
    #[inline]
    pub fn step(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        tree: &mut SilhouetteTree,
        light: &Light,
    ) -> KineticStep {
        if *light == self.light {
            self.changes.clear();
            return KineticStep::Rested;
        }
        self.step_by(mesh, topology, tree, light, way(&self.light, light))
    }

    /// A step to another light, whose length is known.
    pub(super) fn step_by(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        tree: &mut SilhouetteTree,
        light: &Light,
        length: f64,
    ) -> KineticStep {
        assert_eq!(mesh.face_count(), self.face_edges.len(), "the silhouette is of another mesh");
        self.changes.clear();
        self.light = *light;
        self.certificates.advance(length);
        if self.renewed && length.is_finite() {
            let local = tree.planes().local(light);
            if let Some(runs) = self.follow(mesh, tree.planes(), &local) {
                self.note_changes();
                return KineticStep::Followed { runs };
            }
            self.renewed = false;
            self.longest = length / 2.0;
        }
        self.search(mesh, topology, tree);
        self.wait();
        if length > self.longest {
            return KineticStep::Searched;
        }
        self.renew(mesh, tree.planes());
        KineticStep::Renewed
    }

    /// Counts a search of the tree; after many of them certificates are worth another try.
    pub(super) fn wait(&mut self) {
        self.searches += 1;
        if self.searches >= PATIENCE {
            self.searches = 0;
            self.longest *= 2.0;
        }
    }

    /// The longest step that is worth a try by certificates; after a longer one they have to be made anew.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        self.longest
    }

    /// The light of the last step.
    #[must_use]
    pub fn light(&self) -> Light {
        self.light
    }

    /// The edges that the last step changed, ascending.
    #[must_use]
    pub fn changes(&self) -> &[EdgeChange] {
        &self.changes
    }

    /// The multiplicity of an edge: 0 if it is not silhouette. Constant time.
    ///
    /// # Panics
    ///
    /// Panics if there is no such edge.
    #[must_use]
    pub fn multiplicity(&self, edge: EdgeId) -> i32 {
        self.multiplicity[edge.index()]
    }

    /// How many edges are silhouette.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no edge is silhouette.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The silhouette edges, ascending.
    pub fn edges(&self) -> impl Iterator<Item = SilhouetteEdge> + '_ {
        let of = |edge| SilhouetteEdge { edge: EdgeId(edge), multiplicity: self.multiplicity[edge as usize] };
        self.edges.iter().map(of)
    }

    /// The silhouette as a list.
    #[must_use]
    pub fn silhouette(&self) -> Silhouette {
        let mut edges = Vec::with_capacity(self.len);
        edges.extend(self.edges());
        Silhouette { edges }
    }

    /// Looks again at the runs whose certificates have run out, and how many those are; `None`, and nothing is done, if
    /// they are too many.
    fn follow(&mut self, mesh: &Mesh, planes: &FacePlanes, light: &LocalLight) -> Option<usize> {
        let expired = self.certificates.expired(self.most_expired)?;
        let (casters, turned) = (self.casters, &mut self.turned);
        self.certificates.look_again(&expired, mesh, planes, light, |slot, before, now| {
            turned.push((slot, i32::from(casters.sign(now)) - i32::from(casters.sign(before))));
        });
        let mut turned = std::mem::take(&mut self.turned);
        for (slot, by) in turned.drain(..).filter(|&(_, by)| by != 0) {
            self.turn(slot, by);
        }
        self.turned = turned; // for its memory
        Some(expired.len())
    }

    /// Adds to the multiplicities of a face's edges.
    fn turn(&mut self, slot: usize, by: i32) {
        for Use(edge) in self.face_edges[slot] {
            if Use(edge) == Use::NONE {
                return;
            }
            let (edge, against) = (edge >> 1, edge & 1 == 1);
            let multiplicity = &mut self.multiplicity[edge as usize];
            // In the order of touching, so that the first entry of an edge holds what it was before the step.
            self.touched.push((edge, self.touched.len() as u32, *multiplicity));
            *multiplicity += if against { -by } else { by };
        }
    }

    /// From edges that were touched to those that have changed.
    fn note_changes(&mut self) {
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_unstable();
        touched.dedup_by_key(|(edge, ..)| *edge);
        for (edge, _, before) in touched.drain(..) {
            self.note(edge, before, self.multiplicity[edge as usize]);
        }
        self.touched = touched; // for its memory
    }

    fn note(&mut self, edge: u32, before: i32, after: i32) {
        if before == after {
            return;
        }
        self.changes.push(EdgeChange { edge: EdgeId(edge), before, after });
        if after == 0 {
            self.edges.remove(edge);
            self.len -= 1;
        } else if before == 0 {
            self.edges.insert(edge);
            self.len += 1;
        }
    }

    /// The silhouette by the tree.
    fn search(&mut self, mesh: &Mesh, topology: &Topology, tree: &mut SilhouetteTree) {
        let (silhouette, search) = tree.search(mesh, topology, &self.light, self.casters);
        self.most_expired = 1 + match search {
            TreeSearch::Searched { nodes, leaves, .. } => (nodes + leaves) / RUN_COST,
            TreeSearch::Scanned | TreeSearch::Crowded => self.certificates.runs() / EXPIRED_SHARE,
        };
        self.replace(&silhouette);
    }

    /// Takes over a silhouette from elsewhere, and notes what is different.
    fn replace(&mut self, silhouette: &Silhouette) {
        let old: Vec<u32> = self.edges.iter().collect();
        let mut old = old.into_iter().peekable();
        for &SilhouetteEdge { edge, multiplicity } in &silhouette.edges {
            while let Some(gone) = old.next_if(|&old| old < edge.0) {
                self.set(gone, 0);
            }
            old.next_if_eq(&edge.0);
            self.set(edge.0, multiplicity);
        }
        for gone in old {
            self.set(gone, 0);
        }
    }

    fn set(&mut self, edge: u32, after: i32) {
        let before = std::mem::replace(&mut self.multiplicity[edge as usize], after);
        self.note(edge, before, after);
    }

    /// Finds all sides and makes all certificates anew, at the place of the light.
    fn renew(&mut self, mesh: &Mesh, planes: &FacePlanes) {
        self.searches = 0;
        self.certificates.renew(mesh, planes, &planes.local(&self.light));
        self.renewed = true;
    }
}

/// How far a light travels, rounded up; without end between a point and a direction.
pub(super) fn way(from: &Light, to: &Light) -> f64 {
    if from.is_directional() != to.is_directional() {
        return f64::INFINITY;
    }
    let (from, to) = (from.xyz().map(f64::from), to.xyz().map(f64::from));
    let square: f64 = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum();
    // Seven roundings at most. Differences are multiples of 2^-149, so that no square underflows.
    square.sqrt() * (1.0 + 8.0 * f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::silhouette::test_support::{crumpled, light, scan};
    use crate::testing::shapes;

    struct Walk {
        mesh: Mesh,
        topology: Topology,
        tree: SilhouetteTree,
        moving: KineticSilhouette,
    }

    impl Walk {
        fn start(mesh: Mesh, light: &Light, casters: CasterFaces) -> Self {
            let topology = Topology::of(&mesh);
            let mut tree = SilhouetteTree::new(&mesh, &topology);
            let moving = KineticSilhouette::new(&mesh, &topology, &mut tree, light, casters);
            Self { mesh, topology, tree, moving }
        }

        fn step(&mut self, light: &Light) -> KineticStep {
            self.moving.step(&self.mesh, &self.topology, &mut self.tree, light)
        }

        /// Whether the silhouette is the scan's, and the changes are what became of the one before.
        fn agrees(&self, before: &Silhouette) -> bool {
            let now = scan(&self.mesh, &self.topology, &self.moving.light(), self.moving.casters);
            let of = |silhouette: &Silhouette, edge| {
                let found = silhouette.edges.binary_search_by_key(&edge, |edge| edge.edge);
                found.map_or(0, |place| silhouette.edges[place].multiplicity)
            };
            let changes = self.topology.edges().filter_map(|edge| {
                let (before, after) = (of(before, edge), of(&now, edge));
                (before != after).then_some(EdgeChange { edge, before, after })
            });
            self.moving.silhouette() == now
                && self.moving.len() == now.edges.len()
                && self.moving.changes().iter().copied().eq(changes)
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(150))]

        #[test]
        fn silhouette_of_a_walk_from_tie_to_tie_equals_the_scan(
            mesh in crumpled(),
            lights in light(6),
            lengths in prop::collection::vec(prop_oneof![Just(0.0), Just(1.0), Just(1e-4_f32), 0.0_f32..0.1], 40),
            front in any::<bool>(),
        ) {
            let casters = if front { CasterFaces::Front } else { CasterFaces::All };
            let mut walk = Walk::start(mesh, &lights[0], casters);
            for (i, length) in lengths.into_iter().enumerate() {
                // Towards a light of the list, or onto it.
                let (from, to) = (walk.moving.light(), lights[i / 7 % 6]);
                let light = if from.is_directional() || to.is_directional() {
                    to
                } else {
                    let (from, to) = (from.xyz(), to.xyz());
                    Light::point([0, 1, 2].map(|i| from[i] + length * (to[i] - from[i]))).unwrap()
                };
                let before = walk.moving.silhouette();
                let step = walk.step(&light);
                prop_assert!(walk.agrees(&before), "{step:?} from {from} to {light}");
            }
        }
    }

    /// A light on a circle around a sphere, in steps of a ten-thousandth.
    fn circling(spoil: impl Fn(&mut KineticSilhouette)) -> (bool, usize) {
        let at = |i: i32| {
            let angle = i as f32 * 1e-4;
            Light::point([3.0 * angle.cos(), 3.0 * angle.sin(), 0.5]).unwrap()
        };
        let mut walk = Walk::start(shapes::icosphere(4), &at(0), CasterFaces::All);
        let (mut right, mut followed) = (true, 0);
        for i in 1..300 {
            spoil(&mut walk.moving);
            let before = walk.moving.silhouette();
            followed += usize::from(matches!(walk.step(&at(i)), KineticStep::Followed { .. }));
            right &= walk.agrees(&before);
        }
        (right, followed)
    }

    #[test]
    fn silhouette_of_a_slow_light_is_followed_by_certificates() {
        let (right, followed) = circling(|_| ());
        assert!(right);
        assert_eq!(followed, 299);
    }

    #[test]
    fn silhouette_whose_certificates_last_too_long_is_caught() {
        let (right, _) = circling(|moving| {
            let certificates = &mut moving.certificates;
            for end in certificates.run_ends.iter_mut().chain(&mut certificates.group_ends) {
                *end += 1e-4;
            }
        });
        assert!(!right);
    }

    #[test]
    fn silhouette_of_a_light_that_jumps_is_searched_and_followed_again_when_it_slows_down() {
        let at = |x: f32| Light::point([x, 3.0, 4.0]).unwrap();
        let mut walk = Walk::start(shapes::icosphere(4), &at(0.0), CasterFaces::Front);
        let steps = [0.0, 1e-5, 30.0, -30.0, -30.00001, -30.00002].map(|x| {
            let before = walk.moving.silhouette();
            let step = walk.step(&at(x));
            assert!(walk.agrees(&before), "{x}: {step:?}");
            step
        });
        use KineticStep::{Followed, Renewed, Rested, Searched};
        assert!(
            matches!(steps, [Rested, Followed { .. }, Searched, Searched, Renewed, Followed { .. }]),
            "{steps:?}"
        );
        let walk = &mut walk;
        let before = walk.moving.silhouette();
        walk.step(&Light::directional([1.0, 2.0, 3.0]).unwrap());
        assert!(walk.agrees(&before));
    }
}
