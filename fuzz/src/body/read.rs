//! Bytes to a scene, or to an error of one line; what was read goes through every stage and every writer.

use umbrage::animate::Pose;
use umbrage::check::CrackReport;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::read::read_bytes;
use umbrage::scene::{Scene, Scope};
use umbrage::topology::Topology;
use umbrage::write::{Layer, Model, Target, to_bytes};

/// More faces or vertices than this come only from instances of instances, and are left alone.
const MOST: usize = 50_000;

pub(crate) fn run(data: &[u8], name: &str) {
    match read_bytes(data, name) {
        Ok(scene) => judge(scene),
        Err(error) => is_one_line(&error.to_string(), name),
    }
}

/// Panics unless an error is one line that begins with `name` and has a problem and a remedy.
pub(crate) fn is_one_line(error: &str, name: &str) {
    assert!(error.starts_with(name) && error.contains("; "), "{error:?}");
    assert!(!error.chars().any(char::is_control), "{error:?}");
}

fn judge(scene: Scene) {
    assert!(scene.format.is_some());
    assert!(scene.instances.iter().all(|instance| instance.mesh < scene.meshes.len()));
    let placed = |size: fn(&Mesh) -> usize| -> usize {
        scene.instances.iter().map(|instance| size(&scene.meshes[instance.mesh])).sum()
    };
    let (faces, vertices) = (placed(Mesh::face_count), placed(Mesh::vertex_count));
    if faces.max(vertices) > MOST {
        return;
    }
    poses(&scene);
    for scope in [Scope::Primitive, Scope::Mesh, Scope::Scene] {
        let meshes = match scene.clone().bake(scope) {
            Ok(meshes) => meshes,
            Err(error) => {
                assert!(!error.to_string().contains(char::is_control), "{error}");
                continue;
            }
        };
        assert_eq!(meshes.iter().map(Mesh::face_count).sum::<usize>(), faces);
        for mesh in &meshes {
            for how in [Weld::Exact, Weld::None, Weld::Within(0.01)] {
                let welded = weld(mesh, how).mesh;
                assert_eq!(welded.face_count(), mesh.face_count());
                let topology = Topology::of(&welded);
                topology.validate();
                if how == Weld::Exact {
                    let report = CrackReport::of(&welded, &topology);
                    assert_eq!(report.counts.faces, mesh.face_count());
                }
            }
        }
        if let ([mesh], Scope::Scene, true) = (&meshes[..], scope, faces > 0) {
            reads_back(mesh);
        }
    }
}

/// Panics unless a pose is an error of one line, or has the faces of the scene and the same vertices at every
/// time.
fn poses(scene: &Scene) {
    for clip in 0..scene.rig.clips().len().clamp(1, 4) {
        let mut first: Option<Vec<Mesh>> = None;
        for time in [0.0, 0.4, -1.0, 1e9] {
            let clip = (!scene.rig.clips().is_empty()).then_some(clip);
            let meshes = match scene.pose(&Pose { clip, ..Pose::at(time) }) {
                Ok(posed) => posed.bake(Scope::Scene),
                Err(error) => {
                    assert!(!error.to_string().contains('\n') && !error.remedy().is_empty(), "{error}");
                    continue;
                }
            };
            let Ok(meshes) = meshes else { continue };
            let welded: Vec<Mesh> = meshes.iter().map(|mesh| weld(mesh, Weld::Exact).mesh).collect();
            let first = first.get_or_insert_with(|| welded.clone());
            for (mesh, first) in welded.iter().zip(first) {
                assert_eq!(mesh.face_count(), first.face_count());
                assert_eq!(mesh.vertex_count(), first.vertex_count());
            }
        }
    }
}

/// Panics unless every writer's file reads back to the same bits.
fn reads_back(mesh: &Mesh) {
    let model = Model { layers: vec![Layer::from(mesh)] };
    for (target, name) in [(Target::Obj, "b.obj"), (Target::Ply, "b.ply"), (Target::Glb, "b.glb")] {
        let bytes = to_bytes(&model, target).unwrap_or_else(|error| panic!("{error}"));
        let scene = read_bytes(&bytes, name).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.format.map(umbrage::read::Format::name), Some(&name[2..]));
        is_same(mesh, &scene.meshes, name);
    }
}

/// Panics unless `read` is `mesh` alone, bit for bit.
pub(crate) fn is_same(mesh: &Mesh, read: &[Mesh], name: &str) {
    assert_eq!(read.len(), 1, "{name}");
    let bits = |mesh: &Mesh| mesh.positions().iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(&read[0]), bits(mesh), "{name}");
    assert_eq!(read[0].triangles(), mesh.triangles(), "{name}");
}
