//! The silhouette and the volume, of one light and of a frame loop.

use umbrage::caster::Caster;
use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::Light;
use umbrage::mesh::{EdgeId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::shadow::volume::{
    Caps, ExtrudeInput, Extruder, FrameExtruder, ShadowVolume, ShellFaces, WindingIndex,
};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;
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
    let (boxes, torus) = (Caster::new(boxes()), Caster::new(torus(bench.quick)));
    if bench.wants("casting faces") {
        casting_faces(bench, &boxes, [20.0, 90.0, 30.0], "far light", 5_000.0);
        casting_faces(bench, &boxes, [21.0, 0.0, 21.0], "light among them", 5_000.0);
        casting_faces(bench, &torus, [9.0, 4.0, 5.0], "far light", 5_000.0);
        casting_faces(bench, &torus, [0.1, 0.2, 0.1], "light in the hole", 50_000.0);
    }
    if bench.wants("frame of a moving light") {
        for (step, what) in [(1e-4, "1e-4 a step"), (1e-2, "1e-2 a step")] {
            frames(bench, &boxes, step, what, 60_000.0);
            frames(bench, &torus, step, what, 500_000.0);
        }
    }
}

/// 400 boxes of several sizes, turned in several ways, on a grid.
fn boxes() -> Mesh {
    let mut scatter = Scatter(7);
    let parts: Vec<Mesh> = (0..400_u16)
        .map(|i| {
            let half = scatter.point(0.4).map(|x| 0.5 + x);
            let (sin, cos) = scatter.next().sin_cos();
            let at = [2.0 * f32::from(i % 20), scatter.next(), 2.0 * f32::from(i / 20)];
            let cuboid = shapes::cuboid(half.map(|x| -x), half);
            let turned =
                |&[x, y, z]: &[f32; 3]| [at[0] + cos * x + sin * z, at[1] + y, at[2] + cos * z - sin * x];
            Mesh::new(cuboid.positions().iter().map(turned).collect(), cuboid.triangles().to_vec())
                .expect("finite")
        })
        .collect();
    Mesh::concat(&parts).expect("few").with_name("400 boxes")
}

/// 100,352 triangles in one shell.
fn torus(quick: bool) -> Mesh {
    let n = if quick { 40 } else { 224 };
    shapes::torus(n, n, 2.0, 0.75).with_name(format!("torus {n}"))
}

/// Which faces cast: per light, whatever the number of faces.
fn casting_faces(bench: &mut Bench<'_>, caster: &Caster, at: [f32; 3], what: &str, target: f64) {
    const LIGHTS: u16 = 16;
    let lights: Vec<Light> = (0..LIGHTS)
        .map(|i| Light::point([at[0] + 0.001 * f32::from(i), at[1], at[2]]).expect("finite"))
        .collect();
    let count =
        |faces: &ShellFaces| faces.choices.iter().filter(|choice| choice.what == CasterFaces::Front).count();
    // All shells are closed and sound, and no light is inside one.
    let expected = format!("front={}", usize::from(LIGHTS) * caster.shells().count);
    let mut kept = ShellFaces::default();
    let _ = caster.proofs(); // once for a mesh
    let contenders = vec![
        Contender::new("Caster::shell_faces", || {
            let work = || lights.iter().map(|light| count(&caster.shell_faces(light, None))).sum::<usize>();
            timed(work, |front| format!("front={front}"))
        })
        .expects(&*expected),
        Contender::new("Caster::shell_faces_into", || {
            let mut choose = |light| {
                caster.shell_faces_into(light, None, &mut kept);
                count(&kept)
            };
            timed(|| lights.iter().map(&mut choose).sum::<usize>(), |front| format!("front={front}"))
        })
        .expects(&*expected)
        .aims_at(Target::Time(target)),
    ];
    let mesh = format!("{} · {what}", caster.mesh().name);
    bench.run(Group { stage: "casting faces", mesh, units: lights.len(), unit: "light", contenders });
}

