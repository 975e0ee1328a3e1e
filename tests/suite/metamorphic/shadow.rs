//! Relations that keep the shadow the same while the faces and their indices change.

use std::collections::HashMap;

use umbrage::geom::Facing;
use umbrage::geom::predicate::orient3d;
use umbrage::mesh::{HalfEdgeId, Mesh};
use umbrage::oracle::{Crossings, Verdict};
use umbrage::testing::strategy::Case;
use umbrage::topology::Topology;

use super::Twist;
use super::answers::{Answers, Fault, Outline, Slip, Tally, directed, equal, on_grid, rebuilt, set_directed};

type Judgement = Option<Result<Tally, String>>;

fn with_mesh(case: &Case, mesh: Mesh) -> Case {
    Case { mesh, ..case.clone() }
}

/// All windings reversed: front becomes back, and nothing else changes. Fault: one face keeps its winding.
pub(super) fn turned(case: &Case, _: &Twist, fault: Fault) -> Judgement {
    let mut triangles: Vec<_> = case.mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    if let (true, Some(first)) = (fault.in_image(), triangles.first_mut()) {
        first.swap(1, 2);
    }
    let image = with_mesh(case, rebuilt(case.mesh.positions().to_vec(), triangles));
    Some(judge_turned(case, &image, fault))
}

/// The message of each comparison of [`judge_turned`] about a wrong answer.
pub(super) const TURNED: &[(Slip, &str)] = &[
    (Slip::Facing, "facing: "),
    (Slip::Outline(0), "the silhouette: "),
    (Slip::Crossings, "crossings at point "),
    (Slip::Darker, "verdict at point "),
    (Slip::Lighter, "verdict at point "),
    (Slip::Winding, "winding number at point "),
];

fn judge_turned(original: &Case, image: &Case, fault: Fault) -> Result<Tally, String> {
    let (before, mut after) = (Answers::of(original)?, Answers::of(image)?);
    fault.spoil(&mut after);
    let opposite = |facing: &Facing| match facing {
        Facing::Front => Facing::Back,
        Facing::EdgeOn => Facing::EdgeOn,
        Facing::Back => Facing::Front,
    };
    equal("facing", &after.facing, &before.facing.iter().map(opposite).collect())?;
    // A reversed face has the opposite sign and runs along its edges in the opposite direction.
    equal("the silhouette", &after.outlines[0], &before.outlines[0])?;
    for (point, (after, before)) in after.points.iter().zip(&before.points).enumerate() {
        let Crossings { front, back, touching } = before.crossings;
        let crossings = Crossings { front: back, back: front, touching };
        equal(&format!("crossings at point {point}"), &after.crossings, &crossings)?;
        equal(&format!("verdict at point {point}"), &after.verdict, &before.verdict)?;
        equal(&format!("winding number at point {point}"), &after.winding, &before.winding)?;
    }
    Ok(before.tally())
}

/// The same surface with its faces cut differently.
struct Recut {
    mesh: Mesh,
    /// For each face, the face of the original that contains it, or an equivalent one.
    parents: Vec<u32>,
}

/// The message of each comparison of [`judge`] about a wrong answer, those of the silhouettes first.
pub(super) const RECUT: &[(Slip, &str)] = &[
    (Slip::Outline(0), "silhouettes: "),
    (Slip::Outline(1), "silhouettes: "),
    (Slip::Faces, "faces: "),
    (Slip::Facing, "facing: "),
    (Slip::Darker, "verdict at point "),
    (Slip::Lighter, "verdict at point "),
    (Slip::Crossings, "crossings at point "),
    (Slip::Winding, "winding number at point "),
];

/// The comparisons without expected silhouettes.
pub(super) const QUARTERED: &[(Slip, &str)] = RECUT.split_at(2).1;

