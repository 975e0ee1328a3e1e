//! The silhouette by a tree of edges that leaves out, many at once, those whose two faces are surely on one side.
//!
//! Each edge with two faces in opposite directions is a segment between their planes, points of a space of four
//! dimensions (normal and offset), and a light is a plane of that space: the edge is silhouette when its segment crosses
//! it (Aaron Hertzmann, Denis Zorin, *Illustrating Smooth Surfaces*, 2000, section 4.2, for the dual space; Matt Olson,
//! Hao Zhang, *Silhouette Extraction in Hough Space*, 2006, for a tree in it). A tree of boxes over such segments needs
//! no halo, since every edge brings both its planes, and no geometry but theirs.
//!
//! All of it is done in the whole numbers of `quantised.rs`. Departures from the papers: edges lie in
//! leaves of 32 whose two planes stand side by side, so that a leaf is evaluated by vector instructions without a single
//! gather; nodes have eight children; and what the numbers leave open is decided exactly.

pub(super) mod build;

use super::edge_set::{Bits, EdgeSet};
use super::plane::LocalLight;
use super::quantised::{self, BACK, FRONT, Quantised};
use super::{Casters, FacePlanes, Silhouette, SilhouetteEdge};
use crate::geom::Light;
use crate::mesh::{EdgeId, FaceId, Mesh};
use crate::topology::Topology;

/// Edges in a leaf.
pub(super) const LEAF: usize = 32;
/// Children of a node.
pub(super) const WIDE: usize = 8;
/// One edge in so many may be left open, or lie outside the tree, before a scan of everything is cheaper.
const OPEN_SHARE: usize = 64;
/// One leaf in so many may have to be looked at,
const CROWDED_LEAVES: usize = 4;
/// and one edge in so many may be found, before a scan is cheaper.
const CROWDED_EDGES: usize = 40;
/// Leaves that are looked at before what was found in them is collected.
const BATCH: usize = 64;
/// After searches that were given up, so many lights at most are scanned for before the tree is tried again: trying costs
/// up to a fifth of a scan.
const PATIENCE: u32 = 8;

/// A tree over the edges of a mesh, for many lights while the mesh rests.
///
/// Holds the [`FacePlanes`] of the mesh, and for each edge 20 bytes and a share of the nodes.
///
/// ```
/// use umbrage::{geom::Light, mesh::solid, topology::Topology};
/// use umbrage::silhouette::{Casters, SilhouetteTree};
/// let cube = solid::cube();
/// let topology = Topology::build(cube.vertex_count(), cube.triangles().to_vec());
/// let mut tree = SilhouetteTree::new(&cube, &topology);
/// let light = Light::directional([-1.0, -1.0, -1.0])?;
/// let silhouette = tree.silhouette(&cube, &topology, &light, Casters::All);
/// assert_eq!(silhouette.edges.len(), 6); // along the body diagonal: a hexagon
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SilhouetteTree {
    planes: FacePlanes,
    edge_count: usize,
    leaves: Vec<Leaf>,
    /// The edges of the leaves, 32 each but for the last.
    edges: Vec<u32>,
    /// Nodes over leaves, over those nodes, and so on to one that stands over all.
    levels: Vec<Vec<Node>>,
    /// Edges with other faces than two in opposite directions, or with a face whose plane is not known well: looked at
    /// one by one for every light.
    apart: Vec<u32>,
    /// How many edges may be left open or lie apart before a scan is cheaper.
    most_open: usize,
    /// How many leaves may be looked at, and how many edges found in them.
    most_leaves: usize,
    most_found: usize,
    waiting: Waiting,
    work: Work,
}

/// How many lights are still to be scanned for before the tree is tried again, how many that were at first, and why.
#[derive(Clone, Copy, Debug, Default)]
struct Waiting(u32, u32, Option<TreeSearch>);