/// A whole frame: casting faces, silhouette, both caps and sides into a buffer, while a light moves there and
/// back.
fn frames(bench: &mut Bench<'_>, caster: &Caster, step: f32, what: &str, target: f64) {
    const STEPS: u8 = 32;
    let (mesh, topology) = (caster.mesh(), caster.topology());
    let [low, high] = mesh.bounds().expect("it has faces");
    let bounds = umbrage::geom::Aabb { low, high };
    let (center, diagonal) = (bounds.center(), bounds.diagonal() as f32);
    let at = |i: u8| {
        let way = step * f32::from(i);
        let to = [0.5 + 0.6 * way, 0.8 - 0.64 * way, 0.3 + 0.48 * way];
        Light::point([0, 1, 2].map(|i| center[i] + diagonal * to[i])).expect("finite")
    };
    let walk: Vec<Light> = (1..=STEPS).chain((0..STEPS).rev()).map(at).collect();

    let mut faces = ShellFaces::default();
    let (mut facing, mut signs, mut silhouette) = (Vec::new(), Vec::new(), Silhouette::default());
    let (mut whole, mut buffer) = (Extruder::new(topology), vec![[0; 3]; 4 * mesh.face_count()]);
    let mut every_face = |light: &Light, buffer: &mut [[u32; 3]]| {
        caster.shell_faces_into(light, None, &mut faces);
        caster.planes().classify_into(mesh, light, &mut facing);
        faces.signs_into(caster.shells(), &facing, &mut signs);
        silhouette.extract_into(topology, &signs);
        let (silhouette, caps) = (&silhouette, Caps::Both);
        let input = ExtrudeInput { mesh, topology, light, signs: &signs, silhouette, caps };
        whole.write_indices(&input, buffer).expect("it fits").triangle_count()
    };
    let expected: usize = walk.iter().map(|light| every_face(light, &mut buffer)).sum();
    let count = every_face(&walk[walk.len() - 1], &mut buffer);
    let mut last = buffer[..count].to_vec();
    last.sort_unstable();
    let per_frame = expected as f64 / walk.len() as f64;

    let mut ranges = FrameExtruder::new(caster, None);
    let mut written = FrameExtruder::new(caster, None).with_shortest_range(u32::MAX);
    let mut bytes = 0.0;
    for light in walk.iter().chain(&walk[..1]) {
        let frame = ranges.write(caster, light, Caps::Both, &mut buffer).expect("it fits");
        bytes += 12.0 * frame.written.triangle_count() as f64 / (walk.len() + 1) as f64;
    }
    let (mut first_buffer, mut second_buffer) = (buffer.clone(), buffer.clone());
    let answer = |sum: &usize| format!("triangles={sum}");
    let run = |extruder: &mut FrameExtruder, buffer: &mut Vec<[u32; 3]>| {
        let mut frame =
            |light| extruder.write(caster, light, Caps::Both, buffer).expect("it fits").triangle_count();
        let sample = timed(|| walk.iter().map(&mut frame).sum::<usize>(), answer);
        let light = &walk[walk.len() - 1];
        assert!(drawn(extruder, caster, light, buffer) == last, "another volume");
        sample
    };
    let contenders = vec![
        Contender::new("every face and edge", || {
            timed(|| walk.iter().map(|light| every_face(light, &mut buffer)).sum::<usize>(), answer)
        })
        .expects(format!("triangles={expected}"))
        .moves(12.0 * per_frame),
        Contender::new("FrameExtruder::write, all in one buffer", || run(&mut written, &mut first_buffer))
            .expects(format!("triangles={expected}"))
            .moves(12.0 * per_frame),
        Contender::new("FrameExtruder::write", || run(&mut ranges, &mut second_buffer))
            .expects(format!("triangles={expected}"))
            .moves(bytes)
            .aims_at(Target::Time(target)),
    ];
    let name = format!("{} · {what}", mesh.name);
    let units = walk.len();
    bench.run(Group { stage: "frame of a moving light", mesh: name, units, unit: "frame", contenders });
}

/// The triangles of a frame as a renderer would draw them, sorted.
fn drawn(
    extruder: &mut FrameExtruder,
    caster: &Caster,
    light: &Light,
    buffer: &mut [[u32; 3]],
) -> Vec<[u32; 3]> {
    let frame = extruder.write(caster, light, Caps::Both, buffer).expect("it fits");
    let mut all = buffer[..frame.written.triangle_count()].to_vec();
    let (near, dark): (Vec<_>, Vec<_>) = (frame.light_cap.to_vec(), frame.dark_cap().collect());
    let list = extruder.static_triangles();
    for (ranges, base) in [(near, 0), (dark, caster.mesh().vertex_count() as u32)] {
        for range in ranges {
            let triangles = &list[range.start as usize..range.end as usize];
            all.extend(triangles.iter().map(|corners| corners.map(|v| v + base)));
        }
    }
    all.sort_unstable();
    all
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
    let mesh = shapes::icosphere(if bench.quick { 3 } else { 6 });
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
