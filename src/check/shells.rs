//! Shells as solids: their volumes, which lies in which, and which are inside out.

use super::ShellReport;
use crate::geom::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::predicate::{Sign, orient3d, turn};
use crate::geom::signed_volume::{ExactVolume, VolumeSum};
use crate::mesh::{FaceId, Mesh, VertexId};
use crate::topology::{EdgeCounts, Shells, Topology};

impl ShellReport {
    /// A shell of which nothing is known yet.
    const BLANK: Self = Self {
        first_face: FaceId(u32::MAX),
        faces: 0,
        edges: 0,
        vertices: 0,
        euler_characteristic: 0,
        genus: None,
        signed_volume: 0.0,
        volume_sign: Sign::Zero,
        watertight: true,
        balanced: true,
        inside_out: false,
        depth: 0,
        depth_known: true,
        parent: None,
        bounds: Aabb::EMPTY,
    };
}

/// Everything about the shells. `fans` has one face of each fan at the vertices with several, ascending;
/// `vertices` is how many vertices have a face, and `uses` sums up all edges. The search for shells in shells gives
/// up after `tests` tests.
pub(super) fn shells(
    mesh: &Mesh,
    topology: &Topology,
    shells: &Shells,
    fans: &[(VertexId, FaceId)],
    vertices: usize,
    uses: &EdgeCounts,
    tests: u64,
) -> Vec<ShellReport> {
    let mut list = vec![ShellReport::BLANK; shells.count];
    match &mut list[..] {
        // What is known of the whole is known of its only shell.
        [only] => {
            let first = shells.of_face.iter().position(Option::is_some);
            only.first_face = FaceId::new(first.expect("a shell has faces"));
            only.faces = topology.face_count() - topology.collapsed_face_count();
            only.edges = topology.edge_count();
            only.vertices = vertices;
            only.watertight = uses.watertight();
            only.balanced = uses.balanced;
        }
        several => count(topology, shells, fans, several),
    }
    characterise(shells, fans, &mut list);
    let signs = measure(mesh, topology, shells, &mut list);
    nest(mesh, shells, &signs, &mut list, Allowance { tests });
    for (shell, sign) in list.iter_mut().zip(signs) {
        shell.volume_sign = sign;
        if shell.watertight && Sign::of(shell.signed_volume) != sign {
            shell.signed_volume = 0.0; // all of it is rounding
        }
        let expected = if shell.depth % 2 == 0 { Sign::Positive } else { Sign::Negative };
        shell.inside_out = shell.watertight && shell.depth_known && sign == -expected;
    }
    list
}

/// Fills in the counts of each shell.
fn count(topology: &Topology, shells: &Shells, fans: &[(VertexId, FaceId)], list: &mut [ShellReport]) {
    let shell_of =
        |face: FaceId| shells.of_face[face.index()].expect("a face with edges has a shell") as usize;
    for edge in topology.edges() {
        let mut uses = topology.uses(edge);
        let Some((face, direction)) = uses.next() else { continue };
        let sum = direction + uses.map(|(_, direction)| direction).sum::<i32>();
        let shell = &mut list[shell_of(face)];
        shell.edges += 1;
        shell.balanced &= sum == 0;
        shell.watertight &= sum == 0 && topology.valence(edge) == 2;
    }

    // A vertex with one fan belongs to one shell, that of any of its faces; the others are told by their fans.
    let mut seen = vec![0_u64; topology.vertex_count().div_ceil(64)];
    let mut first_time = |vertex: u32| {
        let (word, bit) = (&mut seen[vertex as usize / 64], 1 << (vertex % 64));
        let first = *word & bit == 0;
        *word |= bit;
        first
    };
    for fans in fans.chunk_by(|a, b| a.0 == b.0) {
        first_time(fans[0].0.0);
        let mut at: Vec<usize> = fans.iter().map(|&(_, face)| shell_of(face)).collect();
        at.sort_unstable();
        at.dedup();
        at.into_iter().for_each(|shell| list[shell].vertices += 1);
    }
    for (face, corners) in topology.triangles().iter().enumerate() {
        let Some(shell) = shells.of_face[face] else { continue };
        let shell = &mut list[shell as usize];
        if shell.faces == 0 {
            shell.first_face = FaceId::new(face);
        }
        shell.faces += 1;
        shell.vertices += corners.iter().filter(|&&vertex| first_time(vertex)).count();
    }
}