/// What a search leaves behind, kept for its memory.
#[derive(Clone, Debug)]
struct Work {
    found: EdgeSet,
    /// Of an edge in `found`: whether its multiplicity is negative.
    negative: Vec<u64>,
    found_count: usize,
    /// Edges on their way into `found`, doubled, plus 1 if negative.
    hits: Vec<u32>,
    open: Vec<u32>,
    nodes: Vec<u32>,
    next: Vec<u32>,
    facing: Vec<super::Facing>,
    signs: Vec<i8>,
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

/// The planes of 32 edges: of the faces that run along them, and of those against.
#[derive(Clone, Debug)]
struct Leaf([[[i16; LEAF]; 4]; 2]);

/// The lower bounds of eight children and then the upper ones, component by component.
#[derive(Clone, Debug, Default)]
pub(super) struct Node(pub(super) [[i16; 2 * WIDE]; 4]);

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
        let of_edges = self.edges.iter().flat_map(|&edge| topology.uses(EdgeId(edge))).map(|(face, _)| face);
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
        self.apart.len() > self.most_open
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
        casters: Casters,
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
        casters: Casters,
    ) -> (Silhouette, TreeSearch) {
        assert_eq!(mesh.face_count(), self.planes.offset.len(), "the tree is of another mesh");
        assert_eq!(topology.edge_count(), self.edge_count, "the tree is of another topology");
        if let Waiting(left @ 1.., _, Some(why)) = &mut self.waiting {
            *left -= 1;
            let why = *why;
            return (self.scan(mesh, topology, light, casters).0, why);
        }
        let local = self.planes.local(light);
        let walk = if self.is_idle() { Err(TreeSearch::Scanned) } else { self.walk(&local.quantised) };
        match walk {
            Ok([nodes, leaves]) => {
                self.waiting = Waiting::default();
                let (singles, exact) = self.settle(mesh, topology, &local, casters);
                (self.gather(&singles, casters), TreeSearch::Searched { nodes, leaves, exact })
            }
            Err(mut why) => {
                (self.work.hits, self.work.open) = (Vec::new(), Vec::new());
                let (silhouette, ties) = self.scan(mesh, topology, light, casters);
                if ties > self.most_open {
                    why = TreeSearch::Scanned;
                }
                let wait = (2 * self.waiting.1).clamp(1, PATIENCE);
                self.waiting = Waiting(wait, wait, Some(why));
                (silhouette, why)
            }
        }
    }

    /// All sides and all edges; how many sides were left to the exact predicate.
    fn scan(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &Light,
        casters: Casters,
    ) -> (Silhouette, usize) {
        let Work { facing, signs, .. } = &mut self.work;
        let exact = self.planes.classify_into(mesh, light, facing);
        casters.signs_into(facing, signs);
        (Silhouette::extract(topology, signs), exact)
    }

    /// Collects the edges that are surely silhouette and those left open. How many nodes and leaves it looked at; or why
    /// it gave up, since they are too many.
    fn walk(&mut self, light: &Quantised) -> Result<[usize; 2], TreeSearch> {
        let Self { leaves, edges, levels, most_leaves, most_found, work, .. } = self;
        let most_open = self.most_open.saturating_sub(self.apart.len());
        let mut looked = 0;
        work.nodes.clear();
        work.nodes.extend(levels.last().map(|_| 0));
        for level in (0..levels.len()).rev() {
            let children = if level == 0 { leaves.len() } else { levels[level - 1].len() };
            looked += work.nodes.len();
            work.next.clear();
            for &node in &work.nodes {
                let first = node * WIDE as u32; // fewer than there are edges
                let undecided = levels[level][node as usize].undecided(light);
                let undecided = Bits(undecided).map(|bit| first + bit / 8);
                work.next.extend(undecided.filter(|&child| (child as usize) < children));
            }
            std::mem::swap(&mut work.nodes, &mut work.next);
        }
        if work.nodes.len() > *most_leaves {
            return Err(TreeSearch::Crowded);
        }
        let mut batch_codes = [[QUIET; LEAF]; BATCH];
        for (batches, batch) in (1..).zip(work.nodes.chunks(BATCH)) {
            // No branch here depends on what is found, so that the next leaves are fetched meanwhile.
            for (&leaf, codes) in batch.iter().zip(&mut batch_codes) {
                *codes = leaves[leaf as usize].codes(light);
            }
            for (&leaf, codes) in batch.iter().zip(&batch_codes) {
                let first = leaf as usize * LEAF;
                let edges = &edges[first..edges.len().min(first + LEAF)];
                for (eight, codes) in codes.as_chunks::<8>().0.iter().enumerate() {
                    let codes = u64::from_le_bytes(*codes);
                    // A code has two bits; one of them is enough to find it, and then it stands alone in its byte.
                    for bit in Bits((codes | codes >> 1) & 0x0101_0101_0101_0101) {
                        // Beyond the last edge of the last leaf nothing is found.
                        let Some(&edge) = edges.get(eight * 8 + bit as usize / 8) else { break };
                        match (codes >> bit) as u8 & 3 {
                            OPEN => work.open.push(edge),
                            // Edges number less than 2^31.
                            code => work.hits.push(edge << 1 | u32::from(code == AGAINST)),
                        }
                    }
                }
            }
            if work.open.len() > most_open {
                return Err(TreeSearch::Scanned);
            }
            // As it goes on like this.
            let found = work.hits.len().saturating_mul(work.nodes.len()) / (batches * BATCH);
            if batches >= 4 && found > *most_found {
                return Err(TreeSearch::Crowded);
            }
        }
        for hit in work.hits.drain(..) {
            let edge = hit >> 1;
            work.found.insert(edge);
            let (word, bit) = (&mut work.negative[edge as usize / 64], edge % 64);
            *word = *word & !(1 << bit) | u64::from(hit & 1) << bit;
            work.found_count += 1;
        }
        Ok([looked, work.nodes.len()])
    }

    /// The edges that are decided one by one and are silhouette, ascending; how often the exact predicate was asked.
    fn settle(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        light: &LocalLight,
        casters: Casters,
    ) -> (Vec<SilhouetteEdge>, usize) {
        let (mut singles, mut exact) = (Vec::new(), 0);
        for &edge in self.work.open.iter().chain(&self.apart) {
            let edge = EdgeId(edge);
            let multiplicity = topology
                .uses(edge)
                .map(|(face, direction)| {
                    let (facing, asked) = self.side(mesh, face, light);
                    exact += usize::from(asked);
                    direction * i32::from(casters.sign(facing))
                })
                .sum();
            if multiplicity != 0 {
                singles.push(SilhouetteEdge { edge, multiplicity });
            }
        }
        self.work.open.clear();
        singles.sort_unstable_by_key(|single| single.edge);
        (singles, exact)
    }

    fn side(&self, mesh: &Mesh, face: FaceId, light: &LocalLight) -> (super::Facing, bool) {
        match quantised::height(self.planes.quantised.get(face.index()), &light.quantised) {
            FRONT.. => (super::Facing::Front, false),
            ..=BACK => (super::Facing::Back, false),
            _ => self.planes.side(mesh, face.index(), light),
        }
    }

    /// What was found and the single edges, in order.
    fn gather(&mut self, singles: &[SilhouetteEdge], casters: Casters) -> Silhouette {
        // One face in front and one behind.
        let magnitude = if casters == Casters::All { 2 } else { 1 };
        let Work { found, negative, found_count, .. } = &mut self.work;
        let mut edges = Vec::with_capacity(std::mem::take(found_count) + singles.len());
        let mut singles = singles.iter().copied().peekable();
        found.drain(|first, bits| {
            let negative = negative[first as usize / 64];
            for bit in Bits(bits) {
                let edge = EdgeId(first + bit);
                while let Some(single) = singles.next_if(|single| single.edge < edge) {
                    edges.push(single);
                }
                let multiplicity = magnitude - 2 * magnitude * (negative >> bit & 1) as i32;
                edges.push(SilhouetteEdge { edge, multiplicity });
            }
        });
        edges.extend(singles);
        Silhouette { edges }
    }
}

