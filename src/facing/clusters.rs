//! Front- and back-facing faces as index ranges: faces are ordered in clusters of similar planes, and a
//! bounding hierarchy over the planes classifies whole clusters at once.
//!
//! A cluster has 32 faces. The hierarchy is that of the silhouette tree: boxes over planes, eight children
//! per node. Only clusters that no box decides are evaluated face by face. (Cf. the clusters that Matt Olson
//! and Hao Zhang, *Silhouette Extraction in Hough Space*, 2006, leave out; here what is left out is drawn.)

use std::ops::Range;

use super::plane_tree::{self, Bound, LEAF, Node, WIDE};
use super::planes::LocalLight;
use super::quantized::{BACK, FRONT, Quantized};
use super::{FacePlanes, quantized};
use crate::geom::{Facing, Light};
use crate::mesh::{FaceId, Mesh};

/// Classify all faces one by one when more than 1/64 of them are left open by the integers: an open face
/// costs about as much as some tens of others.
pub(crate) const OPEN_SHARE: usize = 64;

/// An order of the faces of a mesh in which most front-facing faces of a light are consecutive.
///
/// Made for drawing: with the triangles in this order in an index buffer, and once more each reversed, both
/// caps of a shadow volume are draws of a few ranges of that buffer, the dark cap with an offset of the
/// vertices. Single faces and the sides go into a small buffer that is written for each light; no step then
/// takes time for every face. [`FrameExtruder`](crate::shadow::volume::FrameExtruder) does all of this.
///
/// Holds 12 bytes per face and a share of the nodes.
///
/// ```
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// use umbrage::facing::{FaceClusters, FacePlanes, FacingRanges};
/// use umbrage::geom::Facing;
/// let sphere = shapes::icosphere(5);
/// let planes = FacePlanes::new(&sphere);
/// let clusters = FaceClusters::new(&sphere, &planes);
/// let mut ranges = FacingRanges::default();
/// clusters.find(&sphere, &planes, &Light::point([3.0, 4.0, 5.0])?, &mut ranges);
/// let in_ranges: u32 = ranges.front.iter().chain(&ranges.back).map(|range| range.end - range.start).sum();
/// assert!(in_ranges as usize > sphere.face_count() / 4 * 3);
/// assert!(ranges.single.len() < sphere.face_count() / 8);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct FaceClusters {
    order: Vec<FaceId>,
    clusters: Vec<Cluster>,
    levels: Vec<Vec<Node>>,
}

/// The planes of 32 faces.
#[derive(Clone, Debug)]
struct Cluster([[i16; LEAF]; 4]);

/// The faces that a light is in front of, and those that it is behind.
#[derive(Clone, Debug, Default)]
pub struct FacingRanges {
    /// Ranges of [`FaceClusters::order`] with the light in front of every face: ascending, none empty, none
    /// starting where another ends.
    pub front: Vec<Range<u32>>,
    /// The same with the light behind every face.
    pub back: Vec<Range<u32>>,
    /// The other faces, ascending in the order, with their sides. Edge-on faces are not listed.
    pub single: Vec<(FaceId, Facing)>,
    /// Nodes that are still to be visited; kept for its memory.
    stack: Vec<Part>,
    /// The sides of all faces, where clusters decide too few; kept for its memory.
    facing: Vec<Facing>,
}

impl PartialEq for FacingRanges {
    fn eq(&self, other: &Self) -> bool {
        (&self.front, &self.back, &self.single) == (&other.front, &other.back, &other.single)
    }
}

impl Eq for FacingRanges {}

/// A node of the hierarchy, or a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    /// Levels of nodes from here down to the clusters: 0 for a cluster.
    height: u32,
    /// The index of the node in its level, or of the cluster.
    index: u32,
    /// The side of all its faces; edge-on if that is not known.
    facing: Facing,
}

impl FaceClusters {
    /// Orders the faces. On several threads with the feature `parallel`.
    ///
    /// # Panics
    ///
    /// Panics if the planes are of a mesh with another number of faces.
    #[must_use]
    pub fn new(mesh: &Mesh, planes: &FacePlanes) -> Self {
        assert_eq!(mesh.face_count(), planes.offset.len(), "the planes are of another mesh");
        Self::of_faces(planes, 0..planes.offset.len() as u32) // face ids are 32 bits
    }

