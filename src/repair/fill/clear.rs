//! The triangulation of a loop that meets no other face.

use std::collections::HashSet;

use super::least_area::least_area_among;
use super::shape::triangle_area;
use crate::check::{Corners, intersect, segment_meets};
use crate::geom::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::predicate::collinear;
use crate::mesh::{FaceId, Mesh};

/// How the search for a patch that meets nothing ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Clear {
    /// Triangles between corners of the loop that meet no face of the mesh, and not each other.
    Found(Vec<[usize; 3]>),
    /// There are none: proven.
    Impossible,
    /// None was found within the budget, or triangles were given up that might have been part of one.
    NotFound,
}

/// Triangles between the corners `0..n` of a loop, in its winding, that meet no face of the mesh where they
/// should not, and not each other, without a diagonal that is `in_use`; of little area.
///
/// A triangulation is of triangles that meet no face, and their diagonals are none that do: the
/// [least area](least_area_among) among those. Where there is none, no patch between the vertices of the loop
/// fits. Of two triangles of a patch that meet each other the larger one is given up, and with it the proof,
/// and the least area is sought again.
///
/// `weighed` is the number of triangles that may be weighed.
pub(super) fn clear(
    mesh: &Mesh,
    ring: &[u32],
    in_use: impl Fn(usize, usize) -> bool,
    weighed: &mut u64,
) -> Clear {
    let n = ring.len();
    let points: Vec<[f32; 3]> = ring.iter().map(|&vertex| mesh.positions()[vertex as usize]).collect();
    let around = Around::of(mesh, &points);
    let is_blocked = |at: usize| {
        let (i, j) = (at / n, at % n);
        let is_diagonal = j > i + 1 && j - i < n - 1;
        is_diagonal && (in_use(i, j) || around.meets_segment([ring[i], ring[j]], mesh))
    };
    let blocked: Vec<bool> = (0..n * n).map(is_blocked).collect();
    let is_free = |i: usize, j: usize| !blocked[i * n + j];
    let face = |triple: [usize; 3]| Face::of(triple.map(|corner| ring[corner]), mesh);
    let mut given_up = HashSet::new();
    while let Some(rest) = weighed.checked_sub((n * n * n / 6) as u64) {
        *weighed = rest;
        let allowed = |triple: [usize; 3]| {
            let [i, k, j] = triple;
            let free = is_free(i, k) && is_free(k, j) && is_free(i, j);
            free && !given_up.contains(&triple) && !around.meets(&face(triple))
        };
        let Some(patch) = least_area_among(&points, |_, _| false, allowed) else {
            return if given_up.is_empty() { Clear::Impossible } else { Clear::NotFound };
        };
        let faces: Vec<Face> = patch.iter().map(|&triple| face(triple)).collect();
        let Some(worse) = larger_of_a_pair(&faces) else { return Clear::Found(patch) };
        given_up.insert(patch[worse]);
    }
    Clear::NotFound
}

/// A face with its box.
struct Face {
    corners: Corners,
    aabb: Aabb,
    has_area: bool,
}

impl Face {
    fn of(ids: [u32; 3], mesh: &Mesh) -> Self {
        let at = ids.map(|id| mesh.positions()[id as usize]);
        Self {
            corners: Corners { ids, at },
            aabb: Aabb::around(at),
            has_area: !collinear(at[0], at[1], at[2]),
        }
    }

    /// Whether two faces meet beyond what they share. One without area meets nothing, as in any mesh.
    fn meets(&self, other: &Self) -> bool {
        let same = || self.corners.ids.iter().all(|id| other.corners.ids.contains(id));
        self.has_area
            && other.has_area
            && self.aabb.overlaps(&other.aabb)
            && (same() || intersect(&self.corners, &other.corners))
    }
}

/// The faces of a mesh near a loop: within the box of its corners, which holds every patch.
struct Around {
    faces: Vec<Face>,
    tree: Bvh,
}

impl Around {
    fn of(mesh: &Mesh, points: &[[f32; 3]]) -> Self {
        let aabb = Aabb::around(points.iter().copied());
        let near = |face: &usize| aabb.overlaps(&Aabb::around(mesh.corners(FaceId::new(*face))));
        let faces = (0..mesh.face_count()).filter(near).map(|face| Face::of(mesh.triangles()[face], mesh));
        let faces: Vec<Face> = faces.filter(|face| face.has_area).collect();
        let boxes: Vec<Aabb> = faces.iter().map(|face| face.aabb).collect();
        Self { faces, tree: Bvh::build(&boxes) }
    }

    fn meets(&self, face: &Face) -> bool {
        self.any(&face.aabb, |other| face.meets(other))
    }

    /// Whether a segment between two vertices meets a face that has neither.
    fn meets_segment(&self, ids: [u32; 2], mesh: &Mesh) -> bool {
        let ends = ids.map(|id| mesh.positions()[id as usize]);
        self.any(&Aabb::around(ends), |face| {
            !ids.iter().any(|id| face.corners.ids.contains(id)) && segment_meets(ends, face.corners.at)
        })
    }

