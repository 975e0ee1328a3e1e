//! The counts that eight bits of a stencil are trusted with.

use super::{Counting, StencilVolumes};
use crate::caster::Caster;
use crate::mesh::Mesh;
use crate::view::{Projection, ProjectionKind};

/// The stencil volumes of `count` triangles, one above the other, all casting.
fn of_a_stack(count: u32) -> StencilVolumes {
    let corners = |z: f32| [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]];
    let positions = (0..count).flat_map(|layer| corners(layer as f32)).collect();
    let triangles = (0..count).map(|layer| [3 * layer, 3 * layer + 1, 3 * layer + 2]).collect();
    let caster = Caster::new(Mesh::new(positions, triangles).unwrap());
    let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    let camera =
        Projection { eye: [9.0, 0.0, 0.5], right, up, forward, near: 0.1, kind: ProjectionKind::default() };
    caster.stencil_volumes(&"directional:0,0,1".parse().unwrap(), &camera, None, None)
}

#[test]
fn eight_bits_count_255_faces_and_not_one_more() {
    // A ray along the light crosses all of them: 256 would wrap to 0, which is lit.
    for (count, counting) in [(255, Counting::Stencil), (256, Counting::Integer), (257, Counting::Integer)] {
        let volumes = of_a_stack(count);
        assert_eq!(volumes.counting(), counting, "{count} faces: {:?}", volumes.layers);
        assert!(volumes.layers.at_most() >= count, "{count} faces: {:?}", volumes.layers);
    }
}