/// Checks that pieces face like their parents, and that the shadow is the same wherever neither mesh is
/// touched.
///
/// `outlines` gives the expected silhouettes, if they are known. Then the volumes are the same sets of
/// points, and the winding numbers are compared too.
fn judge(
    original: &Case,
    recut: Recut,
    outlines: Option<impl Fn(&Outline) -> Outline>,
    fault: Fault,
) -> Result<Tally, String> {
    let image = with_mesh(original, recut.mesh);
    let (before, mut after) = (Answers::of(original)?, Answers::of(&image)?);
    fault.spoil(&mut after);
    equal("faces", &after.facing.len(), &recut.parents.len())?;
    let expected = recut.parents.iter().map(|&face| before.facing[face as usize]).collect();
    equal("facing", &after.facing, &expected)?;
    if let Some(expected) = &outlines {
        equal(
            "silhouettes",
            &after.outlines,
            &[expected(&before.outlines[0]), expected(&before.outlines[1])],
        )?;
    }
    for (point, (after, before)) in after.points.iter().zip(&before.points).enumerate() {
        if after.verdict != Verdict::Grazing && before.verdict != Verdict::Grazing {
            equal(&format!("verdict at point {point}"), &after.verdict, &before.verdict)?;
        }
        if after.crossings.touching == 0 && before.crossings.touching == 0 {
            equal(&format!("crossings at point {point}"), &after.crossings, &before.crossings)?;
        }
        if outlines.is_some() || after.winding.and(before.winding).is_some() {
            equal(&format!("winding number at point {point}"), &after.winding, &before.winding)?;
        }
    }
    Ok(before.tally())
}

/// The midpoint of two positions, if every coordinate is an exact `f32`.
fn exact_middle(p: [f32; 3], q: [f32; 3]) -> Option<[f32; 3]> {
    let middle = |i: usize| {
        let (x, y) = (f64::from(p[i]), f64::from(q[i]));
        let sum = x + y;
        let rounded = (0.5 * sum) as f32;
        (sum - x == y && sum - y == x && f64::from(rounded) == 0.5 * sum).then_some(rounded)
    };
    Some([middle(0)?, middle(1)?, middle(2)?])
}

