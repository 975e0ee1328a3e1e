//! The step that leaves one of several faces with the same three vertices.

use std::cmp::Ordering;

use super::change::{ChangeKind, Step};
use super::index_map::IndexMap;
use super::rewrite::keep_faces;
use super::walls::inner_walls;
use crate::mesh::Mesh;

/// Leaves one of the faces with the same three vertices, or none.
///
/// - Copies in opposite windings cancel in pairs. Where a pair is all that there is, it goes only if it is a
///   wall inside a closed solid. A double-sided sheet in the open stays, for it casts.
/// - Of copies with the same winding the first stays.
///
/// Guarantee: no position changes, and every place that had a face and is not inside a solid still has one,
/// so that all shadows outside solids stay. The signed boundary chain (at each edge, the faces along it minus
/// the faces against it) changes only by the faces that are listed as
/// [`DuplicateDropped`](ChangeKind::DuplicateDropped).
///
/// ```
/// use umbrage::{repair, testing::shapes};
/// assert_eq!(repair::drop_duplicates(shapes::duplicated_face()).1.count, 1);
/// let (_, step) = repair::drop_duplicates(shapes::double_sheet());
/// assert_eq!((step.count, step.left), (0, 2));
/// ```
#[must_use]
pub fn drop_duplicates(mesh: Mesh) -> (Mesh, Step) {
    let mut step = Step::new("duplicates");
    let sets = sets(&mesh);
    if sets.is_empty() {
        return (mesh, step);
    }
    let alone: Vec<[u32; 2]> = sets.iter().filter_map(|set| set.pair()).collect();
    let goes = inner_walls(&mesh, &sets, &alone);
    let mut dropped: Vec<(u32, ChangeKind, Option<u32>)> = Vec::new();
    let mut kept: Vec<u32> = Vec::new();
    let mut pairs = goes.iter();
    for set in &sets {
        let wall = set.pair().is_some() && pairs.next() == Some(&true);
        set.resolve(wall, &mut dropped, &mut kept);
    }
    dropped.sort_unstable();
    let is_dropped = |face: &u32| dropped.binary_search_by_key(face, |&(face, ..)| face).is_ok();
    let from: Vec<u32> = (0..mesh.face_count() as u32).filter(|face| !is_dropped(face)).collect();
    let new = |face: u32| from.binary_search(&face).ok().map(|new| new as u32);
    let at = |face: u32| mesh.positions()[mesh.triangles()[face as usize][0] as usize];
    for &(face, kind, original) in &dropped {
        step.add(kind, Some(face), original.and_then(new), at(face));
    }
    kept.sort_unstable();
    for face in kept {
        step.add(ChangeKind::OppositeKept, Some(face), new(face), at(face));
    }
    if !dropped.is_empty() {
        let mut new_of = vec![None; mesh.face_count()];
        (0..).zip(&from).for_each(|(new, &old)| new_of[old as usize] = Some(new));
        for &(face, _, original) in &dropped {
            new_of[face as usize] = original.and_then(new);
        }
        step.faces = Some(IndexMap::forward(new_of.into_iter()));
    }
    (if dropped.is_empty() { mesh } else { keep_faces(mesh, &from) }, step)
}

/// The faces of the same three vertices, two or more, ascending by winding.
pub(super) struct Same {
    along: Vec<u32>,
    against: Vec<u32>,
}

impl Same {
    /// The first face of each winding, where both have as many faces.
    pub(super) fn pair(&self) -> Option<[u32; 2]> {
        (self.along.len() == self.against.len()).then(|| [self.along[0], self.against[0]])
    }

    /// The first face of the winding that has more.
    pub(super) fn surplus(&self) -> Option<u32> {
        match self.along.len().cmp(&self.against.len()) {
            Ordering::Less => Some(self.against[0]),
            Ordering::Equal => None,
            Ordering::Greater => Some(self.along[0]),
        }
    }