/// Both faces on one side.
const QUIET: u8 = 0;
/// The face along the edge is in front, the other behind.
const ALONG: u8 = 1;
/// The face against the edge is in front, the other behind.
const AGAINST: u8 = 2;
/// A face whose side the numbers leave open.
const OPEN: u8 = 3;

impl Leaf {
    const EMPTY: Self = Self([[[0; LEAF]; 4]; 2]);

    /// What is known of each edge, in the lowest two bits of a byte.
    #[inline]
    fn codes(&self, light: &Quantised) -> [u8; LEAF] {
        let mut heights = [[0; LEAF]; 2];
        for (planes, heights) in self.0.iter().zip(&mut heights) {
            quantised::heights(planes.each_ref().map(|row| &row[..]), light, heights);
        }
        let mut codes = [QUIET; LEAF];
        compare(&heights[0], &heights[1], &mut codes);
        codes
    }
}

/// Codes of edges from the heights of their faces.
#[inline(never)]
fn compare(along: &[i16], against: &[i16], codes: &mut [u8]) {
    for ((&a, &b), known) in along.iter().zip(against).zip(codes) {
        let open = ((a < FRONT) & (a > BACK)) | ((b < FRONT) & (b > BACK));
        let differ = (a < FRONT) != (b < FRONT);
        let side = if a > b { ALONG } else { AGAINST };
        *known = if open {
            OPEN
        } else if differ {
            side
        } else {
            QUIET
        };
    }
}

impl Node {
    /// One bit at the foot of a byte for each child that may hold a silhouette edge, or an open one.
    ///
    /// The height of a plane never falls when a number of it grows whose counterpart of the light is not negative, and
    /// never rises otherwise. So one corner of the box is the lowest that any plane within reaches, in the very numbers
    /// that decide a plane, and another corner the highest: nothing but the bound of [`Quantised`] is needed.
    fn undecided(&self, light: &Quantised) -> u64 {
        self.decided(light)[0]
    }

