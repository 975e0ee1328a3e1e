//! Lights: anywhere, and where a given mesh makes them hard.

use super::{Draw, position};
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::verify::points::feature::{Feature, along, corner, corners, one_ulp_off, rounded};

/// A kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LightKind {
    /// A point light or a directional one at a position of the grid of integers, or near it.
    Anywhere,
    /// On the mesh, or on the line of an edge or the plane of a face.
    On(Feature),
    /// Off a vertex, an edge or a plane by exactly one ulp in at least one coordinate, and at most one in
    /// each.
    UlpOff,
    /// Between vertices: inside most solids.
    Inside,
    /// Each coordinate that of some vertex: in planes, on edges and corners of axis-aligned solids.
    Corner,
    /// A point in a box five times as large.
    Outside,
    /// Away from the center by a number of diagonals between two powers of two.
    Away(u32, u32),
    /// Directional along an axis.
    Axis,
    /// Directional along an edge or in a face's plane.
    InPlane,
    /// Directional; one in eight of any bits.
    Direction,
    /// A position whose coordinates may be any finite `f32`, of a point light or a directional one.
    Bits,
}

impl LightKind {
    /// 2³⁰ to 2⁴⁰ diagonals away.
    pub(crate) const FAR: Self = Self::Away(30, 40);

    /// The kinds without extreme bits, the simplest first.
    const MODERATE: [Self; 14] = {
        use Feature::{Edge, Face, Line, Plane, Vertex};
        use LightKind::{Anywhere, Away, Axis, Corner, InPlane, Inside, On, Outside, UlpOff};
        let far = Self::FAR;
        let [vertex, edge, face, plane, line] = [On(Vertex), On(Edge), On(Face), On(Plane), On(Line)];
        let away = Away(3, 30);
        [Anywhere, vertex, edge, face, plane, line, UlpOff, Inside, Corner, Outside, away, far, Axis, InPlane]
    };

    /// A light for `mesh`. Without faces its features are at the origin.
    pub(crate) fn draw(self, draw: &mut dyn Draw, mesh: &Mesh) -> Light {
        let bounds = mesh.bounds().map_or(Aabb::around([[0.0; 3]]), |[low, high]| Aabb { low, high });
        let (center, diagonal) = (bounds.center().map(f64::from), bounds.diagonal());
        let (xyz, is_directional) = match self {
            Self::Anywhere => (draw.position(), draw.flag()),
            Self::Bits => (position(draw), draw.flag()),
            Self::On(feature) => (rounded(feature.draw(draw, mesh)), false),
            Self::UlpOff => {
                let feature = draw.pick(&[Feature::Vertex, Feature::Edge, Feature::Plane]);
                let on = rounded(feature.draw(draw, mesh));
                (one_ulp_off(draw, on), false)
            }
            Self::Inside => {
                let [a, b, c] = corners(draw, mesh);
                let middle = [0, 1, 2].map(|i| (a[i] + b[i] + c[i]) / 3.0);
                let other = Feature::Vertex.draw(draw, mesh);
                (rounded(along([middle, other], 0.5 + 0.3 * draw.signed())), false)
            }
            Self::Corner => (corner(draw, mesh), false),
            Self::Outside => (rounded(center.map(|x| x + 2.5 * draw.signed() * diagonal)), false),
            Self::Away(low, high) => {
                let [x, y, z] = [(); 3].map(|()| draw.signed());
                let length = (x * x + y * y + z * z).sqrt();
                let unit = if length > 0.0 { [x, y, z].map(|x| x / length) } else { [1.0, 0.0, 0.0] };
                let distance = diagonal * (f64::from(low) + f64::from(high - low) * draw.unit()).exp2();
                (rounded([0, 1, 2].map(|i| center[i] + distance * unit[i])), false)
            }
            Self::Axis => ([0.0; 3], true),
            Self::InPlane => {
                let weight = draw.pick(&[0.0, 1.0, 0.5, -1.0]);
                let [a, b, c] = corners(draw, mesh);
                (rounded([0, 1, 2].map(|i| (b[i] - a[i]) + weight * (c[i] - a[i]))), true)
            }
            Self::Direction if draw.below(8) == 7 => ([(); 3].map(|()| draw.bits()), true),
            Self::Direction => ([(); 3].map(|()| draw.signed() as f32), true),
        };
        if !is_directional {
            return Light::point(xyz).expect("finite");
        }
        // Along an axis, where this is no direction.
        let mut axis = [0.0; 3];
        axis[draw.index(3)] = draw.pick(&[1.0, -1.0]);
        Light::directional(xyz).or_else(|_| Light::directional(axis)).expect("an axis is a direction")
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
