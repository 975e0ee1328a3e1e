//! Nesting: which watertight shell lies in which others, by exact point-in-solid tests.

use super::ShellReport;
use crate::geom::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::predicate::{Sign, on_triangle, orient3d, turn};
use crate::mesh::{FaceId, Mesh};
use crate::topology::Shells;

/// Budget of the search. If many shells overlap, each would be compared with all others.
pub(super) struct Allowance {
    pub(super) tests: u64,
}

impl Allowance {
    /// Spends one test; whether more are left.
    #[inline]
    fn take(&mut self) -> bool {
        self.tests = self.tests.saturating_sub(1);
        self.tests > 0
    }

    /// `None` once it is spent.
    fn left(&self) -> Option<()> {
        (self.tests > 0).then_some(())
    }
}

/// Fills in depth and parent of the watertight shells. If the budget is spent, the depths of the rest stay
/// unknown.
pub(super) fn nest(
    mesh: &Mesh,
    shells: &Shells,
    signs: &[Sign],
    list: &mut [ShellReport],
    mut allowance: Allowance,
) {
    // Only a shell whose box lies in the box of another can be nested, and only that other can contain it.
    let closed: Vec<usize> = (0..list.len()).filter(|&shell| list[shell].watertight).collect();
    if closed.len() < 2 {
        return;
    }
    let boxes: Vec<Aabb> = closed.iter().map(|&shell| list[shell].bounds).collect();
    let bvh = Bvh::build(&boxes);
    let mut inner = vec![false; list.len()];
    let mut outer = vec![false; list.len()];
    for (index, &shell) in closed.iter().enumerate() {
        let visit = |slot: usize| {
            let other = bvh.order()[slot] as usize;
            if other != index && !signs[closed[other]].is_zero() && boxes[other].contains_box(&boxes[index]) {
                inner[shell] = true;
                outer[closed[other]] = true;
            }
            allowance.take()
        };
        bvh.walk(|aabb| aabb.overlaps(&boxes[index]), visit);
        list[shell].depth_known = !inner[shell] && allowance.left().is_some();
    }
    drop(bvh);
    if allowance.left().is_none() || !inner.contains(&true) {
        return;
    }
    let solids = Solids::new(mesh, shells, &outer);
    // The faces of the inner shells, shell by shell.
    let mut starts = vec![0; list.len() + 1];
    for shell in 0..list.len() {
        starts[shell + 1] = starts[shell] + if inner[shell] { list[shell].faces } else { 0 };
    }
    let mut faces = vec![FaceId(0); starts[list.len()]];
    let mut next = starts.clone();
    for (face, shell) in shells.of_face.iter().enumerate() {
        if let Some(shell) = shell.map(|shell| shell as usize).filter(|&shell| inner[shell]) {
            faces[next[shell]] = FaceId::new(face);
            next[shell] += 1;
        }
    }
    drop(next);
    let mut vertices: Vec<u32> = Vec::new();
    for shell in outside_in(list, &inner) {
        let own = &faces[starts[shell]..starts[shell + 1]];
        vertices.clear();
        vertices.extend(own.iter().flat_map(|face| mesh.triangles()[face.index()]));
        vertices.sort_unstable();
        vertices.dedup();
        let points = vertices.iter().map(|&vertex| mesh.positions()[vertex as usize]);
        let around = holders(&solids, mesh, shell, signs[shell], list, own, points, &mut allowance);
        if allowance.left().is_none() {
            return;
        }
        // The innermost is the deepest; of two as deep as each other, the one with the smaller volume.
        let volume = |other: &u32| list[*other as usize].signed_volume.abs();
        let innermost = around.iter().copied().min_by(|a, b| {
            let depth = |other: &u32| list[*other as usize].depth;
            depth(b).cmp(&depth(a)).then(volume(a).total_cmp(&volume(b))).then(a.cmp(b))
        });
        list[shell].parent = innermost.map(|other| other as usize);
        list[shell].depth = around.len();
        list[shell].depth_known = true;
    }
}

