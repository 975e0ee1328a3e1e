use proptest::prelude::*;

use super::*;
use crate::facing::classify;
use crate::mesh::Mesh;
use crate::shadow::volume::closed::boundary_sum;
use crate::shadow::volume::{ExtrudeInput, Extruder};
use crate::silhouette::Silhouette;
use crate::silhouette::test_support::{crumpled, light, lights};
use crate::testing::{shapes, strategy};

/// The triangles of the volume by a pass over all faces and edges: the reference. Sorted.
fn reference(caster: &Caster, light: &Light, asked: Option<CasterFaces>, caps: Caps) -> Vec<[u32; 3]> {
    let (mesh, topology) = (caster.mesh(), caster.topology());
    let signs = caster.shell_faces(light, asked).signs(caster.shells(), &classify(mesh, light));
    let silhouette = &Silhouette::extract(topology, &signs);
    let input = ExtrudeInput { mesh, topology, light, signs: &signs, silhouette, caps };
    let mut extruder = Extruder::new(topology);
    let mut triangles = vec![[0; 3]; extruder.parts(&input).triangle_count()];
    extruder.write_indices(&input, &mut triangles).unwrap();
    triangles.sort_unstable();
    triangles
}

/// The triangles of a frame, written and in ranges, as a renderer would draw them. Sorted.
fn drawn(extruder: &mut FrameExtruder, caster: &Caster, light: &Light, caps: Caps) -> Vec<[u32; 3]> {
    let mut buffer = Vec::new();
    if let Err(BufferTooSmall { needed, room: 0 }) = extruder.write(caster, light, caps, &mut buffer) {
        buffer.resize(needed, [u32::MAX; 3]);
    }
    let frame = extruder.write(caster, light, caps, &mut buffer).expect("it was asked for");
    assert_eq!(frame.written.triangle_count(), buffer.len());
    let (near, dark): (Vec<_>, Vec<_>) = (frame.light_cap.to_vec(), frame.dark_cap().collect());
    let count = frame.triangle_count();
    let n = caster.mesh().vertex_count() as u32;
    let list = extruder.static_triangles();
    for (ranges, base) in [(near, 0), (dark, n)] {
        for range in ranges {
            assert!(!range.is_empty());
            let triangles = &list[range.start as usize..range.end as usize];
            buffer.extend(triangles.iter().map(|corners| corners.map(|v| v + base)));
        }
    }
    assert_eq!(buffer.len(), count);
    buffer.sort_unstable();
    buffer
}

/// How often caps were found in which manner.
#[derive(Debug, Default)]
struct Taken {
    clustered: usize,
    ranges: usize,
    scanned: usize,
    scanned_by_finder: usize,
    followed: usize,
    /// Lights for which shells of one group cast with different faces.
    mixed: usize,
}

impl Taken {
    fn note(&mut self, extruder: &FrameExtruder) {
        match extruder.caps {
            FoundCaps::Not => panic!("caps were asked for"),
            FoundCaps::Clustered => {
                self.clustered += 1;
                self.ranges += extruder.cap.ranges.len();
            }
            FoundCaps::Scanned => self.scanned += 1,
            FoundCaps::ScannedByFinder => self.scanned_by_finder += 1,
        }
        let method = extruder.method().unwrap().what;
        self.followed += usize::from(method == SilhouetteMethod::Kinetic);
        let choices = &extruder.faces().choices;
        self.mixed += usize::from(choices.iter().any(|choice| choice.what != choices[0].what));
    }
}

/// Every light by one extruder, one after another, against the reference.
fn agrees(extruder: &mut FrameExtruder, caster: &Caster, lights: &[Light], taken: &mut Taken) -> bool {
    lights.iter().all(|light| {
        [Caps::None, Caps::Both].into_iter().all(|caps| {
            let found = drawn(extruder, caster, light, caps);
            if caps == Caps::Both {
                taken.note(extruder);
                assert!(boundary_sum(&found).is_closed(), "{light}");
            }
            found == reference(caster, light, extruder.asked, caps)
        })
    })
}

/// An extruder that takes the tree and clusters for any mesh.
fn forced(caster: &Caster, asked: Option<CasterFaces>, shortest: u32) -> FrameExtruder {
    FrameExtruder {
        finder: SilhouetteFinder::unlimited(caster),
        clusters: CapClusters::new(caster, asked.is_none()),
        ..FrameExtruder::new(caster, asked).with_shortest_range(shortest)
    }
}

