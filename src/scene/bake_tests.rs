//! Placing instances: what a transform does to the winding.

use glam::Mat4;

use super::{Instance, Scene, Scope};
use crate::testing::shapes;

#[test]
fn a_mirrored_instance_turns_its_faces_however_small_it_is() {
    let cube = shapes::cube();
    // Determinants from −10⁻³⁶ to −10³⁶, all normal in `f64`; and the same without the mirror.
    for scale in [1e-12_f32, 1e-6, 1.0, 1e6, 1e12] {
        for (mirror, is_turned) in [([1.0, 1.0, 1.0], false), ([-1.0, 1.0, 1.0], true), ([-1.0; 3], true)] {
            let world_from_mesh = Mat4::from_scale((glam::Vec3::from(mirror) * scale).to_array().into());
            let instance = Instance { mesh: 0, name: String::new(), world_from_mesh };
            let scene = Scene { instances: vec![instance], ..Scene::of(cube.clone()) };
            let placed = scene.bake(Scope::Mesh).unwrap().remove(0);
            for (was, is) in cube.triangles().iter().zip(placed.triangles()) {
                let expected = if is_turned { [was[0], was[2], was[1]] } else { *was };
                assert_eq!(*is, expected, "{mirror:?} times {scale}");
            }
        }
    }
}