/// The `inner` shells in an order in which a shell comes after all shells whose boxes contain its own, so
/// that their depths are known by then. Of equal boxes, that of the larger volume comes first.
fn outside_in(list: &[ShellReport], inner: &[bool]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..list.len()).filter(|&shell| inner[shell]).collect();
    order.sort_unstable_by(|&a, &b| {
        let (one, two) = (&list[a], &list[b]);
        // A box that contains another starts no later on every axis, and ends no earlier.
        let starts = one.bounds.low.partial_cmp(&two.bounds.low);
        let ends = two.bounds.high.partial_cmp(&one.bounds.high);
        let boxes = starts.zip(ends).map(|(starts, ends)| starts.then(ends)).expect("coordinates are finite");
        boxes.then(two.signed_volume.abs().total_cmp(&one.signed_volume.abs())).then(a.cmp(&b))
    });
    order
}

/// The shells that contain `shell`, which has the faces `own` with the vertices `points`; ascending.
#[expect(clippy::too_many_arguments, reason = "everything known of one shell")]
fn holders(
    solids: &Solids,
    mesh: &Mesh,
    shell: usize,
    sign: Sign,
    list: &[ShellReport],
    own: &[FaceId],
    points: impl Iterator<Item = [f32; 3]> + Clone,
    allowance: &mut Allowance,
) -> Vec<u32> {
    let mut around_point = |point| solids.around(mesh, point, shell, allowance);
    // A point on another shell does not decide whether it is inside that shell; the next point may.
    let mut found = around_point(points.clone().next().expect("a shell has faces"));
    if !found.touching.is_empty()
        && let Some(clear) = points.clone().map(&mut around_point).find(|found| found.touching.is_empty())
    {
        found = clear;
    }
    found.shells.retain(|&other| list[other as usize].bounds.contains_box(&list[shell].bounds));
    // Before its depth makes a shell inside out, all of it must lie inside the other: otherwise it only
    // crosses it.
    let odd = found.shells.len() % 2 == 1;
    if !found.shells.is_empty() && (sign == Sign::Positive) == odd {
        for point in points {
            let here = around_point(point);
            let holds = |shells: &[u32], other: &u32| shells.binary_search(other).is_ok();
            found.shells.retain(|other| holds(&here.shells, other) || holds(&here.touching, other));
            if found.shells.is_empty() {
                break;
            }
        }
        // Its vertices may all lie inside while a face between them passes through the outside.
        found.shells = solids.not_passing_through(mesh, own, found.shells, allowance);
    }
    found.shells
}

/// Whether an edge of the triangle `edges` passes through the inside of `face`, from one side to the other.
fn edge_pierces(edges: [[f32; 3]; 3], [a, b, c]: [[f32; 3]; 3]) -> bool {
    let sides = edges.map(|p| orient3d(a, b, c, p));
    (0..3).any(|i| {
        let (p, q) = (edges[i], edges[(i + 1) % 3]);
        if sides[i] != -sides[(i + 1) % 3] || sides[i].is_zero() {
            return false;
        }
        let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
        !turns[0].is_zero() && turns.iter().all(|&turn| turn == turns[0])
    })
}

/// The faces of some shells in a tree, for point-in-solid tests.
struct Solids {
    faces: Vec<FaceId>,
    shell_of: Vec<u32>,
    bvh: Bvh,
}

/// Shells around a point, and shells whose surface passes through it; ascending.
struct Around {
    shells: Vec<u32>,
    touching: Vec<u32>,
}

impl Solids {
    fn new(mesh: &Mesh, shells: &Shells, wanted: &[bool]) -> Self {
        let (mut faces, mut shell_of) = (Vec::new(), Vec::new());
        for (face, shell) in (0..).map(FaceId).zip(&shells.of_face) {
            if let Some(shell) = shell.filter(|&shell| wanted[shell as usize]) {
                faces.push(face);
                shell_of.push(shell);
            }
        }
        let boxes: Vec<Aabb> = faces.iter().map(|&face| Aabb::around(mesh.corners(face))).collect();
        Self { bvh: Bvh::build(&boxes), faces, shell_of }
    }