    /// The same, and one bit for each child whose planes all have the light in front.
    #[inline(never)]
    pub(super) fn decided(&self, light: &Quantised) -> [u64; 2] {
        let mut corners = self.0;
        for (row, &number) in corners.iter_mut().zip(light) {
            if number < 0 {
                let (low, high) = row.split_at_mut(WIDE);
                low.swap_with_slice(high);
            }
        }
        let mut heights = [0; 2 * WIDE];
        quantised::heights(corners.each_ref().map(|row| &row[..]), light, &mut heights);
        let (least, most) = heights.split_at(WIDE);
        let (mut undecided, mut in_front) = ([0_u8; WIDE], [0_u8; WIDE]);
        for (((undecided, in_front), &least), &most) in
            undecided.iter_mut().zip(&mut in_front).zip(least).zip(most)
        {
            *undecided = u8::from((least < FRONT) & (most > BACK));
            *in_front = u8::from(least >= FRONT);
        }
        [undecided, in_front].map(u64::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::trial::{self, crumpled, light, scan};
    use super::*;
    use crate::mesh::solid;

    /// A tree that searches whatever is left open.
    fn built(mesh: &Mesh) -> (Topology, SilhouetteTree) {
        let topology = Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
        let mut tree = SilhouetteTree::new(mesh, &topology);
        (tree.most_open, tree.most_leaves, tree.most_found) = (usize::MAX, usize::MAX, usize::MAX);
        (topology, tree)
    }

    fn agrees(mesh: &Mesh, topology: &Topology, tree: &mut SilhouetteTree, light: &Light) -> bool {
        [Casters::All, Casters::Front].into_iter().all(|casters| {
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
        let mesh = solid::torus(40, 30, 2.0, 0.75);
        let (topology, mut tree) = built(&mesh);
        for light in trial::lights(&mesh).iter().chain(trial::lights(&mesh).iter().rev()) {
            assert!(agrees(&mesh, &topology, &mut tree, light), "{light}");
        }
        // Also after a search that was given up.
        tree.most_open = 0;
        let on_vertex = Light::point(mesh.positions()[7]).unwrap();
        let (given_up, search) = tree.search(&mesh, &topology, &on_vertex, Casters::All);
        assert_eq!(search, TreeSearch::Scanned);
        assert!(given_up == scan(&mesh, &topology, &on_vertex, Casters::All));
        (tree.most_open, tree.waiting) = (usize::MAX, Waiting::default());
        assert!(trial::lights(&mesh).iter().all(|light| agrees(&mesh, &topology, &mut tree, light)));
    }

    #[test]
    fn silhouette_tree_leaves_out_most_of_a_sphere() {
        let mesh = solid::icosphere(5);
        let (topology, mut tree) = built(&mesh);
        let light = Light::point([3.0, 4.0, 5.0]).unwrap();
        let TreeSearch::Searched { leaves, .. } = tree.search(&mesh, &topology, &light, Casters::All).1
        else {
            panic!("nothing is left open")
        };
        assert!(leaves * 5 < tree.leaves.len(), "{leaves} of {}", tree.leaves.len());
    }

    #[test]
    fn silhouette_tree_that_was_given_up_is_tried_again_and_is_right_all_the_while() {
        let mesh = solid::torus(40, 30, 2.0, 0.75);
        let (topology, mut tree) = built(&mesh);
        tree.most_leaves = 0;
        let light = Light::point([3.0, 4.0, 5.0]).unwrap();
        let expected = scan(&mesh, &topology, &light, Casters::All);
        let mut went = Vec::new();
        for i in 0..20 {
            if i == 5 {
                tree.most_leaves = usize::MAX;
            }
            let (silhouette, search) = tree.search(&mesh, &topology, &light, Casters::All);
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
        let lights = trial::lights(mesh);
        assert!(lights.iter().all(|light| agrees(mesh, &topology, &mut tree, light)));
        spoil(&mut tree);
        lights.iter().any(|light| !agrees(mesh, &topology, &mut tree, light))
    }

    #[test]
    fn silhouette_tree_whose_edges_lack_their_second_plane_is_caught() {
        assert!(caught(&solid::icosphere(3), |tree| {
            for Leaf([along, against]) in &mut tree.leaves {
                *against = *along;
            }
        }));
    }

    #[test]
    fn silhouette_tree_with_planes_beyond_their_bound_is_caught() {
        // For lights one unit in the last place off a plane: 16 of an offset make up to 8 of a height, more than the
        // bound forgives.
        assert!(caught(&solid::icosphere(3), |tree| {
            for offsets in tree.leaves.iter_mut().flat_map(|leaf| &mut leaf.0).map(|planes| &mut planes[3]) {
                offsets.iter_mut().for_each(|offset| *offset += 16);
            }
        }));
    }

    #[test]
    fn silhouette_tree_with_boxes_that_are_too_small_is_caught() {
        assert!(caught(&solid::icosphere(3), |tree| {
            for row in tree.levels.iter_mut().flatten().flat_map(|node| &mut node.0) {
                let (low, high) = row.split_at_mut(WIDE);
                low.copy_from_slice(high);
            }
        }));
    }

    #[test]
    fn silhouette_tree_without_its_boundary_edges_is_caught() {
        assert!(caught(&solid::mobius(24), |tree| tree.apart.clear()));
    }
}
