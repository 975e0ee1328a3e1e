//! Positions on a mesh: its vertices, edges, faces and their planes, and how they are rounded.

use super::Draw;
use crate::mesh::Mesh;

/// The corners of a face, from any of them on; three times the origin where there is no face.
pub(super) fn corners(draw: &mut dyn Draw, mesh: &Mesh) -> [[f64; 3]; 3] {
    let (face, first) = (draw.index(mesh.face_count().max(1)), draw.index(3));
    let Some(mut face) = mesh.triangles().get(face).copied() else { return [[0.0; 3]; 3] };
    face.rotate_left(first);
    face.map(|vertex| mesh.positions()[vertex as usize].map(f64::from))
}

/// A vertex.
pub(super) fn vertex(draw: &mut dyn Draw, mesh: &Mesh) -> [f64; 3] {
    corners(draw, mesh)[0]
}

/// A point of an edge or, one time in three, of its line: mostly at an eighth.
pub(super) fn edge(draw: &mut dyn Draw, mesh: &Mesh) -> [f64; 3] {
    let [a, b, _] = corners(draw, mesh);
    let t = match draw.below(4) {
        0 => 0.5,
        1 => f64::from(draw.below(9)) / 8.0,
        2 => draw.unit(),
        _ => f64::from(draw.between(-12, 20)) / 8.0,
    };
    along([a, b], t)
}

/// A point of a face: half of them at eighths.
pub(super) fn face(draw: &mut dyn Draw, mesh: &Mesh) -> [f64; 3] {
    let corners = corners(draw, mesh);
    let in_eighths = !draw.flag();
    let mut part = || if in_eighths { f64::from(draw.below(9)) / 8.0 } else { draw.unit() };
    let (u, v) = (part(), part());
    if u + v > 1.0 { combined(corners, 1.0 - u, 1.0 - v) } else { combined(corners, u, v) }
}

/// A point in the plane of a face, inside or outside it: at eighths, so that it is not rounded on simple
/// meshes.
pub(super) fn plane(draw: &mut dyn Draw, mesh: &Mesh) -> [f64; 3] {
    let corners = corners(draw, mesh);
    let [u, v] = [(); 2].map(|()| f64::from(draw.between(-16, 24)) / 8.0);
    combined(corners, u, v)
}

/// `a` + `t` (`b` − `a`).
pub(super) fn along([a, b]: [[f64; 3]; 2], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]))
}

/// `a` + `u` (`b` − `a`) + `v` (`c` − `a`).
pub(super) fn combined([a, b, c]: [[f64; 3]; 3], u: f64, v: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]))
}

/// The nearest `f32` point that is finite.
pub(super) fn rounded(p: [f64; 3]) -> [f32; 3] {
    p.map(finite)
}

fn finite(x: f64) -> f32 {
    (x as f32).clamp(f32::MIN, f32::MAX) + 0.0 // not −0
}

/// The nearest `f32` point, each coordinate moved by −2 … 2 ulps.
pub(super) fn nudged(draw: &mut dyn Draw, p: [f64; 3]) -> [f32; 3] {
    rounded(p).map(|x| stepped(x, draw.between(-2, 2)))
}

/// Each coordinate one ulp up, one down, or as it is; not all three as they are.
pub(crate) fn one_ulp_off(draw: &mut dyn Draw, p: [f32; 3]) -> [f32; 3] {
    // Three digits of base 3: stay, up, down. Not 000.
    let digits = 1 + draw.below(26);
    [0, 1, 2].map(|i| match digits / 3_u32.pow(i) % 3 {
        0 => p[i as usize],
        1 if p[i as usize] < f32::MAX => stepped(p[i as usize], 1),
        2 if p[i as usize] == f32::MIN => stepped(p[i as usize], 1),
        _ => stepped(p[i as usize], -1),
    })
}

/// `x` moved by `steps` ulps; finite.
fn stepped(mut x: f32, steps: i32) -> f32 {
    for _ in 0..steps.abs() {
        x = if steps > 0 { x.next_up() } else { x.next_down() };
    }
    finite(x.into())
}
