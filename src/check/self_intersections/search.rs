//! The search for pairs of faces that intersect: fans first, then a tree over the boxes of the faces.

use std::ops::ControlFlow;

use super::fans::{self, Fan, arc_box, same_half_planes};
use super::triangles::{Corners, intersect};
use crate::geom::Aabb;
use crate::geom::box_pairs::{NO_SET, Overlaps};
use crate::mesh::{FaceId, Mesh};
use crate::parallel;

/// Tasks per parallel step; their pairs are visited after the step, in order.
const WINDOW: usize = 256;
/// Pairs held per task; a task that finds more is repeated alone, and visits its pairs as it finds them.
pub(super) const MOST_HELD: usize = 4096;
/// Tests per task before oriented boxes are used: an ordinary mesh takes a tenth of them.
const PLAIN_TESTS: u64 = 1 << 16;

/// Result of a task.
#[derive(Default)]
struct Done {
    pairs: Vec<[u32; 2]>,
    tests: u64,
    /// Whether there were more pairs than are held.
    more: bool,
    /// Whether the task ended at its number of tests.
    cut_short: bool,
}

/// Faces that all have area, with what is known of their pairs.
pub(super) struct Search<'a> {
    mesh: &'a Mesh,
    faces: &'a [FaceId],
    /// Faces of one set, by index, are known not to intersect each other; empty if nothing is known.
    known: Vec<u32>,
}

impl<'a> Search<'a> {
    /// A search among `faces`, ascending, that all have area.
    pub(super) fn among(mesh: &'a Mesh, faces: &'a [FaceId]) -> Self {
        Self { mesh, faces, known: Vec::new() }
    }

    /// The same without the pairs within sets: `known` has an entry for each face, which may be [`NO_SET`].
    pub(super) fn without_pairs_within(mut self, known: Vec<u32>) -> Self {
        self.known = known;
        self
    }

    /// Calls `visit` with each pair, the lower id first, each once. It breaks if `visit` does, or if no tests
    /// are left.
    ///
    /// A test of two faces whose boxes overlap costs one, and so does a test of two nodes of the tree.
    pub(super) fn run(
        self,
        tests: &mut u64,
        mut visit: impl FnMut([FaceId; 2]) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Self { mesh, faces, known: mut sets } = self;
        let mut visit = |[i, j]: [u32; 2]| visit([faces[i.min(j) as usize], faces[i.max(j) as usize]]);
        let corners = |face: u32| Corners::of(mesh, faces[face as usize]);
        let unknown = |&face: &u32| sets.get(face as usize).is_none_or(|&set| set == NO_SET);
        let open: Vec<u32> = (0..faces.len() as u32).filter(unknown).collect();
        let fans = fans::fans(&open, &corners);
        drop(open);
        for fan in &fans {
            search_fan(fan, &corners, tests, &mut visit)?;
        }
        if !fans.is_empty() {
            let first = sets.iter().filter(|&&set| set != NO_SET).max().map_or(0, |set| set + 1);
            sets.resize(faces.len(), NO_SET);
            for (set, fan) in (first..).zip(fans) {
                fan.faces().iter().for_each(|&face| sets[face as usize] = set);
            }
        }
        let boxes: Vec<Aabb> = faces.iter().map(|&face| Aabb::around(mesh.corners(face))).collect();
        let mut tree = Overlaps::of(&boxes);
        drop(boxes);
        if !sets.is_empty() {
            tree = tree.without_pairs_within(&sets);
        }
        search_tree(tree, corners, tests, &mut visit)
    }
}

/// The pairs within a fan.
fn search_fan(
    fan: &Fan,
    corners: &dyn Fn(u32) -> Corners,
    tests: &mut u64,
    visit: &mut impl FnMut([u32; 2]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    match fan {
        Fan::Vertex(hub, faces) => {
            let boxes: Vec<Aabb> = faces.iter().map(|&face| arc_box(&corners(face), *hub)).collect();
            let of = |i: u32| corners(faces[i as usize]);
            search_tree(Overlaps::of(&boxes), of, tests, &mut |pair| visit(pair.map(|i| faces[i as usize])))
        }
        Fan::Edge(edge, faces) => {
            for run in same_half_planes(*edge, faces, corners) {
                for (at, &i) in run.iter().enumerate() {
                    for &j in &run[at + 1..] {
                        // Faces with three common vertices are duplicates.
                        if intersect(&corners(i), &corners(j)) {
                            visit([i, j])?;
                        }
                        *tests = tests.saturating_sub(1);
                        if *tests == 0 {
                            return ControlFlow::Break(());
                        }
                    }
                }
            }
            ControlFlow::Continue(())
        }
    }
}

/// The pairs whose boxes overlap in a tree, as indices into `corners`.
///
/// Where tasks take many tests, oriented boxes are added to the tree, and what is left is searched with them:
/// ordinary meshes do not pay for them.
fn search_tree(
    mut tree: Overlaps,
    corners: impl Fn(u32) -> Corners,
    tests: &mut u64,
    visit: &mut impl FnMut([u32; 2]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    // Each face is compared with about ten near it: in the order of the tree these are near in memory too.
    let corners: Vec<Corners> = tree.order().iter().map(|&i| corners(i)).collect();
    let mut plain = PLAIN_TESTS + 32 * corners.len() as u64;
    let mut tasks = tree.tasks();
    let mut next = 0;
    while next < tasks.len() {
        let window = next..tasks.len().min(next + WINDOW);
        next = window.end;
        let mut done: Vec<Done> = window.clone().map(|_| Done::default()).collect();
        let most = if tree.has_frames() { *tests } else { PLAIN_TESTS.min(*tests) };
        let intersect = |[i, j]: [usize; 2]| intersect(&corners[i], &corners[j]);
        let named = |slots: [usize; 2]| slots.map(|slot| tree.order()[slot]);
        parallel::rows(&mut done, 1, |task, done| {
            let done = &mut done[0];
            // A break only means that the rest of this task is not needed now.
            let _ = tree.for_each_pair(tasks[window.start + task], |slots| {
                done.tests += 1;
                if let Some(slots) = slots.filter(|&slots| intersect(slots)) {
                    done.more = done.pairs.len() == MOST_HELD;
                    if !done.more {
                        done.pairs.push(named(slots));
                    }
                }
                done.cut_short = done.tests >= most;
                if done.more || done.cut_short { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
        });
        let mut again = Vec::new();
        for (index, done) in window.zip(done) {
            if done.more {
                tree.for_each_pair(tasks[index], |slots| {
                    *tests = tests.saturating_sub(1);
                    if let Some(slots) = slots.filter(|&slots| intersect(slots)) {
                        visit(named(slots))?;
                    }
                    if *tests == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                })?;
                continue;
            }
            *tests = tests.saturating_sub(done.tests);
            plain = plain.saturating_sub(done.tests);
            if done.cut_short && *tests > 0 && !tree.has_frames() {
                again.push(tasks[index]);
                continue;
            }
            done.pairs.into_iter().try_for_each(&mut *visit)?;
            if *tests == 0 {
                return ControlFlow::Break(());
            }
        }
        tasks.extend(&again);
        if (!again.is_empty() || plain == 0) && !tree.has_frames() {
            tree.add_frames(|slot| corners[slot].at);
        }
    }
    ControlFlow::Continue(())
}
