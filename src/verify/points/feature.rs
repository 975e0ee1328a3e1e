//! Positions on a mesh: its vertices, edges, faces and their planes, and how they are rounded.

use crate::mesh::Mesh;
use crate::random::Draw;

/// What of a mesh a position is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    Vertex,
    /// The middle of an edge.
    Middle,
    /// An edge; half of the positions at eighths of it.
    Edge,
    /// The line of an edge, at eighths.
    Line,
    /// A face; half of the positions at eighths of two sides.
    Face,
    /// The plane of a face, inside or outside the face, at eighths: not rounded on simple meshes.
    Plane,
}

impl Feature {
    pub(crate) const ANY: &'static [Self] = &[Self::Vertex, Self::Edge, Self::Face, Self::Plane];

    pub(crate) fn draw(self, draw: &mut dyn Draw, mesh: &Mesh) -> [f64; 3] {
        let [a, b, c] = corners(draw, mesh);
        let eighths = |draw: &mut dyn Draw, low, high| f64::from(draw.between(low, high)) / 8.0;
        let part =
            |draw: &mut dyn Draw| if draw.flag() { draw.unit() } else { f64::from(draw.below(9)) / 8.0 };
        let (u, v) = match self {
            Self::Vertex => (0.0, 0.0),
            Self::Middle => (0.5, 0.0),
            Self::Edge => (part(draw), 0.0),
            Self::Line => (eighths(draw, -12, 20), 0.0),
            Self::Face => (part(draw), part(draw)),
            Self::Plane => (eighths(draw, -16, 24), eighths(draw, -16, 24)),
        };
        let (u, v) = if self == Self::Face && u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        combined([a, b, c], u, v)
    }
}

/// The corners of a face, from any of them on; three times the origin where there is no face.
pub(crate) fn corners(draw: &mut dyn Draw, mesh: &Mesh) -> [[f64; 3]; 3] {
    let (face, first) = (draw.index(mesh.face_count().max(1)), draw.index(3));
    let Some(mut face) = mesh.triangles().get(face).copied() else { return [[0.0; 3]; 3] };
    face.rotate_left(first);
    face.map(|vertex| mesh.positions()[vertex as usize].map(f64::from))
}

/// Each coordinate that of some vertex.
pub(crate) fn corner(draw: &mut dyn Draw, mesh: &Mesh) -> [f32; 3] {
    rounded([0, 1, 2].map(|axis| corners(draw, mesh)[0][axis]))
}

/// `a` + `t` (`b` − `a`).
pub(crate) fn along([a, b]: [[f64; 3]; 2], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]))
}

/// `a` + `u` (`b` − `a`) + `v` (`c` − `a`).
pub(crate) fn combined([a, b, c]: [[f64; 3]; 3], u: f64, v: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]))
}

/// The nearest `f32` point that is finite.
pub(crate) fn rounded(p: [f64; 3]) -> [f32; 3] {
    p.map(finite)
}

fn finite(x: f64) -> f32 {
    (x as f32).clamp(f32::MIN, f32::MAX) + 0.0 // not −0
}

/// The nearest `f32` point, each coordinate moved by −2 … 2 ulps.
pub(crate) fn nudged(draw: &mut dyn Draw, p: [f64; 3]) -> [f32; 3] {
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
