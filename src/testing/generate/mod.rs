//! Hard meshes, lights and points, drawn from any source of choices: written once, for the torture, for
//! proptest and for the fuzz targets.
//!
//! A generator asks a [`Draw`] for one small choice after another. Each choice is ordered so that 0 is the
//! simplest one. A stream of zeros therefore gives the simplest mesh, and whoever makes choices smaller makes
//! the mesh simpler. Three sources exist: random numbers (the torture), [`Bytes`] (the fuzz targets), and
//! recorded choices that proptest shrinks ([`strategy`](super::strategy)).
//!
//! ```
//! use umbrage::testing::generate::{Bytes, Draw, light, mesh, point};
//!
//! // No bytes, so all choices are 0: a tetrahedron, a light at the origin.
//! let mut bytes = Bytes::new(&[]);
//! let mesh = mesh(&mut bytes);
//! let light = light(&mut bytes, &mesh);
//! assert_eq!((mesh.face_count(), light.to_string().as_str()), (4, "point:0,0,0"));
//! assert_eq!(point(&mut bytes, &mesh, &light), [0.0; 3]);
//! ```

mod bytes;
mod damage;
mod light;
mod mesh;
mod scale;
mod solid;

#[cfg(test)]
mod tests;

pub use crate::random::Draw;
pub use crate::verify::points::sampler::point;
pub use bytes::Bytes;
pub use damage::Damage;
pub use light::light;
pub use mesh::mesh;

pub(crate) use damage::damage;
pub(crate) use light::{LightKind, moderate_light};
pub(crate) use mesh::{Draft, Shape, faces};
pub(crate) use scale::{Scale, power_of_two};
pub(crate) use solid::{bent, cad, closed, hollow, several, voxel_solid};

/// A position, often on the grid of integers, whose coordinates may be any finite `f32`: next to an integer,
/// tiny, huge, or of any bits.
pub fn position(draw: &mut dyn Draw) -> [f32; 3] {
    [(); 3].map(|()| {
        let (kind, near) = (draw.below(16), draw.coordinate());
        match kind {
            0..=10 => near,
            11 => near.next_up(),
            12 => near.next_down(),
            13 => near * 1e-40,
            14 => near * 8e37,
            _ => draw.bits(),
        }
    })
}
