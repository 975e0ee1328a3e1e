//! The silhouette by a tree of edges that leaves out, many at once, those whose two faces are surely on one side.
//!
//! Each edge with two faces in opposite directions is a segment between their planes, points of a space of four
//! dimensions (normal and offset), and a light is a plane of that space: the edge is silhouette when its segment crosses
//! it (Aaron Hertzmann, Denis Zorin, *Illustrating Smooth Surfaces*, 2000, section 4.2, for the dual space; Matt Olson,
//! Hao Zhang, *Silhouette Extraction in Hough Space*, 2006, for a tree in it). A tree of boxes over such segments needs
//! no halo, since every edge brings both its planes, and no geometry but theirs.
//!
//! Departures from the papers: boxes are of the whole numbers of `quantized.rs`; edges lie in leaves of 32 whose two planes
//! stand side by side, in numbers about a middle of their own, so that a leaf is evaluated by vector instructions without
//! a single gather; nodes have eight children; and what the numbers leave open is decided exactly.

mod build;
mod leaf;

use multiversion::multiversion;

use super::edge_set::{Bits, SignedEdges};
use super::{Silhouette, SilhouetteEdge};
use crate::facing::plane_tree::{Heights, LEAF, Node, WIDE, undecided_child};
use crate::facing::planes::LocalLight;
use crate::facing::quantized;
use crate::facing::quantized::{BACK, FRONT};
use crate::facing::{CasterFaces, FacePlanes, facing_of};
use crate::geom::{Facing, Light};
use crate::mesh::{EdgeId, FaceId, Mesh};
use crate::topology::Topology;
use leaf::{Codes, Leaf};

/// One edge in so many may be left open, or lie outside the tree, before a scan of everything is cheaper.
const OPEN_SHARE: usize = 64;
/// One leaf in so many may have to be looked at,
const CROWDED_LEAVES: usize = 4;
/// and one edge in so many may be found, before a scan is cheaper.
const CROWDED_EDGES: usize = 40;
/// Leaves that are looked at before what was found in them is collected.
const BATCH: usize = 64;
/// Faces that the exact predicate has decided and that are remembered for their next edge.
const KNOWN: usize = 256;
/// After searches that were given up, so many lights at most are scanned for before the tree is tried again: trying costs
/// up to a fifth of a scan.
const PATIENCE: u32 = 8;

/// A tree over the edges of a mesh, for many lights while the mesh rests.
///
/// Holds the [`FacePlanes`] of the mesh, and for each edge 22 bytes and a share of the nodes.
///
/// ```
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// use umbrage::facing::CasterFaces;
/// use umbrage::silhouette::SilhouetteTree;
/// let cube = shapes::cube();
/// let topology = Topology::of(&cube);
/// let mut tree = SilhouetteTree::new(&cube, &topology);
/// let light = Light::directional([-1.0, -1.0, -1.0])?;
/// let silhouette = tree.silhouette(&cube, &topology, &light, CasterFaces::All);
/// assert_eq!(silhouette.edges.len(), 6); // along the body diagonal: a hexagon
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SilhouetteTree {
    planes: FacePlanes,
    edge_count: usize,
    store: Store,
    /// Edges with other faces than two in opposite directions, or with a face whose plane is not known well: looked at
    /// one by one for every light.
    apart: Vec<u32>,
    limits: Limits,
    waiting: Waiting,
    work: Work,
}

/// The edges that lie in the tree.
#[derive(Clone, Debug)]
struct Store {
    leaves: Vec<Leaf>,
    /// The edges of the leaves, 32 each but for the last.
    edges: Vec<u32>,
    /// Nodes over leaves, over those nodes, and so on to one that stands over all.
    levels: Vec<Vec<Node>>,
}

/// More than this, and a scan is cheaper.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// Edges that are left open or lie apart.
    open: usize,
    /// Leaves that are looked at.
    leaves: usize,
    /// Edges that are found in them.
    found: usize,
}

impl Limits {
    /// Of so many edges, and so many in the tree.
    fn new(edges: usize, in_tree: usize) -> Self {
        Self {
            open: edges / OPEN_SHARE,
            leaves: in_tree.div_ceil(LEAF) / CROWDED_LEAVES,
            found: edges / CROWDED_EDGES,
        }
    }
}

