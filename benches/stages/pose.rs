//! Poses of a skinned mesh, and what a light makes of them: silhouette and volume of each.

use umbrage::animate::Pose;
use umbrage::caster::Caster;
use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::Light;
use umbrage::mesh::{Weld, weld};
use umbrage::read::read_bytes;
use umbrage::scene::{Scene, Scope};
use umbrage::shadow::volume::{Caps, ShadowVolume};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;

use crate::measure::{Bench, Contender, Group, Sample, timed};

const STAGE: &str = "pose";

/// Joints of the chain that moves the mesh: as many as a game's figure has.
const JOINTS: usize = 24;

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants(STAGE) {
        return;
    }
    // Tubes of 4,704 and of 100,352 faces.
    for (along, around) in [(56, 42), (256, 196)] {
        let (along, around) = if bench.quick { (along / 4, around / 4) } else { (along, around) };
        stage(bench, along, around);
    }
}

fn stage(bench: &mut Bench<'_>, along: usize, around: usize) {
    let scene = scene(along, around);
    let light = Light::point([1.0, 9.0, 3.0]).expect("finite");
    let time = 0.7;
    let posed = |time: f64| {
        let scene = scene.pose(&Pose::at(time)).expect("it is well formed");
        scene.bake(Scope::Mesh).expect("in range").remove(0)
    };
    let rest = weld(&posed(0.0), Weld::Exact).mesh;
    assert_eq!(rest.positions().len(), posed(0.0).vertex_count(), "no vertex is there twice");
    // All faces cast: whether half of them may is a proof that each pose would need anew.
    let lit = |caster: &Caster| {
        let (mesh, topology) = (caster.mesh(), caster.topology());
        let signs = CasterFaces::All.signs(&classify(mesh, &light));
        let silhouette = Silhouette::extract(topology, &signs);
        let volume = ShadowVolume::extrude(mesh, topology, &light, &signs, &silhouette, Caps::Both);
        (silhouette.edges.len(), volume.triangles().len())
    };
    let answer = |(edges, triangles): &(usize, usize)| format!("{edges} edges, {triangles} triangles");
    // A caster made anew of the posed mesh.
    let expected = lit(&Caster::new(weld(&posed(time), Weld::Exact).mesh));
    let still = lit(&Caster::new(rest.clone()));
    assert_ne!(expected, still, "the pose is another");

    let faces = rest.face_count();
    let last = posed(time).positions()[along * around - 1];
    let place = |p: &[f32; 3]| format!("{p:?}");
    let mut caster = Caster::new(rest);
    assert!(caster.topology().edge_count() > 0, "the edge table is made before");
    let mut followed = caster.clone();
    caster.repose(posed(time).positions().to_vec()).expect("as many");
    let contenders = vec![
        Contender::new("pose", || timed(|| posed(time), |mesh| place(&mesh.positions()[along * around - 1])))
            .expects(place(&last)),
        Contender::new("silhouette and volume", || -> Sample {
            let mut caster = caster.clone();
            // The parts that depend on positions are made anew, as for each pose.
            let positions = caster.mesh().positions().to_vec();
            caster.repose(positions).expect("as many");
            timed(|| lit(&caster), answer)
        })
        .expects(answer(&expected)),
        Contender::new("pose, silhouette and volume", || {
            timed(
                || {
                    followed.repose(posed(time).positions().to_vec()).expect("as many");
                    lit(&followed)
                },
                answer,
            )
        })
        .expects(answer(&expected)),
    ];
    let mesh = format!("tube of {faces} faces, {JOINTS} joints, four a vertex");
    bench.run(Group { stage: STAGE, mesh, units: faces, unit: "face", contenders });
}

/// A torus that a chain of joints moves, four of them each vertex, as a GLB: bent at 1 s.
fn scene(along: usize, around: usize) -> Scene {
    let mesh = shapes::torus(along as u32, around as u32, 2.0, 0.7);
    let f32s = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let (mut bin, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |component: u32, shape: &str, count: usize, bytes: Vec<u8>| {
        let (start, length) = (bin.len(), bytes.len());
        views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length}}}"#));
        bin.extend(bytes);
        bin.resize(bin.len().next_multiple_of(4), 0);
        let view = views.len() - 1;
        accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":{component},"type":"{shape}","count":{count}}}"#
        ));
    };
    let vertices = mesh.vertex_count();
    let corners = mesh.triangles().as_flattened();
    add(5126, "VEC3", vertices, f32s(mesh.positions().as_flattened()));
    add(5125, "SCALAR", corners.len(), corners.iter().flat_map(|corner| corner.to_le_bytes()).collect());
    // Where along the chain a vertex is, by its x from -2.7 to 2.7.
    let at = |p: &[f32; 3]| ((p[0] / 5.4 + 0.5) * (JOINTS - 4) as f32).clamp(0.0, (JOINTS - 4) as f32);
    let joints = |p: &[f32; 3]| [0, 1, 2, 3].map(|k| at(p) as u8 + k);
    let weights = |p: &[f32; 3]| {
        let part = at(p).fract();
        [0.5 * (1.0 - part), 0.5, 0.5 * part, 0.0].map(|weight| weight * 0.9 + 0.025)
    };
    add(5121, "VEC4", vertices, mesh.positions().iter().flat_map(joints).collect());
    add(5126, "VEC4", vertices, f32s(&mesh.positions().iter().flat_map(weights).collect::<Vec<f32>>()));
    let inverse = |joint: usize| {
        let x = 2.7 - 0.225 * joint as f32;
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0]
    };
    add(5126, "MAT4", JOINTS, f32s(&(0..JOINTS).flat_map(inverse).collect::<Vec<f32>>()));
    add(5126, "SCALAR", 2, f32s(&[0.0, 1.0]));
    add(5126, "VEC4", 2, f32s(&[0.0, 0.0, 0.0, 1.0, 0.02, 0.0, 0.05, 1.0]));
    // Node 0 has the mesh; joint k is node k + 1, below the one before it.
    let node = |joint: usize| {
        let x = if joint == 0 { -2.7 } else { 0.225 };
        let child =
            if joint + 1 < JOINTS { format!(r#","children":[{}]"#, joint + 2) } else { String::new() };
        format!(r#"{{"translation":[{x},0,0]{child}}}"#)
    };
    let list = |items: Vec<String>| items.join(",");
    let nodes = list((0..JOINTS).map(node).collect());
    let names = list((1..=JOINTS).map(|node| node.to_string()).collect());
    let channel = |node: usize| format!(r#"{{"sampler":0,"target":{{"node":{node},"path":"rotation"}}}}"#);
    let channels = list((1..=JOINTS).map(channel).collect());
    let attributes = r#"{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3}"#;
    let (views, accessors, length) = (list(views), list(accessors), bin.len());
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0,"skin":0,"children":[1]}},{nodes}],
        "skins":[{{"joints":[{names}],"inverseBindMatrices":4}}],
        "meshes":[{{"primitives":[{{"attributes":{attributes},"indices":1}}]}}],
        "animations":[{{"samplers":[{{"input":5,"output":6}}],"channels":[{channels}]}}],
        "accessors":[{accessors}],"bufferViews":[{views}],"buffers":[{{"byteLength":{length}}}]}}"#
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((12 + 8 + json.len() as u32 + 8 + bin.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &bin)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    read_bytes(&glb, "tube.glb").unwrap_or_else(|error| panic!("{error}"))
}
