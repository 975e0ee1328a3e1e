//! Peak bytes a face of each stage, in memory that the caller does not hold already.

use umbrage::caster::{Caster, ShellBoxes, ShellProof};
use umbrage::check::{CrackReport, DefectKind};
use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::geom::Light;
use umbrage::geom::bvh::Bvh;
use umbrage::mesh::{Weld, weld, weld_in_place};
use umbrage::oracle::Oracle;
use umbrage::shadow::stencil::max_depth_complexity;
use umbrage::shadow::volume::{Caps, FrameExtruder, ShadowVolume, ShellFaces, WindingIndex};
use umbrage::silhouette::Silhouette;
use umbrage::topology::Topology;

use super::{alone, inputs, peak};

/// What the documentation of each stage allows: bytes a face (of the caster; of the volume for what reads one).
const BOUNDS: [(&str, usize); 21] = [
    ("weld", 150),
    ("weld in place", 140),
    ("weld within", 400),
    ("edge table", 120),
    ("survey", 120),
    ("shells", 12),
    ("crack report", 700),
    ("items", 100),
    ("tree", 100),
    ("proofs", 700),
    ("planes", 28),
    ("classify", 1),
    ("plan", 24),
    ("frame", 230),
    ("silhouette", 72),
    ("volume", 60),
    ("certificate", 48),
    ("layers", 800),
    ("shell boxes", 160),
    ("oracle", 128),
    ("winding", 2300),
];

/// What does not depend on the mesh.
const CONSTANT: usize = 1 << 20;

fn bound(stage: &str) -> usize {
    BOUNDS.iter().find(|(name, _)| *name == stage).expect("a bound for each stage").1
}

/// What it promises of an ordinary closed mesh, besides.
const ORDINARY: [(&str, usize); 8] = [
    ("weld", 24),
    ("weld in place", 20),
    ("edge table", 41),
    ("survey", 40),
    ("shells", 8),
    ("crack report", 12),
    ("proofs", 129),
    ("layers", 125),
];

/// An extruder that has followed a light, and so has made all that it makes.
fn frame(caster: &Caster, light: &Light) -> FrameExtruder {
    let mut extruder = FrameExtruder::new(caster, Some(CasterFaces::All));
    let [x, y, z] = light.xyz();
    for step in 0..3_u8 {
        let light = Light::point([x, y, z + f32::from(step) * 1e-5]).unwrap();
        let _ = extruder.write(caster, &light, Caps::Both, &mut []);
    }
    extruder
}

#[test]
fn memory_of_every_stage_is_what_its_documentation_says() {
    let _alone = alone();
    let light = Light::point([3.1, 7.3, 11.7]).unwrap();
    let mut beyond = Vec::new();
    for (name, mesh) in inputs::all() {
        let mut line = Vec::new();
        let mut note = |stage: &'static str, units: usize, bytes: usize| {
            line.push(format!("{stage} {:.1}", bytes as f64 / units as f64));
            let ordinary = ORDINARY.iter().find(|(other, _)| *other == stage && name.ends_with("sphere"));
            let bound = ordinary.map_or(bound(stage), |(_, bound)| *bound);
            if bytes > CONSTANT / 16 + bound * units {
                beyond.push(format!("{name}: {stage}: {} bytes a face", bytes / units));
            }
        };
        let faces = mesh.face_count();
        note("weld", faces, peak(|| weld(&mesh, Weld::Exact)).1);
        let copy = mesh.clone();
        note("weld in place", faces, peak(|| weld_in_place(copy, Weld::Exact)).1);
        note("weld within", faces, peak(|| weld(&mesh, Weld::Within(1e-6))).1);
        let triangles = mesh.triangles().to_vec();
        let table = peak(|| Topology::build(mesh.vertex_count(), triangles.clone())).1;
        note("edge table", faces, table - 12 * faces); // the copy
        let topology = Topology::build(mesh.vertex_count(), triangles);
        note("survey", faces, peak(|| topology.non_manifold_vertices()).1);
        let (shells, bytes) = peak(|| topology.shells());
        note("shells", faces, bytes);
        let (report, bytes) = peak(|| CrackReport::of(&mesh, &topology));
        note("crack report", faces, bytes);
        let places = || DefectKind::ALL.map(|kind| report.items(kind, &mesh, &topology, 5));
        note("items", faces, peak(places).1);
        drop(report);
        let boxes: Vec<_> =
            topology.faces().map(|face| umbrage::geom::Aabb::around(mesh.corners(face))).collect();
        note("tree", faces, peak(|| Bvh::build(&boxes)).1);
        drop(boxes);
        let (proofs, bytes) = peak(|| ShellProof::of(&mesh, &topology, &shells));
        note("proofs", faces, bytes);
        let (planes, bytes) = peak(|| FacePlanes::new(&mesh));
        note("planes", faces, bytes);
        drop(planes);
        let (facing, bytes) = peak(|| classify(&mesh, &light));
        note("classify", faces, bytes);
        let (boxes, bytes) = peak(|| ShellBoxes::new(&mesh, &shells));
        note("shell boxes", faces, bytes);
        let (plan, bytes) = peak(|| ShellFaces::choose(&mesh, &boxes, &proofs, &light, None));
        note("plan", faces, bytes);
        let signs = plan.signs(&shells, &facing);
        let (silhouette, bytes) = peak(|| Silhouette::extract(&topology, &signs));
        note("silhouette", faces, bytes);
        let (volume, bytes) =
            peak(|| ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both));
        note("volume", faces + volume.triangles().len(), bytes);
        note("certificate", volume.triangles().len().max(1), peak(|| volume.boundary_sum()).1);
        note("layers", faces, peak(|| max_depth_complexity(&mesh, &signs, &light, 256)).1);
        let caster = Caster::new(mesh.clone());
        let _ = (caster.planes(), caster.topology(), caster.shell_boxes());
        note("frame", faces, peak(|| frame(&caster, &light)).1);
        let (oracle, bytes) = peak(|| Oracle::build(&mesh));
        note("oracle", faces, bytes);
        let index = peak(|| WindingIndex::build(&volume, oracle.bounds())).1;
        note("winding", volume.triangles().len().max(1), index);
        eprintln!("{name}, {faces} faces: {}", line.join(", "));
    }
    assert!(beyond.is_empty(), "{}", beyond.join("\n"));
}