/// How many lights are still to be scanned for before the tree is tried again, how many that were at first, and why.
#[derive(Clone, Copy, Debug, Default)]
struct Waiting(u32, u32, Option<TreeSearch>);

/// What a search leaves behind, kept for its memory.
#[derive(Clone, Debug)]
struct Work {
    found: SignedEdges,
    open: Vec<u32>,
    nodes: Vec<u32>,
    next: Vec<u32>,
    heights: Vec<Heights>,
    facing: Vec<Facing>,
    signs: Vec<i8>,
}

impl Work {
    fn new(edges: usize) -> Self {
        let found = SignedEdges::new(edges);
        let (heights, facing, signs) = (vec![], vec![], vec![]);
        Self { found, open: vec![], nodes: vec![], next: vec![], heights, facing, signs }
    }
}

/// How a search went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TreeSearch {
    /// By the tree.
    Searched {
        /// Nodes whose boxes were looked at.
        nodes: usize,
        /// Leaves whose edges were looked at.
        leaves: usize,
        /// Faces that the filters left to the exact predicate; one counts for each of its edges.
        exact: usize,
    },
    /// By a scan, since too many edges were left open or lie outside the tree, or were for a light shortly before.
    Scanned,
    /// By a scan, since the silhouette runs through too many leaves, or did for a light shortly before.
    Crowded,
}

impl SilhouetteTree {
    /// Builds the tree. Takes the time of some hundred looks at all edges: worth it for many lights.
    ///
    /// # Panics
    ///
    /// Panics if `topology` has another number of faces than `mesh`.
    #[must_use]
    pub fn new(mesh: &Mesh, topology: &Topology) -> Self {
        build::build(mesh, topology)
    }

    /// The planes of the mesh's faces.
    #[must_use]
    pub fn planes(&self) -> &FacePlanes {
        &self.planes
    }

    /// The planes alone.
    pub(super) fn into_planes(self) -> FacePlanes {
        self.planes
    }

    /// All faces, those whose planes are near each other together.
    pub(super) fn face_order(&self, topology: &Topology) -> Vec<FaceId> {
        let mut placed = vec![false; topology.face_count()];
        let mut order = Vec::with_capacity(topology.face_count());
        let of_edges =
            self.store.edges.iter().flat_map(|&edge| topology.uses(EdgeId(edge))).map(|(face, _)| face);
        for face in of_edges.chain(topology.faces()) {
            if !std::mem::replace(&mut placed[face.index()], true) {
                order.push(face);
            }
        }
        order
    }

