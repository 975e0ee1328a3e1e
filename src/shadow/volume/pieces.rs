//! The connected pieces of a volume, with the boxes of their casting faces.

use super::ShadowVolume;
use crate::geom::Aabb;
use crate::mesh::Mesh;
use crate::topology::Components;

/// The pieces of a volume: triangles of different pieces share no vertex of the caster. So each piece is
/// closed if the volume is, and its winding number is 0 outside of the shadow of its box.
#[derive(Clone, Debug)]
pub(in crate::shadow) struct VolumePieces {
    /// The piece of each triangle of the volume.
    pub(in crate::shadow) of_triangle: Vec<u32>,
    /// The box around the casting faces of each piece.
    pub(in crate::shadow) boxes: Vec<Aabb>,
}

impl VolumePieces {
    /// The pieces of the volume of the faces whose sign is not 0, in the order of their first vertex. The
    /// volume may lack its caps.
    pub(in crate::shadow) fn of(mesh: &Mesh, signs: &[i8], volume: &ShadowVolume) -> Self {
        let casting = || mesh.triangles().iter().zip(signs).filter(|(_, sign)| **sign != 0);
        let mut components = Components::new(mesh.vertex_count());
        for (&[a, b, c], _) in casting() {
            components.join(a, b);
            components.join(b, c);
        }
        let mut casts = vec![false; mesh.vertex_count()];
        casting().flat_map(|(corners, _)| corners).for_each(|&v| casts[v as usize] = true);
        let (number_of, count) = components.number(|vertex| casts[vertex as usize]);
        let mut boxes = vec![Aabb::EMPTY; count];
        for (vertex, number) in number_of.iter().enumerate() {
            if let Some(number) = number {
                let p = mesh.positions()[vertex];
                let own = &mut boxes[*number as usize];
                *own = own.join(&Aabb { low: p, high: p });
            }
        }
        let piece = |triangle: &[u32; 3]| {
            let vertex = triangle.iter().find_map(|&corner| volume.finite_vertex(corner));
            let caster = vertex.map(|vertex| volume.casters()[vertex as usize]);
            caster.and_then(|caster| number_of[caster.index()]).unwrap_or(0)
        };
        let of_triangle = volume.triangles().iter().map(piece).collect();
        Self { of_triangle, boxes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::geom::Light;
    use crate::shadow::volume::{Caps, closed};
    use crate::testing::shapes;

    #[test]
    fn pieces_are_closed_and_their_boxes_hold_what_casts() {
        let meshes = [shapes::cube(), shapes::translated(&shapes::mobius(12), [9.0, 0.0, 0.0])];
        let caster = Caster::new(Mesh::concat(&meshes).unwrap());
        for light in ["point:3,4,5", "directional:-1,-2,-0.5"] {
            let light: Light = light.parse().unwrap();
            let signs = caster.shell_faces(&light, None).signs(caster.shells(), &caster.facing(&light));
            let volume = caster.volume_of_signs(&light, &signs, Caps::Both);
            let pieces = VolumePieces::of(caster.mesh(), &signs, &volume);
            assert_eq!(pieces.boxes.len(), 2);
            for (piece, aabb) in (0..).zip(&pieces.boxes) {
                let own = volume.triangles().iter().zip(&pieces.of_triangle);
                let own: Vec<[u32; 3]> = own.filter(|(_, of)| **of == piece).map(|(own, _)| *own).collect();
                assert!(own.len() > 10 && closed::boundary_sum(&own).is_closed(), "{piece}");
                let finite = own.iter().flatten().filter_map(|&corner| volume.finite_vertex(corner));
                assert!(finite.into_iter().all(|vertex| aabb.contains(volume.positions()[vertex as usize])));
            }
            // Without caps the boxes still hold the faces.
            let sides = caster.volume_of_signs(&light, &signs, Caps::None);
            assert_eq!(VolumePieces::of(caster.mesh(), &signs, &sides).boxes, pieces.boxes);
        }
    }
}