    /// Whether a face whose box overlaps another box is such.
    fn any(&self, aabb: &Aabb, is_such: impl Fn(&Face) -> bool) -> bool {
        let mut found = false;
        self.tree.walk(
            |node| node.overlaps(aabb),
            |slot| {
                let face = &self.faces[self.tree.order()[slot] as usize];
                found = face.aabb.overlaps(aabb) && is_such(face);
                !found
            },
        );
        found
    }
}

/// The larger one of the first two faces of a patch that meet each other.
fn larger_of_a_pair(faces: &[Face]) -> Option<usize> {
    let meets = |&(i, j): &(usize, usize)| faces[i].meets(&faces[j]);
    let pairs = (0..faces.len()).flat_map(|i| (i + 1..faces.len()).map(move |j| (i, j)));
    let (i, j) = pairs.into_iter().find(meets)?;
    let area = |face: usize| triangle_area(faces[face].corners.at);
    Some(if area(i) > area(j) { i } else { j })
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::super::tests::all_triangulations;
    use super::*;
    use crate::check::for_each_intersection_among;
    use crate::random::SplitMix64;

    /// Whether a triangulation meets other faces, or itself, by the search for self-intersections.
    fn meets(mesh: &Mesh, ring: &[u32], patch: &[[usize; 3]]) -> bool {
        let first = mesh.face_count();
        let new = patch.iter().map(|triple| triple.map(|corner| ring[corner]));
        let triangles = mesh.triangles().iter().copied().chain(new).collect();
        let with = Mesh::new(mesh.positions().to_vec(), triangles).unwrap();
        let has_area = |face: &FaceId| {
            let [a, b, c] = with.corners(*face);
            !collinear(a, b, c)
        };
        let faces: Vec<FaceId> = (0..with.face_count()).map(FaceId::new).filter(has_area).collect();
        let of_patch = |pair: [FaceId; 2]| pair.iter().any(|face| face.index() >= first);
        let end = for_each_intersection_among(&with, &faces, &mut { u64::MAX }, |pair| {
            if of_patch(pair) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        end.is_break()
    }

    #[test]
    fn clear_patch_is_one_of_all_triangulations_that_meet_nothing() {
        let mut random = SplitMix64(5);
        let (mut found, mut impossible, mut not_found, mut caught) = (0, 0, 0, 0);
        for round in 0..400 {
            let n = 4 + round % 4;
            let obstacles = 1 + round % 5;
            let corners = n + 3 * obstacles;
            let positions = (0..corners).map(|_| [(); 3].map(|()| random.below(12) as f32)).collect();
            let ids = |face: usize| [0, 1, 2].map(|corner| (n + 3 * face + corner) as u32);
            let mesh = Mesh::new(positions, (0..obstacles).map(ids).collect()).unwrap();
            let ring: Vec<u32> = (0..n as u32).collect();
            let used = [0, 2 + random.below(n - 3)];
            let in_use = |i: usize, j: usize| [i, j] == used && round % 3 == 0;
            let uses = |patch: &[[usize; 3]]| {
                patch.iter().any(|&[i, k, j]| in_use(i, k) || in_use(k, j) || in_use(i, j))
            };
            let fitting = all_triangulations(0, n - 1)
                .into_iter()
                .filter(|patch| !uses(patch) && !meets(&mesh, &ring, patch))
                .count();
            match clear(&mesh, &ring, in_use, &mut { u64::MAX }) {
                Clear::Found(patch) => {
                    assert!(!uses(&patch) && !meets(&mesh, &ring, &patch), "round {round}");
                    found += 1;
                }
                Clear::Impossible => {
                    assert_eq!(fitting, 0, "round {round}");
                    impossible += 1;
                }
                Clear::NotFound => not_found += 1,
            }
            // Fault injected: the obstacles are not seen.
            let blind = Mesh::new(mesh.positions().to_vec(), Vec::new()).unwrap();
            if let Clear::Found(patch) = clear(&blind, &ring, in_use, &mut { u64::MAX }) {
                caught += usize::from(meets(&mesh, &ring, &patch));
            }
        }
        assert!(found > 50 && impossible > 50 && caught > 50, "{found} {impossible} {not_found} {caught}");
    }

    #[test]
    fn clear_ends_with_its_budget() {
        let positions = (0..9).map(|k| [(k % 3) as f32, (k / 3) as f32, (k * k % 5) as f32]).collect();
        let mesh = Mesh::new(positions, Vec::new()).unwrap();
        let ring = [0, 1, 2, 5, 8, 7, 6, 3];
        let mut weighed = 100;
        assert!(matches!(clear(&mesh, &ring, |_, _| false, &mut weighed), Clear::Found(_)));
        assert_eq!(weighed, 100 - 8 * 8 * 8 / 6);
        assert_eq!(clear(&mesh, &ring, |_, _| false, &mut weighed), Clear::NotFound);
    }
}