    /// Whether so many edges lie outside the tree that it never searches.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.apart.len() > self.limits.open
    }

    /// The silhouette for a light: what [`Silhouette::extract`] finds for the signs of the exact sides.
    ///
    /// On surfaces the time grows with the edges near the silhouette. Where many faces lie exactly in a plane with the
    /// light it scans instead.
    ///
    /// # Panics
    ///
    /// Panics if `mesh` or `topology` has another number of faces or edges than those that the tree was built of.
    #[must_use]
    pub fn silhouette(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &Light,
        casters: CasterFaces,
    ) -> Silhouette {
        self.search(mesh, topology, light, casters).0
    }

    /// As [`SilhouetteTree::silhouette`], and how it went.
    ///
    /// # Panics
    ///
    /// As [`SilhouetteTree::silhouette`].
    pub fn search(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &Light,
        casters: CasterFaces,
    ) -> (Silhouette, TreeSearch) {
        let mut silhouette = Silhouette::default();
        let search = self.search_into(mesh, topology, light, casters, &mut silhouette);
        (silhouette, search)
    }

    /// As [`SilhouetteTree::search`], in place of what was found before, whose memory is kept.
    pub(super) fn search_into(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &Light,
        casters: CasterFaces,
        silhouette: &mut Silhouette,
    ) -> TreeSearch {
        assert_eq!(mesh.face_count(), self.planes.offset.len(), "the tree is of another mesh");
        assert_eq!(topology.edge_count(), self.edge_count, "the tree is of another topology");
        if let Waiting(left @ 1.., _, Some(why)) = &mut self.waiting {
            *left -= 1;
            let why = *why;
            self.scan(mesh, topology, light, casters, silhouette);
            return why;
        }
        let local = self.planes.local(light);
        let walk = if self.is_idle() {
            Err(TreeSearch::Scanned)
        } else {
            let limits = Limits { open: self.limits.open - self.apart.len(), ..self.limits };
            walk(&self.store, &limits, &local, &mut self.work)
        };
        match walk {
            Ok([nodes, leaves]) => {
                self.waiting = Waiting::default();
                let (singles, exact) = self.settle(mesh, topology, &local, casters);
                self.gather(&singles, casters, silhouette);
                TreeSearch::Searched { nodes, leaves, exact }
            }
            Err(mut why) => {
                self.work.found.drain(|_, _, _| ());
                self.work.open = Vec::new();
                let ties = self.scan(mesh, topology, light, casters, silhouette);
                if ties > self.limits.open {
                    why = TreeSearch::Scanned;
                }
                let wait = (2 * self.waiting.1).clamp(1, PATIENCE);
                self.waiting = Waiting(wait, wait, Some(why));
                why
            }
        }
    }

    /// All sides and all edges; how many sides were left to the exact predicate.
    fn scan(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &Light,
        casters: CasterFaces,
        silhouette: &mut Silhouette,
    ) -> usize {
        let Work { facing, signs, .. } = &mut self.work;
        let exact = self.planes.classify_into(mesh, light, facing);
        casters.signs_into(facing, signs);
        silhouette.extract_into(topology, signs);
        exact
    }

    /// The edges that are decided one by one and are silhouette, ascending; how often the exact predicate was asked.
    fn settle(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &LocalLight,
        casters: CasterFaces,
    ) -> (Vec<SilhouetteEdge>, usize) {
        let (mut singles, mut exact) = (Vec::new(), 0);
        let mut settle = |edge: u32, side: &mut dyn FnMut(FaceId) -> Facing| {
            let edge = EdgeId(edge);
            let sides = topology.uses(edge).map(|(face, direction)| (direction, side(face)));
            let multiplicity = sides.map(|(direction, side)| direction * i32::from(casters.sign(side))).sum();
            if multiplicity != 0 {
                singles.push(SilhouetteEdge { edge, multiplicity });
            }
        };
        let mut known = [(FaceId(u32::MAX), Facing::EdgeOn); KNOWN];
        for &edge in &self.work.open {
            // The numbers of the leaf are about as fine as those of the planes. A face with one edge here has more.
            settle(edge, &mut |face| {
                let known = &mut known[face.index() % KNOWN];
                if known.0 != face {
                    exact += 1;
                    *known = (face, facing_of(mesh, face, light.light()));
                }
                known.1
            });
        }
        for &edge in &self.apart {
            settle(edge, &mut |face| {
                let (facing, asked) = self.side(mesh, face, light);
                exact += usize::from(asked);
                facing
            });
        }
        self.work.open.clear();
        singles.sort_unstable_by_key(|single| single.edge);
        (singles, exact)
    }

    fn side(&self, mesh: &Mesh, face: FaceId, light: &LocalLight) -> (Facing, bool) {
        match quantized::height(self.planes.quantized.get(face.index()), &light.quantized) {
            FRONT.. => (Facing::Front, false),
            ..=BACK => (Facing::Back, false),
            _ => self.planes.side(mesh, face.index(), light),
        }
    }

    /// What was found and the single edges, in order.
    fn gather(&mut self, singles: &[SilhouetteEdge], casters: CasterFaces, silhouette: &mut Silhouette) {
        // One face in front and one behind.
        let magnitude = if casters == CasterFaces::All { 2 } else { 1 };
        let edges = &mut silhouette.edges;
        edges.clear();
        edges.reserve(self.work.found.len() + singles.len());
        self.work.found.drain(|first, present, negative| {
            for bit in Bits(present) {
                let multiplicity = magnitude - 2 * magnitude * (negative >> bit & 1) as i32;
                edges.push(SilhouetteEdge { edge: EdgeId(first + bit), multiplicity });
            }
        });
        merge(edges, singles);
    }
}

/// Puts edges into a list without them, both ascending.
fn merge(edges: &mut Vec<SilhouetteEdge>, singles: &[SilhouetteEdge]) {
    let mut from = edges.len();
    edges.extend(singles);
    let mut to = edges.len();
    // From the end, so that nothing is overwritten that is still to be moved.
    for single in singles.iter().rev() {
        while from > 0 && edges[from - 1].edge > single.edge {
            from -= 1;
            to -= 1;
            edges[to] = edges[from];
        }
        to -= 1;
        edges[to] = *single;
    }
}

