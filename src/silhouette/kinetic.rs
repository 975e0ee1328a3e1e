//! Kinetic silhouettes, for a light that moves while the mesh rests: certificates bound how far the light may
//! travel before a face changes sides.
//!
//! A face at height `|N·(L − o) + w·D|` over its plane keeps its side until the light has travelled that far,
//! since `N` has length 1. So runs of 32 faces carry the least height among them, less its error, as a
//! certificate. It is compared with the distance that the light has travelled so far (the odometer), and only
//! runs whose certificate has expired are evaluated again. A face that changes sides changes the
//! multiplicities of its three edges, on any mesh. (Certificates that fail in time: Julien Basch, Leonidas J.
//! Guibas, John Hershberger, *Data Structures for Mobile Data*, 1999. Here they are compared at each step
//! instead of being queued, and several faces share one.)

mod certificates;

use super::edge_set::EdgeSet;
use super::{Silhouette, SilhouetteEdge, SilhouetteTree, TreeSearch};
use crate::caster::{CasterRule, KeptRule};
use crate::facing::FacePlanes;
use crate::facing::planes::LocalLight;
use crate::geom::Light;
use crate::mesh::{EdgeId, FaceId, Mesh};
use crate::topology::Topology;
use certificates::Certificates;

/// Cost of evaluating one run of 32 faces again, in visits to tree nodes.
const RUN_COST: usize = 3;
/// Without a usable tree: scan when more than 1/8 of the certificates expire in one step.
const EXPIRED_SHARE: usize = 8;
/// Steps by the tree after which certificates are tried again, for steps of up to twice the length.
const PATIENCE: u32 = 64;

/// An edge whose multiplicity a step changed. The multiplicity is 0 where the edge is not silhouette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeChange {
    /// Which edge.
    pub edge: EdgeId,
    /// Its multiplicity before the step.
    pub before: i32,
    /// Its multiplicity after the step, never the same.
    pub after: i32,
}

/// How a step of [`KineticSilhouette`] was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum KineticStep {
    /// The light has not moved.
    Rested,
    /// By certificates.
    #[non_exhaustive]
    Followed {
        /// Runs of 32 faces that were evaluated again.
        runs: usize,
    },
    /// By the tree, since too many certificates expired.
    Searched,
    /// By the tree, and every certificate was computed again: the light seems to move slowly again.
    Renewed,
}

/// The silhouette of a mesh at rest for a light that moves, always up to date and sorted.
///
/// Equal to [`Silhouette::extract`] after every step, whatever the step. Holds 41 bytes per face and 4 per
/// edge besides the tree.
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
/// let casters = CasterFaces::All;
/// let mut moving = KineticSilhouette::new(&sphere, &topology, &mut tree, &light, casters);
/// moving.step(&sphere, &topology, &mut tree, &Light::point([3.0, 4.1, 5.0])?, casters);
/// for change in moving.changes() {
///     assert_eq!(moving.multiplicity(change.edge), change.after);
/// }
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct KineticSilhouette {
    casters: KeptRule,
    light: Light,
    /// The sides in it are those of some earlier light while `renewed` is false.
    certificates: Certificates,
    /// The edges of each face, in the order of the certificates.
    face_edges: Vec<[Use; 3]>,
    /// The index of each face in that order.
    slots: Vec<u32>,
    /// Whether sides and certificates are those of `light`.
    renewed: bool,
    /// When more runs than these expire, the last search of the tree was cheaper.
    most_expired: usize,
    /// The longest step for which certificates are tried.
    longest: f64,
    searches: u32,
    multiplicity: Vec<i32>,
    edges: EdgeSet,
    len: usize,
    /// `Σ|m|` over the silhouette.
    copies: usize,
    changes: Vec<EdgeChange>,
    work: Work,
}

/// Buffers of a step, kept for their memory.
#[derive(Clone, Debug, Default)]
struct Work {
    expired: Vec<usize>,
    /// Slots of faces that cast with another sign now, and the difference.
    turned: Vec<(usize, i32)>,
    /// Edges of these faces, in the order of their changes, and the multiplicity before each.
    touched: Vec<(u32, u32, i32)>,
    found: Silhouette,
    old: Vec<u32>,
}

/// An edge of a face: twice its id, plus 1 if the face runs against it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Use(u32);

impl Use {
    /// Of a collapsed face.
    const NONE: Self = Self(u32::MAX);
}