/// Fills in what follows from the counts. A shell with two fans at one vertex is no surface there, and has no
/// genus; two shells may well share a vertex.
fn characterise(shells: &Shells, fans: &[(VertexId, FaceId)], list: &mut [ShellReport]) {
    for shell in list.iter_mut() {
        let [v, e, f] = [shell.vertices, shell.edges, shell.faces].map(|n| n as i64); // below 2^32
        shell.euler_characteristic = v - e + f;
        if shell.watertight {
            shell.genus = u64::try_from((2 - shell.euler_characteristic) / 2).ok();
        }
    }
    for fans in fans.chunk_by(|a, b| a.0 == b.0) {
        let mut at: Vec<Option<u32>> = fans.iter().map(|&(_, face)| shells.of_face[face.index()]).collect();
        at.sort_unstable();
        for twice in at.windows(2).filter(|pair| pair[0] == pair[1]) {
            if let Some(shell) = twice[0] {
                list[shell as usize].genus = None;
            }
        }
    }
}

/// Fills in boxes and volumes. Gives the exact signs of the watertight shells' volumes; zero for the others.
fn measure(mesh: &Mesh, topology: &Topology, shells: &Shells, list: &mut [ShellReport]) -> Vec<Sign> {
    // A closed surface has the same volume about any point, and the smallest terms about one of its own. Of an
    // open one the volume is that under a cone over its border; one apex for all of them, which moves with the
    // mesh, lets the patches of a solid add up.
    let apex = if list.iter().all(|shell| shell.balanced) { [0.0; 3] } else { mean_corner(mesh, topology) };
    let about = |shell: &ShellReport| match shell.balanced {
        true => mesh.corners(shell.first_face)[0].map(f64::from),
        false => apex,
    };
    let mut sums: Vec<VolumeSum> = list.iter().map(|shell| VolumeSum::new(about(shell))).collect();
    // Shells come in runs; within one the sums stay in registers.
    let mut next = 0;
    for run in shells.of_face.chunk_by(|a, b| a == b) {
        let faces = next..next + run.len() as u32;
        next = faces.end;
        let Some(shell) = run[0].map(|shell| shell as usize) else { continue };
        let (mut sum, mut bounds) = (sums[shell], list[shell].bounds);
        for face in faces.map(FaceId) {
            let corners = mesh.corners(face);
            sum.add(corners);
            bounds = bounds.join(&Aabb::around(corners));
        }
        (sums[shell], list[shell].bounds) = (sum, bounds);
    }
    let mut unsure = vec![None; list.len()];
    for ((shell, sum), unsure) in list.iter_mut().zip(&sums).zip(&mut unsure) {
        shell.signed_volume = sum.value();
        if shell.watertight && sum.sign().is_none() {
            *unsure = Some(Box::new(ExactVolume::new()));
        }
    }
    if unsure.iter().any(Option::is_some) {
        for (face, shell) in topology.faces().zip(&shells.of_face) {
            if let Some(exact) = shell.and_then(|shell| unsure[shell as usize].as_mut()) {
                exact.add(mesh.corners(face));
            }
        }
    }
    let sign = |((shell, sum), exact): ((&ShellReport, &VolumeSum), Option<Box<ExactVolume>>)| match exact {
        _ if !shell.watertight => Sign::Zero,
        Some(exact) => exact.sign(),
        None => sum.sign().expect("what is unsure was added exactly"),
    };
    list.iter().zip(&sums).zip(unsure).map(sign).collect()
}

/// The mean over the corners of all faces that have not collapsed.
fn mean_corner(mesh: &Mesh, topology: &Topology) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for face in topology.faces().filter(|&face| !topology.is_collapsed(face)) {
        for corner in mesh.corners(face) {
            for axis in 0..3 {
                sum[axis] += f64::from(corner[axis]);
            }
        }
    }
    let corners = 3 * (topology.face_count() - topology.collapsed_face_count());
    sum.map(|sum| sum / corners as f64)
}