    pub(super) fn faces(&self) -> impl Iterator<Item = u32> + '_ {
        self.along.iter().chain(&self.against).copied()
    }

    /// Adds the faces that go, each with the one that stands for it, and the first of a pair that stays.
    fn resolve(&self, wall: bool, dropped: &mut Vec<(u32, ChangeKind, Option<u32>)>, kept: &mut Vec<u32>) {
        let [more, fewer] = match self.along.len() < self.against.len() {
            true => [&self.against, &self.along],
            false => [&self.along, &self.against],
        };
        let mut cancel = |faces: &[u32]| {
            dropped.extend(faces.iter().map(|&face| (face, ChangeKind::OppositeCancelled, None)));
        };
        if more.len() == fewer.len() {
            let stay = usize::from(!wall);
            cancel(&more[stay..]);
            cancel(&fewer[stay..]);
            kept.extend((!wall).then(|| more[0].min(fewer[0])));
            return;
        }
        let (pairs, copies) = more[1..].split_at(fewer.len());
        cancel(fewer);
        cancel(pairs);
        dropped.extend(copies.iter().map(|&face| (face, ChangeKind::DuplicateDropped, Some(more[0]))));
    }
}

/// The sets of faces with the same three vertices. Collapsed faces are in none.
///
/// Faces are brought together by their lowest vertex, by a counting sort. Few share it, so that each is
/// compared with the others.
fn sets(mesh: &Mesh) -> Vec<Same> {
    let mut ends = vec![0_u32; mesh.vertex_count() + 1];
    let lowest = |&[a, b, c]: &[u32; 3]| a.min(b).min(c) as usize;
    for corners in mesh.triangles() {
        ends[lowest(corners) + 1] += 1;
    }
    for vertex in 1..ends.len() {
        ends[vertex] += ends[vertex - 1];
    }
    let mut keyed = vec![([0_u32; 2], 0_u32); mesh.face_count()];
    for (face, corners) in (0..).zip(mesh.triangles()) {
        let slot = &mut ends[lowest(corners)];
        keyed[*slot as usize] = (others(*corners), face);
        *slot += 1;
    }
    // Each end has moved to where it was wanted: to the start of the next vertex.
    let mut sets = Vec::new();
    let mut start = 0;
    for &end in &ends[..mesh.vertex_count()] {
        let around = &mut keyed[start as usize..end as usize];
        start = end;
        if may_repeat(around) {
            around.sort_unstable();
            let same = around.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1);
            sets.extend(same.filter_map(|same| Same::of(mesh, same)));
        }
    }
    sets
}

/// The two higher vertices of a face, the highest last.
#[inline]
fn others([a, b, c]: [u32; 3]) -> [u32; 2] {
    [a.min(b).max(a.max(b).min(c)), a.max(b).max(c)]
}

/// Whether two faces around a vertex have the same key; for many faces, whether they might.
#[inline]
fn may_repeat(around: &[([u32; 2], u32)]) -> bool {
    const FEW: usize = 12;
    around.len() > FEW || (1..around.len()).any(|i| around[..i].iter().any(|other| other.0 == around[i].0))
}

