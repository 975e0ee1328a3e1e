//! Silhouette and volume.

use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::Light;
use umbrage::mesh::{EdgeId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::shadow::volume::{Caps, ExtrudeInput, Extruder, ShadowVolume, WindingIndex};
use umbrage::silhouette::Silhouette;
use umbrage::topology::Topology;

use crate::measure::{Bench, Contender, Group, Scatter, Target, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if ["silhouette", "volume"].iter().any(|stage| bench.wants(stage)) {
        for mesh in [crate::ordered(bench.quick), crate::scattered(bench.quick)] {
            silhouette_and_volume(bench, &mesh);
        }
    }
    if bench.wants("winding") {
        winding(bench);
    }
}

fn light() -> Light {
    Light::point([3.0, 4.0, 5.0]).expect("finite")
}

fn silhouette_and_volume(bench: &mut Bench<'_>, mesh: &Mesh) {
    let light = light();
    let topology = Topology::of(mesh);
    let facing = classify(mesh, &light);
    let signs = CasterFaces::All.signs(&facing);
    let silhouette = Silhouette::extract(&topology, &signs);
    let units = topology.edge_count();
    let name = mesh.name.clone();
    if bench.wants("silhouette") {
        let pairs = textbook(&topology);
        let expected = format!("edges={}", silhouette.edges.len());
        let mut kept = Silhouette::default();
        let contenders = vec![
            Contender::new("two faces an edge", || {
                timed(|| changes(&pairs, &signs), |edges| format!("edges={}", edges.len()))
            })
            .expects(&*expected)
            .moves(8.0 + 2.0 / 3.0),
            Contender::new("Silhouette::extract_into", || {
                let sample = timed(
                    || kept.extract_into(&topology, &signs),
                    |()| format!("edges={}", silhouette.edges.len()),
                );
                assert!(kept == silhouette);
                sample
            })
            .expects(&*expected)
            .moves(4.0 + 8.0 + 2.0 / 3.0),
            Contender::new("Silhouette::extract", || {
                timed(
                    || Silhouette::extract(&topology, &signs),
                    |found| {
                        assert!(*found == silhouette);
                        format!("edges={}", found.edges.len())
                    },
                )
            })
            .expects(&*expected)
            // Reads an offset, two entries of 4 and two thirds of a sign.
            .moves(4.0 + 8.0 + 2.0 / 3.0)
            .aims_at(Target::Time(1.0)),
        ];
        bench.run(Group { stage: "silhouette", mesh: name.clone(), units, unit: "edge", contenders });
    }
    if bench.wants("volume") {
        for (casters, which) in [(CasterFaces::All, "all faces"), (CasterFaces::Front, "front faces")] {
            let signs = casters.signs(&facing);
            let silhouette = Silhouette::extract(&topology, &signs);
            let caps = Caps::Both;
            let cast = ExtrudeInput {
                mesh,
                topology: &topology,
                light: &light,
                signs: &signs,
                silhouette: &silhouette,
                caps,
            };
            volume(bench, format!("{name} · {which}"), &cast);
        }
    }
}

fn volume(bench: &mut Bench<'_>, name: String, cast: &ExtrudeInput<'_>) {
    let ExtrudeInput { mesh, topology, light, signs, silhouette, caps } = *cast;
    let extrude = || ShadowVolume::extrude(mesh, topology, light, signs, silhouette, caps);
    let volume = extrude();
    assert!(volume.boundary_sum().is_closed());
    // Each casting face appears in both caps. On a closed mesh each silhouette edge sweeps its quad |m|
    // times, m its multiplicity.
    let triangles = volume.triangles().len();
    let casting = signs.iter().filter(|&&sign| sign != 0).count();
    let multiplicities: u32 = silhouette.edges.iter().map(|edge| edge.multiplicity.unsigned_abs()).sum();
    assert_eq!(triangles, 2 * casting + 2 * multiplicities as usize);
    let mut extruder = Extruder::new(topology);
    let mut writer = extruder.clone();
    let (mut warm, mut buffer) = (volume.clone(), vec![[0; 3]; triangles]);
    let mut copy = buffer.clone();
    // Three indices of 4 are written. As many are read for every second triangle, with a sign. Vertices are
    // not counted.
    let faces = signs.len() as f64 / triangles as f64;
    let bytes = 12.0 + 13.0 * faces;
    let contenders = vec![
        Contender::new("copy into a warm buffer", || {
            timed(|| copy.copy_from_slice(volume.triangles()), |()| format!("triangles={triangles}"))
        })
        .moves(24.0),
        Contender::new("copy of the result", || {
            timed(|| volume.triangles().to_vec(), |copy| format!("triangles={}", copy.len()))
        })
        .moves(24.0),
        Contender::new("ShadowVolume::extrude", || {
            timed(extrude, |volume| format!("triangles={}", volume.triangles().len()))
        })
        .expects(format!("triangles={triangles}"))
        .moves(bytes),
        Contender::new("Extruder::extrude_into", || {
            let sample =
                timed(|| extruder.extrude_into(cast, &mut warm), |()| format!("triangles={triangles}"));
            assert!(warm.triangles() == volume.triangles(), "another volume");
            sample
        })
        .moves(bytes),
        Contender::new("Extruder::write_indices", || {
            let work = || writer.write_indices(cast, &mut buffer).expect("it fits").triangle_count();
            timed(work, |count| format!("triangles={count}"))
        })
        .expects(format!("triangles={triangles}"))
        .moves(bytes)
        .aims_at(Target::Limits(2.0)),
    ];
    bench.run(Group { stage: "volume", mesh: name, units: triangles, unit: "triangle", contenders });
}

/// The structure for a mesh known to be closed and two-sided: the two faces of each edge.
fn textbook(topology: &Topology) -> Vec<[u32; 2]> {
    let pair = |edge: EdgeId| {
        let mut faces = topology.uses(edge).map(|(face, _)| face.0);
        [faces.next().expect("two faces"), faces.next().expect("two faces")]
    };
    topology.edges().map(pair).collect()
}

fn changes(pairs: &[[u32; 2]], signs: &[i8]) -> Vec<u32> {
    let changes = |&(_, &[a, b]): &(u32, &[u32; 2])| signs[a as usize] != signs[b as usize];
    (0..).zip(pairs).filter(changes).map(|(edge, _)| edge).collect()
}

/// The winding number of the emitted volume at scattered points: the number of faces between point and light.
fn winding(bench: &mut Bench<'_>) {
    let mesh = umbrage::testing::shapes::icosphere(if bench.quick { 3 } else { 6 });
    let light = light();
    let topology = Topology::of(&mesh);
    let signs = CasterFaces::All.signs(&classify(&mesh, &light));
    let silhouette = Silhouette::extract(&topology, &signs);
    let volume = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
    let oracle = Oracle::build(&mesh);
    let mut scatter = Scatter(1);
    let points: Vec<[f32; 3]> =
        (0..if bench.quick { 50 } else { 2000 }).map(|_| scatter.point(2.0)).collect();
    let within = umbrage::geom::Aabb { low: [-2.0; 3], high: [2.0; 3] };
    let crossed: Vec<i32> = points
        .iter()
        .map(|&p| {
            let crossings = oracle.crossings(p, &light);
            assert_eq!(crossings.touching, 0, "a scattered point is not in general position: {p:?}");
            (crossings.front + crossings.back) as i32
        })
        .collect();
    let index = WindingIndex::build(&volume, within);
    let contenders = vec![
        Contender::new("faces towards the light (Oracle)", || {
            let work = || points.iter().map(|&p| oracle.crossings(p, &light)).collect::<Vec<_>>();
            timed(work, |found| format!("sum={}", found.iter().map(|c| c.front + c.back).sum::<u32>()))
        })
        .expects(format!("sum={}", crossed.iter().sum::<i32>())),
        Contender::new("WindingIndex::number", || {
            let work = || points.iter().map(|&p| index.number(p)).collect::<Option<Vec<i32>>>();
            timed(work, |found| {
                let found = found.as_ref().expect("no scattered point lies on the volume");
                assert!(*found == crossed, "a winding number is not the number of faces crossed");
                format!("sum={}", found.iter().sum::<i32>())
            })
        }),
    ];
    let units = points.len();
    let name = mesh.name.clone();
    bench.run(Group { stage: "winding", mesh: name.clone(), units, unit: "query", contenders });
    let contenders = vec![Contender::new("WindingIndex::build", || {
        timed(
            || WindingIndex::build(&volume, within),
            |index| format!("at_origin={:?}", index.number([0.0; 3])),
        )
    })];
    let units = volume.triangles().len();
    bench.run(Group { stage: "winding", mesh: name, units, unit: "triangle", contenders });
}