impl KineticSilhouette {
    /// Starts at a light. Linear time.
    ///
    /// `casters` is a [`CasterFaces`](crate::facing::CasterFaces), or what
    /// [`Caster::rule`](crate::caster::Caster::rule) gives.
    ///
    /// # Panics
    ///
    /// Panics if mesh, topology, tree and casters do not belong together.
    #[must_use]
    pub fn new<'a>(
        mesh: &Mesh,
        topology: &Topology,
        tree: &mut SilhouetteTree,
        light: &Light,
        casters: impl Into<CasterRule<'a>>,
    ) -> Self {
        let casters = &casters.into();
        let faces = tree.face_order(topology);
        let mut slots = vec![0; faces.len()];
        for (slot, face) in (0..).zip(&faces) {
            slots[face.index()] = slot;
        }
        let mut face_edges = vec![[Use::NONE; 3]; topology.face_count()];
        for edge in topology.edges() {
            for (half_edge, (face, direction)) in topology.half_edges(edge).zip(topology.uses(edge)) {
                // Half-edges number less than 2^31, and edges no more.
                let value = Use(edge.0 << 1 | u32::from(direction < 0));
                face_edges[slots[face.index()] as usize][half_edge.index() % 3] = value;
            }
        }
        let mut moving = Self {
            casters: KeptRule::default(),
            light: *light,
            certificates: Certificates::new(tree.planes(), faces),
            face_edges,
            slots,
            renewed: false,
            most_expired: 0,
            longest: f64::INFINITY,
            searches: 0,
            multiplicity: vec![0; topology.edge_count()],
            edges: EdgeSet::new(topology.edge_count()),
            len: 0,
            copies: 0,
            changes: Vec::new(),
            work: Work::default(),
        };
        moving.casters.keep(casters);
        moving.search(mesh, topology, tree, casters);
        moving.renew(mesh, tree.planes());
        moving.changes.clear();
        moving
    }

    /// Moves the light, and brings the silhouette up to date.
    ///
    /// `casters` may differ from those of the step before: then the faces of the shells that cast otherwise
    /// are visited.
    ///
    /// A step costs one comparison per 512 faces, an evaluation of the runs whose certificates expire, and
    /// what changes. When so many expire that the last search of the tree was cheaper, it costs another
    /// search.
    ///
    /// # Panics
    ///
    /// Panics if mesh, topology, tree or casters have other numbers of faces or edges than those it was made
    /// with, and the light has moved.
    #[inline]
    pub fn step<'a>(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        tree: &mut SilhouetteTree,
        light: &Light,
        casters: impl Into<CasterRule<'a>>,
    ) -> KineticStep {
        let casters = &casters.into();
        if *light == self.light && self.casters.equals(casters) {
            self.changes.clear();
            return KineticStep::Rested;
        }
        self.step_by(mesh, topology, tree, light, travel(&self.light, light), casters)
    }

    /// A step to another light, whose length is known.
    pub(super) fn step_by(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        tree: &mut SilhouetteTree,
        light: &Light,
        length: f64,
        casters: &CasterRule<'_>,
    ) -> KineticStep {
        assert_eq!(mesh.face_count(), self.face_edges.len(), "the silhouette is of another mesh");
        self.changes.clear();
        self.light = *light;
        self.certificates.advance(length);
        let comparable = self.casters.is_comparable(casters);
        if self.renewed && length.is_finite() && comparable {
            let local = tree.planes().local(light);
            if let Some(runs) = self.follow(mesh, tree.planes(), &local, casters) {
                self.recast(casters);
                self.note_changes();
                return KineticStep::Followed { runs };
            }
            self.longest = length / 2.0;
        }
        self.renewed = false;
        self.casters.keep(casters);
        self.search(mesh, topology, tree, casters);
        self.wait();
        if length > self.longest {
            return KineticStep::Searched;
        }
        self.renew(mesh, tree.planes());
        KineticStep::Renewed
    }

    /// Counts a search of the tree; after many of them certificates are tried again.
    pub(super) fn wait(&mut self) {
        self.searches += 1;
        if self.searches >= PATIENCE {
            self.searches = 0;
            self.longest *= 2.0;
        }
    }

    /// The longest step for which certificates are tried; after a longer one they have to be computed again.
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

    /// `Σ|m|` over the silhouette: how many quads its sides are.
    pub(super) fn copies(&self) -> usize {
        self.copies
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

    /// Evaluates the runs whose certificates have expired, and returns their number; `None`, and nothing is
    /// done, if they are too many.
    fn follow(
        &mut self,
        mesh: &Mesh,
        planes: &FacePlanes,
        light: &LocalLight,
        rule: &CasterRule<'_>,
    ) -> Option<usize> {
        let Self { casters, certificates, work: Work { expired, turned, .. }, .. } = self;
        if !certificates.expired(self.most_expired, expired) {
            return None;
        }
        turned.clear();
        // With the faces that cast so far: what else has changed comes after.
        certificates.look_again(expired, mesh, planes, light, |slot, face, before, now| {
            let casters = casters.of(rule, face);
            turned.push((slot, i32::from(casters.sign(now)) - i32::from(casters.sign(before))));
        });
        let runs = expired.len();
        self.turn_all();
        Some(runs)
    }

    /// From the faces that cast so far to those of a comparable rule. All sides are up to date.
    fn recast(&mut self, rule: &CasterRule<'_>) {
        if self.casters.equals(rule) {
            return;
        }
        let Self { casters, certificates, slots, work: Work { turned, .. }, .. } = self;
        turned.clear();
        casters.for_each_change(rule, slots.len(), |face: FaceId, before, now| {
            let slot = slots[face.index()] as usize;
            let side = certificates.side(slot);
            turned.push((slot, i32::from(now.sign(side)) - i32::from(before.sign(side))));
        });
        self.turn_all();
        self.casters.keep(rule);
    }

    /// Changes the signs of the faces in `turned`.
    fn turn_all(&mut self) {
        let mut turned = std::mem::take(&mut self.work.turned);
        for (slot, by) in turned.drain(..).filter(|&(_, by)| by != 0) {
            self.turn(slot, by);
        }
        self.work.turned = turned; // for its memory
    }

    /// Adds to the multiplicities of a face's edges.
    fn turn(&mut self, slot: usize, by: i32) {
        for Use(edge) in self.face_edges[slot] {
            if Use(edge) == Use::NONE {
                return;
            }
            let (edge, against) = (edge >> 1, edge & 1 == 1);
            let multiplicity = &mut self.multiplicity[edge as usize];
            // Numbered, so that the first entry of an edge holds its multiplicity before the step.
            self.work.touched.push((edge, self.work.touched.len() as u32, *multiplicity));
            *multiplicity += if against { -by } else { by };
        }
    }

    /// From edges that were touched to those that have changed.
    fn note_changes(&mut self) {
        let mut touched = std::mem::take(&mut self.work.touched);
        touched.sort_unstable();
        touched.dedup_by_key(|(edge, ..)| *edge);
        for (edge, _, before) in touched.drain(..) {
            self.note(edge, before, self.multiplicity[edge as usize]);
        }
        self.work.touched = touched; // for its memory
    }

    fn note(&mut self, edge: u32, before: i32, after: i32) {
        if before == after {
            return;
        }
        self.changes.push(EdgeChange { edge: EdgeId(edge), before, after });
        self.copies -= before.unsigned_abs() as usize;
        self.copies += after.unsigned_abs() as usize;
        if after == 0 {
            self.edges.remove(edge);
            self.len -= 1;
        } else if before == 0 {
            self.edges.insert(edge);
            self.len += 1;
        }
    }

    /// The silhouette by the tree.
    fn search(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        tree: &mut SilhouetteTree,
        casters: &CasterRule<'_>,
    ) {
        let mut found = std::mem::take(&mut self.work.found);
        let search = tree.search_into(mesh, topology, &self.light, *casters, &mut found);
        self.most_expired = 1 + match search {
            TreeSearch::Searched { nodes, leaves, .. } => (nodes + leaves) / RUN_COST,
            TreeSearch::Scanned | TreeSearch::Crowded => self.certificates.runs() / EXPIRED_SHARE,
        };
        self.replace(&found);
        self.work.found = found;
    }

    /// Takes over a silhouette from elsewhere, and notes the differences.
    fn replace(&mut self, silhouette: &Silhouette) {
        let mut list = std::mem::take(&mut self.work.old);
        list.clear();
        list.extend(self.edges.iter());
        let mut old = list.iter().copied().peekable();
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
        self.work.old = list;
    }

    fn set(&mut self, edge: u32, after: i32) {
        let before = std::mem::replace(&mut self.multiplicity[edge as usize], after);
        self.note(edge, before, after);
    }

    /// Computes all sides and all certificates again, for the present light.
    fn renew(&mut self, mesh: &Mesh, planes: &FacePlanes) {
        self.searches = 0;
        self.certificates.renew(mesh, planes, &planes.local(&self.light));
        self.renewed = true;
    }
}

