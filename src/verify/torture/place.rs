//! Where the light is.

use super::shape::bits;
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::verify::point::{nudged, rounded};

/// A kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// A point in a box five times as large.
    Outside,
    /// On a vertex.
    Vertex,
    /// At the middle or another point of an edge, or of its line.
    Edge,
    /// In the plane of a face, inside or outside it.
    Plane,
    /// Off one of these three by an ulp in one or more coordinates.
    UlpOff,
    /// 2⁴⁰ diagonals away, as far as `f32` goes.
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
    pub(super) fn draw(self, mesh: &Mesh, random: &mut SplitMix64) -> Light {
        let [low, high] = mesh.bounds().expect("a drawn mesh has a face");
        let bounds = Aabb { low, high };
        let p = match self {
            Self::Outside => {
                let size = 2.5 * bounds.diagonal();
                let centre = bounds.centre();
                rounded(centre.map(|x| f64::from(x) + (2.0 * random.unit() - 1.0) * size))
            }
            Self::Far => {
                let size = bounds.diagonal() * 2_f64.powi(40);
                rounded([(); 3].map(|()| (2.0 * random.unit() - 1.0) * size))
            }
            Self::Vertex => corners(mesh, random)[0],
            Self::Edge => edge(mesh, random),
            Self::Plane => plane(mesh, random),
            Self::UlpOff => {
                let place = [Self::Vertex, Self::Edge, Self::Plane][random.below(3)];
                nudged(place.draw(mesh, random).xyz().map(f64::from), random)
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
