//! Relations that keep every result the same, bit for bit.

use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::oracle::Crossings;
use umbrage::testing::strategy::Case;

use super::Twist;
use super::answers::{
    Answers, Fault, Outline, PointAnswer, Slip, Tally, directed, equal, on_grid, rebuilt, set_directed,
};

type Judgement = Option<Result<Tally, String>>;

/// Positions of the original's vertices and faces within the image.
struct Copy {
    vertices: Vec<u32>,
    faces: Vec<u32>,
    /// Whether the faces of the copy are reversed.
    turned: bool,
}

impl Copy {
    fn identity(mesh: &Mesh) -> Self {
        let (vertices, faces) = (mesh.vertex_count() as u32, mesh.face_count() as u32);
        Self { vertices: (0..vertices).collect(), faces: (0..faces).collect(), turned: false }
    }
}

/// The message of each comparison of [`judge`] about a wrong answer.
pub(super) const COMPARISONS: &[(Slip, &str)] = &[
    (Slip::Faces, "faces: "),
    (Slip::Facing, "facing: "),
    (Slip::Outline(0), "silhouettes: "),
    (Slip::Outline(1), "silhouettes: "),
    (Slip::Points, "points: "),
    (Slip::Darker, "point "),
    (Slip::Lighter, "point "),
    (Slip::Crossings, "point "),
    (Slip::Winding, "point "),
];

/// Checks that each copy has the original's facing and silhouette, that there is nothing else, and that every
/// count is multiplied by the number of copies.
fn judge(original: &Case, image: &Case, copies: &[Copy], fault: Fault) -> Result<Tally, String> {
    let (before, mut after) = (Answers::of(original)?, Answers::of(image)?);
    fault.spoil(&mut after);
    let n = copies.len();
    equal("faces", &after.facing.len(), &(n * before.facing.len()))?;
    let mut expected = [Outline::new(), Outline::new()];
    for copy in copies {
        let facing: Vec<_> = copy.faces.iter().map(|&face| after.facing[face as usize]).collect();
        equal("facing", &facing, &before.facing)?;
        for (outline, before) in expected.iter_mut().zip(&before.outlines) {
            for &[a, b] in before.keys() {
                let m = directed(before, a, b);
                let [a, b] = [a, b].map(|vertex| copy.vertices[vertex as usize]);
                set_directed(outline, a, b, if copy.turned { -m } else { m });
            }
        }
    }
    equal("silhouettes", &after.outlines, &expected)?;
    equal("points", &after.points.len(), &before.points.len())?;
    let (count, sum) = (n as u32, n as i32);
    for (point, (after, before)) in after.points.iter().zip(&before.points).enumerate() {
        let Crossings { front, back, touching } = before.crossings;
        let expected = PointAnswer {
            verdict: before.verdict,
            crossings: Crossings { front: count * front, back: count * back, touching: count * touching },
            winding: before.winding.map(|winding| sum * winding),
        };
        equal(&format!("point {point}"), after, &expected)?;
    }
    Ok(before.tally())
}

/// The case with every position mapped by `map`, and the original without the points for which `map` fails.
/// `None` if `map` fails for a vertex or for the light.
fn moved(
    case: &Case,
    map: impl Fn([f32; 3]) -> Option<[f32; 3]>,
    direction: impl Fn([f32; 3]) -> Option<[f32; 3]>,
) -> Option<(Case, Case)> {
    let positions = case.mesh.positions().iter().map(|&p| map(p)).collect::<Option<_>>()?;
    let light = if case.light.is_directional() {
        Light::directional(direction(case.light.xyz())?.map(|x| -x))
    } else {
        Light::point(map(case.light.xyz())?)
    };
    let (kept, points) = case.points.iter().filter_map(|&p| Some((p, map(p)?))).unzip();
    let mesh = rebuilt(positions, case.mesh.triangles().to_vec());
    let image = Case { mesh, light: light.ok()?, points };
    Some((Case { points: kept, ..case.clone() }, image))
}

/// All three coordinates mapped; `None` if `map` fails for one of them.
fn each(p: [f32; 3], map: impl Fn(f32) -> Option<f32>) -> Option<[f32; 3]> {
    Some([map(p[0])?, map(p[1])?, map(p[2])?])
}

/// Every length times 2ᵏ, where this is exact. Fault: the light stays.
pub(super) fn scaled(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    // An exponent that leaves the range of f32 at one end does not at the other.
    let (original, mut image) = [twist.exponent, -twist.exponent].into_iter().find_map(|exponent| {
        let factor = 2.0_f32.powi(exponent);
        let scale =
            |p| each(p, |x| (x * factor / factor == x && (x * factor).is_finite()).then_some(x * factor));
        moved(case, scale, scale)
    })?;
    if fault.in_image() {
        image.light = original.light;
    }
    Some(judge(&original, &image, &[Copy::identity(&case.mesh)], fault))
}

/// Every position translated by the same vector, where this is exact. Fault: the translation is so large that
/// positions are rounded.
pub(super) fn translated(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let case = on_grid(case);
    let keep = |p| Some(p);
    let (steps, exponent) = twist.shift;
    let shift = steps.map(|step| f32::from(step) * 2.0_f32.powi(exponent));
    let (original, mut image) = moved(
        &case,
        |p| {
            let exact = |i: usize| {
                let sum = p[i] + shift[i];
                // Knuth's two-sum: the rounding error of a sum is itself a float, and must be 0 here.
                let back = sum - p[i];
                let error = (p[i] - (sum - back)) + (shift[i] - back);
                (error == 0.0).then_some(sum)
            };
            Some([exact(0)?, exact(1)?, exact(2)?])
        },
        keep,
    )?;
    if fault.in_image() {
        (_, image) = moved(&original, |p| Some(p.map(|x| x + 4_194_304.0)), keep)?;
    }
    Some(judge(&original, &image, &[Copy::identity(&case.mesh)], fault))
}

