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

use super::edge_set::{Bits, EdgeSet};
use super::plane::LocalLight;
use super::quantised::{self, BACK, FRONT, Quantised};
use super::{Casters, FacePlanes, Silhouette, SilhouetteEdge};
use crate::geom::Light;
use crate::mesh::{EdgeId, FaceId, Mesh};
use crate::topology::Topology;

/// Edges in a leaf.
const LEAF: usize = 32;
/// Children of a node.
const WIDE: usize = 8;
/// One edge in so many may be left open, or lie outside the tree, before a scan of everything is cheaper.
const OPEN_SHARE: usize = 64;

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
    work: Work,
}

/// What a search leaves behind, kept for its memory.
#[derive(Clone, Debug)]
struct Work {
    found: EdgeSet,
    /// Of an edge in `found`: whether its multiplicity is negative.
    negative: Vec<u64>,
    found_count: usize,
    open: Vec<u32>,
    nodes: Vec<u32>,
    next: Vec<u32>,
    facing: Vec<super::Facing>,
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
    /// By a scan, since too many edges were left open or lie outside the tree.
    Scanned,
}

/// The planes of 32 edges: of the faces that run along them, and of those against.
#[derive(Clone, Debug)]
struct Leaf([[[i16; LEAF]; 4]; 2]);

/// The lower bounds of eight children and then the upper ones, component by component.
#[derive(Clone, Debug, Default)]
struct Node([[i16; 2 * WIDE]; 4]);

/// An edge on its way into a leaf.
#[derive(Clone, Copy)]
struct Slot {
    /// The sum of both planes, halved.
    middle: Quantised,
    edge: u32,
}

impl SilhouetteTree {
    /// Builds the tree. Takes the time of some hundred looks at all edges: worth it for many lights.
    ///
    /// # Panics
    ///
    /// Panics if `topology` has another number of faces than `mesh`.
    #[must_use]
    pub fn new(mesh: &Mesh, topology: &Topology) -> Self {
        assert_eq!(mesh.face_count(), topology.face_count(), "the topology is of another mesh");
        let planes = FacePlanes::new(mesh);
        let (mut slots, mut apart) = (Vec::with_capacity(topology.edge_count()), Vec::new());
        for edge in topology.edges() {
            match ends(topology, &planes, edge) {
                Some([a, b]) => {
                    let middle = [0, 1, 2, 3].map(|i| ((i32::from(a[i]) + i32::from(b[i])) / 2) as i16);
                    slots.push(Slot { middle, edge: edge.0 });
                }
                None => apart.push(edge.0),
            }
        }
        arrange(&mut slots);
        let edges: Vec<u32> = slots.into_iter().map(|slot| slot.edge).collect();
        let mut leaves = Vec::with_capacity(edges.len().div_ceil(LEAF));
        let mut bounds = Vec::with_capacity(leaves.capacity());
        for edges in edges.chunks(LEAF) {
            let mut leaf = Leaf([[[0; LEAF]; 4]; 2]);
            let mut bound = Bound::NOTHING;
            for (place, &edge) in edges.iter().enumerate() {
                let ends = ends(topology, &planes, EdgeId(edge)).expect("it had them before");
                for (side, plane) in leaf.0.iter_mut().zip(ends) {
                    for (row, number) in side.iter_mut().zip(plane) {
                        row[place] = number;
                    }
                    bound = bound.around(&Bound { low: plane, high: plane });
                }
            }
            leaves.push(leaf);
            bounds.push(bound);
        }
        let mut levels = Vec::new();
        while !bounds.is_empty() {
            levels.push(bounds.chunks(WIDE).map(Node::over).collect());
            if bounds.len() <= WIDE {
                break;
            }
            bounds = bounds
                .chunks(WIDE)
                .map(|children| children.iter().fold(Bound::NOTHING, |all, child| all.around(child)))
                .collect();
        }
        let edge_count = topology.edge_count();
        let work = Work {
            found: EdgeSet::new(edge_count),
            negative: vec![0; edge_count.div_ceil(64)],
            found_count: 0,
            open: Vec::new(),
            nodes: Vec::new(),
            next: Vec::new(),
            facing: Vec::new(),
        };
        let most_open = edge_count / OPEN_SHARE;
        Self { planes, edge_count, leaves, edges, levels, apart, most_open, work }
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
        let local = self.planes.local(light);
        let (nodes, leaves) = if self.is_idle() { (0, 0) } else { self.walk(&local.quantised) };
        if self.apart.len().saturating_add(self.work.open.len()) > self.most_open {
            self.work.found.drain(|_, _| ());
            (self.work.found_count, self.work.open) = (0, Vec::new());
            self.planes.classify_into(mesh, light, &mut self.work.facing);
            let signs = casters.signs(&self.work.facing);
            return (Silhouette::extract(topology, &signs), TreeSearch::Scanned);
        }
        let (singles, exact) = self.settle(mesh, topology, &local, casters);
        (self.gather(&singles, casters), TreeSearch::Searched { nodes, leaves, exact })
    }

