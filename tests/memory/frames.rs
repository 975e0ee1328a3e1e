//! A frame loop allocates nothing once its buffers have grown.

use umbrage::caster::Caster;
use umbrage::facing::CasterFaces;
use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::shadow::volume::{Caps, ExtrudeInput, Extruder, FrameExtruder, ShellFaces};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;

use super::{MEMORY, alone, peak};

/// Laps before memory is measured: a lap may follow by certificates where the one before searched.
const WARM: usize = 4;

/// Small steps through the middle of a mesh, a jump, small steps again, a directional light.
fn lap(mesh: &Mesh) -> Vec<Light> {
    let [low, high] = mesh.bounds().unwrap();
    let at = |part: [f32; 3]| Light::point([0, 1, 2].map(|i| low[i] + part[i] * (high[i] - low[i]))).unwrap();
    let through = (0..40).map(|i| at([0.3 + 0.01 * i as f32, 0.6, 0.4]));
    let above = (0..40).map(|i| at([0.3 + 1e-4 * i as f32, 3.0, 0.4]));
    let sun = Light::directional([1.0, -2.0, 0.3]).unwrap();
    through.chain(above).chain([sun]).collect()
}

fn meshes() -> [Mesh; 4] {
    let boxes: Vec<Mesh> = (0..400_u16)
        .map(|i| {
            let at = [2.0 * f32::from(i % 20), f32::from(i % 3), 2.0 * f32::from(i / 20)];
            shapes::translated(&shapes::cuboid([0.0; 3], [1.0, 0.5 + f32::from(i % 5), 1.3]), at)
        })
        .collect();
    let boxes = Mesh::concat(&boxes).unwrap();
    let torus = shapes::torus(120, 80, 2.0, 0.7);
    let open = shapes::translated(&shapes::sheet(30), [0.0, 5.0, 0.0]);
    [Mesh::concat(&[torus.clone(), open]).unwrap(), torus, boxes, shapes::soup(&shapes::icosphere(2))]
}

/// Whether some lap after the first ones takes no memory: other threads of the test harness may take some in
/// one of them.
fn is_free_of_allocations(mut lap: impl FnMut()) -> bool {
    (0..WARM).for_each(|_| lap());
    (0..5).any(|_| {
        let before = MEMORY.current_usage();
        let ((), bytes) = peak(&mut lap);
        bytes == 0 && MEMORY.current_usage() == before
    })
}

#[test]
fn memory_of_a_frame_loop_is_taken_once() {
    let _alone = alone();
    for mesh in meshes() {
        let lights = lap(&mesh);
        let caster = Caster::new(mesh);
        for asked in [None, Some(CasterFaces::All)] {
            let mut extruder = FrameExtruder::new(&caster, asked);
            let mut buffer = vec![[0; 3]; 8 * caster.mesh().face_count()];
            assert!(
                is_free_of_allocations(|| {
                    for light in &lights {
                        for caps in [Caps::None, Caps::Both] {
                            let frame = extruder.write(&caster, light, caps, &mut buffer).unwrap();
                            assert!(frame.dark_cap().count() <= frame.light_cap.len());
                        }
                    }
                }),
                "{} {asked:?}",
                caster.mesh().name
            );
        }
    }
}

#[test]
fn memory_of_a_frame_by_its_parts_is_taken_once() {
    let _alone = alone();
    let caster = Caster::new(Mesh::concat(&meshes()[1..3]).unwrap());
    let (mesh, topology) = (caster.mesh(), caster.topology());
    let lights = lap(mesh);
    let mut faces = ShellFaces::default();
    let (mut facing, mut signs, mut masks) = (Vec::new(), Vec::new(), Vec::new());
    let (mut silhouette, mut extruder) = (Silhouette::default(), Extruder::new(topology));
    let mut buffer = vec![[0; 3]; 8 * mesh.face_count()];
    assert!(is_free_of_allocations(|| {
        for light in &lights {
            caster.shell_faces_into(light, None, &mut faces);
            caster.planes().classify_into(mesh, light, &mut facing);
            faces.signs_into(caster.shells(), &facing, &mut signs);
            faces.masks_into(caster.shells(), &mut masks);
            silhouette.extract_into(topology, &signs);
            let (silhouette, caps) = (&silhouette, Caps::Both);
            let input = ExtrudeInput { mesh, topology, light, signs: &signs, silhouette, caps };
            extruder.write_indices(&input, &mut buffer).unwrap();
        }
    }));
}

#[test]
fn memory_of_a_frame_that_allocates_is_seen() {
    let _alone = alone();
    let caster = Caster::new(shapes::icosphere(3));
    let light = Light::point([3.0, 4.0, 5.0]).unwrap();
    // The fault injected: choices in new memory, let go of at once; and kept.
    assert!(!is_free_of_allocations(|| drop(caster.shell_faces(&light, None))));
    let mut kept = Vec::new();
    assert!(!is_free_of_allocations(|| kept.push(caster.shell_faces(&light, None))));
}
