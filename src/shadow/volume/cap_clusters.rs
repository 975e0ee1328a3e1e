//! Both caps as ranges of an index buffer that is the same for every light, and a few single triangles.
//!
//! Faces are ordered by [`FaceClusters`], group by group: each large shell is a group of its own, and small
//! shells of one kind of proof share one. In a group that shares one choice of casting faces, ranges of front
//! faces (and of back faces, where these cast) are drawn as they are. A small shell of which more faces cast
//! than of the others of its group (the light is inside) is visited face by face for the rest.

use std::ops::Range;

use super::ShellFaces;
use super::cap::turned;
use crate::caster::{Caster, ShellProof};
use crate::facing::{CASTS_BEHIND, CASTS_IN_FRONT, CasterFaces, FaceClusters, FacingRanges, OPEN_SHARE};
use crate::geom::{Facing, Light};
use crate::mesh::FaceId;

/// A shell of at least this many faces is a group of its own; a smaller one may have to be visited face by
/// face.
const LARGE: usize = 4096;

/// The faces of a mesh that can cast, ordered so that most caps are ranges of them.
#[derive(Clone, Debug, Default)]
pub(super) struct CapClusters {
    groups: Vec<Group>,
    /// The triangles in order, and once more in order, each reversed.
    triangles: Vec<[u32; 3]>,
}

#[derive(Clone, Debug)]
struct Group {
    clusters: FaceClusters,
    /// The index of its first triangle.
    first: u32,
    /// Shells whose faces it holds.
    shells: Vec<u32>,
}

/// The light cap for one light. Its memory is kept.
#[derive(Clone, Debug, Default)]
pub(super) struct FoundCap {
    /// Triangles that no range holds, turned towards the light.
    pub(super) single: Vec<[u32; 3]>,
    /// Ranges of [`CapClusters::triangles`].
    pub(super) ranges: Vec<Range<u32>>,
    front: Vec<Range<u32>>,
    back: Vec<Range<u32>>,
    facing: FacingRanges,
}

impl CapClusters {
    /// Orders the faces of a caster for choices between all faces and half of them where that is `proven`.
    pub(super) fn new(caster: &Caster, proven: bool) -> Self {
        let boxes = caster.shell_boxes();
        let proofs = if proven { caster.proofs() } else { &[] };
        let mut clusters = Self::default();
        let mut pools = [(); 3].map(|()| Vec::new());
        for shell in 0..boxes.shell_count() {
            if boxes.faces_of(shell).len() >= LARGE {
                clusters.add(caster, vec![shell as u32]); // shells are no more than faces
                continue;
            }
            let pool = match proofs.get(shell) {
                Some(ShellProof::Outward) => 0,
                Some(ShellProof::Inward) => 1,
                _ => 2,
            };
            pools[pool].push(shell as u32);
        }
        pools.into_iter().filter(|shells| !shells.is_empty()).for_each(|shells| clusters.add(caster, shells));
        let reversed: Vec<[u32; 3]> = clusters.triangles.iter().map(|&face| turned(face, true)).collect();
        clusters.triangles.extend(reversed);
        clusters
    }

    fn add(&mut self, caster: &Caster, shells: Vec<u32>) {
        let (mesh, planes, boxes) = (caster.mesh(), caster.planes(), caster.shell_boxes());
        let faces = shells.iter().flat_map(|&shell| boxes.faces_of(shell as usize));
        let casting = faces.filter(|&&face| !planes.is_flat(mesh, face)).map(|face| face.0);
        let clusters = FaceClusters::of_faces(planes, casting);
        let first = self.triangles.len() as u32; // no more than faces
        self.triangles.extend(clusters.order().iter().map(|&face| triangle(caster, face)));
        self.groups.push(Group { clusters, first, shells });
    }

    /// The triangles in order, and once more in order, each reversed.
    pub(super) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Takes all shells of a group for shells like its first one: what a test must notice.
    #[cfg(test)]
    pub(super) fn forget_differences(&mut self) {
        self.groups.iter_mut().for_each(|group| group.shells.truncate(1));
    }

    /// How many triangles there are, each counted once.
    pub(super) fn face_count(&self) -> u32 {
        (self.triangles.len() / 2) as u32 // no more than faces
    }

    /// Finds the light cap. Ranges of fewer than `shortest` triangles are listed as single triangles.
    /// `false`, and what was found is of no use, if too many faces lie in a plane with the light.
    pub(super) fn find(
        &self,
        caster: &Caster,
        light: &Light,
        faces: &ShellFaces,
        shortest: u32,
        found: &mut FoundCap,
    ) -> bool {
        let (mesh, planes) = (caster.mesh(), caster.planes());
        let local = planes.local(light);
        let mut spare = self.face_count() as usize / OPEN_SHARE;
        let FoundCap { single, ranges, front, back, facing } = found;
        single.clear();
        ranges.clear();
        front.clear();
        back.clear();
        let mask_of = |shell: u32| faces.choices[shell as usize].what.mask();
        for Group { clusters, first, shells } in &self.groups {
            if !clusters.search(mesh, planes, &local, facing, &mut spare) {
                return false;
            }
            // What holds for all shells of the group.
            let common =
                shells.iter().fold(CasterFaces::All.mask(), |common, &shell| common & mask_of(shell));
            let cast = |side: Facing, mask: u8| match side {
                Facing::Front => mask & CASTS_IN_FRONT != 0,
                Facing::Back => mask & CASTS_BEHIND != 0,
                Facing::EdgeOn => false,
            };
            if cast(Facing::Front, common) {
                facing.front.iter().for_each(|range| extend(front, range, *first));
            }
            if cast(Facing::Back, common) {
                facing.back.iter().for_each(|range| extend(back, range, self.face_count() + first));
            }
            let towards_light = |face, side| turned(triangle(caster, face), side == Facing::Back);
            let casting = facing.single.iter().filter(|(_, side)| cast(*side, common));
            single.extend(casting.map(|&(face, side)| towards_light(face, side)));
            for &shell in shells.iter().filter(|&&shell| mask_of(shell) != common) {
                for &face in caster.shell_boxes().faces_of(shell as usize) {
                    let side = planes.side_of(mesh, face.index(), &local).0;
                    if cast(side, mask_of(shell) & !common) {
                        single.push(towards_light(face, side));
                    }
                }
            }
        }
        for range in front.iter().chain(&*back) {
            if range.end - range.start < shortest {
                single.extend_from_slice(&self.triangles[range.start as usize..range.end as usize]);
            } else {
                ranges.push(range.clone());
            }
        }
        true
    }
}

fn triangle(caster: &Caster, face: FaceId) -> [u32; 3] {
    caster.mesh().triangles()[face.index()]
}

/// Adds a range that is moved by `by`, joined to the last one if that ends where it starts.
fn extend(ranges: &mut Vec<Range<u32>>, range: &Range<u32>, by: u32) {
    let (start, end) = (range.start + by, range.end + by);
    match ranges.last_mut() {
        Some(last) if last.end == start => last.end = end,
        _ => ranges.push(start..end),
    }
}