    /// Collects the edges that are surely silhouette and those left open, until those are too many. How many
    /// nodes and leaves it looked at.
    fn walk(&mut self, light: &Quantised) -> (usize, usize) {
        let Self { leaves, edges, levels, most_open, work, .. } = self;
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
        for &leaf in &work.nodes {
            let first = leaf as usize * LEAF;
            let edges = &edges[first..edges.len().min(first + LEAF)];
            let codes = leaves[leaf as usize].codes(light);
            for (eight, codes) in codes.chunks_exact(8).enumerate() {
                let codes = u64::from_le_bytes(codes.try_into().expect("eight"));
                // A code has two bits; one of them is enough to find it, and then it stands alone in its byte.
                let mut left = (codes | codes >> 1) & 0x0101_0101_0101_0101;
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    // Beyond the last edge of the last leaf nothing is found.
                    let Some(&edge) = edges.get(eight * 8 + bit as usize / 8) else { break };
                    match (codes >> bit) as u8 & 3 {
                        OPEN => work.open.push(edge),
                        code => {
                            work.found.insert(edge);
                            let word = &mut work.negative[edge as usize / 64];
                            let bit = edge % 64;
                            *word = *word & !(1 << bit) | u64::from(code == AGAINST) << bit;
                            work.found_count += 1;
                        }
                    }
                }
            }
            if work.open.len() > *most_open {
                break;
            }
        }
        (looked, work.nodes.len())
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
    fn over(children: &[Bound]) -> Self {
        let mut node = Self::default();
        for (place, bound) in children.iter().enumerate() {
            for i in 0..4 {
                (node.0[i][place], node.0[i][WIDE + place]) = (bound.low[i], bound.high[i]);
            }
        }
        node
    }

    /// One bit at the foot of a byte for each child that may hold a silhouette edge, or an open one.
    ///
    /// The height of a plane never falls when a number of it grows whose counterpart of the light is not negative, and
    /// never rises otherwise. So one corner of the box is the lowest that any plane within reaches, in the very numbers
    /// that decide a plane, and another corner the highest: nothing but the bound of [`Quantised`] is needed.
    #[inline(never)]
    fn undecided(&self, light: &Quantised) -> u64 {
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
        let mut undecided = [0_u8; WIDE];
        for ((undecided, &least), &most) in undecided.iter_mut().zip(least).zip(most) {
            *undecided = u8::from((least < FRONT) & (most > BACK));
        }
        u64::from_le_bytes(undecided)
    }
}

/// A box of planes.
#[derive(Clone, Copy, Debug)]
struct Bound {
    low: Quantised,
    high: Quantised,
}

impl Bound {
    const NOTHING: Self = Self { low: [i16::MAX; 4], high: [-i16::MAX; 4] };

    fn around(&self, other: &Self) -> Self {
        let mut both = *self;
        for i in 0..4 {
            both.low[i] = both.low[i].min(other.low[i]);
            both.high[i] = both.high[i].max(other.high[i]);
        }
        both
    }
}

/// The planes of the face along an edge and of the face against it, if there are just these and both are known well.
fn ends(topology: &Topology, planes: &FacePlanes, edge: EdgeId) -> Option<[Quantised; 2]> {
    let mut uses = topology.uses(edge);
    let (Some((a, up)), Some((b, down)), None) = (uses.next(), uses.next(), uses.next()) else { return None };
    if up == down {
        return None;
    }
    let (along, against) = if up > 0 { (a, b) } else { (b, a) };
    let ends = [along, against].map(|face| planes.quantised.get(face.index()));
    ends.iter().all(|plane| *plane != [0; 4]).then_some(ends)
}

/// Orders edges so that those of a leaf, of eight leaves, of 64 and so on have planes near each other: halves at the
/// middle of the widest component, at a whole number of the largest node that fits more than once.
fn arrange(slots: &mut [Slot]) {
    let mut parts = vec![slots];
    while let Some(part) = parts.pop() {
        if part.len() <= LEAF {
            continue;
        }
        let mut unit = LEAF;
        while unit * WIDE < part.len() {
            unit *= WIDE;
        }
        let bound = part
            .iter()
            .fold(Bound::NOTHING, |bound, slot| bound.around(&Bound { low: slot.middle, high: slot.middle }));
        let width = |i: usize| i32::from(bound.high[i]) - i32::from(bound.low[i]);
        let widest = [0, 1, 2, 3].into_iter().max_by_key(|&i| width(i)).expect("four");
        let half = (part.len() / 2).div_ceil(unit) * unit;
        part.select_nth_unstable_by_key(half, |slot| (slot.middle[widest], slot.edge));
        let (left, right) = part.split_at_mut(half);
        parts.extend([left, right]);
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
        tree.most_open = usize::MAX;
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
        tree.most_open = usize::MAX;
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
