//! Lights: anywhere, and where a given mesh makes them hard.

use super::feature::{along, corners, edge, face, one_ulp_off, plane, rounded, vertex};
use super::{Draw, position};
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;

/// A kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LightKind {
    /// A point light or a directional one at a position of the grid of integers, or near it.
    Anywhere,
    /// On a vertex.
    Vertex,
    /// On an edge, or its line.
    Edge,
    /// On a face.
    Face,
    /// In the plane of a face, inside or outside it.
    Plane,
    /// Off a vertex, an edge or a plane by exactly one ulp in at least one coordinate, and at most one in
    /// each.
    UlpOff,
    /// Between vertices: inside most solids.
    Inside,
    /// Each coordinate that of some vertex: in planes, on edges and corners of axis-aligned solids.
    Corner,
    /// A point in a box five times as large.
    Outside,
    /// 2³ to 2³⁰ diagonals away from the center.
    Away,
    /// 2³⁰ to 2⁴⁰ diagonals away from the center, as far as `f32` goes.
    Far,
    /// Directional along an axis.
    Axis,
    /// Directional along an edge or in a face's plane.
    InPlane,
    /// Directional.
    Direction,
    /// A position whose coordinates may be any finite `f32`, of a point light or a directional one.
    Bits,
}

impl LightKind {
    /// The kinds without extreme bits, the harder ones several times; the simplest first.
    const MODERATE: [Self; 20] = [
        Self::Anywhere,
        Self::Anywhere,
        Self::Anywhere,
        Self::Anywhere,
        Self::Vertex,
        Self::Vertex,
        Self::Edge,
        Self::Edge,
        Self::Face,
        Self::Plane,
        Self::Plane,
        Self::UlpOff,
        Self::UlpOff,
        Self::Inside,
        Self::Corner,
        Self::Outside,
        Self::Away,
        Self::Far,
        Self::Axis,
        Self::InPlane,
    ];

    /// A light for `mesh`. Without faces its features are at the origin.
    pub(crate) fn draw(self, draw: &mut dyn Draw, mesh: &Mesh) -> Light {
        let bounds = mesh.bounds().map_or(Aabb::around([[0.0; 3]]), |[low, high]| Aabb { low, high });
        let (center, diagonal) = (bounds.center().map(f64::from), bounds.diagonal());
        let xyz = match self {
            Self::Anywhere => {
                let (xyz, is_directional) = (draw.position(), draw.flag());
                return light_of(xyz, is_directional);
            }
            Self::Bits => {
                let (xyz, is_directional) = (position(draw), draw.flag());
                return light_of(xyz, is_directional);
            }
            Self::Axis | Self::InPlane | Self::Direction => return self.direction(draw, mesh),
            Self::UlpOff => {
                let kind = draw.pick(&[Self::Vertex, Self::Edge, Self::Plane]);
                let on = kind.draw(draw, mesh).xyz();
                one_ulp_off(draw, on)
            }
            Self::Vertex => rounded(vertex(draw, mesh)),
            Self::Edge => rounded(edge(draw, mesh)),
            Self::Face => rounded(face(draw, mesh)),
            Self::Plane => rounded(plane(draw, mesh)),
            Self::Inside => {
                let middle = corners(draw, mesh)
                    .into_iter()
                    .fold([0.0; 3], |sum, p| [0, 1, 2].map(|i| sum[i] + p[i] / 3.0));
                let other = vertex(draw, mesh);
                rounded(along([middle, other], 0.5 + 0.3 * draw.signed()))
            }
            Self::Corner => rounded([0, 1, 2].map(|i| vertex(draw, mesh)[i])),
            Self::Outside => rounded(center.map(|x| x + 2.5 * draw.signed() * diagonal)),
            Self::Away => distant(draw, center, diagonal, [3.0, 30.0]),
            Self::Far => distant(draw, center, diagonal, [30.0, 40.0]),
        };
        Light::point(xyz).expect("finite")
    }

    fn direction(self, draw: &mut dyn Draw, mesh: &Mesh) -> Light {
        // Along an axis, and where nothing else came out.
        let mut axis = [0.0; 3];
        axis[draw.index(3)] = draw.pick(&[1.0, -1.0]);
        let travel = match self {
            Self::Axis => axis,
            Self::InPlane => {
                let weight = draw.pick(&[0.0, 1.0, 0.5, -1.0]);
                let [a, b, c] = corners(draw, mesh);
                rounded([0, 1, 2].map(|i| (b[i] - a[i]) + weight * (c[i] - a[i])))
            }
            _ if draw.below(8) == 7 => [(); 3].map(|()| draw.bits()),
            _ => [(); 3].map(|()| draw.signed() as f32),
        };
        Light::directional(travel).or_else(|_| Light::directional(axis)).expect("an axis is a direction")
    }
}

/// A light for `mesh`: of any kind, one in eight of them of any bits.
pub fn light(draw: &mut dyn Draw, mesh: &Mesh) -> Light {
    if draw.below(8) < 7 {
        return moderate_light(draw, mesh);
    }
    let kind = draw.pick(&[LightKind::Direction, LightKind::Bits]);
    kind.draw(draw, mesh)
}

/// A light for `mesh` at most 2⁴⁰ diagonals away, whose coordinates may still be scaled by large powers of
/// two.
pub(crate) fn moderate_light(draw: &mut dyn Draw, mesh: &Mesh) -> Light {
    let kind = draw.pick(&LightKind::MODERATE);
    kind.draw(draw, mesh)
}

/// 2ᵏ diagonals away from the center, for k in a range, evenly.
fn distant(draw: &mut dyn Draw, center: [f64; 3], diagonal: f64, [low, high]: [f64; 2]) -> [f32; 3] {
    let [x, y, z] = [(); 3].map(|()| draw.signed());
    let length = (x * x + y * y + z * z).sqrt();
    let unit = if length > 0.0 { [x, y, z].map(|x| x / length) } else { [1.0, 0.0, 0.0] };
    let distance = diagonal * (low + (high - low) * draw.unit()).exp2();
    rounded([0, 1, 2].map(|i| center[i] + distance * unit[i]))
}

/// A light that travels along `xyz`, or a point light there where that is no direction.
fn light_of(xyz: [f32; 3], is_directional: bool) -> Light {
    match Light::directional(xyz) {
        Ok(light) if is_directional => light,
        _ => Light::point(xyz).expect("finite coordinates"),
    }
}