    /// The shells among `others` (ascending) none of whose faces crosses a face of `own`. Touching is not
    /// crossing.
    fn not_passing_through(
        &self,
        mesh: &Mesh,
        own: &[FaceId],
        mut others: Vec<u32>,
        allowance: &mut Allowance,
    ) -> Vec<u32> {
        for &face in own {
            if others.is_empty() || allowance.left().is_none() {
                break;
            }
            let corners = mesh.corners(face);
            let aabb = Aabb::around(corners);
            let visit = |slot: usize| {
                let slot = self.bvh.order()[slot] as usize;
                if let Ok(at) = others.binary_search(&self.shell_of[slot]) {
                    let theirs = mesh.corners(self.faces[slot]);
                    if edge_pierces(corners, theirs) || edge_pierces(theirs, corners) {
                        others.remove(at);
                    }
                }
                allowance.take()
            };
            self.bvh.walk(|node| node.overlaps(&aabb), visit);
        }
        others
    }

    /// The shells around `point`, except shell `own`: those whose signed crossings with the ray towards +x do
    /// not cancel.
    fn around(&self, mesh: &Mesh, point: [f32; 3], own: usize, allowance: &mut Allowance) -> Around {
        let ray = Aabb { low: point, high: [f32::MAX, point[1], point[2]] };
        let mut crossings: Vec<(u32, i32)> = Vec::new();
        let mut touching = Vec::new();
        let visit = |slot: usize| {
            let slot = self.bvh.order()[slot] as usize;
            let shell = self.shell_of[slot];
            if shell as usize != own {
                match crossing(mesh.corners(self.faces[slot]), point) {
                    Crossing::None => {}
                    Crossing::Signed(sign) => crossings.push((shell, sign)),
                    Crossing::At => touching.push(shell),
                }
            }
            allowance.take()
        };
        self.bvh.walk(|aabb| aabb.overlaps(&ray), visit);
        crossings.sort_unstable();
        touching.sort_unstable();
        touching.dedup();
        let inside =
            crossings.chunk_by(|a, b| a.0 == b.0).filter(|c| c.iter().map(|c| c.1).sum::<i32>() != 0);
        let shells = inside.map(|c| c[0].0).filter(|shell| touching.binary_search(shell).is_err()).collect();
        Around { shells, touching }
    }
}

/// Intersection of the ray from a point towards +x with a triangle.
enum Crossing {
    None,
    /// +1 if the ray leaves through a face whose normal points towards +x, −1 if it enters.
    Signed(i32),
    /// The point lies on the triangle.
    At,
}

/// Exact ray–triangle crossing, with the ray's start moved by (0, ε, ε²) so that it meets no vertex and no
/// edge.
///
/// Simulation of simplicity of one point (Herbert Edelsbrunner and Ernst Peter Mücke, 1990): a sign that is
/// zero is replaced by that of its derivative by ε, then by ε².
fn crossing([a, b, c]: [[f32; 3]; 3], p: [f32; 3]) -> Crossing {
    let side = |u: [f32; 3], v: [f32; 3]| {
        let compare = |x: f32, y: f32| x.partial_cmp(&y).map_or(0, |order| order as i32);
        match turn(u, v, p, 0).value() {
            0 if u[2] != v[2] => compare(u[2], v[2]),
            0 => compare(v[1], u[1]),
            sign => sign,
        }
    };
    let plane = orient3d(a, b, c, p);
    if plane.is_zero() && on_triangle([a, b, c], p) {
        return Crossing::At;
    }
    let facing = side(a, b);
    if facing == 0 || side(b, c) != facing || side(c, a) != facing {
        return Crossing::None;
    }
    // The normal points towards +x if `facing` is positive; the point must then lie below the face.
    if plane.value() == facing { Crossing::Signed(facing) } else { Crossing::None }
}
