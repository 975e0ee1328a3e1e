//! No depth of recursion is in the hands of the input: all stages run on a small stack, whatever comes.
//!
//! `UMBRAGE_STACK_KIB` sets its size, to find the smallest that holds.

use std::thread;

use umbrage::caster::{ShellBoxes, ShellProof};
use umbrage::check::{CrackReport, DefectKind};
use umbrage::facing::FacePlanes;
use umbrage::geom::bvh::Bvh;
use umbrage::geom::{Aabb, Light, Segment};
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::Oracle;
use umbrage::read::read_bytes;
use umbrage::scene::Scope;
use umbrage::shadow::stencil::max_depth_complexity;
use umbrage::shadow::volume::{Caps, ShadowVolume, ShellFaces, WindingIndex};
use umbrage::silhouette::Silhouette;
use umbrage::topology::Topology;

use super::{alone, inputs};

const STACK_KIB: usize = 128;
/// The JSON parser allows 128 levels, which take more than all else.
const JSON_STACK_KIB: usize = 256;

/// Runs `work` on a thread with a small stack. An overflow ends the program, and so the test.
fn on_a_small_stack<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    on_a_stack(STACK_KIB, work)
}

fn on_a_stack<T: Send + 'static>(kib: usize, work: impl FnOnce() -> T + Send + 'static) -> T {
    let asked = std::env::var("UMBRAGE_STACK_KIB").ok().and_then(|size| size.parse().ok());
    let size = asked.unwrap_or(kib) << 10;
    thread::Builder::new().stack_size(size).spawn(work).unwrap().join().unwrap()
}

/// Every stage on one mesh.
fn all_stages(mesh: &Mesh) {
    let light = Light::point([3.1, 7.3, 11.7]).unwrap();
    let _ = (weld(mesh, Weld::Exact), weld(mesh, Weld::Within(1e-4)));
    let topology = Topology::of(mesh);
    let shells = topology.shells();
    let report = CrackReport::of(mesh, &topology);
    let _ = DefectKind::ALL.map(|kind| report.items(kind, mesh, &topology, 2));
    let proofs = ShellProof::of(mesh, &topology, &shells);
    let plan = ShellFaces::choose(mesh, &ShellBoxes::new(mesh, &shells), &proofs, &light, None);
    let signs = plan.signs(&shells, &FacePlanes::new(mesh).classify(mesh, &light));
    let silhouette = Silhouette::extract(&topology, &signs);
    let _ = silhouette.loops(&topology);
    let volume = ShadowVolume::extrude(mesh, &topology, &light, &signs, &silhouette, Caps::Both);
    assert!(volume.boundary_sum().is_closed());
    let _ = (max_depth_complexity(mesh, &signs, &light, 256), ShellBoxes::new(mesh, &shells));
    let oracle = Oracle::build(mesh);
    let winding = WindingIndex::build(&volume, oracle.bounds());
    let p = oracle.bounds().center();
    let _ =
        (oracle.crossings(p, &light), oracle.first_visible([9.0, 9.0, 9.0], [-1.0; 3]), winding.number(p));
}

#[test]
fn stack_of_every_stage_is_small_on_every_shape() {
    let _alone = alone();
    for (name, mesh) in inputs::all() {
        eprintln!("{name}");
        on_a_small_stack(move || all_stages(&mesh));
    }
    on_a_small_stack(|| all_stages(&Mesh::new(vec![], vec![]).unwrap()));
}

/// Boxes that each reach twice as far as the one before, over all of `f32`: a tree by area takes one from the rest at
/// a time.
fn geometric(per_octave: u32) -> Vec<Aabb> {
    let exponents = (0..270 * per_octave).map(|i| f64::from(i) / f64::from(per_octave) - 145.0);
    exponents.map(|e| Aabb { low: [0.0; 3], high: [e.exp2() as f32; 3] }).collect()
}

#[test]
fn stack_of_a_tree_is_small_however_deep_it_could_be() {
    let _alone = alone();
    let point = |x: f32| Aabb { low: [x; 3], high: [x; 3] };
    for boxes in [
        geometric(1),
        geometric(400),
        vec![point(1.0); 1_000_000],
        (0..300_000).map(|i| point((i as f32) * (i as f32))).collect(),
        (0..200_000).map(|i| Aabb { low: [-(i as f32); 3], high: [i as f32; 3] }).collect(),
    ] {
        let count = boxes.len();
        let found = on_a_small_stack(move || {
            let bvh = Bvh::build(&boxes);
            let mut found = 0;
            bvh.for_each_overlapping(&bvh.bounds(), |_| found += 1);
            bvh.for_each_along(&Segment::between([0.0; 3], [1.0; 3]), |_| {});
            found
        });
        assert_eq!(found, count);
    }
}

#[test]
fn stack_of_many_faces_around_one_vertex_is_small() {
    let _alone = alone();
    on_a_small_stack(|| {
        let mesh = inputs::fan(200_000);
        let topology = Topology::of(&mesh);
        let report = CrackReport::of(&mesh, &topology);
        assert_eq!((report.counts.shells, report.counts.boundary_loops), (1, 1));
        assert!(report.counts.non_manifold_vertices == 0 && report.t_junctions_complete);
    });
}

#[test]
fn stack_of_a_deep_scene_is_small() {
    let _alone = alone();
    let deep = 100_000;
    let links =
        |i: u32| if i + 1 < deep { format!(r#"{{"children":[{}]}}"#, i + 1) } else { r#"{"mesh":0}"#.into() };
    let nodes: Vec<String> = (0..deep).map(links).collect();
    let accessor = r#"{"componentType":5126,"type":"VEC3","count":3}"#;
    let file = format!(
        r#"{{"asset":{{"version":"2.0"}},"accessors":[{accessor}],"nodes":[{}],"scenes":[{{"nodes":[0]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]}}"#,
        nodes.join(",")
    );
    let cycle = file.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"children":[7]}"#);
    on_a_stack(JSON_STACK_KIB, move || {
        let scene = read_bytes(file.as_bytes(), "deep.gltf").unwrap();
        assert_eq!(scene.bake(Scope::Mesh).unwrap()[0].face_count(), 1);
        assert!(read_bytes(cycle.as_bytes(), "cycle.gltf").is_err());
        // Brackets in brackets: the JSON parser has a limit of its own.
        for open in ["[", r#"{"a":"#] {
            let text = format!(r#"{{"asset":{}"#, open.repeat(1_000_000));
            assert!(read_bytes(text.as_bytes(), "brackets.gltf").is_err());
        }
    });
}

#[test]
fn stack_that_is_too_small_would_be_seen() {
    /// The sabotage: recursion as deep as the input is long.
    fn depth(bytes: &[u8]) -> usize {
        std::hint::black_box([0_u8; 64]);
        bytes.split_first().map_or(0, |(_, rest)| std::hint::black_box(1 + depth(rest)))
    }
    const ASKED: &str = "UMBRAGE_STACK_SABOTAGE";
    if std::env::var_os(ASKED).is_some() {
        on_a_small_stack(|| depth(&vec![0; 10_000_000]));
        return;
    }
    // An overflow ends the program: so another one.
    let name = "stack::stack_that_is_too_small_would_be_seen";
    let program = std::env::current_exe().unwrap();
    let run = std::process::Command::new(program).args([name, "--exact"]).env(ASKED, "1").output().unwrap();
    assert!(!run.status.success() && String::from_utf8_lossy(&run.stderr).contains("overflow"), "{run:?}");
}
