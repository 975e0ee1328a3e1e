//! Whether patches get along with the mesh and with each other.

use std::ops::ControlFlow;

use crate::check::{SelfIntersections, for_each_intersection_among};
use crate::geom::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::predicate::collinear;
use crate::mesh::{FaceId, Mesh, VertexId};
use crate::topology::Topology;

/// What stands against a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Conflict {
    /// Whether it meets other faces where it should not, its own among them, or lies on one; `None` if that
    /// was not decided.
    pub(super) meets: Option<bool>,
    /// Whether an edge of it has other than two faces in opposite directions.
    pub(super) edge_in_use: bool,
}

/// The conflicts of the patches of a mesh, whose faces begin at face `first` and end, patch by patch, at
/// `ends`. Only faces near a patch are compared.
pub(super) fn conflicts(mesh: &Mesh, first: usize, ends: &[usize]) -> Vec<Conflict> {
    let topology = Topology::of(mesh);
    let patch_of = |face: usize| (face >= first).then(|| ends.partition_point(|&end| end <= face));
    let mut found = vec![Conflict { meets: Some(false), edge_in_use: false }; ends.len()];
    let mut boxes = vec![Aabb::EMPTY; ends.len()];
    for face in first..mesh.face_count() {
        let Some(patch) = patch_of(face) else { continue };
        boxes[patch] = boxes[patch].join(&Aabb::around(mesh.corners(FaceId::new(face))));
        let corners = mesh.triangles()[face];
        for i in 0..3 {
            let [a, b, c] = [corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]];
            let Some(edge) = topology.edge_between(VertexId(a), VertexId(b)) else { continue };
            let sound = topology.valence(edge) == 2 && !topology.is_misoriented(edge);
            found[patch].edge_in_use |= !sound;
            // A face with the same three vertices lies on it.
            let same = |half_edge| topology.tail(topology.prev(half_edge)).0 == c;
            if topology.half_edges(edge).filter(|&half_edge| same(half_edge)).count() > 1 {
                found[patch].meets = Some(true);
            }
        }
    }
    let all = boxes.iter().fold(Aabb::EMPTY, |all, aabb| all.join(aabb));
    let tree = Bvh::build(&boxes);
    let is_near = |face: &FaceId| {
        let [a, b, c] = mesh.corners(*face);
        let aabb = Aabb::around([a, b, c]);
        let mut near = false;
        if aabb.overlaps(&all) && !topology.is_collapsed(*face) && !collinear(a, b, c) {
            tree.walk(
                |node| node.overlaps(&aabb),
                |slot| {
                    near |= boxes[tree.order()[slot] as usize].overlaps(&aabb);
                    !near
                },
            );
        }
        near
    };
    let near: Vec<FaceId> = topology.faces().filter(is_near).collect();
    let mut tests = SelfIntersections::MOST_TESTS;
    let end = for_each_intersection_among(mesh, &near, &mut tests, |pair| {
        for patch in pair.iter().filter_map(|face| patch_of(face.index())) {
            found[patch].meets = Some(true);
        }
        ControlFlow::Continue(())
    });
    if end.is_break() {
        found.iter_mut().filter(|conflict| conflict.meets == Some(false)).for_each(|c| c.meets = None);
    }
    found
}