impl Same {
    fn of(mesh: &Mesh, same: &[([u32; 2], u32)]) -> Option<Self> {
        let mut set = Self { along: Vec::new(), against: Vec::new() };
        for &(_, face) in same {
            let [a, b, c] = mesh.triangles()[face as usize];
            if a == b || b == c || c == a {
                return None; // then all of them are
            }
            // From the lowest vertex on, the winding says which of the other two comes first.
            let rises = (a < b) as u32 + (b < c) as u32 + (c < a) as u32 == 2;
            if rises { &mut set.along } else { &mut set.against }.push(face);
        }
        Some(set)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{added, bits, boundary_chain};
    use super::*;
    use crate::random::SplitMix64;
    use crate::testing::shapes;
    use crate::topology::Topology;

    fn counts(step: &Step, kind: ChangeKind) -> usize {
        step.changes.iter().filter(|change| change.kind == kind).count()
    }

    /// A cube on each side of a square, each with its own wall there.
    fn two_rooms() -> Mesh {
        let left = shapes::cuboid([-2.0, -1.0, -1.0], [0.0, 1.0, 1.0]);
        let right = shapes::cuboid([0.0, -1.0, -1.0], [2.0, 1.0, 1.0]);
        let both = Mesh::concat(&[left, right]).unwrap();
        super::super::weld(both, crate::mesh::Weld::Exact).0
    }

    #[test]
    fn duplicates_same_winding_leave_the_first_and_say_so() {
        for shape in [shapes::cube(), shapes::torus(6, 5, 2.0, 0.5)] {
            let [a, b, c] = shape.triangles()[3];
            let (mesh, step) = drop_duplicates(added(&shape, &[[b, c, a], [c, a, b]]));
            assert_eq!((mesh.triangles(), bits(&mesh)), (shape.triangles(), bits(&shape)));
            assert_eq!((step.count, counts(&step, ChangeKind::DuplicateDropped)), (2, 2));
            assert!(step.changes.iter().all(|change| change.new == Some(3)));
            assert!(Topology::of(&mesh).edge_counts().watertight());
        }
    }

    #[test]
    fn duplicates_cancel_in_pairs_and_the_boundary_chain_stays() {
        for shape in [shapes::cube(), shapes::open_cube(), shapes::mobius(8)] {
            let [a, b, c] = shape.triangles()[1];
            // Twice along and once against; the surplus stays.
            let doubled = added(&shape, &[[a, c, b], [b, c, a]]);
            let (mesh, step) = drop_duplicates(doubled.clone());
            assert_eq!(boundary_chain(&mesh), boundary_chain(&doubled));
            assert_eq!(mesh.triangles(), shape.triangles());
            assert_eq!((step.count, counts(&step, ChangeKind::OppositeCancelled)), (2, 2));
            // Fault injected: one of the two goes alone.
            let faces: Vec<u32> = (0..=shape.face_count() as u32).collect();
            assert_ne!(boundary_chain(&keep_faces(doubled.clone(), &faces)), boundary_chain(&doubled));
        }
    }

    #[test]
    fn duplicates_inside_a_solid_go_and_those_in_the_open_stay() {
        let (mesh, step) = drop_duplicates(two_rooms());
        assert_eq!((mesh.face_count(), step.count, step.left), (20, 4, 0));
        assert!(Topology::of(&mesh).edge_counts().watertight());
        // The same rooms without an outer face are no solid.
        let open = keep_faces(two_rooms(), &(0..23).collect::<Vec<u32>>());
        let (mesh, step) = drop_duplicates(open);
        assert_eq!((mesh.face_count(), step.count, step.left), (23, 0, 2));
        // A double-sided sheet, alone and across the hole of a frame, where all its edges have other faces.
        let (mesh, step) = drop_duplicates(shapes::double_sheet());
        assert_eq!((mesh.face_count(), step.count, step.left), (4, 0, 2));
        let frame = shapes::voxels([3, 3, 1], |[x, y, _]| [x, y] != [1, 1]);
        let at = |p: [f32; 3]| frame.positions().iter().position(|&q| q == p).unwrap() as u32;
        let low = frame.positions()[0][2];
        let [a, b, c, d] = corners_of_the_hole(&frame, low).map(at);
        let sheet = added(&frame, &[[a, b, c], [a, c, d], [a, c, b], [a, d, c]]);
        let (mesh, step) = drop_duplicates(sheet);
        assert_eq!((mesh.face_count(), step.count, step.left), (frame.face_count() + 4, 0, 2));
    }

    /// The hole in the middle of three by three unit cubes, at one height.
    fn corners_of_the_hole(frame: &Mesh, z: f32) -> [[f32; 3]; 4] {
        let [low, high] = frame.bounds().unwrap();
        let third = |i: usize, k: f32| low[i] + (high[i] - low[i]) / 3.0 * k;
        let corner = |x: f32, y: f32| [third(0, x), third(1, y), z];
        [corner(1.0, 1.0), corner(2.0, 1.0), corner(2.0, 2.0), corner(1.0, 2.0)]
    }

    #[test]
    fn duplicate_sets_are_those_of_each_face_against_each() {
        let mut random = SplitMix64(7);
        for vertices in [4, 6, 30] {
            let faces: Vec<[u32; 3]> =
                (0..120).map(|_| [(); 3].map(|()| random.below(vertices) as u32)).collect();
            let mesh = Mesh::new(vec![[0.0; 3]; vertices], faces.clone()).unwrap();
            let mut found: Vec<u32> = sets(&mesh).iter().flat_map(Same::faces).collect();
            found.sort_unstable();
            let sorted = |mut face: [u32; 3]| {
                face.sort_unstable();
                face
            };
            let collapsed = |face: [u32; 3]| crate::topology::has_collapsed(face);
            let repeats = |i: usize| (0..120).any(|j| j != i && sorted(faces[i]) == sorted(faces[j]));
            let naive = (0..120).filter(|&i| !collapsed(faces[i]) && repeats(i)).map(|i| i as u32);
            assert_eq!(found, naive.collect::<Vec<_>>());
        }
    }
}