    /// Orders some faces of a mesh.
    pub(crate) fn of_faces(planes: &FacePlanes, faces: impl Iterator<Item = u32>) -> Self {
        let number = |face: u32| planes.quantized.get(face as usize);
        let faces = plane_tree::arrange(faces.map(|face| (number(face), face)).collect());
        let clusters: Vec<Cluster> = faces
            .chunks(LEAF)
            .map(|faces| {
                let mut cluster = Cluster([[0; LEAF]; 4]);
                for (slot, &face) in faces.iter().enumerate() {
                    for (row, number) in cluster.0.iter_mut().zip(number(face)) {
                        row[slot] = number;
                    }
                }
                cluster
            })
            .collect();
        let bound = |faces: &[u32]| Bound::of(faces.iter().map(|&face| number(face)));
        let levels = plane_tree::levels(faces.chunks(LEAF).map(bound).collect());
        Self { order: faces.into_iter().map(FaceId).collect(), clusters, levels }
    }

    /// All faces, cluster by cluster.
    #[must_use]
    pub fn order(&self) -> &[FaceId] {
        &self.order
    }

    /// The triangles of the mesh in this order: an index buffer whose ranges can be drawn.
    ///
    /// # Panics
    ///
    /// Panics if the mesh has fewer faces than the one that this was made for.
    #[must_use]
    pub fn triangles(&self, mesh: &Mesh) -> Vec<[u32; 3]> {
        self.order.iter().map(|face| mesh.triangles()[face.index()]).collect()
    }

    /// Divides the faces by the side that the light is on, exactly as [`classify`](super::classify) does.
    /// What `ranges` held is replaced, and its memory kept.
    ///
    /// Cost: an evaluation of each cluster that has faces of both sides, or nearly, and of the nodes over it.
    /// Where many faces lie in a plane with the light, it costs what [`FacePlanes::classify_into`] does, and
    /// a visit to each face.
    ///
    /// # Panics
    ///
    /// Panics if mesh or planes have another number of faces than those that this was made for.
    pub fn find(&self, mesh: &Mesh, planes: &FacePlanes, light: &Light, ranges: &mut FacingRanges) {
        assert_eq!(mesh.face_count(), self.order.len(), "the clusters are of another mesh");
        assert_eq!(planes.offset.len(), self.order.len(), "the planes are of another mesh");
        let mut spare = self.order.len() / OPEN_SHARE;
        if !self.search(mesh, planes, &planes.local(light), ranges, &mut spare) {
            self.scan(mesh, planes, light, ranges);
        }
    }

    /// By the hierarchy. Takes the number of faces that were left open and decided one by one from `spare`;
    /// `false`, and `ranges` are of no use, if they are more than that.
    pub(crate) fn search(
        &self,
        mesh: &Mesh,
        planes: &FacePlanes,
        local: &LocalLight,
        ranges: &mut FacingRanges,
        spare: &mut usize,
    ) -> bool {
        let FacingRanges { front, back, single, stack, .. } = ranges;
        front.clear();
        back.clear();
        single.clear();
        stack.clear();
        let height = self.levels.len() as u32;
        stack.extend((height > 0).then_some(Part { height, index: 0, facing: Facing::EdgeOn }));
        while let Some(part) = stack.pop() {
            match (part.facing, part.height) {
                (Facing::Front, _) => extend(front, self.slots(part)),
                (Facing::Back, _) => extend(back, self.slots(part)),
                (Facing::EdgeOn, 0) => {
                    let slots = self.slots(part);
                    let faces = &self.order[slots.start as usize..slots.end as usize];
                    let mut sides = [Facing::EdgeOn; LEAF];
                    self.clusters[part.index as usize].evaluate(&local.quantized, &mut sides);
                    let sides = &mut sides[..faces.len()];
                    let mut open = 0;
                    for (side, face) in
                        sides.iter_mut().zip(faces).filter(|(side, _)| **side == Facing::EdgeOn)
                    {
                        open += 1;
                        *side = planes.side(mesh, face.index(), local).0;
                    }
                    match spare.checked_sub(open) {
                        Some(left) => *spare = left,
                        None => return false,
                    }
                    ranges_of(slots, faces, sides, [&mut *front, &mut *back], single);
                }
                (Facing::EdgeOn, height) => {
                    let node = &self.levels[height as usize - 1][part.index as usize];
                    let [undecided, in_front] = node.decided(&local.quantized);
                    let below = if height == 1 {
                        self.clusters.len()
                    } else {
                        self.levels[height as usize - 2].len()
                    };
                    let first = part.index * WIDE as u32; // fewer than there are faces
                    let count = (below - first as usize).min(WIDE) as u32;
                    stack.extend((0..count).rev().map(|child| {
                        let is_in = |bits: u64| bits >> (8 * child) & 1 == 1;
                        let facing = match (is_in(undecided), is_in(in_front)) {
                            (true, _) => Facing::EdgeOn,
                            (false, true) => Facing::Front,
                            (false, false) => Facing::Back,
                        };
                        Part { height: height - 1, index: first + child, facing }
                    }));
                }
            }
        }
        true
    }