fn asked() -> impl Strategy<Value = Option<CasterFaces>> {
    prop_oneof![
        3 => Just(None),
        1 => Just(Some(CasterFaces::All)),
        1 => Just(Some(CasterFaces::Front)),
        1 => Just(Some(CasterFaces::Back)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn frame_equals_the_extruder_on_soups(
        mesh in strategy::soup(200),
        lights in prop::collection::vec(strategy::light(), 4),
        asked in asked(),
        shortest in prop_oneof![Just(0), Just(40), Just(u32::MAX)],
    ) {
        let caster = Caster::new(mesh);
        let mut taken = Taken::default();
        prop_assert!(agrees(&mut FrameExtruder::new(&caster, asked), &caster, &lights, &mut taken));
        prop_assert!(agrees(&mut forced(&caster, asked, shortest), &caster, &lights, &mut taken));
    }

    #[test]
    fn frame_equals_the_extruder_on_meshes_full_of_ties(
        mesh in crumpled(),
        lights in light(6),
        steps in prop::collection::vec(0.0_f32..0.02, 12),
        asked in asked(),
        shortest in prop_oneof![Just(0), Just(40), Just(u32::MAX)],
    ) {
        // Small steps from each light.
        let walk = lights.iter().flat_map(|light| {
            let moved = |by: &f32| {
                let [x, y, z] = light.xyz();
                if light.is_directional() { *light } else { Light::point([x + by, y - by, z + by]).unwrap() }
            };
            std::iter::once(*light).chain(steps.iter().map(moved)).collect::<Vec<_>>()
        });
        let walk: Vec<Light> = walk.collect();
        let caster = Caster::new(mesh);
        prop_assert!(agrees(&mut forced(&caster, asked, shortest), &caster, &walk, &mut Taken::default()));
    }
}

/// Boxes on a grid, every third one inside out, every fifth one open, one in each corner with a smaller one
/// within.
fn boxes(n: usize) -> Mesh {
    let parts: Vec<Mesh> = (0..n * n)
        .map(|i| {
            let at = [3.0 * (i % n) as f32, 0.25 * (i % 7) as f32, 3.0 * (i / n) as f32];
            let cube = match i {
                _ if i % 3 == 1 => shapes::inside_out(&shapes::cube()),
                _ if i % 5 == 2 => shapes::open_cube(),
                _ if i % 4 == 3 => shapes::nested_cubes(3),
                _ => shapes::icosphere(1),
            };
            shapes::translated(&cube, at)
        })
        .collect();
    Mesh::concat(&parts).unwrap()
}

/// Small steps through the middle of a mesh, in and out of its shells, and jumps.
fn walk(mesh: &Mesh) -> Vec<Light> {
    let [low, high] = mesh.bounds().unwrap();
    let at = |t: f32, jump: f32| {
        let part = [0.1 + t, 0.5 + jump + 0.1 * t, 0.1 + 1.01 * t];
        Light::point([0, 1, 2].map(|i| low[i] + part[i] * (high[i] - low[i]))).unwrap()
    };
    let steps = (0..30).map(|i| at(0.8 * i as f32 / 30.0, 0.0));
    let slow = (0..20).map(|i| at(1e-5 * i as f32, if i > 10 { 2.0 } else { 0.0 }));
    steps.chain(slow).collect()
}

fn meshes() -> Vec<Mesh> {
    let sphere = shapes::icosphere(4);
    let large = shapes::torus(80, 30, 2.0, 0.7);
    let beside = shapes::translated(&shapes::inside_out(&large), [6.0, 0.0, 0.0]);
    let mut flat = shapes::torus(60, 40, 2.0, 0.7).triangles().to_vec();
    flat.extend([[0, 0, 1], [5, 5, 5], [1, 2, 1]]);
    vec![
        sphere.clone(),
        boxes(7),
        Mesh::concat(&[large.clone(), beside, boxes(3)]).unwrap(),
        Mesh::concat(&[sphere.clone(), shapes::scaled(&sphere, 0.5), shapes::scaled(&sphere, 0.3)]).unwrap(),
        Mesh::new(shapes::torus(60, 40, 2.0, 0.7).positions().to_vec(), flat).unwrap(),
        shapes::menger_sponge(2),
        shapes::mobius(200),
        shapes::sheet(20),
        shapes::soup(&shapes::icosphere(2)),
        shapes::figure_eight_prism(),
        shapes::collinear_face(),
        Mesh::new(vec![], vec![]).unwrap(),
    ]
}

#[test]
fn frame_equals_the_extruder_on_whole_meshes_while_a_light_moves() {
    let mut taken = Taken::default();
    for mesh in meshes() {
        let mut all = Vec::new();
        if mesh.face_count() > 0 {
            all = walk(&mesh);
            all.extend(lights(&mesh).into_iter().step_by(3));
        } else {
            all.push(Light::point([1.0, 2.0, 3.0]).unwrap());
        }
        let caster = Caster::new(mesh);
        for (asked, shortest) in [(None, 0), (None, 512), (Some(CasterFaces::All), 64)] {
            let mut extruder = FrameExtruder::new(&caster, asked).with_shortest_range(shortest);
            assert!(agrees(&mut extruder, &caster, &all, &mut taken), "{} {asked:?}", caster.mesh().name);
        }
    }
    // Clusters that give up for ties, below a finder that does not.
    let sponge = Caster::new(shapes::menger_sponge(2));
    let axis = Light::directional([0.0, 0.0, -1.0]).unwrap();
    let skew = Light::directional([1.0, 2.0, 3.0]).unwrap();
    assert!(agrees(&mut forced(&sponge, None, 64), &sponge, &[axis, skew, axis], &mut taken));
    assert!(
        taken.clustered > 300
            && taken.ranges > 1000
            && taken.scanned == 2
            && taken.scanned_by_finder > 300
            && taken.followed > 150
            && taken.mixed > 50,
        "{taken:?}"
    );
}

/// Whether a fault in an extruder is seen by the comparison.
fn caught(mesh: &Mesh, spoil: impl Fn(&mut FrameExtruder)) -> bool {
    let caster = Caster::new(mesh.clone());
    let all = walk(mesh);
    let made = || FrameExtruder::new(&caster, None).with_shortest_range(64);
    let mut taken = Taken::default();
    assert!(agrees(&mut made(), &caster, &all, &mut taken));
    assert!(taken.clustered > 0, "{taken:?}");
    all.iter().any(|light| {
        let mut extruder = made();
        extruder.find(&caster, light, Caps::Both);
        spoil(&mut extruder);
        drawn(&mut extruder, &caster, light, Caps::Both) != reference(&caster, light, None, Caps::Both)
    })
}

#[test]
fn frame_with_a_triangle_less_or_a_range_moved_is_caught() {
    let mesh = shapes::icosphere(5);
    assert!(!caught(&mesh, |_| ()));
    assert!(caught(&mesh, |extruder| extruder.cap.single.truncate(1)));
    assert!(caught(&mesh, |extruder| extruder.cap.ranges[0].end -= 1));
    assert!(caught(&mesh, |extruder| extruder.cap.ranges[0].start += 1));
}

#[test]
fn frame_with_a_triangle_turned_is_caught() {
    assert!(caught(&shapes::icosphere(5), |extruder| extruder.cap.single[0].swap(0, 1)));
}

#[test]
fn frame_of_shells_in_one_group_that_are_taken_for_alike_is_caught() {
    // A light passes through small shells: without the faces that only some of them cast, their shadows are
    // open.
    let mesh = boxes(8);
    let caster = Caster::new(mesh.clone());
    let missed = |spoiled: bool| {
        let mut extruder = forced(&caster, None, 64);
        if spoiled {
            extruder.clusters.forget_differences();
        }
        !agrees_open(&mut extruder, &caster, &walk(&mesh))
    };
    assert!(!missed(false));
    assert!(missed(true));
}

/// As [`agrees`], of volumes that may be open.
fn agrees_open(extruder: &mut FrameExtruder, caster: &Caster, lights: &[Light]) -> bool {
    lights
        .iter()
        .all(|light| drawn(extruder, caster, light, Caps::Both) == reference(caster, light, None, Caps::Both))
}

#[test]
fn frame_is_built_again_for_another_pose() {
    let mut caster = Caster::new(shapes::icosphere(4));
    let light = Light::point([3.0, 4.0, 5.0]).unwrap();
    let mut extruder = FrameExtruder::new(&caster, None).with_shortest_range(1);
    let before = drawn(&mut extruder, &caster, &light, Caps::Both);
    let turned = caster.mesh().positions().iter().map(|&[x, y, z]| [y, -x, z]).collect();
    caster.repose(turned).unwrap();
    let now = drawn(&mut extruder, &caster, &light, Caps::Both);
    assert_eq!(now, reference(&caster, &light, None, Caps::Both));
    assert_ne!(now, before);
    assert_eq!(extruder.shortest_range, 1);
}

#[test]
fn frame_in_a_buffer_that_is_too_small_is_refused_and_nothing_is_written() {
    let caster = Caster::new(shapes::icosphere(4));
    let light = Light::point([3.0, 4.0, 5.0]).unwrap();
    let mut extruder = FrameExtruder::new(&caster, None);
    let needed = extruder.write(&caster, &light, Caps::Both, &mut []).unwrap_err().needed;
    let mut buffer = vec![[7; 3]; needed - 1];
    let refused = extruder.write(&caster, &light, Caps::Both, &mut buffer).unwrap_err();
    assert_eq!(refused, BufferTooSmall { needed, room: needed - 1 });
    assert!(buffer.iter().all(|&triangle| triangle == [7; 3]));
}