/// The same faces with reversed windings.
fn turned(mesh: &Mesh) -> Mesh {
    rebuilt(mesh.positions().to_vec(), mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect())
}

/// The axes permuted. An odd permutation mirrors space, so the windings are reversed. Fault: they are not.
pub(super) fn permuted(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let (order, odd) = [
        ([0, 1, 2], false),
        ([1, 2, 0], false),
        ([2, 0, 1], false),
        ([1, 0, 2], true),
        ([0, 2, 1], true),
        ([2, 1, 0], true),
    ][twist.order];
    rigid(case, |p| order.map(|axis| p[axis]), odd, fault)
}

/// Some axes mirrored. An odd number of them mirrors space, so the windings are reversed. Fault: they are
/// not.
pub(super) fn mirrored(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let map = |p: [f32; 3]| std::array::from_fn(|i| if twist.mirrored >> i & 1 == 1 { -p[i] } else { p[i] });
    rigid(case, map, twist.mirrored.count_ones() % 2 == 1, fault)
}

fn rigid(case: &Case, map: impl Fn([f32; 3]) -> [f32; 3], odd: bool, fault: Fault) -> Judgement {
    let (original, mut image) = moved(case, |p| Some(map(p)), |l| Some(map(l)))?;
    if odd && !fault.in_image() {
        image.mesh = turned(&image.mesh);
    }
    Some(judge(&original, &image, &[Copy { turned: odd, ..Copy::identity(&case.mesh) }], fault))
}

/// The case with another mesh of the same shape.
fn stored(case: &Case, positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Case {
    Case { mesh: rebuilt(positions, triangles), ..case.clone() }
}

/// The vertices renumbered. Fault: the first two positions are not moved.
pub(super) fn relabelled(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let to = twist.permutation(case.mesh.vertex_count());
    let mut positions = vec![[0.0; 3]; to.len()];
    case.mesh.positions().iter().zip(&to).for_each(|(&p, &new)| positions[new as usize] = p);
    if fault.in_image() {
        positions.swap(0, 1);
    }
    let triangles = case.mesh.triangles().iter().map(|face| face.map(|vertex| to[vertex as usize])).collect();
    let copy = Copy { vertices: to, ..Copy::identity(&case.mesh) };
    Some(judge(case, &stored(case, positions, triangles), &[copy], fault))
}

/// The faces renumbered. Fault: one face is lost, and another is there twice.
pub(super) fn reordered(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let to = twist.permutation(case.mesh.face_count());
    let mut triangles = vec![[0; 3]; to.len()];
    case.mesh.triangles().iter().zip(&to).for_each(|(&face, &new)| triangles[new as usize] = face);
    if let (true, [first, .., last]) = (fault.in_image(), &mut triangles[..]) {
        *first = *last;
    }
    let copy = Copy { faces: to, ..Copy::identity(&case.mesh) };
    Some(judge(case, &stored(case, case.mesh.positions().to_vec(), triangles), &[copy], fault))
}

/// The corners of each face rotated. Fault: one face is reversed.
pub(super) fn rotated(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let mut triangles = case.mesh.triangles().to_vec();
    for (face, corners) in triangles.iter_mut().enumerate() {
        corners.rotate_left((twist.scattered(face) % 3) as usize);
    }
    if let (true, Some(first)) = (fault.in_image(), triangles.first_mut()) {
        first.swap(0, 1);
    }
    let copy = Copy::identity(&case.mesh);
    Some(judge(case, &stored(case, case.mesh.positions().to_vec(), triangles), &[copy], fault))
}

/// Unreferenced vertices inserted between the others, near and far. Fault: the first face uses one of them.
pub(super) fn unreferenced(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let (mut positions, mut vertices) = (Vec::new(), Vec::new());
    let stray = |i: usize| [(twist.scattered(i) as f32) * 2.0_f32.powi(-60), 3.0e38, -1.0];
    for (i, &position) in case.mesh.positions().iter().enumerate() {
        if i == 0 || twist.scattered(i).is_multiple_of(3) {
            positions.push(stray(i));
        }
        vertices.push(positions.len() as u32);
        positions.push(position);
    }
    let renamed = |face: &[u32; 3]| face.map(|vertex| vertices[vertex as usize]);
    let mut triangles: Vec<_> = case.mesh.triangles().iter().map(renamed).collect();
    if let (true, Some(first)) = (fault.in_image(), triangles.first_mut()) {
        first[0] = 0;
    }
    let copy = Copy { vertices, ..Copy::identity(&case.mesh) };
    Some(judge(case, &stored(case, positions, triangles), &[copy], fault))
}

/// The entire mesh a second time at the same position, with vertices of its own. Fault: a face of the copy
/// has collapsed.
pub(super) fn duplicated(case: &Case, _: &Twist, fault: Fault) -> Judgement {
    let (v, f) = (case.mesh.vertex_count() as u32, case.mesh.face_count() as u32);
    let (mut positions, mut triangles, ..) = case.mesh.clone().into_parts();
    positions.extend_from_within(..);
    triangles.extend_from_within(..);
    triangles[f as usize..].iter_mut().for_each(|face| *face = face.map(|vertex| vertex + v));
    if let (true, Some(last)) = (fault.in_image(), triangles.last_mut()) {
        last[2] = last[1];
    }
    let second = Copy { vertices: (v..2 * v).collect(), faces: (f..2 * f).collect(), turned: false };
    Some(judge(case, &stored(case, positions, triangles), &[Copy::identity(&case.mesh), second], fault))
}