    /// By the sides of all faces, in the order of the mesh, where many are open: memory is then read in
    /// order.
    fn scan(&self, mesh: &Mesh, planes: &FacePlanes, light: &Light, ranges: &mut FacingRanges) {
        let FacingRanges { front, back, single, facing, .. } = ranges;
        front.clear();
        back.clear();
        single.clear();
        planes.classify_into(mesh, light, facing);
        for (first, faces) in (0..).step_by(LEAF).zip(self.order.chunks(LEAF)) {
            let mut sides = [Facing::EdgeOn; LEAF];
            for (side, face) in sides.iter_mut().zip(faces) {
                *side = facing[face.index()];
            }
            let slots = first..first + faces.len() as u32; // fewer than 2^32
            ranges_of(slots, faces, &sides[..faces.len()], [&mut *front, &mut *back], single);
        }
    }

    /// The faces of a part, as a range of the order.
    fn slots(&self, part: Part) -> Range<u32> {
        let count = (LEAF as u64) * (WIDE as u64).pow(part.height);
        let end = |index: u64| (index * count).min(self.order.len() as u64) as u32;
        end(part.index.into())..end(u64::from(part.index) + 1)
    }
}

impl Cluster {
    /// The sides that the integers decide; edge-on where they do not.
    #[inline(never)]
    fn evaluate(&self, light: &Quantized, sides: &mut [Facing]) {
        let mut heights = [0; LEAF];
        quantized::heights(self.0.each_ref().map(|row| &row[..]), light, &mut heights);
        for (side, &height) in sides.iter_mut().zip(&heights) {
            *side = match height {
                FRONT.. => Facing::Front,
                ..=BACK => Facing::Back,
                _ => Facing::EdgeOn,
            };
        }
    }
}

/// Adds the faces of a cluster whose sides are known: as a range if they are all on one, else each by itself.
fn ranges_of(
    slots: Range<u32>,
    faces: &[FaceId],
    sides: &[Facing],
    [front, back]: [&mut Vec<Range<u32>>; 2],
    single: &mut Vec<(FaceId, Facing)>,
) {
    let all = |one| sides.iter().fold(true, |all, &side| all & (side == one));
    if all(Facing::Front) {
        extend(front, slots);
    } else if all(Facing::Back) {
        extend(back, slots);
    } else if !all(Facing::EdgeOn) {
        let known = faces.iter().copied().zip(sides.iter().copied());
        single.extend(known.filter(|(_, side)| *side != Facing::EdgeOn));
    }
}