/// What may still be looked at: where many shells lie in one place, each would be compared with all others.
struct Allowance {
    tests: u64,
}

impl Allowance {
    /// Whether one more test may be made.
    #[inline]
    fn take(&mut self) -> bool {
        self.tests = self.tests.saturating_sub(1);
        self.tests > 0
    }

    /// `None` once it is used up.
    fn left(&self) -> Option<()> {
        (self.tests > 0).then_some(())
    }
}

/// Fills in depth and parent of the watertight shells. Where it gives up, the depths of the rest are not known.
fn nest(mesh: &Mesh, shells: &Shells, signs: &[Sign], list: &mut [ShellReport], mut allowance: Allowance) {
    // Only a shell whose box lies in another's can be nested, and only those others can hold it.
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

/// The shells that are `inner`, each behind those whose boxes hold its own, so that their depths are known when it
/// is its turn. Of equal boxes the one with the larger volume comes first.
fn outside_in(list: &[ShellReport], inner: &[bool]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..list.len()).filter(|&shell| inner[shell]).collect();
    order.sort_unstable_by(|&a, &b| {
        let (one, two) = (&list[a], &list[b]);
        // A box that holds another starts no later on every axis, and ends no earlier.
        let starts = one.bounds.low.partial_cmp(&two.bounds.low);
        let ends = two.bounds.high.partial_cmp(&one.bounds.high);
        let boxes = starts.zip(ends).map(|(starts, ends)| starts.then(ends)).expect("coordinates are finite");
        boxes.then(two.signed_volume.abs().total_cmp(&one.signed_volume.abs())).then(a.cmp(&b))
    });
    order
}

/// The shells that hold `shell`, which has the faces `own` with the vertices `points`; ascending.
#[expect(clippy::too_many_arguments, reason = "all that is known of one shell")]
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
    // A point that lies on another shell tells nothing about it; the next one may.
    let mut found = around_point(points.clone().next().expect("a shell has faces"));
    if !found.touching.is_empty()
        && let Some(clear) = points.clone().map(&mut around_point).find(|found| found.touching.is_empty())
    {
        found = clear;
    }
    found.shells.retain(|&other| list[other as usize].bounds.contains_box(&list[shell].bounds));
    // Before the depth makes it inside out, all of it must lie inside: else it merely cuts the other.
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

/// The faces of some shells, to be asked which of them surround a point.
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

    /// Those of `others` (ascending) of which no face and none of the faces `own` pass through each other, rather
    /// than merely touch.
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

    /// A shell is around `point` if its faces' signed crossings with the ray towards +x do not cancel. Shell
    /// `own` is left out.
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

/// How the ray from a point towards +x meets a triangle.
enum Crossing {
    None,
    /// +1 on the way out through a face that looks towards +x, −1 through one that looks back.
    Signed(i32),
    /// The point lies on the triangle.
    At,
}

/// Exact, with the ray's start moved by (0, ε, ε²) so that it meets no vertex and no edge. A simulation of
/// simplicity of one point (Herbert Edelsbrunner and Ernst Peter Mücke, 1990): where a sign is zero, that of
/// its derivative by ε, then by ε², takes its place.
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
    // The face looks towards +x where `facing` is positive; the point must then lie below it.
    if plane.value() == facing { Crossing::Signed(facing) } else { Crossing::None }
}

/// Whether a point of the triangle's plane lies in the closed triangle.
fn on_triangle([a, b, c]: [[f32; 3]; 3], p: [f32; 3]) -> bool {
    if !Aabb::around([a, b, c]).contains(p) {
        return false;
    }
    // Inside or on the edge in every projection; a projection that is a line tells nothing by its turns.
    (0..3).all(|axis| {
        let turns = [(a, b), (b, c), (c, a)].map(|(u, v)| turn(u, v, p, axis));
        !(turns.contains(&Sign::Positive) && turns.contains(&Sign::Negative))
    })
}