/// Collects the edges that are surely silhouette and those left open. How many nodes and leaves it looked at; or why
/// it gave up, since they are too many.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn walk(
    Store { leaves, edges, levels }: &Store,
    limits: &Limits,
    light: &LocalLight,
    work: &mut Work,
) -> Result<[usize; 2], TreeSearch> {
    let Work { found, open, nodes, next, heights, .. } = work;
    let mut looked = 0;
    nodes.clear();
    nodes.extend(levels.last().map(|_| 0));
    for level in (0..levels.len()).rev() {
        let children = if level == 0 { leaves.len() } else { levels[level - 1].len() };
        looked += nodes.len();
        // By themselves, since they become vector instructions where they are written to memory.
        heights.resize(nodes.len(), Heights::default());
        for (&node, heights) in nodes.iter().zip(&mut *heights) {
            levels[level][node as usize].heights(&light.quantized, heights);
        }
        next.resize(nodes.len() * WIDE, 0);
        let mut count = 0;
        for (&node, heights) in nodes.iter().zip(&*heights) {
            let first = node * WIDE as u32; // fewer than there are edges
            for place in 0..WIDE {
                let child = first + place as u32;
                next[count] = child;
                count += usize::from((child as usize) < children) & undecided_child(heights, place);
            }
        }
        next.truncate(count);
        std::mem::swap(nodes, next);
    }
    if nodes.len() > limits.leaves {
        return Err(TreeSearch::Crowded);
    }
    let mut batch_codes = [Codes::default(); BATCH];
    for (batches, batch) in (1..).zip(nodes.chunks(BATCH)) {
        // No branch here depends on what is found, so that the next leaves are fetched meanwhile.
        for (&leaf, codes) in batch.iter().zip(&mut batch_codes) {
            *codes = leaves[leaf as usize].codes(light);
        }
        for (&leaf, codes) in batch.iter().zip(&batch_codes) {
            let first = leaf as usize * LEAF;
            let edges = &edges[first..edges.len().min(first + LEAF)];
            for bit in Bits(codes.changes()) {
                // Beyond the last edge of the last leaf nothing is found.
                let Some(&edge) = edges.get(bit as usize / 2) else { break };
                found.insert(edge, codes.against(bit));
            }
            if codes.open() != 0 {
                let places = Bits(codes.open()).map(|bit| bit as usize / 2);
                open.extend(places.map_while(|place| edges.get(place)));
            }
        }
        if open.len() > limits.open {
            return Err(TreeSearch::Scanned);
        }
        // As it goes on like this.
        let in_all = found.len().saturating_mul(nodes.len()) / (batches * BATCH);
        if batches >= 4 && in_all > limits.found {
            return Err(TreeSearch::Crowded);
        }
    }
    Ok([looked, nodes.len()])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::silhouette::test_support;
    use crate::silhouette::test_support::{crumpled, light, scan};
    use crate::testing::shapes;

    const NONE: Limits = Limits { open: usize::MAX, leaves: usize::MAX, found: usize::MAX };

    /// A tree that searches whatever is left open.
    fn built(mesh: &Mesh) -> (Topology, SilhouetteTree) {
        let topology = Topology::of(mesh);
        let mut tree = SilhouetteTree::new(mesh, &topology);
        tree.limits = NONE;
        (topology, tree)
    }

    fn agrees(mesh: &Mesh, topology: &Topology, tree: &mut SilhouetteTree, light: &Light) -> bool {
        [CasterFaces::All, CasterFaces::Front].into_iter().all(|casters| {
            let (silhouette, search) = tree.search(mesh, topology, light, casters);
            assert!(matches!(search, TreeSearch::Searched { .. }));
            silhouette == scan(mesh, topology, light, casters)
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn silhouette_tree_equals_the_scan_on_meshes_full_of_ties(mesh in crumpled(), lights in light(20)) {
            let (topology, mut tree) = built(&mesh);
            for light in lights {
                prop_assert!(agrees(&mesh, &topology, &mut tree, &light), "{light}");
            }
        }
    }

    #[test]
    fn silhouette_tree_searched_again_and_again_forgets_what_it_found() {
        let mesh = shapes::torus(40, 30, 2.0, 0.75);
        let (topology, mut tree) = built(&mesh);
        for light in test_support::lights(&mesh).iter().chain(test_support::lights(&mesh).iter().rev()) {
            assert!(agrees(&mesh, &topology, &mut tree, light), "{light}");
        }
        // Also after a search that was given up.
        tree.limits.open = 0;
        let on_vertex = Light::point(mesh.positions()[7]).unwrap();
        let (given_up, search) = tree.search(&mesh, &topology, &on_vertex, CasterFaces::All);
        assert_eq!(search, TreeSearch::Scanned);
        assert!(given_up == scan(&mesh, &topology, &on_vertex, CasterFaces::All));
        (tree.limits, tree.waiting) = (NONE, Waiting::default());
        assert!(test_support::lights(&mesh).iter().all(|light| agrees(&mesh, &topology, &mut tree, light)));
    }

    #[test]
    fn silhouette_tree_leaves_out_most_of_a_sphere() {
        let mesh = shapes::icosphere(5);
        let (topology, mut tree) = built(&mesh);
        let light = Light::point([3.0, 4.0, 5.0]).unwrap();
        let TreeSearch::Searched { leaves, .. } = tree.search(&mesh, &topology, &light, CasterFaces::All).1
        else {
            panic!("nothing is left open")
        };
        assert!(leaves * 5 < tree.store.leaves.len(), "{leaves} of {}", tree.store.leaves.len());
    }

    #[test]
    fn silhouette_tree_that_was_given_up_is_tried_again_and_is_right_all_the_while() {
        let mesh = shapes::torus(40, 30, 2.0, 0.75);
        let (topology, mut tree) = built(&mesh);
        tree.limits.leaves = 0;
        let light = Light::point([3.0, 4.0, 5.0]).unwrap();
        let expected = scan(&mesh, &topology, &light, CasterFaces::All);
        let mut went = Vec::new();
        for i in 0..20 {
            if i == 5 {
                tree.limits = NONE;
            }
            let (silhouette, search) = tree.search(&mesh, &topology, &light, CasterFaces::All);
            assert_eq!(silhouette, expected);
            went.push(search == TreeSearch::Crowded);
        }
        // Given up, one left out; given up, two left out; and then the tree is taken.
        assert_eq!(went.iter().position(|&crowded| !crowded), Some(5));
        assert!(went[5..].iter().all(|&crowded| !crowded));
    }

    /// Whether a faulty tree is found out by the lights of the comparison.
    fn caught(mesh: &Mesh, spoil: impl FnOnce(&mut SilhouetteTree)) -> bool {
        let (topology, mut tree) = built(mesh);
        let lights = test_support::lights(mesh);
        assert!(lights.iter().all(|light| agrees(mesh, &topology, &mut tree, light)));
        spoil(&mut tree);
        lights.iter().any(|light| !agrees(mesh, &topology, &mut tree, light))
    }

    #[test]
    fn silhouette_tree_whose_edges_lack_their_second_plane_is_caught() {
        assert!(caught(&shapes::icosphere(3), |tree| {
            for row in tree.store.leaves.iter_mut().flat_map(|leaf| &mut leaf.numbers) {
                row.copy_within(..LEAF, LEAF);
            }
        }));
    }

    #[test]
    fn silhouette_tree_with_planes_beyond_their_bound_is_caught() {
        // For lights one unit in the last place off a plane: 16 of an offset make up to 8 of a height, more than the
        // bound forgives.
        assert!(caught(&shapes::icosphere(3), |tree| {
            for offsets in tree.store.leaves.iter_mut().map(|leaf| &mut leaf.numbers[3]) {
                offsets.iter_mut().for_each(|offset| *offset += 16);
            }
        }));
    }

    #[test]
    fn silhouette_tree_with_boxes_that_are_too_small_is_caught() {
        assert!(caught(&shapes::icosphere(3), |tree| {
            for [low, high] in tree.store.levels.iter_mut().flatten().flat_map(|node| &mut node.0) {
                *low = *high;
            }
        }));
    }

    #[test]
    fn silhouette_tree_without_its_boundary_edges_is_caught() {
        assert!(caught(&shapes::mobius(24), |tree| tree.apart.clear()));
    }
}