/// Adds a range, to the last one if that ends where it begins.
fn extend(ranges: &mut Vec<Range<u32>>, more: Range<u32>) {
    match ranges.last_mut() {
        Some(last) if last.end == more.start => last.end = more.end,
        _ => ranges.push(more),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::facing::{FacePlanes, classify};
    use crate::silhouette::test_support;
    use crate::silhouette::test_support::{crumpled, light};
    use crate::testing::shapes;

    fn built(mesh: &Mesh) -> (FacePlanes, FaceClusters) {
        let planes = FacePlanes::new(mesh);
        let clusters = FaceClusters::new(mesh, &planes);
        (planes, clusters)
    }

    /// Whether each face is where its side belongs, once, and the ranges are as they are described.
    fn agrees(
        mesh: &Mesh,
        light: &Light,
        (planes, clusters): &(FacePlanes, FaceClusters),
        found: &mut FacingRanges,
    ) -> bool {
        // By whichever method, and by the boxes alone.
        clusters.find(mesh, planes, light, found);
        let mut searched = FacingRanges::default();
        let local = planes.local(light);
        if !clusters.search(mesh, planes, &local, &mut searched, &mut { usize::MAX }) || searched != *found {
            return false;
        }
        let mut times = vec![0; mesh.face_count()];
        let mut sides = vec![Facing::EdgeOn; mesh.face_count()];
        let mut set = |face: FaceId, side| {
            times[face.index()] += 1;
            sides[face.index()] = side;
        };
        for (ranges, side) in [(&found.front, Facing::Front), (&found.back, Facing::Back)] {
            for place in ranges.iter().cloned().flatten() {
                set(clusters.order()[place as usize], side);
            }
        }
        found.single.iter().for_each(|&(face, side)| set(face, side));
        let apart = |ranges: &[Range<u32>]| ranges.windows(2).all(|pair| pair[0].end < pair[1].start);
        let listed = |(&times, &side): (&u8, &Facing)| times == u8::from(side != Facing::EdgeOn);
        apart(&found.front)
            && apart(&found.back)
            && found.front.iter().chain(&found.back).all(|range| !range.is_empty())
            && times.iter().zip(&sides).all(listed)
            && sides == classify(mesh, light)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn facing_by_clusters_equals_the_predicate_on_meshes_full_of_ties(mesh in crumpled(), lights in light(10)) {
            let (built, mut found) = (built(&mesh), FacingRanges::default());
            for light in lights {
                prop_assert!(agrees(&mesh, &light, &built, &mut found), "{light}");
            }
        }
    }

    #[test]
    fn facing_by_clusters_equals_the_predicate_on_whole_meshes() {
        let empty = Mesh::new(vec![], vec![]).unwrap();
        let somewhere = Light::point([1.0, 2.0, 3.0]).unwrap();
        assert!(agrees(&empty, &somewhere, &built(&empty), &mut FacingRanges::default()));
        for mesh in
            [shapes::cube(), shapes::icosphere(4), shapes::menger_sponge(2), shapes::torus(40, 40, 2.0, 0.75)]
        {
            let (built, mut found) = (built(&mesh), FacingRanges::default());
            for light in test_support::lights(&mesh) {
                assert!(agrees(&mesh, &light, &built, &mut found), "{light}");
            }
        }
    }

    #[test]
    fn facing_by_clusters_full_of_ties_is_found_by_a_scan() {
        let mesh = shapes::menger_sponge(2);
        let (planes, clusters) = built(&mesh);
        let [mut scanned, mut found] = [(); 2].map(|()| FacingRanges::default());
        let [axis, skew] = [[0.0, 0.0, -1.0], [1.0, 2.0, 3.0]].map(|way| Light::directional(way).unwrap());
        for (light, ties) in [(axis, true), (skew, false)] {
            let mut spare = clusters.order.len() / OPEN_SHARE;
            let searched = clusters.search(&mesh, &planes, &planes.local(&light), &mut found, &mut spare);
            assert_eq!(searched, !ties);
            clusters.scan(&mesh, &planes, &light, &mut scanned);
            clusters.find(&mesh, &planes, &light, &mut found);
            assert_eq!(scanned, found);
        }
    }

    #[test]
    fn facing_by_clusters_leaves_few_faces_of_a_sphere_alone() {
        let mesh = shapes::icosphere(5);
        let (built, mut found) = (built(&mesh), FacingRanges::default());
        assert!(agrees(&mesh, &Light::point([3.0, 4.0, 5.0]).unwrap(), &built, &mut found));
        let (single, ranges) = (found.single.len(), found.front.len() + found.back.len());
        assert!(single < mesh.face_count() / 8 && ranges < mesh.face_count() / 64, "{single} and {ranges}");
    }

    /// Whether faulty clusters are found out by the lights of the comparison.
    fn caught(spoil: impl FnOnce(&mut FaceClusters)) -> bool {
        let mesh = shapes::icosphere(3);
        let (mut built, mut found) = (built(&mesh), FacingRanges::default());
        let lights = test_support::lights(&mesh);
        assert!(lights.iter().all(|light| agrees(&mesh, light, &built, &mut found)));
        spoil(&mut built.1);
        lights.iter().any(|light| !agrees(&mesh, light, &built, &mut found))
    }

    #[test]
    fn facing_by_clusters_with_boxes_that_are_too_small_is_caught() {
        assert!(caught(|clusters| {
            for [low, high] in clusters.levels.iter_mut().flatten().flat_map(|node| &mut node.0) {
                *low = *high;
            }
        }));
    }

    #[test]
    fn facing_by_clusters_with_planes_of_another_face_is_caught() {
        assert!(caught(|clusters| clusters.clusters.swap(3, 9)));
    }
}