fn has_edges([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// An edge split at its midpoint, together with all faces at this edge. Fault: the new vertex lies elsewhere.
pub(super) fn split(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let case = &on_grid(case);
    let (mut positions, mut triangles, ..) = case.mesh.clone().into_parts();
    let edges: Vec<([u32; 2], [f32; 3])> = triangles
        .iter()
        .filter(|face| has_edges(**face))
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .filter_map(|[a, b]| Some(([a, b], exact_middle(positions[a as usize], positions[b as usize])?)))
        .collect();
    let &([a, b], mut middle) = edges.get(twist.pick.index(edges.len().max(1)))?;
    if fault.in_image() {
        middle[twist.order % 3] += 0.5;
    }
    let new = positions.len() as u32;
    positions.push(middle);
    let mut parents: Vec<u32> = (0..triangles.len() as u32).collect();
    for face in 0..triangles.len() {
        for first in 0..3 {
            let mut corners = triangles[face];
            corners.rotate_left(first);
            let [p, q, r] = corners;
            if has_edges(corners) && ([p, q] == [a, b] || [p, q] == [b, a]) {
                triangles[face] = [p, new, r];
                triangles.push([new, q, r]);
                parents.push(face as u32);
                break;
            }
        }
    }
    let recut = Recut { mesh: rebuilt(positions, triangles), parents };
    let outlines = |before: &Outline| {
        let (mut outline, m) = (before.clone(), directed(before, a, b));
        set_directed(&mut outline, a, b, 0);
        set_directed(&mut outline, a, new, m);
        set_directed(&mut outline, new, b, m);
        outline
    };
    Some(judge(case, recut, Some(outlines), fault))
}

/// Flat convex quads cut along the other diagonal, among them a parallelogram added for this purpose. Fault:
/// one half of a quad is lost.
pub(super) fn recut(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let (mut positions, mut triangles, ..) = case.mesh.clone().into_parts();
    let [origin, u, v] = twist.quad.map(|place| place.map(f32::from));
    let added = triangles.len();
    let n = positions.len() as u32;
    for (i, j) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        positions.push([0, 1, 2].map(|axis| origin[axis] + i * u[axis] + j * v[axis]));
    }
    triangles.extend([[n, n + 1, n + 2], [n, n + 2, n + 3]]);
    let original = with_mesh(case, rebuilt(positions.clone(), triangles.clone()));

    let topology = Topology::build(positions.len(), triangles.clone());
    let mut taken = vec![false; triangles.len()];
    for half_edge in (0..3 * triangles.len()).map(HalfEdgeId::new) {
        let Some(twin) = topology.twin(half_edge) else { continue };
        let faces = [half_edge, twin].map(|half_edge| half_edge.index() / 3);
        let wanted = faces[0] >= added || twist.scattered(faces[0]).is_multiple_of(2);
        if !wanted || faces.iter().any(|&face| taken[face]) {
            continue;
        }
        let corner = |half_edge: HalfEdgeId, step: usize| {
            topology.triangles()[half_edge.index() / 3][(half_edge.index() + step) % 3]
        };
        let [p, q, r, s] =
            [corner(half_edge, 0), corner(half_edge, 1), corner(half_edge, 2), corner(twin, 2)];
        if !is_convex([p, s, q, r].map(|vertex| positions[vertex as usize])) {
            continue;
        }
        triangles[faces[0]] = [p, s, r];
        triangles[faces[1]] = if fault.in_image() && faces[0] >= added { [p, s, r] } else { [s, q, r] };
        faces.iter().for_each(|&face| taken[face] = true);
    }
    if !taken[added] {
        return None; // its sides are parallel
    }
    let parents = (0..triangles.len() as u32).collect();
    Some(judge(
        &original,
        Recut { mesh: rebuilt(positions, triangles), parents },
        Some(Outline::clone),
        fault,
    ))
}

/// Whether four corners lie exactly in one plane and turn strictly in the same direction.
fn is_convex([a, b, c, d]: [[f32; 3]; 4]) -> bool {
    let apexes = [[1e4, 0.0, 0.0], [0.0, 1e4, 0.0], [0.0, 0.0, 1e4], [-1e4, 0.0, 0.0]];
    let Some(apex) = apexes.into_iter().find(|&apex| !orient3d(a, b, c, apex).is_zero()) else {
        return false;
    };
    let turn = orient3d(a, b, c, apex);
    orient3d(a, b, c, d).is_zero()
        && [[b, c, d], [c, d, a], [d, a, b]].iter().all(|&[x, y, z]| orient3d(x, y, z, apex) == turn)
}

/// Three in four faces cut into four at the midpoints of their edges, while their neighbors stay: exact
/// T-junctions. Fault: the inner quarter is a different triangle.
pub(super) fn quartered(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let case = &on_grid(case);
    let (mut positions, mut triangles, ..) = case.mesh.clone().into_parts();
    let mut parents: Vec<u32> = (0..triangles.len() as u32).collect();
    let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
    let mut cut = false;
    for face in 0..triangles.len() {
        let [a, b, c] = case.mesh.triangles()[face];
        let edges = [[a, b], [b, c], [c, a]];
        let places = edges.map(|edge| {
            let [p, q] = edge.map(|vertex| positions[vertex as usize]);
            exact_middle(p, q)
        });
        let [Some(_), Some(_), Some(_)] = places else { continue };
        if !has_edges([a, b, c]) || twist.scattered(face).is_multiple_of(4) {
            continue;
        }
        let [ab, bc, ca] = [0, 1, 2].map(|i| {
            let [p, q] = edges[i];
            *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                positions.extend(places[i]);
                positions.len() as u32 - 1
            })
        });
        triangles[face] = if fault.in_image() { [a, ab, ca] } else { [ab, bc, ca] };
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c]]);
        parents.extend([face as u32; 3]);
        cut = true;
    }
    let recut = Recut { mesh: rebuilt(positions, triangles), parents };
    cut.then(|| judge(case, recut, None::<fn(&Outline) -> Outline>, fault))
}