/// The distance between two lights, rounded up; infinite between a point and a direction.
pub(super) fn travel(from: &Light, to: &Light) -> f64 {
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
    use crate::caster::Caster;
    use crate::facing::CasterFaces;
    use crate::silhouette::test_support::{crumpled, light, scan};
    use crate::testing::shapes;

    struct Walk {
        mesh: Mesh,
        topology: Topology,
        tree: SilhouetteTree,
        casters: CasterFaces,
        moving: KineticSilhouette,
    }

    impl Walk {
        fn start(mesh: Mesh, light: &Light, casters: CasterFaces) -> Self {
            let topology = Topology::of(&mesh);
            let mut tree = SilhouetteTree::new(&mesh, &topology);
            let moving = KineticSilhouette::new(&mesh, &topology, &mut tree, light, casters);
            Self { mesh, topology, tree, casters, moving }
        }

        fn step(&mut self, light: &Light) -> KineticStep {
            self.moving.step(&self.mesh, &self.topology, &mut self.tree, light, self.casters)
        }

        /// Whether the silhouette is the scan's, and the changes are what became of the one before.
        fn agrees(&self, before: &Silhouette) -> bool {
            let now = scan(&self.mesh, &self.topology, &self.moving.light(), self.casters);
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

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        /// Shell by shell, with other choices at some steps; by certificates and by the tree alone.
        #[test]
        fn silhouette_of_shells_that_cast_otherwise_from_step_to_step_equals_the_scan(
            parts in prop::collection::vec(crumpled(), 3),
            lights in light(3),
            steps in prop::collection::vec((0_usize..3, 0.0_f32..0.01, prop::array::uniform4(0_usize..9)), 30),
        ) {
            let caster = Caster::new(Mesh::concat(&parts).unwrap());
            let (mesh, topology) = (caster.mesh(), caster.topology());
            let planes = caster.shared_planes().clone();
            let mut tree = SilhouetteTree::with_planes(mesh, topology, planes.clone());
            let mut searched = SilhouetteTree::with_planes(mesh, topology, planes).unlimited();
            let all = [CasterFaces::All, CasterFaces::Front, CasterFaces::Back];
            let mut faces = caster.shell_faces(&lights[0], Some(CasterFaces::All));
            let mut moving =
                KineticSilhouette::new(mesh, topology, &mut tree, &lights[0], caster.rule(&faces));
            for (which, by, picks) in steps {
                // Other choices in a third of the steps, for a shell or two.
                for (choice, &pick) in faces.choices.iter_mut().zip(&picks).filter(|_| which == 0) {
                    choice.what = all.get(pick).copied().unwrap_or(choice.what);
                }
                let [x, y, z] = lights[which].xyz();
                let light = if lights[which].is_directional() {
                    lights[which]
                } else {
                    Light::point([x + by, y, z - by]).unwrap()
                };
                let signs = faces.signs(caster.shells(), &caster.facing(&light));
                let expected = Silhouette::extract(topology, &signs);
                let before = moving.silhouette();
                let step = moving.step(mesh, topology, &mut tree, &light, caster.rule(&faces));
                prop_assert_eq!(&moving.silhouette(), &expected, "{:?}", step);
                let copies = |edge: &SilhouetteEdge| edge.multiplicity.unsigned_abs() as usize;
                prop_assert_eq!(moving.copies(), expected.edges.iter().map(copies).sum::<usize>());
                let of = |silhouette: &Silhouette, edge| {
                    let found = silhouette.edges.binary_search_by_key(&edge, |edge| edge.edge);
                    found.map_or(0, |index| silhouette.edges[index].multiplicity)
                };
                for change in moving.changes() {
                    prop_assert_eq!(change.before, of(&before, change.edge));
                    prop_assert_eq!(change.after, of(&expected, change.edge));
                }
                let by_tree = searched.silhouette(mesh, topology, &light, caster.rule(&faces));
                prop_assert_eq!(by_tree, expected);
            }
        }
    }

    #[test]
    fn silhouette_that_misses_a_change_of_the_casting_faces_is_caught() {
        let caster = Caster::new(shapes::icosphere(4));
        let (mesh, topology) = (caster.mesh(), caster.topology());
        let mut tree = SilhouetteTree::new(mesh, topology);
        let at = |x: f32| Light::point([x, 3.0, 4.0]).unwrap();
        let [all, front] = [CasterFaces::All, CasterFaces::Front].map(|casters| {
            let light = at(0.0);
            KineticSilhouette::new(mesh, topology, &mut tree, &light, casters)
        });
        for (mut moving, right) in [(all, true), (front, false)] {
            // The fault injected: the silhouette of front faces, taken for that of all.
            moving.casters.keep(&CasterFaces::All.into());
            let step = moving.step(mesh, topology, &mut tree, &at(1e-5), CasterFaces::Back);
            assert!(matches!(step, KineticStep::Followed { .. }), "{step:?}");
            assert_eq!(moving.silhouette() == caster.silhouette(&at(1e-5), CasterFaces::Back), right);
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
