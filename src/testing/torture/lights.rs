//! Where the light is.

use super::meshes::bits;
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::verify::points::draw::rounded;

/// A kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// A point in a box five times as large.
    Outside,
    /// On a vertex.
    Vertex,
    /// At the middle or another point of an edge, or of its line.
    Edge,
    /// In the plane of a face, inside or outside it.
    Plane,
    /// Off one of these three by exactly one ulp in at least one coordinate, and at most one in each.
    UlpOff,
    /// 2³⁰ to 2⁴⁰ diagonals away from the center, as far as `f32` goes.
    Far,
    /// Between vertices: inside most solids.
    Inside,
    /// Each coordinate that of some vertex: in planes, on edges and corners of axis-aligned solids.
    Corner,
    /// Directional.
    Direction,
    /// Directional along an axis.
    Axis,
    /// Directional along an edge or in a face's plane.
    InPlane,
}

impl Place {
    /// A light for `mesh`, which has a face.
    pub(crate) fn draw(self, mesh: &Mesh, random: &mut SplitMix64) -> Light {
        let [low, high] = mesh.bounds().expect("a drawn mesh has a face");
        let bounds = Aabb { low, high };
        let p = match self {
            Self::Outside => {
                let size = 2.5 * bounds.diagonal();
                let center = bounds.center();
                rounded(center.map(|x| f64::from(x) + (2.0 * random.unit() - 1.0) * size))
            }
            Self::Far => {
                let [x, y, z] = [(); 3].map(|()| 2.0 * random.unit() - 1.0);
                let length = (x * x + y * y + z * z).sqrt();
                let way = if length > 0.0 { [x, y, z].map(|x| x / length) } else { [1.0, 0.0, 0.0] };
                let distance = bounds.diagonal() * 2_f64.powf(30.0 + 10.0 * random.unit());
                let center = bounds.center();
                rounded([0, 1, 2].map(|i| f64::from(center[i]) + distance * way[i]))
            }
            Self::Vertex => corners(mesh, random)[0],
            Self::Edge => edge(mesh, random),
            Self::Plane => plane(mesh, random),
            Self::UlpOff => {
                let place = [Self::Vertex, Self::Edge, Self::Plane][random.below(3)];
                one_ulp_off(place.draw(mesh, random).xyz(), random)
            }
            Self::Inside => {
                let face = corners(mesh, random);
                let (other, weight) = (corners(mesh, random)[0], 0.2 + 0.6 * random.unit());
                rounded([0, 1, 2].map(|i| {
                    let middle = face.iter().map(|p| f64::from(p[i]) / 3.0).sum::<f64>();
                    middle + weight * (f64::from(other[i]) - middle)
                }))
            }
            Self::Corner => [0, 1, 2].map(|i| corners(mesh, random)[0][i]),
            Self::Direction | Self::Axis | Self::InPlane => return self.direction(mesh, random),
        };
        Light::point(p).expect("finite")
    }

    fn direction(self, mesh: &Mesh, random: &mut SplitMix64) -> Light {
        let travel = match self {
            Self::Axis => [0.0; 3],
            Self::InPlane => {
                let face = corners(mesh, random).map(|p| p.map(f64::from));
                let weight = [0.0, 0.5, 1.0, -1.0][random.below(4)];
                let [a, b, c] = face;
                rounded([0, 1, 2].map(|i| (b[i] - a[i]) + weight * (c[i] - a[i])))
            }
            _ if random.below(8) == 0 => [(); 3].map(|()| bits(random)),
            _ => [(); 3].map(|()| (2.0 * random.unit() - 1.0) as f32),
        };
        // Along an axis, and where nothing came out.
        let mut axis = [0.0; 3];
        axis[random.below(3)] = if random.below(2) == 0 { 1.0 } else { -1.0 };
        Light::directional(travel).or_else(|_| Light::directional(axis)).expect("an axis is a direction")
    }
}

fn corners(mesh: &Mesh, random: &mut SplitMix64) -> [[f32; 3]; 3] {
    let mut face = mesh.triangles()[random.below(mesh.face_count())];
    face.rotate_left(random.below(3));
    face.map(|vertex| mesh.positions()[vertex as usize])
}

/// Each coordinate one ulp up, one down, or as it is; not all three as they are.
pub(crate) fn one_ulp_off(p: [f32; 3], random: &mut SplitMix64) -> [f32; 3] {
    // Three digits of base 3 without 111, which is no step.
    let mut digits = random.below(26);
    digits += usize::from(digits >= 13);
    [0, 1, 2].map(|i| {
        let x = match digits / 3_usize.pow(i) % 3 {
            0 if p[i as usize] > f32::MIN => p[i as usize].next_down(),
            2 if p[i as usize] == f32::MAX => f32::MAX.next_down(),
            0 | 2 => p[i as usize].next_up(),
            _ => p[i as usize],
        };
        x + 0.0 // not −0
    })
}

/// At an eighth of the edge, or beyond it.
fn edge(mesh: &Mesh, random: &mut SplitMix64) -> [f32; 3] {
    let [a, b, _] = corners(mesh, random).map(|p| p.map(f64::from));
    let t = match random.below(3) {
        0 => 0.5,
        1 => random.below(9) as f64 / 8.0,
        _ => random.below(33) as f64 / 8.0 - 1.5,
    };
    rounded([0, 1, 2].map(|i| a[i] + t * (b[i] - a[i])))
}

fn plane(mesh: &Mesh, random: &mut SplitMix64) -> [f32; 3] {
    let [a, b, c] = corners(mesh, random).map(|p| p.map(f64::from));
    let [u, v] = [(); 2].map(|()| random.below(41) as f64 / 8.0 - 2.0);
    rounded([0, 1, 2].map(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i])))
}
